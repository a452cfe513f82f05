/* SPDX-License-Identifier: MIT
 * See harvest.h.
 */
#include "harvest.h"

#include "base/vec3.h"
#include "formfactor/hemicube_weights.h"
#include "reconstruct/residual.h"
#include "reconstruct/vertex_fit.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where something stands on a patch, a sample that shooters hardly reach is inside it. It says little about the
 * vertices around it, which may be in the room: they listen to it only if nothing else speaks. Form factors from all
 * shooters sum to 1 at a sample in a closed room, and with the share of the sky that is seen in any scene; what has
 * less than a tenth of that is all but buried. */
static const double REACH_OF_A_ROOM = 0.1, BURIED_WEIGHT = 1e-3;

static double trust(bool crossed, double reach) {
    double share = crossed && reach < REACH_OF_A_ROOM ? reach / REACH_OF_A_ROOM : 1.0;
    return share * share > BURIED_WEIGHT ? share * share : BURIED_WEIGHT;
}

typedef struct harvester {
    const hemi_scene *in;
    const frozen *f;
    const arrival *arrival;
    const progressive_result *light;
    double *radiance, *weight; /* of samples */
    bool *emits;               /* of elements */
    uint32_t *nodes;           /* of element corners */
    vertex_fit_result fit, shown;
    hemi_statistics *statistics;
} harvester;

static const double PI = 3.14159265358979323846;

/* L = (M + rho E) / pi, with what is shown of a texture if shown is not NULL. */
static void set_radiance(harvester *h, const material *shown) {
    const mesh *m = &h->f->mesh;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        const material *a = shown ? &shown[i] : &e->finish;
        for (int k = 0; k < element_corner_count(e); k++) {
            size_t s = (size_t)e->first_sample + (size_t)k;
            for (int c = 0; c < 3; c++)
                h->radiance[3 * s + c] = (a->M[c] + a->rho[c] * h->light->irradiance[3 * s + c]) / PI;
        }
    }
}

static void set_weights(harvester *h) {
    const mesh *m = &h->f->mesh;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        h->emits[i] = material_emits(&e->finish);
        for (int k = 0; k < element_corner_count(e); k++) {
            size_t s = (size_t)e->first_sample + (size_t)k;
            double reach = h->light->reach[s] + (h->arrival->reach ? h->arrival->reach[s] : 0.0);
            h->weight[s] = m->sample_area[s] * trust(h->light->crossed[e->patch], reach);
        }
        for (int k = 0; k < 4; k++)
            h->nodes[4 * i + k] = e->corner[k] == NO_INDEX ? NO_INDEX : h->f->pieces.nodes[e->corner[k]];
    }
}

static hemi_result fit(harvester *h) {
    const mesh *m = &h->f->mesh;
    h->radiance = malloc((3 * m->sample_count + 1) * sizeof *h->radiance);
    h->weight = malloc((m->sample_count + 1) * sizeof *h->weight);
    h->nodes = malloc((4 * m->element_count + 1) * sizeof *h->nodes);
    h->emits = malloc(m->element_count + 1);
    if (!h->radiance || !h->weight || !h->nodes || !h->emits) return HEMI_ERROR_MEMORY;
    set_weights(h);
    set_radiance(h, NULL);
    vertex_fit_input in = { .mesh = m,
                            .node = h->nodes,
                            .node_count = h->f->pieces.node_count,
                            .radiance = h->radiance,
                            .emits = h->emits,
                            .weight = h->weight };
    if (!vertex_fit(&in, &h->fit)) return HEMI_ERROR_MEMORY;
    if (!h->f->shown) return HEMI_OK;
    set_radiance(h, h->f->shown);
    bool ok = vertex_fit(&in, &h->shown);
    set_radiance(h, NULL);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* ---- how far off
 * ---------------------------------------------------------------------------------------------------------- */

static hemi_result check(const harvester *h, const hemi_bake_desc *desc) {
    char message[160];
    int resolution = quality_check_hemicube(desc->quality);
    double *weights = malloc(3 * (size_t)resolution * (size_t)resolution * sizeof *weights);
    if (!weights) return HEMI_ERROR_MEMORY;
    hemicube_weights(resolution, weights);
    residual_result found;
    const vertex_fit_result *fit = h->f->shown ? &h->shown : &h->fit;
    const residual_setup setup = { .scene = &h->f->scene,
                                   .mesh = &h->f->mesh,
                                   .patches = &h->f->patches,
                                   .jobs = h->in->context->jobs,
                                   .resolution = resolution,
                                   .weights = weights,
                                   .seed = desc->seed,
                                   .point_count = quality_check_points(desc->quality),
                                   .samples = h->radiance,
                                   .arrived = h->arrival->irradiance,
                                   .trust = h->weight,
                                   .node = h->nodes,
                                   .shown = fit->radiance,
                                   .colored = h->f->shown,
                                   .diagonal = fit->diagonal };
    const char *failure = residual_measure(&setup, &found, message, sizeof message);
    free(weights);
    if (failure) return context_fail(h->in->context, HEMI_ERROR_BACKEND, "%s", failure);
    /* What the fit leaves over is known at all samples, also where no point fell. */
    h->statistics->error_estimate = fmax(found.error, fit->residual);
    h->statistics->error_bias = found.bias;
    h->statistics->error_points = (uint32_t)found.points;
    return HEMI_OK;
}

/* ---- meshes
 * ---------------------------------------------------------------------------------------------------------- */

static bool allocate_mesh(solved_mesh *out, const tessellate_range *r, uint32_t triangle_count, uint32_t attributes,
                          bool has_source) {
    size_t v = r->vertex_count;
    out->vertex_count = r->vertex_count;
    out->triangle_count = triangle_count;
    out->indices = malloc(3 * (size_t)triangle_count * sizeof *out->indices + 1);
    out->positions = malloc(3 * v * sizeof *out->positions + 1);
    out->normals = calloc(3 * v + 1, sizeof *out->normals);
    out->radiance = malloc(3 * v * sizeof *out->radiance + 1);
    out->source_triangles = has_source ? malloc(v * sizeof *out->source_triangles + 1) : NULL;
    out->source_weights = has_source ? malloc(3 * v * sizeof *out->source_weights + 1) : NULL;
    out->attribute_count = has_source ? 0 : attributes;
    out->attributes = out->attribute_count ? malloc(v * attributes * sizeof *out->attributes + 1) : NULL;
    return out->indices && out->positions && out->normals && out->radiance &&
           (!out->attribute_count || out->attributes) &&
           (!has_source || (out->source_triangles && out->source_weights));
}

/* A vertex interpolated in the mesh's own frame, so that nothing goes through the transform and back. */
static void interpolate(float *out, const float *values, size_t width, const hemi_mesh_desc *m, uint32_t triangle,
                        const float w[3]) {
    for (size_t k = 0; k < width; k++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++) sum += w[i] * (double)values[width * m->indices[3 * (size_t)triangle + i] + k];
        out[k] = (float)sum;
    }
}

static void set_face_normal(float out[3], const hemi_mesh_desc *m, uint32_t triangle) {
    double p[3][3], u[3], v[3], n[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) p[i][k] = m->positions[3 * (size_t)m->indices[3 * (size_t)triangle + i] + k];
    vec3_sub(u, p[1], p[0]);
    vec3_sub(v, p[2], p[0]);
    vec3_cross(n, u, v);
    vec3_normalize(n);
    for (int k = 0; k < 3; k++) out[k] = (float)n[k];
}

static void set_vertex(const harvester *h, const hemi_mesh_desc *m, uint32_t v, solved_mesh *out, uint32_t local) {
    const tessellation *t = &h->f->pieces;
    uint32_t triangle = t->source_triangles[v];
    const float *w = t->source_weights + 3 * (size_t)v;
    float *normal = out->normals + 3 * (size_t)local;
    interpolate(out->positions + 3 * (size_t)local, m->positions, 3, m, triangle, w);
    if (m->normals) {
        interpolate(normal, m->normals, 3, m, triangle, w);
        double n[3] = { normal[0], normal[1], normal[2] };
        if (vec3_normalize(n) > 1e-6)
            for (int k = 0; k < 3; k++) normal[k] = (float)n[k];
        else
            set_face_normal(normal, m, triangle);
    } else {
        set_face_normal(normal, m, triangle);
    }
    for (size_t c = 0; c < 3; c++) {
        out->radiance[3 * (size_t)local + c] = (float)h->fit.radiance[3 * (size_t)t->nodes[v] + c];
        if (out->light) out->light[3 * (size_t)local + c] = (float)h->shown.radiance[3 * (size_t)t->nodes[v] + c];
    }
    if (out->attribute_count)
        interpolate(out->attributes + (size_t)out->attribute_count * local, m->attributes, out->attribute_count, m,
                    triangle, w);
    if (!out->source_triangles) return;
    out->source_triangles[local] = triangle;
    memcpy(out->source_weights + 3 * (size_t)local, w, 3 * sizeof *w);
}

static uint32_t *push_triangle(uint32_t *at, const uint32_t corner[4], int a, int b, int c, uint32_t first, bool turn) {
    at[0] = corner[a] - first;
    at[1] = corner[turn ? c : b] - first;
    at[2] = corner[turn ? b : c] - first;
    return at + 3;
}

/* World triangles of a mirrored mesh are turned over; in the mesh's own frame they run as they came. */
static void set_triangles(const harvester *h, const tessellate_range *r, bool turn, solved_mesh *out) {
    const uint8_t *diagonal = h->shown.diagonal ? h->shown.diagonal : h->fit.diagonal;
    uint32_t *at = out->indices;
    for (uint32_t i = r->first_element; i < r->first_element + r->element_count; i++) {
        const uint32_t *c = h->f->mesh.elements[i].corner;
        if (c[3] == NO_INDEX) {
            at = push_triangle(at, c, 0, 1, 2, r->first_vertex, turn);
        } else if (diagonal[i] == 0) {
            at = push_triangle(at, c, 0, 1, 2, r->first_vertex, turn);
            at = push_triangle(at, c, 0, 2, 3, r->first_vertex, turn);
        } else {
            at = push_triangle(at, c, 0, 1, 3, r->first_vertex, turn);
            at = push_triangle(at, c, 1, 2, 3, r->first_vertex, turn);
        }
    }
}

/* The second half of a double-sided mesh's vertices belongs to its back. */
static void turn_back_normals(const hemi_mesh_desc *m, const hemi_scene *in, solved_mesh *out) {
    if (!in->materials[m->material].double_sided) return;
    for (size_t i = 3 * (size_t)(out->vertex_count / 2); i < 3 * (size_t)out->vertex_count; i++)
        out->normals[i] = -out->normals[i];
}

static hemi_result harvest_mesh(const harvester *h, size_t index, solved_mesh *out) {
    const tessellate_range *r = &h->f->pieces.ranges[index];
    const hemi_mesh_desc *m = &h->f->meshes[index];
    uint32_t triangles = 0;
    for (uint32_t i = r->first_element; i < r->first_element + r->element_count; i++)
        triangles += h->f->mesh.elements[i].corner[3] == NO_INDEX ? 1 : 2;
    bool subdivided = h->in->meshes[index].desc.subdivision != HEMI_SUBDIVISION_NONE;
    if (!allocate_mesh(out, r, triangles, m->attributes ? m->attribute_count : 0, !subdivided))
        return HEMI_ERROR_MEMORY;
    if (m->texture && h->f->shown) {
        out->light = malloc(3 * (size_t)r->vertex_count * sizeof *out->light + 1);
        if (!out->light) return HEMI_ERROR_MEMORY;
    }
    for (uint32_t v = 0; v < r->vertex_count; v++) set_vertex(h, m, r->first_vertex + v, out, v);
    turn_back_normals(m, h->in, out);
    set_triangles(h, r, hemi_transform_determinant(m->transform) < 0.0, out);
    return HEMI_OK;
}

hemi_result harvest(const hemi_scene *in, const hemi_bake_desc *desc, const frozen *f, const arrival *arriving,
                    const progressive_result *light, hemi_solution *out) {
    harvester h = { .in = in, .f = f, .arrival = arriving, .light = light, .statistics = &out->statistics };
    hemi_result result = fit(&h);
    if (result == HEMI_OK) result = check(&h, desc);
    out->meshes = calloc(f->mesh_count + 1, sizeof *out->meshes);
    if (!out->meshes)
        result = HEMI_ERROR_MEMORY;
    else
        out->mesh_count = f->mesh_count;
    for (size_t i = 0; result == HEMI_OK && i < f->mesh_count; i++) {
        result = harvest_mesh(&h, i, &out->meshes[i]);
        out->statistics.vertices_out += out->meshes[i].vertex_count;
        out->statistics.triangles_out += out->meshes[i].triangle_count;
    }
    out->statistics.error_discretisation = f->shown ? h.shown.residual : h.fit.residual; /* of what is shown */
    vertex_fit_free(&h.fit);
    vertex_fit_free(&h.shown);
    free(h.radiance);
    free(h.weight);
    free(h.emits);
    free(h.nodes);
    return result;
}
