/* SPDX-License-Identifier: MIT
 * hemibake render BAKED -o PNG
 */
#include "asset_box.h"
#include "asset_input.h"
#include "commands.h"
#include "output_file.h"
#include "path_text.h"
#include "preview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int draw(const options *o, console *c, const gltf_asset *asset, unsigned char **bytes, size_t *size) {
    hemi_context *context = NULL;
    int status = console_context(c, 1, &context);
    if (status == EXIT_DONE) status = preview_draw_asset(context, asset, o, c, bytes, size);
    hemi_context_destroy(context);
    return status;
}

/* What no bake has written shows the colours of its materials, without light. Colours of vertices may be paint, and a
 * surface without light a backdrop of what is to be baked: a bake leaves both, or linear radiance. */
static bool is_baked(const gltf_asset *asset) {
    uint32_t unlit = 0, count = gltf_asset_mesh_count(asset);
    for (uint32_t i = 0; i < count; i++) {
        bool is_unlit = gltf_asset_mesh_is_unlit(asset, i);
        if (gltf_asset_mesh_radiosity(asset, i) || (is_unlit && gltf_asset_mesh_color(asset, i))) return true;
        unlit += is_unlit;
    }
    return unlit == count;
}

static int render(const options *o, console *c, const gltf_asset *asset) {
    const char *reason = "", *path = o->output;
    unsigned char *bytes = NULL;
    size_t size = 0;
    output_file file = OUTPUT_FILE_NONE;
    output_file *const files[] = { &file };
    int status = preview_check_camera(asset, o, c);
    if (status == EXIT_DONE && !output_file_open(&file, o->output, &reason)) status = EXIT_OUTPUT;
    if (status == EXIT_DONE && !is_baked(asset))
        status = console_error(c, "it has no light in its vertices: bake it first, and render what that writes");
    if (status == EXIT_DONE) status = draw(o, c, asset, &bytes, &size);
    if (status == EXIT_DONE &&
        !(output_file_write(&file, bytes, size, &reason) && output_files_commit(files, 1, &path, &reason)))
        status = EXIT_OUTPUT;
    if (status == EXIT_OUTPUT) console_unwritten(c, path, reason);
    output_file_discard(&file);
    free(bytes);
    return status;
}

/* OUT-2.png of OUT.png */
static char *numbered(const char *path, uint32_t number) {
    const char *dot = strrchr(path_name(path), '.');
    size_t stem = dot ? (size_t)(dot - path) : strlen(path);
    return path_format("%.*s-%u%s", (int)stem, path, number, path + stem);
}

static int render_all(const options *o, console *c, const gltf_asset *asset) {
    const uint32_t count = gltf_asset_camera_count(asset);
    int status = EXIT_DONE;
    if (count == 0) return console_error(c, "--all-cameras: it has no camera");
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++) {
        char number[16], *path = numbered(o->output, i);
        snprintf(number, sizeof number, "%u", i);
        options one = *o;
        one.camera = number;
        one.output = path;
        status = path ? render(&one, c, asset) : EXIT_BAD_INPUT;
        free(path);
    }
    return status;
}

/* Of a turntable: how far up it looks from, and how much wider than the asset its view is. */
static const double TURN_ELEVATION = 20.0, TURN_ROOM = 1.1, PI = 3.14159265358979323846;

/* The field of view of a picture without a camera, hemi_picture_desc.vertical_fov. */
static const double FOV_DEGREES = 40.0;

/* Where the first picture is taken from, seen from the middle. */
static void first_view(const options *o, const gltf_asset *asset, double middle[3], double arm[3]) {
    double narrow = fmin((double)o->size[0] / o->size[1], 1.0);
    double distance = TURN_ROOM * 0.5 * asset_box(asset, middle) / sin(0.5 * FOV_DEGREES * PI / 180.0) / narrow;
    arm[0] = 0.0;
    arm[1] = distance * sin(TURN_ELEVATION * PI / 180.0);
    arm[2] = distance * cos(TURN_ELEVATION * PI / 180.0);
    if (o->look_at.is_given) memcpy(middle, o->look_at.values, sizeof o->look_at.values);
    for (int k = 0; o->look_from.is_given && k < 3; k++) arm[k] = o->look_from.values[k] - middle[k];
}

static int render_turntable(const options *o, console *c, const gltf_asset *asset) {
    double middle[3], arm[3];
    int status = preview_check_camera(asset, o, c);
    first_view(o, asset, middle, arm);
    for (uint32_t i = 0; status == EXIT_DONE && i < o->turntable; i++) {
        double angle = 2.0 * PI * i / o->turntable, turned[3] = { arm[0] * cos(angle) + arm[2] * sin(angle), arm[1],
                                                                  arm[2] * cos(angle) - arm[0] * sin(angle) };
        char *path = numbered(o->output, i);
        options one = *o;
        one.output = path;
        one.look_from.is_given = one.look_at.is_given = true;
        memcpy(one.look_at.values, middle, sizeof middle);
        for (int k = 0; k < 3; k++) one.look_from.values[k] = middle[k] + turned[k];
        status = path ? render(&one, c, asset) : EXIT_BAD_INPUT;
        free(path);
    }
    return status;
}

int command_render(const options *o) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    console c = { 0 };
    console_start(&c, o);
    int status = asset_input_open(o->inputs[0], o, &c, &asset);
    if (status == EXIT_DONE && gltf_asset_read_shown(asset, message) != HEMI_OK)
        status = console_error(&c, "%s", message);
    if (status == EXIT_DONE)
        status = (o->turntable ? render_turntable : o->all_cameras ? render_all : render)(o, &c, asset);
    gltf_asset_destroy(asset);
    return status;
}
