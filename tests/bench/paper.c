/* SPDX-License-Identifier: MIT
 * What do the paper's four methods give on its test environment, and what do they cost? Figure 12 as a table and as two
 * SVG plots (error against the full matrix by shots and by seconds), the numbers of its section 6 beside ours, and
 * figures 8, 9 and 13 (full matrix, original, hybrid; flat shaded, one camera, one exposure) as PNG.
 *
 *     paper [FOLDER]      files go to FOLDER (default: here)
 */
#include "accuracy/paper_room.h"
#include "accuracy/plot.h"
#include "picture/picture.h"
#include "png_encode.h"

#include <stdio.h>

enum { METHODS = 4, POINTS_MAX = 128, WIDTH = 900, HEIGHT = 700, RUNS = 3 };

static const solver_method ORDER[METHODS] = { SOLVER_FM, SOLVER_HYBRID, SOLVER_ANALYTIC, SOLVER_PR };
static const char *const NAMES[METHODS] = { "fm", "hybrid", "analytic", "pr" };
static const char *const PICTURES[METHODS] = { "figure8-fm", "figure13-hybrid", NULL, "figure9-pr" };
static const char *folder = ".";

/* One run, and its error against the full matrix at the points of its curve. */
typedef struct outcome {
    double *B; /* of elements */
    double seconds, error, to_hybrid, analytic_share;
    double shots[POINTS_MAX], at_s[POINTS_MAX], errors[POINTS_MAX];
    int points;
    uint32_t hemicubes, shot_count, splits;
} outcome;

typedef struct bench {
    paper_room paper;
    jobs *jobs;
    outcome outcomes[METHODS];
    double *scratch; /* radiosity of elements */
    outcome *current;
} bench;

/* The clock of the solver: measuring stands still in it. */
static double measuring_s;

static double solver_seconds(void) {
    return paper_seconds() - measuring_s;
}

static void observe(void *user, const progressive_point *point, const double *irradiance) {
    bench *b = user;
    outcome *o = b->current;
    double begin = paper_seconds();
    if (o->points < POINTS_MAX && point->shots > 0) {
        paper_radiosity(&b->paper.room, irradiance, b->scratch);
        o->shots[o->points] = point->shots;
        o->at_s[o->points] = point->t_s;
        o->errors[o->points++] = paper_error(&b->paper.room, b->outcomes[0].B, b->scratch);
    }
    measuring_s += paper_seconds() - begin;
}

static bool run_method(bench *b, int i, bool watch) {
    char message[200];
    progressive_result r;
    progressive_setup setup = paper_setup(&b->paper, ORDER[i], b->jobs, solver_seconds);
    b->current = &b->outcomes[i];
    b->current->points = 0;
    if (watch) setup.observe = observe, setup.observe_user = b;
    double begin = solver_seconds();
    const char *failure = progressive_solve(&setup, &r, message, sizeof message);
    if (failure) fprintf(stderr, "%s: %s\n", NAMES[i], failure);
    b->current->seconds = solver_seconds() - begin;
    if (!failure) {
        paper_radiosity(&b->paper.room, r.irradiance, b->current->B);
        b->current->hemicubes = r.hemicubes;
        b->current->shot_count = r.shots;
        b->current->splits = r.split_count;
        b->current->analytic_share = r.evaluations ? (double)r.analytic / (double)r.evaluations : 0.0;
        b->current->error = paper_error(&b->paper.room, b->outcomes[0].B, b->current->B);
        if (i > 1) b->current->to_hybrid = paper_error(&b->paper.room, b->outcomes[1].B, b->current->B);
    }
    progressive_result_free(&r);
    return !failure;
}

/* ---- tables ---- */

static void print_curves(const bench *b) {
    printf("\nfigure 12: relative error against fm by shots and seconds\n");
    for (int i = 1; i < METHODS; i++) {
        const outcome *o = &b->outcomes[i];
        printf("%s\n", NAMES[i]);
        for (int k = 0; k < o->points; k++)
            printf("  %6.0f shots %8.3f s  %8.4f %%\n", o->shots[k], o->at_s[k], 100 * o->errors[k]);
    }
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median of hybrid : analytic over a few runs, interleaved. */
static double time_ratio(bench *b) {
    double ratios[RUNS];
    for (int k = 0; k < RUNS; k++) {
        run_method(b, 1, false);
        run_method(b, 2, false);
        ratios[k] = b->outcomes[1].seconds / b->outcomes[2].seconds;
    }
    qsort(ratios, RUNS, sizeof *ratios, compare_doubles);
    return ratios[RUNS / 2];
}

static void print_results(bench *b) {
    double ratio = time_ratio(b);
    const outcome *o = b->outcomes;
    printf("\n%-52s %12s %12s\n", "what", "paper", "ours");
    printf("%-52s %12s %10.2f %%\n", "pr against fm", "19 %", 100 * o[3].error);
    printf("%-52s %12s %10.2f %%\n", "hybrid against fm", "4 %", 100 * o[1].error);
    printf("%-52s %12s %11.1fx\n", "pr : hybrid", "4.8x", o[3].error / o[1].error);
    printf("%-52s %12s %10.3f %%\n", "hybrid against analytic", "< .01 %", 100 * o[2].to_hybrid);
    printf("%-52s %12s %10.0f %%\n", "hybrid: share of factors by the closed form", "62 %", 100 * o[1].analytic_share);
    printf("%-52s %12s %12.2f\n", "time hybrid : analytic, median", "0.67", ratio);
    printf("%-52s %12s %10.1f s\n", "time of hybrid", "47.5 min", o[1].seconds);
    for (int i = 0; i < METHODS; i++)
        printf("%-10s %8.2f s %6u shots %6u hemi-cubes %5u split\n", NAMES[i], o[i].seconds, o[i].shot_count,
               o[i].hemicubes, o[i].splits);
}

static bool plot_errors(const bench *b, const char *name, const char *axis, bool by_seconds) {
    char path[1024];
    plot p = { .y_low = 0.003, .y_high = 1.0, .log_x = 1, .log_y = 1 };
    p.x_low = by_seconds ? 0.01 : 1.0, p.x_high = by_seconds ? 30.0 : 5000.0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (!plot_begin(&p, path, "Relative error against the full matrix", axis)) return false;
    for (int i = 1; i < METHODS; i++)
        plot_curve(&p, NAMES[i], by_seconds ? b->outcomes[i].at_s : b->outcomes[i].shots, b->outcomes[i].errors,
                   b->outcomes[i].points);
    plot_end(&p);
    return true;
}

/* ---- pictures ---- */

static uint8_t code_value(float linear) {
    double x = fmin(fmax(linear, 0.0), 1.0);
    return (uint8_t)(255.0 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055) + 0.5);
}

/* Elements as triangles with corners of their own. */
static void make_triangles(const room *r, const double *B, double *positions, float *colors, uint32_t *indices,
                           size_t *count) {
    /* A white wall in the middle of the room comes out at about half of the display's range. */
    const double exposure = 0.4;
    size_t corner_count = 0;
    for (size_t i = 0; i < r->mesh.element_count; i++) {
        const element *e = &r->mesh.elements[i];
        for (int t = 1; t + 1 < element_corner_count(e); t++)
            for (int k = 0; k < 3; k++) {
                uint32_t corner = e->corner[k == 0 ? 0 : t + k - 1];
                vec3_copy(positions + 3 * corner_count, r->vertices + 3 * (size_t)corner);
                for (size_t c = 0; c < 3; c++) colors[3 * corner_count + c] = (float)(exposure * B[3 * i + c]);
                indices[corner_count] = (uint32_t)corner_count;
                corner_count++;
            }
    }
    *count = corner_count / 3;
}

static bool write_png(const char *name, const float *pixels) {
    char path[1024];
    unsigned char *bytes = NULL;
    size_t size = 0;
    uint8_t *rgba = malloc(4 * (size_t)WIDTH * HEIGHT);
    if (!rgba) return false;
    for (size_t i = 0; i < 4 * (size_t)WIDTH * HEIGHT; i++) rgba[i] = i % 4 == 3 ? 255 : code_value(pixels[i]);
    bool ok = png_encode(rgba, WIDTH, HEIGHT, &bytes, &size) == HEMI_OK;
    snprintf(path, sizeof path, "%s/%s.png", folder, name);
    FILE *f = ok ? fopen(path, "wb") : NULL;
    ok = f && fwrite(bytes, 1, size, f) == size;
    if (f) fclose(f);
    free(bytes);
    free(rgba);
    return ok;
}

/* From where the front wall is, which is culled. */
static bool draw(const bench *b, int i) {
    const room *r = &b->paper.room;
    size_t corners = 6 * r->mesh.element_count;
    picture p = { .eye = { 1.5, -2.3, 1.75 },
                  .target = { 1.5, 1.5, 1.35 },
                  .up = { 0, 0, 1 },
                  .vertical_fov = 0.95,
                  .width = WIDTH,
                  .height = HEIGHT,
                  .supersample = 3,
                  .flat = true };
    char message[200] = "out of memory";
    double *positions = malloc(3 * corners * sizeof *positions);
    float *colors = malloc(3 * corners * sizeof *colors), *pixels = malloc(4 * (size_t)WIDTH * HEIGHT * sizeof *pixels);
    uint32_t *indices = malloc(corners * sizeof *indices);
    bool ok = positions && colors && pixels && indices;
    if (ok) {
        make_triangles(r, b->outcomes[i].B, positions, colors, indices, &p.triangle_count);
        p.positions = positions, p.colors = colors, p.indices = indices, p.vertex_count = 3 * p.triangle_count;
        ok = picture_draw(&p, pixels, message, sizeof message) && write_png(PICTURES[i], pixels);
    }
    if (!ok) fprintf(stderr, "%s: %s\n", PICTURES[i], message);
    free(positions);
    free(colors);
    free(pixels);
    free(indices);
    return ok;
}

int main(int argc, char **argv) {
    static bench b;
    bool ok = true;
    if (argc > 1) folder = argv[1];
    paper_room_create(&b.paper);
    b.jobs = jobs_create(0);
    b.scratch = malloc(3 * PAPER_ELEMENTS * sizeof *b.scratch);
    for (int i = 0; i < METHODS; i++) b.outcomes[i].B = malloc(3 * PAPER_ELEMENTS * sizeof *b.outcomes[i].B);
    printf("%zu patches, %zu elements, hemi-cubes %d (emitter) and %d\n", b.paper.room.mesh.patch_count,
           b.paper.room.mesh.element_count, PAPER_HEMICUBE_LIGHT, PAPER_HEMICUBE);
    ok = b.paper.room.mesh.patch_count == PAPER_PATCHES && b.paper.room.mesh.element_count == PAPER_ELEMENTS;
    for (int i = 0; ok && i < METHODS; i++) ok = run_method(&b, i, i > 0);
    if (ok) {
        print_curves(&b);
        ok = plot_errors(&b, "figure12-shots.svg", "shots", false) &&
             plot_errors(&b, "figure12-seconds.svg", "seconds", true);
        print_results(&b);
    }
    for (int i = 0; ok && i < METHODS; i++) ok = !PICTURES[i] || draw(&b, i);
    for (int i = 0; i < METHODS; i++) free(b.outcomes[i].B);
    free(b.scratch);
    jobs_destroy(b.jobs);
    paper_room_free(&b.paper);
    return ok ? 0 : 1;
}
