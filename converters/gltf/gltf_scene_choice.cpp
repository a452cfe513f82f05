/* SPDX-License-Identifier: MIT
 * Which scene is baked, in which variant, and which of its nodes are shown? KHR_node_visibility hides subtrees;
 * MSFT_lod says which nodes stand in for others from afar, and are mostly part of no scene; KHR_materials_variants says
 * which material a primitive has in a variant.
 */
#include "gltf_model.h"

#include <cstdlib>

/* ---- scenes ---------------------------------------------------------------------------------------------------- */

uint32_t gltf_asset_scene_count(const gltf_asset *asset) {
    return uint32_t(asset->model.scenes.size());
}

static std::string quoted(const std::string &name) {
    return name.empty() ? "" : " \"" + gltf_printable(name) + "\"";
}

/* The number of the scene that is asked for: a name goes before a number. */
static int find_scene(const tinygltf::Model &model, const std::string &wanted) {
    for (size_t s = 0; s < model.scenes.size(); s++)
        if (model.scenes[s].name == wanted) return int(s);
    char *end = nullptr;
    unsigned long number = std::strtoul(wanted.c_str(), &end, 10);
    bool is_number = !wanted.empty() && wanted[0] >= '0' && wanted[0] <= '9' && !*end;
    if (is_number && number < model.scenes.size()) return int(number);
    std::string names;
    for (size_t s = 0; s < model.scenes.size() && s < 16; s++)
        names += gltf_text("%s%zu%s", s ? ", " : "", s, quoted(model.scenes[s].name).c_str());
    gltf_fail(HEMI_ERROR_DATA, "there is no scene '%s'; the asset has %s", gltf_printable(wanted).c_str(),
              names.empty() ? "none" : names.c_str());
}

static void note_other_scenes(gltf_asset &asset) {
    for (size_t s = 0; s < asset.model.scenes.size(); s++)
        if (int(s) != asset.scene)
            gltf_note(asset, gltf_text("scene %zu%s", s, quoted(asset.model.scenes[s].name).c_str()),
                      "not baked, another scene is; --scene bakes one by its name or number, or all");
}

static void note_shared_nodes(gltf_asset &asset) {
    for (int node : gltf_shared_roots(asset, asset.scene))
        gltf_note(asset, gltf_text("node %d%s", node, quoted(asset.model.nodes[size_t(node)].name).c_str()),
                  "another scene shows it too, and gets a copy as it was");
}

std::vector<int> gltf_choose_scene(gltf_asset &asset, const char *wanted) {
    const tinygltf::Model &model = asset.model;
    asset.scene = wanted                    ? find_scene(model, wanted)
                  : model.defaultScene >= 0 ? model.defaultScene
                  : model.scenes.empty()    ? -1
                                            : 0;
    note_other_scenes(asset);
    note_shared_nodes(asset);
    if (asset.scene >= 0) return model.scenes[size_t(asset.scene)].nodes;
    std::vector<bool> child(model.nodes.size(), false);
    for (const tinygltf::Node &node : model.nodes)
        for (int c : node.children) child[size_t(c)] = true;
    std::vector<int> roots;
    for (size_t n = 0; n < child.size(); n++)
        if (!child[n]) roots.push_back(int(n));
    return roots;
}

/* ---- what is shown --------------------------------------------------------------------------------------------- */

bool gltf_node_is_hidden(const tinygltf::Node &node) {
    auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return false;
    const tinygltf::Value &visible = found->second.Get("visible");
    return visible.IsBool() && !visible.Get<bool>();
}

/* Nodes that stand in for a node, from near to far. */
static std::vector<int> levels_of(const tinygltf::Model &model, size_t node) {
    std::vector<int> levels;
    auto found = model.nodes[node].extensions.find("MSFT_lod");
    if (found == model.nodes[node].extensions.end() || !found->second.Has("ids")) return levels;
    const tinygltf::Value &ids = found->second.Get("ids");
    for (size_t i = 0; ids.IsArray() && i < ids.ArrayLen(); i++) {
        if (!ids.Get(int(i)).IsInt())
            gltf_fail(HEMI_ERROR_DATA, "nodes[%zu].extensions.MSFT_lod.ids[%zu] is no index", node, i);
        gltf_check_index(ids.Get(int(i)).Get<int>(), model.nodes.size(), "nodes",
                         gltf_text("nodes[%zu].extensions.MSFT_lod.ids[%zu]", node, i));
        levels.push_back(ids.Get(int(i)).Get<int>());
    }
    return levels;
}

std::map<int, gltf_detail> gltf_find_levels(const tinygltf::Model &model, const std::vector<int> &roots) {
    std::vector<char> shown(model.nodes.size(), 0);
    std::vector<int> stack = roots;
    while (!stack.empty()) {
        int node = stack.back();
        stack.pop_back();
        if (gltf_node_is_hidden(model.nodes[size_t(node)])) continue;
        shown[size_t(node)] = 1;
        const std::vector<int> &children = model.nodes[size_t(node)].children;
        stack.insert(stack.end(), children.begin(), children.end());
    }
    std::map<int, gltf_detail> levels;
    for (size_t n = 0; n < model.nodes.size(); n++) {
        if (!shown[n] || levels.count(int(n))) continue; /* a level of a level is none */
        int number = 0;
        for (int level : levels_of(model, n))
            if (level != int(n)) levels.insert({ level, { int(n), ++number } });
    }
    return levels;
}

/* ---- variants ------------------------------------------------------------------------------------------------------
 */

static const char extension[] = "KHR_materials_variants";

static std::vector<std::string> variant_names(const tinygltf::Model &model) {
    std::vector<std::string> names;
    auto found = model.extensions.find(extension);
    if (found == model.extensions.end() || !found->second.Has("variants")) return names;
    const tinygltf::Value &list = found->second.Get("variants");
    for (size_t i = 0; list.IsArray() && i < list.ArrayLen(); i++) {
        const tinygltf::Value &variant = list.Get(int(i));
        bool named = variant.IsObject() && variant.Has("name") && variant.Get("name").IsString();
        names.push_back(named ? variant.Get("name").Get<std::string>() : "");
    }
    return names;
}

static int find_variant(const tinygltf::Model &model, const std::string &wanted) {
    std::vector<std::string> names = variant_names(model);
    std::string all;
    for (size_t i = 0; i < names.size(); i++) {
        if (names[i] == wanted) return int(i);
        if (i < 16) all += (i ? ", " : "") + gltf_printable(names[i]);
    }
    gltf_fail(HEMI_ERROR_DATA, "--variant: there is no variant '%s'; the asset has %s", gltf_printable(wanted).c_str(),
              all.empty() ? "none" : all.c_str());
}

/* The material that a primitive has in a variant; -1: its own. */
static int mapped_material(const tinygltf::Primitive &primitive, int variant) {
    auto found = primitive.extensions.find(extension);
    if (found == primitive.extensions.end() || !found->second.Has("mappings")) return -1;
    const tinygltf::Value &mappings = found->second.Get("mappings");
    for (size_t i = 0; mappings.IsArray() && i < mappings.ArrayLen(); i++) {
        const tinygltf::Value &mapping = mappings.Get(int(i));
        if (!mapping.IsObject() || !mapping.Has("material") || !mapping.Get("material").IsInt()) continue;
        if (!mapping.Has("variants") || !mapping.Get("variants").IsArray()) continue;
        const tinygltf::Value &variants = mapping.Get("variants");
        for (size_t k = 0; k < variants.ArrayLen(); k++)
            if (variants.Get(int(k)).IsInt() && variants.Get(int(k)).Get<int>() == variant)
                return mapping.Get("material").Get<int>();
    }
    return -1;
}

void gltf_choose_variant(gltf_asset &asset, const char *wanted) {
    if (!wanted) return;
    int variant = find_variant(asset.model, wanted);
    std::vector<cJSON *> meshes = gltf_elements(gltf_member(asset.document.get(), "meshes"));
    for (size_t m = 0; m < asset.model.meshes.size(); m++) {
        std::vector<cJSON *> texts = gltf_elements(gltf_member(meshes[m], "primitives"));
        std::vector<tinygltf::Primitive> &primitives = asset.model.meshes[m].primitives;
        for (size_t p = 0; p < primitives.size(); p++) {
            int material = mapped_material(primitives[p], variant);
            if (material < 0) continue;
            gltf_check_index(material, asset.model.materials.size(), "materials",
                             gltf_text("meshes[%zu].primitives[%zu].extensions.%s", m, p, extension));
            primitives[p].material = material;
            gltf_set_number(texts[p], "material", material); /* what the output shows first */
        }
    }
}
