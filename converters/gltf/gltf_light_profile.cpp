/* SPDX-License-Identifier: MIT
 * Which lights shine by a measured profile? EXT_lights_ies at nodes: the file's candela times colour and multiplier,
 * from where the node is, aimed along its -z. [EXT_lights_ies] What cannot be used is left out with a line that says
 * why.
 */
#include "gltf_model.h"

#include "ies_profile.h"

#include <algorithm>
#include <cmath>

static const char extension[] = "EXT_lights_ies";
static const size_t places_max = 1024;

/* ---- profiles ---------------------------------------------------------------------------------------------------- */

static std::string subject_of(const gltf_asset &asset, int index) {
    const cJSON *light =
        cJSON_GetArrayItem(gltf_member(gltf_extension(asset.document.get(), extension), "lights"), index);
    const cJSON *name = gltf_member(light, "name");
    return gltf_text("profile %d", index) +
           (cJSON_IsString(name) ? " \"" + gltf_printable(name->valuestring) + "\"" : "");
}

/* The bytes of its file, wherever they are. */
static std::pair<const unsigned char *, size_t> bytes_of(const gltf_asset &asset, int index) {
    const cJSON *light =
        cJSON_GetArrayItem(gltf_member(gltf_extension(asset.document.get(), extension), "lights"), index);
    int view = gltf_index(light, "bufferView");
    if (view >= 0 && size_t(view) < asset.model.bufferViews.size()) {
        const tinygltf::BufferView &range = asset.model.bufferViews[size_t(view)];
        return { asset.buffers[size_t(range.buffer)].data() + range.byteOffset, range.byteLength };
    }
    if (size_t(index) >= asset.profile_files.size() || asset.profile_files[size_t(index)].empty())
        return { nullptr, 0 };
    return { asset.profile_files[size_t(index)].data(), asset.profile_files[size_t(index)].size() };
}

/* Brightest 1. Without numbers: it cannot be used, and a line says why. */
static const gltf_profile &find_profile(gltf_asset &asset, int index) {
    auto [at, fresh] = asset.profiles.insert({ index, {} });
    gltf_profile &out = at->second;
    if (!fresh) return out;
    char message[IES_MESSAGE_SIZE] = "its file cannot be read";
    ies_profile read = {};
    auto [bytes, size] = bytes_of(asset, index);
    hemi_result result = bytes ? ies_profile_read(bytes, size, &read, message) : HEMI_ERROR_DATA;
    if (result == HEMI_ERROR_MEMORY) throw std::bad_alloc();
    if (result == HEMI_OK) {
        out.rows = read.rows, out.columns = read.columns;
        out.values.assign(read.candela, read.candela + size_t(read.rows) * read.columns);
        out.brightest = *std::max_element(out.values.begin(), out.values.end());
        for (float &value : out.values) value = out.brightest > 0 ? float(double(value) / out.brightest) : 0;
        if (!(out.brightest > 0)) snprintf(message, sizeof message, "it is dark in every direction");
    }
    ies_profile_free(&read);
    if (!(out.brightest > 0)) {
        out.values.clear();
        gltf_note(asset, subject_of(asset, index),
                  std::string("its light is left out, ") + message + "; give it an IES LM-63 file");
    }
    return out;
}

/* ---- lights ---- */

static double number_or(const tinygltf::Value &holder, const char *name, double fallback) {
    return holder.Has(name) && holder.Get(name).IsNumber() ? holder.Get(name).GetNumberAsDouble() : fallback;
}

/* Where a lamp that is not a point shines from, in the node's frame: extras.hemibake_places, x y z of each; else its
 * middle. They share its intensity. */
static std::vector<double> read_places(const tinygltf::Node &holder, const std::string &where) {
    const tinygltf::Value *listed =
        holder.extras.Has("hemibake_places") ? &holder.extras.Get("hemibake_places") : nullptr;
    if (!listed) return { 0, 0, 0 };
    const size_t count = listed->IsArray() ? listed->ArrayLen() : 0;
    std::vector<double> out;
    for (size_t i = 0; i < count && listed->Get(int(i)).IsNumber(); i++)
        out.push_back(listed->Get(int(i)).GetNumberAsDouble());
    if (out.size() != count || count == 0 || count % 3 || count > 3 * places_max)
        gltf_fail(HEMI_ERROR_DATA, "%s: extras.hemibake_places are not x y z of 1 to %zu places", where.c_str(),
                  places_max);
    return out;
}

void gltf_add_profile(gltf_asset &asset, int node, const double world[16]) {
    const tinygltf::Node &holder = asset.model.nodes[size_t(node)];
    auto found = holder.extensions.find(extension);
    if (found == holder.extensions.end()) return;
    const cJSON *lights = gltf_member(gltf_extension(asset.document.get(), extension), "lights");
    const tinygltf::Value &source = found->second;
    std::string where = gltf_text("nodes[%d].extensions.%s", node, extension);
    int index = source.Has("light") && source.Get("light").IsInt() ? source.Get("light").Get<int>() : -1;
    gltf_check_index(index, size_t(cJSON_GetArraySize(lights)), "lights", where + ".light");
    const gltf_profile &profile = find_profile(asset, index);
    if (profile.values.empty()) return;
    double multiplier = number_or(source, "multiplier", 1);
    hemi_light_desc light = {};
    light.struct_size = sizeof light;
    light.kind = HEMI_LIGHT_POINT;
    light.name = holder.name.c_str();
    light.profile = profile.values.data();
    light.profile_rows = profile.rows;
    light.profile_columns = profile.columns;
    for (size_t k = 0; k < 3; k++) {
        double color = 1;
        if (source.Has("color") && source.Get("color").IsArray() && source.Get("color").ArrayLen() > k &&
            source.Get("color").Get(int(k)).IsNumber())
            color = std::clamp(source.Get("color").Get(int(k)).GetNumberAsDouble(), 0.0, 1.0);
        light.intensity[k] = color * multiplier * profile.brightest;
        light.direction[k] = -world[8 + k];
        light.profile_axis[k] = world[k];
        if (!(light.intensity[k] >= 0 && light.intensity[k] <= 1e30))
            gltf_fail(HEMI_ERROR_DATA, "%s: its multiplier is negative or too large", where.c_str());
    }
    const std::vector<double> places = read_places(holder, where);
    for (double &value : light.intensity) value /= double(places.size() / 3);
    for (size_t i = 0; i < places.size(); i += 3) {
        for (size_t r = 0; r < 3; r++)
            light.position[r] =
                world[r] * places[i] + world[4 + r] * places[i + 1] + world[8 + r] * places[i + 2] + world[12 + r];
        asset.lights.push_back(light);
    }
}
