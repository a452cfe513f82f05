/* SPDX-License-Identifier: MIT
 * Which meshes and materials does the asset have once light is in its vertices? Decides who gets a mesh of his own and
 * which materials may be replaced where they stand; gltf_encode.cpp makes the bytes.
 */
#include "gltf_model.h"

#include "gltf_json.h"

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
        length = std::sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
        if (!(length > 0)) return 0;
        for (int k = 0; k < 3; k++) x[k] = z[k] / length;
    }
    return std::sqrt(length);
}

/* uv of a baked vertex: the barycentric mean of its source triangle's corners. */
static void interpolate(const gltf_geometry &source, const hemi_mesh_view &view, size_t set, std::vector<float> &out) {
    size_t stride = 2 * source.texcoords.size();
    for (size_t v = 0; v < view.vertex_count; v++) {
        const uint32_t *corner = &source.indices[size_t(view.source_triangles[v]) * 3];
        for (size_t k = 0; k < 2; k++) {
            double sum = 0;
            for (size_t i = 0; i < 3; i++)
                sum += double(view.source_weights[3 * v + i]) * source.attributes[stride * corner[i] + 2 * set + k];
            out[2 * v + k] = float(sum);
        }
    }
}

static void take_texcoords(const gltf_geometry &source, const hemi_mesh_view &view, gltf_baked_primitive &out) {
    if (!view.source_triangles || !view.source_weights) return;
    for (size_t v = 0; v < view.vertex_count; v++)
        if (view.source_triangles[v] >= source.indices.size() / 3)
            gltf_fail(HEMI_ERROR_ARGUMENT, "%s: a source triangle is out of range", out.where.c_str());
    out.texcoord_names = source.texcoords;
    for (size_t set = 0; set < source.texcoords.size(); set++) {
        out.texcoords.emplace_back(size_t(view.vertex_count) * 2);
        interpolate(source, view, set, out.texcoords.back());
    }
}

static gltf_baked_primitive prepare(const gltf_instance &instance, const gltf_baked_mesh &baked) {
    gltf_baked_primitive out = {};
    out.view = baked.view;
    out.radiosity = baked.radiosity;
    out.scale = largest_stretch(instance.world);
    out.where = gltf_text("nodes[%d], primitive %d", instance.node, instance.primitive);
    out.colors.resize(size_t(baked.view->vertex_count) * 3);
    for (size_t i = 0; i < out.colors.size(); i++) out.colors[i] = std::clamp(baked.colors[i], 0.0f, 1.0f);
    take_texcoords(*instance.geometry, *baked.view, out);
    return out;
}

/* ---- meshes --------------------------------------------------------------------------------------------------- */

/* The nodes that use each mesh and are not baked; a mesh without any may be replaced in place. */
static std::vector<int> count_keepers(const gltf_asset &asset, const std::vector<char> &baked_node) {
    std::vector<int> keepers(asset.model.meshes.size(), 0);
    for (size_t n = 0; n < asset.model.nodes.size(); n++)
        if (asset.model.nodes[n].mesh >= 0 && !baked_node[n]) keepers[size_t(asset.model.nodes[n].mesh)]++;
    return keepers;
}

/* Gives every node with something baked a mesh of its own: the old slot for the first, if nobody else needs it. */
static void separate_meshes(gltf_draft &draft, const gltf_write_desc &desc) {
    const gltf_asset &asset = draft.asset;
    std::vector<char> baked_node(asset.model.nodes.size(), 0), done = baked_node;
    for (uint32_t i = 0; i < desc.mesh_count; i++)
        if (desc.meshes[i].view) baked_node[size_t(asset.instances[i].node)] = 1;
    std::vector<int> keepers = count_keepers(asset, baked_node);
    for (uint32_t i = 0; i < desc.mesh_count; i++) {
        const gltf_instance &instance = asset.instances[i];
        size_t node = size_t(instance.node), mesh = size_t(instance.mesh);
        if (!baked_node[node] || done[node]) continue;
        done[node] = 1;
        if (keepers[mesh]++ == 0) continue;
        draft.model.nodes[node].mesh = int(draft.model.meshes.size());
        draft.model.meshes.push_back(draft.model.meshes[mesh]);
    }
}

/* Meshes that lost their last node, or their last primitive, go. */
static void drop_empty_meshes(gltf_draft &draft) {
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
    }
    for (tinygltf::Mesh &mesh : kept) /* nobody shows it, but an extension may name it */
        if (mesh.primitives.empty())
            mesh.primitives = draft.asset.model.meshes[size_t(mesh.extras.GetNumberAsInt())].primitives;
    model.meshes = std::move(kept);
    for (tinygltf::Node &node : model.nodes)
        if (node.mesh >= 0) node.mesh = moved[size_t(node.mesh)];
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
        if (pending.source >= 0 && !kept[size_t(pending.source)]) {
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

static void bake_primitive(gltf_draft &draft, const gltf_write_desc &desc, uint32_t i, tinygltf::Primitive &out,
                           std::vector<pending_material> &materials) {
    const gltf_instance &instance = draft.asset.instances[i];
    int source = out.material;
    check_view(*desc.meshes[i].view, desc.meshes[i], i);
    gltf_baked_primitive baked = prepare(instance, desc.meshes[i]);
    out.attributes.clear();
    out.mode = TINYGLTF_MODE_TRIANGLES;
    out.extensions.erase("KHR_draco_mesh_compression");
    out.extensions.erase("KHR_materials_variants");
    out.material = first_pending - find_pending(materials, source, !baked.texcoords.empty());
    if (desc.draco)
        gltf_encode_draco(draft, baked, desc, out);
    else
        gltf_encode_plain(draft, baked, out);
}

static bool is_gone(const tinygltf::Primitive &primitive) {
    return primitive.attributes.empty();
}

void gltf_apply_bake(gltf_draft &draft, const gltf_write_desc &desc) {
    const gltf_asset &asset = draft.asset;
    std::vector<pending_material> materials;
    separate_meshes(draft, desc);
    for (uint32_t i = 0; i < desc.mesh_count; i++) {
        if (!desc.meshes[i].view) continue;
        tinygltf::Node &node = draft.model.nodes[size_t(asset.instances[i].node)];
        tinygltf::Primitive &primitive =
            draft.model.meshes[size_t(node.mesh)].primitives[size_t(asset.instances[i].primitive)];
        if (desc.meshes[i].view->triangle_count > 0)
            bake_primitive(draft, desc, i, primitive, materials);
        else
            primitive.attributes.clear();
    }
    for (tinygltf::Mesh &mesh : draft.model.meshes)
        mesh.primitives.erase(std::remove_if(mesh.primitives.begin(), mesh.primitives.end(), is_gone),
                              mesh.primitives.end());
    drop_empty_meshes(draft);
    place_materials(draft, materials);
}
