/* SPDX-License-Identifier: MIT
 * Is the form factor of an emitter that is seen in part what it should be? Judged by shadows whose edges are known: the
 * visible part is then a rectangle, whose factor has a closed form of its own, written here without the code under
 * test.
 */
#include "check.h"
#include "formfactor/emitter_visibility.h"
#include "item_rays.h"
#include "room.h"
#include "visibility/occlusion.h"

static const double UP[3] = { 0, 0, 1 };

/* ---- oracles ---- */

/* The factor from a small area to a parallel rectangle whose corner is right above it, sides a, b, distance c
 * (the double integral of cos cos / (pi r2), as in hemicube_weights.h). Odd in a and in b. */
static double corner_factor(double a, double b, double c) {
    double x = sqrt(a * a + c * c), y = sqrt(b * b + c * c);
    return (a / x * atan(b / x) + b / y * atan(a / y)) / (2 * PI);
}

/* To the rectangle low .. high at height c, from the origin of a plane that looks up; nothing where it is inside out.
 */
static double rectangle_factor(double x0, double x1, double y0, double y1, double c) {
    if (x0 >= x1 || y0 >= y1) return 0.0;
    return corner_factor(x1, y1, c) - corner_factor(x0, y1, c) - corner_factor(x1, y0, c) + corner_factor(x0, y0, c);
}

static polygon rectangle(double x0, double y0, double x1, double y1, double z) {
    return (polygon){ { { x0, y0, z }, { x1, y0, z }, { x1, y1, z }, { x0, y1, z } }, 4 };
}

static polygon facing_down(double x0, double y0, double x1, double y1, double z) {
    return (polygon){ { { x0, y0, z }, { x0, y1, z }, { x1, y1, z }, { x1, y0, z } }, 4 };
}

/* Past all surfaces of the room. */
static double seen_factor(const room *r, const polygon *light, const double point[3], const double normal[3]) {
    double factor = NAN;
    CHECK(emitter_visibility_exact(&r->scene, NULL, 0, light, point, normal, &factor));
    return factor;
}

static void add_plate(room *r, double x0, double y0, double x1, double y1, double z) {
    room_quad(r, (double[]){ x0, y0, z }, (double[]){ x1 - x0, 0, 0 }, (double[]){ 0, y1 - y0, 0 }, 0, 1, 1);
}

static void start(room *r) {
    room_start(r);
    room_material(r, 0.5, 0);
}

/* ---- a half plane before a square light ---- */

/* Light: -1..1 squared at z = 2. Blocker: all of x < 0 at z = 1, as far as it can matter. A point at x sees the light
 * from -x on. */
static void make_half_plane(room *r) {
    start(r);
    add_plate(r, -60, -60, 0, 60, 1);
    room_finish(r);
}

static double half_plane_factor(double x, double y) {
    return rectangle_factor(fmax(-1, -x) - x, 1 - x, -1 - y, 1 - y, 2);
}

static double free_factor(double x, double y) {
    return rectangle_factor(-1 - x, 1 - x, -1 - y, 1 - y, 2);
}

static void a_point_behind_a_half_plane_sees_the_light_clipped_by_the_shadow_plane(void) {
    room r;
    make_half_plane(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    for (double x = -1.5; x <= 1.5; x += 0.1)
        for (double y = -1.4; y <= 1.5; y += 0.37) {
            double factor = seen_factor(&r, &light, (double[]){ x, y, 0 }, UP);
            double all = free_factor(x, y), seen = half_plane_factor(x, y);
            /* The blocker's corners are exact; what remains is rounding. */
            CHECK_NEAR(factor, seen, 1e-13);
            CHECK(factor <= all + 1e-13);
        }
    room_free(&r);
}

/* ---- many blockers ---- */

/* Slats: stripe k of `count` over the light's width is open on its left half. Exact from every point. */
static void a_blind_of_many_slats_is_exact(void) {
    enum { SLATS = 60 };
    room r;
    start(&r);
    for (int k = 0; k < SLATS; k++) add_plate(&r, -1 + (2 * k + 1.0) / SLATS, -9, -1 + (2 * k + 2.0) / SLATS, 9, 1);
    room_finish(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    for (double x = -0.5; x <= 0.5; x += 0.17) {
        double seen = 0.0;
        double factor = seen_factor(&r, &light, (double[]){ x, 0.1, 0 }, UP);
        /* Openings, and what is beside the blind on both sides, thrown from z = 1 to z = 2. */
        for (int k = -1; k <= SLATS; k++) {
            double low = k < 0 ? -99 : -1 + 2.0 * k / SLATS, high = k == SLATS ? 99 : -1 + (2 * k + 1.0) / SLATS;
            if (k < 0) high = -1;
            seen += rectangle_factor(fmax(2 * low - x, -1) - x, fmin(2 * high - x, 1) - x, -1 - 0.1, 1 - 0.1, 2);
        }
        /* 60 fragments, each with a few roundings of its share. */
        CHECK_NEAR(factor, seen, 1e-12);
    }
    room_free(&r);
}

/* Crossed slats: openings of a grid, GRID x GRID of them, more fragments than visible_part.c has room for. */
static void a_grid_of_crossed_slats_is_exact(void) {
    enum { GRID = 25 };
    room r;
    start(&r);
    for (int k = 0; k < GRID; k++) {
        double low = -2 + (4 * k + 2.0) / GRID, high = -2 + (4 * k + 4.0) / GRID;
        add_plate(&r, low, -9, high, 9, 1);
        add_plate(&r, -9, low, 9, high, 1);
    }
    room_finish(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    for (double x = -0.5; x <= 0.5; x += 0.3) {
        const double y = 0.1;
        double seen = 0.0;
        double factor = seen_factor(&r, &light, (double[]){ x, y, 0 }, UP);
        for (int i = 0; i < GRID * GRID; i++) {
            double u = -2 + 4.0 * (i % GRID) / GRID, w = -2 + 4.0 * (i / GRID) / GRID, d = 2.0 / GRID;
            seen += rectangle_factor(fmax(2 * u - x, -1) - x, fmin(2 * (u + d) - x, 1) - x, fmax(2 * w - y, -1) - y,
                                     fmin(2 * (w + d) - y, 1) - y, 2);
        }
        /* What is lost of a millionth-wide slit between the slats and the planes' margins. */
        CHECK_NEAR(factor, seen, 1e-6);
    }
    room_free(&r);
}

/* A point sees sample (u, v) of the light when no surface is crossed. */
static double sampled_fraction(const room *r, const polygon *light, const double point[3], const double normal[3],
                               const double light_normal[3], int n) {
    double all = 0.0, seen = 0.0;
    for (int i = 0; i < n * n; i++) {
        double to[3], ray[3], t, u = (i % n + 0.5) / n, v = (i / n + 0.5) / n;
        bool hidden = false;
        for (int k = 0; k < 3; k++)
            to[k] = light->corner[0][k] + u * (light->corner[1][k] - light->corner[0][k]) +
                    v * (light->corner[3][k] - light->corner[0][k]);
        vec3_sub(ray, to, point);
        double r2 = vec3_dot(ray, ray), weight = vec3_dot(ray, normal) * -vec3_dot(ray, light_normal) / (r2 * r2);
        if (weight <= 0.0 || vec3_dot(ray, normal) <= 0.0) continue;
        for (size_t f = 0; f < r->surface_count && !hidden; f++)
            hidden = occlusion_crossing(&r->surfaces[f], point, to, &t) && t > 0 && t < 1 &&
                     occlusion_inside(&r->scene, &r->surfaces[f], point, to, t);
        all += weight;
        seen += hidden ? 0.0 : weight;
    }
    return all > 0.0 ? seen / all : 0.0;
}

static void random_plates(room *r, int count, uint64_t *state) {
    start(r);
    for (int i = 0; i < count; i++) {
        double a[3], u[3], v[3], size = random_in(state, 0.05, 0.5);
        for (int k = 0; k < 3; k++) a[k] = random_in(state, -1, 1);
        a[2] = random_in(state, 0.3, 1.7);
        random_direction(state, u);
        random_direction(state, v);
        for (int k = 0; k < 3; k++) u[k] *= size, v[k] *= size;
        room_quad(r, a, u, v, 0, 1, 1);
    }
    room_finish(r);
}

static void points_among_random_plates_agree_with_rays(void) {
    enum { RAYS = 200 };
    uint64_t state = 11;
    polygon light = facing_down(-0.5, -0.6, 0.7, 0.4, 2);
    double mean = 0.0;
    for (int i = 0; i < 40; i++) {
        room r;
        random_plates(&r, 2 + 3 * i % 60, &state);
        double point[3] = { random_in(&state, -1, 1), random_in(&state, -1, 1), 0 }, normal[3];
        do random_direction(&state, normal);
        while (normal[2] < 0.3);
        double factor = seen_factor(&r, &light, point, normal);
        double sampled = sampled_fraction(&r, &light, point, normal, (double[]){ 0, 0, -1 }, RAYS);
        /* Rays are off by up to half a cell along a shadow's edge that runs along their grid, 1/400 of the light for an
         * edge as long as the light, and two such edges are allowed for. With 1200 x 1200 rays all 40 agree to 3e-4. */
        double share = factor / polygon_factor(&light, point, normal);
        CHECK_NEAR(share, sampled, 5e-3);
        mean += share / 40;
        room_free(&r);
    }
    printf("random plates: %.2f visible in the mean\n", mean);
    CHECK(mean > 0.1 && mean < 0.9);
}

/* ---- ends of the scale ---- */

static void a_hidden_light_gives_zero_and_a_free_one_gives_all(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2);
    const double point[3] = { 0, 0, 0 };
    room r;
    start(&r);
    add_plate(&r, -9, -9, 9, 9, 1);
    room_finish(&r);
    CHECK_NEAR(seen_factor(&r, &light, point, UP), 0, 0);
    room_free(&r);
    start(&r);
    add_plate(&r, -9, -9, 9, 9, 2.5);  /* behind the light */
    add_plate(&r, -9, -9, 9, 9, -0.5); /* below the point */
    add_plate(&r, 5, 5, 6, 6, 1);      /* beside both */
    add_plate(&r, -1, -1, 1, 1, 2);    /* the light's own surface */
    add_plate(&r, -0.5, -0.5, 0.5, 0.5, 0);
    room_finish(&r);
    CHECK_NEAR(seen_factor(&r, &light, point, UP), polygon_factor(&light, point, UP), 0);
    room_free(&r);
}

static void what_faces_away_sees_nothing(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2), turned = rectangle(-1, -1, 1, 1, 2);
    const double point[3] = { 0, 0, 0 };
    room r;
    make_half_plane(&r);
    CHECK_NEAR(seen_factor(&r, &turned, point, UP), 0, 0);
    CHECK_NEAR(seen_factor(&r, &light, point, (double[]){ 0, 0, -1 }), 0, 0);
    room_free(&r);
}

/* A fence stands on the receiver's plane beside the element, and another hangs from the light. */
static void blockers_that_touch_receiver_or_shooter_count(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2);
    room r;
    start(&r);
    room_quad(&r, (double[]){ -0.5, -9, 0 }, (double[]){ 0, 18, 0 }, (double[]){ 0, 0, 1 }, 0, 1, 1);
    room_quad(&r, (double[]){ 0.25, -9, 1.5 }, (double[]){ 0, 18, 0 }, (double[]){ 0, 0, 0.5 }, 0, 1, 1);
    room_finish(&r);
    /* From the origin: the fence at x = -0.5 up to z = 1 hides x < -1 at z = 2, none of the light; from x = -0.3 it
     * hides x < -0.7. What hangs at 0.25 from z = 1.5 to 2 hides the light from 0.25 to where its lower edge is thrown,
     * x + (0.25 - x) 2 / 1.5. */
    for (double x = -0.45; x < 0.2; x += 0.1) {
        double fence = x + (-0.5 - x) * 2, lower = x + (0.25 - x) * 2 / 1.5;
        double seen =
            rectangle_factor(fmax(fence, -1) - x, 0.25 - x, -1, 1, 2) + rectangle_factor(lower - x, 1 - x, -1, 1, 2);
        double factor = seen_factor(&r, &light, (double[]){ x, 0, 0 }, UP);
        /* Light leaks under what stands on a plane, TOLERANCE_PLANE of the scene: a slit of that width. */
        CHECK_NEAR(factor, seen, 1e-5);
    }
    room_free(&r);
}

int main(void) {
    RUN(a_point_behind_a_half_plane_sees_the_light_clipped_by_the_shadow_plane);
    RUN(a_blind_of_many_slats_is_exact);
    RUN(a_grid_of_crossed_slats_is_exact);
    RUN(points_among_random_plates_agree_with_rays);
    RUN(a_hidden_light_gives_zero_and_a_free_one_gives_all);
    RUN(what_faces_away_sees_nothing);
    RUN(blockers_that_touch_receiver_or_shooter_count);
    return check_end();
}
