/* SPDX-License-Identifier: MIT
 * Do the four methods agree where they must, and is the full matrix solved as linear algebra solves it?
 */
#include "accuracy/paper_room.h"
#include "check.h"
#include "solver/full_matrix.h"
#include "solver/subdivision.h"

enum { RESOLUTION = 100 };

/* A room with a block on lines of the floor's grid and an emitter. */
typedef struct furnished {
    room room;
    mesh_items patches, elements;
    jobs *jobs;
} furnished;

static void furnish(furnished *f, int patches, int elements) {
    room *r = &f->room;
    memset(f, 0, sizeof *f);
    room_start(r);
    uint32_t walls = room_material(r, 0.6, 0), emitter = room_material(r, 0.1, 10);
    room_box(r, (double[]){ -2, -2, 0 }, (double[]){ 2, 2, 3 }, true, walls, patches, elements);
    room_box(r, (double[]){ -2. / 3, -2. / 3, 0 }, (double[]){ 2. / 3, 2. / 3, 1 }, false, walls, 1, elements);
    room_quad(r, (double[]){ -0.5, -0.5, 2.5 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, emitter, 1, 2);
    room_finish(r);
    CHECK(mesh_items_create(&r->scene, &r->mesh, MESH_PATCHES, &r->memory, &f->patches));
    CHECK(mesh_items_create(&r->scene, &r->mesh, MESH_ELEMENTS, &r->memory, &f->elements));
    f->jobs = jobs_create(2);
}

static void clear(furnished *f) {
    jobs_destroy(f->jobs);
    room_free(&f->room);
}

static progressive_setup setup_of(furnished *f, solver_method method) {
    progressive_setup setup = { .method = method,
                                .columns = room_columns(&f->room, RESOLUTION, 3),
                                .patches = &f->patches,
                                .jobs = f->jobs,
                                .unshot_target = 1e-8,
                                .start_s = paper_seconds(),
                                .memory_limit = UINT64_C(1) << 30,
                                .clock = paper_seconds };
    setup.columns.elements = &f->elements;
    return setup;
}

static double *radiosity(furnished *f, solver_method method, progressive_result *out) {
    char message[200] = "";
    progressive_setup setup = setup_of(f, method);
    double *B = malloc(3 * f->room.mesh.element_count * sizeof *B);
    CHECK(progressive_solve(&setup, out, message, sizeof message) == NULL);
    CHECK_TEXT(message, "");
    CHECK(out->converged && energy_residual(&out->books) <= 1e-9);
    paper_radiosity(&f->room, out->irradiance, B);
    free(f->room.weights);
    f->room.weights = NULL;
    return B;
}

/* ---- the full matrix ---- */

/* Gaussian elimination with pivots; a[n*i+j], b[i] becomes x. */
static void eliminate(size_t n, double *a, double *b) {
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k; i < n; i++)
            if (fabs(a[n * i + k]) > fabs(a[n * pivot + k])) pivot = i;
        for (size_t j = 0; j < n; j++) {
            double t = a[n * k + j];
            a[n * k + j] = a[n * pivot + j], a[n * pivot + j] = t;
        }
        double t = b[k];
        b[k] = b[pivot], b[pivot] = t;
        for (size_t i = k + 1; i < n; i++) {
            double f = a[n * i + k] / a[n * k + k];
            for (size_t j = k; j < n; j++) a[n * i + j] -= f * a[n * k + j];
            b[i] -= f * b[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++) b[k] -= a[n * k + j] * b[j];
        b[k] /= a[n * k + k];
    }
}

/* Eq. 1 on patches by elimination, then eq. 4: what fm must give. */
static void fm_solves_its_equations(void) {
    furnished f;
    progressive_result result;
    char message[200] = "";
    furnish(&f, 3, 3);
    const mesh *m = &f.room.mesh;
    size_t n = m->patch_count;
    column **columns = calloc(n, sizeof *columns);
    column_setup setup = room_columns(&f.room, RESOLUTION, 3);
    const full_matrix_setup matrix = { .columns = &setup, .patches = &f.patches, .jobs = f.jobs };
    CHECK(full_matrix_compute(&matrix, columns, message, sizeof message) == NULL);
    double *a = calloc(n * n, sizeof *a), *b = calloc(n, sizeof *b), worst_row = 0.0;
    for (size_t i = 0; i < n; i++) {
        const material *p = &f.room.materials[f.room.surfaces[m->patches[i].surface].material];
        double row = 0.0;
        a[n * i + i] += 1.0;
        b[i] = p->M[0];
        for (size_t j = 0; j < n; j++)
            a[n * i + j] -= p->rho[0] * columns[j]->runs[i].factor, row += columns[j]->runs[i].factor;
        worst_row = fmax(worst_row, fabs(row - columns[i]->closure.front));
    }
    /* What the pixels show of fronts, patch by patch; factors are floats. */
    CHECK_NEAR(worst_row, 0.0, 1e-6);
    eliminate(n, a, b);
    free(f.room.weights);
    f.room.weights = NULL;
    double *B = radiosity(&f, SOLVER_FM, &result), worst = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        const material *p = &f.room.materials[f.room.surfaces[m->patches[m->elements[e].patch].surface].material];
        double E = 0.0;
        for (size_t j = 0; j < n; j++) E += columns[j]->factors[m->elements[e].first_sample] * b[j];
        worst = fmax(worst, fabs(B[3 * e] - p->M[0] - p->rho[0] * E) / b[0]);
    }
    printf("fm against elimination: %zu unknowns, worst element off by %.2g\n", n, worst);
    CHECK(b[0] > 0.01);
    /* Relative to a corner of the floor: 1e-8 of the emitted power is unshot, and factors are floats (6e-8). */
    CHECK_NEAR(worst, 0.0, 1e-6);
    for (size_t j = 0; j < n; j++) column_destroy(columns[j]);
    progressive_result_free(&result);
    free(columns);
    free(a);
    free(b);
    free(B);
    clear(&f);
}

static void the_matrix_says_what_it_takes(void) {
    furnished f;
    furnish(&f, 3, 3);
    progressive_setup setup = setup_of(&f, SOLVER_FM);
    CHECK_EQUAL(progressive_memory(&setup), 4 * f.room.mesh.patch_count * f.room.mesh.sample_count);
    setup.method = SOLVER_PR;
    CHECK_EQUAL(progressive_memory(&setup), 0);
    clear(&f);
}

/* ---- all four ---- */

static void methods_agree_as_far_as_they_can(void) {
    furnished f;
    progressive_result results[4];
    double *B[4];
    furnish(&f, 9, 2);
    for (int i = 0; i < 4; i++) B[i] = radiosity(&f, (solver_method)i, &results[i]);
    double apart = paper_error(&f.room, B[SOLVER_ANALYTIC], B[SOLVER_HYBRID]);
    double fm = paper_error(&f.room, B[SOLVER_FM], B[SOLVER_HYBRID]),
           pr = paper_error(&f.room, B[SOLVER_FM], B[SOLVER_PR]);
    printf("hybrid - analytic %.4f, hybrid - fm %.4f, pr - fm %.4f\n", apart, fm, pr);
    /* Point estimates are off by 2.5 % at worst, either way, and far ones matter little. */
    CHECK(apart > 0.0 && apart < 0.005);
    /* Elements' centres against their means, and the aliasing of 100 pixels. */
    CHECK(fm < 0.04);
    /* What the paper is about. */
    CHECK(pr > 2 * fm);
    CHECK_EQUAL(results[SOLVER_ANALYTIC].analytic, results[SOLVER_ANALYTIC].evaluations);
    CHECK_EQUAL(results[SOLVER_PR].analytic, 0);
    CHECK(results[SOLVER_HYBRID].analytic > 0 && results[SOLVER_HYBRID].analytic < results[SOLVER_HYBRID].evaluations);
    for (int i = 0; i < 4; i++) {
        uint64_t analytic = 0, evaluations = 0, shots = 0;
        for (size_t k = 0; k < results[i].shooter_count; k++) {
            analytic += results[i].shooters[k].analytic;
            evaluations += results[i].shooters[k].evaluations;
            shots += results[i].shooters[k].shots;
        }
        /* What is listed by shooter is what is counted in all. */
        CHECK_EQUAL(analytic, results[i].analytic);
        CHECK_EQUAL(shots, results[i].shots);
        if (i != SOLVER_PR) CHECK_EQUAL(evaluations, results[i].evaluations);
        progressive_result_free(&results[i]);
        free(B[i]);
    }
    clear(&f);
}

/* ---- the original's subdivision ---- */

static void a_shooter_is_cut_into_four_that_keep_its_light(void) {
    furnished f;
    shooters s;
    furnish(&f, 3, 4);
    CHECK(shooters_create(&f.room.scene, &f.room.mesh, NULL, &s));
    const uint32_t index = 4;
    const patch *p = &f.room.mesh.patches[index];
    double *B = malloc(3 * p->sample_count * sizeof *B), mean[3] = { 0, 0, 0 };
    for (uint32_t k = 0; k < p->sample_count; k++)
        for (size_t c = 0; c < 3; c++) {
            B[3 * k + c] = 1 + (double)c + f.room.mesh.x[p->first_sample + k];
            mean[c] += B[3 * k + c] * f.room.mesh.sample_area[p->first_sample + k] / p->area;
        }
    vec3_copy(s.all[index].unshot, mean);
    CHECK(subdivision_is_possible(&s, index));
    CHECK(subdivision_quarter(&s, index, B));
    double area = 0.0, power[3] = { 0, 0, 0 };
    for (int q = 0; q < 4; q++) {
        const shooter *part = &s.all[s.all[index].quarters[q]];
        area += part->subpatch.area;
        CHECK_EQUAL(shooter_depth(part), 1);
        CHECK(part->unshot[0] > 0.0);
        for (int c = 0; c < 3; c++) power[c] += part->unshot[c] * part->subpatch.area;
    }
    /* Sums of 64 products. */
    CHECK_NEAR(area, p->area, 1e-12);
    for (int c = 0; c < 3; c++) CHECK_NEAR(power[c], mean[c] * p->area, 1e-12);
    CHECK(!shooter_is_whole(&s.all[index]) && !subdivision_is_possible(&s, index));
    free(B);
    shooters_free(&s);
    clear(&f);
}

int main(void) {
    RUN(fm_solves_its_equations);
    RUN(the_matrix_says_what_it_takes);
    RUN(methods_agree_as_far_as_they_can);
    RUN(a_shooter_is_cut_into_four_that_keep_its_light);
    return check_end();
}
