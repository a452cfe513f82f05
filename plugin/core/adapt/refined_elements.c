/* SPDX-License-Identifier: MIT */
#include "adapt/refined_elements.h"

#include <string.h>

/* Of the scene's mean irradiance: darker elements count as bright as this, since nobody sees what they are off by. */
static const double DARK = 0.1;

/* Where the sums of form factors around a corner differ by more than this, something stands on the surface there: all
 * shooters are partly hidden at once, and what each of them little is off by adds up. */
static const double REACH_RATIO = 0.6;

void fine_place_weights(const fine_place *place, int corners, int k, double w[4]) {
    double at[2];
    element_sample_place(corners, k, at);
    double u = place->u + place->size * at[0], v = place->v + place->size * at[1];
    if (corners == 3) {
        w[1] = 2 * u - 1.0 / 3.0, w[2] = 2 * v - 1.0 / 3.0, w[0] = 1 - w[1] - w[2], w[3] = 0.0;
        return;
    }
    double x = 2 * u - 0.5, y = 2 * v - 0.5;
    w[0] = (1 - x) * (1 - y), w[1] = x * (1 - y), w[2] = x * y, w[3] = (1 - x) * y;
}

static double irradiance_of(const element *e, const double *irradiance) {
    double sum = 0.0;
    int count = element_corner_count(e);
    for (int k = 0; k < 3 * count; k++) sum += irradiance[3 * (size_t)e->first_sample + (size_t)k];
    return sum / count;
}

/* low, high: of the row_sum of the samples around each corner. */
static void span_row_sums(const mesh *m, const double *row_sum, float *low, float *high) {
    for (size_t v = 0; v < m->vertex_count; v++) low[v] = INFINITY, high[v] = 0.0f;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        int corners = element_corner_count(e);
        for (int j = 0; j < corners * corners; j++) {
            float sum = (float)row_sum[e->first_sample + (uint32_t)(j / corners)];
            uint32_t v = e->corner[j % corners];
            low[v] = fminf(low[v], sum);
            high[v] = fmaxf(high[v], sum);
        }
    }
}

static bool find_contacts(const mesh *m, const double *row_sum, refined_elements *out) {
    float *low = block_new(m->memory, (m->vertex_count + 1) * sizeof *low),
          *high = block_new(m->memory, (m->vertex_count + 1) * sizeof *high);
    bool ok = low && high;
    if (ok) span_row_sums(m, row_sum, low, high);
    for (size_t i = 0; ok && i < out->count; i++) {
        const element *e = &m->elements[out->all[i].coarse];
        for (int k = 0; k < element_corner_count(e); k++)
            out->all[i].in_contact |= low[e->corner[k]] < (float)REACH_RATIO * high[e->corner[k]];
    }
    block_free_all(low, high);
    return ok;
}

/* The fine samples, on the outline of the coarse element. */
static column_receiver receiver_of(const mesh *m, const refined_element *r) {
    const element *e = &m->elements[r->coarse];
    int count = element_corner_count(e);
    column_receiver out = { .surface = m->patches[e->patch].surface,
                            .patch = e->patch,
                            .is_smooth = m->patches[e->patch].is_smooth,
                            .first_sample = r->first_sample,
                            .sample_count = r->sample_count };
    memcpy(out.corner, e->corner, sizeof out.corner);
    for (int i = 0; i < count; i++)
        vec3_add_scaled(out.center, out.center, 1.0 / count, m->vertices + 3 * (size_t)e->corner[i]);
    for (int i = 0; i < count; i++)
        out.diameter = fmax(out.diameter, 2 * vec3_distance(out.center, m->vertices + 3 * (size_t)e->corner[i]));
    return out;
}

bool refined_elements_find(const mesh *coarse, const double *irradiance, const double *row_sum, const mesh *fine,
                           const fine_place *places, refined_elements *out) {
    double sum = 0.0, area = 0.0;
    for (size_t i = 0; i < coarse->element_count; i++) {
        sum += coarse->elements[i].area * irradiance_of(&coarse->elements[i], irradiance);
        area += coarse->elements[i].area;
    }
    double dark = DARK * (area > 0.0 ? sum / area : 0.0);
    *out = (refined_elements){ .all = block_new(coarse->memory, (fine->element_count + 1) * sizeof *out->all) };
    for (size_t i = 0; out->all && i < fine->element_count; i++) {
        const element *e = &coarse->elements[places[i].coarse];
        refined_element *last = out->count ? &out->all[out->count - 1] : NULL;
        if (!last || last->coarse != places[i].coarse) {
            last = &out->all[out->count++];
            *last = (refined_element){ .coarse = places[i].coarse,
                                       .first_fine = (uint32_t)i,
                                       .first_sample = fine->elements[i].first_sample,
                                       .size = sqrt(element_corner_count(e) == 3 ? 2 * e->area : e->area),
                                       .irradiance = fmax(irradiance_of(e, irradiance), dark) };
        }
        last->sample_count += (uint32_t)element_corner_count(&fine->elements[i]);
    }
    for (size_t i = 0; out->all && i < out->count; i++) out->all[i].receiver = receiver_of(coarse, &out->all[i]);
    return out->all && find_contacts(coarse, row_sum, out);
}

void refined_elements_free(refined_elements *e) {
    block_free(e->all);
    *e = (refined_elements){ 0 };
}
