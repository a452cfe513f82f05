/* SPDX-License-Identifier: MIT
 * Which lights without a surface does an asset hold? KHR_lights_punctual at its nodes, EXT_lights_image_based at its
 * scene.
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>

static const double pi = 3.14159265358979323846;

/* ---- KHR_lights_punctual ---------------------------------------------------------------------------------------- */

static int light_index(const tinygltf::Value &holder, const std::string &where) {
    if (!holder.Has("light") || !holder.Get("light").IsInt())
        gltf_fail(HEMI_ERROR_DATA, "%s.light is not an index", where.c_str());
    return holder.Get("light").Get<int>();
}

static hemi_light_kind kind_of(const std::string &type, const std::string &where) {
    if (type == "point") return HEMI_LIGHT_POINT;
    if (type == "spot") return HEMI_LIGHT_SPOT;
    if (type == "directional") return HEMI_LIGHT_DIRECTIONAL;
    gltf_fail(HEMI_ERROR_DATA, "%s.type is \"%s\"; it is point, spot or directional", where.c_str(),
              type.substr(0, 40).c_str());
}

/* KHR_lights_punctual knows no disc of a sun: extras.hemibake_angular_diameter of the light, radians. */
static double angular_diameter(const tinygltf::Light &source, const std::string &where) {
    if (!source.extras.IsObject() || !source.extras.Has("hemibake_angular_diameter")) return 0;
    const tinygltf::Value &value = source.extras.Get("hemibake_angular_diameter");
    double angle = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    if (!(angle >= 0 && angle < pi / 2))
        gltf_fail(HEMI_ERROR_DATA, "%s.extras.hemibake_angular_diameter is no angle from 0 to below pi / 2",
                  where.c_str());
    return angle;
}

/* A cone without a penumbra has a sharp edge. Others take what is out of range to its end, and so does this. False: its
 * cone is closed. */
static bool read_cone(gltf_asset &asset, const tinygltf::Light &source, int index, hemi_light_desc &out) {
    const double inner = source.spot.innerConeAngle, outer = source.spot.outerConeAngle;
    std::string name = gltf_printable(source.name);
    std::string subject =
        name.empty() ? gltf_text("light %d", index) : gltf_text("light %d \"%s\"", index, name.c_str());
    const cJSON *given =
        cJSON_GetArrayItem(gltf_member(gltf_extension(asset.document.get(), "KHR_lights_punctual"), "lights"), index);
    if (!gltf_member(given, "spot"))
        gltf_note(asset, subject, "a spot without a cone, which gets glTF's of 45 degrees");
    if (!(outer > 0)) {
        gltf_note(asset, subject, "its cone is closed, and its light is left out");
        return false;
    }
    out.outer_cone = std::min(outer, pi / 2);
    out.inner_cone = std::clamp(inner, 0.0, out.outer_cone);
    if (outer > pi / 2 + 1e-6) gltf_note(asset, subject, "its cone is wider than a half-space, and is taken as that");
    if (inner >= outer) gltf_note(asset, subject, "its cones are equal: its spot has a sharp edge");
    return true;
}

void gltf_add_light(gltf_asset &asset, int node, const double world[16]) {
    const tinygltf::Node &holder = asset.model.nodes[size_t(node)];
    auto found = holder.extensions.find("KHR_lights_punctual");
    if (found == holder.extensions.end()) return;
    int index = light_index(found->second, gltf_text("nodes[%d].extensions.KHR_lights_punctual", node));
    gltf_check_index(index, asset.model.lights.size(), "lights",
                     gltf_text("nodes[%d].extensions.KHR_lights_punctual.light", node));
    const tinygltf::Light &source = asset.model.lights[size_t(index)];
    std::string where = gltf_text("extensions.KHR_lights_punctual.lights[%d]", index);
    hemi_light_desc light = {};
    light.struct_size = sizeof light;
    light.kind = kind_of(source.type, where);
    if (!source.color.empty() && source.color.size() < 3)
        gltf_fail(HEMI_ERROR_DATA, "%s.color has %zu numbers, not 3", where.c_str(), source.color.size());
    light.name = holder.name.empty() ? source.name.c_str() : holder.name.c_str();
    for (size_t k = 0; k < 3; k++) {
        light.intensity[k] = (source.color.empty() ? 1 : source.color[k]) * source.intensity;
        light.position[k] = world[12 + k];
        light.direction[k] = -world[8 + k]; /* along -z of the node */
        if (!(light.intensity[k] <= 1e30))
            gltf_fail(HEMI_ERROR_DATA, "%s: its colour times its intensity is not a number from 0 to 1e30",
                      where.c_str());
    }
    if (std::min({ light.intensity[0], light.intensity[1], light.intensity[2] }) < 0) {
        gltf_note(asset, gltf_text("light %d", index), "it takes light away, which no lamp does, and is left out");
        return;
    }
    light.range = std::max(source.range, 0.0);
    light.angular_diameter = angular_diameter(source, where);
    if (light.kind == HEMI_LIGHT_SPOT && !read_cone(asset, source, index, light)) return;
    asset.lights.push_back(light);
}

/* ---- EXT_lights_image_based ------------------------------------------------------------------------------------- */

static double number(const tinygltf::Value &value, const std::string &where) {
    if (!value.IsNumber() || !std::isfinite(value.GetNumberAsDouble()))
        gltf_fail(HEMI_ERROR_DATA, "%s is not a number", where.c_str());
    return value.GetNumberAsDouble();
}

/* Real spherical harmonics up to l = 2 in the order of the extension. */
static void harmonics(const double d[3], double Y[9]) {
    double x = d[0], y = d[1], z = d[2];
    const double all[9] = { 0.282094792,
                            0.488602512 * y,
                            0.488602512 * z,
                            0.488602512 * x,
                            1.092548431 * x * y,
                            1.092548431 * y * z,
                            0.315391565 * (3 * z * z - 1),
                            1.092548431 * x * z,
                            0.546274215 * (x * x - y * y) };
    std::copy(all, all + 9, Y);
}

/* The coefficients are those of irradiance; of radiance they are these times less. */
static double cosine_lobe(size_t i) {
    return i == 0 ? pi : i < 4 ? 2 * pi / 3 : pi / 4;
}

/* R^-1 d for a unit quaternion (x, y, z, w). */
static void turn_back(const double q[4], const double d[3], double out[3]) {
    double m[16];
    const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };
    gltf_compose(zero, q, one, m);
    for (size_t r = 0; r < 3; r++) out[r] = m[4 * r] * d[0] + m[4 * r + 1] * d[1] + m[4 * r + 2] * d[2];
}

struct image_light {
    double coefficient[9][3], rotation[4], intensity;
};

static image_light read_image_light(const tinygltf::Value &source, const std::string &where) {
    image_light light = { {}, { 0, 0, 0, 1 }, 1 };
    std::string at = where + ".irradianceCoefficients";
    if (!source.Has("irradianceCoefficients") || !source.Get("irradianceCoefficients").IsArray() ||
        source.Get("irradianceCoefficients").ArrayLen() != 9)
        gltf_fail(HEMI_ERROR_DATA, "%s is not an array of nine", at.c_str());
    for (int i = 0; i < 9; i++) {
        const tinygltf::Value &rgb = source.Get("irradianceCoefficients").Get(i);
        if (!rgb.IsArray() || rgb.ArrayLen() != 3) gltf_fail(HEMI_ERROR_DATA, "%s[%d] is not rgb", at.c_str(), i);
        for (int c = 0; c < 3; c++) light.coefficient[i][c] = number(rgb.Get(c), gltf_text("%s[%d]", at.c_str(), i));
    }
    if (source.Has("intensity")) light.intensity = number(source.Get("intensity"), where + ".intensity");
    if (source.Has("rotation") && source.Get("rotation").IsArray() && source.Get("rotation").ArrayLen() == 4)
        for (int k = 0; k < 4; k++) light.rotation[k] = number(source.Get("rotation").Get(k), where + ".rotation");
    return light;
}

void gltf_read_sky(gltf_asset &asset) {
    if (asset.scene < 0) return;
    const tinygltf::Scene &scene = asset.model.scenes[size_t(asset.scene)];
    auto used = scene.extensions.find("EXT_lights_image_based");
    auto all = asset.model.extensions.find("EXT_lights_image_based");
    if (used == scene.extensions.end() || all == asset.model.extensions.end()) return;
    std::string where = gltf_text("scenes[%d].extensions.EXT_lights_image_based", asset.scene);
    int index = light_index(used->second, where);
    bool listed = all->second.IsObject() && all->second.Has("lights") && all->second.Get("lights").IsArray();
    gltf_check_index(index, listed ? all->second.Get("lights").ArrayLen() : 0, "lights", where + ".light");
    image_light light = read_image_light(all->second.Get("lights").Get(index),
                                         gltf_text("extensions.EXT_lights_image_based.lights[%d]", index));
    asset.sky.resize(3 * gltf_sky_width * gltf_sky_height);
    for (size_t row = 0; row < gltf_sky_height; row++)
        for (size_t column = 0; column < gltf_sky_width; column++) {
            double altitude = pi * (0.5 - (double(row) + 0.5) / gltf_sky_height), Y[9], d[3];
            double azimuth = 2 * pi * ((double(column) + 0.5) / gltf_sky_width - 0.5);
            const double toward[3] = { std::cos(altitude) * std::cos(azimuth), std::sin(altitude),
                                       std::cos(altitude) * std::sin(azimuth) };
            turn_back(light.rotation, toward, d);
            harmonics(d, Y);
            for (size_t c = 0; c < 3; c++) {
                double L = 0;
                for (size_t i = 0; i < 9; i++) L += light.coefficient[i][c] / cosine_lobe(i) * Y[i];
                asset.sky[3 * (row * gltf_sky_width + column) + c] = float(std::clamp(L * light.intensity, 0.0, 1e30));
            }
        }
}

/* ---- what is handed out ------------------------------------------------------------------------------------------ */

bool gltf_asset_light(const gltf_asset *asset, uint32_t index, hemi_light_desc *out) {
    if (index >= asset->lights.size()) return false;
    *out = asset->lights[index];
    return true;
}

bool gltf_asset_sky(const gltf_asset *asset, hemi_sky_desc *out) {
    if (asset->sky.empty()) return false;
    *out = hemi_sky_desc{};
    out->struct_size = sizeof *out;
    for (double &radiance : out->radiance) radiance = 1;
    out->image = asset->sky.data();
    out->width = uint32_t(gltf_sky_width);
    out->height = uint32_t(gltf_sky_height);
    return true;
}
