/* SPDX-License-Identifier: MIT
 * See build_scene.h.
 */
#include "build_scene.h"

#include "flat_faces.h"
#include "proxy_mesh.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "mesh/cluster.h"
#include "scene/coplanar_overlap.h"
#include "scene/intersections.h"
#include "scene/neighbours.h"

#include <hemibake/mesh_transform.h>

#include <string.h>

static const double PI = 3.14159265358979323846;

/* The longest diagonal of a cluster's box, in edges of a patch: about that of a square patch. */
static const double CLUSTER_SIZE = 1.5;

/* Up to so many emitters each shoots alone, with a shadow of its own. Among more no shadow is that of one. */
enum { EMITTERS_ALONE = 256 };

double mesh_desc_area(const hemi_mesh_desc *m) {
    double area = 0.0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], u[3], v[3], n[3];
        for (int k = 0; k < 3; k++)
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + k], p[k]);
        vec3_sub(u, p[1], p[0]);
        vec3_sub(v, p[2], p[0]);
        vec3_cross(n, u, v);
        area += 0.5 * vec3_length(n);
    }
    return area;
}

double bake_scene_area(const bake_scene *f) {
    double area = 0.0;
    for (size_t i = 0; i < f->mesh_count; i++) area += mesh_desc_area(&f->meshes[i]);
    return area;
}

/* ---- materials, surfaces
 * --------------------------------------------------------------------------------------------- */

static bool build_materials(const hemi_scene *in, bake_scene *f) {
    material *out = arena_alloc(&f->memory, in->material_count, sizeof *out);
    if (!out) return false;
    for (size_t i = 0; i < in->material_count; i++)
        for (int c = 0; c < 3; c++) {
            out[i].rho[c] = in->materials[i].reflectance[c];
            out[i].M[c] = PI * in->materials[i].emission[c];
        }
    f->scene.materials = out;
    f->scene.material_count = in->material_count;
    return true;
}

static bool build_surfaces(const hemi_scene *in, bake_scene *f) {
    const tessellation *t = &f->pieces;
    surface *out = arena_alloc(&f->memory, t->surface_count, sizeof *out);
    if (!out) return false;
    f->scene.vertices = t->positions;
    f->scene.vertex_count = t->vertex_count;
    f->scene.surfaces = out;
    f->scene.surface_count = t->surface_count;
    for (size_t i = 0; i < t->surface_count; i++) {
        memcpy(out[i].corner, t->surfaces[i].corner, sizeof out[i].corner);
        out[i].mesh = t->surfaces[i].mesh;
        out[i].material = in->meshes[out[i].mesh].desc.material;
        out[i].twin = t->surfaces[i].twin;
        out[i].holes = NULL;
        surface_measure(&out[i], t->positions);
    }
    scene_measure(&f->scene);
    uint32_t *neighbours = arena_alloc(&f->memory, 4 * t->surface_count, sizeof *neighbours);
    f->scene.neighbours = neighbours;
    return neighbours && scene_find_neighbours(&f->scene, neighbours) && build_masks(f, out);
}

bool build_measure(const bake_scene *f, arena *memory, mesh *m) {
    if (!mesh_measure(m, memory)) return false;
    if (f->scene.tree) mesh_cut_holes(m, &f->scene);
    return true;
}

static bool build_mesh(bake_scene *f) {
    const tessellation *t = &f->pieces;
    mesh *m = &f->mesh;
    m->vertices = t->positions;
    m->nodes = t->nodes;
    m->node_count = t->node_count;
    m->vertex_count = t->vertex_count;
    m->patch_count = t->patch_count;
    m->element_count = t->element_count;
    m->patches = arena_alloc(&f->memory, t->patch_count, sizeof *m->patches);
    m->elements = arena_alloc(&f->memory, t->element_count, sizeof *m->elements);
    if (!m->patches || !m->elements) return false;
    for (size_t i = 0; i < t->patch_count; i++) {
        memcpy(m->patches[i].corner, t->patches[i].corner, sizeof m->patches[i].corner);
        m->patches[i].surface = t->patches[i].surface;
        m->patches[i].first_element = t->patches[i].first_element;
        m->patches[i].element_count = t->patches[i].element_count;
    }
    for (size_t i = 0; i < t->element_count; i++)
        memcpy(m->elements[i].corner, t->elements[i].corner, sizeof m->elements[i].corner);
    f->ranges = arena_alloc(&f->memory, f->mesh_count, sizeof *f->ranges);
    if (!f->ranges || !build_measure(f, &f->memory, m)) return false;
    memcpy(f->ranges, t->ranges, f->mesh_count * sizeof *f->ranges);
    mesh_set_materials(m, &f->scene);
    return true;
}

/* ---- item geometry
 * ----------------------------------------------------------------------------------------------------- */

/* The vertices that surfaces use, numbered densely and relative to the centre: pieces have many more. */
static bool build_positions(bake_scene *f, uint32_t *dense) {
    const scene *s = &f->scene;
    uint32_t count = 0;
    for (size_t v = 0; v < s->vertex_count; v++) dense[v] = NO_INDEX;
    for (size_t i = 0; i < s->surface_count; i++)
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]); k++) {
            uint32_t *at = &dense[s->surfaces[i].corner[k]];
            if (*at == NO_INDEX) *at = count++;
        }
    float *positions = arena_alloc(&f->memory, 3 * (size_t)count, sizeof *positions);
    if (!positions) return false;
    for (size_t v = 0; v < s->vertex_count; v++)
        for (int k = 0; dense[v] != NO_INDEX && k < 3; k++)
            positions[3 * (size_t)dense[v] + k] = (float)(s->vertices[3 * v + k] - s->center[k]);
    f->items.positions = positions;
    f->items.vertex_count = count;
    return true;
}

static bool build_items(bake_scene *f) {
    const scene *s = &f->scene;
    uint32_t *dense = block_new(f->memory.memory, (s->vertex_count + 1) * sizeof *dense);
    uint32_t *indices = arena_alloc(&f->memory, 6 * s->surface_count, sizeof *indices);
    f->triangle_surface = arena_alloc(&f->memory, 2 * s->surface_count, sizeof *f->triangle_surface);
    bool ok = dense && indices && f->triangle_surface && build_positions(f, dense);
    size_t count = 0;
    for (size_t i = 0; ok && i < s->surface_count; i++) {
        const surface *surf = &s->surfaces[i];
        if (surf->twin < i) continue; /* one sheet for the two sides */
        for (int k = 1; k + 1 < surface_corner_count(surf); k++) {
            f->triangle_surface[count] = (uint32_t)i;
            indices[3 * count] = dense[surf->corner[0]];
            indices[3 * count + 1] = dense[surf->corner[k]];
            indices[3 * count + 2] = dense[surf->corner[k + 1]];
            count++;
        }
    }
    block_free(dense);
    f->items.indices = indices;
    f->items.triangle_count = count;
    f->items.near_plane = (float)(TOLERANCE_NEAR_PLANE * s->radius);
    return ok && build_item_masks(f);
}

/* What lies in or passes through what. */
static bool check_meshes(bake_scene *f) {
    uint8_t *layers = arena_alloc(&f->memory, f->items.triangle_count + 1, 1);
    bool ok = layers &&
              coplanar_overlap_find_layers(f->memory.memory, f->items.positions, f->items.indices,
                                           f->items.triangle_count, layers) &&
              intersections_count(&f->scene, &f->crossing_count);
    for (size_t t = 0; ok && t < f->items.triangle_count; t++) f->overlapping_count += layers[t] > 0;
    return ok;
}

static bool build_pieces(solver_method method, bake_scene *f) {
    float near_plane = f->items.near_plane;
    if (!mesh_items_create(&f->scene, &f->mesh, MESH_PATCHES, near_plane, &f->memory, &f->patches)) return false;
    return method != SOLVER_PR ||
           mesh_items_create(&f->scene, &f->mesh, MESH_ELEMENTS, near_plane, &f->memory, &f->elements);
}

static size_t count_emitters(const mesh *m) {
    size_t count = 0;
    for (size_t p = 0; p < m->patch_count; p++) count += material_emits(&m->patches[p].material);
    return count;
}

/* Methods that are there to be compared with shoot patch by patch. */
static bool build_clusters(const bake_options *options, bake_scene *f) {
    const cluster_desc how = { .size = CLUSTER_SIZE * options->patch_size,
                               .angle = options->cluster_angle * PI / 180.0,
                               .emitters = count_emitters(&f->mesh) > EMITTERS_ALONE };
    return quality_compares(options) || !(options->cluster_angle > 0.0) ||
           clusters_find(&f->scene, &how, &f->memory, &f->mesh, &f->clusters);
}

/* Which surfaces are one face, and whose triangles stay, is asked where triangles are decimated. */
static bool build_flat_faces(const bake_options *options, bake_scene *f) {
    if (!(options->decimate_error > 0.0)) return true;
    f->flat_face = arena_alloc(&f->memory, f->scene.surface_count, sizeof *f->flat_face);
    f->kept = arena_alloc(&f->memory, f->scene.surface_count, sizeof *f->kept);
    if (!f->flat_face || !f->kept) return false;
    for (size_t i = 0; i < f->scene.surface_count; i++) f->kept[i] = proxy_mesh_is_used(f, f->scene.surfaces[i].mesh);
    return flat_faces_join(f, f->flat_face);
}

hemi_result fail_too_many(const hemi_scene *in, double element_size, const bake_options *options) {
    return context_fail(in->context, HEMI_ERROR_LIMIT,
                        "elements of %g m make more than %u of them; ask for larger elements", element_size,
                        options->max_elements);
}

hemi_result build_scene(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    bool *double_sided = arena_alloc(&f->memory, f->mesh_count, 1),
         *is_proxy = arena_alloc(&f->memory, f->mesh_count, 1);
    if (!double_sided || !is_proxy) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < f->mesh_count; i++) {
        double_sided[i] = in->materials[f->meshes[i].material].double_sided;
        is_proxy[i] = proxy_mesh_is_used(f, i);
    }
    tessellate_desc pieces = { .meshes = f->meshes,
                               .double_sided = double_sided,
                               .is_proxy = is_proxy,
                               .mesh_count = (uint32_t)f->mesh_count,
                               .element_size = options->element_size,
                               .patch_size = options->patch_size,
                               .max_elements = options->max_elements,
                               .memory = &in->context->blocks };
    hemi_result result = tessellate(&pieces, &f->pieces);
    if (result == HEMI_ERROR_LIMIT) return fail_too_many(in, options->element_size, options);
    if (result != HEMI_OK) return result;
    if (f->pieces.surface_count == 0)
        return context_fail(in->context, HEMI_ERROR_NO_SURFACES, "there is no triangle with an area to bake");
    if (!build_materials(in, f) || !build_surfaces(in, f) || !build_mesh(f)) return HEMI_ERROR_MEMORY;
    result = build_textures(in, f);
    if (result != HEMI_OK) return result;
    if (f->demodulated && !build_emitters(f)) return HEMI_ERROR_MEMORY;
    if (!build_clusters(options, f)) return HEMI_ERROR_MEMORY;
    return build_items(f) && check_meshes(f) && build_pieces(options->method, f) && build_flat_faces(options, f)
               ? HEMI_OK
               : HEMI_ERROR_MEMORY;
}

void bake_scene_free(bake_scene *f) {
    proxy_meshes_free(f);
    for (size_t i = 0; f->refined && i < f->mesh_count; i++) mesh_copy_free(&f->refined[i]);
    block_free(f->refined);
    block_free(f->meshes);
    tessellation_free(&f->pieces);
    surface_bvh_destroy(f->tree);
    arena_free(&f->memory);
    memset(f, 0, sizeof *f);
}
