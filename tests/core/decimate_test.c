/* SPDX-License-Identifier: MIT
 * Do triangles go that the picture does not need, and only those?
 */
#include "check.h"
#include "reconstruct/decimate.h"

#include "geometry/vec3.h"

#include <stdlib.h>
#include <time.h>

enum { FACES_MAX = 8, RANDOM_POINTS = 20000 };

static const double TOLERANCE = 0.01;

/* Grids of n x m cells, each a face; vertices and nodes of their own, which places join. */
typedef struct sheets {
    double *positions, *values, *tolerance;
    uint32_t *nodes;
    uint32_t vertex_count, first_vertex[FACES_MAX], n[FACES_MAX], m[FACES_MAX], face_count;
    decimate_triangles triangles;
    uint32_t before;
} sheets;

typedef double (*field)(int band, const double x[3]);

static void add_sheet(sheets *s, uint32_t n, uint32_t m, const double origin[3], const double u[3], const double v[3]) {
    uint32_t first = s->vertex_count, face = s->face_count++;
    s->first_vertex[face] = first, s->n[face] = n, s->m[face] = m;
    s->vertex_count += (n + 1) * (m + 1);
    s->positions = realloc(s->positions, 3 * s->vertex_count * sizeof *s->positions);
    s->triangles.corners = realloc(s->triangles.corners, (3 * s->triangles.count + 6 * n * m) * sizeof(uint32_t));
    s->triangles.faces = realloc(s->triangles.faces, (s->triangles.count + 2 * n * m) * sizeof(uint32_t));
    for (uint32_t j = 0; j <= m; j++)
        for (uint32_t i = 0; i <= n; i++)
            for (size_t k = 0; k < 3; k++)
                s->positions[3 * (first + j * (n + 1) + i) + k] = origin[k] + i * u[k] / n + j * v[k] / m;
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1, turn = (i + j) % 2;
            uint32_t six[] = { a, b, turn ? d : c, turn ? b : a, c, d };
            memcpy(s->triangles.corners + 3 * s->triangles.count, six, sizeof six);
            s->triangles.faces[s->triangles.count++] = face;
            s->triangles.faces[s->triangles.count++] = face;
        }
    s->before = s->triangles.count;
}

static void fill(sheets *s, field f) {
    s->values = malloc(3 * s->vertex_count * sizeof *s->values);
    s->tolerance = malloc(s->vertex_count * sizeof *s->tolerance);
    s->nodes = malloc(s->vertex_count * sizeof *s->nodes);
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        s->nodes[v] = v;
        s->tolerance[v] = TOLERANCE;
        for (int c = 0; c < 3; c++) s->values[3 * v + (uint32_t)c] = f(c, s->positions + 3 * v);
    }
}

static decimate_result merge_them(sheets *s, unsigned threads, const bool *kept) {
    jobs *workers = jobs_create(threads);
    const decimate_input in = { .jobs = workers,
                                .positions = s->positions,
                                .nodes = s->nodes,
                                .vertex_count = s->vertex_count,
                                .kept = kept,
                                .fields = { { s->values, s->tolerance } },
                                .field_count = 1 };
    decimate_result out;
    CHECK(decimate(&in, &s->triangles, &out));
    jobs_destroy(workers);
    return out;
}

static void free_sheets(sheets *s) {
    free(s->positions), free(s->values), free(s->tolerance), free(s->nodes);
    free(s->triangles.corners), free(s->triangles.faces);
    memset(s, 0, sizeof *s);
}

/* ---- fields ---- */

static double even(int band, const double x[3]) {
    (void)x;
    return 1.0 + band;
}

static double linear(int band, const double x[3]) {
    return 2.0 + (band + 1) * x[0] - 0.7 * x[1] + 0.3 * x[2];
}

/* Between columns 15 and 16 of 32. */
static double step(int band, const double x[3]) {
    return x[0] < 0.49 ? 1.0 : 2.0 + band;
}

/* The shadow of a disc with a soft edge, and light that falls off. */
static double penumbra(int band, const double x[3]) {
    double r = hypot(x[0] - 0.4, x[1] - 0.55), t = fmin(fmax((r - 0.2) / 0.15, 0.0), 1.0);
    return (0.2 + (band ? 0.8 : 0.5) * t * t * (3 - 2 * t)) / (1.0 + x[0] * x[0] + x[1] * x[1]);
}

/* Penumbra on one side of x = 1, even on the other. */
static double half_even(int band, const double x[3]) {
    return x[2] > 1e-9 ? 1.0 : 1.0 + penumbra(band, (const double[]){ x[0], 2 * x[1] - 0.5, 0.0 }) * 20.0 * x[0];
}

/* ---- what is looked at ---- */

static const double *corner(const sheets *s, uint32_t t, uint32_t k) {
    return s->positions + 3 * (size_t)s->triangles.corners[3 * t + k % 3];
}

/* Twice its area, along the normal. */
static void area_of(const sheets *s, uint32_t t, double out[3]) {
    double u[3], v[3];
    vec3_sub(u, corner(s, t, 1), corner(s, t, 0));
    vec3_sub(v, corner(s, t, 2), corner(s, t, 0));
    vec3_cross(out, u, v);
}

/* Every triangle turns as its face does and is no needle; all have the area there was. */
static void check_shapes(const sheets *s, double shape, double area) {
    double sum = 0.0, worst = INFINITY;
    for (uint32_t t = 0; t < s->triangles.count; t++) {
        double a[3], first[3], longest = 0.0;
        area_of(s, t, a);
        for (uint32_t k = 0; k < 3; k++) longest = fmax(longest, vec3_distance(corner(s, t, k), corner(s, t, k + 1)));
        uint32_t f = s->triangles.faces[t], at = s->first_vertex[f];
        double u[3], v[3];
        vec3_sub(u, s->positions + 3 * (at + 1), s->positions + 3 * at);
        vec3_sub(v, s->positions + 3 * (at + s->n[f] + 1), s->positions + 3 * at);
        vec3_cross(first, u, v);
        CHECK(vec3_dot(a, first) > 0.0);
        worst = fmin(worst, vec3_length(a) / (longest * longest));
        sum += vec3_length(a) / 2;
    }
    /* Off by the roundings of coordinates in the plane. */
    if (!(worst >= shape * (1 - 1e-12))) printf("%.17g\n", worst);
    CHECK(worst >= shape * (1 - 1e-12));
    /* Sums of some thousand numbers of that size. */
    CHECK_NEAR(sum, area, 1e-12 * area);
}

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

static bool same_place(const double *a, const double *b) {
    return memcmp(a, b, 3 * sizeof *a) == 0;
}

/* Of edges on the line x = 1, z = 0, y in [0,1]: how many have no other with the same ends. */
static int lone_edges(const sheets *s, int *all) {
    int lone = 0;
    *all = 0;
    for (uint32_t i = 0; i < 3 * s->triangles.count; i++) {
        const double *a = corner(s, i / 3, i), *b = corner(s, i / 3, i % 3 + 1);
        bool paired = false;
        if (a[0] != 1.0 || b[0] != 1.0 || a[2] != 0.0 || b[2] != 0.0) continue;
        ++*all;
        for (uint32_t j = 0; j < 3 * s->triangles.count && !paired; j++) {
            const double *c = corner(s, j / 3, j), *d = corner(s, j / 3, j % 3 + 1);
            paired = s->triangles.faces[i / 3] != s->triangles.faces[j / 3] &&
                     ((same_place(a, c) && same_place(b, d)) || (same_place(a, d) && same_place(b, c)));
        }
        lone += !paired;
    }
    return lone;
}

/* ---- sentences ---- */

static const double O[3] = { 0, 0, 0 }, X[3] = { 1, 0, 0 }, Y[3] = { 0, 1, 0 }, Z[3] = { 0, 0, 1 };

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
