/* SPDX-License-Identifier: MIT
 * How do the leaves of refined elements become a mesh? Patches stay what they are; their elements are the leaves.
 */
#include "build_scene.h"

#include <string.h>

/* The tessellation's arrays may have moved when vertices were added. */
void bake_scene_follow(bake_scene *f) {
    f->scene.vertices = f->pieces.positions;
    f->mesh.vertices = f->pieces.positions;
    f->mesh.nodes = f->pieces.nodes;
    f->mesh.node_count = f->pieces.node_count;
}

static void set_element(const bake_scene *f, const tessellate_leaf *leaf, element *out) {
    memcpy(out->corner, leaf->corner, sizeof out->corner);
    memcpy(out->mid, leaf->mid, sizeof out->mid);
    out->cut = leaf->cut;
    out->material = f->mesh.elements[leaf->base].material;
}

bool build_leaves(const bake_scene *f, const tessellate_leaf *leaves, uint32_t count, bool fresh_only, arena *memory,
                  mesh *out) {
    size_t elements = 0, next = 0;
    for (uint32_t i = 0; i < count; i++) elements += !fresh_only || leaves[i].fresh;
    *out = (mesh){ .memory = f->mesh.memory,
                   .vertices = f->pieces.positions,
                   .vertex_count = f->pieces.vertex_count,
                   .nodes = f->pieces.nodes,
                   .node_count = f->pieces.node_count,
                   .patch_count = f->mesh.patch_count,
                   .element_count = elements,
                   .clustering = f->mesh.clustering };
    out->patches = arena_alloc(memory, out->patch_count, sizeof *out->patches);
    out->elements = arena_alloc(memory, elements, sizeof *out->elements);
    if (!out->patches || !out->elements) return false;
    uint32_t leaf = 0;
    for (size_t p = 0; p < out->patch_count; p++) {
        const patch *from = &f->mesh.patches[p];
        out->patches[p] = *from;
        out->patches[p].first_element = (uint32_t)next;
        for (; leaf < count && leaves[leaf].base < from->first_element + from->element_count; leaf++)
            if (!fresh_only || leaves[leaf].fresh) set_element(f, &leaves[leaf], &out->elements[next++]);
        out->patches[p].element_count = (uint32_t)next - out->patches[p].first_element;
    }
    return build_measure(f, memory, out);
}

hemi_result take_leaves(const hemi_scene *in, bake_scene *f, const tessellate_leaf *leaves, uint32_t count,
                        const mesh *whole) {
    uint32_t leaf = 0;
    for (size_t i = 0; i < f->mesh_count; i++) {
        tessellate_range *r = &f->ranges[i];
        uint32_t end = f->pieces.ranges[i].first_element + f->pieces.ranges[i].element_count;
        r->first_element = leaf;
        while (leaf < count && leaves[leaf].base < end) leaf++;
        r->element_count = leaf - r->first_element;
    }
    f->mesh = *whole;
    if (!f->demodulated) return HEMI_OK;
    mesh_set_materials(&f->mesh, &f->scene);
    return build_textures(in, f);
}
