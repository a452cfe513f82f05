/* SPDX-License-Identifier: MIT
 * What do a material's textures and a primitive's COLOR_0 make of a piece of a surface? Means over a grid of points, at
 * the level of each texture whose texels are as large as the grid's cells: so every texel under the piece counts.
 */
#include "gltf_guarded.h"
#include "gltf_texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

static const int grid_side = 8, grid_side_least = 2;

/* Colours that a texture shows are divided out no further than this: darker texels than a sixteenth do not glow. */
static const double shown_least = 1.0 / 16;

/* ---- what a primitive is shaded with ----------------------------------------------------------------------------- */

struct gltf_shading {
    gltf_sampler base, metallic, emissive;
    const gltf_mip_chain *coverage = nullptr; /* share of the base's texels that the mask leaves; NULL: all */
    double base_factor[3], metal_factor, rough_factor, emissive_factor[3];
    double metal_share; /* gltf_metal_share */
    gltf_transmission transmission;
    bool shows_texture, shows_emission; /* the base texture stays on the surface, or the emissive one */
    int color;                          /* where COLOR_0 is among the attributes; -1: none */
    uint32_t attribute_count;
};

gltf_shadings::gltf_shadings() = default;
gltf_shadings::~gltf_shadings() = default;

/* ---- textures ---------------------------------------------------------------------------------------------------- */

/* uv' = T R S uv. [KHR_texture_transform] */
static void read_transform(const tinygltf::ExtensionMap &extensions, gltf_sampler &out) {
    auto number = [&extensions](const char *name, int index, double fallback) {
        return gltf_extension_number(extensions, "KHR_texture_transform", name, index, fallback);
    };
    double angle = number("rotation", -1, 0), c = std::cos(angle), s = std::sin(angle);
    double x = number("scale", 0, 1), y = number("scale", 1, 1);
    const double rows[2][3] = { { c * x, s * y, number("offset", 0, 0) }, { -s * x, c * y, number("offset", 1, 0) } };
    std::memcpy(out.row, rows, sizeof rows);
}

/* Where TEXCOORD_n is among the attributes; -1: the primitive has none. */
static int attribute_offset(const gltf_geometry &geometry, const std::string &name) {
    int at = 0;
    for (const gltf_attribute &attribute : geometry.transferred) {
        if (attribute.name == name) return at;
        at += attribute.components;
    }
    return -1;
}

/* The image of a texture that holds several of the same picture: the first that can be read, else the last; -1: none.
 */
static int image_of(gltf_asset &asset, int texture) {
    const tinygltf::Texture &source = asset.model.textures[size_t(texture)];
    std::vector<int> images;
    auto add = [&](int image) {
        if (image >= 0 && image < int(asset.model.images.size())) images.push_back(image);
    };
    auto named = [&](const char *extension) {
        add(int(gltf_extension_number(source.extensions, extension, "source", -1, -1)));
    };
    named("EXT_texture_webp");
    add(source.source);
    for (const char *extension : { "KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds" }) named(extension);
    for (size_t i = 0; i + 1 < images.size(); i++)
        if (gltf_image_is_readable(asset, images[i])) return images[i];
    if (images.empty() && asset.shadings->empty_textures.insert(texture).second)
        gltf_note(asset, gltf_text("texture %d", texture), std::string("it has no picture: ") + gltf_unread_picture);
    return images.empty() ? -1 : images.back();
}

int gltf_texture_coordinates(int coordinates, const tinygltf::ExtensionMap &extensions, gltf_sampler &sampler) {
    if (extensions.count("KHR_texture_transform")) read_transform(extensions, sampler);
    return int(gltf_extension_number(extensions, "KHR_texture_transform", "texCoord", -1, coordinates));
}

/* USD's wrap mode black, which glTF lacks: extras.hemibake_border "s", "t" or "st". */
static void read_border(const tinygltf::Value &extras, gltf_sampler &out) {
    if (!extras.Has("hemibake_border") || !extras.Get("hemibake_border").IsString()) return;
    const std::string &along = extras.Get("hemibake_border").Get<std::string>();
    for (size_t k = 0; k < 2; k++) out.black[k] = along.find("st"[k]) != std::string::npos;
}

int gltf_texture_image(gltf_asset &asset, int texture, gltf_sampler &sampler) {
    sampler.wrap[0] = sampler.wrap[1] = TINYGLTF_TEXTURE_WRAP_REPEAT;
    if (texture < 0 || texture >= int(asset.model.textures.size())) return -1;
    int index = asset.model.textures[size_t(texture)].sampler;
    if (index >= 0 && index < int(asset.model.samplers.size())) {
        sampler.wrap[0] = asset.model.samplers[size_t(index)].wrapS;
        sampler.wrap[1] = asset.model.samplers[size_t(index)].wrapT;
        read_border(asset.model.samplers[size_t(index)].extras, sampler);
    }
    return image_of(asset, texture);
}

gltf_sampler gltf_read_sampler(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::TextureInfo &info,
                               int kind) {
    gltf_sampler out;
    int coordinates = gltf_texture_coordinates(info.texCoord, info.extensions, out);
    int offset = attribute_offset(geometry, "TEXCOORD_" + std::to_string(coordinates));
    int image = gltf_texture_image(asset, info.index, out);
    out.mips = image < 0 ? nullptr : gltf_find_mip_chain(asset, image, kind);
    out.unread = info.index >= 0 && !out.mips;
    if (offset < 0) out.mips = nullptr; /* a primitive without coordinates; whether it can be read is the material's */
    if (offset >= 0) out.attribute = uint32_t(offset);
    return out;
}

/* The least alpha of a texel that MASK leaves; 0: all are left. COLOR_0's is not known here and counts as 1. */
static int least_alpha(const tinygltf::Material &material) {
    double factor = gltf_base_factor(material, 3);
    if (material.alphaMode != "MASK" || !(material.alphaCutoff > 0)) return 0;
    return factor > 0 ? int(std::min(std::ceil(255 * material.alphaCutoff / factor), 255.0)) : 255;
}

/* The base colour's texture; under an alpha mask, what that leaves of it. */
static void read_base_texture(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::Material &material,
                              gltf_shading &out) {
    tinygltf::TextureInfo info = gltf_diffuse_texture(material);
    int least = least_alpha(material);
    int kind = out.transmission.blends ? texel_premultiplied_color : texel_color;
    out.base = gltf_read_sampler(asset, geometry, info, least ? texel_covered_color + texel_kinds * least : kind);
    if (least) out.coverage = gltf_read_sampler(asset, geometry, info, texel_coverage + texel_kinds * least).mips;
}

void gltf_convert_factor(const gltf_shadings &all, double rgb[3]) {
    double most = std::max(rgb[0], std::max(rgb[1], rgb[2]));
    if (!all.convert || !(most > 0)) return;
    float color[3];
    for (int c = 0; c < 3; c++) color[c] = float(rgb[c] / most);
    if (all.convert(all.convert_user, false, nullptr, color, 1) != HEMI_OK) return;
    for (int c = 0; c < 3; c++) rgb[c] = most * double(color[c]);
}

static void read_base(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::Material &material,
                      gltf_shading &out) {
    const tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    const bool glossy = material.extensions.count("KHR_materials_pbrSpecularGlossiness") > 0;
    for (size_t c = 0; c < 3; c++) out.base_factor[c] = gltf_base_factor(material, c);
    out.metal_factor = glossy ? 0 : std::clamp(pbr.metallicFactor, 0.0, 1.0);
    out.rough_factor = std::clamp(pbr.roughnessFactor, 0.0, 1.0);
    out.metal_share = gltf_metal_share(asset);
    if (glossy) return;
    tinygltf::TextureInfo metal;
    metal.index = pbr.metallicRoughnessTexture.index, metal.texCoord = pbr.metallicRoughnessTexture.texCoord;
    metal.extensions = pbr.metallicRoughnessTexture.extensions;
    out.metallic = gltf_read_sampler(asset, geometry, metal, texel_metal);
}

static bool is_needed(const gltf_shading &s) {
    return s.base.mips || s.metallic.mips || s.emissive.mips || s.color >= 0 || s.transmission.any;
}

static std::unique_ptr<gltf_shading> read_shading(gltf_asset &asset, const gltf_instance &instance) {
    auto out = std::make_unique<gltf_shading>();
    const gltf_geometry &geometry = *instance.geometry;
    const tinygltf::Material &material = gltf_find_material(asset, instance.material);
    out->transmission = gltf_read_transmission(asset, geometry, instance.material);
    read_base(asset, geometry, material, *out);
    read_base_texture(asset, geometry, material, *out);
    if (out->base.unread || out->metallic.unread) { /* glTF's defaults would make a white metal of it */
        asset.shadings->unread.insert(instance.material);
        out->metallic.mips = nullptr;
        out->metal_factor = 0;
    }
    for (size_t c = 0; c < 3; c++) out->emissive_factor[c] = asset.emission_scale * gltf_material_emission(material, c);
    out->emissive = gltf_read_sampler(asset, geometry, material.emissiveTexture, texel_color);
    out->shows_emission = gltf_shows_emission(asset, material);
    out->shows_texture = out->base.mips != nullptr;
    out->color = geometry.color_at;
    out->attribute_count = geometry.attribute_count;
    gltf_convert_factor(*asset.shadings, out->base_factor);
    gltf_convert_factor(*asset.shadings, out->emissive_factor);
    for (size_t c = 0; gltf_is_unlit(material) && c < 3; c++) out->base_factor[c] = out->emissive_factor[c] = 0;
    return out;
}

/* ---- means ------------------------------------------------------------------------------------------------------- */

/* Points (s, t) of the grid over the corners of a quad or triangle, which stand for equal areas of a parallelogram and
 * a triangle: the centres of cells, and of half cells, none of them on an edge, where a texture may begin anew. */
static void corner_weights(uint32_t corners, const gltf_points &of, int i, int j, double weight[4]) {
    double inside = corners == 3 ? 1.0 / 3 : 0.5, s = (i + inside) / of.side[0], t = (j + inside) / of.side[1];
    if (corners == 3) {
        if (s + t > 1) s = 1 - s, t = 1 - t; /* the other half of the square, turned onto this one */
        weight[0] = 1 - s - t, weight[1] = s, weight[2] = t, weight[3] = 0;
        return;
    }
    weight[0] = (1 - s) * (1 - t), weight[1] = s * (1 - t), weight[2] = s * t, weight[3] = (1 - s) * t;
}

/* Area in uv of a cell of the grid. */
static double footprint_of(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners) {
    double area = 0, last[2], at[2];
    gltf_transform_uv(sampler, attributes + size_t(count) * (corners - 1), last);
    for (uint32_t i = 0; i < corners; i++) {
        gltf_transform_uv(sampler, attributes + size_t(count) * i, at);
        area += 0.5 * (last[0] * at[1] - at[0] * last[1]);
        std::memcpy(last, at, sizeof at);
    }
    return std::fabs(area) / (grid_side * grid_side);
}

struct lookup {
    const gltf_sampler *sampler;
    size_t level;
};

static lookup lookup_over(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners) {
    return { &sampler, sampler.mips ? gltf_level_for(sampler, footprint_of(sampler, attributes, count, corners)) : 0 };
}

static const float *color_at(const lookup &l, const double *point) {
    static const float white[3] = { 1, 1, 1 };
    double uv[2];
    if (!l.sampler->mips) return white;
    gltf_transform_uv(*l.sampler, point, uv);
    return gltf_texel(*l.sampler, l.level, uv);
}

const float *gltf_texel_over(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners,
                             const double *point) {
    return color_at(lookup_over(sampler, attributes, count, corners), point);
}

/* The share of the base texture's texels there that the mask leaves, whose colours it holds times that share. */
static double coverage_at(const gltf_shading &s, const lookup &base, const double *point) {
    if (!s.coverage) return 1;
    gltf_sampler coverage = s.base;
    coverage.mips = s.coverage;
    return double(*color_at({ &coverage, base.level }, point));
}

/* Sums over the points of the grid, of what the mask leaves. */
struct sums {
    double rho[3], emission[3], base[3], glow[3], diffuse[3], coverage;
    double uncovered[3], straight[3], transmitted[3], cover, alpha_texel;
};

static void add_point(const gltf_shading &s, const lookup lookups[3], const gltf_passage &pass, const double *point,
                      sums &sum) {
    const float *base = color_at(lookups[0], point), *metal = color_at(lookups[1], point),
                *emissive = color_at(lookups[2], point);
    double rough = s.metal_share * s.rough_factor * s.rough_factor * double(metal[0]),
           plain = std::clamp(1 - s.metal_factor * double(metal[2]), 0.0, 1.0),
           diffuse = std::clamp(plain * (1 - pass.straight) * (1 - pass.diffuse) + s.metal_factor * rough, 0.0, 1.0),
           coverage = coverage_at(s, lookups[0], point), weight = pass.cover / pass.alpha_texel;
    sum.coverage += coverage;
    sum.cover += coverage * pass.cover;
    sum.alpha_texel += coverage * pass.alpha_texel;
    for (int c = 0; c < 3; c++) {
        double tint = s.color >= 0 ? std::max(point[s.color + c], 0.0) : 1;
        double shown = s.base_factor[c] * tint;
        sum.base[c] += double(base[c]);
        sum.glow[c] += double(emissive[c]);
        sum.diffuse[c] += coverage * shown * diffuse;
        sum.rho[c] += weight * shown * diffuse * double(base[c]);
        sum.emission[c] += coverage * pass.cover * s.emissive_factor[c] * double(emissive[c]);
        sum.straight[c] += weight * shown * plain * pass.straight * double(base[c]);
        sum.uncovered[c] += coverage * (1 - pass.cover);
        sum.transmitted[c] +=
            coverage * pass.cover * plain * (1 - pass.straight) * pass.diffuse * pass.diffuse_color[c];
    }
}

/* What colours carry where the viewer multiplies them by the texture, and blends them by alpha. A pane is shown by an
 * alpha that leaves of what is behind what it lets through of all bands; what it lets through more of some is added as
 * if as much light were in front: so glass shows its colour. */
static void demodulate(const gltf_shading &s, const sums &sum, hemi_texture_mean *out) {
    const double cells = sum.coverage, cover = std::max(sum.cover, 1e-12), alpha = s.transmission.shown_alpha;
    for (int c = 0; c < 3; c++) {
        const double picture = s.shows_emission ? sum.glow[c] / cells : sum.base[c] / std::max(sum.alpha_texel, 1e-12);
        double base = s.shows_texture || s.shows_emission ? std::max(picture, shown_least) : 1;
        double more = s.transmission.straight > 0 ? std::max(sum.straight[c] / cover - (1 - alpha), 0.0) : 0;
        double shown = sum.diffuse[c] / cells + (sum.transmitted[c] / cover + more) / base;
        bool plain = s.shows_emission || (!s.shows_texture && !s.transmission.any);
        out->demodulated_reflectance[c] = plain ? out->reflectance[c] / base : alpha > 0 ? shown / alpha : 0;
        out->demodulated_emission[c] = s.shows_emission ? s.emissive_factor[c]
                                       : alpha > 0      ? sum.emission[c] / cover / base / alpha
                                                        : 0;
    }
}

static void shade(void *user, const double *attributes, uint32_t corners, hemi_texture_mean *out) {
    const gltf_shading &s = *static_cast<const gltf_shading *>(user);
    const uint32_t n = s.attribute_count;
    lookup lookups[3] = { lookup_over(s.base, attributes, n, corners), lookup_over(s.metallic, attributes, n, corners),
                          lookup_over(s.emissive, attributes, n, corners) };
    std::vector<double> point(n);
    sums sum = {};
    const int least = s.transmission.any ? grid_side : grid_side_least;
    gltf_points points = { { least, least } };
    for (lookup &l : lookups) gltf_refine_points(*l.sampler, attributes, n, corners, grid_side, l.level, points);
    for (int j = 0; j < points.side[1]; j++)
        for (int i = 0; i < points.side[0]; i++) {
            double weight[4];
            corner_weights(corners, points, i, j, weight);
            for (uint32_t k = 0; k < n; k++) {
                point[k] = 0;
                for (uint32_t v = 0; v < corners; v++) point[k] += weight[v] * attributes[size_t(n) * v + k];
            }
            add_point(s, lookups, gltf_passage_at(s.transmission, attributes, n, corners, point.data()), point.data(),
                      sum);
        }
    if (s.coverage && !(sum.coverage > 0)) { /* a hole: as if white, for what is interpolated into it */
        gltf_shading whole = s;
        whole.coverage = whole.base.mips = nullptr;
        shade(&whole, attributes, corners, out);
        for (double &rho : out->reflectance) rho = std::min(rho, HEMI_REFLECTANCE_MAX);
        return;
    }
    for (int c = 0; c < 3; c++) {
        out->reflectance[c] = std::clamp(sum.rho[c] / sum.coverage, 0.0, 1.0);
        out->emission[c] = sum.emission[c] / sum.coverage;
        out->transmission[c] = std::clamp((sum.uncovered[c] + sum.straight[c]) / sum.coverage, 0.0, 1.0);
        out->diffuse_transmission[c] = std::clamp(sum.transmitted[c] / sum.coverage, 0.0, 1.0);
    }
    demodulate(s, sum, out);
}

/* ---- what is handed out ------------------------------------------------------------------------------------------ */

/* What a material has that is not in the bake: extensions that only carry numbers for what is baked are not named. */
static void note_reductions(gltf_asset &asset, uint32_t index) {
    const std::map<std::string, const char *> known = {
        { "KHR_materials_unlit", "" },
        { "KHR_materials_transmission", nullptr },
        { "KHR_materials_diffuse_transmission", nullptr },
        { "KHR_materials_pbrSpecularGlossiness",
          "KHR_materials_pbrSpecularGlossiness: only its diffuse part is baked" },
        { "KHR_materials_emissive_strength", nullptr },
    };
    if (index >= asset.model.materials.size()) return;
    const tinygltf::Material &material = asset.model.materials[index];
    for (const auto &[extension, value] : material.extensions) {
        auto found = known.find(extension);
        if (extension.compare(0, 14, "KHR_materials_") != 0 || (found != known.end() && !found->second)) continue;
        std::string text = found != known.end() ? found->second : gltf_printable(extension) + " is left out";
        if (text.empty()) text = gltf_unlit_note(asset, index);
        gltf_note(asset, gltf_text("material %u \"%s\"", index, gltf_printable(material.name).c_str()), text);
    }
}

/* What the material says of itself where its elements say it themselves, and what shows it. */
static void note_transmission(gltf_asset &asset, const gltf_instance &instance, const gltf_transmission &t) {
    if (!t.any) return;
    gltf_passed &passed = asset.shadings->passed[instance.material];
    passed.straight = std::max(passed.straight, gltf_most_straight(t, *instance.geometry));
    for (int c = 0; c < 3; c++) passed.diffuse[c] = t.diffuse * t.diffuse_color[c];
    passed.shown_alpha = t.shown_alpha;
}

static void prepare(gltf_asset &asset, gltf_convert_fn convert, void *user) {
    asset.shadings = std::make_unique<gltf_shadings>();
    asset.shadings->convert = convert;
    asset.shadings->convert_user = user;
    std::map<std::pair<const gltf_geometry *, uint32_t>, gltf_shading *> known;
    std::map<const gltf_geometry *, const hemi_alpha_mask *> masks;
    std::set<uint32_t> noted;
    gltf_find_backdrops(asset);
    for (const gltf_instance &instance : asset.instances) {
        auto &shading = known[{ instance.geometry, instance.material }];
        if (noted.insert(instance.material).second) note_reductions(asset, instance.material);
        if (!shading) {
            asset.shadings->owned.push_back(read_shading(asset, instance));
            shading = asset.shadings->owned.back().get();
            note_transmission(asset, instance, shading->transmission);
        }
        asset.shadings->of_mesh.push_back(is_needed(*shading) ? shading : nullptr);
        auto [mask, fresh] = masks.insert({ instance.geometry, nullptr });
        if (fresh) mask->second = gltf_read_alpha_mask(asset, *instance.geometry, instance.material);
        asset.shadings->mask_of_mesh.push_back(mask->second);
        asset.shadings->shown_mask.push_back(gltf_read_shown_mask(asset, *instance.geometry, instance.material));
    }
    gltf_prepare_variants(asset, shade);
    gltf_gather_notes(asset);
}

hemi_result gltf_asset_read_textures(gltf_asset *asset, gltf_convert_fn convert, void *user,
                                     char message[GLTF_MESSAGE_SIZE]) {
    return gltf_guarded(message, "read the images", "the images cannot be read",
                        [&] { prepare(*asset, convert, user); });
}

bool gltf_asset_texture(const gltf_asset *asset, uint32_t mesh, hemi_mesh_desc *out) {
    if (!asset->shadings || mesh >= asset->shadings->of_mesh.size()) return false;
    out->alpha_mask = asset->shadings->mask_of_mesh[mesh];
    out->texture_is_reentrant = true;
    if (gltf_show_variants(*asset, mesh, *out)) return true;
    if (!asset->shadings->of_mesh[mesh]) return false;
    out->texture = shade;
    out->texture_user = asset->shadings->of_mesh[mesh];
    return true;
}
