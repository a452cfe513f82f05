/* SPDX-License-Identifier: MIT
 * What may enter a scene? Each rule of hemibake.h about materials and meshes is checked here; what passes is copied.
 */
#include "desc_size.h"
#include "internal.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

enum { SUBDIVISION_LEVEL_MAX = 8, ALPHA_MASK_SIDE_MAX = 16384 /* what OpenGL takes as a texture */ };

/* Radiance and places leave as float; what is lit by more than this, or is moved further, would not fit. */
static const double EMISSION_MAX = 1e30, TRANSFORM_MAX = 1e30;

hemi_result hemi_scene_create(hemi_context *context, hemi_scene **out) {
    if (!context || !out) return HEMI_ERROR_ARGUMENT;
    *out = block_zeroed(&context->memory, 1, sizeof **out);
    if (!*out) return context_out_of_memory(context);
    (*out)->context = context;
    if (!context->pool) context->pool = item_pool_create(&context->memory);
    return HEMI_OK;
}

void mesh_copy_free(mesh_copy *m) {
    block_free_all(m->name, m->positions, m->normals, m->attributes, m->indices);
    void *cage[] = { m->subdivision,     m->face_sizes,       m->crease_edges, m->crease_sharpness,
                     m->corner_vertices, m->corner_sharpness, m->holes,        m->alpha_mask };
    for (size_t i = 0; i < sizeof cage / sizeof *cage; i++) block_free(cage[i]);
    memset(m, 0, sizeof *m);
}

void hemi_scene_destroy(hemi_scene *scene) {
    if (!scene) return;
    for (size_t i = 0; i < scene->mesh_count; i++) mesh_copy_free(&scene->meshes[i]);
    block_free(scene->meshes);
    for (size_t i = 0; i < scene->material_count; i++) block_free((char *)scene->materials[i].name);
    for (size_t i = 0; i < scene->light_count; i++) block_free((float *)scene->lights[i].profile);
    block_free_all(scene->materials, scene->lights, scene->sky_image, scene);
}

/* count * size bytes; false when out of memory. No source leaves NULL. */
static bool copy_array(allocator *memory, void *out, const void *source, size_t count, size_t size) {
    void **target = out;
    *target = NULL;
    if (!source) return true;
    *target = block_new(memory, count * size + 1);
    if (!*target) return false;
    if (count) memcpy(*target, source, count * size);
    return true;
}

/* ---- materials ---- */

static const char *material_fault(const hemi_material_desc *m) {
    for (int c = 0; c < 3; c++) {
        if (!(m->reflectance[c] >= 0.0) || isinf(m->reflectance[c]))
            return "its reflectance is negative or not a number";
        if (!(m->emission[c] >= 0.0 && m->emission[c] <= EMISSION_MAX))
            return "its emission is not a number from 0 to 1e30";
        if (!(m->transmission[c] >= 0.0 && m->transmission[c] <= 1.0) ||
            !(m->diffuse_transmission[c] >= 0.0 && m->diffuse_transmission[c] <= 1.0))
            return "what it transmits is not a share from 0 to 1";
    }
    return NULL;
}

hemi_result hemi_scene_add_material(hemi_scene *scene, const hemi_material_desc *given, uint32_t *out_index) {
    hemi_material_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_material_desc, emission);
    if (!scene || !desc_take(scene->context, "material", given, least, &known, sizeof known))
        return HEMI_ERROR_ARGUMENT;
    const char *name = desc->name ? desc->name : "", *fault = material_fault(desc);
    if (fault) return context_fail(scene->context, HEMI_ERROR_DATA, "material '%s': %s", name, fault);
    if (!block_grow(&scene->context->memory, (void **)&scene->materials, &scene->material_capacity,
                    scene->material_count, sizeof *scene->materials))
        return context_out_of_memory(scene->context);
    hemi_material_desc copy = *desc;
    bool clamped = false;
    for (int c = 0; c < 3; c++) {
        clamped = clamped || copy.reflectance[c] > HEMI_REFLECTANCE_MAX;
        copy.reflectance[c] = fmin(copy.reflectance[c], HEMI_REFLECTANCE_MAX);
        copy.double_sided = copy.double_sided || copy.diffuse_transmission[c] > 0.0;
    }
    copy.name = NULL;
    if (clamped && !copy_array(&scene->context->memory, &copy.name, name, strlen(name) + 1, 1))
        return context_out_of_memory(scene->context);
    if (out_index) *out_index = (uint32_t)scene->material_count;
    scene->materials[scene->material_count++] = copy;
    return HEMI_OK;
}

/* ---- meshes ---- */

static bool all_finite(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i])) return false;
    return true;
}

static bool is_transform(const double m[16]) {
    bool any = false;
    for (int i = 0; i < 16; i++) {
        if (!(fabs(m[i]) <= TRANSFORM_MAX)) return false;
        any = any || m[i] != 0.0;
    }
    return !any || (m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] == 1.0);
}

/* What can be told without the cage; the rest is found when it is made. */
static const char *subdivision_fault(const hemi_subdivision_desc *d) {
    if (!d) return NULL;
    if ((unsigned)d->scheme > HEMI_SUBDIVISION_BILINEAR || d->level > SUBDIVISION_LEVEL_MAX)
        return "its subdivision is unknown or deeper than 8 levels";
    if ((unsigned)d->tessellation > HEMI_TESSELLATION_ADAPTIVE || (unsigned)d->boundary > HEMI_BOUNDARY_NONE ||
        (unsigned)d->face_varying > HEMI_FACE_VARYING_ALL)
        return "its tessellation, boundary or face-varying rule is unknown";
    if ((d->face_count && !d->face_sizes) || (d->crease_count && !(d->crease_edges && d->crease_sharpness)) ||
        (d->corner_count && !(d->corner_vertices && d->corner_sharpness)) || (d->hole_count && !d->holes))
        return "faces, creases, corners or holes are counted but NULL";
    return NULL;
}

static const char *alpha_mask_fault(const hemi_mesh_desc *m) {
    const hemi_alpha_mask *c = m->alpha_mask;
    if (!c) return NULL;
    if (!c->alpha || c->width == 0 || c->height == 0 || c->width > ALPHA_MASK_SIDE_MAX ||
        c->height > ALPHA_MASK_SIDE_MAX)
        return "the alpha map of its alpha_mask is not 1 to 16384 texels wide and high";
    if ((unsigned)c->wrap_u > HEMI_WRAP_MIRROR || (unsigned)c->wrap_v > HEMI_WRAP_MIRROR)
        return "the alpha map of its alpha_mask wraps in an unknown way";
    if (!(c->cutoff >= 0.0) || isinf(c->cutoff)) return "the cutoff of its alpha_mask is negative or not a number";
    if (m->attribute_count < 3 || c->attribute > m->attribute_count - 3)
        return "the coordinates of its alpha_mask are not among its attributes";
    return NULL;
}

static const char *mesh_fault(const hemi_scene *scene, const hemi_mesh_desc *m) {
    if (m->material >= scene->material_count) return "its material is not one of the scene's";
    if (m->triangle_count && (!m->positions || !m->indices)) return "it has triangles but no positions or indices";
    if (m->triangle_count > UINT32_MAX / 4 || m->vertex_count > UINT32_MAX / 4)
        return "it has more than 2^30 triangles or vertices";
    if (m->attribute_count && !m->attributes) return "attribute_count is set but attributes is NULL";
    const char *fault = subdivision_fault(m->subdivision);
    if (!fault) fault = alpha_mask_fault(m);
    if (fault) return fault;
    if (!is_transform(m->transform)) return "its transform is not an affine matrix of numbers up to 1e30";
    for (size_t i = 0; i < 3 * (size_t)m->triangle_count; i++)
        if (m->indices[i] >= m->vertex_count) return "an index is past its last vertex";
    if (!all_finite(m->positions, m->triangle_count ? 3 * (size_t)m->vertex_count : 0))
        return "a position is not a finite number";
    if (m->normals && !all_finite(m->normals, 3 * (size_t)m->vertex_count)) return "a normal is not a finite number";
    return NULL;
}

bool mesh_is_subdivided(const hemi_mesh_desc *m) {
    return m->subdivision && m->subdivision->scheme != HEMI_SUBDIVISION_NONE;
}

static bool copy_cage(allocator *memory, mesh_copy *out, const hemi_subdivision_desc *d) {
    if (!d) return true;
    bool ok = copy_array(memory, &out->subdivision, d, 1, sizeof *d) &&
              copy_array(memory, &out->face_sizes, d->face_sizes, d->face_count, sizeof(uint32_t)) &&
              copy_array(memory, &out->crease_edges, d->crease_edges, 2 * (size_t)d->crease_count, sizeof(uint32_t)) &&
              copy_array(memory, &out->crease_sharpness, d->crease_sharpness, d->crease_count, sizeof(float)) &&
              copy_array(memory, &out->corner_vertices, d->corner_vertices, d->corner_count, sizeof(uint32_t)) &&
              copy_array(memory, &out->corner_sharpness, d->corner_sharpness, d->corner_count, sizeof(float)) &&
              copy_array(memory, &out->holes, d->holes, d->hole_count, sizeof(uint32_t));
    if (!ok) return false;
    out->subdivision->face_sizes = out->face_sizes;
    out->subdivision->crease_edges = out->crease_edges;
    out->subdivision->crease_sharpness = out->crease_sharpness;
    out->subdivision->corner_vertices = out->corner_vertices;
    out->subdivision->corner_sharpness = out->corner_sharpness;
    out->subdivision->holes = out->holes;
    return true;
}

static bool copy_mesh(allocator *memory, mesh_copy *out, const hemi_mesh_desc *m) {
    size_t v = m->vertex_count;
    memset(out, 0, sizeof *out);
    out->desc = *m;
    bool ok = copy_array(memory, &out->positions, m->positions, 3 * v, sizeof(float)) &&
              copy_array(memory, &out->normals, m->normals, 3 * v, sizeof(float)) &&
              copy_array(memory, &out->attributes, m->attribute_count ? m->attributes : NULL, m->attribute_count * v,
                         sizeof(float)) &&
              copy_array(memory, &out->indices, m->indices, 3 * (size_t)m->triangle_count, sizeof(uint32_t)) &&
              copy_array(memory, &out->name, m->name ? m->name : "", m->name ? strlen(m->name) + 1 : 1, 1) &&
              copy_array(memory, &out->alpha_mask, m->alpha_mask, 1, sizeof *m->alpha_mask) &&
              copy_cage(memory, out, m->subdivision);
    out->desc.name = out->name;
    out->desc.positions = out->positions;
    out->desc.normals = out->normals;
    out->desc.attributes = out->attributes;
    out->desc.indices = out->indices;
    out->desc.subdivision = out->subdivision;
    out->desc.alpha_mask = out->alpha_mask;
    if (!ok) mesh_copy_free(out);
    return ok;
}

/* A mesh desc with the descs that it points to. */
typedef struct taken_mesh {
    hemi_mesh_desc mesh;
    hemi_subdivision_desc subdivision;
    hemi_alpha_mask alpha_mask;
} taken_mesh;

static bool take_mesh(const hemi_context *c, const hemi_mesh_desc *given, taken_mesh *out) {
    hemi_mesh_desc *m = &out->mesh;
    if (!desc_take(c, "mesh", given, DESC_THROUGH(hemi_mesh_desc, transform), m, sizeof *m)) return false;
    if (m->subdivision && !desc_take(c, "subdivision", m->subdivision, DESC_THROUGH(hemi_subdivision_desc, level),
                                     &out->subdivision, sizeof out->subdivision))
        return false;
    if (m->alpha_mask && !desc_take(c, "alpha mask", m->alpha_mask, DESC_THROUGH(hemi_alpha_mask, cutoff),
                                    &out->alpha_mask, sizeof out->alpha_mask))
        return false;
    if (m->subdivision) m->subdivision = &out->subdivision;
    if (m->alpha_mask) m->alpha_mask = &out->alpha_mask;
    return true;
}

hemi_result hemi_scene_add_mesh(hemi_scene *scene, const hemi_mesh_desc *given, uint32_t *out_index) {
    taken_mesh taken;
    const hemi_mesh_desc *desc = &taken.mesh;
    if (!scene || !take_mesh(scene->context, given, &taken)) return HEMI_ERROR_ARGUMENT;
    const char *fault = mesh_fault(scene, desc);
    if (fault)
        return context_fail(scene->context, HEMI_ERROR_DATA, "mesh '%s': %s", desc->name ? desc->name : "", fault);
    if (!block_grow(&scene->context->memory, (void **)&scene->meshes, &scene->mesh_capacity, scene->mesh_count,
                    sizeof *scene->meshes))
        return context_out_of_memory(scene->context);
    if (!copy_mesh(&scene->context->memory, &scene->meshes[scene->mesh_count], desc))
        return context_out_of_memory(scene->context);
    if (out_index) *out_index = (uint32_t)scene->mesh_count;
    scene->mesh_count++;
    return HEMI_OK;
}
