/* SPDX-License-Identifier: MIT
 * Does the solver settle where theory says, with books that close, whatever the memory and the threads?
 */
#include "check.h"
#include "room.h"
#include "solver/progressive.h"

#include <time.h>

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static progressive_setup setup_of(room *r, jobs *j, double unshot_target) {
    return (progressive_setup){ .columns = room_columns(r, 64, 2),
                                .jobs = j,
                                .unshot_target = unshot_target,
                                .start_s = seconds(),
                                .memory_limit = UINT64_C(1) << 30,
                                .clock = seconds };
}

static bool solve(const progressive_setup *setup, progressive_result *out) {
    char message[160] = "";
    const char *failure = progressive_solve(setup, out, message, sizeof message);
    if (failure) fprintf(stderr, "solver: %s\n", failure);
    CHECK(failure == NULL);
    return failure == NULL;
}

/* ---- scenes ---- */

static void make_box(room *r, double rho, double M) {
    room_start(r);
    room_box(r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(r, rho, M), 3, 3);
    room_finish(r);
}

static void make_hollow_sphere(room *r, double rho, double M) {
    room_start(r);
    room_sphere(r, (double[]){ 1, 2, 3 }, 1.5, true, room_material(r, rho, M), 14, 8, 2);
    room_finish(r);
}

/* A corridor whose floor and one wall are strips 300 times as long as wide. */
static void make_slivers(room *r, double rho, double M) {
    static const double x = 9, y = 1, z = 1.2;
    const double corners[6][4][3] = {
        { { 0, 0, 0 }, { x, 0, 0 }, { x, y, 0 }, { 0, y, 0 } }, { { 0, 0, z }, { 0, y, z }, { x, y, z }, { x, 0, z } },
        { { 0, 0, 0 }, { 0, y, 0 }, { 0, y, z }, { 0, 0, z } }, { { x, 0, 0 }, { x, 0, z }, { x, y, z }, { x, y, 0 } },
        { { 0, y, 0 }, { x, y, 0 }, { x, y, z }, { 0, y, z } }, { { x, 0, 0 }, { 0, 0, 0 }, { 0, 0, z }, { x, 0, z } },
    };
    room_start(r);
    uint32_t grey = room_material(r, rho, M);
    for (int i = 0; i < 6; i++) {
        bool strips = i == 0 || i == 4;
        room_grid(r, corners[i], grey, strips ? &(room_cuts){ 1, 33, 12, 1 } : &(room_cuts){ 4, 4, 2, 2 });
    }
    room_finish(r);
}

/* A closed room with a box on its floor and an emitter under its ceiling: shadows, corners and something that stands.
 */
static void make_furnished_room(room *r) {
    room_start(r);
    uint32_t walls = room_material(r, 0.7, 0), box = room_material(r, 0.4, 0), emitter = room_material(r, 0.0, 10);
    r->materials[box] = (material){ .rho = { 0.8, 0.3, 0.1 }, .M = { 0, 0, 0 } };
    room_box(r, (double[]){ -2, -2, 0 }, (double[]){ 2, 2, 3 }, true, walls, 3, 3);
    room_box(r, (double[]){ 0.3, 0.2, 0 }, (double[]){ 1.2, 1.1, 1 }, false, box, 1, 3);
    room_quad(r, (double[]){ -0.5, -0.5, 2.9 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, emitter, 1, 2);
    room_finish(r);
}

/* Two squares under an open sky. */
static void make_open_scene(room *r) {
    room_start(r);
    uint32_t emitter = room_material(r, 0.2, 5), grey = room_material(r, 0.5, 0);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, emitter, 2, 3);
    room_quad(r, (double[]){ 0, 0, 1 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, grey, 2, 3);
    room_finish(r);
}

/* ---- the furnace ---- */

/* A room that glows evenly: all its walls emit, or all get as much from outside. */
typedef struct furnace {
    const char *name;
    void (*make)(room *, double, double);
    bool reflectors;  /* light arrives and nothing emits, so that factors are found as reflectors' are */
    double row_error; /* what no sum of a row may be off by */
} furnace;

static const furnace FURNACES[] = {
    /* Closed forms, at midpoints of elements of a third of a metre: columns are scaled to give away what there is, and
     * what they miss in the corners makes rows 0.1 % too bright. */
    { "box", make_box, false, 0.002 },
    { "hollow sphere", make_hollow_sphere, false, 0.0003 },
    /* The samples of a strip are 3 cm apart across and 38 along it. */
    { "slivers", make_slivers, false, 0.02 },
    /* Closed forms again, since nothing is five diameters away. */
    { "box that reflects", make_box, true, 0.002 },
    /* Point estimates of what is: off by 2.5 % at worst, some one way and some the other. */
    { "hollow sphere that reflects", make_hollow_sphere, true, 0.002 },
};
enum { FURNACE_COUNT = sizeof FURNACES / sizeof *FURNACES };

static double furthest_row(const room *r, const progressive_result *result) {
    double furthest = 0.0;
    for (size_t s = 0; s < r->mesh.sample_count; s++) furthest = fmax(furthest, fabs(result->row_sum[s] - 1));
    return furthest;
}

/* A row is corrected by what it was off by and no more; corrections are floats of a few percent. */
static void check_corrections(const furnace *f, const room *r, const progressive_result *result) {
    for (size_t s = 0; s < r->mesh.sample_count; s++) {
        double factor = row_closure_factor(result->kept.rows.correction[s], !f->reflectors);
        CHECK_NEAR(factor * result->row_sum[s], 1.0, 1e-8);
    }
}

static void check_furnace(const furnace *f, double rho, bool open_rows) {
    room r;
    progressive_result result;
    const double M = 2.0, exact = M / (1 - rho);
    f->make(&r, rho, f->reflectors ? 0.0 : M);
    jobs *j = jobs_create(2);
    progressive_setup setup = setup_of(&r, j, 1e-5);
    double *arrived = malloc(3 * r.mesh.sample_count * sizeof *arrived);
    for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) arrived[i] = M;
    if (f->reflectors) setup.arrived = arrived;
    setup.open_rows = open_rows;
    if (solve(&setup, &result)) {
        double furthest = furthest_row(&r, &result), worst = 0.0;
        for (size_t i = 0; i < 3 * r.mesh.sample_count; i++)
            worst = fmax(worst, fabs(result.irradiance[i] / exact - 1));
        printf("furnace, %s, rho %.2f, %s rows: rows off by up to %.2g, irradiance by %.2g, %u shots, %zu patches\n",
               f->name, rho, open_rows ? "open" : "closed", furthest, worst, result.shots, r.mesh.patch_count);
        CHECK(result.converged);
        CHECK_EQUAL(result.rows_closed, !open_rows);
        CHECK_NEAR(furthest, 0.0, f->row_error);
        if (!open_rows) check_corrections(f, &r, &result);
        /* With rows that sum to 1 what is unshot, 1e-5 of the emitted power, is all that is missing: each watt of it is
         * rho watts of M / (1 - rho) - M, however often it is reflected. Factors are floats: 6e-8 / (1 - rho). Rows
         * that are off by d add d / (1 - rho). */
        CHECK_NEAR(worst, 0.0, 1e-4 + (open_rows ? furthest / (1 - rho) : 0.0));
    }
    progressive_result_free(&result);
    free(arrived);
    jobs_destroy(j);
    room_free(&r);
}

static void a_closed_room_that_glows_evenly_settles_at_M_over_1_minus_rho(void) {
    for (int k = 0; k < FURNACE_COUNT; k++) {
        check_furnace(&FURNACES[k], 0.5, false);
        check_furnace(&FURNACES[k], 0.9, false);
        check_furnace(&FURNACES[k], 0.99, false);
    }
}

static void with_rows_as_they_come_it_settles_as_near_as_these_are_to_1(void) {
    for (int k = 0; k < FURNACE_COUNT; k++) {
        check_furnace(&FURNACES[k], 0.5, true);
        check_furnace(&FURNACES[k], 0.9, true);
    }
}

/* ---- energy ---- */

static void every_watt_is_booked(void) {
    void (*const scenes[])(room *) = { make_furnished_room, make_open_scene };
    for (int i = 0; i < 2; i++) {
        room r;
        progressive_result result;
        scenes[i](&r);
        jobs *j = jobs_create(2);
        progressive_setup setup = setup_of(&r, j, 1e-3);
        setup.even_shooters = true; /* the books know shooters by their means */
        if (solve(&setup, &result)) {
            double emitted = 0.0, reflected = 0.0, absorbed = 0.0;
            for (size_t p = 0; p < r.mesh.patch_count; p++) {
                const patch *owner = &r.mesh.patches[p];
                const material *m = &r.materials[r.surfaces[owner->surface].material];
                for (int c = 0; c < 3; c++) {
                    emitted += m->M[c] * owner->area;
                    for (uint32_t s = owner->first_sample; s < owner->first_sample + owner->sample_count; s++) {
                        double W = r.mesh.sample_area[s] * result.irradiance[3 * (size_t)s + (size_t)c];
                        reflected += m->rho[c] * W;
                        absorbed += (1 - m->rho[c]) * W;
                    }
                }
            }
            /* Sums of a few thousand products. */
            CHECK_NEAR(result.books.emitted / emitted, 1.0, 1e-12);
            CHECK(energy_residual(&result.books) <= 1e-9);
            CHECK_NEAR((result.books.absorbed + result.books.escaped + result.books.unshot) / emitted, 1.0, 1e-9);
            CHECK(result.books.unshot >= 0.0 && result.books.unshot <= 1e-3 * emitted);
            CHECK(result.books.absorbed > 0.0 && result.books.escaped >= 0.0);
            /* What the samples received is what was booked: factors are kept as floats (6e-8 each), and the books add
             * what no sample could see. */
            CHECK(absorbed <= result.books.absorbed * (1 + 1e-6));
            CHECK_NEAR(absorbed / result.books.absorbed, 1.0, i == 0 ? 0.05 : 1e-6);
            CHECK(reflected > 0.0);
            if (i == 0) CHECK_NEAR(result.books.escaped / emitted, 0.0, 1e-9); /* no sky in a closed room */
            if (i == 1) CHECK(result.books.escaped > 0.5 * emitted);
        }
        progressive_result_free(&result);
        jobs_destroy(j);
        room_free(&r);
    }
}

/* ---- the same light whatever the memory and the threads ---- */

static bool solve_room(unsigned threads, uint64_t memory_limit, progressive_result *out, size_t *sample_count) {
    room r;
    make_furnished_room(&r);
    jobs *j = jobs_create(threads);
    progressive_setup setup = setup_of(&r, j, 1e-3);
    setup.memory_limit = memory_limit;
    *sample_count = r.mesh.sample_count;
    bool ok = solve(&setup, out);
    jobs_destroy(j);
    room_free(&r);
    return ok;
}

static void a_bake_without_room_for_columns_gives_the_same_light(void) {
    progressive_result kept, dropped;
    size_t n;
    if (solve_room(2, UINT64_C(1) << 30, &kept, &n) && solve_room(2, 1, &dropped, &n)) {
        double worst = 0.0, largest = 0.0;
        for (size_t i = 0; i < 3 * n; i++) {
            worst = fmax(worst, fabs(kept.irradiance[i] - dropped.irradiance[i]));
            largest = fmax(largest, kept.irradiance[i]);
        }
        /* The same products in another order: a few hundred roundings. */
        CHECK_NEAR(worst / largest, 0.0, 1e-9);
        CHECK_EQUAL(kept.shots, dropped.shots);
        /* A row counts a patch once, however often its column is made anew. */
        double farthest = 0.0;
        for (size_t i = 0; i < n; i++) farthest = fmax(farthest, fabs(dropped.row_sum[i] - kept.row_sum[i]));
        CHECK_NEAR(farthest, 0.0, 1e-12);
        CHECK(dropped.column_bytes < kept.column_bytes);
        CHECK_EQUAL(dropped.hemicubes, kept.hemicubes);
        double off = fabs(kept.books.absorbed - dropped.books.absorbed);
        CHECK_NEAR(off / kept.books.absorbed, 0.0, 1e-12);
    }
    progressive_result_free(&kept);
    progressive_result_free(&dropped);
}

static void one_thread_and_three_give_identical_bits(void) {
    progressive_result one, three;
    size_t n;
    if (solve_room(1, UINT64_C(1) << 30, &one, &n) && solve_room(3, UINT64_C(1) << 30, &three, &n)) {
        CHECK(memcmp(one.irradiance, three.irradiance, 3 * n * sizeof *one.irradiance) == 0);
        CHECK(memcmp(one.row_sum, three.row_sum, n * sizeof *one.row_sum) == 0);
        CHECK(memcmp(&one.books, &three.books, sizeof one.books) == 0);
        CHECK_EQUAL(one.shots, three.shots);
        CHECK(one.shots > 20);
    }
    progressive_result_free(&one);
    progressive_result_free(&three);
}

/* ---- stopping ---- */

typedef struct listener {
    double last;
    int calls, falls;
    bool refuse;
} listener;

static bool listen(void *user, double fraction, uint32_t shots, double unshot_fraction) {
    listener *l = user;
    (void)shots;
    if (fraction < l->last) l->falls++;
    if (!(unshot_fraction >= 0.0 && unshot_fraction <= 1.0)) l->falls++;
    l->last = fraction;
    l->calls++;
    return !l->refuse;
}

static void the_curve_falls_and_ends_at_the_target(void) {
    room r;
    progressive_result result;
    make_furnished_room(&r);
    jobs *j = jobs_create(2);
    listener heard = { 0 };
    progressive_setup setup = setup_of(&r, j, 1e-3);
    setup.progress = listen;
    setup.progress_user = &heard;
    setup.plain_order = setup.open_rows = true;
    if (solve(&setup, &result)) {
        CHECK(heard.calls > 0);
        CHECK_EQUAL(heard.falls, 0);
        CHECK(result.converged && !result.cancelled);
        CHECK(result.curve_count > 3);
        for (size_t i = 1; i < result.curve_count; i++) {
            const progressive_point *before = &result.curve[i - 1], *now = &result.curve[i];
            CHECK(now->shots >= before->shots && now->t_s >= before->t_s);
            /* Shooting never adds power; a rounding of the sum is left. */
            CHECK(now->unshot_fraction <= before->unshot_fraction * (1 + 1e-12));
        }
        CHECK(result.curve[result.curve_count - 1].unshot_fraction <= 1e-3);
        CHECK_NEAR(result.curve[0].unshot_fraction, 1.0, 0);
    }
    progressive_result_free(&result);
    jobs_destroy(j);
    room_free(&r);
}

/* A corner of three walls, and a lamp of 20 cm 60 m away of whose light a ten-thousandth comes here: less is reflected
 * than the target, which is of all that the lamp emits, leaves unshot. */
static void make_far_lamp(room *r) {
    room_start(r);
    uint32_t walls = room_material(r, 0.8, 0), lamp = room_material(r, 0.0, 1e4);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 2, 0, 0 }, (double[]){ 0, 2, 0 }, walls, 3, 2);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 2 }, (double[]){ 2, 0, 0 }, walls, 3, 2);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 0, 2, 0 }, (double[]){ 0, 0, 2 }, walls, 3, 2);
    room_quad(r, (double[]){ 20, 20, 60 }, (double[]){ 0, .2, 0 }, (double[]){ .2, 0, 0 }, lamp, 1, 1);
    room_finish(r);
}

/* Mean irradiance of the walls' samples. */
static double mean_under_a_far_lamp(double target, bool is_of_emitted) {
    room r;
    progressive_result result;
    double sum = 0.0;
    make_far_lamp(&r);
    jobs *j = jobs_create(2);
    progressive_setup setup = setup_of(&r, j, target);
    setup.unshot_is_of_emitted = is_of_emitted, setup.open_rows = true;
    if (solve(&setup, &result))
        for (size_t s = 0; s < r.mesh.sample_count; s++) sum += result.irradiance[3 * s];
    CHECK(result.converged);
    const double mean = sum / (double)r.mesh.sample_count;
    progressive_result_free(&result);
    jobs_destroy(j);
    room_free(&r);
    return mean;
}

static void a_lamp_whose_light_mostly_misses_is_reflected_all_the_same(void) {
    const double all = mean_under_a_far_lamp(1e-9, false);
    CHECK(all > 0.0);
    CHECK_NEAR(mean_under_a_far_lamp(2e-3, false) / all, 1.0, 0.02);
    CHECK(mean_under_a_far_lamp(2e-3, true) < 0.8 * all);
}

static void a_listener_that_refuses_cancels(void) {
    room r;
    progressive_result result;
    char message[160];
    make_furnished_room(&r);
    jobs *j = jobs_create(2);
    listener heard = { .refuse = true };
    progressive_setup setup = setup_of(&r, j, 1e-9);
    setup.progress = listen;
    setup.progress_user = &heard;
    CHECK(progressive_solve(&setup, &result, message, sizeof message) == NULL);
    CHECK(result.cancelled && !result.converged);
    progressive_result_free(&result);
    jobs_destroy(j);
    room_free(&r);
}

static void a_time_limit_stops_with_what_is_there(void) {
    room r;
    progressive_result result;
    make_furnished_room(&r);
    jobs *j = jobs_create(2);
    progressive_setup setup = setup_of(&r, j, 1e-12);
    setup.start_s -= 10.0; /* the bake began long ago */
    setup.time_limit_s = 1.0;
    if (solve(&setup, &result)) {
        CHECK(!result.converged && !result.cancelled);
        CHECK(result.unshot_fraction > 1e-12);
        CHECK(energy_residual(&result.books) <= 1e-9);
        CHECK(result.irradiance != NULL);
    }
    progressive_result_free(&result);
    jobs_destroy(j);
    room_free(&r);
}

/* The back of a room may have a thousandth of its light: what little of all light is unshot is not to be most of that.
 */
static void nobody_keeps_much_of_its_own_light(void) {
    room r;
    progressive_result result;
    make_furnished_room(&r);
    jobs *j = jobs_create(2);
    progressive_setup setup = setup_of(&r, j, 0.1);
    if (solve(&setup, &result)) {
        size_t count = 0;
        CHECK(result.rows_closed);
        for (size_t i = 0; i < result.kept.count; i++) {
            const shooter *one = &result.kept.all[i];
            const double *B = one->shot_in_all;
            double own = (fabs(B[0]) + fabs(B[1]) + fabs(B[2])) * one->subpatch.area;
            if (!one->column) continue;
            count++;
            CHECK(shooter_unshot_power(one) <= fmax(0.05 * own, 1e-8 * result.books.emitted));
        }
        CHECK(count > 50);
        CHECK(result.unshot_fraction < 0.1);
    }
    progressive_result_free(&result);
    jobs_destroy(j);
    room_free(&r);
}

int main(void) {
    RUN(a_closed_room_that_glows_evenly_settles_at_M_over_1_minus_rho);
    RUN(with_rows_as_they_come_it_settles_as_near_as_these_are_to_1);
    RUN(every_watt_is_booked);
    RUN(a_bake_without_room_for_columns_gives_the_same_light);
    RUN(one_thread_and_three_give_identical_bits);
    RUN(the_curve_falls_and_ends_at_the_target);
    RUN(nobody_keeps_much_of_its_own_light);
    RUN(a_lamp_whose_light_mostly_misses_is_reflected_all_the_same);
    RUN(a_listener_that_refuses_cancels);
    RUN(a_time_limit_stops_with_what_is_there);
    return check_end();
}
