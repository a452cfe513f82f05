/* SPDX-License-Identifier: MIT
 * How long does a million colours take through each view, to linear values for COLOR_0?
 *
 * The best of several runs, because what else the machine does only ever slows one down.
 */
#include "color_transform.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { COUNT = 1000000, RUNS = 7 };

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double time_view(const color_transform *transform, float *rgb) {
    double best = 1e9;
    for (int run = 0; run < RUNS; run++) {
        for (size_t i = 0; i < 3 * (size_t)COUNT; i++) rgb[i] = (float)(i * 7919 % 10007) / 5000.0f;
        double begin = seconds();
        if (color_transform_apply(transform, rgb, COUNT, NULL) != HEMI_OK) return -1.0;
        double taken = seconds() - begin;
        best = taken < best ? taken : best;
    }
    return best;
}

int main(void) {
    const char *const views[] = { "Soft", "Standard", "ACES 1.x SDR", "Filmic", "Raw" };
    char message[COLOR_MESSAGE_SIZE];
    float *rgb = malloc(3 * sizeof *rgb * COUNT);
    for (int v = 0; rgb && v < 5; v++) {
        color_transform *transform;
        const color_transform_desc desc = { .view = views[v] };
        double begin = seconds();
        if (color_transform_create(&desc, &transform, message) != HEMI_OK) return fprintf(stderr, "%s\n", message), 1;
        double made = seconds() - begin;
        printf("a million colours through %s: %.3f s, and %.3f s to make the transform\n", views[v],
               time_view(transform, rgb), made);
        color_transform_destroy(transform);
    }
    free(rgb);
    return 0;
}
