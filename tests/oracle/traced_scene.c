/* SPDX-License-Identifier: MIT
 * See traced_scene.h: what is in it, and how it looks.
 */
#include "traced_scene.h"

#include "geometry/vec3.h"
#include "traced_rays.h"

#include <hemibake/mesh_transform.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far off a surface rays begin, of the radius: thirty roundings of a float coordinate, and a hundredth of what
 * separates the closest sheets that the scenes of ../accuracy and ../../../shared have. */
static const double OFFSET = 4e-6;

/* ---- adding ------------------------------------------------------------------------------------------------------ */

static bool append(void **list, uint32_t *count, size_t size, const void *item) {
    void *grown = realloc(*list, (*count + (size_t)1) * size);
    if (!grown) return false;
    memcpy((char *)grown + *count * size, item, size);
    *list = grown;
    ++*count;
    return true;
}

bool traced_scene_add_material(traced_scene *s, const hemi_material_desc *material) {
    hemi_material_desc clamped = *material;
    for (int c = 0; c < 3; c++) clamped.reflectance[c] = fmin(material->reflectance[c], HEMI_REFLECTANCE_MAX);
    return append((void **)&s->materials, &s->material_count, sizeof clamped, &clamped);
}

bool traced_scene_add_light(traced_scene *s, const hemi_light_desc *light) {
    return append((void **)&s->lights, &s->light_count, sizeof *light, light);
}

static bool add_triangle(traced_scene *s, const hemi_mesh_desc *mesh, const uint32_t vertex[3]) {
    traced_triangle t = { .mesh = s->mesh_count };
    double ab[3], ac[3];
    if (s->triangle_count == s->triangle_room) {
        size_t room = s->triangle_room ? 2 * s->triangle_room : 1024;
        traced_triangle *grown = realloc(s->triangles, room * sizeof *grown);
        if (!grown) return false;
        s->triangles = grown;
        s->triangle_room = room;
    }
    for (int k = 0; k < 3; k++) {
        if (vertex[k] >= mesh->vertex_count) return false;
        t.vertex[k] = vertex[k];
        hemi_transform_point(mesh->transform, mesh->positions + 3 * (size_t)vertex[k], t.corner[k]);
    }
    vec3_sub(ab, t.corner[1], t.corner[0]);
    vec3_sub(ac, t.corner[2], t.corner[0]);
    vec3_cross(t.normal, ab, ac);
    t.area = vec3_normalize(t.normal) / 2;
    if (t.area > 0) s->triangles[s->triangle_count++] = t;
    return true;
}

bool traced_scene_add_mesh(traced_scene *s, const hemi_mesh_desc *mesh) {
    bool mirrors = mesh->transform[15] != 0.0 && hemi_transform_determinant(mesh->transform) < 0.0;
    if (mesh->material >= s->material_count) return false;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *v = mesh->indices + 3 * i;
        uint32_t turned[3] = { v[0], v[mirrors ? 2 : 1], v[mirrors ? 1 : 2] };
        if (!add_triangle(s, mesh, turned)) return false;
    }
    return append((void **)&s->meshes, &s->mesh_count, sizeof *mesh, mesh);
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static void measure(traced_scene *s) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t t = 0; t < s->triangle_count; t++)
        for (int i = 0; i < 9; i++) {
            double x = s->triangles[t].corner[i / 3][i % 3];
            low[i % 3] = fmin(low[i % 3], x);
            high[i % 3] = fmax(high[i % 3], x);
        }
    vec3_mid(s->center, low, high);
    s->radius = vec3_distance(low, high) / 2;
    s->offset = OFFSET * s->radius;
}

static bool any_light(const traced_scene *s) {
    for (uint32_t m = 0; m < s->mesh_count; m++) {
        const hemi_material_desc *material = &s->materials[s->meshes[m].material];
        if (s->meshes[m].texture || !vec3_is_zero(material->emission)) return true;
    }
    return s->light_count > 0 || !vec3_is_zero(s->sky.radiance);
}

/* Does it let any light straight through? */
static bool is_pane(const traced_scene *s, uint32_t triangle) {
    return !vec3_is_zero(s->materials[s->meshes[s->triangles[triangle].mesh].material].transmission);
}

bool traced_scene_commit(traced_scene *s) {
    if (s->triangle_count == 0) return false;
    measure(s);
    for (uint32_t t = 0; t < s->triangle_count && !s->panes; t++) s->panes = is_pane(s, t);
    if (!any_light(s)) s->sky = (hemi_sky_desc){ .radiance = { 1, 1, 1 } };
    return traced_rays_create(s);
}

void traced_scene_destroy(traced_scene *s) {
    traced_rays_destroy(s);
    free(s->materials);
    free(s->meshes);
    free(s->lights);
    free(s->triangles);
    memset(s, 0, sizeof *s);
}

/* ---- how it looks ------------------------------------------------------------------------------------------------ */

enum { ATTRIBUTES_MAX = 64 };

/* Attributes of a triangle at three places, whose weights of its corners are given. */
static bool gather_attributes(const hemi_mesh_desc *mesh, const traced_triangle *t, const double weights[3][3],
                              double out[3 * ATTRIBUTES_MAX]) {
    uint32_t n = mesh->attribute_count;
    if (!mesh->texture || (n > 0 && !mesh->attributes) || n > ATTRIBUTES_MAX) return false;
    for (uint32_t place = 0; place < 3; place++)
        for (uint32_t k = 0; k < n; k++) {
            double sum = 0;
            for (int i = 0; i < 3; i++)
                sum += weights[place][i] * (double)mesh->attributes[(size_t)n * t->vertex[i] + k];
            out[n * place + k] = sum;
        }
    return true;
}

/* Where a texture says how it looks there. */
static bool picture_over(const traced_scene *s, uint32_t triangle, const double weights[3][3], hemi_texture_mean *out) {
    const traced_triangle *t = &s->triangles[triangle];
    const hemi_mesh_desc *mesh = &s->meshes[t->mesh];
    double attributes[3 * ATTRIBUTES_MAX];
    memset(out, 0, sizeof *out);
    if (!gather_attributes(mesh, t, weights, attributes)) return false;
    mesh->texture(mesh->texture_user, attributes, 3, out);
    return true;
}

static void shade_over(const traced_scene *s, uint32_t triangle, const double weights[3][3], double rho[3],
                       double emission[3]) {
    const hemi_mesh_desc *mesh = &s->meshes[s->triangles[triangle].mesh];
    hemi_texture_mean mean;
    if (picture_over(s, triangle, weights, &mean)) {
        for (int c = 0; c < 3; c++) rho[c] = fmin(mean.reflectance[c], HEMI_REFLECTANCE_MAX);
        vec3_copy(emission, mean.emission);
        return;
    }
    vec3_copy(rho, s->materials[mesh->material].reflectance);
    vec3_copy(emission, s->materials[mesh->material].emission);
}

void traced_scene_shade(const traced_scene *s, uint32_t triangle, const double weights[3], double rho[3],
                        double emission[3]) {
    double thrice[3][3];
    for (int i = 0; i < 3; i++) vec3_copy(thrice[i], weights);
    shade_over(s, triangle, (const double(*)[3])thrice, rho, emission);
}

void traced_point_turn(traced_point *at) {
    for (int k = 0; k < 3; k++) {
        at->normal[k] = -at->normal[k];
        at->shading[k] = -at->shading[k];
    }
    vec3_copy(at->eye, at->position);
    vec3_copy(at->horizon, at->normal);
}

void traced_scene_transmittance(const traced_scene *s, uint32_t triangle, const double weights[3], double straight[3],
                                double diffuse[3]) {
    const hemi_material_desc *material = &s->materials[s->meshes[s->triangles[triangle].mesh].material];
    double thrice[3][3];
    hemi_texture_mean mean;
    for (int i = 0; i < 3; i++) vec3_copy(thrice[i], weights);
    vec3_copy(straight, material->transmission);
    vec3_copy(diffuse, material->diffuse_transmission);
    if (vec3_is_zero(straight) && vec3_is_zero(diffuse)) return;
    if (!picture_over(s, triangle, (const double(*)[3])thrice, &mean)) return;
    vec3_copy(straight, mean.transmission);
    vec3_copy(diffuse, mean.diffuse_transmission);
}

void traced_scene_mean_emission(const traced_scene *s, uint32_t triangle, double emission[3]) {
    static const double corners[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    double rho[3];
    shade_over(s, triangle, corners, rho, emission);
}

/* The transposed inverse of a transform, up to a factor: its columns are products of two of the transform's. */
static void to_world(const double m[16], const double n[3], double out[3]) {
    static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    const double *t = m[15] == 0.0 ? identity : m;
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < 3; k++) {
        double column[3];
        vec3_cross(column, t + 4 * ((k + 1) % 3), t + 4 * ((k + 2) % 3));
        vec3_add_scaled(out, out, n[k], column);
    }
}

static void set_shading_normal(const traced_scene *s, uint32_t triangle, const double weights[3],
                               const double normal[3], double out[3]) {
    const traced_triangle *t = &s->triangles[triangle];
    const hemi_mesh_desc *mesh = &s->meshes[t->mesh];
    double n[3] = { 0, 0, 0 };
    vec3_copy(out, normal);
    if (s->faces || !mesh->normals) return;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) n[k] += weights[i] * (double)mesh->normals[3 * (size_t)t->vertex[i] + (size_t)k];
    to_world(mesh->transform, n, out);
    double length = vec3_normalize(out), cosine = vec3_dot(out, normal);
    if (!(length > 0) || cosine == 0)
        vec3_copy(out, normal);
    else if (cosine < 0)
        for (int k = 0; k < 3; k++) out[k] = -out[k];
}

/* The planes through the corners, by the normals there, are what a smooth surface touches: above a facet of a convex
 * one the point is moved to each by its weight [Hanika, Ray Tracing Gems II, ch. 4]. Not where a normal leans by more
 * than 45 degrees. */
void traced_scene_set_shading(const traced_scene *s, traced_point *at) {
    static const double corners[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    const traced_triangle *t = &s->triangles[at->triangle];
    double eye[3], n[3][3];
    bool lean = false, bent = false;
    set_shading_normal(s, at->triangle, at->weights, at->normal, at->shading);
    vec3_copy(eye, at->position);
    vec3_copy(at->eye, at->position);
    vec3_copy(at->horizon, at->normal);
    for (int i = 0; i < 3; i++) {
        set_shading_normal(s, at->triangle, corners[i], at->normal, n[i]);
        double cosine = vec3_dot(n[i], at->normal), from[3];
        bent = bent || cosine < 1 - 1e-6, lean = lean || cosine < sqrt(0.5);
        vec3_sub(from, t->corner[i], at->position);
        vec3_add_scaled(eye, eye, at->weights[i] * fmax(vec3_dot(from, n[i]), 0), n[i]);
    }
    if (lean || !bent) return;
    vec3_copy(at->eye, eye);
    vec3_copy(at->horizon, at->shading);
}

bool traced_scene_double_sided(const traced_scene *s, uint32_t triangle) {
    return s->materials[s->meshes[s->triangles[triangle].mesh].material].double_sided;
}

void traced_scene_sky(const traced_scene *s, const double d[3], double radiance[3]) {
    const hemi_sky_desc *sky = &s->sky;
    vec3_copy(radiance, sky->radiance);
    if (!sky->image) return;
    double u = 0.5 + atan2(d[2], d[0]) / (2 * PI), v = 0.5 - asin(fmax(-1, fmin(1, d[1]))) / PI;
    size_t column = (size_t)fmin(u * sky->width, sky->width - 1), row = (size_t)fmin(v * sky->height, sky->height - 1);
    for (int c = 0; c < 3; c++) radiance[c] *= (double)sky->image[3 * (row * sky->width + column) + (size_t)c];
}
