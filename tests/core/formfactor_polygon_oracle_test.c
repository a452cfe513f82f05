/* SPDX-License-Identifier: MIT
 * Is the closed form good to 1e-10 of its value where geometry is nasty? The oracle is the same sum with 33 digits
 * (__float128), written as in a textbook; it checks itself that what cancels leaves it 12 of them. Inputs are taken as
 * they stand: a rotated polygon has the corners that rounding gave it, and the oracle sees the same ones.
 *
 * Prints the worst error of each hard case, beside those of the textbook sum in doubles.
 */
#include "check.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <quadmath.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

typedef __float128 quad;

enum { CORNERS_MAX = 64 };

/* What the library promises. */
static const double PROMISED = 1e-10;

typedef struct shape {
    double corner[CORNERS_MAX][3];
    size_t count;
} shape;

typedef struct view {
    double point[3], normal[3];
} view;

static polygon_loop loop_of(const shape *s) {
    return (polygon_loop){ s->corner, s->count };
}

/* splitmix64 (Steele, Lea & Flood 2014). */
static double random_between(uint64_t *state, double low, double high) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static void random_direction(uint64_t *seed, double out[3]) {
    do
        for (int k = 0; k < 3; k++) out[k] = random_between(seed, -1, 1);
    while (vec3_length(out) > 1 || vec3_length(out) < 0.1);
    vec3_normalize(out);
}

/* ---- the oracle ---- */

typedef struct oracle {
    quad sum, size; /* the terms, and the sum of the sizes of what they are made of */
    quad first[3], last[3];
    bool begun, above;
} oracle;

static quad quad_dot(const quad a[3], const quad b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void oracle_edge(oracle *o, const quad a[3], const quad b[3], const quad n[3]) {
    quad e[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    quad cross[3] = { a[1] * e[2] - a[2] * e[1], a[2] * e[0] - a[0] * e[2], a[0] * e[1] - a[1] * e[0] };
    quad sine = sqrtq(quad_dot(cross, cross)), angle = atan2q(sine, quad_dot(a, b));
    if (sine == 0) return;
    quad lengths = sqrtq(quad_dot(a, a) * quad_dot(e, e));
    o->sum += quad_dot(n, cross) / sine * angle;
    o->size += lengths / sine * angle;
}

static void oracle_walk(oracle *o, const quad r[3], const quad n[3]) {
    if (o->begun)
        oracle_edge(o, o->last, r, n);
    else
        memcpy(o->first, r, sizeof o->first);
    memcpy(o->last, r, sizeof o->last);
    o->begun = true;
}

/* The rule of polygon.h for a point in the plane of a loop: in that plane all vector areas of the point and an edge are
 * parallel, so that no two corners span a volume with another one. */
static bool is_in_one_plane(const shape *s, const view *v) {
    quad area[3] = { 0, 0, 0 }, largest = 0;
    for (size_t pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < s->count; i++) {
            quad a[3], b[3];
            for (int k = 0; k < 3; k++)
                a[k] = (quad)s->corner[i][k] - s->corner[0][k],
                b[k] = (quad)s->corner[(i + 1) % s->count][k] - s->corner[0][k];
            for (int k = 0; pass == 0 && k < 3; k++)
                area[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
            for (int k = 0; k < 3; k++) a[k] = (quad)s->corner[i][k] - v->point[k];
            quad size = sqrtq(quad_dot(a, a) * quad_dot(area, area));
            if (pass == 1 && size > 0) largest = fmaxq(largest, fabsq(quad_dot(a, area)) / size);
        }
    /* 33 digits less a few dozen roundings. */
    return largest < 1e-30Q;
}

static bool oracle_value(const shape *s, const view *v, double *value) {
    *value = 0.0;
    if (is_in_one_plane(s, v)) return true;
    quad n[3] = { v->normal[0], v->normal[1], v->normal[2] };
    oracle o = { .begun = false };
    for (size_t i = 0; i < s->count; i++) {
        quad a[3], b[3], cut[3];
        const double *from = s->corner[i], *to = s->corner[(i + 1) % s->count];
        for (int k = 0; k < 3; k++) a[k] = (quad)from[k] - v->point[k], b[k] = (quad)to[k] - v->point[k];
        quad ha = quad_dot(n, a), hb = quad_dot(n, b);
        if (ha >= 0) oracle_walk(&o, a, n);
        if (ha > 0) o.above = true;
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
            for (int k = 0; k < 3; k++) cut[k] = a[k] + ha / (ha - hb) * (b[k] - a[k]);
            oracle_walk(&o, cut, n);
        }
    }
    if (o.begun) oracle_edge(&o, o.last, o.first, n);
    *value = o.above ? (double)(-o.sum / (2 * M_PIq)) : 0.0;
    /* 2^-112 for each of a few dozen operations. */
    return !o.above || fabsq(o.sum) > 1e12Q * 50 * FLT128_EPSILON * o.size;
}

/* ---- the competition ---- */

/* The sum in doubles; with_edges takes differences of corners instead of rays. No horizon: for views of the whole. */
static double plain_sum(const shape *s, const view *v, bool with_edges) {
    double sum = 0.0, a[3], b[3], e[3], cross[3];
    for (size_t i = 0; i < s->count; i++) {
        vec3_sub(a, s->corner[i], v->point);
        vec3_sub(b, s->corner[(i + 1) % s->count], v->point);
        vec3_sub(e, s->corner[(i + 1) % s->count], s->corner[i]);
        vec3_cross(cross, a, with_edges ? e : b);
        double sine = vec3_length(cross);
        if (sine > 0) sum += vec3_dot(v->normal, cross) * (atan2(sine, vec3_dot(a, b)) / sine);
    }
    return -sum / 6.28318530717958647692;
}

typedef struct hard_case {
    const char *name;
    double worst, worst_textbook, worst_edges, smallest, largest;
    int count, beyond_oracle;
} hard_case;

static bool is_wholly_above(const shape *s, const view *v) {
    for (size_t i = 0; i < s->count; i++) {
        double r[3];
        vec3_sub(r, s->corner[i], v->point);
        if (vec3_dot(r, v->normal) <= 0) return false;
    }
    return true;
}

static void check_view(hard_case *c, const shape *s, const view *v) {
    double expected, F = polygon_loop_factor(loop_of(s), v->point, v->normal);
    c->count++;
    CHECK(isfinite(F));
    if (!oracle_value(s, v, &expected)) {
        c->beyond_oracle++;
        return;
    }
    /* The promise of polygon.h; a factor of exactly 0 (nothing above the horizon) must be one. */
    CHECK_NEAR(F, expected, PROMISED * fabs(expected));
    if (expected == 0.0) return;
    c->worst = fmax(c->worst, fabs(F / expected - 1));
    c->smallest = c->smallest > 0 ? fmin(c->smallest, fabs(expected)) : fabs(expected);
    c->largest = fmax(c->largest, fabs(expected));
    if (!is_wholly_above(s, v)) return;
    c->worst_textbook = fmax(c->worst_textbook, fabs(plain_sum(s, v, false) / expected - 1));
    c->worst_edges = fmax(c->worst_edges, fabs(plain_sum(s, v, true) / expected - 1));
}

static void print_case(const hard_case *c) {
    printf("%-34s %6d views, |F| %.0e .. %.0e: error %.1e; textbook %.1e, with edge vectors %.1e\n", c->name, c->count,
           c->smallest, c->largest, c->worst, c->worst_textbook, c->worst_edges);
    /* Cases that the oracle cannot judge prove nothing. */
    CHECK(c->beyond_oracle * 20 <= c->count);
}

/* ---- shapes ---- */

/* Of size 1 about the origin, in the plane z = 0 unless said otherwise, front up. */
enum { TRIANGLE, SQUARE, L_SHAPE, STAR, MANY_GON, SADDLE, REPEATED, SHAPES };

static void add_corner(shape *s, double x, double y, double z) {
    vec3_copy(s->corner[s->count++], (double[]){ x, y, z });
}

static void add_ring(shape *s, int n, double inner, double lift) {
    for (int i = 0; i < n; i++) {
        double angle = 2 * 3.14159265358979 * i / n, radius = i % 2 ? inner : 0.5;
        add_corner(s, radius * cos(angle), radius * sin(angle), lift * cos(2 * angle));
    }
}

static shape shape_of(int kind) {
    static const double ell[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 0.3 }, { 0.3, 0.3 }, { 0.3, 1 }, { 0, 1 } };
    static const int repeats[9] = { 0, 0, 1, 2, 2, 2, 3, 3, 0 };
    shape s = { .count = 0 };
    if (kind == TRIANGLE) add_corner(&s, -0.4, -0.3, 0), add_corner(&s, 0.6, -0.2, 0), add_corner(&s, 0.1, 0.7, 0);
    for (int i = 0; kind == SQUARE && i < 4; i++) add_corner(&s, (i == 1 || i == 2) - 0.5, (i >= 2) - 0.5, 0);
    for (int i = 0; kind == L_SHAPE && i < 6; i++) add_corner(&s, ell[i][0] - 0.4, ell[i][1] - 0.4, 0);
    for (int i = 0; kind == REPEATED && i < 9; i++)
        add_corner(&s, (repeats[i] == 1 || repeats[i] == 2) - 0.5, (repeats[i] >= 2) - 0.5, 0);
    if (kind == STAR) add_ring(&s, 10, 0.2, 0);
    if (kind == MANY_GON) add_ring(&s, 40, 0.5, 0);
    if (kind == SADDLE) add_ring(&s, 24, 0.5, 0.2);
    return s;
}

/* Rows are an orthonormal frame, to rounding. */
typedef struct turn {
    double row[3][3];
} turn;

static turn random_turn(uint64_t *seed) {
    turn t;
    double helper[3];
    random_direction(seed, t.row[0]);
    do random_direction(seed, helper);
    while (fabs(vec3_dot(helper, t.row[0])) > 0.9);
    vec3_cross(t.row[1], t.row[0], helper);
    vec3_normalize(t.row[1]);
    vec3_cross(t.row[2], t.row[0], t.row[1]);
    return t;
}

static void apply(const turn *t, double scale, const double offset[3], double x[3]) {
    double out[3];
    for (int k = 0; k < 3; k++)
        out[k] = offset[k] + scale * (t->row[0][k] * x[0] + t->row[1][k] * x[1] + t->row[2][k] * x[2]);
    vec3_copy(x, out);
}

static void apply_to_all(const turn *t, double scale, const double offset[3], shape *s, view *v) {
    for (size_t i = 0; i < s->count; i++) apply(t, scale, offset, s->corner[i]);
    apply(t, scale, offset, v->point);
    apply(t, 1, (double[]){ 0, 0, 0 }, v->normal);
}

/* ---- cases ---- */

static const double NOWHERE[3] = { 0, 0, 0 };

/* From a random direction at a distance of the centre, looking roughly there. */
static view random_view(uint64_t *seed, double distance, double astray) {
    view v;
    double away[3];
    random_direction(seed, away);
    random_direction(seed, v.normal);
    for (int k = 0; k < 3; k++) v.point[k] = distance * away[k], v.normal[k] = astray * v.normal[k] - away[k];
    vec3_normalize(v.normal);
    return v;
}

static void at_distances(const char *name, double low, double high, double astray) {
    hard_case c = { .name = name };
    uint64_t seed = 1;
    for (double d = low; d <= high * 1.001; d *= sqrt(10))
        for (int kind = 0; kind < SHAPES; kind++)
            for (int i = 0; i < 12; i++) {
                shape s = shape_of(kind);
                view v = random_view(&seed, d, astray);
                turn t = random_turn(&seed);
                apply_to_all(&t, 1, NOWHERE, &s, &v);
                check_view(&c, &s, &v);
            }
    print_case(&c);
}

static void benign_views_are_good_to_ten_digits(void) {
    at_distances("benign: 1 to 10 sizes away", 1, 10, 0.5);
}

static void far_views_are_good_to_ten_digits(void) {
    at_distances("far: 1e2 to 1e4 sizes", 1e2, 1e4, 0.5);
    at_distances("farther: 1e5 to 1e9 sizes", 1e5, 1e9, 0.5);
}

static void views_through_the_horizon_are_good_to_ten_digits(void) {
    at_distances("partly below the horizon", 0.01, 10, 3);
    at_distances("partly below the horizon, far", 1e2, 1e6, 200);
}

/* At a height over a corner, an edge or the inside. */
static void near_views_are_good_to_ten_digits(void) {
    hard_case c = { .name = "near: 1e-9 to 1 over all places" };
    uint64_t seed = 2;
    for (double d = 1e-9; d <= 1.001; d *= 10)
        for (int kind = 0; kind < SHAPES; kind++)
            for (int place = 0; place < 3; place++)
                for (int i = 0; i < 12; i++) {
                    shape s = shape_of(kind);
                    view v;
                    size_t corner = (size_t)i % s.count;
                    double share = place == 0 ? 0.0 : place == 1 ? random_between(&seed, 0, 1) : 0.5;
                    for (int k = 0; k < 3; k++)
                        v.point[k] = (1 - share) * s.corner[corner][k] + share * s.corner[(corner + 1) % s.count][k];
                    if (place == 2) v.point[0] *= 0.3, v.point[1] *= 0.3;
                    v.point[2] += d;
                    random_direction(&seed, v.normal);
                    turn t = random_turn(&seed);
                    apply_to_all(&t, 1, NOWHERE, &s, &v);
                    check_view(&c, &s, &v);
                }
    print_case(&c);
}

static void slivers_are_good_to_ten_digits(void) {
    hard_case c = { .name = "slivers of aspect 1e3 to 1e6" };
    uint64_t seed = 3;
    for (double aspect = 1e3; aspect <= 1.001e6; aspect *= 10)
        for (double d = 1e-2; d <= 1.001e8; d *= 10)
            for (int kind = 0; kind < SHAPES; kind++)
                for (int i = 0; i < 6; i++) {
                    shape s = shape_of(kind);
                    for (size_t k = 0; k < s.count; k++) s.corner[k][1] /= aspect;
                    view v = random_view(&seed, d, 0.7);
                    turn t = random_turn(&seed);
                    apply_to_all(&t, 1, NOWHERE, &s, &v);
                    check_view(&c, &s, &v);
                }
    print_case(&c);
}

static void scaled(const char *name, double scale, double offset) {
    hard_case c = { .name = name };
    uint64_t seed = 4;
    for (double d = 1e-3; d <= 1.001e3; d *= 10)
        for (int kind = 0; kind < SHAPES; kind++)
            for (int i = 0; i < 12; i++) {
                shape s = shape_of(kind);
                view v = random_view(&seed, d, 0.7);
                turn t = random_turn(&seed);
                double direction[3], away[3] = { 0, 0, 0 };
                random_direction(&seed, direction);
                vec3_add_scaled(away, away, offset, direction);
                apply_to_all(&t, scale, away, &s, &v);
                check_view(&c, &s, &v);
            }
    print_case(&c);
}

static void scenes_of_any_scale_are_good_to_ten_digits(void) {
    scaled("scale 1e-6", 1e-6, 0);
    scaled("scale 1e6", 1e6, 0);
    /* Squares and fourth powers of lengths leave the range of doubles here. */
    scaled("scale 1e-120", 1e-120, 0);
    scaled("scale 1e120", 1e120, 0);
}

static void scenes_far_from_the_origin_are_good_to_ten_digits(void) {
    scaled("offset 1e6 sizes", 1, 1e6);
    scaled("offset 1e9 of scale 1e3", 1e3, 1e9);
}

/* The polygon sticks out of the horizon, or lies above it, by little. */
static void views_along_the_horizon_are_good_to_ten_digits(void) {
    hard_case c = { .name = "1e-8 to 1e-1 above the horizon" };
    uint64_t seed = 5;
    for (double height = 1e-8; height < 0.2; height *= 10)
        for (int kind = 0; kind < SHAPES; kind++)
            for (int i = 0; i < 24; i++) {
                shape s = shape_of(kind);
                /* Upright in y, one unit away, its lower border at -1/2 or at 0. */
                for (size_t k = 0; k < s.count; k++) {
                    double y = s.corner[k][1], x = s.corner[k][0];
                    s.corner[k][0] = 1 + s.corner[k][2], s.corner[k][1] = x;
                    s.corner[k][2] = i % 2 ? height * (y + 0.5001) : y - 0.5 + height;
                }
                view v = { { random_between(&seed, -0.3, 0.3), random_between(&seed, -0.3, 0.3), 0 }, { 0, 0, 1 } };
                turn t = random_turn(&seed);
                if (i % 3) apply_to_all(&t, 1, NOWHERE, &s, &v);
                check_view(&c, &s, &v);
            }
    print_case(&c);
}

/* The point lies almost in the polygon's plane, beside it. */
static void views_along_the_plane_are_good_to_ten_digits(void) {
    hard_case c = { .name = "1e-9 to 1e-1 off the plane" };
    uint64_t seed = 6;
    for (double height = 1e-9; height < 0.2; height *= 10)
        for (int kind = 0; kind < SHAPES; kind++)
            for (int i = 0; i < 24; i++) {
                shape s = shape_of(kind);
                view v = { { random_between(&seed, 0.7, 3), random_between(&seed, -1, 1), height }, { -1, 0, 0.1 } };
                vec3_normalize(v.normal);
                turn t = random_turn(&seed);
                apply_to_all(&t, 1, NOWHERE, &s, &v);
                check_view(&c, &s, &v);
            }
    print_case(&c);
}

/* As near to the plane, an edge or a corner as rounding brings it after a turn; the corners themselves are off their
 * plane by as much. */
static void points_on_the_plane_to_rounding_are_good_to_ten_digits(void) {
    hard_case c = { .name = "on plane, edge, corner to rounding" };
    uint64_t seed = 7;
    for (int kind = 0; kind < SHAPES; kind++)
        for (int place = 0; place < 3; place++)
            for (int i = 0; i < 60; i++) {
                shape s = shape_of(kind);
                size_t a = (size_t)i % s.count, b = (a + 1) % s.count;
                double share = place == 0 ? 0.0 : random_between(&seed, 0, 1);
                view v;
                for (int k = 0; k < 3; k++) v.point[k] = (1 - share) * s.corner[a][k] + share * s.corner[b][k];
                if (place == 2) v.point[0] *= 0.3, v.point[1] *= 0.3;
                random_direction(&seed, v.normal);
                turn t = random_turn(&seed);
                apply_to_all(&t, 1, NOWHERE, &s, &v);
                check_view(&c, &s, &v);
            }
    print_case(&c);
}

/* ---- rules for what has no value ---- */

static void a_point_in_the_plane_sees_nothing(void) {
    uint64_t seed = 8;
    for (int kind = 0; kind < SHAPES; kind++) {
        if (kind == SADDLE) continue;
        shape s = shape_of(kind);
        for (int i = 0; i < 200; i++) {
            /* On corners, on edges (at halves: exact), inside, outside. */
            view v = { { random_between(&seed, -1, 1), random_between(&seed, -1, 1), 0 }, { 0, 0, 0 } };
            size_t corner = (size_t)i % s.count;
            if (i % 3 == 0) vec3_copy(v.point, s.corner[corner]);
            if (i % 3 == 1) vec3_mid(v.point, s.corner[corner], s.corner[(corner + 1) % s.count]);
            random_direction(&seed, v.normal);
            CHECK_NEAR(polygon_loop_factor(loop_of(&s), v.point, v.normal), 0.0, 0);
            CHECK_NEAR(polygon_loop_factor(loop_of(&s), v.point, (double[]){ 0, 0, -1 }), 0.0, 0);
        }
    }
}

static void bad_polygons_give_nothing(void) {
    static const double bad[] = { NAN, INFINITY, -INFINITY };
    const double up[3] = { 0, 0, 1 }, below[3] = { 0.1, 0.1, -1 };
    for (int b = 0; b < 3; b++)
        for (int k = 0; k < 3; k++) {
            shape s = shape_of(SQUARE);
            s.corner[2][k] = bad[b];
            CHECK_NEAR(polygon_loop_factor(loop_of(&s), below, up), 0.0, 0);
            s = shape_of(SQUARE);
            double point[3] = { 0.1, 0.1, -1 }, normal[3] = { 0, 0, 1 };
            point[k] = bad[b];
            CHECK_NEAR(polygon_loop_factor(loop_of(&s), point, up), 0.0, 0);
            normal[k] = bad[b];
            CHECK_NEAR(polygon_loop_factor(loop_of(&s), below, normal), 0.0, 0);
        }
    shape s = shape_of(SQUARE);
    for (s.count = 0; s.count < 3; s.count++) CHECK_NEAR(polygon_loop_factor(loop_of(&s), below, up), 0.0, 0);
    static const double line[4][3] = { { 0, 0, 0 }, { 1, 0.5, 0.25 }, { 2, 1, 0.5 }, { 0.5, 0.25, 0.125 } };
    CHECK_NEAR(polygon_loop_factor((polygon_loop){ line, 4 }, below, up), 0.0, 0);
    static const double dot[4][3] = { { 0, 0, 0 } };
    CHECK_NEAR(polygon_loop_factor((polygon_loop){ dot, 4 }, below, up), 0.0, 0);
    CHECK_NEAR(polygon_loop_factor((polygon_loop){ dot, 4 }, dot[0], up), 0.0, 0);
}

static void a_loop_that_crosses_itself_counts_its_windings(void) {
    /* A bow tie: one wing each way. */
    static const double bow[4][3] = { { -1, -1, 1 }, { 1, 1, 1 }, { 1, -1, 1 }, { -1, 1, 1 } };
    static const double left[3][3] = { { -1, -1, 1 }, { 0, 0, 1 }, { -1, 1, 1 } };
    static const double right[3][3] = { { 0, 0, 1 }, { 1, 1, 1 }, { 1, -1, 1 } };
    const double point[3] = { 0.3, 0.2, 0 }, up[3] = { 0, 0, 1 };
    double whole = polygon_loop_factor((polygon_loop){ bow, 4 }, point, up);
    double parts = polygon_loop_factor((polygon_loop){ left, 3 }, point, up) +
                   polygon_loop_factor((polygon_loop){ right, 3 }, point, up);
    CHECK(fabs(whole) > 0.01);
    /* Roundings of numbers below 1. */
    CHECK_NEAR(whole, parts, 1e-15);
}

int main(void) {
    RUN(benign_views_are_good_to_ten_digits);
    RUN(far_views_are_good_to_ten_digits);
    RUN(views_through_the_horizon_are_good_to_ten_digits);
    RUN(near_views_are_good_to_ten_digits);
    RUN(slivers_are_good_to_ten_digits);
    RUN(scenes_of_any_scale_are_good_to_ten_digits);
    RUN(scenes_far_from_the_origin_are_good_to_ten_digits);
    RUN(views_along_the_horizon_are_good_to_ten_digits);
    RUN(views_along_the_plane_are_good_to_ten_digits);
    RUN(points_on_the_plane_to_rounding_are_good_to_ten_digits);
    RUN(a_point_in_the_plane_sees_nothing);
    RUN(bad_polygons_give_nothing);
    RUN(a_loop_that_crosses_itself_counts_its_windings);
    return check_end();
}
