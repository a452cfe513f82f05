/* SPDX-License-Identifier: MIT
 * How does the baked asset become the bytes of a .glb, or of a .gltf and its .bin?
 */
#include "gltf_guarded.h"
#include "gltf_model.h"

#include "gltf_container.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

/* ---- which extensions are still used ---------------------------------------------------------------------------- */

static bool any_element_has(const gltf_draft &draft, gltf_list_kind list, const char *extension) {
    const std::vector<cJSON *> &elements = draft.lists[list];
    return std::any_of(elements.begin(), elements.end(),
                       [extension](const cJSON *element) { return gltf_extension(element, extension) != nullptr; });
}

template <typename Test> static bool any_primitive(const gltf_draft &draft, Test test) {
    for (const cJSON *mesh : draft.lists[gltf_meshes])
        for (const cJSON *primitive : gltf_elements(gltf_member(mesh, "primitives")))
            if (test(primitive)) return true;
    return false;
}

static bool any_primitive_has(const gltf_draft &draft, const char *extension) {
    return any_primitive(draft, [extension](const cJSON *primitive) { return gltf_extension(primitive, extension); });
}

/* Whether an attribute has a component type that only KHR_mesh_quantization allows. */
static bool is_quantized(const gltf_draft &draft, const cJSON *attribute) {
    const std::string name = attribute->string;
    const cJSON *accessor = draft.lists[gltf_accessors][size_t(attribute->valueint)];
    int type = gltf_index(accessor, "componentType");
    bool floating = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (name == "POSITION" || name == "NORMAL" || name == "TANGENT") return !floating;
    if (name.compare(0, 9, "TEXCOORD_") != 0) return false;
    bool plain = cJSON_IsTrue(gltf_member(accessor, "normalized")) &&
                 (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
    return !floating && !plain;
}

static bool uses_quantization(const gltf_draft &draft, const cJSON *primitive) {
    std::vector<cJSON *> dictionaries = gltf_elements(gltf_member(primitive, "targets"));
    dictionaries.push_back(gltf_member(primitive, "attributes"));
    for (const cJSON *dictionary : dictionaries)
        for (const cJSON *attribute : gltf_elements(dictionary))
            if (is_quantized(draft, attribute)) return true;
    return false;
}

static bool is_unused(const gltf_draft &draft, const std::string &name) {
    const char *extension = name.c_str();
    if (name == "KHR_draco_mesh_compression" || name == "FB_ngon_encoding") return !any_primitive_has(draft, extension);
    if (name == "KHR_mesh_quantization")
        return !any_primitive(draft, [&](const cJSON *primitive) { return uses_quantization(draft, primitive); });
    if (name == "KHR_materials_variants")
        return !any_primitive_has(draft, extension) && !gltf_extension(draft.document.get(), extension);
    if (name == "EXT_mesh_gpu_instancing") return !any_element_has(draft, gltf_nodes, extension);
    if (name == "KHR_lights_punctual") /* dropped, if there were lights */
        return !draft.asset.model.lights.empty() && !gltf_extension(draft.document.get(), extension);
    if (name == "EXT_lights_ies")
        return !draft.asset.profiles.empty() && !gltf_extension(draft.document.get(), extension);
    if (name == "EXT_meshopt_compression") return true; /* what it packed is written unpacked */
    return name.compare(0, 14, "KHR_materials_") == 0 && !any_element_has(draft, gltf_materials, extension);
}

static void set_names(cJSON *root, const char *list, const std::vector<std::string> &names) {
    if (names.empty()) {
        gltf_drop(root, list);
        return;
    }
    gltf_set(root, list, gltf_json(cJSON_CreateArray()));
    for (const std::string &name : names)
        gltf_append(gltf_member(root, list), gltf_json(cJSON_CreateString(name.c_str())));
}

static void add_once(std::vector<std::string> &names, const char *name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

static void update_extensions(gltf_draft &draft) {
    std::vector<std::string> used = draft.asset.model.extensionsUsed, required = draft.asset.model.extensionsRequired;
    for (std::vector<std::string> *names : { &used, &required })
        names->erase(std::remove_if(names->begin(), names->end(),
                                    [&draft](const std::string &name) { return is_unused(draft, name); }),
                     names->end());
    if (any_element_has(draft, gltf_materials, "KHR_materials_unlit")) add_once(used, "KHR_materials_unlit");
    if (any_primitive_has(draft, "KHR_draco_mesh_compression")) {
        add_once(used, "KHR_draco_mesh_compression");
        add_once(required, "KHR_draco_mesh_compression");
    }
    if (gltf_extension(draft.document.get(), "KHR_lights_punctual")) add_once(used, "KHR_lights_punctual");
    set_names(draft.document.get(), "extensionsUsed", used);
    set_names(draft.document.get(), "extensionsRequired", required);
}

static void drop_lights(gltf_draft &draft) {
    for (const char *extension : { "KHR_lights_punctual", "EXT_lights_ies" }) {
        for (cJSON *node : draft.lists[gltf_nodes]) gltf_drop_extension(node, extension);
        gltf_drop_extension(draft.document.get(), extension);
    }
    for (cJSON *node : draft.lists[gltf_nodes]) {
        cJSON *extras = gltf_member(node, "extras");
        if (extras) gltf_drop(extras, "hemibake_places");
    }
}

/* ---- serialising ------------------------------------------------------------------------------------------------ */

static void add_extras(cJSON *root, const char *text) {
    gltf_json value(cJSON_Parse(text));
    if (!value) gltf_fail(HEMI_ERROR_ARGUMENT, "the text for asset.extras.hemibake is not JSON");
    cJSON *extras = gltf_object(gltf_member(root, "asset"), "extras");
    gltf_drop(extras, "hemibake");
    gltf_set(extras, "hemibake", std::move(value));
}

/* One buffer holds everything; the name and extras of a single one before it are kept. uri NULL: the binary chunk. */
static void set_buffer(cJSON *root, size_t length, const char *uri) {
    const cJSON *old = gltf_member(root, "buffers");
    gltf_json buffer = cJSON_GetArraySize(old) == 1 ? gltf_copy(old->child) : gltf_json(cJSON_CreateObject());
    gltf_drop(root, "buffers");
    if (length == 0) return;
    gltf_drop(buffer.get(), "uri");
    gltf_drop_extension(buffer.get(), "EXT_meshopt_compression");
    gltf_drop(buffer.get(), "byteLength");
    gltf_set_number(buffer.get(), "byteLength", double(length));
    if (uri) gltf_set_text(buffer.get(), "uri", uri);
    gltf_append(gltf_list(root, "buffers"), std::move(buffer));
}

using text_owner = std::unique_ptr<char, decltype(&cJSON_free)>;

static text_owner print_document(gltf_draft &draft, const gltf_write_desc &desc, size_t buffer_length) {
    cJSON *root = draft.document.get();
    const char *name = desc.bin_name ? desc.bin_name : "scene.bin";
    if (desc.generator) gltf_set_text(gltf_member(root, "asset"), "generator", desc.generator);
    set_buffer(root, buffer_length, desc.binary ? nullptr : name);
    if (desc.extras_json) add_extras(root, desc.extras_json);
    text_owner text(desc.binary ? cJSON_PrintUnformatted(root) : cJSON_Print(root), cJSON_free);
    if (!text) throw std::bad_alloc();
    return text;
}

static uint8_t *copy_bytes(const void *data, size_t size) {
    uint8_t *copy = static_cast<uint8_t *>(malloc(size));
    if (!copy) throw std::bad_alloc();
    std::memcpy(copy, data, size);
    return copy;
}

static void fill_output(const gltf_draft &draft, const gltf_write_desc &desc, const char *json, size_t bin_size,
                        gltf_output &out) {
    out = draft.stats;
    size_t length = std::strlen(json);
    if (desc.binary) {
        uint8_t *bin = nullptr;
        hemi_result result = gltf_container_join(json, length, bin_size, &out.main, &out.main_size, &bin);
        if (result != HEMI_OK) gltf_fail(result, "a .glb holds at most 4 GiB; write a .gltf");
        if (bin) gltf_copy_views(draft, bin);
        return;
    }
    out.main = copy_bytes(json, length);
    out.main_size = length;
    if (bin_size == 0) return;
    out.bin = static_cast<uint8_t *>(malloc(bin_size));
    if (!out.bin) throw std::bad_alloc();
    out.bin_size = bin_size;
    gltf_copy_views(draft, out.bin);
}

static void check_desc(const gltf_asset &asset, const gltf_write_desc &desc) {
    if (desc.mesh_count != asset.instances.size() || (desc.mesh_count && !desc.meshes))
        gltf_fail(HEMI_ERROR_ARGUMENT, "%u baked meshes for an asset of %zu", desc.mesh_count, asset.instances.size());
    bool bits = true;
    for (int value : desc.draco_bits) bits = bits && value >= 0 && value <= 30;
    if (desc.draco && (!bits || desc.draco_level < 0 || desc.draco_level > 10))
        gltf_fail(HEMI_ERROR_ARGUMENT, "the Draco level must be 0 to 10 and its bits 1 to 30");
}

static void write_asset(const gltf_asset &asset, const gltf_write_desc &desc, gltf_output &out) {
    check_desc(asset, desc);
    gltf_draft draft(asset);
    gltf_apply_bake(draft, desc);
    size_t bin_size = gltf_compact(draft);
    if (desc.drop_lights) drop_lights(draft);
    update_extensions(draft);
    text_owner json = print_document(draft, desc, bin_size);
    fill_output(draft, desc, json.get(), bin_size, out);
}

hemi_result gltf_asset_write(const gltf_asset *asset, const gltf_write_desc *desc, gltf_output *out,
                             char message[GLTF_MESSAGE_SIZE]) {
    if (message) message[0] = '\0';
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = gltf_output{};
    hemi_result result = gltf_guarded(message, "write the asset", "a name or text in the asset is not UTF-8", [&] {
        if (!asset || !desc) gltf_fail(HEMI_ERROR_ARGUMENT, "no asset or no description");
        write_asset(*asset, *desc, *out);
    });
    if (result != HEMI_OK) gltf_output_free(out);
    return result;
}

void gltf_output_free(gltf_output *output) {
    if (!output) return;
    free(output->main);
    free(output->bin);
    *output = gltf_output{};
}
