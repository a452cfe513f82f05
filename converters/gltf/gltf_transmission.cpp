/* SPDX-License-Identifier: MIT
 * How does a material let light past? Of what it covers (alphaMode BLEND), KHR_materials_transmission lets a share
 * straight through, tinted by the base colour, and KHR_materials_diffuse_transmission a share of the rest diffusely:
 *
 *     covered    = baseColorFactor.a x texture's x COLOR_0's          by BLEND; 1 otherwise
 *     straight   = 1 - covered + covered x base (1 - m) t             t = transmissionFactor x texture
 *     diffuse    = covered x colour (1 - m) (1 - t) f                 f = diffuseTransmissionFactor x texture
 *     reflected  = covered x base [(1 - m) (1 - t) (1 - f) + m r^2 / 2]
 */
#include "gltf_texture.h"

#include <algorithm>
#include <cmath>

static const char straight_name[] = "KHR_materials_transmission", diffuse_name[] = "KHR_materials_diffuse_transmission";

/* Glass that would show no more than this of itself is shown as nothing. */
static const double alpha_least = 1e-3;

static double share(const tinygltf::Material &material, const char *extension, const char *member) {
    return std::clamp(gltf_extension_number(material.extensions, extension, member, -1, 0), 0.0, 1.0);
}

static gltf_sampler read_map(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::Material &material,
                             const char *extension, const char *member, int kind) {
    return gltf_read_sampler(asset, geometry, gltf_extension_texture(material.extensions.at(extension), member), kind);
}

static double mean(const gltf_sampler &sampler, int band) {
    return sampler.mips ? double(sampler.mips->levels.back().rgb[size_t(band)]) : 1;
}

/* 1 - what all bands let straight through: so much of the glass covers what is behind it. What emits is shown whole. */
static double shown_alpha(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::Material &material,
                          const gltf_transmission &t) {
    const double metal = material.extensions.count("KHR_materials_pbrSpecularGlossiness")
                             ? 0
                             : std::clamp(material.pbrMetallicRoughness.metallicFactor, 0.0, 1.0);
    if (!(t.straight > 0)) return 1;
    gltf_sampler base = gltf_read_sampler(asset, geometry, gltf_diffuse_texture(material), texel_color);
    double least = 1;
    for (int c = 0; c < 3; c++) {
        if (gltf_material_emission(material, size_t(c)) > 0) return 1;
        least = std::min(least, std::clamp(gltf_base_factor(material, size_t(c)), 0.0, 1.0) * mean(base, c));
    }
    double alpha = 1 - least * t.straight * mean(t.straight_map, 0) * (1 - metal);
    return alpha < alpha_least ? 0 : alpha;
}

gltf_transmission gltf_read_transmission(gltf_asset &asset, const gltf_geometry &geometry, uint32_t index) {
    const tinygltf::Material &material = gltf_find_material(asset, index);
    gltf_transmission out;
    out.blends = material.alphaMode == "BLEND";
    if (out.blends) {
        out.alpha = std::clamp(gltf_base_factor(material, 3), 0.0, 1.0);
        out.alpha_at = geometry.mask_at < 0 ? -1 : geometry.mask_at + 2;
        out.alpha_map = gltf_read_sampler(asset, geometry, gltf_diffuse_texture(material), texel_alpha);
    }
    out.straight = share(material, straight_name, "transmissionFactor");
    if (out.straight > 0)
        out.straight_map = read_map(asset, geometry, material, straight_name, "transmissionTexture", texel_data);
    out.diffuse = share(material, diffuse_name, "diffuseTransmissionFactor");
    for (int c = 0; out.diffuse > 0 && c < 3; c++)
        out.diffuse_color[c] = std::clamp(
            gltf_extension_number(material.extensions, diffuse_name, "diffuseTransmissionColorFactor", c, 1), 0.0, 1.0);
    if (out.diffuse > 0) {
        gltf_convert_factor(*asset.shadings, out.diffuse_color);
        out.diffuse_map = read_map(asset, geometry, material, diffuse_name, "diffuseTransmissionTexture", texel_alpha);
        out.diffuse_color_map =
            read_map(asset, geometry, material, diffuse_name, "diffuseTransmissionColorTexture", texel_color);
    }
    out.any = out.straight > 0 || out.diffuse > 0 || gltf_most_straight(out, geometry) > 0;
    out.blends = out.blends && out.any;
    out.shown_alpha = material.alphaMode == "MASK" ? 1 : shown_alpha(asset, geometry, material, out);
    return out;
}

double gltf_most_straight(const gltf_transmission &t, const gltf_geometry &geometry) {
    double cover = t.alpha_at < 0 ? t.alpha : 1, texel = 1;
    for (size_t v = 0; t.alpha_at >= 0 && v < geometry.vertex_count; v++)
        cover = std::min(cover, double(geometry.attributes[geometry.attribute_count * v + size_t(t.alpha_at)]));
    if (t.alpha_map.mips)
        for (float alpha : t.alpha_map.mips->levels.front().rgb) texel = std::min(texel, double(alpha));
    double least = t.blends ? std::clamp(cover * texel, 0.0, 1.0) : 1;
    return 1 - least + least * t.straight;
}

gltf_passage gltf_passage_at(const gltf_transmission &t, const double *attributes, uint32_t count, uint32_t corners,
                             const double *point) {
    gltf_passage out = { 1, 1, t.straight, t.diffuse, { t.diffuse_color[0], t.diffuse_color[1], t.diffuse_color[2] } };
    if (!t.any) return out;
    auto texel = [&](const gltf_sampler &sampler, int band) {
        return double(gltf_texel_over(sampler, attributes, count, corners, point)[band]);
    };
    if (t.blends) {
        out.alpha_texel = std::max(texel(t.alpha_map, 0), 1e-9);
        out.cover = std::clamp(t.alpha_at < 0 ? t.alpha : point[t.alpha_at], 0.0, 1.0) * out.alpha_texel;
    }
    out.straight *= texel(t.straight_map, 0);
    out.diffuse *= texel(t.diffuse_map, 0);
    for (int c = 0; c < 3; c++) out.diffuse_color[c] *= texel(t.diffuse_color_map, c);
    return out;
}
