/* SPDX-License-Identifier: MIT
 * Where do the holes lie that alpha maps make in meshes? Each surface gets the affine map from places on it to texels.
 * Meshes with the same picture share its map, since what has one map is drawn at once: a forest is one call.
 */
#include "build_scene.h"

#include "geometry/triangle.h"

#include <string.h>

static bool is_same(const alpha_mask_map *a, const alpha_mask_map *b) {
    return a->alpha == b->alpha && a->width == b->width && a->height == b->height && a->wrap[0] == b->wrap[0] &&
           a->wrap[1] == b->wrap[1] && a->cutoff == b->cutoff;
}

alpha_mask_map alpha_map_of(const hemi_alpha_mask *given) { /* both enums are in the same order */
    const alpha_mask_wrap u = (alpha_mask_wrap)given->wrap_u, v = (alpha_mask_wrap)given->wrap_v;
    return (alpha_mask_map){ given->alpha, given->width, given->height, { u, v }, given->cutoff };
}

/* One of the maps of the meshes before, or a new one; NULL when out of memory. maps[i] of mesh i, NULL: none. */
static const alpha_mask_map *build_map(bake_scene *f, const hemi_alpha_mask *given, const alpha_mask_map *const *maps,
                                       size_t mesh_index) {
    const alpha_mask_map map = alpha_map_of(given);
    for (size_t i = mesh_index; i-- > 0;) /* most have that of the mesh before */
        if (maps[i] && is_same(maps[i], &map)) return maps[i];
    alpha_mask_map *out = arena_alloc(&f->memory, 1, sizeof *out);
    if (out) *out = map;
    return out;
}

/* From the larger half of a quad, which has an area however thin the other is. */
static bool mask_surface(bake_scene *f, const hemi_mesh_desc *m, const alpha_mask_map *map, double *attributes,
                         surface *out) {
    const double *corner[4], *used[3];
    double values[9];
    int count = surface_corner_count(out);
    for (int i = 0; i < count; i++) corner[i] = scene_vertex(&f->scene, out->corner[i]);
    bool second =
        count == 4 && triangle_area(corner[0], corner[2], corner[3]) > triangle_area(corner[0], corner[1], corner[2]);
    for (int i = 0; i < 3; i++) {
        int k = i > 0 && second ? i + 1 : i;
        used[i] = corner[k];
        bake_scene_attributes(f, m, out->corner[k], attributes);
        memcpy(values + 3 * i, attributes + m->alpha_mask->attribute, 3 * sizeof *values);
    }
    alpha_mask *holes = arena_alloc(&f->memory, 1, sizeof *holes);
    if (!holes) return false;
    *holes = alpha_mask_over_triangle(map, used, values);
    out->holes = holes;
    return true;
}

bool build_masks(bake_scene *f) {
    const alpha_mask_map **maps = arena_alloc(&f->memory, f->mesh_count, sizeof *maps);
    uint32_t widest = 0;
    bool any = false;
    if (!maps) return false;
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        maps[i] = NULL;
        /* A limit surface has the coordinates of its cage. */
        if (!m->alpha_mask || m->triangle_count == 0 || !m->attributes ||
            m->alpha_mask->attribute + 3 > m->attribute_count)
            continue;
        maps[i] = build_map(f, m->alpha_mask, maps, i);
        if (!maps[i]) return false;
        if (m->attribute_count > widest) widest = m->attribute_count;
        any = true;
    }
    if (!any) return true;
    double *attributes = arena_alloc(&f->memory, widest, sizeof *attributes);
    if (!attributes) return false;
    for (size_t i = 0; i < f->scene.surface_count; i++) {
        surface *own = &f->scene.surfaces[i];
        if (maps[own->mesh] && !mask_surface(f, &f->meshes[own->mesh], maps[own->mesh], attributes, own)) return false;
    }
    f->tree = surface_bvh_create(&f->scene);
    f->scene.tree = f->tree;
    return f->tree != NULL;
}
