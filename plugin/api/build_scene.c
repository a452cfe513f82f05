/* SPDX-License-Identifier: MIT */
#include "build_scene.h"

#include "proxy_mesh.h"

#include "geometry/triangle.h"
#include "mesh/cluster.h"
#include "mesh/contact_cut.h"
#include "mesh/flat_faces.h"
#include "mesh/mesh.h"
#include "mesh/shading_normals.h"
#include "scene/coplanar_overlap.h"
#include "scene/scene.h"

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
        double p[3][3];
        for (int k = 0; k < 3; k++)
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + k], p[k]);
        area += triangle_area(p[0], p[1], p[2]);
    }
    return area;
}

double bake_scene_area(const bake_scene *f) {
    double area = 0.0;
    for (size_t i = 0; i < f->mesh_count; i++) area += mesh_desc_area(&f->meshes[i]);
    return area;
}

static bool build_surfaces(const hemi_scene *in, bake_scene *f) {
    scene *s = &f->scene;
    uint32_t *neighbours = arena_alloc(&f->memory, 4 * s->surface_count, sizeof *neighbours);
    material *materials = arena_alloc(&f->memory, in->material_count, sizeof *materials);
    for (size_t i = 0; materials && i < in->material_count; i++)
        for (int c = 0; c < 3; c++) {
            materials[i].rho[c] = in->materials[i].reflectance[c];
            materials[i].M[c] = PI * in->materials[i].emission[c];
        }
    for (size_t i = 0; materials && i < in->material_count; i++)
        if (material_set_transmission(f, in->materials[i].transmission, in->materials[i].diffuse_transmission,
                                      &materials[i]))
            for (int c = 0; c < 3; c++) materials[i].rho[c] = fmin(materials[i].rho[c], HEMI_REFLECTANCE_MAX);
    s->materials = materials;
    s->material_count = in->material_count;
    for (size_t i = 0; i < s->surface_count; i++) surface_measure(&s->surfaces[i], s->vertices);
    scene_measure(s);
    s->neighbours = neighbours;
    return materials && neighbours && scene_find_neighbours(s, neighbours) && build_masks(f);
}

/* What lies in or passes through what. */
static bool check_meshes(bake_scene *f) {
    const item_geometry *items = &f->surfaces.items;
    uint8_t *layers = arena_alloc(&f->memory, items->triangle_count + 1, 1);
    bool ok = layers &&
              coplanar_overlap_find_layers(f->memory.memory, items->positions, items->indices, items->triangle_count,
                                           layers) &&
              intersections_count(&f->scene, &f->crossing_count);
    for (size_t t = 0; ok && t < items->triangle_count; t++) f->overlapping_count += layers[t] > 0;
    return ok;
}

static bool build_items(solver_method method, bake_scene *f) {
    return mesh_items_create(&f->scene, &f->mesh, MESH_SURFACES, &f->memory, &f->surfaces) &&
           mesh_items_create(&f->scene, &f->mesh, MESH_PATCHES, &f->memory, &f->patches) &&
           (method != SOLVER_PR || mesh_items_create(&f->scene, &f->mesh, MESH_ELEMENTS, &f->memory, &f->elements));
}

/* Methods that are there to be compared with shoot patch by patch. */
static bool build_clusters(const bake_options *options, bake_scene *f) {
    size_t emitters = 0;
    for (size_t p = 0; p < f->mesh.patch_count; p++) emitters += material_emits(&f->mesh.patches[p].material);
    const cluster_desc how = { .size = CLUSTER_SIZE * options->patch_size,
                               .angle = options->cluster_angle * PI / 180.0,
                               .emitters = emitters > EMITTERS_ALONE };
    return quality_compares(options) || !(options->cluster_angle > 0.0) ||
           clusters_find(&f->scene, &how, &f->memory, &f->mesh, &f->clusters);
}

/* Which surfaces are one face, and whose triangles stay, is asked where triangles are decimated. */
static bool build_flat_faces(const bake_options *options, bake_scene *f) {
    if (!(options->decimate_error > 0.0)) return true;
    f->flat_face = arena_alloc(&f->memory, f->scene.surface_count, sizeof *f->flat_face);
    f->kept = arena_alloc(&f->memory, f->scene.surface_count, sizeof *f->kept);
    if (!f->flat_face || !f->kept) return false;
    for (size_t i = 0; i < f->scene.surface_count; i++) {
        uint32_t m = f->scene.surfaces[i].mesh;
        f->kept[i] = proxy_mesh_is_used(f, m) || f->meshes[m].keep_vertices;
    }
    return flat_faces_join(&f->scene, &f->vertices, f->sources, f->flat_face);
}

hemi_result fail_too_many(const hemi_scene *in, double element_size, const bake_options *options) {
    return context_fail(in->context, HEMI_ERROR_LIMIT,
                        "elements of %g m make more than %u of them; ask for larger elements", element_size,
                        options->max_elements);
}

/* The transpose of the inverse of a transform, up to a factor: what normals are taken to the world by. */
static void set_normal_matrix(const double transform[16], double out[9]) {
    double x[3], y[3], z[3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            (c == 0 ? x : c == 1 ? y : z)[r] = transform[15] == 0.0 ? r == c : transform[4 * c + r];
    const double *axes[3] = { x, y, z };
    for (int c = 0; c < 3; c++) {
        double cofactor[3];
        vec3_cross(cofactor, axes[(c + 1) % 3], axes[(c + 2) % 3]);
        for (int r = 0; r < 3; r++) out[3 * r + c] = cofactor[r];
    }
}

/* f->meshes as surfaces, patches and elements. */
static hemi_result build_tessellation(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    bool *double_sided = arena_alloc(&f->memory, f->mesh_count, 1),
         *is_proxy = arena_alloc(&f->memory, f->mesh_count, 1);
    f->sources = arena_alloc(&f->memory, f->mesh_count, sizeof *f->sources);
    if (!double_sided || !is_proxy || !f->sources) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        double_sided[i] = in->materials[m->material].double_sided;
        is_proxy[i] = proxy_mesh_is_used(f, i);
        f->sources[i] = (source_mesh){ m->positions, m->normals, m->attributes, m->indices, m->attribute_count, { 0 } };
        set_normal_matrix(m->transform, f->sources[i].normal_matrix);
    }
    const tessellate_desc how = { .meshes = f->meshes,
                                  .double_sided = double_sided,
                                  .is_proxy = is_proxy,
                                  .mesh_count = (uint32_t)f->mesh_count,
                                  .element_size = options->element_size,
                                  .patch_size = options->patch_size,
                                  .max_elements = options->max_elements,
                                  .memory = f->memory.memory };
    tessellation made = { .vertices = &f->vertices, .scene = &f->scene, .mesh = &f->mesh };
    hemi_result result = tessellate(&how, &made);
    f->check = made.check;
    if (result == HEMI_ERROR_LIMIT) return fail_too_many(in, options->element_size, options);
    if (result == HEMI_OK && f->scene.surface_count == 0)
        return context_fail(in->context, HEMI_ERROR_NO_SURFACES, "there is no triangle with an area to bake");
    return result;
}

static bool shades_smooth(const bake_options *options) {
    return !options->facets && !quality_compares(options);
}

/* Methods that are there to be compared with have their elements as the paper has them. */
static bool cut_at_contacts(const bake_options *options, bake_scene *f) {
    const refinement_setup setup = { &f->scene, &f->mesh, &f->vertices, f->sources };
    contact_lines lines;
    if (quality_compares(options)) return true;
    bool ok = contact_lines_find(&f->scene, &lines) && contact_cut(&setup, &lines, options->max_elements);
    contact_lines_free(&lines);
    return ok;
}

bool scene_transmits(const hemi_scene *in, const bake_scene *f) {
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_material_desc *m = &in->materials[f->meshes[i].material];
        if (f->meshes[i].triangle_count == 0) continue;
        for (int c = 0; c < 3; c++)
            if (m->transmission[c] > 0.0 || m->diffuse_transmission[c] > 0.0) return true;
    }
    return false;
}

static bool build_panes(bake_scene *f) {
    if (panes_mark(&f->scene, &f->mesh) == 0) return true;
    f->scene.panes = f->panes = panes_create(&f->scene, &f->mesh);
    return f->panes;
}

hemi_result build_scene(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    f->solves_beyond = options->method == SOLVER_ROWS;
    hemi_result result = build_tessellation(in, options, f);
    if (result != HEMI_OK) return result;
    if (!build_surfaces(in, f) || !cut_at_contacts(options, f) ||
        (shades_smooth(options) && !shading_normals_set_all(&f->mesh, &f->scene, f->sources, &f->vertices)) ||
        !mesh_measure_in_scene(&f->mesh, &f->scene, &f->memory))
        return HEMI_ERROR_MEMORY;
    result = build_textures(in, f);
    if (result == HEMI_OK && !build_panes(f)) result = HEMI_ERROR_MEMORY;
    if (result != HEMI_OK) return result;
    if (f->demodulated && !uneven_emitters_split(&f->mesh, &f->scene, &f->memory, &f->emitters_are_split))
        return HEMI_ERROR_MEMORY;
    return build_clusters(options, f) && build_items(options->method, f) && check_meshes(f) &&
                   build_flat_faces(options, f)
               ? HEMI_OK
               : HEMI_ERROR_MEMORY;
}

void bake_scene_free(bake_scene *f) {
    proxy_meshes_free(f);
    for (size_t i = 0; f->limit_surfaces && i < f->mesh_count; i++) mesh_copy_free(&f->limit_surfaces[i]);
    block_free_all(f->limit_surfaces, f->meshes);
    tessellation_free(&(tessellation){ .vertices = &f->vertices, .scene = &f->scene, .mesh = &f->mesh });
    surface_bvh_destroy(f->tree);
    panes_destroy(f->panes);
    arena_free(&f->memory);
    memset(f, 0, sizeof *f);
}
