/* SPDX-License-Identifier: MIT
 * Do all back ends draw the same, and what is there? OSMesa, EGL, Embree's rays, and rays in double precision as
 * another opinion.
 */
#include "check.h"
#include "item_rays.h"
#include "room.h"

#include <pthread.h>

enum { SIZE = 64, PIXELS = SIZE * SIZE };

static const char *const NAME[] = { "default", "OSMesa", "EGL", "rays" };

static item_buffer *open_on(item_backend backend, const item_geometry *g, uint32_t first_id) {
    char message[128] = "";
    const item_buffer_desc desc = { g, SIZE, SIZE, backend, first_id, false, NULL };
    item_buffer *b = item_buffer_open(&desc, message, sizeof message);
    if (!b) fprintf(stderr, "%s: %s\n", NAME[backend], message);
    return b;
}

/* A back end that this machine lacks is said to be lacking, and its checks are left out. */
static bool has(item_backend backend) {
    static const float positions[9] = { 0 };
    static const uint32_t indices[3] = { 0, 1, 2 };
    const item_geometry g = { positions, 3, indices, 1, 1e-6f, NULL, NULL, NULL, NULL };
    item_buffer *b = open_on(backend, &g, 0);
    item_buffer_destroy(b);
    return b != NULL;
}

static bool draw(item_buffer *b, const item_view *v, uint32_t *ids) {
    return b && item_buffer_draw(b, v, 1, v->width, v->height, false, ids);
}

/* ---- agreement ---- */

static void both_back_ends_draw_the_same_ids(void) {
    static soup s;
    static uint32_t ids[2][PIXELS];
    uint64_t state = 7;
    int shown = 0;
    if (!has(ITEM_BACKEND_OSMESA) || !has(ITEM_BACKEND_EGL)) return;
    for (int trial = 0; trial < 20; trial++) {
        soup_random(&s, 20 + 60 * trial, &state);
        item_buffer *b[2] = { open_on(ITEM_BACKEND_OSMESA, &s.geometry, 0), open_on(ITEM_BACKEND_EGL, &s.geometry, 0) };
        for (int look = 0; look < 10; look++) {
            double eye[3], forward[3];
            for (int k = 0; k < 3; k++) eye[k] = random_in(&state, -1.5, 1.5);
            random_direction(&state, forward);
            item_view v = view_along(eye, forward, SIZE);
            /* One after the other in one thread: neither may be left current when the other draws. */
            for (int i = 0; i < 2; i++) CHECK(draw(b[i], &v, ids[i]));
            CHECK(memcmp(ids[0], ids[1], sizeof ids[0]) == 0);
            for (int i = 0; i < PIXELS; i++) shown += ids[0][i] != 0;
        }
        item_buffer_destroy(b[trial & 1]);
        item_buffer_destroy(b[!(trial & 1)]);
    }
    /* More than a tenth of the pixels: the comparison was not of empty skies. */
    CHECK(shown > 20 * 10 * PIXELS / 10);
}

static void each_back_end_shows_what_rays_meet(void) {
    static soup s;
    static uint32_t ids[PIXELS];
    for (item_backend backend = ITEM_BACKEND_OSMESA; backend < ITEM_BACKENDS; backend++) {
        uint64_t state = 21;
        int wrong = 0, tested = 0;
        if (!has(backend)) continue;
        for (int trial = 0; trial < 8; trial++) {
            double eye[3], forward[3];
            soup_random(&s, 30 + 40 * trial, &state);
            for (int k = 0; k < 3; k++) eye[k] = random_in(&state, -1, 1);
            random_direction(&state, forward);
            item_view v = view_along(eye, forward, SIZE);
            item_buffer *b = open_on(backend, &s.geometry, 0);
            CHECK(draw(b, &v, ids));
            item_buffer_destroy(b);
            for (int i = 0; i < PIXELS; i++, tested++)
                wrong += !rays_agree(&s.geometry, &v, i % SIZE, i / SIZE, ids[i]);
        }
        printf("%s: %d of %d pixels show what no ray near their centre meets\n", NAME[backend], wrong, tested);
        /* Triangles seen edge-on are thinner than the reach of the rays: a few pixels in ten thousand. */
        CHECK(wrong <= tested / 5000);
    }
}

/* Of a square of four triangles in one place, two upon two, the lower layer is seen, whichever is said to be that. */
static void layers_that_are_known_are_drawn_by(void) {
    static const float positions[] = { -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0 };
    static const uint32_t indices[] = { 0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3 };
    static const uint8_t layers[2][4] = { { 0, 0, 1, 1 }, { 1, 1, 0, 0 } };
    static uint32_t ids[PIXELS];
    for (item_backend backend = ITEM_BACKEND_OSMESA; backend < ITEM_BACKENDS; backend++)
        for (int i = 0; i < 3 && has(backend); i++) {
            const item_geometry g = { positions, 4, indices, 4, 1e-6f, NULL, NULL, NULL, i < 2 ? layers[i] : NULL };
            item_view v = view_along((double[]){ 0.1, 0.05, 0.5 }, (double[]){ 0, 0, -1 }, SIZE);
            item_buffer *b = open_on(backend, &g, 0);
            CHECK(draw(b, &v, ids));
            item_buffer_destroy(b);
            int upper = 0, lower = 0;
            for (int p = 0; p < PIXELS; p++) upper += ids[p] > 2, lower += ids[p] == 1 || ids[p] == 2;
            CHECK(upper + lower > PIXELS / 2);
            CHECK_EQUAL(i == 1 ? lower : upper, 0);
        }
}

/* ---- rays ---- */

enum { WAYS = 6 };
static const char *const WAY[WAYS] = { "surfaces", "culled", "parallel", "holes", "front edges", "back edges" };

/* Of so many pixels these differ: centres a rounding away from an edge; lines are a pixel wide, and where two cross or
 * a third ends is a matter of rounding more often. */
static const double MAY_DIFFER[WAYS] = { 5e-4, 5e-4, 5e-4, 5e-4, 4e-3, 4e-3 };

/* Every third triangle has a chequered picture with holes. */
static void set_holes(soup *s, float *coordinates, const alpha_mask_map **holes, const alpha_mask_map *map) {
    for (size_t t = 0; t < s->geometry.triangle_count; t++) {
        holes[t] = t % 3 ? NULL : map;
        for (size_t k = 0; k < 3; k++) {
            float *at = coordinates + 3 * (size_t)s->indices[3 * t + k];
            at[0] = k == 1 ? 2.5f : 0.25f, at[1] = k == 2 ? 2.5f : 0.25f, at[2] = 1.0f;
        }
    }
    s->geometry.coordinates = coordinates, s->geometry.holes = holes;
}

static void rays_show_what_opengl_does(void) {
    static soup s;
    static uint32_t ids[2][PIXELS];
    static float coordinates[9 * SOUP_TRIANGLES_MAX];
    static const alpha_mask_map *holes[SOUP_TRIANGLES_MAX];
    static const uint8_t chequered[] = { 255, 0, 0, 255 };
    const alpha_mask_map map = { chequered, 2, 2, { ALPHA_MASK_REPEAT, ALPHA_MASK_MIRROR }, 0.5 };
    uint64_t state = 5;
    if (!has(ITEM_BACKEND_OSMESA) || !has(ITEM_BACKEND_RAYS)) return;
    for (int way = 0; way < WAYS; way++) {
        int differ = 0, shown = 0;
        for (int trial = 0; trial < 12; trial++) {
            char message[128];
            double eye[3], forward[3];
            soup_random(&s, 20 + 40 * trial, &state);
            if (way >= 3) set_holes(&s, coordinates, holes, &map);
            for (int k = 0; k < 3; k++) eye[k] = random_in(&state, -1.5, 1.5);
            random_direction(&state, forward);
            for (int k = 0; way == 2 && k < 3; k++) eye[k] = -6.0 * forward[k]; /* before everything */
            item_view v = view_along(eye, forward, SIZE);
            if (way == 2) v.parallel = true, v.depth = 12.0f;
            if (way >= 4) v.edges = way == 4 ? ITEM_EDGES_FRONT : ITEM_EDGES_BACK;
            for (int i = 0; i < 2; i++) {
                const item_buffer_desc desc = { &s.geometry, SIZE, SIZE, i ? ITEM_BACKEND_RAYS : ITEM_BACKEND_OSMESA,
                                                7,           true, NULL };
                item_buffer *b = item_buffer_open(&desc, message, sizeof message);
                CHECK(b && item_buffer_draw(b, &v, 1, SIZE, SIZE, way == 1, ids[i]));
                item_buffer_destroy(b);
            }
            for (int i = 0; i < PIXELS; i++) differ += ids[0][i] != ids[1][i], shown += ids[0][i] != 0;
        }
        printf("%s: %d of %d pixels differ, %d show something\n", WAY[way], differ, 12 * PIXELS, shown);
        CHECK(differ <= MAY_DIFFER[way] * 12 * PIXELS);
        CHECK(shown > 12 * PIXELS / 20);
    }
}

/* A rug in the plane of a floor, and the floor again: the first is seen, everywhere. */
static void of_what_lies_in_one_plane_rays_show_the_first(void) {
    static soup s;
    static uint32_t ids[PIXELS];
    if (!has(ITEM_BACKEND_RAYS)) return;
    soup_start(&s, 1e-6);
    for (int i = 0; i < 3; i++) {
        double half = i == 0 ? 0.3 : 4.0, z = 1.0 / 3.0;
        soup_triangle(&s, (double[]){ -half, -half, z }, (double[]){ half, -half, z }, (double[]){ half, half, z });
        soup_triangle(&s, (double[]){ -half, -half, z }, (double[]){ half, half, z }, (double[]){ -half, half, z });
    }
    item_view v = view_along((double[]){ 0.1, 0, 0 }, (double[]){ 0.2, 0.1, 1 }, SIZE);
    item_buffer *b = open_on(ITEM_BACKEND_RAYS, &s.geometry, 0);
    CHECK(draw(b, &v, ids));
    item_buffer_destroy(b);
    int count[7] = { 0 };
    for (int i = 0; i < PIXELS; i++)
        if (ids[i] < 7) count[ids[i]]++;
    CHECK(count[1] + count[2] > PIXELS / 20 && count[3] + count[4] > PIXELS / 4);
    CHECK_EQUAL(count[5] + count[6], 0);
}

/* ---- ids ---- */

/* Bit patterns that a way through floats, signed or 24-bit numbers would change; 0x7f800001 is a signalling NaN. */
static const uint32_t FIRST_IDS[] = { 1,          2,          0x00fffffe, 0x00ffffff, 0x3f800000,
                                      0x7f7fffff, 0x7f800000, 0x7f800001, 0x7ffffffe, 0x7fffffff,
                                      0x80000000, 0xff800001, 0xfffffffd, 0xfffffffe };

static void ids_survive_all_32_bits(void) {
    static soup s;
    static uint32_t ids[PIXELS];
    soup_start(&s, 1e-6);
    soup_triangle(&s, (double[]){ -9, -9, 1 }, (double[]){ 0, -9, 1 }, (double[]){ -5, 30, 1 });
    soup_triangle(&s, (double[]){ 0, -9, 1 }, (double[]){ 9, -9, 1 }, (double[]){ 5, 30, 1 });
    item_view v = view_along((double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, SIZE);
    for (item_backend backend = ITEM_BACKEND_OSMESA; backend < ITEM_BACKENDS; backend++)
        for (size_t i = 0; has(backend) && i < sizeof FIRST_IDS / sizeof *FIRST_IDS; i++) {
            item_buffer *b = open_on(backend, &s.geometry, FIRST_IDS[i]);
            CHECK(draw(b, &v, ids));
            item_buffer_destroy(b);
            for (int p = 0; p < PIXELS; p++) {
                uint32_t expected = ray_id(&s.geometry, &v, p % SIZE + 0.5, p / SIZE + 0.5);
                CHECK_EQUAL(ids[p], expected ? FIRST_IDS[i] + expected - 1 : 0);
            }
        }
}

static void ids_that_would_wrap_are_refused(void) {
    static soup s;
    uint64_t state = 3;
    char message[128] = "";
    soup_random(&s, 3, &state);
    const item_buffer_desc desc = { &s.geometry, SIZE, SIZE, ITEM_BACKEND_DEFAULT, UINT32_MAX - 1, false, NULL };
    CHECK(!item_buffer_open(&desc, message, sizeof message));
    CHECK_TEXT(message, "more triangles than ids");
}

/* ---- threads ---- */

enum { THREADS = 4, SCENES = 6 };

typedef struct thread_work {
    uint64_t hash[SCENES];
    bool failed;
} thread_work;

static uint64_t hash_of(const uint32_t *ids) {
    uint64_t h = 14695981039346656037u;
    for (int i = 0; i < PIXELS; i++) h = (h ^ ids[i]) * 1099511628211u;
    return h;
}

/* Two buffers at a time, one of each back end that is there; both must hash alike. */
static void *draw_scenes(void *user) {
    thread_work *work = user;
    uint64_t state = 99;
    uint32_t *ids = malloc(PIXELS * sizeof *ids);
    soup *s = malloc(sizeof *s);
    for (int i = 0; i < SCENES; i++) {
        soup_random(s, 100, &state);
        item_view v = view_along((double[]){ 0.1, 0.2, 1.5 }, (double[]){ 0, 0, -1 }, SIZE);
        item_buffer *a = open_on(ITEM_BACKEND_DEFAULT, &s->geometry, 0),
                    *b = open_on(ITEM_BACKEND_EGL, &s->geometry, 0);
        for (int again = 0; again < 3; again++) {
            work->failed |= !draw(a, &v, ids);
            work->hash[i] = hash_of(ids);
            work->failed |= !draw(b, &v, ids) || work->hash[i] != hash_of(ids);
        }
        item_buffer_destroy(a);
        item_buffer_destroy(b);
    }
    free(ids);
    free(s);
    return NULL;
}

static void threads_draw_at_once_what_one_draws_alone(void) {
    thread_work alone = { .failed = false }, work[THREADS] = { { .failed = false } };
    pthread_t thread[THREADS];
    if (!has(ITEM_BACKEND_EGL)) return;
    draw_scenes(&alone);
    CHECK(!alone.failed);
    for (int i = 0; i < THREADS; i++) CHECK(pthread_create(&thread[i], NULL, draw_scenes, &work[i]) == 0);
    for (int i = 0; i < THREADS; i++) {
        CHECK(pthread_join(thread[i], NULL) == 0);
        CHECK(!work[i].failed);
        CHECK(memcmp(work[i].hash, alone.hash, sizeof alone.hash) == 0);
    }
}

/* ---- columns ---- */

static column *column_on(column_setup setup, item_backend backend) {
    char message[128] = "";
    setup.backend = backend;
    column_worker *w = column_worker_create(&setup, message, sizeof message);
    column *c = w ? room_column(&setup, w, 9) : NULL;
    if (!w) fprintf(stderr, "%s: %s\n", NAME[backend], message);
    column_worker_destroy(w);
    return c;
}

static void a_column_is_the_same_from_both_back_ends(void) {
    room r;
    if (!has(ITEM_BACKEND_OSMESA) || !has(ITEM_BACKEND_EGL)) return;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 1);
    room_box(&r, (double[]){ -2, -2, 0 }, (double[]){ 2, 2, 3 }, true, grey, 2, 3);
    room_box(&r, (double[]){ 0.2, 0.3, 0 }, (double[]){ 1, 0.9, 1.4 }, false, grey, 1, 3);
    room_finish(&r);
    column_setup setup = room_columns(&r, SIZE, 2);
    column *a = column_on(setup, ITEM_BACKEND_OSMESA), *b = column_on(setup, ITEM_BACKEND_EGL);
    CHECK(a && b && a->factor_count > 100 && a->factor_count == b->factor_count);
    if (a && b && a->factor_count == b->factor_count)
        CHECK(memcmp(a->factors, b->factors, a->factor_count * sizeof *a->factors) == 0);
    column_destroy(a);
    column_destroy(b);
    room_free(&r);
}

/* ---- limits ---- */

static void a_view_larger_than_the_buffer_is_refused(void) {
    static soup s;
    static uint32_t ids[PIXELS];
    uint64_t state = 3;
    soup_random(&s, 3, &state);
    item_view v = view_along((double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, SIZE);
    item_buffer *b = open_on(ITEM_BACKEND_DEFAULT, &s.geometry, 0);
    CHECK(b && !item_buffer_draw(b, &v, 1, SIZE + 1, SIZE, false, ids));
    CHECK(b && !item_buffer_draw(b, &v, 1, SIZE, SIZE + 1, false, ids));
    CHECK(draw(b, &v, ids));
    item_buffer_destroy(b);
}

static void a_scene_of_nothing_is_all_sky(void) {
    static uint32_t ids[PIXELS];
    const item_geometry g = { NULL, 0, NULL, 0, 1e-6f, NULL, NULL, NULL, NULL };
    item_view v = view_along((double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, SIZE);
    for (item_backend backend = ITEM_BACKEND_OSMESA; backend < ITEM_BACKENDS; backend++) {
        int shown = 0;
        if (!has(backend)) continue;
        item_buffer *b = open_on(backend, &g, 0);
        memset(ids, 0xff, sizeof ids);
        CHECK(draw(b, &v, ids));
        item_buffer_destroy(b);
        for (int p = 0; p < PIXELS; p++) shown += ids[p] != 0;
        CHECK_EQUAL(shown, 0);
    }
}

int main(void) {
    RUN(both_back_ends_draw_the_same_ids);
    RUN(each_back_end_shows_what_rays_meet);
    RUN(layers_that_are_known_are_drawn_by);
    RUN(rays_show_what_opengl_does);
    RUN(of_what_lies_in_one_plane_rays_show_the_first);
    RUN(ids_survive_all_32_bits);
    RUN(ids_that_would_wrap_are_refused);
    RUN(threads_draw_at_once_what_one_draws_alone);
    RUN(a_column_is_the_same_from_both_back_ends);
    RUN(a_view_larger_than_the_buffer_is_refused);
    RUN(a_scene_of_nothing_is_all_sky);
    return check_end();
}
