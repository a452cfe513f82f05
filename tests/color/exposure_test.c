/* SPDX-License-Identifier: MIT
 * Does the meter map a scene's middle to middle grey, and do lamps and darkness leave it alone? */
#include "check.h"
#include "exposure.h"

#include <stdint.h>

enum { COUNT = 10000 };

static void set_grey(float *rgb, size_t index, double value) {
    for (int c = 0; c < 3; c++) rgb[3 * index + (size_t)c] = (float)value;
}

/* A room: luminance from 1/4 to 4, even in stops, so that its geometric mean is 1. */
static void make_room(float *rgb) {
    for (size_t i = 0; i < COUNT; i++) set_grey(rgb, i, exp2(-2.0 + 4.0 * ((double)i + 0.5) / COUNT));
}

/* Of points that are all seen from one place. weights: the area that each stands for; NULL: all alike. */
static double meter(const float *rgb, const float *weights, size_t count) {
    static seen_point points[COUNT];
    for (size_t i = 0; i < count; i++) {
        float weight = weights ? weights[i] : 1.0f;
        points[i] = (seen_point){ .weight = weight, .area = weight, .from = SEEN_FROM_INSIDE };
        memcpy(points[i].radiance, rgb + 3 * i, sizeof points[i].radiance);
    }
    return exposure_meter(points, count, 1.0);
}

static void constant_radiance_maps_to_middle_grey(void) {
    static float rgb[3 * COUNT];
    const double values[] = { 1e-4, 0.18, 1.0, 37.5, 2e4 };
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        for (size_t i = 0; i < COUNT; i++) set_grey(rgb, i, values[k]);
        double ev = meter(rgb, NULL, COUNT);
        exposure_apply(rgb, COUNT, ev);
        /* float32 colours and a float32 scale: three roundings of 2^-24. */
        CHECK_NEAR(rgb[3 * 777 + 1], EXPOSURE_MIDDLE_GREY, 0.18 * 3e-7);
    }
}

static void the_geometric_mean_maps_to_middle_grey(void) {
    static float rgb[3 * COUNT];
    make_room(rgb);
    CHECK_NEAR(meter(rgb, NULL, COUNT), log2(0.18), 1e-3);
}

static void luminance_is_weighed_by_rec709(void) {
    const float green[3] = { 0.0f, 1.0f, 0.0f };
    CHECK_NEAR(meter(green, NULL, 1), log2(0.18 / 0.7152), 1e-6);
}

/* Area counts, not the number of points: three quarters at 1, one quarter at 2, in equal numbers of points. */
static void weights_are_areas(void) {
    static float rgb[3 * COUNT], weights[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        set_grey(rgb, i, i % 2 ? 2.0 : 1.0);
        weights[i] = i % 2 ? 1.0f : 3.0f;
    }
    /* 5 % of the area goes off each end: (0.70 * 0 + 0.20 * 1) / 0.90 stops. */
    CHECK_NEAR(meter(rgb, weights, COUNT), log2(0.18) - 0.2 / 0.9, 1e-6);
}

/* Over 1 % of the area. Without the trim a lamp of 1000 would move the mean by 0.1 stop, one of 1e6 by 0.2. */
static void a_lamp_moves_the_exposure_by_less_than_a_twentieth_of_a_stop(void) {
    static float rgb[3 * COUNT];
    make_room(rgb);
    double without = meter(rgb, NULL, COUNT);
    const double lamps[] = { 1e3, 1e6 };
    for (int k = 0; k < 2; k++) {
        make_room(rgb);
        for (size_t i = 0; i < COUNT; i += 100) set_grey(rgb, i, lamps[k]);
        double with = meter(rgb, NULL, COUNT);
        printf("a lamp of %g over 1 %% of the area: %+.4f EV\n", lamps[k], with - without);
        CHECK(fabs(with - without) < 0.05);
        CHECK(with < without);
    }
}

static void darkness_moves_nothing(void) {
    static float rgb[3 * COUNT];
    const double darks[] = { 0.0, 1e-30, 1e-5 };
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < COUNT; i++) set_grey(rgb, i, i % 5 < 3 ? darks[k] : 2.0); /* 60 % see no light */
        CHECK_NEAR(meter(rgb, NULL, COUNT), log2(0.18 / 2.0), 1e-6);
    }
}

static void a_black_scene_has_exposure_zero(void) {
    static float rgb[3 * COUNT], weights[COUNT];
    memset(rgb, 0, sizeof rgb);
    CHECK_NEAR(meter(rgb, NULL, COUNT), 0.0, 0.0);
    CHECK_NEAR(meter(rgb, NULL, 0), 0.0, 0.0);
    make_room(rgb);
    CHECK_NEAR(meter(rgb, weights, COUNT), 0.0, 0.0); /* nothing but lamps: every weight is 0 */
}

static void values_that_are_no_radiance_are_passed_over(void) {
    static float rgb[3 * COUNT], weights[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        set_grey(rgb, i, 1.0);
        weights[i] = 1.0f;
    }
    set_grey(rgb, 1, NAN);
    set_grey(rgb, 2, INFINITY);
    set_grey(rgb, 3, -5.0);
    weights[4] = NAN;
    weights[5] = -1.0f;
    weights[6] = INFINITY;
    CHECK_NEAR(meter(rgb, weights, COUNT), log2(0.18), 1e-9);
}

static void the_range_is_bounded(void) {
    float rgb[3];
    set_grey(rgb, 0, 1e30);
    CHECK_NEAR(meter(rgb, NULL, 1), -EXPOSURE_EV_MAX, 0.0);
    set_grey(rgb, 0, 1e-30);
    CHECK_NEAR(meter(rgb, NULL, 1), EXPOSURE_EV_MAX, 0.0);
}

/* ---- of what is seen ---- */

static void see(seen_point *points, seen_from from, double value) {
    for (size_t i = 0; i < COUNT; i++) {
        points[i] = (seen_point){ .weight = 1.0f, .area = 1.0f, .from = from };
        set_grey(points[i].radiance, 0, value);
        set_grey(points[i].light, 0, value);
    }
}

static void what_is_seen_maps_to_middle_grey_and_lamps_do_not_count(void) {
    static seen_point points[COUNT];
    see(points, SEEN_FROM_INSIDE, 2.0);
    for (size_t i = 0; i < COUNT / 4; i++) {
        set_grey(points[4 * i].radiance, 0, 1e4);
        points[4 * i].emits = true;
    }
    CHECK_NEAR(exposure_meter(points, COUNT, 1.0), log2(0.18 / 2.0), 1e-6);
}

/* A tenth of what is seen is 64 times as bright as the rest, which would lie at 0.18: it comes to lie at white. */
static void highlights_are_bounded(void) {
    static seen_point points[COUNT];
    see(points, SEEN_FROM_OUTSIDE, 1.0);
    for (size_t i = 0; i < COUNT; i += 10) set_grey(points[i].radiance, 0, 64.0);
    /* A bin is a sixteenth of a stop, and its upper end counts. */
    CHECK_NEAR(exposure_meter(points, COUNT, 1.0), -6.0, 1.0 / 16 + 1e-6);
    CHECK_NEAR(exposure_meter(points, COUNT, 2.0), -5.0, 1.0 / 16 + 1e-6);
}

/* A hundredth that is 1000 times as bright is left to burn. */
static void small_highlights_burn(void) {
    static seen_point points[COUNT];
    see(points, SEEN_FROM_OUTSIDE, 1.0);
    for (size_t i = 0; i < COUNT; i += 100) set_grey(points[i].radiance, 0, 1000.0);
    CHECK_NEAR(exposure_meter(points, COUNT, 1.0), log2(0.18), 1e-6);
}

static void where_all_emits_lamps_are_metered(void) {
    static seen_point points[COUNT];
    see(points, SEEN_FROM_INSIDE, 8.0);
    for (size_t i = 0; i < COUNT; i++) points[i].emits = true;
    CHECK_NEAR(exposure_meter(points, COUNT, 1.0), log2(0.18 / 8.0), 1e-6);
    see(points, SEEN_FROM_INSIDE, 0.0);
    CHECK_NEAR(exposure_meter(points, COUNT, 1.0), 0.0, 0.0);
    CHECK_NEAR(exposure_meter(NULL, 0, 1.0), 0.0, 0.0);
}

int main(void) {
    RUN(what_is_seen_maps_to_middle_grey_and_lamps_do_not_count);
    RUN(highlights_are_bounded);
    RUN(small_highlights_burn);
    RUN(where_all_emits_lamps_are_metered);
    RUN(constant_radiance_maps_to_middle_grey);
    RUN(the_geometric_mean_maps_to_middle_grey);
    RUN(luminance_is_weighed_by_rec709);
    RUN(weights_are_areas);
    RUN(a_lamp_moves_the_exposure_by_less_than_a_twentieth_of_a_stop);
    RUN(darkness_moves_nothing);
    RUN(a_black_scene_has_exposure_zero);
    RUN(values_that_are_no_radiance_are_passed_over);
    RUN(the_range_is_bounded);
    return check_end();
}
