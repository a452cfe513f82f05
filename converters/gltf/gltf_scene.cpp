/* SPDX-License-Identifier: MIT
 * Which primitives stand where in the scene, and which of them cannot be baked, and why?
 */
#include "gltf_model.h"

#include "geometry/vec3.h"

#include <algorithm>
#include <cmath>
#include <cstring>

/* Bounds on what a small file can blow up to by sharing: nodes times primitives, and decoded numbers. */
static const size_t instance_count_max = 1000000;
static const size_t decoded_bytes_max = size_t(1) << 33;

static void local_transform(const tinygltf::Node &node, double *out) {
    double translation[3] = { 0, 0, 0 }, rotation[4] = { 0, 0, 0, 1 }, scale[3] = { 1, 1, 1 };
    if (node.matrix.size() == 16) {
        std::memcpy(out, node.matrix.data(), 16 * sizeof *out);
        for (int c = 0; c < 4; c++) out[4 * c + 3] = c == 3; /* to a rounding, gltf_check.cpp */
        return;
    }
    std::copy(node.translation.begin(), node.translation.end(), translation);
    std::copy(node.rotation.begin(), node.rotation.end(), rotation);
    std::copy(node.scale.begin(), node.scale.end(), scale);
    gltf_compose(translation, rotation, scale, out);
}

/* ---- the walk ------------------------------------------------------------------------------------------------- */

struct visit {
    int node;
    double world[16];
    bool animated; /* the node or an ancestor */
};

struct scene_walk {
    gltf_asset &asset;
    std::vector<char> animated; /* animated[n]: a channel moves node n itself */
    size_t decoded_bytes = 0;
    std::map<std::pair<const gltf_geometry *, const gltf_cage *>, uint32_t>
        first{}; /* instance that shows a geometry */
};

static std::string label(const gltf_asset &asset, int node, int primitive) {
    std::string name = gltf_printable(asset.model.nodes[size_t(node)].name);
    std::string text = name.empty() ? gltf_text("node %d", node) : gltf_text("node %d \"%s\"", node, name.c_str());
    return primitive < 0 ? text : text + gltf_text(", primitive %d", primitive);
}

static const char *primitive_obstacle(const tinygltf::Model &model, const tinygltf::Primitive &primitive) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return "not made of triangles";
    if (!primitive.targets.empty()) return "morphed";
    if (primitive.attributes.count("POSITION") == 0) return "without positions";
    if (primitive.material >= 0 && model.materials[size_t(primitive.material)].alphaMode == "BLEND") return "blended";
    return nullptr;
}

static size_t geometry_bytes(const gltf_geometry &geometry) {
    return 4 * (geometry.positions.size() + geometry.normals.size() + 2 * geometry.attributes.size() +
                3 * geometry.colors.size() + geometry.radiosity.size() + geometry.indices.size());
}

static const gltf_geometry *find_geometry(scene_walk &walk, int mesh, int primitive) {
    auto &geometry = walk.asset.geometries[{ mesh, primitive }];
    if (geometry) return geometry.get();
    geometry = gltf_read_primitive(walk.asset, mesh, primitive);
    walk.decoded_bytes += geometry_bytes(*geometry);
    if (walk.decoded_bytes > decoded_bytes_max)
        gltf_fail(HEMI_ERROR_LIMIT, "meshes[%d].primitives[%d]: all geometry together exceeds %zu bytes", mesh,
                  primitive, decoded_bytes_max);
    return geometry.get();
}

static void add_primitive(scene_walk &walk, const visit &at, int p, int copy) {
    gltf_asset &asset = walk.asset;
    const tinygltf::Node &node = asset.model.nodes[size_t(at.node)];
    const tinygltf::Mesh &mesh = asset.model.meshes[size_t(node.mesh)];
    const tinygltf::Primitive &primitive = mesh.primitives[size_t(p)];
    if (const char *why = primitive_obstacle(asset.model, primitive)) {
        if (copy <= 0) asset.skipped.push_back(label(asset, at.node, p) + ": not baked, " + why);
        return;
    }
    if (asset.instances.size() == instance_count_max)
        gltf_fail(HEMI_ERROR_LIMIT, "nodes[%d]: more than %zu primitives in the scene", at.node, instance_count_max);
    gltf_instance instance = {};
    instance.node = at.node;
    instance.mesh = node.mesh;
    instance.primitive = p;
    instance.copy = copy;
    instance.material = uint32_t(primitive.material >= 0 ? size_t(primitive.material) : asset.model.materials.size());
    std::memcpy(instance.world, at.world, sizeof instance.world);
    instance.geometry = find_geometry(walk, node.mesh, p);
    instance.name = node.name.empty() ? mesh.name.c_str() : node.name.c_str();
    instance.cage = gltf_read_cage(asset, at.node, node.mesh, p);
    instance.subdivision = gltf_describe_cage(instance);
    instance.original =
        walk.first.insert({ { instance.geometry, instance.cage.get() }, uint32_t(asset.instances.size()) })
            .first->second;
    asset.instances.push_back(instance);
}

static void check_finite(const visit &at) {
    for (double number : at.world)
        if (!std::isfinite(number)) gltf_fail(HEMI_ERROR_DATA, "nodes[%d]: its world transform is not finite", at.node);
}

static void add_mesh(scene_walk &walk, const visit &at) {
    const tinygltf::Node &node = walk.asset.model.nodes[size_t(at.node)];
    if (const char *why = at.animated ? "animated" : node.skin >= 0 ? "skinned" : nullptr) {
        walk.asset.skipped.push_back(label(walk.asset, at.node, -1) + ": not baked, " + why);
        return;
    }
    int count = int(walk.asset.model.meshes[size_t(node.mesh)].primitives.size());
    if (node.extensions.count("EXT_mesh_gpu_instancing") == 0) {
        for (int p = 0; p < count; p++) add_primitive(walk, at, p, -1);
        return;
    }
    std::vector<double> &copies = walk.asset.copies[at.node] = gltf_read_copies(walk.asset, at.node);
    for (size_t i = 0; 16 * i < copies.size(); i++) {
        visit copy = at;
        gltf_multiply(at.world, &copies[16 * i], copy.world);
        check_finite(copy);
        for (int p = 0; p < count; p++) add_primitive(walk, copy, p, int(i));
    }
}

/* A camera looks along -z, y is up. [glTF 2.0, 3.10] */
static void add_camera(gltf_asset &asset, const visit &at) {
    const tinygltf::Node &node = asset.model.nodes[size_t(at.node)];
    const tinygltf::Camera &source = asset.model.cameras[size_t(node.camera)];
    gltf_camera camera = {};
    camera.name = node.name.empty() ? source.name.c_str() : node.name.c_str();
    double forward[3] = { -at.world[8], -at.world[9], -at.world[10] };
    vec3_normalize(forward);
    for (int k = 0; k < 3; k++) {
        camera.eye[k] = at.world[12 + k];
        camera.target[k] = camera.eye[k] + forward[k];
        camera.up[k] = at.world[4 + k];
    }
    vec3_normalize(camera.up);
    bool perspective = source.type == "perspective";
    camera.yfov = perspective ? source.perspective.yfov : 0;
    camera.ymag = perspective ? 0 : source.orthographic.ymag;
    asset.cameras.push_back(camera);
}

static void add_light(scene_walk &walk, const visit &at) {
    if (walk.asset.model.nodes[size_t(at.node)].extensions.count("KHR_lights_punctual") == 0) return;
    if (at.animated)
        walk.asset.skipped.push_back(label(walk.asset, at.node, -1) + ": its light is left out, animated");
    else
        gltf_add_light(walk.asset, at.node, at.world);
}

static visit enter(const scene_walk &walk, int node, const visit *parent) {
    const tinygltf::Node &source = walk.asset.model.nodes[size_t(node)];
    visit at = {};
    at.node = node;
    at.animated = walk.animated[size_t(node)] || (parent && parent->animated);
    double local[16];
    local_transform(source, local);
    if (parent)
        gltf_multiply(parent->world, local, at.world);
    else
        std::memcpy(at.world, local, sizeof at.world);
    check_finite(at);
    return at;
}

static std::vector<char> animated_nodes(const tinygltf::Model &model) {
    std::vector<char> animated(model.nodes.size(), 0);
    for (const tinygltf::Animation &animation : model.animations)
        for (const tinygltf::AnimationChannel &channel : animation.channels)
            if (channel.target_path != "weights") animated[size_t(channel.target_node)] = 1;
    return animated;
}

static void note_other_scenes(gltf_asset &asset) {
    for (size_t s = 0; s < asset.model.scenes.size(); s++) {
        if (int(s) == asset.scene) continue;
        std::string name = gltf_printable(asset.model.scenes[s].name);
        asset.skipped.push_back(gltf_text("scene %zu%s%s%s: not baked, it is not the default scene", s,
                                          name.empty() ? "" : " \"", name.c_str(), name.empty() ? "" : "\""));
    }
}

/* The roots of the scene that is baked; of an asset without scenes, every node that is nobody's child. */
static std::vector<int> root_nodes(gltf_asset &asset) {
    const tinygltf::Model &model = asset.model;
    asset.scene = model.defaultScene >= 0 ? model.defaultScene : model.scenes.empty() ? -1 : 0;
    if (asset.scene >= 0) return model.scenes[size_t(asset.scene)].nodes;
    std::vector<bool> child(model.nodes.size(), false);
    for (const tinygltf::Node &node : model.nodes)
        for (int c : node.children) child[size_t(c)] = true;
    std::vector<int> roots;
    for (size_t n = 0; n < child.size(); n++)
        if (!child[n]) roots.push_back(int(n));
    return roots;
}

void gltf_walk_scene(gltf_asset &asset) {
    scene_walk walk = { asset, animated_nodes(asset.model) };
    std::vector<visit> stack; /* not recursion: a chain of nodes may be as long as the file */
    std::vector<int> roots = root_nodes(asset);
    for (size_t i = roots.size(); i-- > 0;) stack.push_back(enter(walk, roots[i], nullptr));
    while (!stack.empty()) {
        visit at = stack.back();
        stack.pop_back();
        const tinygltf::Node &node = asset.model.nodes[size_t(at.node)];
        if (node.mesh >= 0) add_mesh(walk, at);
        if (node.camera >= 0) add_camera(asset, at);
        add_light(walk, at);
        for (size_t i = node.children.size(); i-- > 0;) stack.push_back(enter(walk, node.children[i], &at));
    }
    gltf_read_sky(asset);
    note_other_scenes(asset);
}
