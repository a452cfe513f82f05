/* SPDX-License-Identifier: MIT
 * How does light come onto what is skinned or morphed? Its vertices stay what weights and targets are of, in number and
 * order: it gets a colour on each, and nothing else of it changes.
 */
#include "gltf_model.h"

static const char draco[] = "KHR_draco_mesh_compression";

/* Colours are light now; what would be added to them, or read in their place, goes. */
static void drop_colors(cJSON *primitive) {
    gltf_drop(gltf_member(primitive, "attributes"), "COLOR_0");
    gltf_drop(gltf_member(gltf_extension(primitive, draco), "attributes"), "COLOR_0");
    for (cJSON *target : gltf_elements(gltf_member(primitive, "targets"))) gltf_drop(target, "COLOR_0");
}

/* Draco's points are as many as its decoder finds, whatever the accessors said. */
static void set_counts(gltf_draft &draft, const cJSON *primitive, const gltf_geometry &geometry) {
    const cJSON *packed = gltf_extension(primitive, draco);
    if (!packed) return;
    for (const cJSON *attribute : gltf_elements(gltf_member(primitive, "attributes"))) {
        int index = gltf_index(gltf_member(primitive, "attributes"), attribute->string);
        if (gltf_member(gltf_member(packed, "attributes"), attribute->string) && index >= 0)
            gltf_set_number(draft.lists[gltf_accessors][size_t(index)], "count", geometry.vertex_count);
    }
    int corners = gltf_index(primitive, "indices");
    if (corners >= 0)
        gltf_set_number(draft.lists[gltf_accessors][size_t(corners)], "count", double(geometry.indices.size()));
}

static void add_light(gltf_draft &draft, const gltf_baked_primitive &baked, size_t first, size_t count,
                      cJSON *primitive) {
    cJSON *attributes = gltf_member(primitive, "attributes");
    if (!baked.colors.empty()) gltf_set_number(attributes, "COLOR_0", gltf_add_colors(draft, baked, first, count));
    if (baked.radiosity)
        gltf_set_number(attributes, "_RADIOSITY", gltf_add_floats(draft, baked.radiosity + 3 * first, count, 3));
    if (baked.errors) gltf_set_number(attributes, "_ERROR", gltf_add_floats(draft, baked.errors + first, count, 1));
    for (const gltf_attribute &light : baked.lights)
        gltf_set_number(attributes, light.name.c_str(),
                        gltf_add_floats(draft, light.values.data() + 3 * first, count, 3));
}

cJSON *gltf_light_posed(gltf_draft &draft, const gltf_instance &instance, const gltf_baked_primitive &baked,
                        cJSON *mesh, cJSON *primitive) {
    const gltf_geometry &geometry = *instance.geometry;
    const hemi_mesh_view &view = *baked.view;
    const uint32_t count = geometry.vertex_count, corners = uint32_t(geometry.indices.size());
    if (view.vertex_count % count != 0 || view.triangle_count % (corners / 3) != 0)
        gltf_fail(HEMI_ERROR_ARGUMENT, "%s: it moves, but its vertices were not kept", baked.where.c_str());
    if (!baked.colors.empty()) drop_colors(primitive);
    set_counts(draft, primitive, geometry);
    gltf_count_geometry(draft.stats, baked, view.vertex_count, gltf_plain_bytes(baked));
    cJSON *back = nullptr;
    if (view.vertex_count > count && !gltf_extension(primitive, draco)) { /* packed triangles cannot be turned round */
        std::vector<uint32_t> turned(view.indices + corners, view.indices + 2 * size_t(corners));
        for (uint32_t &corner : turned) corner -= count;
        gltf_json copy = gltf_copy(primitive);
        back = copy.get();
        gltf_append(gltf_member(mesh, "primitives"), std::move(copy));
        gltf_set_number(back, "indices", gltf_add_triangles(draft, turned.data(), turned.size(), count));
        if (gltf_member(back, "mode")) gltf_set_number(back, "mode", TINYGLTF_MODE_TRIANGLES);
        add_light(draft, baked, count, count, back);
    }
    add_light(draft, baked, 0, count, primitive);
    return back;
}
