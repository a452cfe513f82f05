/* SPDX-License-Identifier: MIT
 * The C functions that hand out what was read. Exceptions end here.
 */
#include "gltf_guarded.h"
#include "gltf_model.h"

#include <cstdio>
#include <new>

hemi_result gltf_guarded_call(char *message, const char *purpose, const char *broken, void (*call)(const void *work),
                              const void *work) {
    char unread[GLTF_MESSAGE_SIZE];
    if (!message) message = unread;
    message[0] = '\0';
    try {
        call(work);
        return HEMI_OK;
    } catch (const gltf_failure &failure) {
        snprintf(message, GLTF_MESSAGE_SIZE, "%s", failure.text.c_str());
        return failure.code;
    } catch (const std::bad_alloc &) {
        snprintf(message, GLTF_MESSAGE_SIZE, "not enough memory to %s", purpose);
        return HEMI_ERROR_MEMORY;
    } catch (const std::exception &) {
        snprintf(message, GLTF_MESSAGE_SIZE, "%s", broken);
        return HEMI_ERROR_DATA;
    }
}

static void find_materials_of_lamps(gltf_asset &asset) {
    std::vector<bool> is_of_others(gltf_asset_material_count(&asset), false);
    asset.is_of_lamps = is_of_others;
    for (uint32_t i = 0; i < asset.instances.size(); i++)
        (gltf_asset_mesh_is_lamp(&asset, i) ? asset.is_of_lamps : is_of_others)[asset.instances[i].material] = true;
    for (size_t i = 0; i < is_of_others.size(); i++) asset.is_of_lamps[i] = asset.is_of_lamps[i] && !is_of_others[i];
}

hemi_result gltf_asset_read(const char *path, gltf_asset **out, char message[GLTF_MESSAGE_SIZE]) {
    return gltf_asset_read_within(path, nullptr, out, message);
}

hemi_result gltf_asset_read_within(const char *path, const gltf_limits *limits, gltf_asset **out,
                                   char message[GLTF_MESSAGE_SIZE]) {
    const char *broken = "the JSON does not have the shape of glTF; export the file again";
    if (out) *out = nullptr;
    return gltf_guarded(message, "read the asset", broken, [&] {
        if (!out || !path) gltf_fail(HEMI_ERROR_ARGUMENT, "no path or no place for the asset");
        auto asset = std::make_unique<gltf_asset>();
        gltf_load(*asset, path, limits ? *limits : gltf_limits());
        gltf_walk_scene(*asset, limits ? *limits : gltf_limits());
        gltf_count_mesh_copies(*asset);
        find_materials_of_lamps(*asset);
        gltf_gather_notes(*asset);
        *out = asset.release();
    });
}

void gltf_asset_destroy(gltf_asset *asset) {
    delete asset;
}

uint32_t gltf_asset_mesh_count(const gltf_asset *asset) {
    return uint32_t(asset->instances.size());
}

static const float *pointer_or_null(const std::vector<float> &values) {
    return values.empty() ? nullptr : values.data();
}

bool gltf_asset_mesh(const gltf_asset *asset, uint32_t mesh, hemi_mesh_desc *out) {
    if (mesh >= asset->instances.size()) return false;
    const gltf_instance &instance = asset->instances[mesh];
    const gltf_geometry &geometry = *instance.geometry;
    *out = hemi_mesh_desc{};
    out->struct_size = sizeof *out;
    out->name = instance.name;
    out->positions = geometry.positions.data();
    out->normals = pointer_or_null(geometry.normals);
    out->attributes = pointer_or_null(geometry.attributes);
    out->attribute_count = geometry.attribute_count;
    out->vertex_count = geometry.vertex_count;
    out->indices = geometry.indices.data();
    out->triangle_count = uint32_t(geometry.indices.size() / 3);
    out->material = instance.material;
    for (int i = 0; i < 16; i++) out->transform[i] = instance.world[i];
    out->subdivision = instance.subdivision.struct_size ? &instance.subdivision : nullptr;
    out->keep_vertices = instance.posed;
    out->detail_group = uint32_t(instance.level.owner + 1);
    out->detail_level = uint32_t(instance.level.number);
    return true;
}

bool gltf_asset_mesh_level_is_auto(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() && asset->instances[mesh].cage && asset->instances[mesh].cage->level_is_auto;
}

bool gltf_asset_mesh_is_lamp(const gltf_asset *asset, uint32_t mesh) {
    if (mesh >= asset->instances.size()) return false;
    const tinygltf::Value &extras = asset->model.nodes[size_t(asset->instances[mesh].node)].extras;
    return extras.IsObject() && extras.Has("hemibake_lamp") && extras.Get("hemibake_lamp").IsBool() &&
           extras.Get("hemibake_lamp").Get<bool>();
}

uint32_t gltf_asset_mesh_original(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() ? asset->instances[mesh].original : mesh;
}

const float *gltf_asset_mesh_radiosity(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() ? pointer_or_null(asset->instances[mesh].geometry->radiosity) : nullptr;
}

const float *gltf_asset_mesh_color(const gltf_asset *asset, uint32_t mesh) {
    return mesh < asset->instances.size() ? pointer_or_null(asset->instances[mesh].geometry->colors) : nullptr;
}

uint32_t gltf_asset_camera_count(const gltf_asset *asset) {
    return uint32_t(asset->cameras.size());
}

bool gltf_asset_camera(const gltf_asset *asset, uint32_t index, gltf_camera *out) {
    if (index >= asset->cameras.size()) return false;
    *out = asset->cameras[index];
    return true;
}
