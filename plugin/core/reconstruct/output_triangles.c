/* SPDX-License-Identifier: MIT */
#include "reconstruct/output_triangles.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Of the mean radiance of what does not emit: darker vertices count as bright as this, since nobody sees what they are
 * off by. */
static const double DARK = 0.1;

/* ---- all triangles ---- */

static bool list_triangles(const output_triangles_input *in, decimate_triangles *out) {
    const mesh *m = in->mesh;
    const uint8_t *diagonal = in->demodulated ? in->demodulated->diagonal : in->fit->diagonal;
    size_t count = 0;
    uint8_t triangle[ELEMENT_TRIANGLES_MAX][3];
    for (size_t e = 0; e < m->element_count; e++)
        count += (size_t)element_triangles(&m->elements[e], diagonal[e], triangle);
    if (count >= UINT32_MAX / 3) return false;
    out->corners = block_new(in->mesh->memory, 3 * count * sizeof *out->corners + 1);
    out->faces = block_new(in->mesh->memory, count * sizeof *out->faces + 1);
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

static bool keep_diagonals(const output_triangles_input *in) {
    output_record *r = in->record;
    size_t count = in->mesh->element_count;
    if (!r || r->collapses.is_given) return true;
    r->diagonal = arena_alloc(r->collapses.memory, count + 1, 1);
    if (!r->diagonal) return false;
    memcpy(r->diagonal, in->demodulated ? in->demodulated->diagonal : in->fit->diagonal, count);
    r->diagonal_count = count;
    return true;
}

/* ---- decimation ---- */

/* Of what does not emit: the mean of radiance over area, and its square integrated over it, all bands. */
static double mean_level(const output_triangles_input *in, double *square) {
    const mesh *m = in->mesh;
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
    size_t count = in->node_count;
    double *out = block_new(in->mesh->memory, (count + 1) * sizeof *out);
    for (size_t n = 0; out && n < count; n++) {
        const double *v = values + 3 * n;
        out[n] = in->decimate_error * fmax(fmax(floor, DBL_MIN), fmax(v[0], fmax(v[1], v[2])));
    }
    return out;
}

/* Surfaces of which some element emits; the others of a flat face are of the same material. */
static bool *emitter_faces(const output_triangles_input *in) {
    const mesh *m = in->mesh;
    bool *emitters = block_zeroed(in->mesh->memory, in->scene->surface_count + 1, sizeof *emitters);
    for (size_t e = 0; emitters && e < m->element_count; e++)
        if (in->samples->emits[e]) emitters[m->patches[m->elements[e].patch].surface] = true;
    return emitters;
}

/* Puts the triangles of each flat face together, under the number of its first surface. */
static bool gather_faces(const output_triangles_input *in, decimate_triangles *t) {
    allocator *memory = in->mesh->memory;
    size_t surfaces = in->scene->surface_count;
    uint32_t *next = block_zeroed(memory, surfaces + 1, sizeof *next);
    decimate_triangles to = { .count = t->count };
    to.corners = block_new(memory, 3 * (size_t)t->count * sizeof *to.corners + 1);
    to.faces = block_new(memory, (size_t)t->count * sizeof *to.faces + 1);
    bool ok = next && to.corners && to.faces;
    for (uint32_t i = 0; ok && i < t->count; i++) next[in->flat_face[t->faces[i]] + 1]++;
    for (size_t s = 0; ok && s < surfaces; s++) next[s + 1] += next[s];
    for (uint32_t i = 0; ok && i < t->count; i++) {
        uint32_t face = in->flat_face[t->faces[i]], at = next[face]++;
        to.faces[at] = face;
        memcpy(to.corners + 3 * (size_t)at, t->corners + 3 * (size_t)i, 3 * sizeof *to.corners);
    }
    block_free_all(next, ok ? t->corners : to.corners, ok ? t->faces : to.faces);
    if (ok) *t = to;
    return ok;
}

static bool decimate_faces_of(const output_triangles_input *in, decimate_triangles *triangles,
                              decimation_figures *figures) {
    double square, floor = DARK * mean_level(in, &square);
    double *radiance = tolerances(in, in->fit->radiance, floor);
    double *demodulated = in->demodulated ? tolerances(in, in->demodulated->radiance, floor) : NULL;
    bool *emitters = emitter_faces(in);
    decimate_input setup = { .jobs = in->jobs,
                             .watch = in->watch,
                             .positions = in->mesh->vertices,
                             .nodes = in->nodes,
                             .vertex_count = (uint32_t)in->mesh->vertex_count,
                             .kept = in->kept,
                             .emitters = emitters,
                             .fields = { { in->fit->radiance, radiance } },
                             .field_count = 1,
                             .record = in->record ? &in->record->collapses : NULL };
    decimate_result result = { 0 };
    if (demodulated) setup.fields[setup.field_count++] = (decimate_field){ in->demodulated->radiance, demodulated };
    bool ok = radiance && emitters && (!in->demodulated || demodulated) && gather_faces(in, triangles) &&
              decimate(&setup, triangles, &result);
    figures->error = in->decimate_error * result.error;
    figures->rms = square > 0.0 ? sqrt(result.square / square) : 0.0;
    block_free_all(radiance, demodulated, emitters);
    return ok;
}

bool output_triangles_make(const output_triangles_input *in, output_triangles *out, decimation_figures *figures) {
    memset(out, 0, sizeof *out);
    memset(figures, 0, sizeof *figures);
    bool ok = list_triangles(in, &out->all) && keep_diagonals(in);
    figures->triangles_before = out->all.count;
    if (ok && in->decimate_error > 0.0) ok = decimate_faces_of(in, &out->all, figures);
    out->first = ok ? block_new(in->mesh->memory, (in->input_count + (size_t)1) * sizeof *out->first) : NULL;
    for (uint32_t i = 0, t = 0; out->first && i <= in->input_count; i++) {
        while (t < out->all.count && in->scene->surfaces[out->all.faces[t]].mesh < i) t++;
        out->first[i] = t;
    }
    return out->first;
}

void output_triangles_free(output_triangles *t) {
    block_free_all(t->all.corners, t->all.faces, t->first);
    memset(t, 0, sizeof *t);
}

/* ---- the vertices of a mesh ---- */

static int compare_vertices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a & ~OUTPUT_TRIANGLES_BACK, y = *(const uint32_t *)b & ~OUTPUT_TRIANGLES_BACK;
    return (x > y) - (x < y);
}

uint32_t output_triangles_list(const output_triangles *t, const scene *s, size_t index, uint32_t *local,
                               uint32_t *order) {
    size_t first = 3 * (size_t)t->first[index], end = 3 * (size_t)t->first[index + 1];
    uint32_t count = 0;
    for (size_t c = first; c < end; c++) local[t->all.corners[c]] = NO_INDEX;
    for (size_t c = first; c < end; c++) {
        uint32_t v = t->all.corners[c];
        if (local[v] != NO_INDEX) continue;
        local[v] = 0;
        uint32_t own = t->all.faces[c / 3];
        order[count++] = v | (surface_sheet(s, own) != own ? OUTPUT_TRIANGLES_BACK : 0);
    }
    qsort(order, count, sizeof *order, compare_vertices);
    for (uint32_t i = 0; i < count; i++) local[order[i] & ~OUTPUT_TRIANGLES_BACK] = i;
    return count;
}
