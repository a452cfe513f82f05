/* SPDX-License-Identifier: MIT
 * hemibake bake IN -o OUT --scene all: one scene after the other, each in the file that the one before has made.
 */
#include "commands.h"
#include "gltf_asset.h"
#include "signals.h"
#include "usd_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* 0: it cannot be read, which the bake itself says. */
static uint32_t count_scenes(const options *o) {
    char message[GLTF_MESSAGE_SIZE];
    const gltf_limits limits = { .root = o->root, .image_pixels = o->max_pixels };
    gltf_asset *asset;
    if (usd_is_input(o->inputs[0]) || gltf_asset_read_within(o->inputs[0], &limits, &asset, message) != HEMI_OK)
        return 0;
    uint32_t count = gltf_asset_scene_count(asset);
    gltf_asset_destroy(asset);
    return count;
}

/* What comes of a scene before the last is a file of no one's. */
static void keep_quiet(options *o, const char *output) {
    o->output = output;
    o->report = o->preview = o->reference = o->depfile = o->layer = NULL;
    o->quiet = true;
}

int command_bake_scenes(const options *asked) {
    char folder[256], between[2][300], number[16];
    const char *place = getenv("TMPDIR");
    uint32_t count = count_scenes(asked);
    int status = EXIT_DONE, worst = EXIT_DONE;
    options one = *asked;
    one.scene = NULL;
    if (count < 2) return command_bake(&one);
    snprintf(folder, sizeof folder, "%.200s/hemibake-scenes-XXXXXX", place && *place ? place : "/tmp");
    if (!mkdtemp(folder)) {
        fprintf(stderr, "hemibake: %s: cannot be made, for what comes between scenes\n", folder);
        return EXIT_OUTPUT;
    }
    for (int i = 0; i < 2; i++) snprintf(between[i], sizeof between[i], "%s/%d.glb", folder, i);
    for (uint32_t s = 0; s < count && (status == EXIT_DONE || status == EXIT_NOT_CONVERGED); s++) {
        one = *asked;
        snprintf(number, sizeof number, "%u", s);
        one.scene = number;
        one.continues = s > 0 ? between[(s + 1) % 2] : asked->inputs[0];
        if (s + 1 < count) keep_quiet(&one, between[s % 2]);
        status = signals_interrupted ? EXIT_INTERRUPTED : command_bake(&one);
        if (status > worst) worst = status;
    }
    for (int i = 0; i < 2; i++) unlink(between[i]);
    rmdir(folder);
    return status == EXIT_DONE ? worst : status;
}
