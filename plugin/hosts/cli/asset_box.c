/* SPDX-License-Identifier: MIT */
#include "asset_box.h"

#include <hemibake/mesh_transform.h>

#include <math.h>

double asset_box(const gltf_asset *asset, double middle[3]) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, square = 0.0;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        gltf_asset_mesh(asset, i, &mesh);
        if (!gltf_asset_mesh_blocks(asset, i)) continue;
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            double x[3];
            hemi_transform_point(mesh.transform, mesh.positions + 3 * (size_t)v, x);
            for (int k = 0; k < 3; k++) low[k] = fmin(low[k], x[k]), high[k] = fmax(high[k], x[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        square += (high[k] - low[k]) * (high[k] - low[k]);
        middle[k] = high[k] >= low[k] ? 0.5 * (low[k] + high[k]) : 0.0;
    }
    return isfinite(square) && high[0] >= low[0] ? sqrt(square) : 0.0;
}
