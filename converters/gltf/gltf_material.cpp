/* SPDX-License-Identifier: MIT
 * How does a glTF material reflect and emit as a Lambert surface, and what is left of it once its light is baked?
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>

/* What reflects no more than this of any band is as good as black beside its own light. */
static const double hardly_reflects = 0.05;

static const tinygltf::Material default_material;

/* Closer to its default than this, a factor is left out. */
static const double factor_tolerance = 1e-12;

static const char glossiness[] = "KHR_materials_pbrSpecularGlossiness"; /* the older shading model */

double gltf_extension_number(const tinygltf::ExtensionMap &extensions, const char *extension, const char *member,
                             int index, double fallback) {
    const tinygltf::Value *holder = gltf_find_named(extensions, extension);
    if (!holder || !holder->IsObject()) return fallback;
    const tinygltf::Value *named = gltf_find_named(holder->Get<tinygltf::Value::Object>(), member);
    if (!named) return fallback;
    const tinygltf::Value &found = *named;
    if (index < 0) return found.IsNumber() ? found.GetNumberAsDouble() : fallback;
    if (!found.IsArray() || int(found.ArrayLen()) <= index || !found.Get(index).IsNumber()) return fallback;
    return found.Get(index).GetNumberAsDouble();
}

const tinygltf::Material &gltf_find_material(const gltf_asset &asset, uint32_t index) {
    return index < asset.model.materials.size() ? asset.model.materials[index] : default_material;
}

static double emissive_strength(const tinygltf::Material &material) {
    return gltf_extension_number(material.extensions, "KHR_materials_emissive_strength", "emissiveStrength", -1, 1);
}

double gltf_material_emission(const tinygltf::Material &material, size_t c) {
    double emission[3] = { 0, 0, 0 };
    for (size_t k = 0; k < 3 && material.emissiveFactor.size() == 3; k++)
        emission[k] = std::max(material.emissiveFactor[k] * emissive_strength(material), 0.0);
    gltf_steer_emission(material, emission);
    return emission[c];
}

static double reflected_share(const gltf_asset &asset, uint32_t index) {
    const tinygltf::Material &material = gltf_find_material(asset, index);
    const tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    if (gltf_find_named(material.extensions, glossiness) || (asset.shadings && asset.shadings->unread.count(index)))
        return 1;
    const double m = std::clamp(pbr.metallicFactor, 0.0, 1.0), r = std::clamp(pbr.roughnessFactor, 0.0, 1.0);
    return 1 - m + gltf_metal_share(asset) * m * r * r;
}

double gltf_metal_share(const gltf_asset &asset) {
    return asset.metals == GLTF_METALS_BLACK ? 0 : 0.5;
}

void gltf_asset_show_emission(gltf_asset *asset) {
    asset->shows_emission = true;
}

void gltf_asset_scale_emission(gltf_asset *asset, double scale) {
    asset->emission_scale = scale;
}

void gltf_asset_set_metals(gltf_asset *asset, gltf_metals metals) {
    asset->metals = metals;
}

void gltf_asset_clear_lamps(gltf_asset *asset) {
    asset->lamps_are_clear = true;
}

double gltf_base_factor(const tinygltf::Material &material, size_t c) {
    return gltf_find_named(material.extensions, glossiness)
               ? gltf_extension_number(material.extensions, glossiness, "diffuseFactor", int(c), 1)
               : material.pbrMetallicRoughness.baseColorFactor[c];
}

uint32_t gltf_asset_material_count(const gltf_asset *asset) {
    return uint32_t(asset->model.materials.size()) + 1;
}

bool gltf_asset_material(const gltf_asset *asset, uint32_t index, hemi_material_desc *out) {
    if (index > asset->model.materials.size()) return false;
    const tinygltf::Material &material = gltf_find_material(*asset, index);
    *out = hemi_material_desc{};
    out->struct_size = sizeof *out;
    out->name = &material == &default_material ? "default material" : material.name.c_str();
    for (size_t c = 0; c < 3; c++) {
        if (gltf_is_unlit(material)) continue; /* neither takes nor gives light */
        out->reflectance[c] = std::clamp(gltf_base_factor(material, c) * reflected_share(*asset, index), 0.0, 1.0);
        out->emission[c] = asset->emission_scale * gltf_material_emission(material, c);
    }
    out->double_sided = material.doubleSided;
    if (asset->lamps_are_clear && asset->is_of_lamps[index])
        for (size_t c = 0; c < 3; c++) out->reflectance[c] = 0, out->transmission[c] = 1;
    if (!asset->shadings || !asset->shadings->passed.count(index)) return true;
    const gltf_passed &passed = asset->shadings->passed.at(index);
    for (size_t c = 0; c < 3; c++) {
        out->transmission[c] = passed.straight;
        out->diffuse_transmission[c] = passed.diffuse[c];
        out->double_sided = out->double_sided || passed.diffuse[c] > 0;
    }
    return true;
}

bool gltf_asset_material_weights(const gltf_asset *asset, uint32_t index, double *reflectance, double *emission) {
    if (index > asset->model.materials.size()) return false;
    const tinygltf::Material &material = gltf_find_material(*asset, index);
    *reflectance = reflected_share(*asset, index);
    *emission = asset->emission_scale * emissive_strength(material);
    return true;
}

double gltf_asset_mesh_opacity(const gltf_asset *asset, uint32_t mesh) {
    if (mesh >= asset->instances.size()) return 1;
    const uint32_t index = asset->instances[mesh].material;
    const tinygltf::Material &material = gltf_find_material(*asset, index);
    const bool passes = asset->shadings && asset->shadings->passed.count(index);
    const double alpha = material.alphaMode == "BLEND" ? std::clamp(gltf_base_factor(material, 3), 0.0, 1.0) : 1;
    return passes ? alpha * asset->shadings->passed.at(index).shown_alpha : alpha;
}

bool gltf_asset_mesh_blends(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() &&
           gltf_find_material(*asset, asset->instances[mesh].material).alphaMode == "BLEND";
}

/* ---- the copy that shows baked light ---------------------------------------------------------------------------- */

tinygltf::TextureInfo gltf_diffuse_texture(const tinygltf::Material &source) {
    const tinygltf::Value *glossy = gltf_find_named(source.extensions, glossiness);
    if (!glossy) return source.pbrMetallicRoughness.baseColorTexture;
    return gltf_extension_texture(*glossy, "diffuseTexture");
}

bool gltf_shows_emission(const gltf_asset &asset, const tinygltf::Material &material) {
    const std::vector<std::string> &used = asset.model.extensionsUsed;
    bool is_plain = asset.shows_emission && material.alphaMode == "OPAQUE" && material.emissiveTexture.index >= 0 &&
                    !material.extensions.count("KHR_materials_transmission") &&
                    !material.extensions.count("KHR_materials_diffuse_transmission") && !gltf_is_unlit(material) &&
                    std::find(used.begin(), used.end(), "KHR_materials_variants") == used.end();
    double reflected = 0, emitted = 0;
    for (size_t c = 0; c < 3; c++) {
        reflected = std::max(reflected, gltf_base_factor(material, c));
        emitted = std::max(emitted, gltf_material_emission(material, c));
    }
    return is_plain && reflected <= hardly_reflects && emitted > 0;
}

tinygltf::TextureInfo gltf_extension_texture(const tinygltf::Value &holder, const char *member) {
    tinygltf::TextureInfo info;
    if (!holder.Has(member)) return info;
    const tinygltf::Value &texture = holder.Get(member);
    if (texture.Has("index") && texture.Get("index").IsInt()) info.index = texture.Get("index").Get<int>();
    if (texture.Has("extensions") && texture.Get("extensions").Has("KHR_texture_transform"))
        info.extensions["KHR_texture_transform"] = texture.Get("extensions").Get("KHR_texture_transform");
    if (texture.Has("texCoord") && texture.Get("texCoord").IsInt()) info.texCoord = texture.Get("texCoord").Get<int>();
    return info;
}

/* KHR_materials_unlit next to any other shading extension is undefined. */
static void add_extensions(cJSON *copy, const cJSON *source) {
    static const char unlit[] = "KHR_materials_unlit";
    std::map<std::string, const cJSON *> kept = { { unlit, gltf_extension(source, unlit) } };
    for (const cJSON *extension : gltf_elements(gltf_member(source, "extensions")))
        if (cJSON_IsObject(extension) && std::strncmp(extension->string, "KHR_materials_", 14) != 0)
            kept[extension->string] = extension;
    cJSON *extensions = gltf_object(copy, "extensions");
    for (const auto &[name, value] : kept)
        gltf_set(extensions, name.c_str(), value ? gltf_copy(value) : gltf_json(cJSON_CreateObject()));
}

static void add_base_color(cJSON *copy, double alpha, const cJSON *texture) {
    const double factor[4] = { 1, 1, 1, alpha };
    cJSON *pbr = gltf_object(copy, "pbrMetallicRoughness");
    if (std::fabs(alpha - 1) >= factor_tolerance) gltf_set_numbers(pbr, "baseColorFactor", factor, 4);
    if (texture) gltf_set(pbr, "baseColorTexture", gltf_copy(texture));
    gltf_set_number(pbr, "metallicFactor", 0);
    gltf_set_number(pbr, "roughnessFactor", 0.9);
}

/* The base colour's texture as it was written; of the specular-glossiness model, its diffuse one. */
static const cJSON *base_texture(const cJSON *source) {
    const cJSON *glossy = gltf_extension(source, glossiness);
    const cJSON *texture = glossy ? gltf_member(glossy, "diffuseTexture")
                                  : gltf_member(gltf_member(source, "pbrMetallicRoughness"), "baseColorTexture");
    return gltf_index(texture, "index") >= 0 ? texture : nullptr;
}

/* Members in the order of their names. */
gltf_json gltf_unlit_material(const gltf_asset &asset, const tinygltf::Material &material, const cJSON *source,
                              bool textured, double shown_alpha) {
    gltf_json copy(cJSON_CreateObject());
    const cJSON *texture =
        gltf_shows_emission(asset, material) ? gltf_member(source, "emissiveTexture") : base_texture(source);
    if (textured || !texture) { /* a mask without its texture would vanish or stay whole */
        if (std::fabs(material.alphaCutoff - 0.5) >= factor_tolerance)
            gltf_set_number(copy.get(), "alphaCutoff", material.alphaCutoff);
        if (material.alphaMode != "OPAQUE") gltf_set_text(copy.get(), "alphaMode", material.alphaMode.c_str());
    }
    bool turns = shown_alpha < 1 && material.alphaMode != "MASK"; /* to what blends: unlit glass */
    if (turns) gltf_set_text(copy.get(), "alphaMode", "BLEND");
    double alpha = material.alphaMode == "OPAQUE" && turns ? 1 : gltf_base_factor(material, 3);
    add_extensions(copy.get(), source);
    if (!material.name.empty()) gltf_set_text(copy.get(), "name", material.name.c_str());
    add_base_color(copy.get(), turns ? alpha * shown_alpha : alpha, textured ? texture : nullptr);
    if (const cJSON *extras = gltf_member(source, "extras")) gltf_set(copy.get(), "extras", gltf_copy(extras));
    return copy;
}
