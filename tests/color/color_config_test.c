/* SPDX-License-Identifier: MIT
 * Does a wrong name or file get a clear answer, and does a configuration of somebody else mean what it says? */
#include "color_config.h"
#include "color_input.h"

/* ---- names ------------------------------------------------------------------------------------------------------ */

static void the_defaults_are_named(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    CHECK_EQUAL(color_transform_create(NULL, &transform, message), HEMI_OK);
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_CONFIG), "hemibake");
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_DISPLAY), "sRGB");
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_VIEW), "Soft");
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_LOOK), "");
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_WORKING_SPACE), "Linear Rec.709");
    color_transform_destroy(transform);
    CHECK_EQUAL(color_transform_create(&(color_transform_desc){ .view = "aces 1.X sdr" }, &transform, message),
                HEMI_OK);
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_VIEW), "ACES 1.x SDR");
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
    CHECK_EQUAL(create(&(color_transform_desc){ .view = "Kodachrome" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"Kodachrome\"") && strstr(message, "Soft, Standard, ACES 1.x SDR, Filmic, Raw"));
    CHECK_EQUAL(create(&(color_transform_desc){ .display = "Rec.2020" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"Rec.2020\"") && strstr(message, "sRGB, Display P3"));
    CHECK_EQUAL(create(&(color_transform_desc){ .look = "moody" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"moody\"") && strstr(message, "there are: none"));
    CHECK_EQUAL(create(&(color_transform_desc){ .look = "" }, message), HEMI_OK);
    CHECK_EQUAL(create(&(color_transform_desc){ .view = "" }, message), HEMI_ERROR_ARGUMENT);
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

static void check_refusal(const char *text, hemi_result result, const char *word, const char *other_word) {
    char message[COLOR_MESSAGE_SIZE] = "";
    color_transform *transform = NULL;
    CHECK_EQUAL(create_from(text, (color_transform_desc){ 0 }, &transform, message), result);
    CHECK(transform == NULL);
    if (!strstr(message, word) || !strstr(message, other_word)) fprintf(stderr, "the message is: %s\n", message);
    CHECK(strstr(message, word) && strstr(message, other_word));
}

static void a_newer_configuration_is_refused_with_its_version(void) {
    check_refusal("ocio_profile_version: 2.99\nname: later\n", HEMI_ERROR_UNSUPPORTED, "version 2.99",
                  "newer OpenColorIO");
}

/* Only the sRGB display's transform differs. */
static const char plain_config[] = "ocio_profile_version: 2\n"
                                   "search_path: luts\n"
                                   "roles: {scene_linear: %s, default: %s}\n"
                                   "file_rules: [!<Rule> {name: Default, colorspace: default}]\n"
                                   "displays: {sRGB: [!<View> {name: Plain, colorspace: sRGB}]}\n"
                                   "colorspaces:\n"
                                   "  - !<ColorSpace> {name: %s}\n"
                                   "  - !<ColorSpace> {name: sRGB, from_scene_reference: !<%s }\n";

static const char *plain_config_with(const char *linear, const char *transform) {
    static char text[1024];
    snprintf(text, sizeof text, plain_config, linear, linear, linear, transform);
    return text;
}

static void a_transform_of_a_newer_library_is_named(void) {
    const char *text = plain_config_with("lin_rec709", "BuiltinTransform> {style: DISPLAY - NEXT_YEARS}");
    check_refusal(text, HEMI_ERROR_UNSUPPORTED, "DISPLAY - NEXT_YEARS", "newer OpenColorIO");
}

static void a_missing_table_is_named(void) {
    const char *text = plain_config_with("lin_rec709", "FileTransform> {src: lost_table.cube}");
    check_refusal(text, HEMI_ERROR_FILE, "lost_table.cube", "missing");
}

static void only_linear_spaces_are_worked_in(void) {
    char message[COLOR_MESSAGE_SIZE];
    CHECK_EQUAL(create(&(color_transform_desc){ .working_space = "ACEScg" }, message), HEMI_OK);
    CHECK_EQUAL(create(&(color_transform_desc){ .working_space = "lin_rec2020" }, message), HEMI_OK);
    CHECK_EQUAL(create(&(color_transform_desc){ .working_space = "sRGB - Texture" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "sRGB - Texture") && strstr(message, "not linear"));
    CHECK_EQUAL(create(&(color_transform_desc){ .working_space = "Raw" }, message), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(create(&(color_transform_desc){ .working_space = "Kodak" }, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "\"Kodak\"") && strstr(message, "Linear Rec.709, ACEScg"));
}

/* A configuration that does not say where Rec.709 is takes no Rec.709 colours; colours of its own it takes. */
static void primaries_that_are_not_known_are_not_assumed(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    color_input *input = NULL;
    float rgb[3] = { 0.5f, 0.25f, 0.125f };
    const char *text =
        plain_config_with("camera", "ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}");
    CHECK_EQUAL(create_from(text, (color_transform_desc){ 0 }, &transform, message), HEMI_OK);
    if (!transform) return;
    CHECK_EQUAL(color_input_create(transform, &(color_input_desc){ 0 }, &input, message), HEMI_ERROR_DATA);
    CHECK(input == NULL && strstr(message, "--input-space"));
    CHECK_EQUAL(color_transform_apply_rec709(transform, rgb, 1), HEMI_ERROR_UNSUPPORTED);
    CHECK_EQUAL(color_input_create(transform, &(color_input_desc){ .space = "camera" }, &input, message), HEMI_OK);
    CHECK_EQUAL(color_input_apply(input, rgb, 1, NULL), HEMI_OK);
    CHECK_EQUAL(color_transform_apply(transform, rgb, 1, NULL), HEMI_OK);
    CHECK_NEAR(rgb[2], 0.125, 1e-5);
    color_input_destroy(input);
    color_transform_destroy(transform);
}

static void a_missing_configuration_is_named(void) {
    char message[COLOR_MESSAGE_SIZE];
    CHECK_EQUAL(create(&(color_transform_desc){ .config = "no/such.ocio" }, message), HEMI_ERROR_FILE);
    CHECK(strstr(message, "no/such.ocio"));
    CHECK(create(&(color_transform_desc){ .config = "/" }, message) != HEMI_OK);
}

static void the_configuration_inside_is_the_file_in_the_tree(void) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL, *inside = NULL;
    color_transform_desc desc = { .view = "ACES 1.x SDR" };
    float a[3] = { 0.7f, 0.2f, 0.05f }, b[3] = { 0.7f, 0.2f, 0.05f };
    CHECK_EQUAL(color_transform_create(&desc, &inside, message), HEMI_OK);
    desc.config = "color/hemibake.ocio";
    CHECK_EQUAL(color_transform_create(&desc, &transform, message), HEMI_OK);
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_CONFIG), "color/hemibake.ocio");
    color_transform_apply(transform, a, 1, NULL);
    color_transform_apply(inside, b, 1, NULL);
    CHECK(memcmp(a, b, sizeof a) == 0);
    color_transform_destroy(transform);
    color_transform_destroy(inside);
}

/* A Rec.709 colour of an asset, all the way through. */
static void check_color(const color_transform_desc *desc, double scale, const char *look) {
    char message[COLOR_MESSAGE_SIZE];
    color_transform *transform = NULL;
    color_input *input = NULL;
    float rgb[3] = { 0.4f, 0.1f, 0.05f };
    CHECK_EQUAL(create_from(aces_config, *desc, &transform, message), HEMI_OK);
    if (!transform) return;
    CHECK_EQUAL(color_input_create(transform, &(color_input_desc){ 0 }, &input, message), HEMI_OK);
    CHECK_EQUAL(color_input_apply(input, rgb, 1, NULL), HEMI_OK);
    CHECK_EQUAL(color_transform_apply(transform, rgb, 1, NULL), HEMI_OK);
    color_input_destroy(input);
    CHECK_NEAR(rgb[0], 0.4 * scale, 1e-5);
    CHECK_NEAR(rgb[1], 0.1 * scale, 1e-5);
    CHECK_NEAR(rgb[2], 0.05 * scale, 1e-5);
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_LOOK), look);
    CHECK_TEXT(color_transform_name(transform, COLOR_PART_WORKING_SPACE), "ACEScg");
    color_transform_destroy(transform);
}

/* Whatever primaries the configuration solves in: a red of the asset is that red on the display. */
static void rec709_goes_through_a_configuration_that_solves_in_acescg(void) {
    check_color(&(color_transform_desc){ .view = "Plain" }, 1.0, "");
}

static void looks_are_the_views_own_unless_given(void) {
    check_color(&(color_transform_desc){ .view = "Halved" }, 0.5, "half");
    check_color(&(color_transform_desc){ .view = "Halved", .look = "" }, 1.0, "");
    check_color(&(color_transform_desc){ .view = "Halved", .look = "double" }, 2.0, "double");
    check_color(&(color_transform_desc){ .view = "Plain", .look = "-double" }, 0.5, "-double");
    check_color(&(color_transform_desc){ .view = "Plain", .look = "half, double" }, 1.0, "half, double");
}

int main(void) {
    RUN(the_defaults_are_named);
    RUN(unknown_names_are_answered_with_the_known_ones);
    RUN(broken_configurations_are_refused);
    RUN(a_missing_configuration_is_named);
    RUN(the_configuration_inside_is_the_file_in_the_tree);
    RUN(a_newer_configuration_is_refused_with_its_version);
    RUN(a_transform_of_a_newer_library_is_named);
    RUN(a_missing_table_is_named);
    RUN(only_linear_spaces_are_worked_in);
    RUN(primaries_that_are_not_known_are_not_assumed);
    RUN(rec709_goes_through_a_configuration_that_solves_in_acescg);
    RUN(looks_are_the_views_own_unless_given);
    return check_end();
}
