/* SPDX-License-Identifier: MIT
 * The C functions that hand out what was read. Exceptions end here.
 */
#include "gltf_model.h"

#include <cstdio>
#include <new>

static hemi_result report(hemi_result code, const char *text, char *message) {
    if (message) snprintf(message, GLTF_MESSAGE_SIZE, "%s", text);
    return code;
}

static hemi_result read_guarded(const char *path, std::unique_ptr<gltf_asset> &asset, char *message) {
    try {
        asset = std::make_unique<gltf_asset>();
        gltf_load(*asset, path);
        gltf_check(*asset);
        gltf_walk_scene(*asset);
        return HEMI_OK;
    } catch (const gltf_failure &failure) {
        return report(failure.code, failure.text.c_str(), message);
    } catch (const std::bad_alloc &) {
        return report(HEMI_ERROR_MEMORY, "not enough memory to read the asset", message);
    } catch (const std::exception &) {
        return report(HEMI_ERROR_DATA, "the JSON does not have the shape of glTF; export the file again", message);
    }
}

hemi_result gltf_asset_read(const char *path, gltf_asset **out, char message[GLTF_MESSAGE_SIZE]) {
    if (message) message[0] = '\0';
    if (!out || !path) return report(HEMI_ERROR_ARGUMENT, "no path or no place for the asset", message);
    std::unique_ptr<gltf_asset> asset;
    hemi_result result = read_guarded(path, asset, message);
    *out = result == HEMI_OK ? asset.release() : nullptr;
    return result;
}

void gltf_asset_destroy(gltf_asset *asset) {
    delete asset;
}

const char *gltf_asset_scene_name(const gltf_asset *asset) {
    return asset->scene >= 0 ? asset->model.scenes[size_t(asset->scene)].name.c_str() : "";
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
    return true;
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

size_t gltf_asset_skipped_count(const gltf_asset *asset) {
    return asset->skipped.size();
}

const char *gltf_asset_skipped(const gltf_asset *asset, size_t index) {
    return index < asset->skipped.size() ? asset->skipped[index].c_str() : nullptr;
}

uint32_t gltf_asset_camera_count(const gltf_asset *asset) {
    return uint32_t(asset->cameras.size());
}

bool gltf_asset_camera(const gltf_asset *asset, uint32_t index, gltf_camera *out) {
    if (index >= asset->cameras.size()) return false;
    *out = asset->cameras[index];
    return true;
}
