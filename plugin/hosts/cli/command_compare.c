/* SPDX-License-Identifier: MIT
 * hemibake compare BAKED REFERENCE.hprb|OTHER.glb
 */
#include "commands.h"
#include "comparison.h"

int command_compare(const options *o) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset;
    console c = { 0 };
    console_start(&c, o);
    const gltf_limits limits = { .root = o->root, .scene = o->scene };
    if (gltf_asset_read_within(o->inputs[0], &limits, &asset, message) != HEMI_OK) {
        console_error(&c, "%s", message);
        return EXIT_BAD_INPUT;
    }
    int status = comparison_make(asset, o, &c);
    gltf_asset_destroy(asset);
    return status;
}
