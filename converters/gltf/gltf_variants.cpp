/* SPDX-License-Identifier: MIT
 * What do colours hold where a primitive has several variants (KHR_materials_variants), or its material levels of
 * detail (MSFT_lod)? Light without the reflectance of any, which is the factor of each variant's unlit material: so the
 * variants differ after a bake as they did before it, in the light of the one that was baked. What glows in the variant
 * that is baked has all of it in its colours, for every variant.
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>

static const char extension[] = "KHR_materials_variants";

/* Emission is divided by a reflectance no further than this. */
static const double reflectance_least = 1.0 / 16;

std::vector<int> gltf_material_levels(const gltf_asset &asset, int material) {
    std::vector<int> levels;
    if (material < 0 || size_t(material) >= asset.model.materials.size()) return levels;
    const tinygltf::ExtensionMap &extensions = asset.model.materials[size_t(material)].extensions;
    auto found = extensions.find("MSFT_lod");
    if (found == extensions.end() || !found->second.Has("ids")) return levels;
    const tinygltf::Value &ids = found->second.Get("ids");
    for (size_t i = 0; ids.IsArray() && i < ids.ArrayLen(); i++) {
        const std::string place = gltf_text("materials[%d].extensions.MSFT_lod.ids[%zu]", material, i);
        if (!ids.Get(int(i)).IsInt()) gltf_fail(HEMI_ERROR_DATA, "%s is no index", place.c_str());
        gltf_check_index(ids.Get(int(i)).Get<int>(), asset.model.materials.size(), "materials", place);
        levels.push_back(ids.Get(int(i)).Get<int>());
    }
    return levels;
}

bool gltf_has_variants(const gltf_asset &asset, const gltf_instance &instance) {
    const tinygltf::Primitive &primitive =
        asset.model.meshes[size_t(instance.mesh)].primitives[size_t(instance.primitive)];
    const tinygltf::Material &material = gltf_find_material(asset, instance.material);
    for (size_t c = 0; c < 3; c++)
        if (gltf_material_emission(material, c) > 0) return false;
    if (!gltf_material_levels(asset, int(instance.material)).empty()) return true;
    auto found = primitive.extensions.find(extension);
    if (found == primitive.extensions.end() || !found->second.Has("mappings")) return false;
    return found->second.Get("mappings").IsArray() && found->second.Get("mappings").ArrayLen() > 0;
}

/* The reflectance that a material's unlit copy has as its factor; a texture that stays multiplies it. */
void gltf_variant_factor(const gltf_asset &asset, uint32_t material, double factor[3]) {
    hemi_material_desc desc = {};
    gltf_asset_material(&asset, std::min(material, uint32_t(asset.model.materials.size())), &desc);
    std::copy(desc.reflectance, desc.reflectance + 3, factor);
}

static void shade(void *user, const double *attributes, uint32_t corners, hemi_texture_mean *out) {
    const gltf_variant &variant = *static_cast<const gltf_variant *>(user);
    if (variant.texture) variant.texture(variant.user, attributes, corners, out);
    for (int c = 0; c < 3; c++) {
        double factor = variant.factor[c];
        out->demodulated_reflectance[c] = factor > 0 ? out->demodulated_reflectance[c] / factor : 1;
        out->demodulated_emission[c] /= std::max(factor, reflectance_least);
    }
}

void gltf_prepare_variants(gltf_asset &asset, hemi_texture_fn texture) {
    asset.variants.clear();
    for (size_t i = 0; i < asset.instances.size(); i++) {
        asset.variants.push_back(nullptr);
        if (!gltf_has_variants(asset, asset.instances[i])) continue;
        asset.variants[i] = std::make_unique<gltf_variant>();
        asset.variants[i]->user = asset.shadings->of_mesh[i];
        asset.variants[i]->texture = asset.variants[i]->user ? texture : nullptr;
        gltf_variant_factor(asset, asset.instances[i].material, asset.variants[i]->factor);
    }
}

bool gltf_show_variants(const gltf_asset &asset, uint32_t mesh, hemi_mesh_desc &out) {
    if (mesh >= asset.variants.size() || !asset.variants[mesh]) return false;
    out.texture = shade;
    out.texture_user = asset.variants[mesh].get();
    return true;
}
