/* SPDX-License-Identifier: MIT
 * Do triangles go that the picture does not need, and only those?
 */
#include "check.h"
#include "sheets.h"

#include <time.h>

enum { RANDOM_POINTS = 20000 };

static decimate_result merge_them(sheets *s, unsigned threads, const bool *kept) {
    return merge_by(s, threads, kept, NULL);
}

/* ---- fields ---- */

static double linear(int band, const double x[3]) {
    return 2.0 + (band + 1) * x[0] - 0.7 * x[1] + 0.3 * x[2];
}

/* Between columns 15 and 16 of 32. */
static double step(int band, const double x[3]) {
    return x[0] < 0.49 ? 1.0 : 2.0 + band;
}

/* Penumbra on one side of x = 1, even on the other. */
static double half_even(int band, const double x[3]) {
    return x[2] > 1e-9 ? 1.0 : 1.0 + penumbra(band, (const double[]){ x[0], 2 * x[1] - 0.5, 0.0 }) * 20.0 * x[0];
}

/* ---- what is looked at ---- */

/* The value of triangles [first, end) at a point of the unit square. */
static bool value_at(const sheets *s, const uint32_t *corners, uint32_t count, const double x[2], double out[3]) {
    for (uint32_t t = 0; t < count; t++) {
        const double *p[3];
        for (int k = 0; k < 3; k++) p[k] = s->positions + 3 * (size_t)corners[3 * t + (uint32_t)k];
        double whole = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        double v = ((x[0] - p[0][0]) * (p[2][1] - p[0][1]) - (x[1] - p[0][1]) * (p[2][0] - p[0][0])) / whole;
        double w = ((p[1][0] - p[0][0]) * (x[1] - p[0][1]) - (p[1][1] - p[0][1]) * (x[0] - p[0][0])) / whole;
        if (v < -1e-12 || w < -1e-12 || v + w > 1 + 1e-12) continue;
        for (uint32_t c = 0; c < 3; c++)
            out[c] = (1 - v - w) * s->values[3 * corners[3 * t] + c] + v * s->values[3 * corners[3 * t + 1] + c] +
                     w * s->values[3 * corners[3 * t + 2] + c];
        return true;
    }
    return false;
}

/* The largest change at random points of a sheet in the unit square, and its root of mean squares. */
static double worst_change(const sheets *s, const uint32_t *before, uint32_t count, double *rms) {
    double worst = 0.0, sum = 0.0;
    uint32_t state = 1;
    for (int i = 0; i < RANDOM_POINTS; i++) {
        double x[2], old[3] = { 0 }, new[3] = { 0 };
        for (int k = 0; k < 2; k++) x[k] = (state = state * 1664525u + 1013904223u) / 4294967296.0;
        CHECK(value_at(s, before, count, x, old) && value_at(s, s->triangles.corners, s->triangles.count, x, new));
        for (int c = 0; c < 3; c++) {
            worst = fmax(worst, fabs(new[c] - old[c]));
            sum += (new[c] - old[c]) * (new[c] - old[c]);
        }
    }
    *rms = sqrt(sum / RANDOM_POINTS);
    return worst;
}

/* ---- sentences ---- */

static void wall_with(field f, uint32_t n) {
    sheets s = { 0 };
    add_sheet(&s, n, n, O, X, Y);
    fill(&s, f);
    decimate_result r = merge_them(&s, 2, NULL);
    CHECK_EQUAL(s.triangles.count, 2);
    check_shapes(&s, 0.49, 1.0);
    /* Interpolation of linear fields is off by roundings of numbers below 6, in tolerances. */
    CHECK(r.error < 1e-15 * 6 * 10 / TOLERANCE && r.square < 1e-24);
    free_sheets(&s);
}

static void an_even_wall_becomes_two_triangles(void) {
    for (uint32_t n = 1; n <= 64; n = 2 * n + 1) wall_with(even, n);
}

static void so_does_one_over_which_light_is_linear(void) {
    for (uint32_t n = 2; n <= 64; n *= 2) wall_with(linear, n);
}

/* Twelve triangles of 6 x 2 x 16 x 16; edges of three faces' corners stay, all others go on both sides. */
static void an_even_room_becomes_twelve(void) {
    sheets s = { 0 };
    add_sheet(&s, 16, 16, O, X, Y), add_sheet(&s, 16, 16, Z, X, Y);
    add_sheet(&s, 16, 16, O, Y, Z), add_sheet(&s, 16, 16, X, Y, Z);
    add_sheet(&s, 16, 16, O, Z, X), add_sheet(&s, 16, 16, Y, Z, X);
    fill(&s, even);
    merge_them(&s, 2, NULL);
    CHECK_EQUAL(s.triangles.count, 12);
    check_shapes(&s, 0.49, 6.0);
    free_sheets(&s);
}

/* Cuts may leave triangles without area: three vertices in a row. What is changed is a number all the same. */
static void triangles_without_area_change_nothing(void) {
    sheets s = { 0 };
    add_sheet(&s, 8, 8, O, X, Y);
    s.triangles.corners = realloc(s.triangles.corners, 3 * (s.triangles.count + 4) * sizeof(uint32_t));
    s.triangles.faces = realloc(s.triangles.faces, (s.triangles.count + 4) * sizeof(uint32_t));
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(s.triangles.corners + 3 * s.triangles.count, (uint32_t[]){ 20 + i, 21 + i, 22 + i },
               3 * sizeof(uint32_t));
        s.triangles.faces[s.triangles.count++] = 0;
    }
    fill(&s, penumbra);
    decimate_result r = merge_them(&s, 2, NULL);
    CHECK(isfinite(r.square) && r.square >= 0.0);
    CHECK(r.error <= 1.0 + 1e-9);
    free_sheets(&s);
}

/* A skirting board is narrow itself, and not cut narrower. */
static void a_strip_becomes_two(void) {
    sheets s = { 0 };
    add_sheet(&s, 400, 2, O, X, (const double[]){ 0, 0.005, 0 });
    fill(&s, even);
    merge_them(&s, 2, NULL);
    CHECK_EQUAL(s.triangles.count, 2);
    check_shapes(&s, 0.0049, 0.005);
    free_sheets(&s);
}

static void changes_stay_within_the_tolerance(field f, uint32_t most) {
    sheets s = { 0 };
    double rms;
    add_sheet(&s, 32, 32, O, X, Y);
    fill(&s, f);
    uint32_t *before = malloc(3 * s.before * sizeof *before);
    memcpy(before, s.triangles.corners, 3 * s.before * sizeof *before);
    decimate_result r = merge_them(&s, 2, NULL);
    double worst = worst_change(&s, before, s.before, &rms);
    printf("%u triangles of %u, off by %.4f at most and %.4f rms where %.4f is allowed\n", s.triangles.count, s.before,
           worst, rms, TOLERANCE);
    CHECK(s.triangles.count <= most);
    CHECK(r.error <= 1.0);
    /* Corners and middles of edges are looked at; what lies between them may be off by as much again, where a new edge
     * passes through. */
    CHECK(worst <= 2 * TOLERANCE);
    CHECK(rms <= sqrt(3.0) * TOLERANCE / 2);
    /* The points that were looked at are a fair sample. */
    CHECK_NEAR(sqrt(r.square), rms, 0.25 * rms + 1e-15);
    check_shapes(&s, 0.1, 1.0);
    free(before);
    free_sheets(&s);
}

/* Both edges of the column in which light steps stay, and what leads from them to the borders. */
static void a_step_stays(void) {
    changes_stay_within_the_tolerance(step, 400);
}

static void a_penumbra_stays_within_the_tolerance(void) {
    changes_stay_within_the_tolerance(penumbra, 700);
}

static void borders_have_the_same_vertices_on_both_sides(void) {
    sheets s = { 0 };
    int all;
    add_sheet(&s, 32, 32, O, X, Y);
    add_sheet(&s, 32, 32, X, Y, Z);
    fill(&s, half_even);
    merge_them(&s, 2, NULL);
    CHECK_EQUAL(lone_edges(&s, &all), 0);
    printf("%d edges left of 32 where two faces meet, %u triangles of %u\n", all / 2, s.triangles.count, s.before);
    /* The lit side needs some, and neither all. */
    CHECK(all / 2 > 2 && all / 2 < 32);
    check_shapes(&s, 0.1, 2.0);
    free_sheets(&s);
}

/* Where one face ends in the middle of another's border, the other keeps its vertex there. */
static void a_corner_of_another_face_keeps_the_border(void) {
    sheets s = { 0 };
    int all;
    add_sheet(&s, 16, 16, O, X, Y);
    add_sheet(&s, 8, 8, X, (const double[]){ 0, 0.5, 0 }, Z);
    add_sheet(&s, 8, 8, (const double[]){ 1, 0.5, 0 }, (const double[]){ 0, 0.5, 0 }, Z);
    fill(&s, even);
    merge_them(&s, 2, NULL);
    CHECK_EQUAL(s.triangles.count, 3 + 2 + 2);
    CHECK_EQUAL(lone_edges(&s, &all), 0);
    CHECK_EQUAL(all, 4);
    free_sheets(&s);
}

static void what_is_kept_stays_with_its_border(void) {
    sheets s = { 0 };
    const bool kept[] = { false, true };
    int all;
    add_sheet(&s, 8, 8, O, X, Y);
    add_sheet(&s, 8, 8, X, Y, Z);
    fill(&s, even);
    merge_them(&s, 2, kept);
    uint32_t of_kept = 0;
    for (uint32_t t = 0; t < s.triangles.count; t++) of_kept += s.triangles.faces[t] == 1;
    CHECK_EQUAL(of_kept, 128);
    CHECK_EQUAL(lone_edges(&s, &all), 0);
    CHECK_EQUAL(all, 16);
    /* 8 edges on one side and 1 on each other: at least 9 triangles; some vertices inside keep them from being needles.
     */
    CHECK(s.triangles.count - of_kept < 20);
    check_shapes(&s, 0.1, 2.0);
    free_sheets(&s);
}

static void the_result_is_the_same_for_any_number_of_threads(void) {
    sheets s[2] = { 0 };
    for (unsigned i = 0; i < 2; i++) {
        add_sheet(&s[i], 32, 32, O, X, Y);
        add_sheet(&s[i], 32, 32, X, Y, Z);
        fill(&s[i], half_even);
        merge_them(&s[i], i ? 3 : 1, NULL);
    }
    CHECK_EQUAL(s[0].triangles.count, s[1].triangles.count);
    CHECK(memcmp(s[0].triangles.corners, s[1].triangles.corners, 12 * (size_t)s[0].triangles.count) == 0);
    free_sheets(&s[0]), free_sheets(&s[1]);
}

/* Prints how long it takes; what is checked is that it ends. */
static void half_a_million_triangles_take_seconds(void) {
    sheets s = { 0 };
    struct timespec a, b;
    add_sheet(&s, 512, 512, O, X, Y);
    fill(&s, penumbra);
    clock_gettime(CLOCK_MONOTONIC, &a);
    merge_them(&s, 2, NULL);
    clock_gettime(CLOCK_MONOTONIC, &b);
    printf("%u triangles of %u in %.2f s\n", s.triangles.count, s.before,
           (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec));
    CHECK(s.triangles.count < s.before / 100);
    check_shapes(&s, 0.1, 1.0);
    free_sheets(&s);
}

int main(void) {
    RUN(an_even_wall_becomes_two_triangles);
    RUN(so_does_one_over_which_light_is_linear);
    RUN(an_even_room_becomes_twelve);
    RUN(triangles_without_area_change_nothing);
    RUN(a_strip_becomes_two);
    RUN(a_step_stays);
    RUN(a_penumbra_stays_within_the_tolerance);
    RUN(borders_have_the_same_vertices_on_both_sides);
    RUN(a_corner_of_another_face_keeps_the_border);
    RUN(what_is_kept_stays_with_its_border);
    RUN(the_result_is_the_same_for_any_number_of_threads);
    RUN(half_a_million_triangles_take_seconds);
    return check_end();
}
