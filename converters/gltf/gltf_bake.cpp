/* SPDX-License-Identifier: MIT
 * Which meshes and materials does the asset have once light is in its vertices? Decides which
 * materials may be replaced where they stand; gltf_meshes.cpp who gets a mesh of its own, gltf_encode.cpp makes the
 * bytes.
 */
#include "gltf_model.h"

#include "gltf_json.h"

#include "geometry/vec3.h"

#include <algorithm>
#include <cmath>

/* Between the two passes a baked primitive names its new material by this: first_pending - (number in the list). */
static const int first_pending = -2;

struct pending_material {
    int source; /* of the asset, or -1: the default */
    bool textured;
    int index = -1; /* where the copy ended up */
};

/* ---- what goes into a primitive --------------------------------------------------------------------------------- */

static void check_view(const hemi_mesh_view &view, const gltf_baked_mesh &baked, uint32_t mesh) {
    bool valid = view.positions && view.indices && baked.colors && view.vertex_count > 0;
    for (size_t i = 0; valid && i < size_t(view.vertex_count) * 3; i++)
        valid = std::isfinite(view.positions[i]) && std::isfinite(baked.colors[i]) &&
                (!baked.radiosity || std::isfinite(baked.radiosity[i]));
    for (size_t i = 0; valid && i < size_t(view.triangle_count) * 3; i++) valid = view.indices[i] < view.vertex_count;
    if (!valid) gltf_fail(HEMI_ERROR_ARGUMENT, "baked mesh %u has indices out of range or numbers not finite", mesh);
}

/* The largest factor by which m stretches a length: the root of the largest eigenvalue of M^T M, by power iteration. */
static double largest_stretch(const double *m) {
    double x[3] = { 1, 1, 1 }, length = 0;
    for (int step = 0; step < 64; step++) {
        double y[3] = { 0, 0, 0 }, z[3] = { 0, 0, 0 };
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) y[r] += m[4 * c + r] * x[c];
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3; r++) z[c] += m[4 * c + r] * y[r];
        length = vec3_length(z);
        if (!(length > 0)) return 0;
        for (int k = 0; k < 3; k++) x[k] = z[k] / length;
    }
    return std::sqrt(length);
}

/* Instances that go on showing one mesh are all moved by its quantisation. */
static double stretch_of(const gltf_asset &asset, const gltf_instance &instance, bool shared) {
    if (!shared) return largest_stretch(instance.world);
    double largest = 0;
    for (const gltf_instance &other : asset.instances)
        if (other.geometry == instance.geometry) largest = std::fmax(largest, largest_stretch(other.world));
    return largest;
}

static gltf_baked_primitive prepare(const gltf_asset &asset, const gltf_write_desc &desc, uint32_t i) {
    const gltf_instance &instance = asset.instances[i];
    const gltf_baked_mesh &baked = desc.meshes[i];
    gltf_baked_primitive out = {};
    out.view = baked.view;
    out.radiosity = baked.radiosity;
    out.scale = stretch_of(asset, instance, desc.keep_instances);
    out.where = gltf_text("nodes[%d], primitive %d", instance.node, instance.primitive);
    out.colors.resize(desc.keep_materials ? 0 : size_t(baked.view->vertex_count) * 3);
    for (size_t k = 0; k < out.colors.size(); k++) out.colors[k] = std::clamp(baked.colors[k], 0.0f, 1.0f);
    out.color_width = 3;
    gltf_carry_attributes(*instance.geometry, desc.keep_materials, out);
    if (gltf_masked_material(asset, int(instance.material))) gltf_carry_alpha(*instance.geometry, out);
    return out;
}

/* ---- materials ------------------------------------------------------------------------------------------------ */

static int find_pending(std::vector<pending_material> &list, int source, bool textured) {
    for (size_t i = 0; i < list.size(); i++)
        if (list[i].source == source && list[i].textured == textured) return int(i);
    list.push_back({ source, textured });
    return int(list.size()) - 1;
}

static void mark_variants(const tinygltf::Primitive &primitive, std::vector<char> &kept) {
    auto found = primitive.extensions.find("KHR_materials_variants");
    if (found == primitive.extensions.end() || !found->second.Has("mappings")) return;
    const tinygltf::Value &mappings = found->second.Get("mappings");
    for (size_t i = 0; i < mappings.ArrayLen(); i++) {
        const tinygltf::Value &mapping = mappings.Get(int(i));
        if (!mapping.Has("material") || !mapping.Get("material").IsInt()) continue;
        int material = mapping.Get("material").Get<int>();
        if (material >= 0 && size_t(material) < kept.size()) kept[size_t(material)] = 1;
    }
}

/* Materials that some primitive still uses as they were. */
static std::vector<char> kept_materials(const tinygltf::Model &model) {
    std::vector<char> kept(model.materials.size(), 0);
    for (const tinygltf::Mesh &mesh : model.meshes)
        for (const tinygltf::Primitive &primitive : mesh.primitives) {
            if (primitive.material >= 0) kept[size_t(primitive.material)] = 1;
            mark_variants(primitive, kept);
        }
    return kept;
}

static void place_materials(gltf_draft &draft, std::vector<pending_material> &list) {
    tinygltf::Model &model = draft.model;
    std::vector<char> kept = kept_materials(model);
    for (pending_material &pending : list) {
        const tinygltf::Material standard;
        const tinygltf::Material &source =
            pending.source >= 0 ? draft.asset.model.materials[size_t(pending.source)] : standard;
        tinygltf::Material copy = gltf_unlit_copy(source, pending.textured);
        if (pending.source >= 0) copy.extras = tinygltf::Value(GLTF_ORIGIN_REPLACED(pending.source));
        if (pending.source >= 0 && !kept[size_t(pending.source)] && !draft.keeps_numbers) {
            kept[size_t(pending.source)] = 1; /* a second copy goes elsewhere */
            pending.index = pending.source;
            model.materials[size_t(pending.source)] = std::move(copy);
        } else {
            pending.index = int(model.materials.size());
            model.materials.push_back(std::move(copy));
        }
    }
    for (tinygltf::Mesh &mesh : model.meshes)
        for (tinygltf::Primitive &primitive : mesh.primitives)
            if (primitive.material <= first_pending)
                primitive.material = list[size_t(first_pending - primitive.material)].index;
}

/* ---- the whole ------------------------------------------------------------------------------------------------ */

/* What is baked into one primitive of the draft. */
struct bake_target {
    uint32_t instance;
    int mesh, primitive;
};

/* One target for every primitive of a mesh, though several instances may show it. In order of their meshes. */
static std::vector<bake_target> list_targets(const gltf_draft &draft, const gltf_write_desc &desc,
                                             const std::vector<int> &meshes) {
    std::map<std::pair<int, int>, uint32_t> first;
    for (uint32_t i = 0; i < desc.mesh_count; i++)
        if (desc.meshes[i].view) first.insert({ { meshes[i], draft.asset.instances[i].primitive }, i });
    std::vector<bake_target> targets;
    for (const auto &[at, instance] : first) targets.push_back({ instance, at.first, at.second });
    return targets;
}

static bool textured(const gltf_baked_primitive &baked) {
    return std::any_of(baked.carried.begin(), baked.carried.end(),
                       [](const gltf_attribute &attribute) { return attribute.name.compare(0, 9, "TEXCOORD_") == 0; });
}

static void bake_primitive(gltf_draft &draft, const gltf_write_desc &desc, const gltf_baked_primitive &baked,
                           const gltf_grids &grids, tinygltf::Primitive &out,
                           std::vector<pending_material> &materials) {
    out.attributes.clear();
    out.mode = TINYGLTF_MODE_TRIANGLES;
    out.extensions.erase("KHR_draco_mesh_compression");
    out.extensions.erase("FB_ngon_encoding");
    if (!desc.keep_materials) {
        out.extensions.erase("KHR_materials_variants");
        out.material = first_pending - find_pending(materials, out.material, textured(baked));
    }
    if (desc.draco)
        gltf_encode_draco(draft, baked, grids, desc, out);
    else
        gltf_encode_plain(draft, baked, out);
}

/* All primitives of one mesh: targets[begin] to targets[end-1]. */
static void bake_mesh(gltf_draft &draft, const gltf_write_desc &desc, const std::vector<bake_target> &targets,
                      size_t begin, size_t end, std::vector<pending_material> &materials) {
    std::vector<tinygltf::Primitive> &primitives = draft.model.meshes[size_t(targets[begin].mesh)].primitives;
    std::vector<gltf_baked_primitive> baked;
    std::vector<int> numbers;
    for (size_t t = begin; t < end; t++) {
        uint32_t i = targets[t].instance;
        if (desc.meshes[i].view->triangle_count == 0) {
            primitives[size_t(targets[t].primitive)].attributes.clear();
            continue;
        }
        check_view(*desc.meshes[i].view, desc.meshes[i], i);
        baked.push_back(prepare(draft.asset, desc, i));
        numbers.push_back(targets[t].primitive);
    }
    gltf_grids grids = gltf_shared_grids(baked);
    for (size_t k = 0; k < baked.size(); k++)
        bake_primitive(draft, desc, baked[k], grids, primitives[size_t(numbers[k])], materials);
}

static bool is_gone(const tinygltf::Primitive &primitive) {
    return primitive.attributes.empty();
}

void gltf_apply_bake(gltf_draft &draft, const gltf_write_desc &desc) {
    std::vector<pending_material> materials;
    std::vector<bake_target> targets = list_targets(draft, desc, gltf_separate_meshes(draft, desc));
    for (size_t begin = 0, end; begin < targets.size(); begin = end) {
        for (end = begin; end < targets.size() && targets[end].mesh == targets[begin].mesh;) end++;
        bake_mesh(draft, desc, targets, begin, end, materials);
    }
    for (tinygltf::Mesh &mesh : draft.model.meshes)
        mesh.primitives.erase(std::remove_if(mesh.primitives.begin(), mesh.primitives.end(), is_gone),
                              mesh.primitives.end());
    gltf_drop_empty_meshes(draft);
    place_materials(draft, materials);
}
