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
static std::vector<size_t> count_other_users(const gltf_asset &asset, const std::set<place> &places,
                                             const std::vector<size_t> &kept = {}) {
    std::vector<size_t> others = kept;
    others.resize(asset.model.meshes.size(), 0);
    std::set<int> baked;
    for (const place &at : places) baked.insert(at.first);
    for (size_t n = 0; n < asset.model.nodes.size(); n++)
        if (asset.model.nodes[n].mesh >= 0 && !baked.count(int(n))) others[size_t(asset.model.nodes[n].mesh)]++;
    return others;
}

void gltf_count_mesh_copies(gltf_asset &asset) {
    std::set<place> places = baked_places(asset, nullptr);
    std::vector<size_t> users = count_other_users(asset, places);
    for (const place &at : places) asset.mesh_copies += users[size_t(asset.model.nodes[size_t(at.first)].mesh)]++ > 0;
}

uint32_t gltf_asset_mesh_copies(const gltf_asset *asset) {
    return asset->mesh_copies;
}

/* A node below the instanced one takes the place of a copy. */
static void add_copy_node(gltf_draft &draft, const place &at, int mesh) {
    const std::string &name = draft.asset.model.nodes[size_t(at.first)].name;
    cJSON *parent = draft.lists[gltf_nodes][size_t(at.first)];
    gltf_json node(cJSON_CreateObject());
    gltf_set_numbers(node.get(), "matrix", &draft.asset.copies.at(at.first)[16 * size_t(at.second)], 16);
    gltf_set_number(node.get(), "mesh", mesh);
    if (!name.empty()) gltf_set_text(node.get(), "name", name.c_str());
    const cJSON *prim = gltf_member(gltf_member(parent, "extras"), "usd"); /* whose copy it is */
    if (prim) gltf_set(gltf_object(node.get(), "extras"), "usd", gltf_copy(prim));
    int index = gltf_add_element(draft, gltf_nodes, std::move(node));
    gltf_append(gltf_list(parent, "children"), gltf_json(cJSON_CreateNumber(index)));
    gltf_drop(parent, "mesh");
    gltf_drop_extension(parent, "EXT_mesh_gpu_instancing");
}

static int copy_mesh(gltf_draft &draft, int mesh) {
    return gltf_add_element(draft, gltf_meshes, gltf_copy(draft.lists[gltf_meshes][size_t(mesh)]));
}

static void show_mesh(gltf_draft &draft, int node, int mesh) {
    gltf_set_number(draft.lists[gltf_nodes][size_t(node)], "mesh", mesh);
}

/* A mesh of its own for every place: the old one for the first, if nobody else needs it. */
static std::map<place, int> separate(gltf_draft &draft, const std::set<place> &places) {
    std::vector<size_t> users = count_other_users(draft.asset, places, draft.kept_users);
    std::map<place, int> meshes;
    for (const gltf_instance &instance : draft.asset.instances) {
        place at = { instance.node, instance.copy };
        if (!places.count(at) || meshes.count(at)) continue;
        int mesh = users[size_t(instance.mesh)]++ == 0 ? instance.mesh : copy_mesh(draft, instance.mesh);
        if (at.second < 0)
            show_mesh(draft, at.first, mesh);
        else
            add_copy_node(draft, at, mesh);
        meshes[at] = mesh;
    }
    return meshes;
}

/* One mesh for all places that showed the same: the old one, or a copy if others need that as it was. */
static std::map<place, int> share(gltf_draft &draft, const std::set<place> &places) {
    std::vector<size_t> others = count_other_users(draft.asset, places, draft.kept_users);
    std::map<int, int> moved;
    std::map<place, int> meshes;
    for (const gltf_instance &instance : draft.asset.instances) {
        place at = { instance.node, instance.copy };
        if (!places.count(at)) continue;
        if (!moved.count(instance.mesh))
            moved[instance.mesh] = others[size_t(instance.mesh)] ? copy_mesh(draft, instance.mesh) : instance.mesh;
        show_mesh(draft, at.first, meshes[at] = moved[instance.mesh]);
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

/* A mesh that nobody shows, but an extension may name, is what it was. */
static void restore_primitives(gltf_draft &draft, size_t mesh) {
    std::vector<cJSON *> originals = gltf_elements(gltf_member(draft.asset.document.get(), "meshes"));
    gltf_set(draft.lists[gltf_meshes][mesh], "primitives", gltf_copy(gltf_member(originals[mesh], "primitives")));
}

/* Meshes that lost their last node, or their last primitive, go. */
void gltf_drop_empty_meshes(gltf_draft &draft) {
    const size_t originals = draft.asset.model.meshes.size();
    std::vector<cJSON *> &meshes = draft.lists[gltf_meshes];
    std::vector<char> was_used(meshes.size(), 0), is_used = was_used;
    for (const tinygltf::Node &node : draft.asset.model.nodes)
        if (node.mesh >= 0) was_used[size_t(node.mesh)] = 1;
    for (cJSON *node : draft.lists[gltf_nodes]) {
        int mesh = gltf_index(node, "mesh");
        if (mesh < 0) continue;
        if (gltf_member(meshes[size_t(mesh)], "primitives")->child)
            is_used[size_t(mesh)] = 1;
        else
            gltf_drop(node, "mesh");
    }
    for (size_t m = 0; m < meshes.size(); m++) {
        if (!is_used[m] && (m >= originals || (was_used[m] && !draft.keeps_numbers)))
            gltf_remove_element(draft, gltf_meshes, m);
        else if (!gltf_member(meshes[m], "primitives")->child)
            restore_primitives(draft, m);
    }
    std::vector<int> moved = gltf_close_list(draft, gltf_meshes);
    for (cJSON *node : draft.lists[gltf_nodes])
        if (gltf_index(node, "mesh") >= 0) gltf_set_number(node, "mesh", moved[size_t(gltf_index(node, "mesh"))]);
}
