/* SPDX-License-Identifier: MIT
 * What does an asset ask of a bake itself? extras.hemibake of a node is for it and all below it, that of a material for
 * what has it; a node that says something goes before its material.
 *
 *     { "bake": false, "castShadow": false, "elementSize": 0.05, "emission": 2, "group": "desk",
 *       "normals": "faces" }
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>

static const char *const known_keys[] = { "bake", "castShadow", "elementSize", "emission", "group", "normals" };

/* Editors keep truth as 0 and 1. */
static bool read_truth(const tinygltf::Value &value, int &out) {
    bool ok =
        value.IsBool() || (value.IsNumber() && (value.GetNumberAsDouble() == 0 || value.GetNumberAsDouble() == 1));
    if (ok) out = value.IsBool() ? value.Get<bool>() : value.GetNumberAsDouble() != 0;
    return ok;
}

static bool read_size(const tinygltf::Value &value, double &out) {
    double size = value.IsNumber() ? value.GetNumberAsDouble() : 0;
    if (!(size > 0) || std::isinf(size)) return false;
    out = size;
    return true;
}

static bool read_normals(const tinygltf::Value &value, int &out) {
    if (!value.IsString()) return false;
    const std::string &word = value.Get<std::string>();
    if (word != "file" && word != "faces") return false;
    out = word == "faces";
    return true;
}

static bool read_group(const tinygltf::Value &value, std::string &out) {
    if (!value.IsString() || value.Get<std::string>().empty()) return false;
    out = value.Get<std::string>();
    return true;
}

static bool is_emission(const tinygltf::Value &value) {
    auto is_amount = [](const tinygltf::Value &v) {
        return v.IsNumber() && v.GetNumberAsDouble() >= 0 && v.GetNumberAsDouble() <= 1e30;
    };
    if (!value.IsArray()) return is_amount(value);
    return value.ArrayLen() == 3 && is_amount(value.Get(0)) && is_amount(value.Get(1)) && is_amount(value.Get(2));
}

static bool read_one(const std::string &key, const tinygltf::Value &value, bool of_material, gltf_steering &out) {
    if (key == "bake") return read_truth(value, out.bake);
    if (key == "castShadow") return read_truth(value, out.casts_shadow);
    if (key == "elementSize") return read_size(value, out.element_size);
    if (key == "normals") return read_normals(value, out.facets);
    if (key == "group" && of_material) return read_group(value, out.group);
    return key == "emission" && of_material && is_emission(value);
}

static const tinygltf::Value *steering_of(const tinygltf::Value &extras) {
    if (!extras.IsObject() || !extras.Has("hemibake")) return nullptr;
    return &extras.Get("hemibake");
}

gltf_steering gltf_read_steering(gltf_asset &asset, const tinygltf::Value &extras, const std::string &subject,
                                 bool of_material) {
    gltf_steering out;
    const tinygltf::Value *found = steering_of(extras);
    if (!found) return out;
    if (!found->IsObject()) gltf_note(asset, subject, "its extras.hemibake is no object and is passed over");
    for (const std::string &key : found->IsObject() ? found->Keys() : std::vector<std::string>()) {
        if (read_one(key, found->Get(key), of_material, out)) continue;
        bool is_known = std::find(std::begin(known_keys), std::end(known_keys), key) != std::end(known_keys);
        gltf_note(asset, subject,
                  gltf_text("its extras.hemibake.%s is %s and is passed over", gltf_printable(key, 32).c_str(),
                            (key == "emission" || key == "group") && !of_material ? "for materials"
                            : is_known                                            ? "not what that takes"
                                                                                  : "not known"));
    }
    return out;
}

static gltf_steering steered(const gltf_steering &first, const gltf_steering &second) {
    gltf_steering out = first;
    if (out.bake < 0) out.bake = second.bake;
    if (out.casts_shadow < 0) out.casts_shadow = second.casts_shadow;
    if (out.facets < 0) out.facets = second.facets;
    if (!(out.element_size > 0)) out.element_size = second.element_size;
    if (out.group.empty()) out.group = second.group;
    return out;
}

gltf_steering gltf_steer(gltf_asset &asset, int node, const gltf_steering &above) {
    const tinygltf::Node &source = asset.model.nodes[size_t(node)];
    return steered(gltf_read_steering(asset, source.extras, gltf_text("node %d", node), false), above);
}

/* What is left out of a bake and yet stands in no light's way is no part of it; to be lit and stand in no light's way
 * is more than the solver can. */
void gltf_steer_instances(gltf_asset &asset) {
    std::vector<gltf_steering> materials;
    for (size_t m = 0; m < asset.model.materials.size(); m++)
        materials.push_back(
            gltf_read_steering(asset, asset.model.materials[m].extras, gltf_text("material %zu", m), true));
    for (gltf_instance &instance : asset.instances) {
        if (instance.material < materials.size())
            instance.steering = steered(instance.steering, materials[instance.material]);
        const gltf_steering &own = instance.steering;
        if (own.bake == 0)
            gltf_note(asset, gltf_text("node %d", instance.node),
                      own.casts_shadow == 0 ? "left out of the bake, as its extras ask"
                                            : "not baked, as its extras ask; it stands in the way of light");
        else if (own.casts_shadow == 0)
            gltf_note(asset, gltf_text("node %d", instance.node),
                      "what is baked casts shadows: castShadow false is for what has bake false too");
    }
}

void gltf_steer_emission(const tinygltf::Material &material, double emission[3]) {
    const tinygltf::Value *found = steering_of(material.extras);
    if (!found || !found->IsObject() || !found->Has("emission") || !is_emission(found->Get("emission"))) return;
    const tinygltf::Value &value = found->Get("emission");
    for (size_t c = 0; c < 3; c++)
        emission[c] = value.IsArray() ? value.Get(c).GetNumberAsDouble() : emission[c] * value.GetNumberAsDouble();
}

bool gltf_asset_mesh_steering(const gltf_asset *asset, uint32_t mesh, gltf_mesh_steering *out) {
    if (mesh >= asset->instances.size()) return false;
    const gltf_steering &own = asset->instances[mesh].steering;
    *out = { own.bake == 0 && own.casts_shadow == 0, own.facets == 1, own.element_size,
             own.group.empty() ? nullptr : own.group.c_str() };
    return true;
}

bool gltf_asset_mesh_is_left(const gltf_asset *asset, uint32_t mesh) {
    return gltf_asset_mesh_is_unlit(asset, mesh) ||
           (mesh < asset->instances.size() && asset->instances[mesh].steering.bake == 0);
}
