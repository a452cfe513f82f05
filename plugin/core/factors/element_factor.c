/* SPDX-License-Identifier: MIT
 * See element_factor.h. The element, cut to what is in front of the polygon, is a fan of triangles; each is integrated
 * with products of Gauss' rules of 7 x 7 and 5 x 5 points in the coordinates
 *
 *     x = v0 + s ((1 - t) e1 + t e2),   dA = 2 A s ds dt        [Duffy82]
 *
 * v0 is the corner next to one of the polygon's corners. Where the element touches the polygon, at the end of a shared
 * edge, the factor depends on the direction from that corner even at no distance; in s and t it is smooth, so that no
 * grading is needed there. The worst triangle is cut in two through v0 or in four. Points go through the batch kernel.
 *
 * Points for unit squares on a common edge at a right angle, and for an upright rectangle of 0.3 x 0.4 whose foot is
 * inside the element; asked 1e-6 / 1e-10:
 *                                              common edge        foot inside
 *     another corner as v0, cut in four       7992 / 27528      17168 / 83916
 *     v0 as above, cut in four                1036 / 11692      14060 / 83028
 *     what is here                            1036 /  6364       3108 / 24420
 */
#include "factors/element_factor.h"

#include "geometry/vec3.h"

#include <float.h>
#include <string.h>

/* A point's factor is off by this many DBL_EPSILON of the angles of the edges: the constant of polygon.c. */
static const double POINT_ROUNDINGS = 8.0;

/* A corner of the polygon nearer to the element's outline than this, relative to an edge, becomes a corner of the
 * outline, for the sake of its coordinates; that costs or saves points and changes no value. Float positions touch to
 * 1e-7. */
static const double TOUCHING = 1e-6;

/* Gauss-Legendre on [0, 1] [Abramowitz64, table 25.4]. */
enum { LOW = 5, HIGH = 7, POINTS = LOW * LOW + HIGH * HIGH };

static const double LOW_X[LOW] = { 0.0469100770306680036, 0.2307653449471584545, 0.5, 0.7692346550528415455,
                                   0.9530899229693319964 };
static const double LOW_W[LOW] = { 0.1184634425280945438, 0.239314335249683234, 0.2844444444444444444,
                                   0.239314335249683234, 0.1184634425280945438 };
static const double HIGH_X[HIGH] = { 0.02544604382862073774, 0.1292344072003027801, 0.2970774243113014165, 0.5,
                                     0.7029225756886985835,  0.8707655927996972199, 0.9745539561713792623 };
static const double HIGH_W[HIGH] = { 0.06474248308443484664, 0.139852695744638334,  0.1909150252525594725,
                                     0.2089795918367346939,  0.1909150252525594725, 0.139852695744638334,
                                     0.06474248308443484664 };

/* The points of the higher rule are at most this many sides apart. */
static const double SPACING = 0.21;

/* P6 at the nodes of the higher rule. */
static const double LAST_LEGENDRE[HIGH] = { 0.17682772500692665, -0.25629270346308333, 0.29881367709479615, -0.3125,
                                            0.29881367709479615, -0.25629270346308333, 0.17682772500692665 };

/* place: three corners, and which way to split. */
enum { ROUGH_IN_T = 9 };

typedef struct samples {
    double x[POINTS], y[POINTS], z[POINTS], weight[POINTS], factor[POINTS];
    size_t count;
} samples;

static void add_samples(samples *set, const double v[9], double twice_area, const double *nodes, const double *weights,
                        int order) {
    for (int i = 0; i < order * order; i++) {
        double s = nodes[i / order], t = nodes[i % order], out[3];
        for (int k = 0; k < 3; k++) out[k] = v[k] + s * ((1 - t) * (v[3 + k] - v[k]) + t * (v[6 + k] - v[k]));
        size_t at = set->count++;
        set->x[at] = out[0], set->y[at] = out[1], set->z[at] = out[2];
        set->weight[at] = twice_area * s * weights[i / order] * weights[i % order];
        set->factor[at] = 0.0;
    }
}

/* Signed: a fan of a non-convex element has triangles that run the other way. */
static double twice_area_of(const facing *f, const double v[9]) {
    double e1[3], e2[3], cross[3];
    vec3_sub(e1, v + 3, v);
    vec3_sub(e2, v + 6, v);
    vec3_cross(cross, e1, e2);
    return vec3_dot(cross, f->element.normal);
}

/* What the edges of the polygon take up at most, seen from the triangle. */
static double angle_of_edges(const facing *f, const double v[9]) {
    double reach = fmax(vec3_distance(v, v + 3), vec3_distance(v, v + 6));
    double gap = vec3_distance(v, f->source.center) - f->source.radius - reach;
    return gap > 0.0 ? fmin(TWO_PI, f->source.perimeter / gap) : TWO_PI;
}

static double weighted_sum(const samples *set, size_t begin, size_t end) {
    double sum = 0.0;
    for (size_t i = begin; i < end; i++) sum += set->weight[i] * set->factor[i];
    return sum;
}

static double variation(const samples *set, size_t begin, size_t end, double mean) {
    double sum = 0.0;
    for (size_t i = begin; i < end; i++) sum += fabs(set->weight[i] * (set->factor[i] - mean));
    return sum;
}

/* How much of the integrand is in the last Legendre polynomials that the higher rule resolves, in s and in t? */
typedef struct roughness {
    double s, t;
} roughness;

static roughness roughness_of(const double *weight, const double *factor) {
    roughness rough = { 0, 0 };
    for (int i = 0; i < HIGH; i++) {
        double s = 0.0, t = 0.0;
        for (int j = 0; j < HIGH; j++) {
            int along_s = HIGH * j + i, along_t = HIGH * i + j;
            s += weight[along_s] * LAST_LEGENDRE[j] * factor[along_s];
            t += weight[along_t] * LAST_LEGENDRE[j] * factor[along_t];
        }
        rough.s += fabs(s), rough.t += fabs(t);
    }
    return rough;
}

static const double ROUGHNESS = 8.0;

/* Coefficients of a smooth integrand fall geometrically: that of degree 6 is c, of degree 14, which is the error, about
 * c^2 over that of degree 0. The two rules may agree by chance; then this does not. With 8 times it,
 * errors are above their estimate in 1 of 10^4 triangles, by less than twice; without it in 7, by up to 14 times. */
static double error_of(double difference, double varies, const roughness *rough) {
    double c = rough->s + rough->t, error = adaptive_error(difference, varies);
    return varies > 0.0 ? fmax(error, c * fmin(1.0, ROUGHNESS * c / varies)) : error;
}

static double points_to_outline(polygon_loop loop, const double *x, const double *y, const double *z, int count) {
    double nearest = INFINITY;
    for (int i = 0; i < count; i++)
        for (size_t k = 0; k < loop.count; k++) {
            double point[3] = { x[i], y[i], z[i] };
            nearest = fmin(nearest, vec3_distance_to_segment(point, loop.corner[k], loop.corner[(k + 1) % loop.count]));
        }
    return nearest;
}

static double distance_to_triangle(const double x[3], const double v[9], const double normal[3]) {
    double nearest = INFINITY, r[3];
    bool inside = true;
    for (int i = 0; i < 3; i++) {
        const double *a = v + 3 * i, *b = v + 3 * ((i + 1) % 3);
        double e[3], cross[3];
        vec3_sub(e, b, a);
        vec3_sub(r, x, a);
        vec3_cross(cross, e, r);
        inside = inside && vec3_dot(cross, normal) >= 0.0;
        nearest = fmin(nearest, vec3_distance_to_segment(x, a, b));
    }
    return inside ? fabs(vec3_dot(r, normal)) : nearest;
}

static double triangle_to_outline(const facing *f, const double v[9]) {
    polygon_loop loop = f->source.loop;
    double x[3] = { v[0], v[3], v[6] }, y[3] = { v[1], v[4], v[7] }, z[3] = { v[2], v[5], v[8] };
    double nearest = points_to_outline(loop, x, y, z, 3);
    for (size_t k = 0; k < loop.count; k++)
        nearest = fmin(nearest, distance_to_triangle(loop.corner[k], v, f->element.normal));
    return nearest;
}

/* A polygon that is small or thin (area / radius is twice a sliver's width) and close to the triangle lights a patch or
 * a strip of it of about that width, which may lie between the points. It may if the triangle is many times larger than
 * the polygon and its distance, or if the polygon is clearly nearer to the triangle than to all points. Then nothing is
 * known but that, by reciprocity, no triangle gets more than the polygon's area. */
static double hidden_error(const facing *f, const samples *set, const double v[9]) {
    double sides = fmax(vec3_distance(v, v + 3), vec3_distance(v, v + 6)),
           reach = fmax(sides, vec3_distance(v + 3, v + 6));
    double width = 0.5 * f->source.area_left / f->source.radius;
    if (width > SPACING * reach) return 0.0;
    double nearest = triangle_to_outline(f, v);
    if (SPACING * reach > nearest + f->source.radius) return f->source.area_left;
    double near_points = points_to_outline(f->source.loop, set->x, set->y, set->z, POINTS);
    return near_points > 1.2 * nearest + 0.5 * width ? f->source.area_left : 0.0;
}

static void evaluate(void *user, adaptive_piece *piece) {
    const facing *f = user;
    samples set;
    set.count = 0;
    double twice_area = twice_area_of(f, piece->place);
    add_samples(&set, piece->place, twice_area, LOW_X, LOW_W, LOW);
    add_samples(&set, piece->place, twice_area, HIGH_X, HIGH_W, HIGH);
    polygon_loop_factor_batch(f->source.loop, f->element.normal, set.x, set.y, set.z, POINTS, set.factor);
    double low = weighted_sum(&set, 0, LOW * LOW), high = weighted_sum(&set, LOW * LOW, POINTS);
    double mean = twice_area != 0.0 ? 2.0 * high / twice_area : 0.0;
    piece->value = high;
    roughness rough = roughness_of(set.weight + LOW * LOW, set.factor + LOW * LOW);
    piece->error = error_of(high - low, variation(&set, LOW * LOW, POINTS, mean), &rough);
    piece->error = fmax(piece->error, hidden_error(f, &set, piece->place));
    piece->place[ROUGH_IN_T] = rough.t > rough.s;
    piece->rounding = POINT_ROUNDINGS * DBL_EPSILON * 0.5 * fabs(twice_area) * angle_of_edges(f, piece->place) / TWO_PI;
}

static double distance_to_corners(const facing *f, const double x[3]) {
    double nearest = INFINITY;
    for (size_t i = 0; i < f->source.loop.count; i++)
        nearest = fmin(nearest, vec3_distance(x, f->source.loop.corner[i]));
    return nearest;
}

/* Turns the triangle so that the corner next to one of the polygon's comes first. */
static void set_triangle(const facing *f, double place[9], const double a[3], const double b[3], const double c[3]) {
    const double *v[3] = { a, b, c };
    double distance[3] = { distance_to_corners(f, a), distance_to_corners(f, b), distance_to_corners(f, c) };
    int first = distance[1] < distance[0] ? 1 : 0;
    if (distance[2] < distance[first]) first = 2;
    for (int i = 0; i < 3; i++) vec3_copy(place + 3 * i, v[(first + i) % 3]);
}

/* In two through its first corner where directions from there are what is rough, else in four. */
static int split(void *user, const double v[ADAPTIVE_PLACE], double parts[ADAPTIVE_CHILDREN][ADAPTIVE_PLACE]) {
    const facing *f = user;
    double mid[3][3];
    for (int i = 0; i < 3; i++) vec3_mid(mid[i], v + 3 * i, v + 3 * ((i + 1) % 3));
    if (v[ROUGH_IN_T] > 0.0) {
        for (int i = 0; i < 2; i++) memcpy(parts[i], v, 9 * sizeof *v);
        vec3_copy(parts[0] + 6, mid[1]);
        vec3_copy(parts[1] + 3, mid[1]);
        return 2;
    }
    set_triangle(f, parts[0], v, mid[0], mid[2]);
    set_triangle(f, parts[1], mid[0], v + 3, mid[1]);
    set_triangle(f, parts[2], mid[2], mid[1], v + 6);
    set_triangle(f, parts[3], mid[0], mid[1], mid[2]);
    return 4;
}

/* The outline of the element, with the corners of the polygon that touch it as corners of its own. At most
 * element + source many. */
static size_t set_outline(const facing *f, double (*out)[3]) {
    polygon_loop element = f->element.loop, source = f->source.loop;
    size_t count = 0, room = element.count + source.count;
    for (size_t i = 0; i < element.count; i++) {
        const double *b = element.corner[(i + 1) % element.count], *a = element.corner[i];
        vec3_copy(out[count++], a);
        /* Along a shared edge the polygon runs the other way; twice round it, for where it begins. */
        for (size_t j = 2 * source.count; j-- > 0 && count < room - (element.count - 1 - i);) {
            const double *x = source.corner[j % source.count];
            if (vec3_place_between(x, out[count - 1], b, TOUCHING) > 0.0) vec3_copy(out[count++], x);
        }
    }
    return count;
}

/* A fan from a corner; from the middle where corners lie in line. Returns how many triangles it has. */
static size_t set_fan(const facing *f, const double (*corner)[3], size_t count, double (*places)[ADAPTIVE_PLACE]) {
    bool plain = count == f->element.loop.count;
    for (size_t i = 0; plain && i < count - 2; i++) set_triangle(f, places[i], corner[0], corner[i + 1], corner[i + 2]);
    if (plain) return count - 2;
    for (size_t i = 0; i < count; i++)
        set_triangle(f, places[i], f->element.center, corner[i], corner[(i + 1) % count]);
    return count;
}

factor_estimate element_factor(const facing *f, const factor_request *request) {
    if (!f->any) return (factor_estimate){ 0.0, f->planar ? 0.0 : 1.0, 0, f->planar };
    size_t room = f->element.loop.count + f->source.loop.count;
    allocator *memory = request ? request->memory : NULL;
    double(*corner)[3] = block_new(memory, room * sizeof *corner),
    (*places)[ADAPTIVE_PLACE] = block_zeroed(memory, room, sizeof *places);
    factor_estimate out = factor_failed();
    if (corner && places) {
        size_t count = set_outline(f, corner);
        count = set_fan(f, (const double(*)[3])corner, count, places);
        adaptive_rule rule = { evaluate, split, POINTS, 0, false, (void *)f };
        out = adaptive_integrate(&rule, (const double(*)[ADAPTIVE_PLACE])places, count, 1.0 / f->element.area, request);
    }
    block_free_all(corner, places);
    /* A fan of a non-convex outline also has triangles outside of it, which count twice, with both signs; far away the
     * factor is smooth there. */
    if (!f->planar || !(f->element.convex || f->far)) out.error = 1.0, out.converged = false;
    return out;
}
