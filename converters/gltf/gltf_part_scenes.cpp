/* SPDX-License-Identifier: MIT
 * What do scenes that share nodes show once one of them is baked? The others get copies of the nodes as they were, with
 * their animations and skins, so that no scene shows the light of another.
 */
#include "gltf_model.h"

#include <set>

using node_map = std::map<int, int>;

/* The number that stands for a node in the copy; others stay. */
static int moved(const node_map &copies, int node) {
    auto found = copies.find(node);
    return found == copies.end() ? node : found->second;
}

static void move_numbers(const node_map &copies, const cJSON *list) {
    for (cJSON *number : gltf_elements(list))
        if (gltf_is_number(number)) gltf_change_number(number, moved(copies, number->valueint));
}

static node_map copy_nodes(gltf_draft &draft, int root) {
    node_map copies;
    std::vector<int> stack = { root };
    while (!stack.empty()) {
        int node = stack.back();
        stack.pop_back();
        const tinygltf::Node &source = draft.asset.model.nodes[size_t(node)];
        copies[node] = gltf_add_element(draft, gltf_nodes, gltf_copy(draft.lists[gltf_nodes][size_t(node)]));
        if (source.mesh >= 0) draft.kept_users[size_t(source.mesh)]++;
        stack.insert(stack.end(), source.children.begin(), source.children.end());
    }
    for (const auto &[node, copy] : copies) {
        cJSON *made = draft.lists[gltf_nodes][size_t(copy)];
        move_numbers(copies, gltf_member(made, "children"));
        move_numbers(copies, gltf_member(gltf_extension(made, "MSFT_lod"), "ids"));
    }
    return copies;
}

/* Skins of copied nodes hang on copied joints. */
static void copy_skins(gltf_draft &draft, const node_map &copies) {
    cJSON *skins = gltf_member(draft.document.get(), "skins");
    std::map<int, int> made;
    for (const auto &[node, copy] : copies) {
        cJSON *holder = draft.lists[gltf_nodes][size_t(copy)];
        int skin = gltf_index(holder, "skin");
        if (skin < 0) continue;
        auto [at, fresh] = made.insert({ skin, cJSON_GetArraySize(skins) });
        if (fresh) {
            gltf_json own = gltf_copy(cJSON_GetArrayItem(skins, skin));
            move_numbers(copies, gltf_member(own.get(), "joints"));
            int skeleton = gltf_index(own.get(), "skeleton");
            if (skeleton >= 0) gltf_set_number(own.get(), "skeleton", moved(copies, skeleton));
            gltf_append(skins, std::move(own));
        }
        gltf_set_number(holder, "skin", at->second);
    }
}

/* What moves a node moves its copy. */
static void copy_channels(gltf_draft &draft, const node_map &copies) {
    for (cJSON *animation : gltf_elements(gltf_member(draft.document.get(), "animations"))) {
        cJSON *channels = gltf_member(animation, "channels");
        for (const cJSON *channel : gltf_elements(channels)) {
            int node = gltf_index(gltf_member(channel, "target"), "node");
            if (!copies.count(node)) continue;
            gltf_json own = gltf_copy(channel);
            gltf_set_number(gltf_member(own.get(), "target"), "node", copies.at(node));
            gltf_append(channels, std::move(own));
        }
    }
}

std::vector<int> gltf_shared_roots(const gltf_asset &asset, int scene) {
    std::vector<int> shared;
    if (scene < 0) return shared;
    std::set<int> others;
    for (size_t s = 0; s < asset.model.scenes.size(); s++)
        if (int(s) != scene) others.insert(asset.model.scenes[s].nodes.begin(), asset.model.scenes[s].nodes.end());
    for (int root : asset.model.scenes[size_t(scene)].nodes)
        if (others.count(root)) shared.push_back(root);
    return shared;
}

void gltf_part_scenes(gltf_draft &draft) {
    if (draft.asset.opens_scene) gltf_set_number(draft.document.get(), "scene", draft.asset.scene);
    draft.kept_users.assign(draft.asset.model.meshes.size(), 0);
    std::vector<cJSON *> scenes = gltf_elements(gltf_member(draft.document.get(), "scenes"));
    for (int root : gltf_shared_roots(draft.asset, draft.asset.scene)) {
        node_map copies = copy_nodes(draft, root);
        copy_skins(draft, copies);
        copy_channels(draft, copies);
        for (size_t s = 0; s < scenes.size(); s++)
            if (int(s) != draft.asset.scene)
                for (cJSON *number : gltf_elements(gltf_member(scenes[s], "nodes")))
                    if (gltf_is_number(number) && number->valueint == root) gltf_change_number(number, copies.at(root));
    }
}
