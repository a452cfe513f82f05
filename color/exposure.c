/* SPDX-License-Identifier: MIT
 * How bright is the scene, and by how much must it be scaled to show? A histogram over log2 luminance gives the trimmed
 * mean in one pass without sorting; each bin keeps the sum of its logarithms, so that only the two bins that the trim
 * cuts through are known to a bin's width (1/16 stop). */
#include "exposure.h"

#include <math.h>
#include <stdbool.h>

enum { STOPS = 128, BINS_PER_STOP = 16, BINS = STOPS * BINS_PER_STOP };

/* log2 luminance of the first bin's lower end; float radiance below or above the range falls in the end bins. */
#define LOWEST_STOP (-64.0)

typedef struct histogram {
    double weight[BINS], sum[BINS]; /* area; area times log2 luminance */
    double total;
} histogram;

/* Rec.709 [ITU-R BT.709-6]. Negative and NaN for what is no radiance. */
static double luminance(const float rgb[3]) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static double weight_of(const float *weights, size_t i) {
    return weights ? weights[i] : 1.0;
}

static bool counts(double value, double weight) {
    return value > 0.0 && isfinite(value) && weight > 0.0 && isfinite(weight);
}

static int bin_of(double stop) {
    double bin = floor((stop - LOWEST_STOP) * BINS_PER_STOP);
    return (int)fmin(fmax(bin, 0.0), BINS - 1.0);
}

static void collect(histogram *h, const float *radiance, const float *weights, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double value = luminance(radiance + 3 * i), weight = weight_of(weights, i);
        if (!counts(value, weight)) continue;
        double stop = log2(value);
        int bin = bin_of(stop);
        h->weight[bin] += weight;
        h->sum[bin] += weight * stop;
        h->total += weight;
    }
}

/* The bin that the brightest EXPOSURE_TRIM of the area begins in. */
static int bright_bin(const histogram *h) {
    double above = 0.0;
    for (int i = BINS - 1; i > 0; i--) {
        above += h->weight[i];
        if (above > EXPOSURE_TRIM * h->total) return i;
    }
    return 0;
}

static void drop_dark(histogram *h) {
    int darkest = bright_bin(h) - EXPOSURE_DARK_STOPS * BINS_PER_STOP;
    for (int i = 0; i < darkest; i++) {
        h->total -= h->weight[i];
        h->weight[i] = h->sum[i] = 0.0;
    }
}

/* Mean of log2 luminance without the outer EXPOSURE_TRIM of the area at both ends. */
static double trimmed_mean(const histogram *h) {
    double first = EXPOSURE_TRIM * h->total, last = (1.0 - EXPOSURE_TRIM) * h->total;
    double below = 0.0, sum = 0.0, weight = 0.0;
    for (int i = 0; i < BINS; i++) {
        double kept = fmin(below + h->weight[i], last) - fmax(below, first);
        if (kept > 0.0) {
            sum += kept * (h->sum[i] / h->weight[i]);
            weight += kept;
        }
        below += h->weight[i];
    }
    return sum / weight;
}

double exposure_meter(const float *radiance, const float *weights, size_t count) {
    histogram h = { .total = 0.0 };
    collect(&h, radiance, weights, count);
    if (!(h.total > 0.0)) return 0.0;
    drop_dark(&h);
    double ev = log2(EXPOSURE_MIDDLE_GREY) - trimmed_mean(&h);
    return fmin(fmax(ev, -EXPOSURE_EV_MAX), EXPOSURE_EV_MAX);
}

void exposure_apply(float *rgb, size_t count, double ev) {
    float scale = (float)exp2(ev);
    for (size_t i = 0; i < 3 * count; i++) rgb[i] *= scale;
}
