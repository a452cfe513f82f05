/* SPDX-License-Identifier: MIT
 * Does an asset's colour arrive in the working space as the same colour, and only as light that can be? */
#include "color_config.h"
#include "color_input.h"

/* An input into working_space of the configuration inside; both are destroyed by close_input. */
typedef struct opened {
    color_transform *transform;
    color_input *input;
} opened;

static opened open_input(const char *working_space, color_input_desc desc) {
    char message[COLOR_MESSAGE_SIZE];
    opened o = { 0 };
    color_transform_desc transform = { .view = "Standard", .working_space = working_space };
    CHECK_EQUAL(color_transform_create(&transform, &o.transform, message), HEMI_OK);
    CHECK_EQUAL(color_input_create(o.transform, &desc, &o.input, message), HEMI_OK);
    CHECK_TEXT(message, "");
    return o;
}

static void close_input(opened o) {
    color_input_destroy(o.input);
    color_transform_destroy(o.transform);
}

static void check_rgb(const float rgb[3], double r, double g, double b) {
    /* Matrices of published primaries have five digits or more, and sums of three float products round less. */
    CHECK_NEAR(rgb[0], r, 2e-5);
    CHECK_NEAR(rgb[1], g, 2e-5);
    CHECK_NEAR(rgb[2], b, 2e-5);
}

static void check_input(const char *working_space, color_input_desc desc, float value, const double expected[3]) {
    opened o = open_input(working_space, desc);
    float rgb[3] = { value, 0.5f * value, 0.0f };
    size_t outside = 99;
    CHECK_EQUAL(color_input_apply(o.input, rgb, 1, &outside), HEMI_OK);
    check_rgb(rgb, expected[0], expected[1], expected[2]);
    CHECK_EQUAL(outside, 0);
    close_input(o);
}

/* ---- spaces ----------------------------------------------------------------------------------------------------- */

static void factors_are_linear_and_textures_are_srgb_by_gltfs_rule(void) {
    const double linear[3] = { 0.5, 0.25, 0 }, decoded[3] = { 0.2140411, 0.0508761, 0 };
    check_input(NULL, (color_input_desc){ .origin = COLOR_ORIGIN_FACTOR }, 0.5f, linear);
    check_input(NULL, (color_input_desc){ .origin = COLOR_ORIGIN_TEXTURE }, 0.5f, decoded);
    opened o = open_input(NULL, (color_input_desc){ .origin = COLOR_ORIGIN_FACTOR });
    CHECK(color_input_is_identity(o.input));
    close_input(o);
}

/* Rec.709 red and half as much green in the primaries of AP1 [ACES S-2014-004 with Bradford adaptation] and Rec.2020
 * [ITU-R BT.2087]: columns of the matrices. */
static void primaries_are_converted(void) {
    const double ap1[3] = { 0.61310 + 0.5 * 0.33952, 0.07019 + 0.5 * 0.91636, 0.02062 + 0.5 * 0.10957 };
    const double rec2020[3] = { 0.62740 + 0.5 * 0.32928, 0.06910 + 0.5 * 0.91954, 0.01639 + 0.5 * 0.08801 };
    check_input("ACEScg", (color_input_desc){ 0 }, 1.0f, ap1);
    check_input("Linear Rec.2020", (color_input_desc){ 0 }, 1.0f, rec2020);
}

static void a_named_space_replaces_gltfs_rule(void) {
    const double linear[3] = { 0.5, 0.25, 0 }, decoded[3] = { 0.2140411, 0.0508761, 0 };
    check_input(NULL, (color_input_desc){ .origin = COLOR_ORIGIN_FACTOR, .space = "srgb_texture" }, 0.5f, decoded);
    check_input(NULL, (color_input_desc){ .origin = COLOR_ORIGIN_TEXTURE, .space = "Raw" }, 0.5f, linear);
    check_input("ACEScg", (color_input_desc){ .space = "acescg" }, 0.5f, linear);
}

static void check_rule(const char *file, const char *space) {
    opened o = open_input(NULL, (color_input_desc){ .space = COLOR_INPUT_FILE_RULES, .file = file });
    CHECK_TEXT(color_input_space(o.input), space);
    close_input(o);
}

static void file_rules_choose_by_name(void) {
    check_rule("textures/wood.PNG", "sRGB - Texture");
    check_rule("wood.jpeg", "sRGB - Texture");
    check_rule("wood_acescg.png", "ACEScg");
    check_rule("room.glb", "Linear Rec.709");
    check_rule(NULL, "Linear Rec.709");
}

static void an_unknown_space_is_answered_with_the_known_ones(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    color_input *input = NULL;
    CHECK_EQUAL(color_transform_create(NULL, &transform, message), HEMI_OK);
    CHECK_EQUAL(color_input_create(transform, &(color_input_desc){ .space = "Kodak" }, &input, message),
                HEMI_ERROR_ARGUMENT);
    CHECK(input == NULL && strstr(message, "\"Kodak\"") && strstr(message, "ACEScg"));
    color_transform_destroy(transform);
}

/* ---- light that can be ------------------------------------------------------------------------------------------ */

static void colours_outside_the_primaries_lose_their_negative_bands_and_are_counted(void) {
    opened o = open_input(NULL, (color_input_desc){ .space = "Linear Rec.2020" });
    float rgb[] = { 0, 1, 0, 0.5f, 0.5f, 0.5f, 0, 0, 0 };
    size_t outside = 99;
    CHECK_EQUAL(color_input_apply(o.input, rgb, 3, &outside), HEMI_OK);
    CHECK_EQUAL(outside, 1);
    check_rgb(rgb, 0, 1.13290, 0);
    check_rgb(rgb + 3, 0.5, 0.5, 0.5);
    close_input(o);
}

/* To wide primaries and back leaves zeros a rounding below 0; that is no colour outside. */
static void rounding_is_not_counted(void) {
    opened o = open_input("ACEScg", (color_input_desc){ 0 });
    float rgb[3 * 64];
    size_t outside = 99;
    for (int i = 0; i < 64; i++)
        for (int c = 0; c < 3; c++) rgb[3 * i + c] = (float)(i >> (2 * c) & 3) / 3.0f;
    CHECK_EQUAL(color_input_apply(o.input, rgb, 64, &outside), HEMI_OK);
    CHECK_EQUAL(outside, 0);
    close_input(o);
}

static void what_is_not_finite_becomes_black_and_is_counted(void) {
    const char *const spaces[] = { NULL, "sRGB - Texture", "ACES2065-1", "Raw" };
    for (int s = 0; s < 4; s++) {
        opened o = open_input("ACEScg", (color_input_desc){ .space = spaces[s] });
        float rgb[] = { NAN, 0.5f, 0.5f, 0.5f, INFINITY, 0, 0.25f, 0.25f, 0.25f, -INFINITY, 0, 0, 3e38f, 3e38f, 3e38f };
        size_t outside = 0;
        CHECK_EQUAL(color_input_apply(o.input, rgb, 5, &outside), HEMI_OK);
        CHECK(outside >= 3);
        for (int i = 0; i < 15; i++) CHECK(isfinite(rgb[i]) && rgb[i] >= 0.0f);
        for (int i = 0; i < 6; i++) CHECK_EQUAL(rgb[i], 0);
        close_input(o);
    }
}

/* Radiance outside Rec.709 keeps its negative bands where floats may have them, and loses them in COLOR_0. */
static void negative_radiance_is_kept_as_radiance_and_clipped_as_colour(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    float green[3] = { 0, 0.5f, 0 }, color[3] = { 0, 0.5f, 0 };
    size_t clipped = 0;
    CHECK_EQUAL(color_transform_create(&(color_transform_desc){ .view = "Standard", .working_space = "ACEScg" },
                                       &transform, message),
                HEMI_OK);
    CHECK_EQUAL(color_transform_apply_rec709(transform, green, 1), HEMI_OK);
    check_rgb(green, -0.5 * 0.62179, 0.5 * 1.14080, -0.5 * 0.12897);
    CHECK_EQUAL(color_transform_apply(transform, color, 1, &clipped), HEMI_OK);
    CHECK_EQUAL(clipped, 1);
    check_rgb(color, 0, 0.5 * 1.14080, 0);
    color_transform_destroy(transform);
}

int main(void) {
    RUN(factors_are_linear_and_textures_are_srgb_by_gltfs_rule);
    RUN(primaries_are_converted);
    RUN(a_named_space_replaces_gltfs_rule);
    RUN(file_rules_choose_by_name);
    RUN(an_unknown_space_is_answered_with_the_known_ones);
    RUN(colours_outside_the_primaries_lose_their_negative_bands_and_are_counted);
    RUN(rounding_is_not_counted);
    RUN(what_is_not_finite_becomes_black_and_is_counted);
    RUN(negative_radiance_is_kept_as_radiance_and_clipped_as_colour);
    return check_end();
}
