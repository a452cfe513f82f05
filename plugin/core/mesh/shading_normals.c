/* SPDX-License-Identifier: MIT */
#include "mesh/shading_normals.h"

#include "geometry/triangle.h"

#include <string.h>

/* One less the cosine from which a normal is another one than its surface's: 0.36 degrees, which is more than what
 * normals of 8 bits are off by. */
static const double ANOTHER = 2e-5;

/* A normal further from that of its surface, 80 degrees, is no way to look: the surface's own is taken. */
static const double LEAST_COSINE = 0.17;

/* A facet with a corner whose normal is further from its own, 45 degrees, is no piece of a smooth surface: half of a
 * box would be between it and the surface that such corners tell of. A ball of six segments is one of 42 degrees. */
static const double LEAST_COSINE_OF_LIFT = 0.7;

/* What a corner's plane lifts a point by, of how far the corner is: less is the rounding of normals that are floats. */
static const double LEAST_DEPTH = 1e-6;

enum { PATCHES_A_JOB = 256 };

/* The transpose of the inverse, up to a factor. */
void shading_normals_set_matrix(const double transform[16], double out[9]) {
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

void shading_normals_set(mesh_vertices *v, const source_mesh *source, uint32_t vertex) {
    double n[3], world[3];
    if (!v->normals || !source->normals) return;
    mesh_vertices_interpolate(v, vertex, source->indices, source->normals, 3, n);
    for (int r = 0; r < 3; r++) world[r] = vec3_dot(source->normal_matrix + 3 * r, n);
    if (!(vec3_normalize(world) > 0.0)) return;
    for (int k = 0; k < 3; k++) v->normals[3 * (size_t)vertex + (size_t)k] = (float)world[k];
}

bool shading_normals_set_all(mesh *m, const scene *s, const source_mesh *sources, mesh_vertices *v) {
    bool any = false;
    for (size_t i = 0; i < s->surface_count; i++) any = any || sources[s->surfaces[i].mesh].normals;
    if (!any) return true;
    v->normals = block_zeroed(v->memory, 3 * v->capacity + 1, sizeof *v->normals);
    if (!v->normals) return false;
    v->normal_capacity = v->capacity;
    for (size_t p = 0; p < m->patch_count; p++) {
        const patch *owner = &m->patches[p];
        const source_mesh *source = &sources[s->surfaces[owner->surface].mesh];
        for (uint32_t e = owner->first_element; e < owner->first_element + owner->element_count; e++)
            for (int k = 0; k < element_corner_count(&m->elements[e]); k++)
                shading_normals_set(v, source, m->elements[e].corner[k]);
    }
    m->normals = v->normals;
    return true;
}

/* The normal of a vertex on the side of a surface, or the surface's own. True: it is another one. */
static bool normal_at(const mesh *m, const surface *f, uint32_t vertex, double out[3]) {
    vec3_from_floats(out, m->normals + 3 * (size_t)vertex);
    double cosine = vec3_dot(out, f->normal);
    if (cosine < 0.0)
        for (int k = 0; k < 3; k++) out[k] = -out[k];
    cosine = fabs(cosine);
    if (cosine >= LEAST_COSINE && cosine < 1.0 - ANOTHER) return true;
    vec3_copy(out, f->normal);
    return false;
}

bool shading_normals_mix(const mesh *m, const surface *f, const uint32_t *vertices, const double *weights, int count,
                         double out[3]) {
    double n[3] = { 0, 0, 0 }, at[3];
    bool smooth = false;
    for (int i = 0; m->normals && i < count; i++) {
        smooth |= normal_at(m, f, vertices[i], at);
        vec3_add_scaled(n, n, weights[i], at);
    }
    smooth = smooth && vec3_normalize(n) > 0.0;
    vec3_copy(out, smooth ? n : f->normal);
    return smooth;
}

static bool sample_element(const mesh *m, const surface *f, const element *e) {
    int count = element_corner_count(e);
    bool smooth = false;
    for (int k = 0; k < count; k++) {
        double weights[4];
        element_sample_weights(count, k, weights);
        smooth |= shading_normals_mix(m, f, e->corner, weights, count,
                                      m->shading + 3 * ((size_t)e->first_sample + (size_t)k));
    }
    return smooth;
}

typedef struct sampling {
    mesh *mesh;
    const scene *scene;
} sampling;

static void sample_job(void *user, size_t job, unsigned worker) {
    const sampling *a = user;
    mesh *m = a->mesh;
    (void)worker;
    for (size_t p = job * PATCHES_A_JOB; p < (job + 1) * PATCHES_A_JOB && p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        owner->is_smooth = false;
        for (uint32_t e = owner->first_element; e < owner->first_element + owner->element_count; e++)
            owner->is_smooth |= sample_element(m, &a->scene->surfaces[owner->surface], &m->elements[e]);
    }
}

bool shading_normals_sample(mesh *m, const scene *s, jobs *j, arena *memory) {
    m->shading = NULL;
    if (!m->normals) return true;
    m->shading = arena_alloc(memory, 3 * m->sample_count + 1, sizeof *m->shading);
    if (!m->shading) return false;
    sampling a = { m, s };
    jobs_run(j, (m->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB, sample_job, NULL, &a);
    return true;
}

/* Is a facet a piece of a smooth surface, by the normals of its corners? */
static bool is_piece(const mesh *m, const surface *f) {
    bool any = false;
    for (int i = 0; i < surface_corner_count(f); i++) {
        double normal[3];
        vec3_from_floats(normal, m->normals + 3 * (size_t)f->corner[i]);
        if (vec3_dot(normal, normal) == 0.0) continue;
        if (fabs(vec3_dot(normal, f->normal)) < LEAST_COSINE_OF_LIFT) return false;
        any = true;
    }
    return any;
}

bool shading_normals_lift(const mesh *m, const surface *f, const double point[3], double out[3]) {
    int corners = surface_corner_count(f);
    bool is_lifted = false;
    vec3_copy(out, point);
    if (!m->normals || !is_piece(m, f)) return false;
    for (int t = 0; t < corners - 2; t++) {
        const uint32_t vertices[3] = { f->corner[0], f->corner[t + 1], f->corner[t + 2] };
        const double *p[3];
        double w[3], normal[3], down[3];
        for (int i = 0; i < 3; i++) p[i] = m->vertices + 3 * (size_t)vertices[i];
        if (!triangle_weights(w, p[0], p[1], p[2], point)) continue;
        if (t + 3 < corners && fmin(w[0], fmin(w[1], w[2])) < 0.0) continue;
        for (int i = 0; i < 3; i++) {
            normal_at(m, f, vertices[i], normal);
            vec3_sub(down, point, p[i]);
            double depth = fmax(-vec3_dot(down, normal), 0.0);
            is_lifted |= depth > LEAST_DEPTH * vec3_length(down);
            vec3_add_scaled(out, out, fmax(w[i], 0.0) * depth, normal);
        }
        break;
    }
    return is_lifted;
}

bool shading_normals_lift_sample(const mesh *m, const surface *f, bool is_smooth, size_t sample, double out[3]) {
    const double point[3] = { m->x[sample], m->y[sample], m->z[sample] };
    vec3_copy(out, point);
    return is_smooth && shading_normals_lift(m, f, point, out);
}
