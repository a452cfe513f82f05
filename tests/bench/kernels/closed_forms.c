/* SPDX-License-Identifier: MIT
 * How many edges of the closed form does a core evaluate in a second, one point at a time, in batches, and as a
 * textbook writes it?
 *
 * The unit is one edge for one point: a quad seen from 4096 points counts 16384. Each figure is the best of several
 * runs, because what else the machine does only ever slows one down. Also checks that all versions of the batch give
 * the same bits.
 */
#include "kernels.h"

#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <string.h>

enum { POINTS = 4096, RUNS = 15 };

typedef struct points {
    double x[POINTS], y[POINTS], z[POINTS], factors[POINTS];
} points;

typedef struct bench_scene {
    const char *name;
    polygon shape;
    double spread; /* points lie in [-spread, spread]^2 on the plane z = 0 */
} bench_scene;

static const double UP[3] = { 0, 0, 1 };

typedef void (*kernel)(const polygon *p, points *set);

/* The same source again without dispatch, and for one instruction set only (CMakeLists.txt). */
void portable_polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y,
                                   const double *z, size_t count, double *factors);
void avx2_polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y,
                               const double *z, size_t count, double *factors);

static void dispatched(const polygon *p, points *set) {
    polygon_factor_batch(p, UP, set->x, set->y, set->z, POINTS, set->factors);
}

static void portable(const polygon *p, points *set) {
    portable_polygon_factor_batch(p, UP, set->x, set->y, set->z, POINTS, set->factors);
}

#ifdef BENCH_AVX2
static void avx2(const polygon *p, points *set) {
    avx2_polygon_factor_batch(p, UP, set->x, set->y, set->z, POINTS, set->factors);
}
#endif

static void scalar(const polygon *p, points *set) {
    for (size_t i = 0; i < POINTS; i++)
        set->factors[i] += polygon_factor(p, (double[]){ set->x[i], set->y[i], set->z[i] }, UP);
}

static void exact(const polygon *p, points *set) {
    for (size_t i = 0; i < POINTS; i++)
        set->factors[i] +=
            polygon_loop_factor_exact(polygon_boundary(p), (double[]){ set->x[i], set->y[i], set->z[i] }, UP);
}

/* What a textbook writes: no horizon, no bounds, atan2 of the C library. */
static void textbook(const polygon *p, points *set) {
    for (size_t i = 0; i < POINTS; i++) {
        double sum = 0.0, a[3], b[3], cross[3], point[3] = { set->x[i], set->y[i], set->z[i] };
        for (int g = 0; g < p->count; g++) {
            vec3_sub(a, p->corner[g], point);
            vec3_sub(b, p->corner[(g + 1) % p->count], point);
            vec3_cross(cross, a, b);
            double sine = vec3_length(cross);
            if (sine > 0.0) sum += vec3_dot(UP, cross) * (atan2(sine, vec3_dot(a, b)) / sine);
        }
        set->factors[i] -= sum / 6.28318530717958647692;
    }
}

/* Million edges a second. */
static double speed(kernel run, const bench_scene *s, points *set, int repeats) {
    double best = 1e300;
    for (int r = 0; r < RUNS; r++) {
        memset(set->factors, 0, sizeof set->factors);
        double begin = kernel_seconds();
        for (int i = 0; i < repeats; i++) run(&s->shape, set);
        best = fmin(best, (kernel_seconds() - begin) / repeats);
    }
    return 1e-6 * POINTS * s->shape.count / best;
}

static void scatter(points *set, double spread) {
    uint64_t state = 1;
    for (size_t i = 0; i < 2 * POINTS; i++)
        (i & 1 ? set->y : set->x)[i / 2] = spread * (2.0 * kernel_random(&state) - 1.0);
    memset(set->z, 0, sizeof set->z);
}

static bool same_bits(const bench_scene *s, points *set) {
    static double reference[POINTS];
    bool same = true;
    memset(set->factors, 0, sizeof set->factors);
    portable(&s->shape, set);
    memcpy(reference, set->factors, sizeof reference);
    memset(set->factors, 0, sizeof set->factors);
    dispatched(&s->shape, set);
    same = same && memcmp(reference, set->factors, sizeof reference) == 0;
#ifdef BENCH_AVX2
    if (!__builtin_cpu_supports("avx2")) return same;
    memset(set->factors, 0, sizeof set->factors);
    avx2(&s->shape, set);
    same = same && memcmp(reference, set->factors, sizeof reference) == 0;
#endif
    return same;
}

static void print_line(const char *name, double value, double reference) {
    printf("  %-38s %8.1f  %5.2f x\n", name, value, value / reference);
}

static void print_scene(const bench_scene *s, points *set) {
    scatter(set, s->spread);
    double one = speed(textbook, s, set, 1);
    printf("closed form, %s: million edges a second, and times the simplest loop\n", s->name);
    print_line("simplest: textbook, libm's atan2", one, one);
    print_line("scalar: polygon_factor", speed(scalar, s, set, 1), one);
    print_line("scalar, pairs of doubles", speed(exact, s, set, 1), one);
    print_line("batch, portable", speed(portable, s, set, 10), one);
#ifdef BENCH_AVX2
    if (__builtin_cpu_supports("avx2")) print_line("batch, AVX2", speed(avx2, s, set, 10), one);
#endif
    print_line("batch, dispatched", speed(dispatched, s, set, 10), one);
}

bool kernel_closed_forms(void) {
    static points set;
    static const bench_scene scenes[] = {
        { "quad at its own size's distance", { { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } }, 4 }, 3 },
        { "quad 20 sizes away", { { { 20, 0, 1 }, { 20, 1, 1 }, { 20, 1, 2 }, { 20, 0, 2 } }, 4 }, 1 },
        { "wall close by, edges over right angles",
          { { { 0, 9, 0 }, { 0, 9, 3 }, { 0, -9, 3 }, { 0, -9, 0 } }, 4 },
          2 },
        { "triangle at its own size's distance", { { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 0, 1 } }, 3 }, 3 },
    };
    bool same = true;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        print_scene(&scenes[i], &set);
        same = same && same_bits(&scenes[i], &set);
    }
    printf("all versions of the batch give the same bits: %s\n", same ? "yes" : "NO");
    return same;
}
