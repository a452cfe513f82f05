/* SPDX-License-Identifier: MIT
 * Does every index of the model point at something, every accessor stay in its buffer, every node have one parent?
 * After this the rest of the folder indexes without asking. tinygltf checks little of it; what the
 * document alone can tell is checked before (gltf_document_check.cpp).
 */
#include "gltf_model.h"

#include <cmath>

void gltf_check_index(int index, size_t count, const char *what, const std::string &where) {
    if (index >= 0 && size_t(index) < count) return;
    gltf_fail(HEMI_ERROR_DATA, "%s is %d, but there are %zu %s", where.c_str(), index, count, what);
}

static void check_optional(int index, size_t count, const char *what, const std::string &where) {
    if (index != -1) gltf_check_index(index, count, what, where);
}

static void check_required_extensions(const tinygltf::Model &model) {
    static const char *const known[] = { "KHR_draco_mesh_compression",
                                         "KHR_mesh_quantization",
                                         "KHR_texture_transform",
                                         "KHR_lights_punctual",
                                         "KHR_texture_basisu",
                                         "KHR_materials_variants",
                                         "EXT_mesh_gpu_instancing",
                                         "EXT_meshopt_compression",
                                         "EXT_texture_webp",
                                         "KHR_animation_pointer",
                                         "EXT_texture_avif",
                                         "MSFT_texture_dds",
                                         "KHR_node_visibility",
                                         "KHR_node_selectability",
                                         "KHR_node_hoverability",
                                         "KHR_xmp_json_ld",
                                         "EXT_lights_ies",
                                         "EXT_lights_image_based",
                                         "MSFT_lod",
                                         "FB_ngon_encoding",
                                         "EXT_mesh_features",
                                         "EXT_structural_metadata",
                                         "EXT_instance_features",
                                         "EXT_mesh_manifold" };
    for (const std::string &name : model.extensionsRequired) {
        bool found = name.compare(0, 14, "KHR_materials_") == 0;
        for (const char *extension : known) found = found || name == extension;
        if (!found)
            gltf_fail(HEMI_ERROR_UNSUPPORTED, "the asset requires the extension %.80s; export it without",
                      name.c_str());
    }
}

/* ---- buffers, accessors --------------------------------------------------------------------------------------- */

static void check_view(const gltf_asset &asset, size_t v) {
    const tinygltf::BufferView &view = asset.model.bufferViews[v];
    size_t size = asset.buffers[size_t(view.buffer)].size();
    if (view.byteOffset > size || view.byteLength > size - view.byteOffset || view.byteLength == 0)
        gltf_fail(HEMI_ERROR_DATA, "bufferViews[%zu] covers bytes %zu+%zu of a buffer of %zu", v, view.byteOffset,
                  view.byteLength, size);
}

/* elements of element bytes, stride apart, from offset on, within view. */
static void check_range(const gltf_asset &asset, int view, size_t offset, size_t count, size_t element, bool strided,
                        const std::string &where) {
    gltf_check_index(view, asset.model.bufferViews.size(), "bufferViews", where + ".bufferView");
    const tinygltf::BufferView &range = asset.model.bufferViews[size_t(view)];
    size_t stride = strided && range.byteStride ? range.byteStride : element;
    if (stride < element)
        gltf_fail(HEMI_ERROR_DATA, "%s: the byteStride %zu of bufferViews[%d] is smaller than an element of %zu bytes",
                  where.c_str(), stride, view, element);
    size_t length = range.byteLength;
    if (offset > length || element > length - offset || count - 1 > (length - offset - element) / stride)
        gltf_fail(HEMI_ERROR_DATA, "%s: %zu elements at offset %zu run past the end of bufferViews[%d]", where.c_str(),
                  count, offset, view);
}

static void check_sparse(const gltf_asset &asset, const tinygltf::Accessor &accessor, const std::string &where) {
    const auto &sparse = accessor.sparse;
    int type = sparse.indices.componentType;
    if (sparse.count < 1 || size_t(sparse.count) > accessor.count)
        gltf_fail(HEMI_ERROR_DATA, "%s.sparse.count is %d of %zu", where.c_str(), sparse.count, accessor.count);
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        gltf_fail(HEMI_ERROR_DATA, "%s.sparse.indices.componentType %d is not unsigned", where.c_str(), type);
    size_t index_size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(type))), count = size_t(sparse.count);
    check_range(asset, sparse.indices.bufferView, size_t(sparse.indices.byteOffset), count, index_size, false,
                where + ".sparse.indices");
    check_range(asset, sparse.values.bufferView, size_t(sparse.values.byteOffset), count, gltf_element_size(accessor),
                false, where + ".sparse.values");
}

static void check_accessor(const gltf_asset &asset, size_t a) {
    const tinygltf::Accessor &accessor = asset.model.accessors[a];
    std::string where = gltf_text("accessors[%zu]", a);
    if (accessor.count < 1) return; /* an empty primitive, which is none */
    if (accessor.bufferView != -1)
        check_range(asset, accessor.bufferView, accessor.byteOffset, accessor.count, gltf_element_size(accessor), true,
                    where);
    if (accessor.sparse.isSparse) check_sparse(asset, accessor, where);
}

/* ---- meshes, materials, textures ------------------------------------------------------------------------------- */

static void check_primitive(const tinygltf::Model &model, const tinygltf::Primitive &primitive,
                            const std::string &where) {
    size_t accessors = model.accessors.size();
    for (const auto &[name, accessor] : primitive.attributes)
        gltf_check_index(accessor, accessors, "accessors", where + ".attributes." + name.substr(0, 40));
    for (size_t t = 0; t < primitive.targets.size(); t++)
        for (const auto &[name, accessor] : primitive.targets[t])
            gltf_check_index(accessor, accessors, "accessors",
                             where + gltf_text(".targets[%zu].", t) + name.substr(0, 40));
    check_optional(primitive.indices, accessors, "accessors", where + ".indices");
    check_optional(primitive.material, model.materials.size(), "materials", where + ".material");
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        gltf_fail(HEMI_ERROR_DATA, "%s.mode is %d; glTF knows 0 to 6", where.c_str(), primitive.mode);
}

/* glTF's own limit is 1, which older exporters pass; radiance leaves a bake as float. */
static const double emission_max = 1e30;

static void check_material(gltf_asset &asset, size_t m) {
    tinygltf::Model &model = asset.model;
    tinygltf::Material &material = model.materials[m];
    const tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    std::string where = gltf_text("materials[%zu]", m);
    size_t textures = model.textures.size();
    check_optional(pbr.baseColorTexture.index, textures, "textures", where + ".pbrMetallicRoughness.baseColorTexture");
    check_optional(pbr.metallicRoughnessTexture.index, textures, "textures",
                   where + ".pbrMetallicRoughness.metallicRoughnessTexture");
    check_optional(material.normalTexture.index, textures, "textures", where + ".normalTexture");
    check_optional(material.occlusionTexture.index, textures, "textures", where + ".occlusionTexture");
    check_optional(material.emissiveTexture.index, textures, "textures", where + ".emissiveTexture");
    for (double &factor : material.emissiveFactor) {
        if (factor < 0) {
            gltf_note(asset, gltf_text("material %zu", m), "its emissiveFactor is negative, and counts as 0");
            factor = 0;
        }
        if (!(factor <= emission_max))
            gltf_fail(HEMI_ERROR_DATA, "%s.emissiveFactor is not three numbers from 0 to %g", where.c_str(),
                      emission_max);
    }
}

static void check_textures(const tinygltf::Model &model) {
    for (size_t i = 0; i < model.textures.size(); i++) {
        check_optional(model.textures[i].source, model.images.size(), "images", gltf_text("textures[%zu].source", i));
        check_optional(model.textures[i].sampler, model.samplers.size(), "samplers",
                       gltf_text("textures[%zu].sampler", i));
    }
    for (size_t i = 0; i < model.images.size(); i++)
        check_optional(model.images[i].bufferView, model.bufferViews.size(), "bufferViews",
                       gltf_text("images[%zu].bufferView", i));
}

/* ---- nodes ---------------------------------------------------------------------------------------------------- */

static void check_numbers(const std::vector<double> &numbers, size_t count, const std::string &where) {
    if (numbers.empty()) return;
    bool finite = true;
    for (double number : numbers) finite = finite && std::isfinite(number);
    if (numbers.size() != count || !finite)
        gltf_fail(HEMI_ERROR_DATA, "%s is not %zu finite numbers", where.c_str(), count);
}

static void check_node(gltf_asset &asset, size_t n) {
    const tinygltf::Model &model = asset.model;
    const tinygltf::Node &node = model.nodes[n];
    std::string where = gltf_text("nodes[%zu]", n);
    check_optional(node.mesh, model.meshes.size(), "meshes", where + ".mesh");
    check_optional(node.skin, model.skins.size(), "skins", where + ".skin");
    check_optional(node.camera, model.cameras.size(), "cameras", where + ".camera");
    check_numbers(node.matrix, 16, where + ".matrix");
    bool affine = true;
    for (size_t c = 0; c < 4 && !node.matrix.empty(); c++) /* exporters round */
        affine = affine && std::fabs(node.matrix[4 * c + 3] - (c == 3 ? 1 : 0)) <= 1e-6;
    if (!affine)
        gltf_note(asset, gltf_text("node %zu", n), "its matrix is not affine; its last row counts as 0, 0, 0, 1");
    check_numbers(node.translation, 3, where + ".translation");
    check_numbers(node.rotation, 4, where + ".rotation");
    check_numbers(node.scale, 3, where + ".scale");
}

/* Every node has at most one parent and no cycle: following parents from any node ends within nodes.size() steps. */
static void check_tree(const tinygltf::Model &model) {
    std::vector<int> parent(model.nodes.size(), -1);
    for (size_t n = 0; n < model.nodes.size(); n++)
        for (size_t c = 0; c < model.nodes[n].children.size(); c++) {
            std::string where = gltf_text("nodes[%zu].children[%zu]", n, c);
            int child = model.nodes[n].children[c];
            gltf_check_index(child, model.nodes.size(), "nodes", where);
            if (parent[size_t(child)] != -1)
                gltf_fail(HEMI_ERROR_DATA, "%s: node %d already has node %d as its parent", where.c_str(), child,
                          parent[size_t(child)]);
            parent[size_t(child)] = int(n);
        }
    std::vector<char> rooted(model.nodes.size(), 0);
    for (size_t n = 0; n < model.nodes.size(); n++) {
        std::vector<size_t> path;
        size_t at = n;
        while (!rooted[at] && parent[at] != -1 && path.size() < model.nodes.size()) {
            path.push_back(at);
            at = size_t(parent[at]);
        }
        if (!rooted[at] && parent[at] != -1)
            gltf_fail(HEMI_ERROR_DATA, "nodes[%zu].children: node %zu is its own ancestor", at, at);
        rooted[at] = 1;
        for (size_t step : path) rooted[step] = 1;
    }
    std::vector<char> listed;
    for (size_t s = 0; s < model.scenes.size(); s++) {
        listed.assign(model.nodes.size(), 0);
        for (size_t i = 0; i < model.scenes[s].nodes.size(); i++) {
            std::string where = gltf_text("scenes[%zu].nodes[%zu]", s, i);
            int node = model.scenes[s].nodes[i];
            gltf_check_index(node, model.nodes.size(), "nodes", where);
            if (parent[size_t(node)] != -1 || listed[size_t(node)])
                gltf_fail(HEMI_ERROR_DATA, "%s: node %d is not a root, or listed twice", where.c_str(), node);
            listed[size_t(node)] = 1;
        }
    }
}

/* ---- animations, skins ---------------------------------------------------------------------------------------- */

static void check_animation(const tinygltf::Model &model, size_t a) {
    const tinygltf::Animation &animation = model.animations[a];
    for (size_t i = 0; i < animation.channels.size(); i++) {
        std::string where = gltf_text("animations[%zu].channels[%zu]", a, i);
        gltf_check_index(animation.channels[i].sampler, animation.samplers.size(), "samplers", where + ".sampler");
        gltf_check_index(animation.channels[i].target_node, model.nodes.size(), "nodes", where + ".target.node");
    }
    for (size_t i = 0; i < animation.samplers.size(); i++) {
        std::string where = gltf_text("animations[%zu].samplers[%zu]", a, i);
        gltf_check_index(animation.samplers[i].input, model.accessors.size(), "accessors", where + ".input");
        gltf_check_index(animation.samplers[i].output, model.accessors.size(), "accessors", where + ".output");
    }
}

static void check_skin(const tinygltf::Model &model, size_t s) {
    const tinygltf::Skin &skin = model.skins[s];
    std::string where = gltf_text("skins[%zu]", s);
    for (int joint : skin.joints) gltf_check_index(joint, model.nodes.size(), "nodes", where + ".joints[]");
    check_optional(skin.skeleton, model.nodes.size(), "nodes", where + ".skeleton");
    check_optional(skin.inverseBindMatrices, model.accessors.size(), "accessors", where + ".inverseBindMatrices");
}

void gltf_check(gltf_asset &asset) {
    const tinygltf::Model &model = asset.model;
    check_required_extensions(model);
    for (size_t i = 0; i < model.bufferViews.size(); i++) check_view(asset, i);
    for (size_t i = 0; i < model.accessors.size(); i++) check_accessor(asset, i);
    for (size_t m = 0; m < model.meshes.size(); m++)
        for (size_t p = 0; p < model.meshes[m].primitives.size(); p++)
            check_primitive(model, model.meshes[m].primitives[p], gltf_text("meshes[%zu].primitives[%zu]", m, p));
    for (size_t i = 0; i < model.materials.size(); i++) check_material(asset, i);
    check_textures(model);
    for (size_t i = 0; i < model.nodes.size(); i++) check_node(asset, i);
    check_tree(model);
    check_optional(model.defaultScene, model.scenes.size(), "scenes", "scene");
    for (size_t i = 0; i < model.animations.size(); i++) check_animation(model, i);
    for (size_t i = 0; i < model.skins.size(); i++) check_skin(model, i);
}
