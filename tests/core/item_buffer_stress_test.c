/* SPDX-License-Identifier: MIT
 * Do threads that draw what has holes at once leave each other alone? Two draw the same forest of cut-out triangles,
 * many textures, many flushes, over and over, and must see what one sees alone: the driver's lists are one a process.
 *
 *     core_item_buffer_stress SECONDS      for minutes; without it a second
 */
#include "check.h"
#include "item_rays.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

enum { SIZE = 96, PIXELS = SIZE * SIZE, MAPS = 64, TRIANGLES = 256, VIEWS = 12, THREADS = 2, TEXELS = 64 };

static soup forest;
static alpha_mask_map maps[MAPS];
static uint8_t alphas[MAPS][TEXELS * TEXELS];
static float coordinates[9 * TRIANGLES];
static const alpha_mask_map *holes[TRIANGLES];
static item_view views[VIEWS];
static uint32_t alone[VIEWS][PIXELS];
static double seconds_to_draw = 1.0;

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void plant(void) {
    uint64_t state = 5;
    double eye[3], forward[3];
    soup_random(&forest, TRIANGLES, &state);
    for (int m = 0; m < MAPS; m++) {
        for (int i = 0; i < TEXELS * TEXELS; i++) alphas[m][i] = random_in(&state, 0, 1) < 0.5 ? 0 : 255;
        maps[m] = (alpha_mask_map){ alphas[m], TEXELS, TEXELS, { ALPHA_MASK_REPEAT, ALPHA_MASK_REPEAT }, 0.5 };
    }
    for (size_t v = 0; v < forest.geometry.vertex_count; v++)
        memcpy(coordinates + 3 * v, (float[]){ 2 * forest.positions[3 * v], 2 * forest.positions[3 * v + 1], 1 },
               3 * sizeof *coordinates);
    for (size_t t = 0; t < TRIANGLES; t++) holes[t] = &maps[t % MAPS];
    forest.geometry.coordinates = coordinates;
    forest.geometry.holes = holes;
    for (int i = 0; i < VIEWS; i++) {
        for (int k = 0; k < 3; k++) eye[k] = random_in(&state, -1.5, 1.5);
        random_direction(&state, forward);
        views[i] = view_along(eye, forward, SIZE);
    }
}

static item_buffer *open_forest(void) {
    char message[128] = "";
    const item_buffer_desc desc = { .geometry = &forest.geometry, .width = SIZE, .height = SIZE, .marks_holes = true };
    item_buffer *b = item_buffer_open(&desc, message, sizeof message);
    if (!b) fprintf(stderr, "item buffer: %s\n", message);
    return b;
}

typedef struct drawer {
    pthread_t thread;
    int drawn, different;
    bool failed;
} drawer;

static void *draw_on(void *user) {
    drawer *d = user;
    uint32_t ids[PIXELS];
    double end = seconds() + seconds_to_draw;
    while (seconds() < end && !d->failed) {
        item_buffer *b = open_forest(); /* anew, since what a context leaves behind is walked too */
        for (int i = 0; b && i < VIEWS; i++, d->drawn++) {
            d->failed = d->failed || !item_buffer_draw(b, &views[i], 1, SIZE, SIZE, false, ids);
            d->different += memcmp(ids, alone[i], sizeof ids) != 0;
        }
        d->failed = d->failed || !b;
        item_buffer_destroy(b);
    }
    return NULL;
}

static void threads_draw_a_forest_at_once_as_one_does_alone(void) {
    drawer all[THREADS] = { 0 };
    plant();
    item_buffer *b = open_forest();
    for (int i = 0; b && i < VIEWS; i++) CHECK(item_buffer_draw(b, &views[i], 1, SIZE, SIZE, false, alone[i]));
    item_buffer_destroy(b);
    for (int i = 0; i < THREADS; i++) CHECK(pthread_create(&all[i].thread, NULL, draw_on, &all[i]) == 0);
    for (int i = 0; i < THREADS; i++) {
        pthread_join(all[i].thread, NULL);
        printf("thread %d: %d pictures\n", i, all[i].drawn);
        CHECK(!all[i].failed && all[i].drawn > 0);
        CHECK_EQUAL(all[i].different, 0);
    }
}

int main(int argc, char **argv) {
    if (argc > 1) seconds_to_draw = atof(argv[1]);
    RUN(threads_draw_a_forest_at_once_as_one_does_alone);
    return check_end();
}
