/* SPDX-License-Identifier: MIT
 * How does the baked asset become the bytes of a .glb, or of a .gltf and its .bin?
 */
#include "gltf_model.h"

#include "gltf_container.h"
#include "gltf_json.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>

/* ---- which extensions are still used ---------------------------------------------------------------------------- */

static bool any_material_has(const tinygltf::Model &model, const std::string &name) {
    return std::any_of(model.materials.begin(), model.materials.end(),
                       [&](const tinygltf::Material &material) { return material.extensions.count(name) > 0; });
}

template <typename Test> static bool any_primitive(const tinygltf::Model &model, Test test) {
    for (const tinygltf::Mesh &mesh : model.meshes)
        for (const tinygltf::Primitive &primitive : mesh.primitives)
            if (test(primitive)) return true;
    return false;
}

static bool uses_draco(const tinygltf::Primitive &primitive) {
    return primitive.extensions.count("KHR_draco_mesh_compression") > 0;
}

/* Whether an attribute has a component type that only KHR_mesh_quantization allows. */
static bool is_quantized(const tinygltf::Model &model, const std::string &name, int index) {
    const tinygltf::Accessor &accessor = model.accessors[size_t(index)];
    bool floating = accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (name == "POSITION" || name == "NORMAL" || name == "TANGENT") return !floating;
    if (name.compare(0, 9, "TEXCOORD_") != 0) return false;
    bool plain = accessor.normalized && (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                         accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
    return !floating && !plain;
}

static bool uses_quantization(const tinygltf::Model &model, const tinygltf::Primitive &primitive) {
    for (const auto &[name, index] : primitive.attributes)
        if (is_quantized(model, name, index)) return true;
    for (const auto &target : primitive.targets)
        for (const auto &[name, index] : target)
            if (is_quantized(model, name, index)) return true;
    return false;
}

static bool is_unused(const tinygltf::Model &model, const std::string &name) {
    if (name == "KHR_draco_mesh_compression") return !any_primitive(model, uses_draco);
    if (name == "KHR_mesh_quantization")
        return !any_primitive(model, [&model](const auto &primitive) { return uses_quantization(model, primitive); });
    if (name == "FB_ngon_encoding")
        return !any_primitive(model, [&name](const auto &primitive) { return primitive.extensions.count(name) > 0; });
    if (name == "KHR_materials_variants")
        return !any_primitive(model, [&name](const auto &primitive) { return primitive.extensions.count(name) > 0; }) &&
               model.extensions.count(name) == 0;
    if (name == "EXT_mesh_gpu_instancing")
        return std::none_of(model.nodes.begin(), model.nodes.end(),
                            [&name](const tinygltf::Node &node) { return node.extensions.count(name) > 0; });
    if (name == "EXT_meshopt_compression") return true; /* what it packed is written unpacked */
    return name.compare(0, 14, "KHR_materials_") == 0 && !any_material_has(model, name);
}

static void add_once(std::vector<std::string> &names, const char *name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

static void update_extensions(tinygltf::Model &model) {
    for (std::vector<std::string> *names : { &model.extensionsUsed, &model.extensionsRequired })
        names->erase(std::remove_if(names->begin(), names->end(),
                                    [&model](const std::string &name) { return is_unused(model, name); }),
                     names->end());
    if (any_material_has(model, "KHR_materials_unlit")) add_once(model.extensionsUsed, "KHR_materials_unlit");
    if (!any_primitive(model, uses_draco)) return;
    add_once(model.extensionsUsed, "KHR_draco_mesh_compression");
    add_once(model.extensionsRequired, "KHR_draco_mesh_compression");
}

/* ---- serialising ---------------------------------------------------------------------------------------------- */

using text_owner = std::unique_ptr<char, decltype(&free)>;

/* tinygltf's JSON. It writes a GLB without binary chunk, from which the text is taken. */
static std::string model_json(tinygltf::Model &model) {
    tinygltf::TinyGLTF writer;
    writer.SetImageWriter(nullptr, nullptr); /* images are in buffer views, or keep their uri */
    std::ostringstream stream;
    if (!writer.WriteGltfSceneToStream(&model, stream, false, true))
        gltf_fail(HEMI_ERROR_MEMORY, "the model cannot be serialised");
    std::string glb = stream.str();
    gltf_chunks chunks;
    char message[GLTF_MESSAGE_SIZE] = "";
    hemi_result result =
        gltf_container_split(reinterpret_cast<const uint8_t *>(glb.data()), glb.size(), &chunks, message);
    if (result != HEMI_OK) gltf_fail(result, "the model was serialised wrongly: %s", message);
    return std::string(reinterpret_cast<const char *>(chunks.json), chunks.json_size);
}

static text_owner mended_json(gltf_draft &draft, const gltf_write_desc &desc, size_t buffer_length) {
    std::string json = model_json(draft.model);
    gltf_json_mend mend = {};
    mend.original = draft.asset.json.c_str();
    mend.buffer_length = buffer_length;
    mend.buffer_uri = desc.binary ? nullptr : desc.bin_name ? desc.bin_name : "scene.bin";
    mend.extras_json = desc.extras_json;
    mend.pretty = !desc.binary;
    char *text = nullptr, message[GLTF_MESSAGE_SIZE] = "the JSON cannot be mended";
    hemi_result result = gltf_json_after_write(json.data(), json.size(), &mend, &text, message);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    return text_owner(text, free);
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
    size_t bin_size = gltf_rebuild(draft);
    update_extensions(draft.model);
    if (desc.generator) draft.model.asset.generator = desc.generator;
    text_owner json = mended_json(draft, desc, bin_size);
    fill_output(draft, desc, json.get(), bin_size, out);
}

static hemi_result report(hemi_result code, const char *text, gltf_output *out, char *message) {
    gltf_output_free(out);
    if (message) snprintf(message, GLTF_MESSAGE_SIZE, "%s", text);
    return code;
}

hemi_result gltf_asset_write(const gltf_asset *asset, const gltf_write_desc *desc, gltf_output *out,
                             char message[GLTF_MESSAGE_SIZE]) {
    if (message) message[0] = '\0';
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = gltf_output{};
    if (!asset || !desc) return report(HEMI_ERROR_ARGUMENT, "no asset or no description", out, message);
    try {
        write_asset(*asset, *desc, *out);
        return HEMI_OK;
    } catch (const gltf_failure &failure) {
        return report(failure.code, failure.text.c_str(), out, message);
    } catch (const std::bad_alloc &) {
        return report(HEMI_ERROR_MEMORY, "not enough memory to write the asset", out, message);
    } catch (const std::exception &) {
        return report(HEMI_ERROR_DATA, "a name or text in the asset is not UTF-8", out, message);
    }
}

void gltf_output_free(gltf_output *output) {
    if (!output) return;
    free(output->main);
    free(output->bin);
    *output = gltf_output{};
}
