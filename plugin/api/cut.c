/* SPDX-License-Identifier: MIT
 * See cut.h.
 */
#include "cut.h"

#include "coplanar.h"
#include "stand_in.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Of the mean radiance of what does not emit: darker vertices count as bright as this, since nobody sees what they are
 * off by. */
static const double DARK = 0.1;

/* ---- all triangles -------------------------------------------------------------------------------------------------
 */

static bool list_triangles(const cut_input *in, merge_triangles *out) {
    const mesh *m = &in->frozen->mesh;
    const uint8_t *diagonal = in->shown ? in->shown->diagonal : in->fit->diagonal;
    size_t count = 0;
    uint8_t triangle[ELEMENT_TRIANGLES_MAX][3];
    for (size_t e = 0; e < m->element_count; e++)
        count += (size_t)element_triangles(&m->elements[e], diagonal[e], triangle);
    if (count >= UINT32_MAX / 3) return false;
    out->corners = block_new(in->frozen->memory.memory, 3 * count * sizeof *out->corners + 1);
    out->faces = block_new(in->frozen->memory.memory, count * sizeof *out->faces + 1);
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

static bool find_firsts(const frozen *f, cut_triangles *out) {
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
static double mean_level(const cut_input *in, double *square) {
    const mesh *m = &in->frozen->mesh;
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
static double *tolerances(const cut_input *in, const double *values, double floor) {
    size_t count = in->frozen->pieces.node_count;
    double *out = block_new(in->frozen->memory.memory, (count + 1) * sizeof *out);
    for (size_t n = 0; out && n < count; n++) {
        const double *v = values + 3 * n;
        out[n] = in->merge_error * fmax(fmax(floor, DBL_MIN), fmax(v[0], fmax(v[1], v[2])));
    }
    return out;
}

/* What stands in for a dense mesh is only read at the dense mesh's vertices. */
static bool *kept_faces(const frozen *f) {
    bool *kept = block_zeroed(f->memory.memory, f->scene.surface_count + 1, sizeof *kept);
    for (size_t i = 0; kept && i < f->scene.surface_count; i++) kept[i] = stand_in_stands(f, f->scene.surfaces[i].mesh);
    return kept;
}

/* Surfaces of which some element emits; the others of a flat face are of the same material. */
static bool *lamp_faces(const cut_input *in) {
    const mesh *m = &in->frozen->mesh;
    bool *lamps = block_zeroed(in->frozen->memory.memory, in->frozen->scene.surface_count + 1, sizeof *lamps);
    for (size_t e = 0; lamps && e < m->element_count; e++)
        if (in->samples->emits[e]) lamps[m->patches[m->elements[e].patch].surface] = true;
    return lamps;
}

/* Puts the triangles of each flat face together, under the number of its first surface. */
static bool gather_faces(const frozen *f, merge_triangles *t) {
    size_t surfaces = f->scene.surface_count;
    uint32_t *first = block_new(f->memory.memory, (surfaces + 1) * sizeof *first);
    uint32_t *next = block_zeroed(f->memory.memory, surfaces + 1, sizeof *next);
    merge_triangles to = { .count = t->count };
    to.corners = block_new(f->memory.memory, 3 * (size_t)t->count * sizeof *to.corners + 1);
    to.faces = block_new(f->memory.memory, (size_t)t->count * sizeof *to.faces + 1);
    bool ok = first && next && to.corners && to.faces && coplanar_join(f, first);
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

static hemi_result merge_cut(const cut_input *in, merge_triangles *triangles, cut_merged *merged) {
    double square, floor = DARK * mean_level(in, &square);
    double *radiance = tolerances(in, in->fit->radiance, floor);
    double *light = in->shown ? tolerances(in, in->shown->radiance, floor) : NULL;
    bool *kept = kept_faces(in->frozen), *lamps = lamp_faces(in);
    merge_input setup = { .jobs = in->jobs,
                          .positions = in->frozen->pieces.positions,
                          .nodes = in->frozen->pieces.nodes,
                          .vertex_count = in->frozen->pieces.vertex_count,
                          .kept = kept,
                          .lamps = lamps,
                          .fields = { { in->fit->radiance, radiance } },
                          .field_count = 1 };
    merge_result result = { 0 };
    if (light) setup.fields[setup.field_count++] = (merge_field){ in->shown->radiance, light };
    bool ok = radiance && kept && lamps && (!in->shown || light) && gather_faces(in->frozen, triangles) &&
              merge(&setup, triangles, &result);
    merged->error = in->merge_error * result.error;
    merged->rms = square > 0.0 ? sqrt(result.square / square) : 0.0;
    block_free(radiance);
    block_free(light);
    block_free(kept);
    block_free(lamps);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

hemi_result cut_elements(const cut_input *in, cut_triangles *out, cut_merged *merged) {
    memset(out, 0, sizeof *out);
    memset(merged, 0, sizeof *merged);
    hemi_result result = list_triangles(in, &out->all) ? HEMI_OK : HEMI_ERROR_MEMORY;
    merged->triangles_before = out->all.count;
    if (result == HEMI_OK && in->merge_error > 0.0) result = merge_cut(in, &out->all, merged);
    return result == HEMI_OK && !find_firsts(in->frozen, out) ? HEMI_ERROR_MEMORY : result;
}

void cut_free(cut_triangles *c) {
    block_free(c->all.corners);
    block_free(c->all.faces);
    block_free(c->first);
    memset(c, 0, sizeof *c);
}
