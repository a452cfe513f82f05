/* SPDX-License-Identifier: MIT
 * Do fine elements get what they would have got, had they been there from the beginning? And do near shooters shoot by
 * their elements?
 */
#include "adapt/refined_gather.h"
#include "check.h"
#include "room.h"
#include "solver/progressive.h"

#include <time.h>

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Every element of a room in four. */
typedef struct quartered {
    arena memory;
    mesh fine;
    fine_place *places;
} quartered;

static void quarter(room *r, quartered *q) {
    static const double u[4] = { 0, 0.5, 0.5, 0 }, v[4] = { 0, 0, 0.5, 0.5 };
    memset(q, 0, sizeof *q);
    q->fine = r->mesh;
    q->fine.element_count = 4 * r->mesh.element_count;
    q->fine.patches = arena_alloc(&q->memory, r->mesh.patch_count, sizeof *q->fine.patches);
    q->fine.elements = arena_alloc(&q->memory, q->fine.element_count, sizeof *q->fine.elements);
    q->places = arena_alloc(&q->memory, q->fine.element_count, sizeof *q->places);
    for (size_t p = 0; p < r->mesh.patch_count; p++) {
        q->fine.patches[p] = r->mesh.patches[p];
        q->fine.patches[p].first_element *= 4;
        q->fine.patches[p].element_count *= 4;
    }
    for (size_t e = 0; e < r->mesh.element_count; e++) {
        const uint32_t *c = r->mesh.elements[e].corner;
        uint32_t grid[9];
        for (int i = 0; i < 9; i++) {
            double x = 0.5 * (i % 3), y = 0.5 * (i / 3), at[3];
            const double w[4] = { (1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y };
            for (int k = 0; k < 3; k++) {
                at[k] = 0.0;
                for (int j = 0; j < 4; j++) at[k] += w[j] * r->vertices[3 * (size_t)c[j] + (size_t)k];
            }
            grid[i] = room_vertex(r, at);
        }
        for (int k = 0; k < 4; k++) {
            int first = (int)(2 * u[k]) + 3 * (int)(2 * v[k]);
            q->fine.elements[4 * e + (size_t)k] =
                (element){ .corner = { grid[first], grid[first + 1], grid[first + 4], grid[first + 3] },
                           .material = r->mesh.elements[e].material };
            q->places[4 * e + (size_t)k] = (fine_place){ (uint32_t)e, (float)u[k], (float)v[k], 0.5f };
        }
    }
    CHECK(mesh_measure(&q->fine, &q->memory));
}

static bool solve(const column_setup *columns, jobs *j, progressive_result *out) {
    char message[160] = "";
    const progressive_setup setup = { .columns = *columns,
                                      .jobs = j,
                                      .unshot_target = 1e-5,
                                      .even_shooters = true, /* as they shoot here, without a gradient */
                                      .start_s = seconds(),
                                      .memory_limit = UINT64_C(1) << 30,
                                      .clock = seconds };
    bool ok = !progressive_solve(&setup, out, message, sizeof message);
    CHECK(ok);
    return ok;
}

static bool gather(const quartered *q, progressive_result *solved, const shooter_gradient *near, double tolerance,
                   refined_gather_result *out) {
    char message[160] = "";
    const refined_gather_setup setup = { .store = &solved->store,
                                         .irradiance = solved->irradiance,
                                         .row_sum = solved->row_sum,
                                         .gradient = near,
                                         .fine = &q->fine,
                                         .places = q->places,
                                         .tolerance = tolerance };
    bool ok = !refined_gather(&setup, out, message, sizeof message);
    CHECK(ok);
    return ok;
}

/* Relative rms difference over the samples of a mesh. */
static double difference(const mesh *m, const double *a, const double *b) {
    double off = 0.0, all = 0.0;
    for (size_t s = 0; s < m->sample_count; s++)
        for (size_t c = 0; c < 3; c++) {
            off += m->sample_area[s] * (a[3 * s + c] - b[3 * s + c]) * (a[3 * s + c] - b[3 * s + c]);
            all += m->sample_area[s] * b[3 * s + c] * b[3 * s + c];
        }
    return sqrt(off / all);
}

/* Each patch as elements x elements of them. */
static void make_furnished_room(room *r, int elements) {
    room_start(r);
    uint32_t walls = room_material(r, 0.7, 0), box = room_material(r, 0.4, 0), emitter = room_material(r, 0.0, 10);
    room_box(r, (double[]){ -2, -2, 0 }, (double[]){ 2, 2, 3 }, true, walls, 4, elements);
    room_box(r, (double[]){ 0.3, 0.2, 0 }, (double[]){ 1.2, 1.1, 1 }, false, box, 2, elements);
    room_quad(r, (double[]){ -0.5, -0.5, 2.9 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, emitter, 1, elements);
    room_finish(r);
}

/* The sample of patch p of a mesh that lies where a point does. */
static uint32_t sample_at(const mesh *m, uint32_t p, const double point[3]) {
    for (uint32_t s = m->patches[p].first_sample; s < m->patches[p].first_sample + m->patches[p].sample_count; s++) {
        const double here[3] = { m->x[s], m->y[s], m->z[s] };
        if (vec3_distance(here, point) < 1e-9) return s;
    }
    CHECK(!"a sample at the point");
    return 0;
}

/* What the fine elements of a mesh receive when the light settles on them from the beginning: irradiance[3*s+c] of the
 * samples of fine; from malloc. */
static double *settle_finely(const mesh *fine, jobs *j) {
    room r;
    progressive_result solved;
    double *irradiance = calloc(3 * fine->sample_count, sizeof *irradiance);
    make_furnished_room(&r, 4);
    CHECK_EQUAL(r.mesh.sample_count, fine->sample_count);
    CHECK_EQUAL(r.mesh.patch_count, fine->patch_count);
    const column_setup columns = room_columns(&r, 64, 2);
    if (solve(&columns, j, &solved))
        for (uint32_t p = 0; p < fine->patch_count; p++)
            for (uint32_t k = 0; k < fine->patches[p].sample_count; k++) {
                uint32_t s = fine->patches[p].first_sample + k;
                const double point[3] = { fine->x[s], fine->y[s], fine->z[s] };
                uint32_t from = sample_at(&r.mesh, p, point);
                memcpy(irradiance + 3 * (size_t)s, solved.irradiance + 3 * (size_t)from, 3 * sizeof *irradiance);
            }
    progressive_result_free(&solved);
    room_free(&r);
    return irradiance;
}

static void fine_elements_get_what_they_would_have_got_from_the_beginning(void) {
    room r;
    quartered q;
    progressive_result solved;
    refined_gather_result fine = { 0 };
    make_furnished_room(&r, 2);
    jobs *j = jobs_create(2);
    const column_setup columns = room_columns(&r, 64, 2);
    if (solve(&columns, j, &solved)) {
        quarter(&r, &q);
        double *settled = settle_finely(&q.fine, j);
        if (gather(&q, &solved, NULL, 5e-4, &fine)) {
            double off = difference(&q.fine, fine.irradiance, settled);
            printf("received at the end instead of from the beginning: irradiance differs by %.2f %%\n", 100 * off);
            /* Elements of half the size leave a quarter of the two percent by which coarse ones are off. */
            CHECK(off < 8e-3);
        }
        refined_gather_free(&fine);
        free(settled);
        arena_free(&q.memory);
    }
    progressive_result_free(&solved);
    jobs_destroy(j);
    room_free(&r);
}

static void what_is_interpolated_is_nearly_what_is_received_one_by_one(void) {
    room r;
    quartered q;
    progressive_result solved;
    refined_gather_result all = { 0 }, some = { 0 };
    make_furnished_room(&r, 2);
    jobs *j = jobs_create(2);
    const column_setup columns = room_columns(&r, 64, 2);
    if (solve(&columns, j, &solved)) {
        quarter(&r, &q);
        if (gather(&q, &solved, NULL, 0.0, &all) && gather(&q, &solved, NULL, 5e-4, &some)) {
            double off = difference(&q.fine, some.irradiance, all.irradiance);
            printf("received finely: %.1f %% of pairs instead of %.1f %%; irradiance differs by %.2f %%\n",
                   100.0 * (double)some.fine / (double)some.pairs, 100.0 * (double)all.fine / (double)all.pairs,
                   100 * off);
            /* A percent of discretisation is what elements of this size leave; a tenth of it may be lost here. */
            CHECK(off < 1e-3);
            CHECK(some.fine < all.fine);
        }
        refined_gather_free(&all);
        refined_gather_free(&some);
        arena_free(&q.memory);
    }
    progressive_result_free(&solved);
    jobs_destroy(j);
    room_free(&r);
}

static void a_furnace_is_even_on_fine_elements_too(void) {
    room r;
    quartered q;
    progressive_result solved;
    refined_gather_result fine = { 0 };
    const double rho = 0.8, M = 2.0, exact = M / (1 - rho);
    double worst = 0.0;
    room_start(&r);
    room_box(&r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(&r, rho, M), 3, 2);
    room_finish(&r);
    jobs *j = jobs_create(2);
    const column_setup columns = room_columns(&r, 64, 2);
    if (solve(&columns, j, &solved)) {
        quarter(&r, &q);
        CHECK(solved.rows_closed);
        if (gather(&q, &solved, NULL, 5e-4, &fine))
            for (size_t i = 0; i < 3 * q.fine.sample_count; i++)
                worst = fmax(worst, fabs((M + rho * fine.irradiance[i]) / exact - 1));
        printf("furnace: worst fine sample off by %.2g\n", worst);
        /* As for the coarse ones (progressive_test.c): what is unshot. */
        CHECK_NEAR(worst, 0.0, 1e-4);
        refined_gather_free(&fine);
        arena_free(&q.memory);
    }
    progressive_result_free(&solved);
    jobs_destroy(j);
    room_free(&r);
}

/* A wall that is bright below and dark above, as one patch, beside a floor that reflects nothing: next to the wall the
 * floor gets what the wall's elements give, by their closed forms, and not what their mean does. */
static void a_near_shooter_shoots_by_its_elements(void) {
    room r;
    shooter_gradient near;
    room_start(&r);
    uint32_t black = room_material(&r, 0.0, 0), grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, black, 1, 4);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 }, grey, 1, 4);
    room_finish(&r);
    const mesh *m = &r.mesh;
    double *irradiance = calloc(3 * m->sample_count, sizeof *irradiance),
           *row_sum = calloc(m->sample_count, sizeof *row_sum);
    const patch *wall = &m->patches[1];
    for (uint32_t s = wall->first_sample; s < wall->first_sample + wall->sample_count; s++)
        for (size_t c = 0; c < 3; c++) irradiance[3 * (size_t)s + c] = 10 * (1 - m->z[s]);
    const bool crossed[2] = { false, false };
    CHECK(shooter_gradient_create(&r.scene, m, irradiance, row_sum, crossed, NULL, &near));
    column_setup columns = room_columns(&r, 64, 0);
    char message[160];
    column_worker *w = column_worker_create(&columns, message, sizeof message);
    column *c = room_column(&columns, w, 1);
    const column_receiver floor = column_patch_receiver(m, 0);
    const subpatch from = subpatch_of_patch(&r.scene, m, 1);
    double *scratch = calloc(SHOOTER_GRADIENT_SCRATCH * floor.sample_count, sizeof *scratch);
    double *E = calloc(3 * floor.sample_count, sizeof *E);
    CHECK(shooter_gradient_reaches(&near, &from, &floor));
    CHECK_EQUAL(c->run_count, 1);
    shooter_gradient_add(&near, c, &from, m, &floor, c->factors, scratch, E);
    for (uint32_t k = 0; k < floor.sample_count; k++) {
        const double point[3] = { m->x[floor.first_sample + k], m->y[floor.first_sample + k], 0 }, up[3] = { 0, 0, 1 };
        double exact = 0.0;
        for (uint32_t e = wall->first_element; e < wall->first_element + wall->element_count; e++) {
            polygon shape = { .count = 4 };
            double B = 0.0;
            for (int i = 0; i < 4; i++) vec3_copy(shape.corner[i], m->vertices + 3 * (size_t)m->elements[e].corner[i]);
            for (uint32_t i = 0; i < 4; i++) B += 0.5 * irradiance[3 * (size_t)(m->elements[e].first_sample + i)] / 4;
            exact += B * polygon_factor(&shape, point, up);
        }
        /* The column's factors are floats, and its clearance over the floor a millionth of the scene. */
        CHECK_NEAR(E[3 * k] + c->factors[k] * 2.5, exact, 1e-4 * exact);
    }
    free(scratch);
    free(E);
    free(irradiance);
    free(row_sum);
    column_destroy(c);
    column_worker_destroy(w);
    shooter_gradient_free(&near);
    room_free(&r);
}

int main(void) {
    RUN(fine_elements_get_what_they_would_have_got_from_the_beginning);
    RUN(what_is_interpolated_is_nearly_what_is_received_one_by_one);
    RUN(a_furnace_is_even_on_fine_elements_too);
    RUN(a_near_shooter_shoots_by_its_elements);
    return check_end();
}
