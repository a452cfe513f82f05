/* SPDX-License-Identifier: MIT
 * What does the output still refer to, and under which number? Geometry that was replaced must not stay in the file:
 * accessors and buffer views that nothing names go, the rest is renumbered and copied into one buffer.
 */
#include "gltf_model.h"

#include <cstring>
#include <functional>

using index_visitor = std::function<void(int &)>;

/* ---- who names an accessor, who a buffer view ---------------------------------------------------------------------
 */

static void visit_member(tinygltf::Value &object, const char *name, const index_visitor &visit) {
    if (!object.Has(name) || !object.Get(name).IsInt()) return;
    int index = object.Get(name).Get<int>();
    visit(index);
    object.Get<tinygltf::Value::Object>()[name] = tinygltf::Value(index);
}

static void visit_instancing(tinygltf::Node &node, const index_visitor &visit) {
    auto found = node.extensions.find("EXT_mesh_gpu_instancing");
    if (found == node.extensions.end() || !found->second.Has("attributes")) return;
    tinygltf::Value &attributes = found->second.Get<tinygltf::Value::Object>()["attributes"];
    for (const std::string &name : attributes.Keys()) visit_member(attributes, name.c_str(), visit);
}

static void visit_accessors(tinygltf::Model &model, const index_visitor &visit) {
    for (tinygltf::Mesh &mesh : model.meshes)
        for (tinygltf::Primitive &primitive : mesh.primitives) {
            if (primitive.indices >= 0) visit(primitive.indices);
            for (auto &attribute : primitive.attributes) visit(attribute.second);
            for (auto &target : primitive.targets)
                for (auto &attribute : target) visit(attribute.second);
        }
    for (tinygltf::Animation &animation : model.animations)
        for (tinygltf::AnimationSampler &sampler : animation.samplers) {
            visit(sampler.input);
            visit(sampler.output);
        }
    for (tinygltf::Skin &skin : model.skins)
        if (skin.inverseBindMatrices >= 0) visit(skin.inverseBindMatrices);
    for (tinygltf::Node &node : model.nodes) visit_instancing(node, visit);
}

static void visit_views(tinygltf::Model &model, const index_visitor &visit) {
    for (tinygltf::Accessor &accessor : model.accessors) {
        if (accessor.bufferView >= 0) visit(accessor.bufferView);
        if (!accessor.sparse.isSparse) continue;
        visit(accessor.sparse.indices.bufferView);
        visit(accessor.sparse.values.bufferView);
    }
    for (tinygltf::Image &image : model.images)
        if (image.bufferView >= 0) visit(image.bufferView);
    for (tinygltf::Mesh &mesh : model.meshes)
        for (tinygltf::Primitive &primitive : mesh.primitives) {
            auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
            if (draco != primitive.extensions.end()) visit_member(draco->second, "bufferView", visit);
        }
}

/* ---- who names a texture, an image, a sampler ----------------------------------------------------------------------
 */

/* Any member called ...Texture below an extension of a material: all ratified ones are texture infos. */
static void visit_texture_infos(tinygltf::Value &value, const index_visitor &visit) {
    static const std::string end = "Texture";
    if (value.IsArray())
        for (tinygltf::Value &element : value.Get<tinygltf::Value::Array>()) visit_texture_infos(element, visit);
    if (!value.IsObject()) return;
    for (auto &member : value.Get<tinygltf::Value::Object>()) {
        const std::string &name = member.first;
        bool info = name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
        if (info) visit_member(member.second, "index", visit);
        visit_texture_infos(member.second, visit);
    }
}

static void visit_textures(tinygltf::Model &model, const index_visitor &visit) {
    for (tinygltf::Material &material : model.materials) {
        int *const infos[] = { &material.pbrMetallicRoughness.baseColorTexture.index,
                               &material.pbrMetallicRoughness.metallicRoughnessTexture.index,
                               &material.normalTexture.index, &material.occlusionTexture.index,
                               &material.emissiveTexture.index };
        for (int *index : infos)
            if (*index >= 0) visit(*index);
        for (auto &extension : material.extensions) visit_texture_infos(extension.second, visit);
    }
}

static void visit_images(tinygltf::Model &model, const index_visitor &visit) {
    for (tinygltf::Texture &texture : model.textures) {
        if (texture.source >= 0) visit(texture.source);
        for (auto &extension : texture.extensions)
            visit_member(extension.second, "source", visit); /* webp, basisu, ... */
    }
}

static void visit_samplers(tinygltf::Model &model, const index_visitor &visit) {
    for (tinygltf::Texture &texture : model.textures)
        if (texture.sampler >= 0) visit(texture.sampler);
}

/* ---- images --------------------------------------------------------------------------------------------------- */

static void pack_images(gltf_draft &draft) {
    for (size_t i = 0; i < draft.model.images.size(); i++) {
        tinygltf::Image &image = draft.model.images[i];
        const std::vector<unsigned char> &bytes = draft.asset.images[size_t(image.extras.GetNumberAsInt())];
        if (image.bufferView >= 0 || bytes.empty()) continue;
        image.uri.clear();
        image.mimeType = gltf_media_type(bytes.data(), bytes.size(), image.mimeType);
        image.bufferView = gltf_add_view(draft, bytes, 0);
    }
}

/* ---- where elements came from --------------------------------------------------------------------------------------
 */

template <typename T> static void number(std::vector<T> &list) {
    for (size_t i = 0; i < list.size(); i++) list[i].extras = tinygltf::Value(int(i));
}

/* Extensions whose indices the visitors above know, beside KHR_materials_*. */
static bool is_understood(const std::string &name) {
    static const char *const known[] = { "KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_texture_transform",
                                         "KHR_lights_punctual",        "KHR_texture_basisu",    "KHR_xmp_json_ld",
                                         "EXT_mesh_gpu_instancing",    "EXT_texture_webp",      "EXT_texture_avif",
                                         "EXT_meshopt_compression",    "MSFT_texture_dds",      "FB_ngon_encoding" };
    for (const char *extension : known)
        if (name == extension) return true;
    return name.compare(0, 14, "KHR_materials_") == 0;
}

gltf_draft::gltf_draft(const gltf_asset &source) : asset(source), model(source.model) {
    number(model.accessors);
    number(model.bufferViews);
    number(model.nodes);
    number(model.materials);
    number(model.textures);
    number(model.images);
    number(model.samplers);
    number(model.meshes);
    for (tinygltf::Mesh &mesh : model.meshes) number(mesh.primitives);
    for (tinygltf::Animation &animation : model.animations) /* tinygltf leaves out those without channels it knows */
        if (animation.channels.empty()) animation.channels.emplace_back();
    for (const std::string &name : model.extensionsUsed) keeps_numbers = keeps_numbers || !is_understood(name);
}

/* ---- adding, dropping, renumbering ------------------------------------------------------------------------------- */

int gltf_add_view(gltf_draft &draft, std::vector<unsigned char> bytes, int target) {
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteLength = bytes.size();
    view.target = target;
    draft.fresh.push_back(std::move(bytes));
    draft.model.bufferViews.push_back(view);
    return int(draft.model.bufferViews.size()) - 1;
}

int gltf_add_accessor(gltf_draft &draft, int view, int component_type, int type, size_t count) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    draft.model.accessors.push_back(accessor);
    return int(draft.model.accessors.size()) - 1;
}

using visit_all = void (*)(tinygltf::Model &, const index_visitor &);

static std::vector<char> named_by(tinygltf::Model &model, visit_all visit, size_t size) {
    std::vector<char> named(size, 0);
    visit(model, [&named](int &index) {
        if (index >= 0 && size_t(index) < named.size()) named[size_t(index)] = 1;
    });
    return named;
}

/* Drops from list what the bake left without a user, and renumbers the rest; which elements stay. What nobody named
 * before either is none of our business and stays. */
template <typename T>
static std::vector<size_t> compact(gltf_draft &draft, tinygltf::Model &before, std::vector<T> &list, visit_all visit) {
    std::vector<char> named = named_by(draft.model, visit, list.size()),
                      was_named = named_by(before, visit, list.size());
    std::vector<int> moved(list.size(), -1);
    std::vector<size_t> kept;
    std::vector<T> result;
    for (size_t i = 0; i < list.size(); i++) {
        if (!named[i] && was_named[i] && !draft.keeps_numbers) continue;
        moved[i] = int(kept.size());
        kept.push_back(i);
        result.push_back(std::move(list[i]));
    }
    visit(draft.model, [&moved](int &index) {
        if (index >= 0 && size_t(index) < moved.size()) index = moved[size_t(index)];
    });
    list = std::move(result);
    return kept;
}

/* Views begin at multiples of four, which suits every component type. */
static size_t place_views(gltf_draft &draft, const std::vector<size_t> &kept) {
    size_t originals = draft.asset.model.bufferViews.size(), size = 0;
    for (size_t i = 0; i < kept.size(); i++) {
        tinygltf::BufferView &view = draft.model.bufferViews[i];
        draft.bytes.push_back(kept[i] >= originals ? draft.fresh[kept[i] - originals].data()
                                                   : draft.asset.buffers[size_t(view.buffer)].data() + view.byteOffset);
        size = (size + 3) & ~size_t(3);
        view.buffer = 0;
        view.byteOffset = size;
        size += view.byteLength;
    }
    return size;
}

void gltf_copy_views(const gltf_draft &draft, unsigned char *to) {
    size_t end = 0;
    for (size_t i = 0; i < draft.bytes.size(); i++) {
        const tinygltf::BufferView &view = draft.model.bufferViews[i];
        std::memset(to + end, 0, view.byteOffset - end);
        std::memcpy(to + view.byteOffset, draft.bytes[i], view.byteLength);
        end = view.byteOffset + view.byteLength;
    }
}

size_t gltf_rebuild(gltf_draft &draft) {
    tinygltf::Model &model = draft.model, before = draft.asset.model;
    compact(draft, before, model.textures, visit_textures);
    compact(draft, before, model.images, visit_images);
    compact(draft, before, model.samplers, visit_samplers);
    pack_images(draft);
    compact(draft, before, model.accessors, visit_accessors);
    std::vector<size_t> kept = compact(draft, before, model.bufferViews, visit_views);
    size_t size = place_views(draft, kept);
    model.buffers.clear();
    if (size) model.buffers.emplace_back();
    return size;
}
