/* SPDX-License-Identifier: MIT
 * How does a glTF material reflect and emit as a Lambert surface, and what is left of it once its light is baked?
 */
#include "gltf_model.h"

#include <algorithm>

static const tinygltf::Material default_material;

static double number_of(const tinygltf::Material &material, const char *extension, const char *member,
                        double fallback) {
    auto found = material.extensions.find(extension);
    if (found == material.extensions.end() || !found->second.Has(member)) return fallback;
    const tinygltf::Value &value = found->second.Get(member);
    return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

/* Component c of the diffuseFactor of the old specular-glossiness model. */
static double diffuse_factor(const tinygltf::Value &extension, size_t c) {
    if (!extension.Has("diffuseFactor")) return 1;
    const tinygltf::Value &factor = extension.Get("diffuseFactor");
    if (!factor.IsArray() || factor.ArrayLen() <= c || !factor.Get(int(c)).IsNumber()) return 1;
    return factor.Get(int(c)).GetNumberAsDouble();
}

static double reflectance_of(const tinygltf::Material &material, size_t c) {
    auto glossy = material.extensions.find("KHR_materials_pbrSpecularGlossiness");
    if (glossy != material.extensions.end()) return diffuse_factor(glossy->second, c);
    const tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    return pbr.baseColorFactor[c] * (1 - std::clamp(pbr.metallicFactor, 0.0, 1.0));
}

uint32_t gltf_asset_material_count(const gltf_asset *asset) {
    return uint32_t(asset->model.materials.size()) + 1;
}

bool gltf_asset_material(const gltf_asset *asset, uint32_t index, hemi_material_desc *out) {
    if (index > asset->model.materials.size()) return false;
    const bool named = index < asset->model.materials.size();
    const tinygltf::Material &material = named ? asset->model.materials[index] : default_material;
    double strength = number_of(material, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    *out = hemi_material_desc{};
    out->struct_size = sizeof *out;
    out->name = named ? material.name.c_str() : "default material";
    for (size_t c = 0; c < 3; c++) {
        double emission = material.emissiveFactor.size() == 3 ? material.emissiveFactor[c] * strength : 0;
        out->reflectance[c] = std::clamp(reflectance_of(material, c), 0.0, 1.0);
        out->emission[c] = std::max(emission, 0.0);
    }
    out->double_sided = material.doubleSided;
    return true;
}

bool gltf_asset_material_weights(const gltf_asset *asset, uint32_t index, double *reflectance, double *emission) {
    if (index > asset->model.materials.size()) return false;
    const bool named = index < asset->model.materials.size();
    const tinygltf::Material &material = named ? asset->model.materials[index] : default_material;
    const bool glossy = material.extensions.count("KHR_materials_pbrSpecularGlossiness") > 0;
    *reflectance = glossy ? 1 : 1 - std::clamp(material.pbrMetallicRoughness.metallicFactor, 0.0, 1.0);
    *emission = number_of(material, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    return true;
}

/* ---- the copy that shows baked light ---------------------------------------------------------------------------- */

/* KHR_materials_unlit next to any other shading extension is undefined; the texture of the specular-glossiness model
 * is the base colour of the copy. */
static void strip_shading(tinygltf::Material &material) {
    for (auto it = material.extensions.begin(); it != material.extensions.end();)
        it = it->first.compare(0, 14, "KHR_materials_") == 0 ? material.extensions.erase(it) : std::next(it);
}

double gltf_material_alpha(const tinygltf::Material &source) {
    auto glossy = source.extensions.find("KHR_materials_pbrSpecularGlossiness");
    return glossy != source.extensions.end() ? diffuse_factor(glossy->second, 3)
                                             : source.pbrMetallicRoughness.baseColorFactor[3];
}

tinygltf::TextureInfo gltf_diffuse_texture(const tinygltf::Material &source) {
    auto glossy = source.extensions.find("KHR_materials_pbrSpecularGlossiness");
    if (glossy == source.extensions.end()) return source.pbrMetallicRoughness.baseColorTexture;
    tinygltf::TextureInfo info;
    if (!glossy->second.Has("diffuseTexture")) return info;
    const tinygltf::Value &texture = glossy->second.Get("diffuseTexture");
    if (texture.Has("index") && texture.Get("index").IsInt()) info.index = texture.Get("index").Get<int>();
    if (texture.Has("extensions") && texture.Get("extensions").Has("KHR_texture_transform"))
        info.extensions["KHR_texture_transform"] = texture.Get("extensions").Get("KHR_texture_transform");
    if (texture.Has("texCoord") && texture.Get("texCoord").IsInt()) info.texCoord = texture.Get("texCoord").Get<int>();
    return info;
}

tinygltf::Material gltf_unlit_copy(const tinygltf::Material &source, bool textured) {
    tinygltf::Material copy;
    copy.name = source.name;
    copy.extensions = source.extensions;
    strip_shading(copy);
    copy.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object{});
    copy.emissiveFactor = { 0, 0, 0 };
    const tinygltf::TextureInfo texture = gltf_diffuse_texture(source);
    if (textured) copy.pbrMetallicRoughness.baseColorTexture = texture;
    if (textured || texture.index < 0) { /* a cut-out without its texture would vanish or stay whole */
        copy.alphaMode = source.alphaMode;
        copy.alphaCutoff = source.alphaCutoff;
    }
    copy.pbrMetallicRoughness.baseColorFactor = { 1, 1, 1, gltf_material_alpha(source) };
    copy.pbrMetallicRoughness.metallicFactor = 0;
    copy.pbrMetallicRoughness.roughnessFactor = 0.9;
    return copy;
}
