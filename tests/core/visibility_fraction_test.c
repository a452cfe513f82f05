/* SPDX-License-Identifier: MIT
 * Is the visible fraction of a shooter what it should be, and is its error what it says? Judged by shadows whose edges
 * are known: the visible part is then a rectangle, or a light less a rectangle, whose factor has a closed form of its
 * own, written here without the code under test.
 */
#include "check.h"
#include "formfactor/visible_fraction.h"
#include "item_rays.h"
#include "room.h"
#include "visibility/occlusion.h"

static const double PI = 3.14159265358979323846;
static const double UP[3] = { 0, 0, 1 };
static const visible_effort EFFORT = { 1e-4, 4000000 };

/* ---- oracles
 * --------------------------------------------------------------------------------------------------------- */

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

/* Gauss-Legendre, 8 points on [-1, 1] (Abramowitz & Stegun 1964, table 25.4). */
static const double GAUSS_X[4] = { 0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623 };
static const double GAUSS_W[4] = { 0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626 };

typedef double (*plane_function)(const void *user, double x, double y);

/* Over breaks[0] .. breaks[n-1] in both directions, 4 panels between breaks: 1e-12 for integrands that are smooth
 * between them on the scale of a panel. */
static double gauss(plane_function f, const void *user, const double *x_breaks, int nx, const double *y_breaks,
                    int ny) {
    double sum = 0.0;
    for (int i = 0; i < 4 * (nx - 1); i++)
        for (int j = 0; j < 4 * (ny - 1); j++) {
            double hx = (x_breaks[i / 4 + 1] - x_breaks[i / 4]) / 8, hy = (y_breaks[j / 4 + 1] - y_breaks[j / 4]) / 8;
            double mx = x_breaks[i / 4] + (2 * (i % 4) + 1) * hx, my = y_breaks[j / 4] + (2 * (j % 4) + 1) * hy;
            for (int p = 0; p < 8; p++)
                for (int q = 0; q < 8; q++)
                    sum += hx * hy * GAUSS_W[p / 2] * GAUSS_W[q / 2] *
                           f(user, mx + (p % 2 ? -hx : hx) * GAUSS_X[p / 2], my + (q % 2 ? -hy : hy) * GAUSS_X[q / 2]);
        }
    return sum;
}

static polygon rectangle(double x0, double y0, double x1, double y1, double z) {
    return (polygon){ { { x0, y0, z }, { x1, y0, z }, { x1, y1, z }, { x0, y1, z } }, 4 };
}

static polygon facing_down(double x0, double y0, double x1, double y1, double z) {
    return (polygon){ { { x0, y0, z }, { x0, y1, z }, { x1, y1, z }, { x1, y0, z } }, 4 };
}

static void add_plate(room *r, double x0, double y0, double x1, double y1, double z) {
    room_quad(r, (double[]){ x0, y0, z }, (double[]){ x1 - x0, 0, 0 }, (double[]){ 0, y1 - y0, 0 }, 0, 1, 1);
}

static void start(room *r) {
    room_start(r);
    room_material(r, 0.5, 0);
}

/* What must hold of every result: an honest estimate, not absurdly large. */
static void check_estimate(const visible_fraction *v, double exact, const visible_effort *effort) {
    CHECK_NEAR(v->fraction, exact, v->error);
    CHECK(v->converged == (v->error <= effort->tolerance));
    CHECK(v->fraction >= 0 && v->fraction <= 1);
}

/* ---- a half plane before a square light
 * ------------------------------------------------------------------------------- */

/* Light: -1..1 squared at z = 2. Blocker: all of x < 0 at z = 1, as far as it can matter. A point at x sees the light
 * from -x on. */
static void make_half_plane(room *r) {
    start(r);
    add_plate(r, -60, -60, 0, 60, 1);
    room_finish(r);
}

static double half_plane_factor(const void *user, double x, double y) {
    (void)user;
    return rectangle_factor(fmax(-1, -x) - x, 1 - x, -1 - y, 1 - y, 2);
}

static double free_factor(const void *user, double x, double y) {
    (void)user;
    return rectangle_factor(-1 - x, 1 - x, -1 - y, 1 - y, 2);
}

static void a_point_behind_a_half_plane_sees_the_light_clipped_by_the_shadow_plane(void) {
    room r;
    make_half_plane(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    for (double x = -1.5; x <= 1.5; x += 0.1)
        for (double y = -1.4; y <= 1.5; y += 0.37) {
            visible_fraction v;
            CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ x, y, 0 }, UP, &v));
            double all = free_factor(NULL, x, y), seen = half_plane_factor(NULL, x, y);
            /* The blocker's corners are exact; what remains is rounding. */
            CHECK_NEAR(v.unoccluded, all, 1e-14);
            CHECK_NEAR(v.factor, seen, 1e-13);
            CHECK_NEAR(v.fraction, seen / all, v.error);
            CHECK_NEAR(v.error, 0, 1e-5);
        }
    room_free(&r);
}

static void an_element_in_penumbra_converges_to_the_closed_form(void) {
    const double x_breaks[] = { -0.4, 0.8 }, y_breaks[] = { -0.3, 0.5 };
    const double wide_x[] = { -1.7, -1, 1, 1.4 }, wide_y[] = { -0.9, 0.5 };
    room r;
    make_half_plane(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    polygon inside = rectangle(-0.4, -0.3, 0.8, 0.5, 0), across = rectangle(-1.7, -0.9, 1.4, 0.5, 0);
    double exact_inside =
        gauss(half_plane_factor, NULL, x_breaks, 2, y_breaks, 2) / gauss(free_factor, NULL, x_breaks, 2, y_breaks, 2);
    double exact_across =
        gauss(half_plane_factor, NULL, wide_x, 4, wide_y, 2) / gauss(free_factor, NULL, wide_x, 4, wide_y, 2);
    for (double tolerance = 1e-1; tolerance > 5e-6; tolerance /= 10) {
        const visible_effort effort = { tolerance, 4000000 };
        visible_fraction a, b;
        CHECK(visible_fraction_of_element(&r.scene, &light, &inside, &effort, &a));
        CHECK(visible_fraction_of_element(&r.scene, &light, &across, &effort, &b));
        printf("half plane, tolerance %.0e: inside %.1e of %.1e in %llu; across %.1e of %.1e in %llu\n", tolerance,
               fabs(a.fraction - exact_inside), a.error, (unsigned long long)a.evaluations,
               fabs(b.fraction - exact_across), b.error, (unsigned long long)b.evaluations);
        check_estimate(&a, exact_inside, &effort);
        check_estimate(&b, exact_across, &effort);
        CHECK(a.converged && b.converged);
    }
    room_free(&r);
}

/* The error at a given effort falls at least with the first power of the evaluations: kinks run along lines, cells on
 * them halve in size and their number doubles while the others are done (second order of the cell size). */
static void the_error_falls_with_the_evaluations(void) {
    const double x_breaks[] = { -1.7, -1, 1, 1.4 }, y_breaks[] = { -0.9, 0.5 };
    room r;
    make_half_plane(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2), receiver = rectangle(-1.7, -0.9, 1.4, 0.5, 0);
    double exact =
        gauss(half_plane_factor, NULL, x_breaks, 4, y_breaks, 2) / gauss(free_factor, NULL, x_breaks, 4, y_breaks, 2);
    double first = 0, last = 0, first_evaluations = 0, last_evaluations = 0;
    for (uint64_t limit = 1000; limit <= 256000; limit *= 4) {
        const visible_effort effort = { 1e-9, limit };
        visible_fraction v;
        CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &effort, &v));
        check_estimate(&v, exact, &effort);
        CHECK(!v.converged && v.evaluations <= 2 * limit);
        printf("%8llu evaluations: off by %.2e, reported %.2e\n", (unsigned long long)v.evaluations,
               fabs(v.fraction - exact), v.error);
        if (limit == 1000) first = v.error, first_evaluations = (double)v.evaluations;
        last = v.error, last_evaluations = (double)v.evaluations;
    }
    double order = log(first / last) / log(last_evaluations / first_evaluations);
    printf("order of the reported error in evaluations: %.2f\n", order);
    CHECK(order > 0.9);
    room_free(&r);
}

/* ---- displaced squares with an obstruction between them
 * ----------------------------------------------------------------- */

/* Receiver 0..1 squared at z = 0; light 0..1 squared at z = 1, displaced by (dx, dy); between them at z = 1/2 the
 * square low..high. Its shadow on the light from (x, y) is 2 low - x .. 2 high - x. */
typedef struct obstructed {
    double dx, dy, low[2], high[2];
} obstructed;

static double obstructed_factor(const void *user, double x, double y) {
    const obstructed *o = user;
    double x0 = o->dx, x1 = o->dx + 1, y0 = o->dy, y1 = o->dy + 1;
    return rectangle_factor(x0 - x, x1 - x, y0 - y, y1 - y, 1) -
           rectangle_factor(fmax(x0, 2 * o->low[0] - x) - x, fmin(x1, 2 * o->high[0] - x) - x,
                            fmax(y0, 2 * o->low[1] - y) - y, fmin(y1, 2 * o->high[1] - y) - y, 1);
}

/* Where the shadow's borders pass the light's, as x varies over 0..1: 2 b - x = l. Sorted, with both ends. */
static int obstructed_breaks(const obstructed *o, int axis, double breaks[6]) {
    double displaced = axis ? o->dy : o->dx, edges[2] = { displaced, displaced + 1 };
    int n = 0;
    breaks[n++] = 0;
    for (int i = 0; i < 4; i++) {
        double x = 2 * (i / 2 ? o->high : o->low)[axis] - edges[i % 2];
        if (x > 0 && x < 1) breaks[n++] = x;
    }
    breaks[n++] = 1;
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && breaks[k] < breaks[k - 1]; k--) {
            double swap = breaks[k];
            breaks[k] = breaks[k - 1], breaks[k - 1] = swap;
        }
    return n;
}

static double obstructed_exact(const obstructed *o) {
    double x_breaks[6], y_breaks[6];
    int nx = obstructed_breaks(o, 0, x_breaks), ny = obstructed_breaks(o, 1, y_breaks);
    return gauss(obstructed_factor, o, x_breaks, nx, y_breaks, ny);
}

static void displaced_squares_with_an_obstruction_match_their_closed_form(void) {
    const obstructed cases[] = {
        { 0, 0, { 0.25, 0.25 }, { 0.75, 0.75 } },     { 0, 0, { 0.4, 0.4 }, { 0.6, 0.6 } },
        { 0.3, 0.2, { 0.25, 0.25 }, { 0.75, 0.75 } }, { 0.5, -0.7, { 0.3, -0.2 }, { 0.9, 0.45 } },
        { 1.5, 0, { 0.5, 0 }, { 1.2, 0.6 } },         { 0, 0, { 0.45, -3 }, { 0.5, 3 } }
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const obstructed *o = &cases[i];
        room r;
        visible_fraction v, back;
        start(&r);
        add_plate(&r, o->low[0], o->low[1], o->high[0], o->high[1], 0.5);
        room_finish(&r);
        polygon light = facing_down(o->dx, o->dy, o->dx + 1, o->dy + 1, 1), receiver = rectangle(0, 0, 1, 1, 0);
        CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &EFFORT, &v));
        CHECK(visible_fraction_of_element(&r.scene, &receiver, &light, &EFFORT, &back));
        double exact = obstructed_exact(o);
        printf("obstruction %zu: F %.8f, exact %.8f, reported %.1e, %llu evaluations\n", i, v.factor, exact,
               v.factor_error, (unsigned long long)v.evaluations);
        CHECK_NEAR(v.factor, exact, v.factor_error);
        CHECK(v.converged);
        /* Equal areas: reciprocity says the same of the way back, through the same obstruction. */
        CHECK_NEAR(back.factor, v.factor, v.factor_error + back.factor_error);
        room_free(&r);
    }
}

/* ---- many blockers
 * ------------------------------------------------------------------------------------------------------ */

/* Slats: stripe k of `count` over the light's width is open on its left half. Exact from every point. */
static void a_blind_of_many_slats_is_exact(void) {
    enum { SLATS = 60 };
    room r;
    start(&r);
    for (int k = 0; k < SLATS; k++) add_plate(&r, -1 + (2 * k + 1.0) / SLATS, -9, -1 + (2 * k + 2.0) / SLATS, 9, 1);
    room_finish(&r);
    polygon light = facing_down(-1, -1, 1, 1, 2);
    for (double x = -0.5; x <= 0.5; x += 0.17) {
        visible_fraction v;
        double seen = 0.0;
        CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ x, 0.1, 0 }, UP, &v));
        /* Openings, and what is beside the blind on both sides, thrown from z = 1 to z = 2. */
        for (int k = -1; k <= SLATS; k++) {
            double low = k < 0 ? -99 : -1 + 2.0 * k / SLATS, high = k == SLATS ? 99 : -1 + (2 * k + 1.0) / SLATS;
            if (k < 0) high = -1;
            seen += rectangle_factor(fmax(2 * low - x, -1) - x, fmin(2 * high - x, 1) - x, -1 - 0.1, 1 - 0.1, 2);
        }
        /* 60 fragments, each with a few roundings of its share. */
        CHECK_NEAR(v.factor, seen, 1e-12);
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
        visible_fraction v;
        double seen = 0.0;
        CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ x, y, 0 }, UP, &v));
        for (int i = 0; i < GRID * GRID; i++) {
            double u = -2 + 4.0 * (i % GRID) / GRID, w = -2 + 4.0 * (i / GRID) / GRID, d = 2.0 / GRID;
            seen += rectangle_factor(fmax(2 * u - x, -1) - x, fmin(2 * (u + d) - x, 1) - x, fmax(2 * w - y, -1) - y,
                                     fmin(2 * (w + d) - y, 1) - y, 2);
        }
        CHECK_NEAR(v.factor, seen, v.factor_error);
        CHECK_NEAR(v.factor_error, 0, 1e-5);
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
        visible_fraction v;
        random_plates(&r, 2 + 3 * i % 60, &state);
        double point[3] = { random_in(&state, -1, 1), random_in(&state, -1, 1), 0 }, normal[3];
        do random_direction(&state, normal);
        while (normal[2] < 0.3);
        CHECK(visible_fraction_at_point(&r.scene, &light, point, normal, &v));
        double sampled = sampled_fraction(&r, &light, point, normal, (double[]){ 0, 0, -1 }, RAYS);
        /* Rays are off by up to half a cell along a shadow's edge that runs along their grid, 1/400 of the light for an
         * edge as long as the light, and two such edges are allowed for. With 1200 x 1200 rays all 40 agree to 3e-4. */
        CHECK_NEAR(v.fraction, sampled, 5e-3);
        mean += v.fraction / 40;
        room_free(&r);
    }
    printf("random plates: %.2f visible in the mean\n", mean);
    CHECK(mean > 0.1 && mean < 0.9);
}

static void estimates_hold_among_random_plates(void) {
    uint64_t state = 12;
    int broken = 0, tested = 0, unconverged = 0;
    double ratio_sum = 0.0, least = INFINITY;
    for (int i = 0; i < 30; i++) {
        room r;
        visible_fraction best;
        /* From an emitter as large as the room to one that throws hard shadows. */
        double size = pow(10, random_in(&state, -1.5, 0)), x = random_in(&state, -1, 1), y = random_in(&state, -1, 1);
        polygon light = facing_down(x, y, x + size, y + size, 2);
        polygon receiver = rectangle(-0.3, -0.2, 0.3, 0.4, 0);
        random_plates(&r, 3 + 2 * i, &state);
        const visible_effort reference = { 2e-4, 200000 };
        CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &reference, &best));
        unconverged += !best.converged;
        for (double tolerance = 0.1; tolerance > 0.002; tolerance /= 3) {
            const visible_effort effort = { tolerance, 200000 };
            visible_fraction v;
            CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &effort, &v));
            double off = fabs(v.fraction - best.fraction);
            broken += off > v.error + best.error;
            tested++;
            if (off > best.error) ratio_sum += log(v.error / off), least = fmin(least, v.error / off);
        }
        room_free(&r);
    }
    printf(
        "estimates among random plates: %d of %d too small, least reported / true %.2f, log mean %.1f; %d references "
        "not converged\n",
        broken, tested, least, exp(ratio_sum / tested), unconverged);
    CHECK_EQUAL(broken, 0);
}

/* ---- ends of the scale
 * -------------------------------------------------------------------------------------------------- */

static void a_hidden_light_gives_zero_and_a_free_one_gives_one(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2), receiver = rectangle(-0.5, -0.5, 0.5, 0.5, 0);
    visible_fraction v;
    room r;
    start(&r);
    add_plate(&r, -9, -9, 9, 9, 1);
    room_finish(&r);
    CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &EFFORT, &v));
    CHECK_NEAR(v.fraction, 0, 0);
    /* What cells may hide: at most half of the tolerance. */
    CHECK_NEAR(v.error, 0, 0.51 * EFFORT.tolerance);
    CHECK(v.unoccluded > 0.1);
    CHECK(v.converged);
    room_free(&r);
    start(&r);
    add_plate(&r, -9, -9, 9, 9, 2.5);  /* behind the light */
    add_plate(&r, -9, -9, 9, 9, -0.5); /* below the element */
    add_plate(&r, 5, 5, 6, 6, 1);      /* beside both */
    add_plate(&r, -1, -1, 1, 1, 2);    /* the light's own surface */
    add_plate(&r, -0.5, -0.5, 0.5, 0.5, 0);
    room_finish(&r);
    CHECK(visible_fraction_of_element(&r.scene, &light, &receiver, &EFFORT, &v));
    CHECK_NEAR(v.fraction, 1, 0);
    CHECK_NEAR(v.error, 0, 0);
    CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ 0, 0, 0 }, UP, &v));
    CHECK_NEAR(v.fraction, 1, 0);
    room_free(&r);
}

static void what_faces_away_sees_nothing(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2), turned = rectangle(-1, -1, 1, 1, 2);
    polygon receiver = rectangle(-0.5, -0.5, 0.5, 0.5, 0);
    visible_fraction v;
    room r;
    make_half_plane(&r);
    CHECK(visible_fraction_of_element(&r.scene, &turned, &receiver, &EFFORT, &v));
    CHECK_NEAR(v.factor, 0, 0);
    CHECK_NEAR(v.fraction, 0, 0);
    CHECK(v.converged);
    CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, -1 }, &v));
    CHECK_NEAR(v.factor, 0, 0);
    CHECK_NEAR(v.unoccluded, 0, 0);
    room_free(&r);
}

/* A fence stands on the receiver's plane beside the element, and another hangs from the light. */
static void blockers_that_touch_receiver_or_shooter_count(void) {
    polygon light = facing_down(-1, -1, 1, 1, 2);
    room r;
    visible_fraction v;
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
        CHECK(visible_fraction_at_point(&r.scene, &light, (double[]){ x, 0, 0 }, UP, &v));
        CHECK_NEAR(v.factor, seen, v.factor_error);
        CHECK_NEAR(v.factor_error, 0, 1e-5);
    }
    room_free(&r);
}

int main(void) {
    RUN(a_point_behind_a_half_plane_sees_the_light_clipped_by_the_shadow_plane);
    RUN(an_element_in_penumbra_converges_to_the_closed_form);
    RUN(the_error_falls_with_the_evaluations);
    RUN(displaced_squares_with_an_obstruction_match_their_closed_form);
    RUN(a_blind_of_many_slats_is_exact);
    RUN(a_grid_of_crossed_slats_is_exact);
    RUN(points_among_random_plates_agree_with_rays);
    RUN(estimates_hold_among_random_plates);
    RUN(a_hidden_light_gives_zero_and_a_free_one_gives_one);
    RUN(what_faces_away_sees_nothing);
    RUN(blockers_that_touch_receiver_or_shooter_count);
    return check_end();
}
