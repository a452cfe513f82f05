/* SPDX-License-Identifier: MIT
 * Which unlit surfaces stand in the way of light, and what do they show? What shows its colour whatever falls on it
 * takes no light, but a floor that was baked before still is a floor. Only a backdrop does not: what lies around all
 * else, as a dome with a picture of the sky does, would shut out the sun that it shows.
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>

/* A backdrop is larger than what it is around by more than this share: the walls of a room touch what is in it. */
static const double around = 0.05;

struct world_box {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
};

static void extend(world_box &box, const gltf_instance &instance) {
    const std::vector<float> &positions = instance.geometry->positions;
    const double *m = instance.world;
    for (size_t v = 0; v + 2 < positions.size(); v += 3)
        for (size_t k = 0; k < 3; k++) {
            double x = m[12 + k];
            for (size_t c = 0; c < 3; c++) x += m[4 * c + k] * double(positions[v + c]);
            box.low[k] = std::min(box.low[k], x);
            box.high[k] = std::max(box.high[k], x);
        }
}

bool gltf_is_baked(const gltf_asset &asset) {
    const tinygltf::Value &extras = asset.model.asset.extras;
    return extras.IsObject() && extras.Has("hemibake");
}

bool gltf_is_unlit(const tinygltf::Material &material) {
    return gltf_find_named(material.extensions, "KHR_materials_unlit");
}

bool gltf_asset_mesh_is_unlit(const gltf_asset *asset, uint32_t mesh) {
    if (mesh >= asset->instances.size()) return false;
    uint32_t material = asset->instances[mesh].material;
    return material < asset->model.materials.size() && gltf_is_unlit(asset->model.materials[material]);
}

void gltf_find_backdrops(gltf_asset &asset) {
    world_box lit;
    asset.is_backdrop.assign(asset.instances.size(), 0);
    if (gltf_is_baked(asset)) return; /* what a bake has written stood in the way when it was made */
    for (uint32_t i = 0; i < asset.instances.size(); i++)
        if (!gltf_asset_mesh_is_unlit(&asset, i)) extend(lit, asset.instances[i]);
    for (uint32_t i = 0; i < asset.instances.size(); i++) {
        if (!gltf_asset_mesh_is_unlit(&asset, i)) continue;
        world_box own;
        bool is_around = true;
        extend(own, asset.instances[i]);
        for (size_t k = 0; k < 3; k++) {
            double gap = around * (lit.high[k] - lit.low[k]);
            /* a dome may stand on the ground that it is around, a roof over it is none */
            bool stands = k == 1 && own.low[k] < lit.high[k] + around * (own.high[k] - own.low[k]);
            bool below = own.low[k] < lit.low[k] - gap || (stands && own.high[k] > lit.high[k] + 10 * gap);
            is_around = is_around && below && own.high[k] > lit.high[k] + gap;
        }
        asset.is_backdrop[i] = is_around;
        if (is_around)
            gltf_note(asset, gltf_text("node %d", asset.instances[i].node),
                      "an unlit backdrop around all else, which stands in no light's way");
    }
}

bool gltf_asset_mesh_blocks(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() && !(mesh < asset->is_backdrop.size() && asset->is_backdrop[mesh]);
}

void gltf_asset_mesh_factor(const gltf_asset *asset, uint32_t mesh, double factor[3]) {
    for (size_t c = 0; c < 3; c++)
        factor[c] =
            mesh < asset->instances.size()
                ? std::clamp(gltf_base_factor(gltf_find_material(*asset, asset->instances[mesh].material), c), 0.0, 1.0)
                : 1;
}

std::string gltf_unlit_note(const gltf_asset &asset, uint32_t material) {
    size_t all = 0, blocking = 0;
    for (uint32_t i = 0; i < asset.instances.size(); i++) {
        gltf_mesh_steering steering;
        if (asset.instances[i].material != material || !gltf_asset_mesh_steering(&asset, i, &steering)) continue;
        all++;
        blocking += gltf_asset_mesh_blocks(&asset, i) && !steering.is_left_out;
    }
    std::string text =
        gltf_is_baked(asset) ? "not baked again, it is already baked: it stays" : "not baked, unlit: it stays";
    return text + (blocking == 0    ? ", and stands in no light's way"
                   : blocking < all ? gltf_text(", and stands in the way of light on %zu of %zu meshes", blocking, all)
                                    : ", and stands in the way of light");
}
