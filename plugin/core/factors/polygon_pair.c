/* SPDX-License-Identifier: MIT
 * See polygon_pair.h. For a point x and an edge from y0 to y1 with direction u, let tau0 and tau1 be the edge's ends
 * seen from the foot of x on its line, d the distance of x from that line and alpha the angle between y0 - x and y1 -
 * x:
 *
 *     integral of ln r dt = tau1 ln |y1 - x| - tau0 ln |y0 - x| - (tau1 - tau0) + d alpha
 *
 * The middle term cancels over a closed outline. Outside, each edge is cut where it comes close to a corner or an edge
 * of the other outline; there the integrand behaves like s ln s or |s|. A stretch [p0, p1] is mapped by
 *
 *     s = p0 + (p1 - p0) (10 u^3 - 15 u^4 + 6 u^5)
 *
 * whose two vanishing derivatives at both ends make that smooth enough for the 15 points of Gauss and Kronrod, which
 * are applied to u adaptively.
 *
 * Lengths are in units of the pair's size, so that the logarithms stay small. Far apart they cancel with the square of
 * the distance all the same; there the mean of element_factor.h over the smaller one converges at once, and is taken.
 */
#include "factors/polygon_pair.h"

#include "factors/element_factor.h"
#include "geometry/vec3.h"

#include <float.h>
#include <stdlib.h>

/* Outlines closer than this to an edge, relative to its length, are worth a cut of it: the integrand then has a
 * singularity within twice the largest distance of the rule's nodes, 0.1. Half of it left three times as many estimates
 * below the error; twice as much costs points and changes nothing. */
static const double CLOSE = 0.25;

/* A term of the inner integral is good to this many DBL_EPSILON of its size: differences, a square, a logarithm, a
 * product. */
static const double TERM_ROUNDINGS = 4.0;

/* [Piessens83, qk15]: nodes of Kronrod's rule on [-1, 1], its weights, those of Gauss' rule (every second node). */
static const double NODE[8] = { 0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                0.586087235467691130294144691258380, 0.405845151377397166906606412076961,
                                0.207784955007898467600689403773245, 0.0 };
static const double KRONROD[8] = { 0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                   0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                   0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                   0.204432940075298892414161999234649, 0.209482141084727828012999174891714 };
static const double GAUSS[8] = { 0.0, 0.129484966168869693270611432679082, 0.0, 0.279705391489276667901467771423780,
                                 0.0, 0.381830050505118944950369775488975, 0.0, 0.417959183673469387755102040816327 };

/* place: edge of the outer outline, cuts p0 and p1 on it, stretch u0 to u1 between them. */
enum { EDGE, P0, P1, U0, U1 };

/* Both outlines relative to a common centre, in units of their size. */
typedef struct outlines {
    double (*outer)[3], (*inner)[3];
    size_t outer_count, inner_count;
} outlines;

static void edge_of(const double (*corner)[3], size_t count, size_t i, double edge[3]) {
    vec3_sub(edge, corner[(i + 1) % count], corner[i]);
}

/* The integral of ln r along the inner outline, dotted with the outer edge's vector; size: the same without signs. */
static double inner_integral(const outlines *o, const double x[3], const double along[3], double *size) {
    double value = 0.0, a[3], b[3], e[3], cross[3];
    *size = 0.0;
    vec3_sub(a, o->inner[0], x);
    double square_a = vec3_dot(a, a), log_a = square_a > 0.0 ? 0.5 * log(square_a) : 0.0;
    for (size_t j = 0; j < o->inner_count; j++) {
        vec3_sub(b, o->inner[(j + 1) % o->inner_count], x);
        edge_of((const double(*)[3])o->inner, o->inner_count, j, e);
        double square_b = vec3_dot(b, b), log_b = square_b > 0.0 ? 0.5 * log(square_b) : 0.0;
        double length2 = vec3_dot(e, e);
        if (length2 > 0.0) {
            vec3_cross(cross, square_a < square_b ? a : b, e);
            double beside = vec3_length(cross), angle = atan2(beside, vec3_dot(a, b)),
                   share = vec3_dot(along, e) / length2;
            double end = vec3_dot(b, e), begin = vec3_dot(a, e);
            value += share * (end * log_b - begin * log_a + beside * angle);
            *size +=
                fabs(share) * (fabs(end) * (1.0 + fabs(log_b)) + fabs(begin) * (1.0 + fabs(log_a)) + beside * angle);
        }
        vec3_copy(a, b);
        square_a = square_b, log_a = log_b;
    }
    return value;
}

/* The integrand over u at one node. */
static double at_node(const outlines *o, const double place[ADAPTIVE_PLACE], double u, double *size) {
    double smooth = u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), slope = 30.0 * u * u * (1.0 - u) * (1.0 - u);
    size_t i = (size_t)place[EDGE];
    double along[3], x[3], stretch = place[P1] - place[P0];
    edge_of((const double(*)[3])o->outer, o->outer_count, i, along);
    vec3_add_scaled(x, o->outer[i], place[P0] + stretch * smooth, along);
    double value = inner_integral(o, x, along, size);
    *size *= stretch * slope;
    return stretch * slope * value;
}

static void evaluate(void *user, adaptive_piece *piece) {
    const outlines *o = user;
    double half = 0.5 * (piece->place[U1] - piece->place[U0]), middle = 0.5 * (piece->place[U1] + piece->place[U0]);
    double values[15], kronrod = 0.0, gauss = 0.0, rounding = 0.0, variation = 0.0;
    for (int i = 0; i < 15; i++) {
        int k = i < 8 ? i : 14 - i;
        double size;
        values[i] = at_node(o, piece->place, middle + (i < 8 ? -half : half) * NODE[k], &size);
        kronrod += KRONROD[k] * values[i], gauss += GAUSS[k] * values[i], rounding += KRONROD[k] * size;
    }
    for (int i = 0; i < 15; i++) variation += KRONROD[i < 8 ? i : 14 - i] * fabs(values[i] - 0.5 * kronrod);
    piece->value = half * kronrod;
    piece->error = adaptive_error(half * (kronrod - gauss), half * variation);
    piece->rounding = TERM_ROUNDINGS * DBL_EPSILON * half * rounding;
}

static int halve(void *user, const double place[ADAPTIVE_PLACE], double parts[ADAPTIVE_CHILDREN][ADAPTIVE_PLACE]) {
    (void)user;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < ADAPTIVE_PLACE; k++) parts[i][k] = place[k];
    parts[0][U1] = parts[1][U0] = 0.5 * (place[U0] + place[U1]);
    return 2;
}

/* ---- cuts ---- */

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Adds t if the edge is cut there by something near at x. */
static size_t add_cut(double *cuts, size_t count, double t, const double a[3], const double e[3], const double x[3]) {
    double on[3];
    if (!(t > 0.0 && t < 1.0)) return count;
    vec3_add_scaled(on, a, t, e);
    if (vec3_distance(on, x) > CLOSE * vec3_length(e)) return count;
    cuts[count] = t;
    return count + 1;
}

/* Where does the line a + t e pass the edge b + s f? NaN for parallel lines, and where it passes beyond its ends. */
static double passing(const double a[3], const double e[3], const double b[3], const double f[3], double on[3]) {
    double r[3], ee = vec3_dot(e, e), ff = vec3_dot(f, f), ef = vec3_dot(e, f);
    vec3_sub(r, b, a);
    double determinant = ee * ff - ef * ef, re = vec3_dot(r, e), rf = vec3_dot(r, f);
    if (!(determinant > DBL_EPSILON * ee * ff)) return NAN;
    double t = (re * ff - rf * ef) / determinant, s = (re * ef - rf * ee) / determinant;
    vec3_add_scaled(on, b, s, f);
    return s > 0.0 && s < 1.0 ? t : NAN;
}

/* cuts has room for 2 + 2 inner_count. */
static size_t cuts_of(const outlines *o, size_t i, double *cuts) {
    size_t count = 2;
    double e[3], f[3], on[3];
    cuts[0] = 0.0, cuts[1] = 1.0;
    edge_of((const double(*)[3])o->outer, o->outer_count, i, e);
    for (size_t j = 0; j < o->inner_count; j++) {
        edge_of((const double(*)[3])o->inner, o->inner_count, j, f);
        double r[3];
        vec3_sub(r, o->inner[j], o->outer[i]);
        count = add_cut(cuts, count, vec3_dot(r, e) / vec3_dot(e, e), o->outer[i], e, o->inner[j]); /* at its foot */
        double t = passing(o->outer[i], e, o->inner[j], f, on);
        count = add_cut(cuts, count, t, o->outer[i], e, on);
    }
    qsort(cuts, count, sizeof *cuts, by_value);
    return count;
}

/* Returns how many places there are. */
static size_t set_places(const outlines *o, double *cuts, double (*places)[ADAPTIVE_PLACE]) {
    size_t count = 0;
    double e[3];
    for (size_t i = 0; i < o->outer_count; i++) {
        edge_of((const double(*)[3])o->outer, o->outer_count, i, e);
        if (!(vec3_dot(e, e) > 0.0)) continue;
        size_t cut_count = cuts_of(o, i, cuts);
        for (size_t k = 0; k + 1 < cut_count; k++) {
            /* Closer cuts than roundings of a coordinate along the edge are one. */
            if (cuts[k + 1] - cuts[k] <= 4.0 * DBL_EPSILON) {
                cuts[k + 1] = cuts[k];
                continue;
            }
            double *p = places[count++];
            for (int c = 0; c < ADAPTIVE_PLACE; c++) p[c] = 0.0;
            p[EDGE] = (double)i, p[P0] = cuts[k], p[P1] = cuts[k + 1], p[U1] = 1.0;
        }
    }
    return count;
}

static void set_outline(double (*out)[3], polygon_loop loop, const double center[3], double unit) {
    for (size_t i = 0; i < loop.count; i++)
        for (int k = 0; k < 3; k++) out[i][k] = (loop.corner[i][k] - center[k]) / unit;
}

static factor_estimate integrate_outlines(const facing *f, const factor_request *request) {
    polygon_loop outer = f->element.loop, inner = f->source.loop;
    size_t places_max = outer.count * (2 * inner.count + 1);
    allocator *memory = request ? request->memory : NULL;
    double(*corners)[3] = block_new(memory, (outer.count + inner.count) * sizeof *corners);
    double *cuts = block_new(memory, (2 * inner.count + 2) * sizeof *cuts);
    double(*places)[ADAPTIVE_PLACE] = block_new(memory, places_max * sizeof *places);
    factor_estimate out = factor_failed();
    if (corners && cuts && places) {
        outlines o = { corners, corners + outer.count, outer.count, inner.count };
        double unit = fmax(f->element.radius, f->source.radius), center[3];
        vec3_mid(center, f->element.center, f->source.center);
        set_outline(o.outer, outer, center, unit);
        set_outline(o.inner, inner, center, unit);
        adaptive_rule rule = { evaluate, halve, 15, 0, false, &o };
        size_t count = set_places(&o, cuts, places);
        out = adaptive_integrate(&rule, (const double(*)[ADAPTIVE_PLACE])places, count,
                                 unit * unit / (TWO_PI * f->element.area), request);
    }
    block_free_all(corners, cuts, places);
    return out;
}

/* From the smaller side, by reciprocity: over it the factor to the larger one is the smoother. */
static factor_estimate integrate_area(const facing *f, const factor_request *request) {
    bool smaller = f->source.area_left < f->element.area_left && (f->source.convex || f->far);
    if (!smaller) return element_factor(f, request);
    facing turned = *f;
    turned.element = f->source, turned.source = f->element;
    factor_request scaled = request ? *request : (factor_request){ 0 };
    double ratio = f->source.area / f->element.area;
    scaled.absolute /= ratio;
    factor_estimate out = element_factor(&turned, &scaled);
    out.value *= ratio, out.error *= ratio;
    return out;
}

static factor_estimate pair_of_facing(const facing *f, const factor_request *request) {
    if (!f->any || f->far) return integrate_area(f, request);
    factor_estimate outline = integrate_outlines(f, request);
    if (!f->planar) outline.error = 1.0, outline.converged = false;
    if (outline.converged || !f->planar) return outline;
    /* Small values between near outlines: their logarithms cancel, the mean over the area has no sign. */
    factor_estimate area = integrate_area(f, request);
    factor_estimate *better = area.error < outline.error ? &area : &outline;
    better->evaluations = area.evaluations + outline.evaluations;
    return *better;
}

factor_estimate polygon_pair_factor(polygon_loop from, polygon_loop to, const factor_request *request) {
    facing f;
    if (!facing_create(&f, from, to, request ? request->memory : NULL)) return factor_failed();
    factor_estimate out = pair_of_facing(&f, request);
    facing_destroy(&f);
    return out;
}
