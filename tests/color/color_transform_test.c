/* SPDX-License-Identifier: MIT
 * Does a view show what it promises, whatever goes in, and does a wrong name or file get a clear answer? */
#include "check.h"
#include "color_transform.h"

#include <stdlib.h>
#include <time.h>

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

/* ---- hard values ------------------------------------------------------------------------------------------------ */

static void what_comes_out_is_finite_whatever_goes_in(void) {
    const float hard[] = { NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-45f, -1.0f, 0.0f, 65504.0f };
    const char *const views[] = { "Standard", "ACES 1.x SDR", "Raw" };
    enum { HARD = sizeof hard / sizeof hard[0] };
    for (int v = 0; v < 3; v++) {
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

/* ---- names and files -------------------------------------------------------------------------------------------- */

static void the_defaults_are_named(void) {
    color_transform *transform = make(NULL);
    CHECK_TEXT(color_transform_config(transform), "hemibake");
    CHECK_TEXT(color_transform_display(transform), "sRGB");
    CHECK_TEXT(color_transform_view(transform), "Standard");
    CHECK_TEXT(color_transform_look(transform), "");
    CHECK_TEXT(color_transform_source(transform), "Linear Rec.709");
    color_transform_destroy(transform);
    transform = make("aces 1.X sdr");
    CHECK_TEXT(color_transform_view(transform), "ACES 1.x SDR");
    color_transform_destroy(transform);
}

static hemi_result create(const color_transform_desc *desc, char *message) {
    color_transform *transform = NULL;
    hemi_result result = color_transform_create(desc, &transform, message);
    CHECK((result == HEMI_OK) == (transform != NULL));
    CHECK((result == HEMI_OK) == (message[0] == '\0'));
    CHECK(strpbrk(message, "\r\n") == NULL);
    color_transform_destroy(transform);
    return result;
}

static void unknown_names_are_answered_with_the_known_ones(void) {
    char message[COLOR_MESSAGE_SIZE];
    CHECK_EQUAL(create(&(color_transform_desc){ .view = "Filmic" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"Filmic\"") && strstr(message, "Standard, ACES 1.x SDR, Raw"));
    CHECK_EQUAL(create(&(color_transform_desc){ .display = "Rec.2020" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"Rec.2020\"") && strstr(message, "sRGB"));
    CHECK_EQUAL(create(&(color_transform_desc){ .look = "moody" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"moody\"") && strstr(message, "there are: none"));
    CHECK_EQUAL(create(&(color_transform_desc){ .look = "" }, message), HEMI_OK);
    CHECK_EQUAL(create(&(color_transform_desc){ .view = "" }, message), HEMI_ERROR_ARGUMENT);
}

/* Writes text to a temporary file and creates a transform from it. */
static hemi_result create_from(const char *text, color_transform_desc desc, color_transform **out, char *message) {
    char path[] = "/tmp/hemibake-ocio-XXXXXX";
    int descriptor = mkstemp(path);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
    desc.config = path;
    hemi_result result = color_transform_create(&desc, out, message);
    CHECK(strpbrk(message, "\r\n") == NULL);
    remove(path);
    return result;
}

static void broken_configurations_are_refused(void) {
    const struct {
        const char *text;
        hemi_result result;
    } cases[] = { { "", HEMI_ERROR_FILE },
                  { "{[", HEMI_ERROR_DATA },
                  { "ocio_profile_version: 2\n", HEMI_ERROR_DATA },
                  { "ocio_profile_version: nonsense\n", HEMI_ERROR_DATA },
                  { "ocio_profile_version: 9\n", HEMI_ERROR_UNSUPPORTED },
                  { "ocio_profile_version: 2.99\n", HEMI_ERROR_UNSUPPORTED },
                  { "\x01\x02\x03\xff", HEMI_ERROR_DATA } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char message[COLOR_MESSAGE_SIZE];
        color_transform *transform;
        CHECK_EQUAL(create_from(cases[i].text, (color_transform_desc){ 0 }, &transform, message), cases[i].result);
        CHECK(transform == NULL && message[0] != '\0');
    }
}

static void a_missing_configuration_is_named(void) {
    char message[COLOR_MESSAGE_SIZE];
    CHECK_EQUAL(create(&(color_transform_desc){ .config = "no/such.ocio" }, message), HEMI_ERROR_FILE);
    CHECK(strstr(message, "no/such.ocio"));
    CHECK(create(&(color_transform_desc){ .config = "/" }, message) != HEMI_OK);
}

static void the_configuration_inside_is_the_file_in_the_tree(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL, *inside = make("ACES 1.x SDR");
    color_transform_desc desc = { .config = "color/hemibake.ocio", .view = "ACES 1.x SDR" };
    float a[3] = { 0.7f, 0.2f, 0.05f }, b[3] = { 0.7f, 0.2f, 0.05f };
    CHECK_EQUAL(color_transform_create(&desc, &transform, message), HEMI_OK);
    CHECK_TEXT(color_transform_config(transform), "color/hemibake.ocio");
    color_transform_apply(transform, a, 1, NULL);
    color_transform_apply(inside, b, 1, NULL);
    CHECK(memcmp(a, b, sizeof a) == 0);
    color_transform_destroy(transform);
    color_transform_destroy(inside);
}

/* A configuration whose scene_linear is ACEScg, as studios have; %s is its name for linear Rec.709, if any. */
static const char aces_config[] =
    "ocio_profile_version: 2\n"
    "roles: {scene_linear: ACEScg, aces_interchange: ACES2065-1, default: ACEScg}\n"
    "file_rules:\n"
    "  - !<Rule> {name: Default, colorspace: default}\n"
    "displays:\n"
    "  sRGB:\n"
    "    - !<View> {name: Plain, colorspace: sRGB}\n"
    "    - !<View> {name: Halved, colorspace: sRGB, looks: half}\n"
    "looks:\n"
    "  - !<Look> {name: half, process_space: ACEScg, transform: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, "
    "0, "
    "0, 0, 0.5, 0, 0, 0, 0, 1]}}\n"
    "  - !<Look> {name: double, process_space: ACEScg, transform: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, "
    "0, 0, 2, 0, 0, 0, 0, 1]}}\n"
    "colorspaces:\n"
    "  - !<ColorSpace> {name: ACES2065-1}\n"
    "  - !<ColorSpace> {name: ACEScg, to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}}\n"
    "  - !<ColorSpace>\n"
    "    name: sRGB\n"
    "    from_scene_reference: !<GroupTransform>\n"
    "      children:\n"
    "        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}\n"
    "        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}\n"
    "        - !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}\n";

static void check_color(const color_transform_desc *desc, double scale, const char *look) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    float rgb[3] = { 0.4f, 0.1f, 0.05f };
    CHECK_EQUAL(create_from(aces_config, *desc, &transform, message), HEMI_OK);
    if (!transform) return;
    CHECK_EQUAL(color_transform_apply(transform, rgb, 1, NULL), HEMI_OK);
    CHECK_NEAR(rgb[0], 0.4 * scale, 1e-5);
    CHECK_NEAR(rgb[1], 0.1 * scale, 1e-5);
    CHECK_NEAR(rgb[2], 0.05 * scale, 1e-5);
    CHECK_TEXT(color_transform_look(transform), look);
    CHECK_TEXT(color_transform_source(transform), "aces_interchange");
    color_transform_destroy(transform);
}

/* Radiance is Rec.709 whatever the configuration calls scene-linear: a red stays that red. */
static void radiance_enters_an_aces_configuration_as_rec709(void) {
    check_color(&(color_transform_desc){ .view = "Plain" }, 1.0, "");
}

static void looks_are_the_views_own_unless_given(void) {
    check_color(&(color_transform_desc){ .view = "Halved" }, 0.5, "half");
    check_color(&(color_transform_desc){ .view = "Halved", .look = "" }, 1.0, "");
    check_color(&(color_transform_desc){ .view = "Halved", .look = "double" }, 2.0, "double");
    check_color(&(color_transform_desc){ .view = "Plain", .look = "-double" }, 0.5, "-double");
    check_color(&(color_transform_desc){ .view = "Plain", .look = "half, double" }, 1.0, "half, double");
}

/* ---- speed ------------------------------------------------------------------------------------------------------ */

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The limit is ten times what it takes, so that it holds under sanitizers and on a busy machine; the time is printed.
 */
static void a_million_colours_are_quick(void) {
    enum { COUNT = 1000000 };
    const char *const views[] = { "Standard", "ACES 1.x SDR" };
    float *rgb = malloc(3 * sizeof *rgb * COUNT);
    for (int v = 0; v < 2; v++) {
        color_transform *transform = make(views[v]);
        for (size_t i = 0; i < 3 * (size_t)COUNT; i++) rgb[i] = (float)(i * 7919 % 10007) / 5000.0f;
        double begin = seconds();
        CHECK_EQUAL(color_transform_apply(transform, rgb, COUNT, NULL), HEMI_OK);
        double taken = seconds() - begin;
        printf("a million colours through %s: %.3f s\n", views[v], taken);
        CHECK(taken < 2.0);
        color_transform_destroy(transform);
    }
    free(rgb);
}

int main(void) {
    RUN(the_standard_view_gives_colours_back_clamped);
    RUN(the_standard_display_values_are_srgb);
    RUN(the_aces_view_is_monotonic_and_in_range);
    RUN(aces_middle_grey_lands_at_ten_percent);
    RUN(the_raw_view_shows_radiance_as_code_values);
    RUN(what_comes_out_is_finite_whatever_goes_in);
    RUN(clipped_colours_are_counted_once);
    RUN(a_colour_does_not_know_its_neighbours);
    RUN(the_defaults_are_named);
    RUN(unknown_names_are_answered_with_the_known_ones);
    RUN(broken_configurations_are_refused);
    RUN(a_missing_configuration_is_named);
    RUN(the_configuration_inside_is_the_file_in_the_tree);
    RUN(radiance_enters_an_aces_configuration_as_rec709);
    RUN(looks_are_the_views_own_unless_given);
    RUN(a_million_colours_are_quick);
    return check_end();
}
