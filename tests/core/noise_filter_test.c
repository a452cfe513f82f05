/* SPDX-License-Identifier: MIT
 * Does the filter take noise away and leave light where it is?
 */
#include "base/splitmix.h"
#include "check.h"
#include "reconstruct/noise_filter.h"
#include "room.h"

enum { SIDE = 40 };
static const double SIGMA = 0.15, EDGE = 0.3;

typedef struct floor_light {
    room r;
    double *truth, *noisy, *half, *row_sum, *found, *left;
} floor_light;

/* A slope, and beyond an edge three times as much: what a shadow leaves. */
static double light_at(double x, double y, bool edge) {
    return (1.0 + 0.4 * x - 0.2 * y) * (edge && x > EDGE ? 3.0 : 1.0);
}

/* About normal, of deviation 1. */
static double noise_of(uint64_t seed) {
    double sum = -6.0;
    for (uint64_t i = 0; i < 12; i++) sum += (double)(splitmix(seed * 12 + i) >> 11) * 0x1p-53;
    return sum;
}

static void floor_make(floor_light *f, bool edge, double sigma) {
    static uint32_t nodes[ROOM_VERTICES_MAX];
    const double corner[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
    room_start(&f->r);
    room_grid(&f->r, corner, room_material(&f->r, 0.5, 0.0), &(room_cuts){ 1, 1, SIDE, SIDE });
    room_finish(&f->r);
    mesh *m = &f->r.mesh;
    for (uint32_t v = 0; v < f->r.vertex_count; v++) nodes[v] = v;
    m->nodes = nodes, m->node_count = f->r.vertex_count;
    double **all[] = { &f->truth, &f->noisy, &f->half, &f->row_sum, &f->found, &f->left };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) *all[i] = calloc(3 * m->sample_count + 1, sizeof(double));
    for (size_t s = 0; s < m->sample_count; s++) {
        f->row_sum[s] = 1.0;
        for (size_t c = 0; c < 3; c++) {
            double L = light_at(m->x[s], m->y[s], edge), a = L + sigma * noise_of(6 * s + c),
                   b = L + sigma * noise_of(6 * s + 3 + c);
            f->truth[3 * s + c] = L, f->noisy[3 * s + c] = 0.5 * (a + b), f->half[3 * s + c] = 0.5 * (a - b);
        }
    }
}

static void floor_free(floor_light *f) {
    free(f->truth), free(f->noisy), free(f->half), free(f->row_sum), free(f->found), free(f->left);
    room_free(&f->r);
}

static void filter(floor_light *f, const double *exact, unsigned threads) {
    jobs *j = jobs_create(threads);
    memcpy(f->found, f->noisy, 3 * f->r.mesh.sample_count * sizeof *f->found);
    memcpy(f->left, f->half, 3 * f->r.mesh.sample_count * sizeof *f->left);
    const noise_filter_input in = { .scene = &f->r.scene,
                                    .mesh = &f->r.mesh,
                                    .jobs = j,
                                    .exact = exact,
                                    .row_sum = f->row_sum,
                                    .half_difference = f->left,
                                    .irradiance = f->found };
    CHECK(noise_filter(&in));
    jobs_destroy(j);
}

/* Of samples whose distance from the edge is in a range. */
static double rms(const floor_light *f, const double *values, double from, double to) {
    double sum = 0.0, count = 0.0;
    for (size_t s = 0; s < f->r.mesh.sample_count; s++) {
        double distance = fabs(f->r.mesh.x[s] - EDGE);
        for (size_t c = 0; distance >= from && distance < to && c < 3; c++)
            sum += pow(values[3 * s + c] - f->truth[3 * s + c], 2), count++;
    }
    return sqrt(sum / count);
}

static void noise_on_a_slope_is_a_third_of_what_it_was(void) {
    floor_light f;
    floor_make(&f, false, SIGMA);
    filter(&f, NULL, 2);
    double before = rms(&f, f.noisy, 0, 1), after = rms(&f, f.found, 0, 1);
    printf("noise on a slope: %.4f, filtered %.4f\n", before, after);
    CHECK_NEAR(before, SIGMA / sqrt(2), 0.05 * SIGMA);
    CHECK(after < before / 3.0);
    /* What the halves still differ by says how noisy it is now. */
    double said = 0.0;
    for (size_t i = 0; i < 3 * f.r.mesh.sample_count; i++) said += f.left[i] * f.left[i];
    said = sqrt(said / (3.0 * (double)f.r.mesh.sample_count));
    printf("its halves say %.4f\n", said);
    CHECK(said > 0.6 * after && said < 1.6 * after);
    floor_free(&f);
}

static void the_edge_of_a_shadow_stays(void) {
    floor_light f;
    floor_make(&f, true, SIGMA);
    filter(&f, NULL, 2);
    double width = 1.0 / SIDE;
    printf("at the edge: %.4f, filtered %.4f; elsewhere: %.4f, filtered %.4f\n", rms(&f, f.noisy, 0, width),
           rms(&f, f.found, 0, width), rms(&f, f.noisy, 4 * width, 1), rms(&f, f.found, 4 * width, 1));
    CHECK(rms(&f, f.found, 0, width) < 1.1 * rms(&f, f.noisy, 0, width));
    CHECK(rms(&f, f.found, 4 * width, 1) < rms(&f, f.noisy, 4 * width, 1) / 2.5);
    floor_free(&f);
}

/* Ripples five elements long, thirty times as high as the noise: no plane runs through them, and both halves show them.
 */
static void what_both_halves_agree_on_stays(void) {
    const double sigma = 0.02;
    floor_light f;
    floor_make(&f, false, sigma);
    for (size_t i = 0; i < 3 * f.r.mesh.sample_count; i++) {
        double ripple = 30.0 * sigma * sin(2.0 * 3.14159265358979323846 * f.r.mesh.x[i / 3] * SIDE / 5.0);
        f.truth[i] += 2.0 + ripple, f.noisy[i] += 2.0 + ripple;
    }
    filter(&f, NULL, 2);
    double before = rms(&f, f.noisy, 0, 1), after = rms(&f, f.found, 0, 1);
    printf("noise on ripples: %.4f, filtered %.4f\n", before, after);
    CHECK(after < 1.1 * before);
    floor_free(&f);
}

/* One element whose halves agree on a little more light than those around it: chance, as among a hundred thousand there
 * is. On much more: light. */
static void what_one_element_says_alone_stays_where_it_is_much(void) {
    for (int much = 0; much < 2; much++) {
        floor_light f;
        floor_make(&f, false, SIGMA);
        const element *one = &f.r.mesh.elements[SIDE * SIDE / 2 + SIDE / 4];
        size_t first = one->first_sample, end = first + (size_t)element_corner_count(one);
        double off = (much ? 8.0 : 2.0) * SIGMA, left = 0.0;
        for (size_t s = first; s < end; s++)
            for (size_t c = 0; c < 3; c++) f.noisy[3 * s + c] = f.truth[3 * s + c] + off, f.half[3 * s + c] = SIGMA;
        filter(&f, NULL, 2);
        for (size_t s = first; s < end; s++) left += (f.found[3 * s] - f.truth[3 * s]) / off / (double)(end - first);
        printf("%.0f times the noise on one element: %.2f of it stays\n", off / SIGMA, left);
        CHECK(much ? left > 0.8 : left < 0.5);
        floor_free(&f);
    }
}

static void what_has_no_noise_stays(void) {
    floor_light f;
    floor_make(&f, true, 0.0);
    filter(&f, NULL, 2);
    CHECK(memcmp(f.found, f.noisy, 3 * f.r.mesh.sample_count * sizeof *f.found) == 0);
    floor_free(&f);
    /* Light known exactly, a sharp shadow in it, is not looked at. */
    floor_make(&f, false, SIGMA);
    double *exact = calloc(3 * f.r.mesh.sample_count, sizeof *exact);
    for (size_t s = 0; s < f.r.mesh.sample_count; s++)
        for (size_t c = 0; c < 3; c++) {
            exact[3 * s + c] = f.r.mesh.x[s] > EDGE ? 50.0 : 0.0;
            f.noisy[3 * s + c] += exact[3 * s + c], f.truth[3 * s + c] += exact[3 * s + c];
        }
    filter(&f, exact, 2);
    CHECK(rms(&f, f.found, 0, 0.05) < rms(&f, f.noisy, 0, 0.05) / 2.5);
    free(exact);
    floor_free(&f);
}

/* A sample inside something says nothing of those beside it, and is not made up from them. */
static void what_is_inside_something_is_left_alone(void) {
    floor_light f;
    floor_make(&f, false, SIGMA);
    for (size_t s = 0; s < f.r.mesh.sample_count; s++)
        if (f.r.mesh.x[s] < 0.5) {
            f.row_sum[s] = 0.0;
            for (size_t c = 0; c < 3; c++) f.noisy[3 * s + c] = 0.0, f.half[3 * s + c] = 0.0;
        }
    filter(&f, NULL, 2);
    for (size_t s = 0; s < f.r.mesh.sample_count; s++) {
        if (f.r.mesh.x[s] < 0.5) CHECK_NEAR(f.found[3 * s], 0.0, 0.0);
        if (f.r.mesh.x[s] > 0.5) CHECK(f.found[3 * s] > 0.8 * f.truth[3 * s] - 3 * SIGMA);
    }
    floor_free(&f);
}

/* A dark stripe at the rim, so noisy that nothing of its own is kept: beyond those along it are brighter ones alone,
 * and they say how it slopes. It is not black for that. */
static void no_plane_falls_to_nothing_within_an_element(void) {
    const double lit = 2.0, dark = 0.2;
    floor_light f;
    floor_make(&f, false, 0.0);
    double darkest = INFINITY;
    for (size_t s = 0; s < f.r.mesh.sample_count; s++) {
        bool is_dark = f.r.mesh.x[s] > 1.0 - 1.0 / SIDE;
        for (size_t c = 0; c < 3; c++) {
            f.truth[3 * s + c] = f.noisy[3 * s + c] = is_dark ? dark : lit;
            f.half[3 * s + c] = is_dark ? lit : 0.0;
        }
    }
    filter(&f, NULL, 2);
    for (size_t s = 0; s < f.r.mesh.sample_count; s++) darkest = fmin(darkest, f.found[3 * s]);
    printf("in a dark stripe the darkest is %.3f of what is there\n", darkest / dark);
    CHECK(darkest > 0.45 * dark);
    floor_free(&f);
}

static void threads_change_nothing(void) {
    floor_light f;
    floor_make(&f, true, SIGMA);
    filter(&f, NULL, 1);
    double *one = malloc(3 * f.r.mesh.sample_count * sizeof *one);
    memcpy(one, f.found, 3 * f.r.mesh.sample_count * sizeof *one);
    filter(&f, NULL, 3);
    CHECK(memcmp(one, f.found, 3 * f.r.mesh.sample_count * sizeof *one) == 0);
    free(one);
    floor_free(&f);
}

int main(void) {
    RUN(noise_on_a_slope_is_a_third_of_what_it_was);
    RUN(the_edge_of_a_shadow_stays);
    RUN(what_both_halves_agree_on_stays);
    RUN(what_one_element_says_alone_stays_where_it_is_much);
    RUN(what_has_no_noise_stays);
    RUN(what_is_inside_something_is_left_alone);
    RUN(no_plane_falls_to_nothing_within_an_element);
    RUN(threads_change_nothing);
    return check_end();
}
