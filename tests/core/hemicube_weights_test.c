/* SPDX-License-Identifier: MIT
 * Do the weights of a hemi-cube's pixels integrate the cosine over the hemisphere?
 */
#include "check.h"
#include "formfactor/hemicube_weights.h"

#include <stdlib.h>

static double *new_weights(int n) {
    double *w = malloc(3 * (size_t)n * (size_t)n * sizeof *w);
    if (w) hemicube_weights(n, w);
    return w;
}

static double top_kernel(double x, double y) {
    double r2 = 1 + x * x + y * y;
    return 1 / (PI * r2 * r2);
}

static double side_kernel(double y, double z) {
    return z * top_kernel(y, z);
}

/* Midpoints of parts x parts pieces of a pixel. */
static double integrate(double (*kernel)(double, double), double x0, double y0, double step, int parts) {
    double sum = 0.0, h = step / parts;
    for (int i = 0; i < parts; i++)
        for (int k = 0; k < parts; k++) sum += kernel(x0 + (i + 0.5) * h, y0 + (k + 0.5) * h);
    return sum * h * h;
}

static void weights_sum_to_one(void) {
    for (int n = 16; n <= 512; n *= 2) {
        double *w = new_weights(n), sum = 0.0;
        for (int q = 0; w && q < 3 * n * n; q++) sum += w[q];
        /* Every weight is a difference of four numbers below 1/4 with roundings of 3e-17, and neighbours share corners,
         * so the roundings telescope; what stays is the summing of 3 n^2 numbers. */
        CHECK_NEAR(sum, 1.0, 1e-12);
        free(w);
    }
    /* Even resolutions that are no power of two. */
    double *w = new_weights(86), sum = 0.0;
    for (int q = 0; w && q < 3 * 86 * 86; q++) sum += w[q];
    CHECK_NEAR(sum, 1.0, 1e-12);
    free(w);
}

static void the_top_weighs_what_its_view_factor_says(void) {
    /* The top is a square of side 2 at distance 1: four times [Howell82, B-3] with a = b = c. */
    enum { N = 64 };
    double *w = new_weights(N), top = 0.0;
    for (int q = 0; w && q < N * N; q++) top += w[q];
    CHECK_NEAR(top, 4 * 0.13853160599489298, 1e-13);
    free(w);
}

static void every_weight_is_positive(void) {
    for (int n = 16; n <= 512; n *= 2) {
        double *w = new_weights(n), least = 1.0;
        for (int q = 0; w && q < 3 * n * n; q++) least = fmin(least, w[q]);
        CHECK(least > 0.0);
        /* The lowest row of a side weighs about z step^2 / pi at |y| = 1, where 1 + y^2 is 2. */
        double step = 2.0 / n, lowest = side_kernel(1 - step / 2, step / 2) * step * step;
        /* Within the few percent that the midpoint rule is off at 16 pixels. */
        CHECK_NEAR(least / lowest, 1.0, 0.02);
        free(w);
    }
}

static void the_four_sides_are_alike_and_every_face_is_symmetric(void) {
    enum { N = 48, HALF = N / 2 };
    double *w = new_weights(N);
    if (!w) return;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            /* Mirrored differences are taken in another order: roundings of 1/4. */
            CHECK_NEAR(w[y * N + x], w[y * N + N - 1 - x], 2e-16);
            CHECK_NEAR(w[y * N + x], w[(N - 1 - y) * N + x], 2e-16);
            CHECK_NEAR(w[y * N + x], w[x * N + y], 2e-16);
        }
    for (int z = 0; z < HALF; z++)
        for (int x = 0; x < N; x++) {
            double side = w[(N + z) * N + x];
            CHECK_NEAR(side, w[(N + z) * N + N - 1 - x], 2e-16);
            for (int s = 1; s < 4; s++) CHECK_NEAR(w[(N + s * HALF + z) * N + x], side, 0);
        }
    free(w);
}

static void a_weight_is_the_integral_of_the_kernel_over_its_pixel(void) {
    enum { N = 16, PARTS = 200 };
    const double step = 2.0 / N;
    double *w = new_weights(N);
    for (int y = 0; w && y < N; y += 3)
        for (int x = 0; x < N; x += 3) {
            /* The midpoint rule on pieces of 1/1600: h^2 / 24 times second derivatives below 10, relative. */
            double top = integrate(top_kernel, x * step - 1, y * step - 1, step, PARTS);
            CHECK_NEAR(w[y * N + x] / top, 1.0, 2e-6);
            if (y >= N / 2) continue;
            double side = integrate(side_kernel, x * step - 1, y * step, step, PARTS);
            CHECK_NEAR(w[(N + y) * N + x] / side, 1.0, 2e-6);
        }
    free(w);
}

static void the_midpoint_rule_would_be_off_by_two_thousandths(void) {
    enum { N = 16 };
    const double step = 2.0 / N;
    double midpoint = 0.0;
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            midpoint += integrate(top_kernel, x * step - 1, y * step - 1, step, 1);
            if (y < N / 2) midpoint += 4 * integrate(side_kernel, x * step - 1, y * step, step, 1);
        }
    /* The classic delta factors of [Cohen85] sum to 1.0021: half a unit of that digit. */
    CHECK_NEAR(midpoint, 1.0021, 5e-5);
    double *w = new_weights(N), largest = 0.0;
    for (int y = 0; w && y < N; y++)
        for (int x = 0; x < N; x++)
            largest =
                fmax(largest, fabs(w[y * N + x] / integrate(top_kernel, x * step - 1, y * step - 1, step, 1) - 1));
    /* So the exact weights are not the midpoint ones. */
    CHECK(largest > 1e-3);
    free(w);
}

int main(void) {
    RUN(weights_sum_to_one);
    RUN(the_top_weighs_what_its_view_factor_says);
    RUN(every_weight_is_positive);
    RUN(the_four_sides_are_alike_and_every_face_is_symmetric);
    RUN(a_weight_is_the_integral_of_the_kernel_over_its_pixel);
    RUN(the_midpoint_rule_would_be_off_by_two_thousandths);
    return check_end();
}
