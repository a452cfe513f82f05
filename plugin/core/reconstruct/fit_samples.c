/* SPDX-License-Identifier: MIT */
#include "reconstruct/fit_samples.h"

#include "geometry/vec3.h"

#include <string.h>

/* Where something stands on a patch, a sample that shooters hardly reach is inside it. It says little about the
 * vertices around it, which may be in the room: they listen to it only if nothing else speaks. Form factors from all
 * shooters sum to 1 at a sample in a closed room, and with the share of the sky that is seen in any scene; what has
 * less than a tenth of that is all but buried. */
static const double ROW_SUM_OF_A_ROOM = 0.1, BURIED_WEIGHT = 1e-3;

static double sample_confidence(bool crossed, double row_sum) {
    double share = crossed && row_sum < ROW_SUM_OF_A_ROOM ? row_sum / ROW_SUM_OF_A_ROOM : 1.0;
    return share * share > BURIED_WEIGHT ? share * share : BURIED_WEIGHT;
}

static void set_element(const fit_samples_input *in, size_t index, fit_samples *out) {
    const element *e = &in->mesh->elements[index];
    uint8_t ring[ELEMENT_PLACES];
    int places = element_ring(e, ring);
    out->emits[index] = material_emits(e->material);
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++) {
        double row_sum = in->row_sum[s] + (in->direct_row_sum ? in->direct_row_sum[s] : 0.0);
        out->weight[s] = in->mesh->sample_area[s] * sample_confidence(in->crossed[e->patch], row_sum);
    }
    for (size_t k = 0; k < ELEMENT_PLACES; k++) out->nodes[ELEMENT_PLACES * index + k] = NO_INDEX;
    for (int k = 0; k < places; k++)
        out->nodes[ELEMENT_PLACES * index + ring[k]] = in->vertex_nodes[element_vertex(e, ring[k])];
}

static bool is_buried(const fit_samples *all, const mesh *m, const element *e) {
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++)
        if (all->weight[s] >= m->sample_area[s]) return false;
    return true;
}

/* Where nothing around a vertex is in the room, there is no light of the room to carry on: what lies wholly inside
 * something has what was found there, else the light of the nearest place that is half outside would fill all of it. */
static bool trust_insides(const fit_samples_input *in, fit_samples *out) {
    const mesh *m = in->mesh;
    bool *outside = block_zeroed(m->memory, m->node_count + 1, sizeof *outside); /* of nodes */
    if (!outside) return false;
    for (size_t i = 0; i < m->element_count; i++)
        for (const uint32_t *node = out->nodes + ELEMENT_PLACES * i, *end = node + ELEMENT_PLACES;
             node < end && !is_buried(out, m, &m->elements[i]); node++)
            if (*node != NO_INDEX) outside[*node] = true;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        bool is_inside = is_buried(out, m, e);
        for (size_t k = 0; k < ELEMENT_PLACES && is_inside; k++) {
            uint32_t node = out->nodes[ELEMENT_PLACES * i + k];
            is_inside = node == NO_INDEX || !outside[node];
        }
        for (size_t s = e->first_sample; is_inside && s < (size_t)e->first_sample + (size_t)element_corner_count(e);
             s++)
            out->weight[s] = m->sample_area[s];
    }
    block_free(outside);
    return true;
}

void fit_samples_set_radiance(const fit_samples_input *in, const material *materials, fit_samples *out) {
    for (size_t i = 0; i < in->mesh->element_count; i++) {
        const element *e = &in->mesh->elements[i];
        const material *a = materials ? &materials[i] : e->material;
        for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++)
            for (size_t c = 0; c < 3; c++)
                out->radiance[3 * s + c] = (a->M[c] + a->rho[c] * in->irradiance[3 * s + c]) / PI;
    }
}

bool fit_samples_create(const fit_samples_input *in, fit_samples *out) {
    const mesh *m = in->mesh;
    *out = (fit_samples){ .radiance = block_new(m->memory, (3 * m->sample_count + 1) * sizeof *out->radiance),
                          .weight = block_new(m->memory, (m->sample_count + 1) * sizeof *out->weight),
                          .nodes = block_new(m->memory, (ELEMENT_PLACES * m->element_count + 1) * sizeof *out->nodes),
                          .emits = block_new(m->memory, m->element_count + 1),
                          .uneven = in->uneven };
    if (!out->radiance || !out->weight || !out->nodes || !out->emits) return false;
    for (size_t i = 0; i < m->element_count; i++) set_element(in, i, out);
    fit_samples_set_radiance(in, NULL, out);
    return trust_insides(in, out);
}

void fit_samples_free(fit_samples *s) {
    block_free_all(s->radiance, s->weight, s->nodes, s->emits);
    memset(s, 0, sizeof *s);
}
