/* SPDX-License-Identifier: MIT
 * Which parts of a primitive does alphaMode MASK leave? The alpha of the base colour's texels, times baseColorFactor's
 * and COLOR_0's, against alphaCutoff. Without the texture, its coordinates or a picture that can be read, texels count
 * as opaque, and the factors decide.
 */
#include "gltf_texture.h"

#include "image_decode.h"

#include <algorithm>
#include <climits>

/* OpenGL takes no wider pictures; every n-th row and column of such stays. */
static const uint32_t side_most = 16384;

const tinygltf::Material *gltf_masked_material(const gltf_asset &asset, int material) {
    if (material < 0 || material >= int(asset.model.materials.size())) return nullptr;
    const tinygltf::Material &found = asset.model.materials[size_t(material)];
    return found.alphaMode == "MASK" ? &found : nullptr;
}

const tinygltf::Material *gltf_covered_material(const gltf_asset &asset, int material) {
    if (material < 0 || material >= int(asset.model.materials.size())) return nullptr;
    const tinygltf::Material &found = asset.model.materials[size_t(material)];
    return found.alphaMode == "MASK" || found.alphaMode == "BLEND" ? &found : nullptr;
}

/* ---- where texels are -------------------------------------------------------------------------------------------- */

/* Alpha of COLOR_0 at a vertex. */
static float color_alpha(const gltf_geometry &geometry, size_t v) {
    for (const gltf_attribute &attribute : geometry.lit_only)
        if (attribute.name == "COLOR_0" && attribute.components == 4) return attribute.values[4 * v + 3];
    return 1;
}

static bool has_color_alpha(const gltf_geometry &geometry) {
    return std::any_of(geometry.lit_only.begin(), geometry.lit_only.end(), [](const gltf_attribute &attribute) {
        return attribute.name == "COLOR_0" && attribute.components == 4;
    });
}

/* The coordinates of the base colour's texture; NULL: it has none. */
static const gltf_attribute *find_coordinates(const gltf_geometry &geometry, const tinygltf::TextureInfo &info,
                                              gltf_sampler &sampler) {
    int coordinates = gltf_texture_coordinates(info.texCoord, info.extensions, sampler);
    for (const gltf_attribute &attribute : geometry.transferred)
        if (attribute.name == "TEXCOORD_" + std::to_string(coordinates)) return &attribute;
    return nullptr;
}

std::vector<float> gltf_mask_coordinates(const gltf_asset &asset, int material, const gltf_geometry &geometry) {
    const tinygltf::Material *masked = gltf_covered_material(asset, material);
    const bool varies = masked && (has_color_alpha(geometry) || gltf_diffuse_texture(*masked).index >= 0);
    if (!masked || (masked->alphaMode == "BLEND" && !varies)) return {};
    std::vector<float> out(3 * size_t(geometry.vertex_count), 0.0f);
    gltf_sampler sampler;
    const gltf_attribute *set = find_coordinates(geometry, gltf_diffuse_texture(*masked), sampler);
    for (size_t v = 0; v < geometry.vertex_count; v++) {
        double uv[2] = { 0, 0 };
        if (set) {
            const double at[2] = { double(set->values[2 * v]), double(set->values[2 * v + 1]) };
            gltf_transform_uv(sampler, at, uv);
        }
        out[3 * v] = float(uv[0]), out[3 * v + 1] = float(uv[1]);
        out[3 * v + 2] = float(std::max(gltf_base_factor(*masked, 3), 0.0)) * std::max(color_alpha(geometry, v), 0.0f);
    }
    return out;
}

/* ---- alpha maps -------------------------------------------------------------------------------------------------- */

/* Without a picture that has alpha: one opaque texel. */
static std::unique_ptr<gltf_alpha_map> read_alpha(gltf_asset &asset, int image) {
    auto out = std::make_unique<gltf_alpha_map>();
    *out = { 1, 1, { 255 } };
    if (image < 0) return out;
    image_pixels pixels;
    if (!gltf_decode_image(asset, image, &pixels)) return out;
    std::unique_ptr<uint8_t, decltype(&free)> owner(pixels.rgba, free);
    uint32_t step = (std::max(pixels.width, pixels.height) + side_most - 1) / side_most;
    out->width = (pixels.width + step - 1) / step, out->height = (pixels.height + step - 1) / step;
    out->alpha.resize(size_t(out->width) * out->height);
    for (size_t row = 0; row < out->height; row++)
        for (size_t column = 0; column < out->width; column++)
            out->alpha[row * out->width + column] = pixels.rgba[4 * (row * step * pixels.width + column * step) + 3];
    return out;
}

static hemi_wrap wrap_of(int wrap) {
    if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return HEMI_WRAP_CLAMP;
    return wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? HEMI_WRAP_MIRROR : HEMI_WRAP_REPEAT;
}

static bool any_hole(const hemi_alpha_mask &mask, const gltf_geometry &geometry) {
    const uint8_t least = *std::min_element(mask.alpha, mask.alpha + size_t(mask.width) * mask.height);
    float weight = 1e30f;
    for (size_t v = 0; v < geometry.vertex_count; v++)
        weight = std::min(weight, geometry.attributes[geometry.attribute_count * v + mask.attribute + 2]);
    return least / 255.0 * double(weight) < mask.cutoff;
}

static const hemi_alpha_mask *read_mask(gltf_asset &asset, const gltf_geometry &geometry,
                                        const tinygltf::Material *masked, double cutoff) {
    if (!masked || geometry.mask_at < 0) return nullptr;
    tinygltf::TextureInfo info = gltf_diffuse_texture(*masked);
    gltf_sampler sampler;
    int image = find_coordinates(geometry, info, sampler) ? gltf_texture_image(asset, info.index, sampler) : -1;
    gltf_shadings &all = *asset.shadings;
    auto &map = all.alphas[image];
    if (!map) map = read_alpha(asset, image);
    auto out = std::make_unique<hemi_alpha_mask>();
    *out = { sizeof *out,
             map->alpha.data(),
             map->width,
             map->height,
             wrap_of(sampler.wrap[0]),
             wrap_of(sampler.wrap[1]),
             uint32_t(geometry.mask_at),
             std::max(cutoff, 0.0) };
    if (!any_hole(*out, geometry)) return nullptr;
    all.masks.push_back(std::move(out));
    return all.masks.back().get();
}

const hemi_alpha_mask *gltf_read_alpha_mask(gltf_asset &asset, const gltf_geometry &geometry, uint32_t material) {
    const tinygltf::Material *masked = material <= INT_MAX ? gltf_masked_material(asset, int(material)) : nullptr;
    return read_mask(asset, geometry, masked, masked ? masked->alphaCutoff : 0);
}

const hemi_alpha_mask *gltf_read_shown_mask(gltf_asset &asset, const gltf_geometry &geometry, uint32_t material) {
    const tinygltf::Material *covered = material <= INT_MAX ? gltf_covered_material(asset, int(material)) : nullptr;
    return read_mask(asset, geometry, covered, covered && covered->alphaMode == "MASK" ? covered->alphaCutoff : 1.0);
}
