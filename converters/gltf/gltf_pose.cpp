/* SPDX-License-Identifier: MIT
 * What shape has a skinned or morphed primitive at its rest pose? Targets first, by the weights of its node or else its
 * mesh; then the skin, as its joints stand in the document. [glTF 2.0, 3.7.2.2, 3.7.3]
 */
#include "gltf_model.h"

#include <cmath>
#include <cstring>

/* ---- targets ---------------------------------------------------------------------------------------------------- */

/* values[3*v+k] += weight * what a target says of them, if it fits. */
static void add_target(const gltf_asset &asset, const std::map<std::string, int> &target, const char *name,
                       double weight, const std::string &where, std::vector<float> &values) {
    auto found = target.find(name);
    if (found == target.end()) return;
    std::vector<float> moves = gltf_read_floats(asset, found->second, 3, gltf_zero_broken, where + "." + name);
    if (moves.size() != values.size())
        gltf_fail(HEMI_ERROR_DATA, "%s.%s has %zu elements, but there are %zu vertices", where.c_str(), name,
                  moves.size() / 3, values.size() / 3);
    for (size_t i = 0; i < values.size(); i++) values[i] = float(double(values[i]) + weight * double(moves[i]));
}

static void morph(const gltf_asset &asset, int node, int mesh, int primitive, gltf_geometry &geometry) {
    const tinygltf::Mesh &source = asset.model.meshes[size_t(mesh)];
    const std::vector<double> &own = asset.model.nodes[size_t(node)].weights;
    const std::vector<double> &weights = own.empty() ? source.weights : own;
    const auto &targets = source.primitives[size_t(primitive)].targets;
    for (size_t t = 0; t < targets.size() && t < weights.size(); t++) {
        std::string where = gltf_text("meshes[%d].primitives[%d].targets[%zu]", mesh, primitive, t);
        if (!std::isfinite(weights[t])) gltf_fail(HEMI_ERROR_DATA, "%s: its weight is not finite", where.c_str());
        if (weights[t] == 0) continue;
        add_target(asset, targets[t], "POSITION", weights[t], where, geometry.positions);
        if (!geometry.normals.empty()) add_target(asset, targets[t], "NORMAL", weights[t], where, geometry.normals);
    }
}

/* ---- skins ------------------------------------------------------------------------------------------------------ */

using matrix = std::array<double, 16>; /* column-major */

static const matrix identity = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

/* Of every node of the document: joints may be in no scene. */
static const std::vector<matrix> &world_transforms(gltf_asset &asset) {
    std::vector<matrix> &worlds = asset.node_worlds;
    const std::vector<tinygltf::Node> &nodes = asset.model.nodes;
    if (!worlds.empty()) return worlds;
    std::vector<int> parent(nodes.size(), -1), stack;
    for (size_t n = 0; n < nodes.size(); n++)
        for (int child : nodes[n].children) parent[size_t(child)] = int(n);
    worlds.assign(nodes.size(), identity);
    for (size_t n = 0; n < nodes.size(); n++)
        if (parent[n] < 0) stack.push_back(int(n));
    while (!stack.empty()) {
        size_t n = size_t(stack.back());
        stack.pop_back();
        double local[16];
        gltf_local_transform(nodes[n], local);
        gltf_multiply(parent[n] < 0 ? identity.data() : worlds[size_t(parent[n])].data(), local, worlds[n].data());
        stack.insert(stack.end(), nodes[n].children.begin(), nodes[n].children.end());
    }
    return worlds;
}

/* Of each joint: from where the mesh is bound to where it stands. */
static std::vector<matrix> joint_matrices(gltf_asset &asset, int skin) {
    const tinygltf::Skin &source = asset.model.skins[size_t(skin)];
    const std::vector<matrix> &worlds = world_transforms(asset);
    std::vector<float> bound;
    std::string where = gltf_text("skins[%d].inverseBindMatrices", skin);
    if (source.inverseBindMatrices >= 0) bound = gltf_read_matrices(asset, source.inverseBindMatrices, where);
    if (!bound.empty() && bound.size() < 16 * source.joints.size())
        gltf_fail(HEMI_ERROR_DATA, "%s has fewer elements than the skin has joints", where.c_str());
    std::vector<matrix> joints(source.joints.size(), identity);
    for (size_t j = 0; j < joints.size(); j++) {
        double inverse[16];
        for (size_t k = 0; k < 16; k++) inverse[k] = bound.empty() ? identity[k] : double(bound[16 * j + k]);
        gltf_multiply(worlds[size_t(source.joints[j])].data(), inverse, joints[j].data());
    }
    return joints;
}

/* The weights of a vertex, all of its sets, times the matrices of its joints. False: it has none. */
static bool blend(const std::vector<matrix> &joints, const std::vector<std::vector<float>> &sets, size_t vertex,
                  matrix &out) {
    double total = 0;
    out.fill(0);
    for (size_t s = 0; s + 1 < sets.size(); s += 2)
        for (size_t k = 0; k < 4; k++) {
            double joint = double(sets[s][4 * vertex + k]), weight = double(sets[s + 1][4 * vertex + k]);
            if (!(weight > 0) || !(joint >= 0 && joint < double(joints.size()))) continue;
            for (size_t i = 0; i < 16; i++) out[i] += weight * joints[size_t(joint)][i];
            total += weight;
        }
    for (double &number : out) number /= total > 0 ? total : 1;
    return total > 0;
}

static void transform(const matrix &m, double w, float *v) {
    const double from[3] = { double(v[0]), double(v[1]), double(v[2]) };
    for (size_t r = 0; r < 3; r++)
        v[r] = float(m[r] * from[0] + m[4 + r] * from[1] + m[8 + r] * from[2] + m[12 + r] * w);
}

/* JOINTS_0, WEIGHTS_0, JOINTS_1, ... of every vertex. */
static std::vector<std::vector<float>> read_influences(const gltf_asset &asset, int mesh, int primitive,
                                                       size_t vertices) {
    std::vector<std::vector<float>> sets;
    for (int n = 0;; n++) {
        std::vector<float> joints = gltf_read_attribute(asset, mesh, primitive, "JOINTS_" + std::to_string(n), 4),
                           weights = gltf_read_attribute(asset, mesh, primitive, "WEIGHTS_" + std::to_string(n), 4);
        if (joints.size() != 4 * vertices || weights.size() != 4 * vertices) return sets;
        sets.push_back(std::move(joints));
        sets.push_back(std::move(weights));
    }
}

static void bend(gltf_asset &asset, int node, int mesh, int primitive, gltf_geometry &geometry) {
    std::vector<std::vector<float>> sets = read_influences(asset, mesh, primitive, geometry.vertex_count);
    std::vector<matrix> joints = joint_matrices(asset, asset.model.nodes[size_t(node)].skin);
    const matrix &own = world_transforms(asset)[size_t(node)];
    for (size_t v = 0; v < geometry.vertex_count; v++) {
        matrix blended;
        const matrix &m = blend(joints, sets, v, blended) ? blended : own;
        transform(m, 1, &geometry.positions[3 * v]);
        if (!geometry.normals.empty()) transform(m, 0, &geometry.normals[3 * v]);
    }
    for (float number : geometry.positions)
        if (!std::isfinite(number))
            gltf_fail(HEMI_ERROR_DATA, "nodes[%d]: its skin moves a vertex to where numbers are not finite", node);
    geometry.in_world = true;
}

std::unique_ptr<gltf_geometry> gltf_read_posed(gltf_asset &asset, int node, int mesh, int primitive) {
    std::unique_ptr<gltf_geometry> geometry = gltf_read_primitive(asset, mesh, primitive, true);
    morph(asset, node, mesh, primitive, *geometry);
    if (asset.model.nodes[size_t(node)].skin >= 0) bend(asset, node, mesh, primitive, *geometry);
    return geometry;
}
