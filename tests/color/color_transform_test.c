/* SPDX-License-Identifier: MIT
 * Does a view show what it promises, whatever goes in? */
#include "check.h"
#include "color_transform.h"

static color_transform *make(const char *view) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    CHECK_EQUAL(color_transform_create(&(color_transform_desc){ .view = view }, &transform, message), HEMI_OK);
    CHECK_TEXT(message, "");
    return transform;
}

static double srgb_encode(double x) {
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

/* ---- views ------------------------------------------------------------------------------------------------------ */

static void the_standard_view_gives_colours_back_clamped(void) {
    enum { COUNT = 5000 };
    static float rgb[3 * COUNT];
    color_transform *transform = make("Standard");
    size_t clipped = 0, expected = 0;
    for (size_t i = 0; i < COUNT; i++) {
        rgb[3 * i] = (float)i / 4000.0f;
        rgb[3 * i + 1] = 0.5f * rgb[3 * i];
        rgb[3 * i + 2] = 0.18f;
        expected += rgb[3 * i] > 1.0f + COLOR_CLIP_SLACK;
    }
    CHECK_EQUAL(color_transform_apply(transform, rgb, COUNT, &clipped), HEMI_OK);
    for (size_t i = 0; i < COUNT; i++) {
        CHECK_NEAR(rgb[3 * i], fmin((double)i / 4000.0, 1.0), 1e-5);
        CHECK_NEAR(rgb[3 * i + 1], (double)i / 8000.0, 1e-5);
        CHECK_NEAR(rgb[3 * i + 2], 0.18, 1e-5);
    }
    CHECK_EQUAL(clipped, expected);
    color_transform_destroy(transform);
}

/* The curve that color/hemibake.ocio documents. */
static void soften(const float in[3], double out[3]) {
    double v = fmax(in[0], fmax(in[1], in[2])), scale = v > 0.5 ? (1 + log(2 * v)) / 2 / v : 1;
    for (int c = 0; c < 3; c++) {
        double u = scale * in[c];
        out[c] = u > 0.5 ? 1 - exp(1 - 2 * u) / 2 : u;
    }
}

/* From a tiny part of white to 2^26 of it, greys and saturated colours. */
static void the_soft_view_is_the_curve_that_is_documented_and_clips_nothing(void) {
    enum { COUNT = 3000 };
    static float from[3 * COUNT], rgb[3 * COUNT];
    color_transform *transform = make("Soft");
    size_t clipped = 99;
    for (int i = 0; i < 3 * COUNT; i++)
        rgb[i] = from[i] = exp2f(-12.0f + 0.0125f * (float)(i / 3) - (float)(i % 3 * (i / 3 % 7)));
    CHECK_EQUAL(color_transform_apply(transform, rgb, COUNT, &clipped), HEMI_OK);
    CHECK_EQUAL(clipped, 0);
    for (int i = 0; i < COUNT; i++) {
        double expected[3];
        soften(&from[3 * i], expected);
        for (int c = 0; c < 3; c++) CHECK_NEAR(rgb[3 * i + c], expected[c], 1e-5); /* through hue and back, in floats */
    }
    color_transform_destroy(transform);
}

static void the_soft_view_leaves_colours_under_half_of_white(void) {
    float rgb[] = { 0.5f, 0.4f, 0.1f, 0.18f, 0.18f, 0.18f, 0.01f, 0.3f, 0.02f, 2.0f, 2.0f, 2.0f };
    const double expected[] = { 0.5, 0.4, 0.1, 0.18, 0.18, 0.18, 0.01, 0.3, 0.02, 0.875, 0.875, 0.875 };
    color_transform *transform = make("Soft");
    CHECK_EQUAL(color_transform_apply(transform, rgb, 4, NULL), HEMI_OK);
    for (int i = 0; i < 12; i++) CHECK_NEAR(rgb[i], expected[i], 1e-5);
    color_transform_destroy(transform);
}

/* What clips has its white at 1; Soft shows 1 - 1 / (4 x), which is code value 240 from 1.94 on. */
static void white_is_where_a_view_shows_next_to_it(void) {
    const char *const views[] = { "Standard", "Soft" };
    const double white[] = { 1.0, 2.0 };
    for (int i = 0; i < 2; i++) {
        color_transform *transform = make(views[i]);
        CHECK_NEAR(color_transform_white(transform), white[i], 0.0);
        color_transform_destroy(transform);
    }
    color_transform *filmic = make("Filmic");
    CHECK(color_transform_white(filmic) > 1.0);
    color_transform_destroy(filmic);
}

static void the_standard_display_values_are_srgb(void) {
    float rgb[3 * 101];
    color_transform *transform = make("Standard");
    for (int i = 0; i < 303; i++) rgb[i] = (float)(i / 3) / 100.0f;
    CHECK_EQUAL(color_transform_apply_display(transform, rgb, 101, NULL), HEMI_OK);
    /* The library's curve has its joint where the two pieces meet smoothly, 1e-5 from that of IEC 61966-2-1. */
    for (int i = 0; i < 303; i++) CHECK_NEAR(rgb[i], srgb_encode((i / 3) / 100.0), 2e-5);
    color_transform_destroy(transform);
}

static void the_aces_view_is_monotonic_and_in_range(void) {
    enum { COUNT = 4001 };
    static float rgb[3 * COUNT];
    color_transform *transform = make("ACES 1.x SDR");
    for (size_t i = 0; i < 3 * COUNT; i++) rgb[i] = exp2f(-16.0f + 24.0f * (float)(i / 3) / (COUNT - 1)); /* to 256 */
    CHECK_EQUAL(color_transform_apply(transform, rgb, COUNT, NULL), HEMI_OK);
    for (size_t i = 0; i < 3 * COUNT; i++) {
        CHECK(rgb[i] >= 0.0f && rgb[i] <= 1.0f);
        if (i >= 3) CHECK(rgb[i] >= rgb[i - 3]);
    }
    CHECK(rgb[0] < 1e-3f);
    CHECK(rgb[3 * COUNT - 1] > 0.99f);
    color_transform_destroy(transform);
}

/* The ACES 1.x reference tone scale shows 0.18 at 4.8 of 48 cd/m2, a tenth of white; the surround compensation of the
 * video output raises that to 0.104, code value 0.356 on the sRGB display. */
static void aces_middle_grey_lands_at_ten_percent(void) {
    float linear[3] = { 0.18f, 0.18f, 0.18f }, code[3] = { 0.18f, 0.18f, 0.18f };
    color_transform *transform = make("ACES 1.x SDR");
    CHECK_EQUAL(color_transform_apply(transform, linear, 1, NULL), HEMI_OK);
    CHECK_EQUAL(color_transform_apply_display(transform, code, 1, NULL), HEMI_OK);
    for (int c = 0; c < 3; c++) {
        CHECK_NEAR(linear[c], 0.104, 0.001);
        CHECK_NEAR(code[c], 0.356, 0.001);
        CHECK_NEAR(srgb_encode(linear[c]), code[c], 2e-5);
    }
    color_transform_destroy(transform);
}

static void the_raw_view_shows_radiance_as_code_values(void) {
    float linear[3] = { 0.0f, 0.5f, 1.0f }, code[3] = { 0.0f, 0.5f, 1.0f };
    color_transform *transform = make("Raw");
    CHECK_EQUAL(color_transform_apply_display(transform, code, 1, NULL), HEMI_OK);
    CHECK_EQUAL(color_transform_apply(transform, linear, 1, NULL), HEMI_OK);
    CHECK_NEAR(code[1], 0.5, 1e-6);
    CHECK_NEAR(linear[1], 0.2140411, 1e-5); /* ((0.5 + 0.055) / 1.055)^2.4 */
    CHECK_NEAR(linear[2], 1.0, 1e-5);
    color_transform_destroy(transform);
}

/* The curve that color/hemibake.ocio documents, for grey: t stops over middle grey. */
static double filmic(double x) {
    double t = log2(x / 0.18 + exp2(-10)), grey = pow(0.18, 1 / 2.2), slope = 1.15 * grey * log(2) / 2.2;
    double p = t > 0 ? 1.9 : 1.6, a = t > 0 ? 0.65977 : 0.49946;
    return pow(fmax(grey + slope * t / pow(1 + pow(fabs(slope * t / a), p), 1 / p), 0), 2.2);
}

static void the_filmic_view_is_the_curve_that_is_documented(void) {
    color_transform *transform = make("Filmic");
    for (double stop = -9.9; stop < 6; stop += 0.07) {
        float code[3];
        code[0] = code[1] = code[2] = (float)(0.18 * exp2(stop));
        CHECK_EQUAL(color_transform_apply_display(transform, code, 1, NULL), HEMI_OK);
        /* Between the stops at which it is given the curve is a spline; half a code value is what a pixel rounds. */
        for (int c = 0; c < 3; c++) CHECK_NEAR(255 * code[c], 255 * srgb_encode(filmic(0.18 * exp2(stop))), 0.5);
    }
    color_transform_destroy(transform);
}

static void the_filmic_view_keeps_grey_and_bleaches_lights(void) {
    float rgb[] = { 0, 0, 0, 0.18f, 0.18f, 0.18f, 11.6f, 11.6f, 11.6f, 0.1f, 0, 0, 20.0f, 0, 0 };
    size_t clipped = 99;
    color_transform *transform = make("Filmic");
    CHECK_EQUAL(color_transform_apply(transform, rgb, 5, &clipped), HEMI_OK);
    CHECK_EQUAL(clipped, 0); /* whatever is lit shows something */
    CHECK_NEAR(rgb[0], 0, 1e-6);
    CHECK_NEAR(rgb[3], 0.18, 5e-4); /* t is 2^-10 there, not 0: 0.0014 stops */
    CHECK_NEAR(rgb[6], 1, 1e-5);
    CHECK(rgb[10] / rgb[9] < 0.1f && rgb[13] / rgb[12] > 0.4f);
    color_transform_destroy(transform);
}

/* Rec.709 red in P3 primaries with the same white [ITU-R BT.709-6, SMPTE EG 432-1]: (0.82246, 0.03319, 0.01708). */
static void display_p3_shows_the_same_colour_in_its_own_primaries(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    float red[3] = { 1, 0, 0 }, white[3] = { 1, 1, 1 };
    CHECK_EQUAL(color_transform_create(&(color_transform_desc){ .display = "Display P3", .view = "Standard" },
                                       &transform, message),
                HEMI_OK);
    if (!transform) return;
    CHECK_EQUAL(color_transform_apply(transform, red, 1, NULL), HEMI_OK);
    CHECK_EQUAL(color_transform_apply(transform, white, 1, NULL), HEMI_OK);
    CHECK_NEAR(red[0], 0.82246, 2e-5);
    CHECK_NEAR(red[1], 0.03319, 2e-5);
    CHECK_NEAR(red[2], 0.01708, 2e-5);
    for (int c = 0; c < 3; c++) CHECK_NEAR(white[c], 1, 1e-5);
    color_transform_destroy(transform);
}

/* ---- hard values ------------------------------------------------------------------------------------------------ */

static void what_comes_out_is_finite_whatever_goes_in(void) {
    const float hard[] = { NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-45f, -1.0f, 0.0f, 65504.0f };
    const char *const views[] = { "Soft", "Standard", "ACES 1.x SDR", "Filmic", "Raw" };
    enum { HARD = sizeof hard / sizeof hard[0] };
    for (int v = 0; v < 5; v++) {
        color_transform *transform = make(views[v]);
        for (int i = 0; i < HARD * HARD * HARD; i++) {
            float linear[3] = { hard[i % HARD], hard[i / HARD % HARD], hard[i / HARD / HARD] }, code[3];
            memcpy(code, linear, sizeof code);
            color_transform_apply(transform, linear, 1, NULL);
            color_transform_apply_display(transform, code, 1, NULL);
            for (int c = 0; c < 3; c++)
                CHECK(linear[c] >= 0.0f && linear[c] <= 1.0f && code[c] >= 0.0f && code[c] <= 1.0f);
        }
        color_transform_destroy(transform);
    }
}

static void clipped_colours_are_counted_once(void) {
    float rgb[] = { 0.5f, 0.5f, 0.5f, 2.0f, 2.0f, 2.0f, NAN, 0, 0, 0, -0.1f, 0, 1.0f, 1.0f, 1.0f };
    color_transform *transform = make("Standard");
    size_t clipped = 99;
    CHECK_EQUAL(color_transform_apply(transform, rgb, 5, &clipped), HEMI_OK);
    CHECK_EQUAL(clipped, 3);
    CHECK_EQUAL(color_transform_apply(transform, NULL, 0, &clipped), HEMI_OK);
    CHECK_EQUAL(clipped, 0);
    color_transform_destroy(transform);
}

/* The answer for a colour may not depend on which others are processed with it. */
static void a_colour_does_not_know_its_neighbours(void) {
    enum { COUNT = 3001 };
    static float many[3 * COUNT];
    color_transform *transform = make("ACES 1.x SDR");
    for (int i = 0; i < 3 * COUNT; i++) many[i] = (float)((i * 37) % 1001) / 300.0f;
    float one[3];
    memcpy(one, &many[3 * 2999], sizeof one);
    color_transform_apply(transform, many, COUNT, NULL);
    color_transform_apply(transform, one, 1, NULL);
    CHECK(memcmp(one, &many[3 * 2999], sizeof one) == 0);
    color_transform_destroy(transform);
}

int main(void) {
    RUN(the_standard_view_gives_colours_back_clamped);
    RUN(the_soft_view_is_the_curve_that_is_documented_and_clips_nothing);
    RUN(the_soft_view_leaves_colours_under_half_of_white);
    RUN(white_is_where_a_view_shows_next_to_it);
    RUN(the_standard_display_values_are_srgb);
    RUN(the_aces_view_is_monotonic_and_in_range);
    RUN(aces_middle_grey_lands_at_ten_percent);
    RUN(the_raw_view_shows_radiance_as_code_values);
    RUN(the_filmic_view_is_the_curve_that_is_documented);
    RUN(the_filmic_view_keeps_grey_and_bleaches_lights);
    RUN(display_p3_shows_the_same_colour_in_its_own_primaries);
    RUN(what_comes_out_is_finite_whatever_goes_in);
    RUN(clipped_colours_are_counted_once);
    RUN(a_colour_does_not_know_its_neighbours);
    return check_end();
}
