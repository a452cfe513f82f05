/* SPDX-License-Identifier: MIT
 * Which meshes and materials does the asset have once light is in its vertices? Decides which
 * materials may be replaced where they stand; gltf_meshes.cpp who gets a mesh of its own, gltf_encode.cpp makes the
 * bytes.
 */
#include "gltf_model.h"

#include "geometry/vec3.h"

#include <algorithm>
#include <cmath>

/* Between the two passes a baked primitive names its new material by this: first_pending - (number in the list). */
static const int first_pending = -2;

struct pending_material {
    int source; /* of the asset, or -1: the default */
    bool textured, double_sided, has_variants;
    const cJSON *original = nullptr; /* source in the asset's document */
    int index = -1;                  /* where the copy ended up */
};

/* ---- what goes into a primitive --------------------------------------------------------------------------------- */

static void check_view(const hemi_mesh_view &view, const gltf_baked_mesh &baked, uint32_t mesh) {
    bool valid = view.positions && view.indices && baked.colors && view.vertex_count > 0;
    for (size_t i = 0; valid && i < size_t(view.vertex_count) * 3; i++)
        valid = std::isfinite(view.positions[i]) && std::isfinite(baked.colors[i]) &&
                (!baked.radiosity || std::isfinite(baked.radiosity[i]));
    for (size_t i = 0; valid && i < size_t(view.triangle_count) * 3; i++) valid = view.indices[i] < view.vertex_count;
    for (size_t i = 0; valid && baked.errors && i < view.vertex_count; i++) valid = std::isfinite(baked.errors[i]);
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

/* What each group of lights gives. */
static void take_lights(const gltf_write_desc &desc, uint32_t i, gltf_baked_primitive &out) {
    size_t width = 3 * size_t(out.view->vertex_count);
    for (uint32_t g = 0; desc.lights && g < desc.light_count; g++) {
        const float *from = desc.lights[i] + g * width;
        if (!std::all_of(from, from + width, [](float x) { return std::isfinite(x); }))
            gltf_fail(HEMI_ERROR_ARGUMENT, "baked mesh %u has numbers not finite", i);
        out.lights.push_back({ desc.light_names[g], 3, false, { from, from + width } });
    }
}

static gltf_baked_primitive prepare(const gltf_asset &asset, const gltf_write_desc &desc, uint32_t i) {
    const gltf_instance &instance = asset.instances[i];
    const gltf_baked_mesh &baked = desc.meshes[i];
    gltf_baked_primitive out = {};
    out.view = baked.view;
    out.radiosity = baked.radiosity;
    out.errors = baked.errors;
    out.scale = stretch_of(asset, instance, desc.keep_instances);
    out.where = gltf_text("nodes[%d], primitive %d", instance.node, instance.primitive);
    out.colors.resize(desc.keep_materials ? 0 : size_t(baked.view->vertex_count) * 3);
    for (size_t k = 0; k < out.colors.size(); k++) out.colors[k] = std::clamp(baked.colors[k], 0.0f, 1.0f);
    out.color_width = 3;
    out.float_colors = desc.float_colors;
    out.has_variants = !desc.whole_colors && gltf_has_variants(asset, instance);
    gltf_transfer_attributes(*instance.geometry, desc.keep_materials, out);
    take_lights(desc, i, out);
    if (gltf_covered_material(asset, int(instance.material))) gltf_transfer_alpha(*instance.geometry, out);
    return out;
}

/* ---- materials ------------------------------------------------------------------------------------------------ */

static int find_pending(std::vector<pending_material> &list, const pending_material &wanted) {
    for (size_t i = 0; i < list.size(); i++)
        if (list[i].source == wanted.source && list[i].textured == wanted.textured &&
            list[i].double_sided == wanted.double_sided && list[i].has_variants == wanted.has_variants)
            return int(i);
    list.push_back(wanted);
    return int(list.size()) - 1;
}

static bool is_level_to_bake(const gltf_asset &asset, int material) {
    return material >= 0 && size_t(material) < asset.model.materials.size() &&
           !asset.model.materials[size_t(material)].extensions.count("KHR_materials_unlit");
}

/* The copy of a material, and with it those of its levels of detail, each of which shows the same light. */
static int find_with_levels(const gltf_asset &asset, std::vector<pending_material> &list, pending_material wanted) {
    const int found = find_pending(list, wanted);
    for (int level : gltf_material_levels(asset, wanted.source)) {
        wanted.source = level;
        if (is_level_to_bake(asset, level)) find_pending(list, wanted);
    }
    return found;
}

static std::vector<cJSON *> variant_mappings(const cJSON *primitive) {
    return gltf_elements(gltf_member(gltf_extension(primitive, "KHR_materials_variants"), "mappings"));
}

/* Names the baked copies of a primitive's materials: its own, and those of its other variants. */
static void set_pending(const gltf_asset &asset, cJSON *primitive, std::vector<pending_material> &list,
                        pending_material wanted) {
    wanted.source = gltf_index(primitive, "material");
    gltf_set_number(primitive, "material", first_pending - find_with_levels(asset, list, wanted));
    for (cJSON *mapping : variant_mappings(primitive)) {
        wanted.source = gltf_index(mapping, "material");
        if (wanted.source < 0 || size_t(wanted.source) >= asset.model.materials.size()) continue;
        if (asset.model.materials[size_t(wanted.source)].extensions.count("KHR_materials_unlit")) continue;
        gltf_set_number(mapping, "material", first_pending - find_with_levels(asset, list, wanted));
    }
}

/* Colours of a variant are light that its reflectance multiplies. */
static void set_variant_factor(const gltf_asset &asset, const pending_material &pending, cJSON *copy) {
    double factor[4] = { 1, 1, 1, gltf_base_factor(gltf_find_material(asset, uint32_t(pending.source)), 3) };
    gltf_variant_factor(asset, uint32_t(pending.source), factor);
    gltf_set_numbers(gltf_object(copy, "pbrMetallicRoughness"), "baseColorFactor", factor, 4);
}

/* Materials that some primitive still uses as they were. */
static std::vector<char> kept_materials(const gltf_draft &draft) {
    std::vector<char> kept(draft.lists[gltf_materials].size(), 0);
    auto keep = [&kept, &draft](const cJSON *holder) {
        int material = gltf_index(holder, "material");
        if (material < 0 || size_t(material) >= kept.size()) return;
        kept[size_t(material)] = 1;
        for (int level : gltf_material_levels(draft.asset, material)) kept[size_t(level)] = 1;
    };
    for (const cJSON *mesh : draft.lists[gltf_meshes])
        for (const cJSON *primitive : gltf_elements(gltf_member(mesh, "primitives"))) {
            keep(primitive);
            for (const cJSON *mapping : variant_mappings(primitive)) keep(mapping);
        }
    return kept;
}

static double shown_alpha(const gltf_asset &asset, int material) {
    if (!asset.shadings || material < 0) return 1;
    auto found = asset.shadings->passed.find(uint32_t(material));
    return found == asset.shadings->passed.end() ? 1 : found->second.shown_alpha;
}

/* Puts the copy where its source was, if nobody needs that, or at the end. */
static void place_material(gltf_draft &draft, pending_material &pending, std::vector<char> &kept) {
    const bool named = pending.source >= 0;
    const size_t source = named ? size_t(pending.source) : 0;
    gltf_json copy = gltf_unlit_material(draft.asset, gltf_find_material(draft.asset, uint32_t(pending.source)),
                                         pending.original, pending.textured, shown_alpha(draft.asset, pending.source));
    if (pending.has_variants) set_variant_factor(draft.asset, pending, copy.get());
    if (pending.double_sided) gltf_set(copy.get(), "doubleSided", gltf_json(cJSON_CreateTrue()));
    if (named && !kept[source] && !draft.keeps_numbers) {
        kept[source] = 1; /* a second copy goes elsewhere */
        pending.index = pending.source;
        gltf_replace_element(draft, gltf_materials, source, std::move(copy));
    } else {
        pending.index = gltf_add_element(draft, gltf_materials, std::move(copy));
    }
}

/* Levels of a copy are the copies of its source's levels. */
static void settle_levels(gltf_draft &draft, const std::vector<pending_material> &list) {
    for (const pending_material &pending : list) {
        std::vector<int> levels = gltf_material_levels(draft.asset, pending.source);
        if (levels.empty()) continue;
        for (int &level : levels)
            for (const pending_material &other : list)
                if (other.source == level && other.textured == pending.textured &&
                    other.double_sided == pending.double_sided && other.has_variants == pending.has_variants)
                    level = other.index;
        cJSON *copy = draft.lists[gltf_materials][size_t(pending.index)];
        const std::vector<double> ids(levels.begin(), levels.end());
        gltf_set_numbers(gltf_object(gltf_object(copy, "extensions"), "MSFT_lod"), "ids", ids.data(), ids.size());
    }
}

static void place_materials(gltf_draft &draft, std::vector<pending_material> &list) {
    std::vector<char> kept = kept_materials(draft);
    std::vector<cJSON *> originals = gltf_elements(gltf_member(draft.asset.document.get(), "materials"));
    for (pending_material &pending : list) {
        if (pending.source >= 0) pending.original = originals[size_t(pending.source)];
        place_material(draft, pending, kept);
    }
    auto settle = [&list](cJSON *holder) {
        int material = gltf_index(holder, "material");
        if (material <= first_pending)
            gltf_set_number(holder, "material", list[size_t(first_pending - material)].index);
    };
    for (const cJSON *mesh : draft.lists[gltf_meshes])
        for (cJSON *primitive : gltf_elements(gltf_member(mesh, "primitives"))) {
            settle(primitive);
            for (cJSON *mapping : variant_mappings(primitive)) settle(mapping);
        }
    settle_levels(draft, list);
}

/* So many are prepared before threads share what Draco packs, and no more are in memory twice. */
static const size_t batch_vertices = size_t(1) << 17;

/* ---- the whole ------------------------------------------------------------------------------------------------ */

/* What is baked into one primitive of the draft. */
struct bake_target {
    uint32_t instance;
    int mesh, primitive;
};

/* One target for every primitive of a mesh, though several instances may show it. In order of their meshes. What
 * is out of range is refused before anything reads it. */
static std::vector<bake_target> list_targets(const gltf_draft &draft, const gltf_write_desc &desc,
                                             const std::vector<int> &meshes) {
    std::map<std::pair<int, int>, uint32_t> first;
    for (uint32_t i = 0; i < desc.mesh_count; i++)
        if (desc.meshes[i].view) first.insert({ { meshes[i], draft.asset.instances[i].primitive }, i });
    std::vector<bake_target> targets;
    for (const auto &[at, instance] : first) {
        const gltf_baked_mesh &baked = desc.meshes[instance];
        if (baked.view->triangle_count > 0) check_view(*baked.view, baked, instance);
        targets.push_back({ instance, at.first, at.second });
    }
    return targets;
}

/* How far the positions of each mesh reach, in the frame of its node. */
static std::vector<double> extents_of(const gltf_write_desc &desc, const std::vector<bake_target> &targets) {
    std::vector<double> extents;
    double low[3], high[3];
    for (size_t t = 0; t < targets.size(); t++) {
        if (t == 0 || targets[t].mesh != targets[t - 1].mesh) {
            extents.push_back(0);
            for (size_t k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
        }
        const hemi_mesh_view &view = *desc.meshes[targets[t].instance].view;
        for (size_t i = 0; view.triangle_count > 0 && i < 3 * size_t(view.vertex_count); i++) {
            low[i % 3] = std::fmin(low[i % 3], double(view.positions[i]));
            high[i % 3] = std::fmax(high[i % 3], double(view.positions[i]));
        }
        for (size_t k = 0; k < 3; k++) extents.back() = std::fmax(extents.back(), high[k] - low[k]);
    }
    return extents;
}

static bool textured(const gltf_baked_primitive &baked) {
    return std::any_of(baked.transferred.begin(), baked.transferred.end(),
                       [](const gltf_attribute &attribute) { return attribute.name.compare(0, 9, "TEXCOORD_") == 0; });
}

static void set_attributes(cJSON *attributes, const std::map<std::string, int> &numbers) {
    for (const cJSON *old : gltf_elements(attributes))
        if (!numbers.count(old->string)) gltf_drop(attributes, std::string(old->string).c_str());
    for (const auto &[name, number] : numbers) gltf_set_number(attributes, name.c_str(), number);
}

/* Members in the order of their names, if the primitive had no such extension. */
static void set_draco(cJSON *primitive, const gltf_encoded_primitive &encoded) {
    cJSON *draco = gltf_object(gltf_object(primitive, "extensions"), "KHR_draco_mesh_compression");
    set_attributes(gltf_object(draco, "attributes"), encoded.draco_ids);
    gltf_set_number(draco, "bufferView", encoded.draco_view);
}

static void place_primitive(gltf_draft &draft, const gltf_write_desc &desc, const gltf_baked_primitive &baked,
                            const gltf_encoded_primitive &encoded, cJSON *out,
                            std::vector<pending_material> &materials) {
    set_attributes(gltf_object(out, "attributes"), encoded.attributes);
    gltf_set_number(out, "indices", encoded.indices);
    if (!desc.keep_materials)
        set_pending(draft.asset, out, materials, { -1, textured(baked), false, baked.has_variants });
    if (gltf_member(out, "mode")) gltf_set_number(out, "mode", TINYGLTF_MODE_TRIANGLES);
    if (desc.draco)
        set_draco(out, encoded);
    else
        gltf_drop_extension(out, "KHR_draco_mesh_compression");
    gltf_drop_extension(out, "FB_ngon_encoding");
}

/* What is skinned or morphed. Backs that cannot be triangles of their own show the light of the fronts. */
static void bake_posed(gltf_draft &draft, const gltf_write_desc &desc, uint32_t i, cJSON *mesh, cJSON *primitive,
                       std::vector<pending_material> &materials) {
    const gltf_baked_primitive baked = prepare(draft.asset, desc, i);
    cJSON *back = gltf_light_posed(draft, draft.asset.instances[i], baked, mesh, primitive);
    if (desc.keep_materials) return;
    bool both = !back && gltf_find_material(draft.asset, draft.asset.instances[i].material).doubleSided;
    set_pending(draft.asset, primitive, materials, { -1, textured(baked), both, baked.has_variants });
    if (back) set_pending(draft.asset, back, materials, { -1, textured(baked), false, baked.has_variants });
}

/* What is baked of one mesh, and the primitives of the document that it is for. */
struct lit_mesh {
    std::vector<cJSON *> primitives{};
    std::vector<gltf_baked_primitive> baked{};
    gltf_grids grids{};
};

/* All primitives of one mesh: targets[begin] to targets[end-1]. What is posed is in its place already. */
static lit_mesh prepare_mesh(gltf_draft &draft, const gltf_write_desc &desc, const std::vector<bake_target> &targets,
                             size_t begin, size_t end, double shared_step, std::vector<pending_material> &materials) {
    cJSON *mesh = draft.lists[gltf_meshes][size_t(targets[begin].mesh)];
    std::vector<cJSON *> primitives = gltf_elements(gltf_member(mesh, "primitives"));
    lit_mesh out;
    for (size_t t = begin; t < end; t++) {
        uint32_t i = targets[t].instance;
        cJSON *primitive = primitives[size_t(targets[t].primitive)];
        if (desc.meshes[i].view->triangle_count == 0) {
            set_attributes(gltf_member(primitive, "attributes"), {});
            continue;
        }
        if (draft.asset.instances[i].posed) {
            bake_posed(draft, desc, i, mesh, primitive, materials);
            continue;
        }
        out.baked.push_back(prepare(draft.asset, desc, i));
        out.primitives.push_back(primitive);
    }
    out.grids = gltf_shared_grids(out.baked, shared_step, gltf_position_bits(desc.draco_bits));
    return out;
}

/* Threads share what is in the batch, which is empty then. */
static void bake_batch(gltf_draft &draft, const gltf_write_desc &desc, std::vector<lit_mesh> &batch,
                       std::vector<pending_material> &materials) {
    std::vector<gltf_to_encode> list;
    for (const lit_mesh &mesh : batch)
        for (const gltf_baked_primitive &baked : mesh.baked) list.push_back({ &baked, &mesh.grids });
    std::vector<gltf_encoded_primitive> encoded = gltf_encode(draft, list, desc);
    size_t k = 0;
    for (const lit_mesh &mesh : batch)
        for (cJSON *primitive : mesh.primitives) {
            place_primitive(draft, desc, *list[k].baked, encoded[k], primitive, materials);
            k++;
        }
    batch.clear();
}

/* Those that were left without triangles. */
static void drop_empty_primitives(const cJSON *mesh) {
    cJSON *primitives = gltf_member(mesh, "primitives");
    for (cJSON *primitive : gltf_elements(primitives))
        if (!gltf_member(primitive, "attributes")->child)
            cJSON_Delete(cJSON_DetachItemViaPointer(primitives, primitive));
}

void gltf_apply_bake(gltf_draft &draft, const gltf_write_desc &desc) {
    std::vector<pending_material> materials;
    gltf_part_scenes(draft);
    std::vector<bake_target> targets = list_targets(draft, desc, gltf_separate_meshes(draft, desc));
    const double step =
        desc.draco ? gltf_shared_step(extents_of(desc, targets), gltf_position_bits(desc.draco_bits)) : 0;
    std::vector<lit_mesh> batch;
    size_t vertices = 0;
    for (size_t begin = 0, end; begin < targets.size(); begin = end) {
        for (end = begin; end < targets.size() && targets[end].mesh == targets[begin].mesh;) end++;
        batch.push_back(prepare_mesh(draft, desc, targets, begin, end, step, materials));
        for (const gltf_baked_primitive &baked : batch.back().baked) vertices += baked.view->vertex_count;
        if (vertices < batch_vertices && end < targets.size()) continue;
        bake_batch(draft, desc, batch, materials);
        vertices = 0;
    }
    for (const cJSON *mesh : draft.lists[gltf_meshes]) drop_empty_primitives(mesh);
    gltf_drop_empty_meshes(draft);
    place_materials(draft, materials);
}
