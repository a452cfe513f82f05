/* SPDX-License-Identifier: MIT
 * How bright is the scene, and by how much must it be scaled to show? A histogram over log2 luminance gives the trimmed
 * mean in one pass without sorting; each bin keeps the sum of its logarithms, so that only the two bins that the trim
 * cuts through are known to a bin's width (1/16 stop). */
#include "exposure.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { STOPS = 128, BINS_PER_STOP = 16, BINS = STOPS * BINS_PER_STOP };

/* log2 luminance of the first bin's lower end; float radiance below or above the range falls in the end bins. */
#define LOWEST_STOP (-64.0)

typedef struct histogram {
    double weight[BINS], sum[BINS]; /* area; area times log2 luminance */
    double total;
} histogram;

static bool counts(double value, double weight) {
    return value > 0.0 && isfinite(value) && weight > 0.0 && isfinite(weight);
}

static int bin_of(double stop) {
    double bin = floor((stop - LOWEST_STOP) * BINS_PER_STOP);
    return (int)fmin(fmax(bin, 0.0), BINS - 1.0);
}

static void add(histogram *h, double value, double weight) {
    if (!counts(value, weight)) return;
    double stop = log2(value);
    int bin = bin_of(stop);
    h->weight[bin] += weight;
    h->sum[bin] += weight * stop;
    h->total += weight;
}

/* The bin that the brightest share of the area begins in. */
static int bright_bin(const histogram *h, double share) {
    double above = 0.0;
    for (int i = BINS - 1; i > 0; i--) {
        above += h->weight[i];
        if (above > share * h->total) return i;
    }
    return 0;
}

/* The stop that all but a share of the area stay below; of the bin's upper end. */
static double bright_stop(const histogram *h, double share) {
    return LOWEST_STOP + (bright_bin(h, share) + 1.0) / BINS_PER_STOP;
}

static void drop_dark(histogram *h) {
    int darkest = bright_bin(h, EXPOSURE_TRIM) - EXPOSURE_DARK_STOPS * BINS_PER_STOP;
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

/* What one place sees of what does not emit, or, where lamps count, of all. */
typedef struct place {
    histogram luminance, light; /* of light the brightest band */
    histogram area;             /* luminance by area alone */
} place;

static double brightest_of(const float rgb[3]) {
    return fmax(rgb[0], fmax(rgb[1], rgb[2]));
}

static void collect_seen(place *places, const seen_point *points, size_t count, bool lamps_count) {
    for (size_t i = 0; i < count; i++) {
        const seen_point *p = &points[i];
        if (p->emits && !lamps_count) continue;
        for (int k = 0; k < 2; k++) { /* its place, and all together */
            place *at = &places[k ? SEEN_PLACES : p->from];
            add(&at->luminance, luminance(p->radiance), p->weight);
            add(&at->light, brightest_of(p->light), p->weight);
            add(&at->area, luminance(p->radiance), p->area);
        }
    }
}

/* EV from what each place has seen; false if none has seen light. */
static bool judge(place *places, double white, double *ev) {
    double wanted = 0.0, shown = INFINITY, carried = INFINITY;
    int lit = 0;
    for (int k = 0; k < SEEN_PLACES; k++) {
        histogram *h = &places[k].luminance;
        if (!(h->total > 0.0)) continue;
        drop_dark(h);
        lit++;
        wanted += log2(EXPOSURE_MIDDLE_GREY) - trimmed_mean(h);
        shown = fmin(shown, log2(EXPOSURE_MEDIAN_MAX) - bright_stop(h, 0.5));
        shown = fmin(shown, log2(white) - bright_stop(h, EXPOSURE_BURNT));
        carried = fmin(carried, log2(white) - bright_stop(&places[k].light, EXPOSURE_BURNT_LIGHT));
    }
    if (lit == 0) return false;
    drop_dark(&places[SEEN_PLACES].luminance);
    double median = bright_stop(&places[SEEN_PLACES].luminance, 0.5);
    double best = fmin(wanted / lit, fmin(shown, carried));
    best = fmax(best, fmin(shown, log2(EXPOSURE_MEDIAN_DIM) - median));
    histogram *all = &places[SEEN_PLACES].area;
    drop_dark(all);
    double middle = bright_stop(all, 0.5);
    best = fmax(best, fmin(log2(EXPOSURE_MEDIAN_DIM) - middle, log2(white) - bright_stop(all, EXPOSURE_BURNT)));
    *ev = fmax(best, log2(EXPOSURE_MEDIAN_MIN) - middle);
    return true;
}

double exposure_meter(const seen_point *points, size_t count, double white) {
    double ev = 0.0;
    place *places = NULL;
    for (int lamps_count = 0; lamps_count < 2; lamps_count++) {
        free(places);
        places = calloc(SEEN_PLACES + 1, sizeof *places);
        if (!places) return 0.0;
        collect_seen(places, points, count, lamps_count);
        if (judge(places, white, &ev)) break;
    }
    free(places);
    return fmin(fmax(ev, -EXPOSURE_EV_MAX), EXPOSURE_EV_MAX);
}

void exposure_apply(float *rgb, size_t count, double ev) {
    float scale = (float)exp2(ev);
    for (size_t i = 0; i < 3 * count; i++) rgb[i] *= scale;
}
