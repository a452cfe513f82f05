/* SPDX-License-Identifier: MIT
 * Does hemi_picture draw what is there, and refuse what cannot be drawn?
 */
#include "check.h"

#include <hemibake/hemibake.h>

#include <stdlib.h>

enum { SIDE = 8 };

static const float SQUARE[12] = { -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0 };
static const float RED[12] = { 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0 };
static const uint32_t QUAD[6] = { 0, 1, 2, 0, 2, 3 };

static int errors;

static void listen(void *user, hemi_log_level level, const char *text) {
    (void)user, (void)text;
    errors += level == HEMI_LOG_ERROR;
}

static hemi_context *open_context(void) {
    hemi_context *context = NULL;
    const hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 1, .log = listen };
    CHECK_EQUAL(hemi_context_create(&desc, &context), HEMI_OK);
    return context;
}

/* Seen from +z, the square fills the picture. */
static hemi_picture_desc view_of(const hemi_picture_mesh *mesh) {
    return (hemi_picture_desc){ .struct_size = sizeof(hemi_picture_desc),
                                .meshes = mesh,
                                .mesh_count = 1,
                                .eye = { 0, 0, 1 },
                                .up = { 0, 1, 0 },
                                .vertical_fov = 1.0,
                                .width = SIDE,
                                .height = SIDE };
}

static void a_square_fills_the_picture(void) {
    const hemi_picture_mesh mesh = { SQUARE, RED, QUAD, 4, 2 };
    hemi_context *context = open_context();
    hemi_picture_desc desc = view_of(&mesh);
    float pixels[4 * SIDE * SIDE];
    CHECK_EQUAL(hemi_picture(context, &desc, pixels), HEMI_OK);
    for (int i = 0; i < 4 * SIDE * SIDE; i++) CHECK_NEAR(pixels[i], i % 4 == 0 || i % 4 == 3, 1e-6);
    desc.eye[2] = -1; /* its back is culled */
    CHECK_EQUAL(hemi_picture(context, &desc, pixels), HEMI_OK);
    for (int i = 0; i < 4 * SIDE * SIDE; i++) CHECK_NEAR(pixels[i], 0, 0);
    hemi_context_destroy(context);
}

/* Red grows to the right and green upwards; the first row of a picture is its top. */
static void pictures_stand_upright_and_colours_are_linear_between_corners(void) {
    static const float corners[12] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
    const hemi_picture_mesh mesh = { SQUARE, corners, QUAD, 4, 2 };
    hemi_context *context = open_context();
    const hemi_picture_desc desc = view_of(&mesh);
    float pixels[4 * SIDE * SIDE];
    CHECK_EQUAL(hemi_picture(context, &desc, pixels), HEMI_OK);
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            const float *pixel = pixels + 4 * (SIDE * row + column);
            double x = tan(0.5) * (2 * (column + 0.5) / SIDE - 1), y = tan(0.5) * (1 - 2 * (row + 0.5) / SIDE);
            /* Means of a pixel's parts, in floats. */
            CHECK_NEAR(pixel[0], 0.5 * (1 + x), 1e-6);
            CHECK_NEAR(pixel[1], 0.5 * (1 + y), 1e-6);
            CHECK_NEAR(pixel[2], 0, 0);
        }
    hemi_context_destroy(context);
}

/* A wall whose left part has a long edge on which vertices of the right part are, each a little to the right of it: a
 * file rounded them. gap: how far. The share of a picture that shows what is behind. */
static double share_behind(float gap) {
    enum { PARTS = 40, LARGE = 64 };
    float at[3 * (4 + 2 * (PARTS + 1))] = { -2, -2, 0, -0.4f, -2, 0, 0.4f, 2, 0, -2, 2, 0 };
    float white[3 * (4 + 2 * (PARTS + 1))], *pixels = malloc(4 * LARGE * LARGE * sizeof *pixels);
    uint32_t indices[6 + 6 * PARTS] = { 0, 1, 2, 0, 2, 3 };
    for (size_t i = 0; i < sizeof white / sizeof *white; i++) white[i] = 1.0f;
    for (int i = 0; i <= PARTS; i++) {
        float *right = at + 3 * (4 + 2 * i), up = -2 + 4 * (float)i / PARTS;
        right[0] = 0.2f * up + gap, right[1] = right[4] = up, right[3] = 2, right[2] = right[5] = 0;
    }
    for (uint32_t i = 0; i < PARTS; i++) {
        uint32_t v = 4 + 2 * i, *corner = indices + 6 + 6 * i;
        corner[0] = v, corner[1] = v + 1, corner[2] = v + 3, corner[3] = v, corner[4] = v + 3, corner[5] = v + 2;
    }
    const hemi_picture_mesh mesh = { at, white, indices, 4 + 2 * (PARTS + 1), 2 + 2 * PARTS };
    hemi_context *context = open_context();
    hemi_picture_desc desc = view_of(&mesh);
    double behind = 0.0;
    desc.width = desc.height = LARGE;
    CHECK_EQUAL(hemi_picture(context, &desc, pixels), HEMI_OK);
    for (int i = 0; i < LARGE * LARGE; i++) behind += 1.0 - (double)pixels[4 * i + 3];
    hemi_context_destroy(context);
    free(pixels);
    return behind / (LARGE * LARGE);
}

/* A sample is 2 tan(0.5) / (64 * 3) wide, and the wall 1 away: 0.0057. */
static void nothing_shows_through_a_crack_and_a_gap_stays_one(void) {
    CHECK_NEAR(share_behind(0.0f), 0.0, 0);
    CHECK_NEAR(share_behind(0.0005f), 0.0, 0);
    double gap = 0.02 / (2.0 * tan(0.5)); /* 3.5 samples wide */
    CHECK_NEAR(share_behind(0.02f), gap, 0.1 * gap);
}

static void what_cannot_be_drawn_is_refused_with_a_line(void) {
    const float astray[12] = { NAN, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0 };
    const uint32_t past[6] = { 0, 1, 2, 0, 2, 4 };
    const hemi_picture_mesh good = { SQUARE, RED, QUAD, 4, 2 };
    const hemi_picture_mesh bad[] = { { NULL, RED, QUAD, 4, 2 },
                                      { SQUARE, NULL, QUAD, 4, 2 },
                                      { SQUARE, RED, NULL, 4, 2 },
                                      { SQUARE, RED, past, 4, 2 },
                                      { astray, RED, QUAD, 4, 2 } };
    hemi_context *context = open_context();
    float pixels[4 * SIDE * SIDE];
    int expected = errors;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const hemi_picture_desc desc = view_of(&bad[i]);
        CHECK_EQUAL(hemi_picture(context, &desc, pixels), HEMI_ERROR_ARGUMENT);
        CHECK_EQUAL(errors, ++expected);
    }
    hemi_picture_desc views[6];
    for (int i = 0; i < 6; i++) views[i] = view_of(&good);
    views[0].eye[0] = INFINITY;
    views[1].up[2] = NAN;
    views[2].vertical_fov = 3.2;
    views[3].width = 0;
    views[4].height = 1 << 20;
    views[5].meshes = NULL;
    for (int i = 0; i < 6; i++) {
        CHECK_EQUAL(hemi_picture(context, &views[i], pixels), HEMI_ERROR_ARGUMENT);
        CHECK_EQUAL(errors, ++expected);
    }
    CHECK_EQUAL(hemi_picture(context, &views[5], NULL), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(hemi_picture(NULL, &views[5], pixels), HEMI_ERROR_ARGUMENT);
    hemi_context_destroy(context);
}

int main(void) {
    RUN(a_square_fills_the_picture);
    RUN(pictures_stand_upright_and_colours_are_linear_between_corners);
    RUN(nothing_shows_through_a_crack_and_a_gap_stays_one);
    RUN(what_cannot_be_drawn_is_refused_with_a_line);
    return check_end();
}
