/* SPDX-License-Identifier: MIT
 * Do form factors obey the laws that hold whatever the shapes: closure, reciprocity, additivity, invariance? And are
 * their error estimates true: never below the error, and not far above what was asked for?
 */
#include "check.h"
#include "element_mean.h"
#include "factors/polygon_pair.h"
#include "geometry/vec3.h"

#include <stdbool.h>
#include <stdint.h>

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

static double area_of(const polygon *p) {
    double area[3];
    polygon_vector_area(p, area);
    return vec3_length(area);
}

static factor_estimate pair(const polygon *a, const polygon *b, double relative) {
    factor_request request = { .relative = relative, .absolute = relative * 1e-3 };
    return polygon_pair_factor(polygon_boundary(a), polygon_boundary(b), &request);
}

static factor_estimate mean(const polygon *a, const polygon *b, double relative) {
    factor_request request = { .relative = relative, .absolute = relative * 1e-3 };
    return element_mean(polygon_boundary(a), polygon_boundary(b), &request);
}

/* ---- enclosures ---- */

enum { FACES_MAX = 14 };

typedef struct body {
    polygon face[FACES_MAX];
    int count;
} body;

/* What random planes at distances around 1 leave of a cube; faces look inward. */
static body random_body(uint64_t *seed) {
    double normal[FACES_MAX][3], distance[FACES_MAX];
    body b = { .count = 6 + (int)random_between(seed, 0, 6) };
    for (int i = 0; i < b.count; i++) {
        for (int k = 0; k < 3; k++) normal[i][k] = i < 6 && i / 2 == k ? 1 - 2 * (i % 2) : 0;
        if (i >= 6) random_direction(seed, normal[i]);
        distance[i] = random_between(seed, 0.6, 1.2);
    }
    for (int i = 0; i < b.count; i++) {
        double u[3], v[3], helper[3] = { 0, 0, 0 }, inward[3] = { -normal[i][0], -normal[i][1], -normal[i][2] };
        helper[fabs(normal[i][0]) < 0.7 ? 0 : 1] = 1;
        vec3_cross(u, inward, helper);
        vec3_normalize(u);
        vec3_cross(v, inward, u);
        polygon p = { .count = 4 };
        for (int c = 0; c < 4; c++)
            for (int k = 0; k < 3; k++)
                p.corner[c][k] =
                    distance[i] * normal[i][k] + 9 * (c == 1 || c == 2 ? 1 : -1) * u[k] + 9 * (c >= 2 ? 1 : -1) * v[k];
        for (int j = 0; j < b.count; j++) {
            double other[3] = { -normal[j][0], -normal[j][1], -normal[j][2] };
            polygon cut;
            if (j != i) polygon_clip(&cut, &p, other, -distance[j]), p = cut;
        }
        b.face[i] = p;
    }
    return b;
}

static void the_rows_of_closed_bodies_sum_to_one(void) {
    uint64_t seed = 11;
    int faces = 0;
    double worst = 0.0, worst_estimate = 0.0;
    for (int n = 0; n < 12; n++) {
        body b = random_body(&seed);
        for (int i = 0; i < b.count; i++) {
            if (b.face[i].count < 3 || area_of(&b.face[i]) < 1e-6) continue;
            double row = 0.0, error = 0.0;
            for (int j = 0; j < b.count; j++) {
                if (j == i) continue;
                factor_estimate e = pair(&b.face[i], &b.face[j], 1e-9);
                CHECK(e.value >= -e.error && isfinite(e.value));
                row += e.value, error += e.error;
            }
            /* By their own estimates; what cutting the body's corners out of planes has rounded is 1e-15 of its
             * size, on faces down to 1e-3 of it. */
            CHECK_NEAR(row, 1.0, error + 1e-11);
            CHECK(error < 1e-8);
            worst = fmax(worst, fabs(row - 1)), worst_estimate = fmax(worst_estimate, error);
            faces++;
        }
    }
    CHECK(faces > 80);
    printf("closure of %d faces: worst %.1e, worst estimate %.1e\n", faces, worst, worst_estimate);
}

static void a_closed_body_closes_around_any_element_of_its_faces(void) {
    uint64_t seed = 12;
    for (int n = 0; n < 6; n++) {
        body b = random_body(&seed);
        const polygon *face = &b.face[n];
        if (face->count < 3 || area_of(face) < 1e-3) continue;
        /* A triangle from a corner, an edge's middle and the centroid: touches two neighbours. */
        polygon element = { .count = 3 };
        vec3_copy(element.corner[0], face->corner[0]);
        vec3_mid(element.corner[1], face->corner[0], face->corner[1]);
        polygon_centroid(face, element.corner[2]);
        double row = 0.0, error = 0.0;
        for (int j = 0; j < b.count; j++) {
            factor_estimate e = j == n ? (factor_estimate){ 0 } : mean(&element, &b.face[j], 1e-8);
            row += e.value, error += e.error;
        }
        CHECK_NEAR(row, 1.0, error + 1e-11);
        CHECK(error < 1e-7);
    }
}

/* ---- pairs ---- */

enum { APART, SHARED_EDGE, SHARED_CORNER, CORNER_ON_EDGE, FOOT_INSIDE, PIERCED, ALMOST_COPLANAR, FAR, KINDS };

static const char *const KIND_NAMES[KINDS] = { "apart",       "shared edge", "shared corner",   "corner on edge",
                                               "foot inside", "pierced",     "almost coplanar", "far" };

/* A triangle or a quad in the plane z = 0, front up, within the unit square; and another one. */
static void random_pair(uint64_t *seed, int kind, polygon *a, polygon *b) {
    double bend = random_between(seed, 0.3, 2.8), along = random_between(seed, 0.2, 0.5);
    *a =
        (polygon){ { { 0, 0, 0 }, { 1, 0, 0 }, { random_between(seed, 0.6, 1), random_between(seed, 0.5, 1), 0 } }, 3 };
    if (random_between(seed, 0, 1) < 0.5)
        vec3_copy(a->corner[3], (double[]){ 0, random_between(seed, 0.4, 1), 0 }), a->count = 4;
    double from[3] = { 1, 0, 0 }, to[3] = { 0, 0, 0 }, up = 0.0;
    if (kind == ALMOST_COPLANAR) bend = 3.14;
    if (kind == CORNER_ON_EDGE) from[0] = along, to[0] = along - 0.7, to[1] = -0.6;
    if (kind == SHARED_CORNER) from[0] = 0, to[0] = -0.6, to[1] = -0.4;
    if (kind == FOOT_INSIDE) from[0] = 0.8, from[1] = 0.2, to[0] = 0.5, to[1] = 0.25;
    if (kind == PIERCED) from[0] = 1.2, from[1] = 0.15, to[0] = -0.3, to[1] = 0.2, up = -0.3;
    if (kind == APART) from[1] = to[1] = -0.4, up = random_between(seed, 0.1, 0.5);
    if (kind == FAR) from[1] = to[1] = -60, from[2] = to[2] = 30;
    double edge[3], across[3] = { 0, 0, 0 }, side[3];
    vec3_sub(edge, to, from);
    /* Leans over a: its front looks to where a lies, left of from -> to seen from above. */
    vec3_copy(side, (double[]){ edge[1], -edge[0], 0 });
    vec3_normalize(side);
    for (int k = 0; k < 3; k++) across[k] = -cos(bend) * side[k] * -1 + (k == 2 ? sin(bend) : 0);
    double height = random_between(seed, 0.3, 1);
    *b = (polygon){ .count = 4 };
    vec3_copy(b->corner[0], to);
    vec3_copy(b->corner[1], from);
    vec3_add_scaled(b->corner[2], from, height, across);
    vec3_add_scaled(b->corner[3], to, height, across);
    for (int i = 0; i < 4; i++)
        vec3_add_scaled(b->corner[i], b->corner[i], up, kind == PIERCED ? across : (double[]){ 0, 0, 1 });
}

static polygon reversed(const polygon *p) {
    polygon out = { .count = p->count };
    for (int i = 0; i < p->count; i++) vec3_copy(out.corner[i], p->corner[p->count - 1 - i]);
    return out;
}

/* Either side of b sees a, or none. */
static void random_seeing_pair(uint64_t *seed, int kind, polygon *a, polygon *b) {
    random_pair(seed, kind, a, b);
    if (pair(a, b, 1e-4).value <= 1e-9) *b = reversed(b);
}

static void reciprocity_holds_within_the_errors(void) {
    uint64_t seed = 21;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 25; i++) {
            polygon a, b;
            random_seeing_pair(&seed, kind, &a, &b);
            factor_estimate there = pair(&a, &b, 1e-9), back = pair(&b, &a, 1e-9);
            double A = area_of(&a), B = area_of(&b);
            CHECK(there.converged && back.converged);
            CHECK_NEAR(A * there.value, B * back.value, A * there.error + B * back.error);
        }
}

static void outline_and_area_agree_within_the_errors(void) {
    uint64_t seed = 22;
    for (int kind = 0; kind < KINDS; kind++) {
        size_t outline = 0, area = 0;
        double lowest = 1.0, highest = 0.0;
        for (int i = 0; i < 25; i++) {
            polygon a, b;
            random_seeing_pair(&seed, kind, &a, &b);
            factor_estimate one = pair(&a, &b, 1e-8), other = mean(&a, &b, 1e-8);
            CHECK(one.converged && other.converged);
            CHECK_NEAR(one.value, other.value, one.error + other.error);
            outline += one.evaluations, area += other.evaluations;
            lowest = fmin(lowest, one.value), highest = fmax(highest, one.value);
        }
        printf("%-16s F %.1e .. %.1e, to 1e-8: %6zu points of the outline, %7zu of the area\n", KIND_NAMES[kind],
               lowest, highest, outline / 25, area / 25);
        CHECK(highest > 0.0);
    }
}

/* The estimate must hold for every request, and must not be so large that it says nothing. */
static void check_estimates(factor_estimate (*method)(const polygon *, const polygon *, double), uint64_t seed) {
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 12; i++) {
            polygon a, b;
            random_seeing_pair(&seed, kind, &a, &b);
            factor_estimate best = method(&a, &b, 1e-11);
            for (double asked = 1e-2; asked > 1e-10; asked *= 0.1) {
                factor_estimate e = method(&a, &b, asked);
                CHECK(e.converged);
                CHECK_NEAR(e.value, best.value, e.error + best.error);
                CHECK(e.error <= asked * fmax(fabs(e.value), 1e-3));
                CHECK(e.evaluations <= best.evaluations);
            }
        }
}

static void estimates_hold_for_every_request(void) {
    check_estimates(pair, 23);
    check_estimates(mean, 24);
}

/* Between the points of any rule in its first step lie a low wall, a small box side in the middle, a small tile above.
 */
static void what_hides_between_points_is_found_or_admitted(void) {
    const polygon floor = { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4 };
    for (double size = 0.1; size > 1e-5; size *= 0.3) {
        const polygon hidden[3] = {
            { { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, size }, { 0, 0, size } }, 4 },
            { { { 0.43, 0.37, 0 }, { 0.43, 0.37 + size, 0 }, { 0.43, 0.37 + size, size }, { 0.43, 0.37, size } }, 4 },
            { { { 0.61, 0.67, size },
                { 0.61, 0.67 + size, size },
                { 0.61 + size, 0.67 + size, size },
                { 0.61 + size, 0.67, size } },
              4 },
        };
        for (int i = 0; i < 3; i++) {
            /* From the small one everything is smooth: reciprocity gives the value. */
            factor_estimate back = pair(&hidden[i], &floor, 1e-9);
            double exact = back.value * area_of(&hidden[i]);
            for (double asked = 1e-1; asked > 1e-6; asked *= 0.1) {
                factor_request request = { .relative = asked, .evaluations_max = 20000 };
                const factor_estimate e[] = {
                    polygon_pair_factor(polygon_boundary(&floor), polygon_boundary(&hidden[i]), &request),
                    element_mean(polygon_boundary(&floor), polygon_boundary(&hidden[i]), &request)
                };
                for (int k = 0; k < 2; k++)
                    CHECK_NEAR(e[k].value, exact, e[k].error + back.error * area_of(&hidden[i]));
                CHECK(e[0].converged);
            }
        }
    }
}

static void an_estimate_that_ran_out_says_so(void) {
    uint64_t seed = 25;
    for (int kind = 0; kind < KINDS; kind++) {
        polygon a, b;
        random_seeing_pair(&seed, kind, &a, &b);
        factor_request request = { .relative = 1e-14, .evaluations_max = 200 };
        factor_estimate best = pair(&a, &b, 1e-10),
                        e = element_mean(polygon_boundary(&a), polygon_boundary(&b), &request);
        CHECK(!e.converged || e.error <= 1e-14 * e.value);
        /* The first step, and one more that splits each. */
        CHECK(e.evaluations < 200 + 20 * 74);
        CHECK_NEAR(e.value, best.value, e.error + best.error);
    }
}

static void parts_add_up_to_the_whole(void) {
    uint64_t seed = 26;
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 6; i++) {
            polygon a, b, part[4];
            random_seeing_pair(&seed, kind, &a, &b);
            factor_estimate whole = pair(&a, &b, 1e-9);
            double to_parts = 0.0, from_parts = 0.0, error = whole.error, error_from = whole.error;
            polygon_quarter(&b, part);
            for (int q = 0; q < 4; q++) {
                factor_estimate e = pair(&a, &part[q], 1e-9);
                to_parts += e.value, error += e.error;
            }
            polygon_quarter(&a, part);
            for (int q = 0; q < 4; q++) {
                factor_estimate e = pair(&part[q], &b, 1e-9);
                double share = area_of(&part[q]) / area_of(&a);
                from_parts += share * e.value, error_from += share * e.error;
            }
            /* Corners of parts are off by 1e-16; where parts touch the other polygon or its plane, as much of them
             * changes sides. */
            CHECK_NEAR(to_parts, whole.value, error + 1e-14);
            CHECK_NEAR(from_parts, whole.value, error_from + 1e-14);
        }
}

static void moving_turning_and_scaling_change_nothing(void) {
    uint64_t seed = 27;
    static const double scales[] = { 1e-6, 1, 1e6 }, offsets[] = { 0, 10, 1e6 };
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 9; i++) {
            polygon a, b;
            random_seeing_pair(&seed, kind, &a, &b);
            factor_estimate before = pair(&a, &b, 1e-9);
            double x[3], y[3], z[3], helper[3], scale = scales[i % 3], offset = offsets[i / 3];
            random_direction(&seed, x);
            do random_direction(&seed, helper);
            while (fabs(vec3_dot(x, helper)) > 0.9);
            vec3_cross(y, x, helper);
            vec3_normalize(y);
            vec3_cross(z, x, y);
            polygon *both[2] = { &a, &b };
            for (int p = 0; p < 2; p++)
                for (int c = 0; c < both[p]->count; c++) {
                    double *at = both[p]->corner[c], t[3] = { vec3_dot(x, at), vec3_dot(y, at), vec3_dot(z, at) };
                    for (int k = 0; k < 3; k++) at[k] = scale * (t[k] + offset * (k + 1));
                }
            factor_estimate after = pair(&a, &b, 1e-9);
            /* Coordinates are rounded to 2e-16 of the offset, of which polygons that are almost coplanar or small in
             * the distance make a thousand times as much of their factors. */
            CHECK_NEAR(after.value, before.value, after.error + before.error + 1e3 * 2.3e-16 * (3 * offset + 1));
            CHECK(after.error < 1e-6);
        }
}

/* ---- rules ---- */

static void bad_polygons_give_nothing_and_say_so(void) {
    const polygon square = { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4 };
    polygon bad[6];
    for (int i = 0; i < 6; i++) bad[i] = (polygon){ { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } }, 4 };
    bad[0].corner[1][2] = NAN;
    bad[1].corner[3][0] = INFINITY;
    bad[2].count = 2;
    bad[3].count = 0;
    for (int i = 0; i < 4; i++) bad[4].corner[i][0] = bad[4].corner[i][1] = i;
    for (int i = 0; i < 4; i++) vec3_copy(bad[5].corner[i], bad[5].corner[0]);
    for (int i = 0; i < 6; i++) {
        const factor_estimate e[] = { pair(&square, &bad[i], 1e-6), pair(&bad[i], &square, 1e-6),
                                      mean(&square, &bad[i], 1e-6), mean(&bad[i], &square, 1e-6) };
        for (int k = 0; k < 4; k++) {
            CHECK_NEAR(e[k].value, 0.0, 0);
            CHECK_NEAR(e[k].error, 0.0, 0);
        }
    }
    /* Bent: a value, and an error that promises nothing. */
    polygon bent = { { { 0, 0, 1 }, { 0, 1, 1.3 }, { 1, 1, 1 }, { 1, 0, 1.3 } }, 4 };
    const factor_estimate e[] = { pair(&square, &bent, 1e-6), mean(&square, &bent, 1e-6), pair(&bent, &square, 1e-6) };
    for (int k = 0; k < 3; k++) {
        CHECK(!e[k].converged && e[k].error >= 1.0);
        CHECK(e[k].value >= 0.0 && e[k].value <= 1.0);
    }
}

static void a_polygon_that_is_not_convex_is_the_sum_of_its_parts(void) {
    const polygon ell = { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 0.3, 0 }, { 0.4, 0.3, 0 }, { 0.4, 1, 0 }, { 0, 1, 0 } }, 6 };
    const polygon foot = { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 0.3, 0 }, { 0, 0.3, 0 } }, 4 };
    const polygon leg = { { { 0, 0.3, 0 }, { 0.4, 0.3, 0 }, { 0.4, 1, 0 }, { 0, 1, 0 } }, 4 };
    /* Near, through the inner corner, and far. */
    const polygon others[3] = {
        { { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 0, 0, 1 } }, 4 },
        { { { 0.4, 0.3, 0 }, { 0.9, 0.8, 0 }, { 0.9, 0.8, 1 }, { 0.4, 0.3, 1 } }, 4 },
        { { { 9, 9, 30 }, { 9, 10, 30 }, { 10, 10, 30 }, { 10, 9, 30 } }, 4 },
    };
    for (int i = 0; i < 3; i++) {
        factor_estimate whole = pair(&ell, &others[i], 1e-9), back = pair(&others[i], &ell, 1e-9);
        factor_estimate first = pair(&foot, &others[i], 1e-9), second = pair(&leg, &others[i], 1e-9);
        double A = area_of(&ell), sum = area_of(&foot) * first.value + area_of(&leg) * second.value;
        CHECK(whole.converged && whole.value > 0.0);
        CHECK_NEAR(A * whole.value, sum, A * whole.error + first.error + second.error);
        CHECK_NEAR(area_of(&others[i]) * back.value, sum, back.error + first.error + second.error);
        /* A fan over it would reach beyond it: nothing is promised, unless it is far, or what is in front is convex. */
        factor_estimate over = mean(&ell, &others[i], 1e-9);
        CHECK(over.converged == (i > 0) && (i > 0 || over.error >= 1.0));
    }
}

static void repeated_and_straight_corners_change_nothing(void) {
    const polygon floor = { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4 };
    const polygon wall = { { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 0, 0, 1 } }, 4 };
    const polygon same = {
        { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0.25, 0 }, { 0, 1, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 0, 0.5, 1 }, { 0, 0, 1 } },
        8
    };
    factor_estimate e = pair(&floor, &wall, 1e-11);
    const factor_estimate others[] = { pair(&floor, &same, 1e-11), pair(&same, &floor, 1e-11),
                                       mean(&floor, &same, 1e-9), mean(&same, &floor, 1e-9) };
    for (int k = 0; k < 4; k++) CHECK_NEAR(others[k].value, e.value, e.error + others[k].error);
}

int main(void) {
    RUN(the_rows_of_closed_bodies_sum_to_one);
    RUN(a_closed_body_closes_around_any_element_of_its_faces);
    RUN(reciprocity_holds_within_the_errors);
    RUN(outline_and_area_agree_within_the_errors);
    RUN(estimates_hold_for_every_request);
    RUN(what_hides_between_points_is_found_or_admitted);
    RUN(an_estimate_that_ran_out_says_so);
    RUN(parts_add_up_to_the_whole);
    RUN(moving_turning_and_scaling_change_nothing);
    RUN(bad_polygons_give_nothing_and_say_so);
    RUN(a_polygon_that_is_not_convex_is_the_sum_of_its_parts);
    RUN(repeated_and_straight_corners_change_nothing);
    return check_end();
}
