/* SPDX-License-Identifier: MIT
 * Which node shows which mesh once light is in the vertices? What several nodes, or several copies of
 * EXT_mesh_gpu_instancing, show becomes a mesh for each of them, since each is lit differently; unless they are to
 * share.
 */
#include "gltf_model.h"

#include <set>

/* Where something baked stands: a node, and which copy of its mesh (-1: it is not instanced). */
using place = std::pair<int, int>;

static std::set<place> baked_places(const gltf_asset &asset, const gltf_write_desc *desc) {
    std::set<place> places;
    for (size_t i = 0; i < asset.instances.size(); i++)
        if (!desc || desc->meshes[i].view) places.insert({ asset.instances[i].node, asset.instances[i].copy });
    return places;
}

/* The nodes that use each mesh and are not baked; a mesh without any may be replaced in place. */
static std::vector<size_t> count_keepers(const gltf_asset &asset, const std::set<place> &places) {
    std::vector<size_t> keepers(asset.model.meshes.size(), 0);
    std::set<int> baked;
    for (const place &at : places) baked.insert(at.first);
    for (size_t n = 0; n < asset.model.nodes.size(); n++)
        if (asset.model.nodes[n].mesh >= 0 && !baked.count(int(n))) keepers[size_t(asset.model.nodes[n].mesh)]++;
    return keepers;
}

uint32_t gltf_asset_mesh_copies(const gltf_asset *asset) {
    std::set<place> places = baked_places(*asset, nullptr);
    std::vector<size_t> users = count_keepers(*asset, places);
    uint32_t copies = 0;
    for (const place &at : places) copies += users[size_t(asset->model.nodes[size_t(at.first)].mesh)]++ > 0;
    return copies;
}

/* A node below the instanced one takes the place of a copy. */
static int add_copy_node(gltf_draft &draft, const place &at) {
    const std::vector<double> &copies = draft.asset.copies.at(at.first);
    tinygltf::Node node;
    node.name = draft.asset.model.nodes[size_t(at.first)].name;
    node.matrix.assign(copies.begin() + 16 * at.second, copies.begin() + 16 * (at.second + 1));
    int index = int(draft.model.nodes.size());
    draft.model.nodes.push_back(node);
    tinygltf::Node &parent = draft.model.nodes[size_t(at.first)];
    parent.children.push_back(index);
    parent.mesh = -1;
    parent.extensions.erase("EXT_mesh_gpu_instancing");
    return index;
}

static int copy_mesh(gltf_draft &draft, int mesh) {
    draft.model.meshes.push_back(draft.model.meshes[size_t(mesh)]);
    return int(draft.model.meshes.size()) - 1;
}

/* A mesh of its own for every place: the old one for the first, if nobody else needs it. */
static std::map<place, int> separate(gltf_draft &draft, const std::set<place> &places) {
    std::vector<size_t> users = count_keepers(draft.asset, places);
    std::map<place, int> meshes;
    for (const gltf_instance &instance : draft.asset.instances) {
        place at = { instance.node, instance.copy };
        if (!places.count(at) || meshes.count(at)) continue;
        int mesh = users[size_t(instance.mesh)]++ == 0 ? instance.mesh : copy_mesh(draft, instance.mesh);
        int node = at.second < 0 ? at.first : add_copy_node(draft, at);
        draft.model.nodes[size_t(node)].mesh = meshes[at] = mesh;
    }
    return meshes;
}

/* One mesh for all places that showed the same: the old one, or a copy if others need that as it was. */
static std::map<place, int> share(gltf_draft &draft, const std::set<place> &places) {
    std::vector<size_t> keepers = count_keepers(draft.asset, places);
    std::map<int, int> moved;
    std::map<place, int> meshes;
    for (const gltf_instance &instance : draft.asset.instances) {
        place at = { instance.node, instance.copy };
        if (!places.count(at)) continue;
        if (!moved.count(instance.mesh))
            moved[instance.mesh] = keepers[size_t(instance.mesh)] ? copy_mesh(draft, instance.mesh) : instance.mesh;
        draft.model.nodes[size_t(at.first)].mesh = meshes[at] = moved[instance.mesh];
    }
    return meshes;
}

std::vector<int> gltf_separate_meshes(gltf_draft &draft, const gltf_write_desc &desc) {
    std::set<place> places = baked_places(draft.asset, &desc);
    std::map<place, int> meshes = desc.keep_instances ? share(draft, places) : separate(draft, places);
    std::vector<int> of_instance;
    for (const gltf_instance &instance : draft.asset.instances) {
        auto found = meshes.find({ instance.node, instance.copy });
        of_instance.push_back(found == meshes.end() ? -1 : found->second);
    }
    return of_instance;
}

/* Meshes that lost their last node, or their last primitive, go. */
void gltf_drop_empty_meshes(gltf_draft &draft) {
    tinygltf::Model &model = draft.model;
    std::vector<char> was_used(model.meshes.size(), 0), is_used = was_used;
    for (const tinygltf::Node &node : draft.asset.model.nodes)
        if (node.mesh >= 0) was_used[size_t(node.mesh)] = 1;
    for (tinygltf::Node &node : model.nodes) {
        if (node.mesh >= 0 && model.meshes[size_t(node.mesh)].primitives.empty()) node.mesh = -1;
        if (node.mesh >= 0) is_used[size_t(node.mesh)] = 1;
    }
    std::vector<int> moved(model.meshes.size(), -1);
    std::vector<tinygltf::Mesh> kept;
    for (size_t m = 0; m < model.meshes.size(); m++) {
        bool fresh = m >= draft.asset.model.meshes.size();
        if (!is_used[m] && (fresh || (was_used[m] && !draft.keeps_numbers))) continue;
        moved[m] = int(kept.size());
        kept.push_back(std::move(model.meshes[m]));
        if (kept.back().primitives.empty()) /* nobody shows it, but an extension may name it */
            kept.back().primitives = draft.asset.model.meshes[m].primitives;
    }
    model.meshes = std::move(kept);
    for (tinygltf::Node &node : model.nodes)
        if (node.mesh >= 0) node.mesh = moved[size_t(node.mesh)];
}
