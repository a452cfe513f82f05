/* SPDX-License-Identifier: MIT
 * hemibake compare BAKED REFERENCE.hprb|OTHER.glb
 */
#include "asset_input.h"
#include "commands.h"
#include "comparison.h"

int command_compare(const options *o) {
    gltf_asset *asset = NULL;
    console c = { 0 };
    console_start(&c, o);
    int status = asset_input_open(o->inputs[0], o, &c, &asset);
    if (status == EXIT_DONE) status = comparison_make(asset, o, &c);
    gltf_asset_destroy(asset);
    return status;
}
