/* SPDX-License-Identifier: MIT
 * Does an item buffer draw the same on a device that others had before? Ids beside those of an item buffer with a
 * device of its own, over sizes, geometries and threads.
 */
#include "check.h"
#include "item_rays.h"

#include <pthread.h>

enum { SIZE = 48, PIXELS = SIZE * SIZE, TRIALS = 8 };

static item_buffer *open_for(const soup *s, item_pool *pool, int size) {
    char message[128] = "";
    item_geometry g = s->geometry;
    g.pool = pool;
    const item_buffer_desc desc = { .geometry = &g, .width = size, .height = size, .marks_holes = g.coordinates };
    item_buffer *b = item_buffer_open(&desc, message, sizeof message);
    if (!b) fprintf(stderr, "item buffer: %s\n", message);
    CHECK(b);
    return b;
}

/* Draws one view on a fresh device and on one of the pool; the number of pixels that show something. */
static int alike(const soup *s, item_pool *pool, int size, uint64_t *state) {
    uint32_t fresh[PIXELS], pooled[PIXELS];
    double eye[3], forward[3];
    int shown = 0;
    for (int k = 0; k < 3; k++) eye[k] = random_in(state, -1.5, 1.5);
    random_direction(state, forward);
    item_view v = view_along(eye, forward, size);
    item_buffer *a = open_for(s, NULL, SIZE), *b = open_for(s, pool, SIZE);
    if (!a || !b) return 0;
    CHECK(item_buffer_draw(a, &v, 1, size, size, false, fresh));
    CHECK(item_buffer_draw(b, &v, 1, size, size, false, pooled));
    CHECK(memcmp(fresh, pooled, (size_t)(size * size) * sizeof *fresh) == 0);
    for (int i = 0; i < size * size; i++) shown += (fresh[i] & ~ITEM_MARK) != 0;
    item_buffer_destroy(a);
    item_buffer_destroy(b);
    return shown;
}

static void what_was_drawn_before_leaves_no_trace(void) {
    static soup s;
    item_pool *pool = item_pool_create(NULL);
    uint64_t state = 11;
    int shown = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        soup_random(&s, 300 - 30 * trial, &state); /* fewer each time: what is left of the last would show */
        shown += alike(&s, pool, SIZE, &state);
    }
    CHECK(shown > TRIALS * PIXELS / 20); /* a test of empty pictures would say nothing */
    item_pool_destroy(pool);
}

/* Every second triangle is half cut out, by a picture of its own for each trial. */
static void cut_soup(soup *s, uint8_t alpha[16], alpha_mask_map *map, float *coordinates,
                     const alpha_mask_map **holes) {
    *map = (alpha_mask_map){ alpha, 4, 4, { ALPHA_MASK_REPEAT, ALPHA_MASK_REPEAT }, 0.5 };
    for (size_t v = 0; v < s->geometry.vertex_count; v++)
        memcpy(coordinates + 3 * v, (float[]){ 2 * s->positions[3 * v], 2 * s->positions[3 * v + 1], 1 },
               3 * sizeof *coordinates);
    for (size_t t = 0; t < s->geometry.triangle_count; t++) holes[t] = t % 2 ? map : NULL;
    s->geometry.coordinates = coordinates;
    s->geometry.holes = holes;
}

static void holes_leave_no_trace(void) {
    static soup s;
    static float coordinates[9 * 300];
    static const alpha_mask_map *holes[300];
    item_pool *pool = item_pool_create(NULL);
    uint64_t state = 23;
    int shown = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        uint8_t alpha[16];
        alpha_mask_map map; /* at the same address each time, so that a texture that stayed would be found again */
        for (int i = 0; i < 16; i++) alpha[i] = (uint8_t)(((i + i / 4 * (trial / 2)) & 1) * 255);
        soup_random(&s, 300 - 30 * trial, &state);
        s.geometry.coordinates = NULL;
        if (trial % 3) cut_soup(&s, alpha, &map, coordinates, holes);
        shown += alike(&s, pool, SIZE, &state);
    }
    CHECK(shown > TRIALS * PIXELS / 20);
    item_pool_destroy(pool);
}

/* More sizes than a device has targets. */
static void every_size_has_its_own_pixels(void) {
    static soup s;
    item_pool *pool = item_pool_create(NULL);
    uint64_t state = 5;
    soup_random(&s, 200, &state);
    item_buffer *a = open_for(&s, NULL, SIZE), *b = open_for(&s, pool, SIZE);
    for (int look = 0; a && b && look < 24; look++) {
        uint32_t fresh[PIXELS], again[PIXELS];
        double eye[3] = { 0, 0, -3 }, forward[3] = { 0, 0, 1 };
        int size = 8 * (1 + look % 6), large = SIZE;
        item_view v = view_along(eye, forward, size), w = view_along(eye, forward, large);
        CHECK(item_buffer_draw(a, &v, 1, size, size, false, fresh));
        CHECK(item_buffer_draw(b, &w, 1, large, large, false, again));
        CHECK(item_buffer_draw(b, &v, 1, size, size, false, again));
        CHECK(memcmp(fresh, again, (size_t)(size * size) * sizeof *fresh) == 0);
    }
    item_buffer_destroy(a);
    item_buffer_destroy(b);
    item_pool_destroy(pool);
}

typedef struct thread_work {
    item_pool *pool;
    uint64_t state;
    int shown;
} thread_work;

static void *draw_in_thread(void *user) {
    thread_work *w = user;
    soup *s = malloc(sizeof *s);
    for (int trial = 0; s && trial < TRIALS; trial++) {
        soup_random(s, 100, &w->state);
        w->shown += alike(s, w->pool, SIZE, &w->state);
    }
    free(s);
    return NULL;
}

/* Two devices are made in threads that end; four other threads pass them round, and make what is missing. */
static void devices_go_from_thread_to_thread(void) {
    thread_work work[4];
    pthread_t threads[4];
    item_pool *pool = item_pool_create(NULL);
    item_pool_warm(pool, 2);
    for (int i = 0; i < 4; i++) {
        work[i] = (thread_work){ pool, (uint64_t)i + 1, 0 };
        pthread_create(&threads[i], NULL, draw_in_thread, &work[i]);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(threads[i], NULL);
        CHECK(work[i].shown > 0);
    }
    item_pool_destroy(pool);
}

static void a_pool_that_nobody_draws_from_ends_cleanly(void) {
    item_pool *pool = item_pool_create(NULL);
    item_pool_warm(pool, 2);
    CHECK(pool != NULL);
    item_pool_destroy(pool);
    item_pool_destroy(NULL);
}

int main(void) {
    RUN(what_was_drawn_before_leaves_no_trace);
    RUN(holes_leave_no_trace);
    RUN(every_size_has_its_own_pixels);
    RUN(devices_go_from_thread_to_thread);
    RUN(a_pool_that_nobody_draws_from_ends_cleanly);
    return check_end();
}
