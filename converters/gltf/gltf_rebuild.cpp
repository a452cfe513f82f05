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

/* Any member `bufferView` below an extension of the root (audio, metadata, ...). */
static void visit_value_views(tinygltf::Value &value, const index_visitor &visit) {
    visit_member(value, "bufferView", visit);
    if (value.IsObject())
        for (auto &member : value.Get<tinygltf::Value::Object>()) visit_value_views(member.second, visit);
    if (value.IsArray())
        for (tinygltf::Value &element : value.Get<tinygltf::Value::Array>()) visit_value_views(element, visit);
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
    for (auto &extension : model.extensions) visit_value_views(extension.second, visit);
}

/* ---- images --------------------------------------------------------------------------------------------------- */

/* By their first bytes; what is not known keeps the type the asset gave. */
static std::string media_type(const std::vector<unsigned char> &bytes, const std::string &given) {
    auto begins = [&bytes](const char *magic, size_t size, size_t at) {
        return bytes.size() >= at + size && std::memcmp(bytes.data() + at, magic, size) == 0;
    };
    if (begins("\x89PNG", 4, 0)) return "image/png";
    if (begins("\xFF\xD8\xFF", 3, 0)) return "image/jpeg";
    if (begins("RIFF", 4, 0) && begins("WEBP", 4, 8)) return "image/webp";
    if (begins("\xABKTX 20\xBB", 8, 0)) return "image/ktx2";
    if (begins("DDS ", 4, 0)) return "image/vnd-ms.dds";
    if (begins("ftypavif", 8, 4)) return "image/avif";
    return given.empty() ? "application/octet-stream" : given;
}

static void pack_images(gltf_draft &draft) {
    for (size_t i = 0; i < draft.model.images.size(); i++) {
        tinygltf::Image &image = draft.model.images[i];
        const std::vector<unsigned char> &bytes = draft.asset.images[i];
        if (image.bufferView >= 0 || bytes.empty()) continue;
        image.uri.clear();
        image.mimeType = media_type(bytes, image.mimeType);
        image.bufferView = gltf_add_view(draft, bytes, 0);
    }
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

/* Marks what visit_all names, keeps those of list in their order, and renames. */
template <typename T, typename VisitAll> static std::vector<size_t> compact(std::vector<T> &list, VisitAll visit_all) {
    std::vector<int> moved(list.size(), -1);
    auto in_list = [&moved](int i) { return i >= 0 && size_t(i) < moved.size(); };
    visit_all([&](int &index) {
        if (in_list(index)) moved[size_t(index)] = 0;
    });
    std::vector<size_t> kept;
    std::vector<T> result;
    for (size_t i = 0; i < list.size(); i++) {
        if (moved[i] < 0) continue;
        moved[i] = int(kept.size());
        kept.push_back(i);
        result.push_back(std::move(list[i]));
    }
    visit_all([&](int &index) {
        if (in_list(index)) index = moved[size_t(index)];
    });
    list = std::move(result);
    return kept;
}

/* Copies the bytes behind each kept view; views begin at multiples of four, which suits every component type. */
static std::vector<unsigned char> gather_bytes(gltf_draft &draft, const std::vector<size_t> &kept) {
    std::vector<unsigned char> bytes;
    size_t originals = draft.asset.model.bufferViews.size();
    for (size_t i = 0; i < kept.size(); i++) {
        tinygltf::BufferView &view = draft.model.bufferViews[i];
        const unsigned char *from = kept[i] >= originals
                                        ? draft.fresh[kept[i] - originals].data()
                                        : draft.asset.buffers[size_t(view.buffer)].data() + view.byteOffset;
        bytes.resize((bytes.size() + 3) & ~size_t(3));
        view.buffer = 0;
        view.byteOffset = bytes.size();
        bytes.insert(bytes.end(), from, from + view.byteLength);
    }
    return bytes;
}

std::vector<unsigned char> gltf_rebuild(gltf_draft &draft) {
    tinygltf::Model &model = draft.model;
    pack_images(draft);
    compact(model.accessors, [&model](const index_visitor &visit) { visit_accessors(model, visit); });
    std::vector<size_t> kept =
        compact(model.bufferViews, [&model](const index_visitor &visit) { visit_views(model, visit); });
    std::vector<unsigned char> bytes = gather_bytes(draft, kept);
    model.buffers.clear();
    if (!bytes.empty()) model.buffers.emplace_back();
    return bytes;
}
