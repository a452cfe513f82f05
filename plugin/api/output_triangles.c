/* SPDX-License-Identifier: MIT
 * See output_triangles.h.
 */
#include "output_triangles.h"

#include "flat_faces.h"
#include "proxy_mesh.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Of the mean radiance of what does not emit: darker vertices count as bright as this, since nobody sees what they are
 * off by. */
static const double DARK = 0.1;

/* ---- all triangles -------------------------------------------------------------------------------------------------
 */

static bool list_triangles(const output_triangles_input *in, decimate_triangles *out) {
    const mesh *m = &in->bake_scene->mesh;
    const uint8_t *diagonal = in->demodulated ? in->demodulated->diagonal : in->fit->diagonal;
    size_t count = 0;
    uint8_t triangle[ELEMENT_TRIANGLES_MAX][3];
    for (size_t e = 0; e < m->element_count; e++)
        count += (size_t)element_triangles(&m->elements[e], diagonal[e], triangle);
    if (count >= UINT32_MAX / 3) return false;
    out->corners = block_new(in->bake_scene->memory.memory, 3 * count * sizeof *out->corners + 1);
    out->faces = block_new(in->bake_scene->memory.memory, count * sizeof *out->faces + 1);
    if (!out->corners || !out->faces) return false;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        int triangles = element_triangles(e, diagonal[i], triangle);
        for (int t = 0; t < triangles; t++) {
            for (int k = 0; k < 3; k++)
                out->corners[3 * (size_t)out->count + (size_t)k] = element_vertex(e, triangle[t][k]);
            out->faces[out->count++] = m->patches[e->patch].surface;
        }
    }
    return true;
}

static bool find_firsts(const bake_scene *f, output_triangles *out) {
    uint32_t t = 0;
    out->first = block_new(f->memory.memory, (f->mesh_count + 1) * sizeof *out->first);
    for (size_t i = 0; out->first && i <= f->mesh_count; i++) {
        while (t < out->all.count && f->scene.surfaces[out->all.faces[t]].mesh < i) t++;
        out->first[i] = t;
    }
    return out->first;
}

/* ---- merging -------------------------------------------------------------------------------------------------------
 */

/* Of what does not emit: the mean of radiance over area, and its square integrated over it, all bands. */
static double mean_level(const output_triangles_input *in, double *square) {
    const mesh *m = &in->bake_scene->mesh;
    double sum = 0.0, area = 0.0;
    *square = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        if (in->samples->emits[e]) continue;
        for (size_t k = 0; k < (size_t)element_corner_count(&m->elements[e]); k++) {
            size_t s = m->elements[e].first_sample + k;
            const double *L = in->samples->radiance + 3 * s;
            sum += m->sample_area[s] * (L[0] + L[1] + L[2]) / 3.0;
            *square += m->sample_area[s] * vec3_dot(L, L);
            area += m->sample_area[s];
        }
    }
    return area > 0.0 ? sum / area : 0.0;
}

/* NULL when out of memory. */
static double *tolerances(const output_triangles_input *in, const double *values, double floor) {
    size_t count = in->bake_scene->pieces.node_count;
    double *out = block_new(in->bake_scene->memory.memory, (count + 1) * sizeof *out);
    for (size_t n = 0; out && n < count; n++) {
        const double *v = values + 3 * n;
        out[n] = in->merge_error * fmax(fmax(floor, DBL_MIN), fmax(v[0], fmax(v[1], v[2])));
    }
    return out;
}

/* What stands in for a dense mesh is only read at the dense mesh's vertices. */
static bool *kept_faces(const bake_scene *f) {
    bool *kept = block_zeroed(f->memory.memory, f->scene.surface_count + 1, sizeof *kept);
    for (size_t i = 0; kept && i < f->scene.surface_count; i++)
        kept[i] = proxy_mesh_is_used(f, f->scene.surfaces[i].mesh);
    return kept;
}

/* Surfaces of which some element emits; the others of a flat face are of the same material. */
static bool *emitter_faces(const output_triangles_input *in) {
    const mesh *m = &in->bake_scene->mesh;
    bool *emitters =
        block_zeroed(in->bake_scene->memory.memory, in->bake_scene->scene.surface_count + 1, sizeof *emitters);
    for (size_t e = 0; emitters && e < m->element_count; e++)
        if (in->samples->emits[e]) emitters[m->patches[m->elements[e].patch].surface] = true;
    return emitters;
}

/* Puts the triangles of each flat face together, under the number of its first surface. */
static bool gather_faces(const bake_scene *f, decimate_triangles *t) {
    size_t surfaces = f->scene.surface_count;
    uint32_t *first = block_new(f->memory.memory, (surfaces + 1) * sizeof *first);
    uint32_t *next = block_zeroed(f->memory.memory, surfaces + 1, sizeof *next);
    decimate_triangles to = { .count = t->count };
    to.corners = block_new(f->memory.memory, 3 * (size_t)t->count * sizeof *to.corners + 1);
    to.faces = block_new(f->memory.memory, (size_t)t->count * sizeof *to.faces + 1);
    bool ok = first && next && to.corners && to.faces && flat_faces_join(f, first);
    for (uint32_t i = 0; ok && i < t->count; i++) next[first[t->faces[i]] + 1]++;
    for (size_t s = 0; ok && s < surfaces; s++) next[s + 1] += next[s];
    for (uint32_t i = 0; ok && i < t->count; i++) {
        uint32_t face = first[t->faces[i]], at = next[face]++;
        to.faces[at] = face;
        memcpy(to.corners + 3 * (size_t)at, t->corners + 3 * (size_t)i, 3 * sizeof *to.corners);
    }
    block_free(first);
    block_free(next);
    block_free(ok ? t->corners : to.corners);
    block_free(ok ? t->faces : to.faces);
    if (ok) *t = to;
    return ok;
}

static hemi_result decimate_triangles_of(const output_triangles_input *in, decimate_triangles *triangles,
                                         decimated *merged) {
    double square, floor = DARK * mean_level(in, &square);
    double *radiance = tolerances(in, in->fit->radiance, floor);
    double *light = in->demodulated ? tolerances(in, in->demodulated->radiance, floor) : NULL;
    bool *kept = kept_faces(in->bake_scene), *emitters = emitter_faces(in);
    decimate_input setup = { .jobs = in->jobs,
                             .positions = in->bake_scene->pieces.positions,
                             .nodes = in->bake_scene->pieces.nodes,
                             .vertex_count = in->bake_scene->pieces.vertex_count,
                             .kept = kept,
                             .emitters = emitters,
                             .fields = { { in->fit->radiance, radiance } },
                             .field_count = 1 };
    decimate_result result = { 0 };
    if (light) setup.fields[setup.field_count++] = (decimate_field){ in->demodulated->radiance, light };
    bool ok = radiance && kept && emitters && (!in->demodulated || light) && gather_faces(in->bake_scene, triangles) &&
              decimate(&setup, triangles, &result);
    merged->error = in->merge_error * result.error;
    merged->rms = square > 0.0 ? sqrt(result.square / square) : 0.0;
    block_free(radiance);
    block_free(light);
    block_free(kept);
    block_free(emitters);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

hemi_result output_triangles_make(const output_triangles_input *in, output_triangles *out, decimated *merged) {
    memset(out, 0, sizeof *out);
    memset(merged, 0, sizeof *merged);
    hemi_result result = list_triangles(in, &out->all) ? HEMI_OK : HEMI_ERROR_MEMORY;
    merged->triangles_before = out->all.count;
    if (result == HEMI_OK && in->merge_error > 0.0) result = decimate_triangles_of(in, &out->all, merged);
    return result == HEMI_OK && !find_firsts(in->bake_scene, out) ? HEMI_ERROR_MEMORY : result;
}

void output_triangles_free(output_triangles *c) {
    block_free(c->all.corners);
    block_free(c->all.faces);
    block_free(c->first);
    memset(c, 0, sizeof *c);
}
