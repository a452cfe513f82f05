/* SPDX-License-Identifier: MIT */
#include "formfactor/hemicube_weights.h"

#include <string.h>

static double top_integral(double x, double y) {
    double a = sqrt(1 + x * x), b = sqrt(1 + y * y);
    return (x / a * atan(y / a) + y / b * atan(x / b)) / TWO_PI;
}

static double side_integral(double y, double z) {
    double a = sqrt(1 + z * z);
    return (atan(y) - atan(y / a) / a) / TWO_PI;
}

static double over_pixel(double (*integral)(double, double), double x0, double x1, double y0, double y1) {
    return (integral(x1, y1) - integral(x0, y1)) - (integral(x1, y0) - integral(x0, y0));
}

void hemicube_weights(int resolution, double *weights) {
    int n = resolution, half = n / 2;
    double step = 2.0 / n;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++)
            weights[y * n + x] =
                over_pixel(top_integral, x * step - 1, (x + 1) * step - 1, y * step - 1, (y + 1) * step - 1);
    for (int z = 0; z < half; z++)
        for (int x = 0; x < n; x++)
            weights[(n + z) * n + x] =
                over_pixel(side_integral, x * step - 1, (x + 1) * step - 1, z * step, (z + 1) * step);
    for (int side = 1; side < 4; side++)
        memcpy(weights + (n + side * half) * n, weights + n * n, (size_t)half * (size_t)n * sizeof *weights);
}

/* In four sums, since each addition waits for the one before it in its sum. */
static double sum_of(const double *weights, size_t count) {
    double sum[4] = { 0, 0, 0, 0 }, rest = 0.0;
    size_t i = 0;
    for (; i + 4 <= count; i += 4)
        for (size_t k = 0; k < 4; k++) sum[k] += weights[i + k];
    for (; i < count; i++) rest += weights[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest;
}

hemicube_closure hemicube_close(const hemicube *h, const double *weights, const scene *s,
                                const uint32_t *triangle_surface) {
    hemicube_closure sum = { 0, 0, 0 };
    size_t pixel_count = 3 * (size_t)h->resolution * (size_t)h->resolution;
    for (size_t q = 0, end; q < pixel_count; q = end) {
        end = hemicube_run_end(h->ids, q, pixel_count);
        double weight = sum_of(weights + q, end - q);
        uint32_t id = h->ids[q] & ~ITEM_MARK;
        if (id == 0)
            sum.sky += weight;
        else if (hemicube_shows_front(s, triangle_surface[id - 1], h->eye))
            sum.front += weight;
        else
            sum.back += weight;
    }
    return sum;
}
