/* SPDX-License-Identifier: MIT
 * Do any lights settle on rows that were kept, as rows of their own would say?
 */
#include "check.h"
#include "room.h"
#include "solver/kept_rows_file.h"

#include <math.h>

/* A box with a lamp and an opening to the sky, solved by rows that are kept. */
typedef struct kept_room {
    room room;
    jobs *jobs;
    lights lights;
    double *direct; /* zeros */
    rows_result solved;
    kept_rows *rows;
} kept_room;

static void open_room(kept_room *k, unsigned threads) {
    char message[160] = "";
    room *r = &k->room;
    *k = (kept_room){ .jobs = jobs_create(threads),
                      .lights = { .sky_is_given = true, .has_sky = true, .sky_radiance = { 2, 1, 0.5 } } };
    room_start(r);
    uint32_t wall = room_material(r, 0.6, 0);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 3, 0, 0 }, (double[]){ 0, 3, 0 }, wall, 3, 4);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 0, 3, 0 }, (double[]){ 0, 0, 2 }, wall, 3, 4);
    room_quad(r, (double[]){ 3, 0, 0 }, (double[]){ 0, 0, 2 }, (double[]){ 0, 3, 0 }, wall, 3, 4);
    room_quad(r, (double[]){ 1, 1, 1.8 }, (double[]){ 0, 0.5, 0 }, (double[]){ 0.5, 0, 0 }, room_material(r, 0.2, 9), 1,
              2);
    room_finish(r);
    k->direct = calloc(3 * r->mesh.sample_count + 1, sizeof *k->direct);
    const rows_setup setup = { .scene = &r->scene,
                               .mesh = &r->mesh,
                               .jobs = k->jobs,
                               .seed = 4,
                               .initial_rays = 64,
                               .adaptive_rays = 192.0 * (double)r->mesh.sample_count,
                               .lights = &k->lights,
                               .direct = k->direct,
                               .emitter_rays = 16,
                               .keeps_rows = true };
    CHECK(!rows_solve(&setup, &k->solved, message, sizeof message) && k->solved.final_gather);
    k->rows = kept_rows_cast(k->solved.final_gather, &r->mesh, NULL, NULL, NULL);
    k->solved.final_gather = NULL;
    CHECK(k->rows != NULL);
}

static void close_room(kept_room *k) {
    kept_rows_free(k->rows);
    rows_result_free(&k->solved);
    free(k->direct);
    jobs_destroy(k->jobs);
    room_free(&k->room);
}

static rows_result settle(kept_room *k, const lights *l, const bool *is_dark) {
    rows_result out;
    CHECK(!kept_rows_settle(k->rows, &(kept_rows_setup){ .lights = l, .direct = k->direct, .is_dark = is_dark }, &out));
    return out;
}

/* Root mean square of a b ... relative to that of a. */
static double difference(const kept_room *k, const double *a, const double *b, const double *c) {
    double off = 0.0, level = 0.0;
    for (size_t i = 0; i < 3 * k->room.mesh.sample_count; i++) {
        double d = a[i] - b[i] - (c ? c[i] : 0.0);
        off += d * d, level += a[i] * a[i];
    }
    return sqrt(off / level);
}

static void kept_rows_say_what_was_solved_within_their_noise(void) {
    kept_room k;
    open_room(&k, 2);
    rows_result again = settle(&k, &k.lights, NULL);
    double off = difference(&k, k.solved.irradiance, again.irradiance, NULL);
    printf("kept rows: off by %.2f %%, noise %.2f %%\n", 100 * off, 100 * k.solved.noise);
    CHECK(off > 0.0 && off < 2.0 * k.solved.noise && k.solved.noise < 0.1);
    /* What emitters and the sky bring is what surfaces absorb and lose, to what iterations leave over. */
    double in = again.emitters_w + again.sky_w, out = again.absorbed_w + again.escaped_w;
    CHECK_NEAR(out / in, 1.0, 1e-3);
    rows_result_free(&again);
    close_room(&k);
}

static void lights_add_up_and_those_that_are_off_give_nothing(void) {
    kept_room k;
    open_room(&k, 2);
    const lights none = { 0 };
    bool *is_dark = malloc(k.room.mesh.patch_count);
    memset(is_dark, true, k.room.mesh.patch_count);
    rows_result all = settle(&k, &k.lights, NULL), lamp = settle(&k, &none, NULL);
    rows_result of_sky = settle(&k, &k.lights, is_dark);
    rows_result dark = settle(&k, &none, is_dark);
    /* Each is iterated until 1e-4 is left. */
    CHECK(difference(&k, all.irradiance, lamp.irradiance, of_sky.irradiance) < 2e-4);
    CHECK(difference(&k, all.irradiance, lamp.irradiance, NULL) > 0.1);
    CHECK(difference(&k, all.irradiance, of_sky.irradiance, NULL) > 0.01);
    double most = 0.0;
    for (size_t i = 0; i < 3 * k.room.mesh.sample_count; i++) most = fmax(most, fabs(dark.irradiance[i]));
    CHECK_NEAR(most, 0.0, 0.0);
    rows_result_free(&all), rows_result_free(&lamp), rows_result_free(&of_sky), rows_result_free(&dark);
    free(is_dark);
    close_room(&k);
}

static void a_panorama_of_one_colour_is_that_sky(void) {
    kept_room k;
    float pixels[3 * 8 * 4];
    open_room(&k, 2);
    for (size_t i = 0; i < 8 * 4; i++) pixels[3 * i] = 2.0f, pixels[3 * i + 1] = 1.0f, pixels[3 * i + 2] = 0.5f;
    lights seen = k.lights;
    for (int c = 0; c < 3; c++) seen.sky_radiance[c] = 1.0;
    seen.sky_image = (sky_image){ .radiance = pixels, .width = 8, .height = 4 };
    rows_result even = settle(&k, &k.lights, NULL), panorama = settle(&k, &seen, NULL);
    CHECK_NEAR(difference(&k, even.irradiance, panorama.irradiance, NULL), 0.0, 1e-12);
    /* Half of it, above or to one side, is less of it where it is seen. */
    for (size_t i = 0; i < 3 * 8 * 2; i++) pixels[i] = 0.0f;
    rows_result half = settle(&k, &seen, NULL);
    CHECK(half.sky_w < 0.9 * panorama.sky_w && half.sky_w >= 0.0);
    rows_result_free(&even), rows_result_free(&panorama), rows_result_free(&half);
    close_room(&k);
}

static void threads_change_no_bit(void) {
    kept_room one, two;
    open_room(&one, 1), open_room(&two, 2);
    rows_result a = settle(&one, &one.lights, NULL), b = settle(&two, &two.lights, NULL);
    CHECK(memcmp(a.irradiance, b.irradiance, 3 * one.room.mesh.sample_count * sizeof(double)) == 0);
    CHECK(memcmp(a.half_difference, b.half_difference, 3 * one.room.mesh.sample_count * sizeof(double)) == 0);
    rows_result_free(&a), rows_result_free(&b);
    close_room(&one), close_room(&two);
}

/* Rows as they are written, of a room; what is read of them again: NULL, or what says why not. */
static chunk_fault read_again(const kept_room *k, rows_result *settled) {
    char message[160];
    chunk_memory file = { 0 };
    chunk_writer w = { .write = chunk_memory_write, .user = &file };
    chunk_write_begin(&w, "testrows", 1);
    kept_rows_write(k->rows, &w);
    CHECK(chunk_write_end(&w));
    file.size = file.used, file.used = 0;
    chunk_reader r = { .read = chunk_memory_read, .user = &file };
    final_gather *with = final_gather_open(&k->room.scene, &k->room.mesh, k->jobs, 0.0, message, sizeof message);
    CHECK(with != NULL);
    with->seed = 4, with->emitter_rays = 16;
    CHECK(chunk_read_begin(&r, "testrows", 1));
    kept_rows *again = kept_rows_read(&r, with, &k->room.mesh, NULL);
    CHECK((again != NULL) == (r.fault == CHUNK_FINE));
    if (again)
        CHECK(!kept_rows_settle(again, &(kept_rows_setup){ .lights = &k->lights, .direct = k->direct }, settled));
    kept_rows_free(again);
    block_free(file.bytes);
    return r.fault;
}

static void rows_come_back_from_a_file_and_say_the_same(void) {
    kept_room k;
    rows_result again;
    open_room(&k, 2);
    rows_result before = settle(&k, &k.lights, NULL);
    CHECK_EQUAL(read_again(&k, &again), CHUNK_FINE);
    CHECK(memcmp(before.irradiance, again.irradiance, 3 * k.room.mesh.sample_count * sizeof(double)) == 0);
    rows_result_free(&before), rows_result_free(&again);
    close_room(&k);
}

static void rows_that_no_bake_writes_are_refused_though_checksums_are_right(void) {
    kept_room k;
    rows_result none;
    open_room(&k, 2);
    row_rays *r = &k.rows->rays;
    const uint32_t hit = r->hit[5], bad[] = { (uint32_t)k.room.mesh.element_count, ROW_HIT_PANES, ROW_HIT_ELEMENT };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        r->hit[5] = bad[i];
        CHECK_EQUAL(read_again(&k, &none), CHUNK_UNEXPECTED);
    }
    r->hit[5] = hit;
    const float weight = r->weight[5], worse[] = { -0.1f, 1.1f, (float)NAN, INFINITY };
    for (size_t i = 0; i < sizeof worse / sizeof *worse; i++) {
        r->weight[5] = worse[i];
        CHECK_EQUAL(read_again(&k, &none), CHUNK_UNEXPECTED);
    }
    r->weight[5] = weight;
    r->counts[3].cosine++;
    CHECK_EQUAL(read_again(&k, &none), CHUNK_UNEXPECTED);
    r->counts[3].cosine--;
    CHECK_EQUAL(read_again(&k, &none), CHUNK_FINE);
    rows_result_free(&none);
    close_room(&k);
}

int main(void) {
    if (!rays_are_there()) return printf("skipped: a build without Embree\n"), 77;
    RUN(kept_rows_say_what_was_solved_within_their_noise);
    RUN(lights_add_up_and_those_that_are_off_give_nothing);
    RUN(a_panorama_of_one_colour_is_that_sky);
    RUN(threads_change_no_bit);
    RUN(rows_come_back_from_a_file_and_say_the_same);
    RUN(rows_that_no_bake_writes_are_refused_though_checksums_are_right);
    return check_end();
}
