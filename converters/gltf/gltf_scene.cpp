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
static const double transform_max = 1e30; /* as the library's */
static const size_t decoded_bytes_max = size_t(1) << 33;

void gltf_local_transform(const tinygltf::Node &node, double *out) {
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
    bool animated, hidden; /* the node or an ancestor */
    gltf_detail level;     /* of the node or an ancestor */
    gltf_steering steering;
};

struct scene_walk {
    gltf_asset &asset;
    std::vector<char> animated; /* animated[n]: a channel moves node n itself */
    std::map<int, gltf_detail> levels;
    bool leaves_moving;
    size_t decoded_bytes = 0;
    std::map<int, visit> owners{};   /* above the nodes that have levels, whose node is -1 at the root */
    std::vector<char> was_visited{}; /* of nodes */
    std::map<std::pair<const gltf_geometry *, const gltf_cage *>, uint32_t>
        first{}; /* instance that shows a geometry */
};

static std::string label(const gltf_asset &asset, int node, int primitive) {
    std::string name = gltf_printable(asset.model.nodes[size_t(node)].name);
    std::string text = name.empty() ? gltf_text("node %d", node) : gltf_text("node %d \"%s\"", node, name.c_str());
    return primitive < 0 ? text : text + gltf_text(", primitive %d", primitive);
}

static const char *primitive_obstacle(const scene_walk &walk, const tinygltf::Primitive &primitive) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return "not made of triangles";
    if (walk.leaves_moving && !primitive.targets.empty()) return "morphed";
    const tinygltf::Model &model = walk.asset.model;
    auto positions = primitive.attributes.find("POSITION");
    if (positions == primitive.attributes.end()) return "without positions";
    bool packed = primitive.extensions.count("KHR_draco_mesh_compression") > 0; /* whose own counts hold */
    bool drawn = primitive.indices < 0 || model.accessors[size_t(primitive.indices)].count >= 3;
    if (!packed && (!drawn || model.accessors[size_t(positions->second)].count < 3)) return "empty";
    return nullptr;
}

static size_t geometry_bytes(const gltf_geometry &geometry) {
    return 4 * (geometry.positions.size() + geometry.normals.size() + 2 * geometry.attributes.size() +
                3 * geometry.colors.size() + geometry.radiosity.size() + geometry.indices.size());
}

/* What has a shape of its own at every node, as poses differ. */
static bool is_posed(const tinygltf::Node &node, const tinygltf::Primitive &primitive) {
    return node.skin >= 0 || !primitive.targets.empty();
}

static const gltf_geometry *find_geometry(scene_walk &walk, int node, int mesh, int primitive) {
    const tinygltf::Model &model = walk.asset.model;
    bool posed = is_posed(model.nodes[size_t(node)], model.meshes[size_t(mesh)].primitives[size_t(primitive)]);
    auto &geometry = posed ? walk.asset.poses[{ node, primitive }] : walk.asset.geometries[{ mesh, primitive }];
    if (geometry) return geometry.get();
    geometry = posed ? gltf_read_posed(walk.asset, node, mesh, primitive)
                     : gltf_read_primitive(walk.asset, mesh, primitive, false);
    walk.decoded_bytes += geometry_bytes(*geometry);
    for (const char *note : geometry->notes)
        gltf_note(walk.asset, gltf_text("mesh %d, primitive %d", mesh, primitive), note);
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
    if (const char *why = primitive_obstacle(walk, primitive)) {
        if (copy <= 0) gltf_note(asset, label(asset, at.node, p), std::string("not baked, ") + why);
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
    instance.level = at.level;
    instance.steering = at.steering;
    instance.geometry = find_geometry(walk, at.node, node.mesh, p);
    instance.posed = is_posed(node, primitive);
    if (!instance.geometry->in_world) std::memcpy(instance.world, at.world, sizeof instance.world);
    for (int k = 0; instance.geometry->in_world && k < 4; k++) instance.world[5 * k] = 1;
    instance.name = node.name.empty() ? mesh.name.c_str() : node.name.c_str();
    if (!instance.posed && at.level.number == 0) {
        instance.cage = gltf_read_cage(asset, at.node, node.mesh, p);
        instance.subdivision = gltf_describe_cage(instance);
    }
    instance.original =
        walk.first.insert({ { instance.geometry, instance.cage.get() }, uint32_t(asset.instances.size()) })
            .first->second;
    asset.instances.push_back(instance);
}

/* Places are written as float, and what is larger would be of no place any more: a whole object was once lost by it, or
 * everything else was a point beside it. */
static void check_place(const visit &at) {
    for (double number : at.world)
        if (!(std::fabs(number) <= transform_max))
            gltf_fail(HEMI_ERROR_DATA, "nodes[%d]: its world transform is not of finite numbers up to %g", at.node,
                      transform_max);
}

static void add_mesh(scene_walk &walk, const visit &at) {
    const tinygltf::Node &node = walk.asset.model.nodes[size_t(at.node)];
    const char *why = at.animated ? "animated" : node.skin >= 0 ? "skinned" : nullptr;
    if (at.hidden) return;
    if (why && walk.leaves_moving) {
        gltf_note(walk.asset, label(walk.asset, at.node, -1), std::string("not baked, ") + why);
        return;
    }
    if (why) gltf_note(walk.asset, label(walk.asset, at.node, -1), std::string(why) + ", baked at its rest pose");
    if (at.level.number)
        gltf_note(walk.asset, label(walk.asset, at.node, -1),
                  "a level of detail (MSFT_lod), lit as the nearest one is");
    int count = int(walk.asset.model.meshes[size_t(node.mesh)].primitives.size());
    if (node.extensions.count("EXT_mesh_gpu_instancing") == 0) {
        for (int p = 0; p < count; p++) add_primitive(walk, at, p, -1);
        return;
    }
    std::vector<double> &copies = walk.asset.copies[at.node] = gltf_read_copies(walk.asset, at.node);
    for (size_t i = 0; 16 * i < copies.size(); i++) {
        visit copy = at;
        gltf_multiply(at.world, &copies[16 * i], copy.world);
        check_place(copy);
        for (int p = 0; p < count; p++) add_primitive(walk, copy, p, int(i));
    }
}

/* A camera looks along -z, y is up. [glTF 2.0, 3.10] */
static void add_camera(gltf_asset &asset, const visit &at) {
    const tinygltf::Node &node = asset.model.nodes[size_t(at.node)];
    const tinygltf::Camera &source = asset.model.cameras[size_t(node.camera)];
    gltf_camera camera = {};
    camera.name = node.name.empty() ? source.name.c_str() : node.name.c_str();
    const cJSON *held = cJSON_GetArrayItem(gltf_member(asset.document.get(), "nodes"), at.node);
    const char *path = cJSON_GetStringValue(gltf_member(gltf_member(gltf_member(held, "extras"), "usd"), "path"));
    camera.path = path ? path : "";
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
    const tinygltf::ExtensionMap &extensions = walk.asset.model.nodes[size_t(at.node)].extensions;
    if (at.hidden || at.level.number ||
        (!extensions.count("KHR_lights_punctual") && !extensions.count("EXT_lights_ies")))
        return;
    if (at.animated && walk.leaves_moving) {
        gltf_note(walk.asset, label(walk.asset, at.node, -1), "its light is left out, animated");
        return;
    }
    if (at.animated)
        gltf_note(walk.asset, label(walk.asset, at.node, -1), "its light moves, and is baked where it is at rest");
    gltf_add_light(walk.asset, at.node, at.world);
    gltf_add_profile(walk.asset, at.node, at.world);
}

static visit enter(const scene_walk &walk, int node, const visit *parent) {
    const tinygltf::Node &source = walk.asset.model.nodes[size_t(node)];
    visit at = {};
    at.node = node;
    at.animated = walk.animated[size_t(node)] || (parent && parent->animated);
    at.hidden = gltf_node_is_hidden(source) || (parent && parent->hidden);
    auto level = walk.levels.find(node);
    if (level != walk.levels.end())
        at.level = level->second;
    else if (parent)
        at.level = parent->level;
    at.steering = gltf_steer(walk.asset, node, parent ? parent->steering : gltf_steering{});
    double local[16];
    gltf_local_transform(source, local);
    if (parent && parent->node >= 0)
        gltf_multiply(parent->world, local, at.world);
    else
        std::memcpy(at.world, local, sizeof at.world);
    check_place(at);
    return at;
}

static std::vector<char> animated_nodes(const tinygltf::Model &model) {
    std::vector<char> animated(model.nodes.size(), 0);
    for (const tinygltf::Animation &animation : model.animations)
        for (const tinygltf::AnimationChannel &channel : animation.channels)
            if (channel.target_path != "weights") animated[size_t(channel.target_node)] = 1;
    return animated;
}

static void visit_node(scene_walk &walk, const visit &at) {
    const tinygltf::Node &node = walk.asset.model.nodes[size_t(at.node)];
    walk.was_visited[size_t(at.node)] = 1;
    if (gltf_node_is_hidden(node))
        gltf_note(walk.asset, label(walk.asset, at.node, -1),
                  "hidden (KHR_node_visibility), left out with all below it");
    if (node.mesh >= 0) add_mesh(walk, at);
    if (node.camera >= 0) add_camera(walk.asset, at);
    add_light(walk, at);
}

/* All from some nodes on; parents[i] is above nodes[i]. */
static void walk_down(scene_walk &walk, const std::vector<int> &nodes, const std::vector<visit> &parents) {
    std::vector<std::pair<visit, visit>> stack; /* not recursion: a chain of nodes may be as long as the file */
    for (size_t i = nodes.size(); i-- > 0;) stack.push_back({ enter(walk, nodes[i], &parents[i]), parents[i] });
    while (!stack.empty()) {
        const auto [at, above] = stack.back();
        stack.pop_back();
        const tinygltf::Node &node = walk.asset.model.nodes[size_t(at.node)];
        if (walk.was_visited[size_t(at.node)]) continue;
        if (node.extensions.count("MSFT_lod")) walk.owners.insert({ at.node, above });
        visit_node(walk, at);
        for (size_t i = node.children.size(); i-- > 0;) stack.push_back({ enter(walk, node.children[i], &at), at });
    }
}

/* Levels that are no part of the scene stand where the node does that they stand in for. */
static void walk_levels(scene_walk &walk) {
    std::vector<int> nodes;
    std::vector<visit> parents;
    for (const auto &[node, level] : walk.levels) {
        if (walk.was_visited[size_t(node)] || !walk.owners.count(level.owner)) continue;
        nodes.push_back(node);
        parents.push_back(walk.owners.at(level.owner));
    }
    walk_down(walk, nodes, parents);
}

/* What has levels is level 0 of itself, with all below it. */
static std::map<int, gltf_detail> find_levels(const tinygltf::Model &model, const std::vector<int> &roots) {
    std::map<int, gltf_detail> levels = gltf_find_levels(model, roots), all = levels;
    for (const auto &[node, level] : levels) all.insert({ level.owner, { level.owner, 0 } });
    return all;
}

void gltf_walk_scene(gltf_asset &asset, const gltf_limits &limits) {
    gltf_choose_variant(asset, limits.variant);
    asset.opens_scene = limits.scene && limits.opens_scene;
    std::vector<int> roots = gltf_choose_scene(asset, limits.scene);
    scene_walk walk = { asset, animated_nodes(asset.model), find_levels(asset.model, roots), limits.leaves_moving };
    walk.was_visited.resize(asset.model.nodes.size(), 0);
    visit outside = {};
    outside.node = -1;
    outside.level.owner = -1;
    walk_down(walk, roots, std::vector<visit>(roots.size(), outside));
    walk_levels(walk);
    gltf_steer_instances(asset);
    gltf_read_sky(asset);
}
