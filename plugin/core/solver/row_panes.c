/* SPDX-License-Identifier: MIT
 * See row_panes.h.
 */
#include "solver/row_panes.h"

#include "geometry/vec3.h"
#include "scene/material.h"

#include <string.h>

/* A ray to the sky ends outside of everything: so many radii of the scene away. */
static const double SKY_RADII = 4.0;

/* ---- the other side ---- */

/* The sample of an element at a place. */
static uint32_t nearest_sample(const mesh *m, const element *e, const double place[3]) {
    uint32_t best = e->first_sample;
    double least = INFINITY;
    for (uint32_t s = e->first_sample; s < e->first_sample + (uint32_t)element_corner_count(e); s++) {
        const double point[3] = { m->x[s], m->y[s], m->z[s] };
        double distance = vec3_distance_squared(point, place);
        if (distance < least) least = distance, best = s;
    }
    return best;
}

/* The two sides of a sheet are divided alike. */
static void find_other_side(row_panes *p, const uint32_t *first, uint32_t index) {
    const mesh *m = p->mesh;
    const element *e = &m->elements[index];
    uint32_t of = m->patches[e->patch].surface, twin = p->scene->surfaces[of].twin;
    if (!material_transmits_diffusely(e->material) || twin == NO_INDEX) return;
    const element *other = &m->elements[first[twin] + index - first[of]];
    for (uint32_t s = e->first_sample; s < e->first_sample + (uint32_t)element_corner_count(e); s++) {
        const double place[3] = { m->x[s], m->y[s], m->z[s] };
        p->other_side[s] = nearest_sample(m, other, place);
    }
}

static bool find_other_sides(row_panes *p) {
    const mesh *m = p->mesh;
    bool any = false;
    for (size_t e = 0; e < m->element_count; e++) any = any || material_transmits_diffusely(m->elements[e].material);
    if (!any) return true;
    uint32_t *first = block_new(m->memory, (p->scene->surface_count + 1) * sizeof *first);
    p->other_side = block_new(m->memory, (m->sample_count + 1) * sizeof *p->other_side);
    for (size_t s = 0; p->other_side && s < m->sample_count; s++) p->other_side[s] = NO_INDEX;
    for (size_t i = 0; first && i < p->scene->surface_count; i++) first[i] = NO_INDEX;
    bool ok = first && p->other_side;
    for (uint32_t e = 0; ok && e < m->element_count; e++) {
        uint32_t of = m->patches[m->elements[e].patch].surface;
        if (first[of] == NO_INDEX) first[of] = e;
    }
    for (uint32_t e = 0; ok && e < m->element_count; e++) find_other_side(p, first, e);
    block_free(first);
    return ok;
}

void row_panes_reflect(const row_panes *p, size_t element_index, const double *irradiance, double B[3]) {
    const element *e = &p->mesh->elements[element_index];
    if (!p->other_side) return;
    for (uint32_t s = e->first_sample; s < e->first_sample + (uint32_t)element_corner_count(e); s++) {
        size_t other = p->other_side[s];
        for (size_t c = 0; other != NO_INDEX && c < 3; c++)
            B[c] += e->material->diffuse_transmittance[c] *
                    (irradiance[3 * other + c] - irradiance[3 * (size_t)s + c]) * p->mesh->sample_area[s] / e->area;
    }
}

bool row_panes_combine_sides(const row_panes *p, double *irradiance) {
    const mesh *m = p->mesh;
    if (!p->other_side) return true;
    double *found = block_new(m->memory, (3 * m->sample_count + 1) * sizeof *found);
    if (!found) return false;
    memcpy(found, irradiance, 3 * m->sample_count * sizeof *found);
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++)
            for (size_t c = 0; p->other_side[s] != NO_INDEX && c < 3; c++) {
                double rho = e->material->rho[c], share = rho > 0.0 ? e->material->diffuse_transmittance[c] / rho : 0.0;
                irradiance[3 * s + c] =
                    (1.0 - share) * found[3 * s + c] + share * found[3 * (size_t)p->other_side[s] + c];
            }
    }
    block_free(found);
    return true;
}

/* ---- rays ---- */

bool row_panes_create(const scene *s, const mesh *m, const mesh *hit, row_panes *out) {
    out->scene = s;
    out->mesh = m, out->hit = hit;
    if (s->panes) out->of_sample = block_zeroed(m->memory, m->sample_count + 1, sizeof *out->of_sample);
    return (!s->panes || out->of_sample) && (m != hit || find_other_sides(out));
}

void row_panes_free(row_panes *p) {
    for (size_t s = 0; p->of_sample && s < p->mesh->sample_count; s++) block_free(p->of_sample[s].all);
    block_free_all(p->of_sample, p->other_side);
}

static void add_term(row_panes *p, size_t sample, uint32_t ray, uint32_t element_index, const double T[3]) {
    row_pane_terms *terms = &p->of_sample[sample];
    if (!block_grow(p->mesh->memory, (void **)&terms->all, &terms->capacity, terms->count, sizeof *terms->all)) {
        p->failed = true;
        return;
    }
    terms->all[terms->count++] = (row_pane_term){ ray, element_index, { (float)T[0], (float)T[1], (float)T[2] } };
}

static bool reflects(const mesh *m, uint32_t element_index) {
    const double *rho = m->elements[element_index].material->rho;
    return rho[0] > 0.0 || rho[1] > 0.0 || rho[2] > 0.0;
}

bool row_panes_trace(row_panes *p, pane_crossings *scratch, size_t sample, uint32_t ray, const double from[3],
                     const double direction[3], double distance, row_pane_end end, uint32_t element_index) {
    double to[3], T[3] = { 1, 1, 1 };
    vec3_add_scaled(to, from, end == ROW_PANE_SKY ? SKY_RADII * p->scene->radius : distance, direction);
    if (!panes_list(p->scene->panes, NO_INDEX, from, to, scratch)) p->failed = true;
    for (size_t i = 0; i < scratch->count; i++) {
        uint32_t crossed = scratch->all[i].element;
        if (crossed != NO_INDEX && reflects(p->hit, crossed)) add_term(p, sample, ray, crossed, T);
        for (int b = 0; b < 3; b++) T[b] *= scratch->all[i].transmittance[b];
    }
    if (scratch->count == 0 || end == ROW_PANE_BACK) return false;
    add_term(p, sample, ray, end == ROW_PANE_SKY ? NO_INDEX : element_index, T);
    return true;
}

void row_panes_truncate(row_panes *p, size_t sample, uint32_t first_ray) {
    row_pane_terms *terms = &p->of_sample[sample];
    while (terms->count > 0 && terms->all[terms->count - 1].ray >= first_ray) terms->count--;
}

void row_panes_sky(const row_panes *p, size_t sample, uint32_t ray, size_t *cursor, double T[3]) {
    const row_pane_terms *terms = &p->of_sample[sample];
    T[0] = T[1] = T[2] = 1.0;
    while (*cursor < terms->count && terms->all[*cursor].ray < ray) (*cursor)++;
    for (; *cursor < terms->count && terms->all[*cursor].ray == ray; (*cursor)++)
        for (int c = 0; c < 3 && terms->all[*cursor].element == NO_INDEX; c++) T[c] = (double)terms->all[*cursor].T[c];
}

void row_panes_gather(const row_pane_term *begin, const row_pane_term *end, const float *weight, const double *B,
                      double E[3]) {
    for (const row_pane_term *t = begin; t < end; t++)
        for (size_t c = 0; t->element != NO_INDEX && c < 3; c++)
            E[c] += (double)weight[t->ray] * (double)t->T[c] * B[3 * (size_t)t->element + c];
}

double row_panes_luminance(const row_panes *p, size_t sample, uint32_t ray, const double *luminance) {
    const row_pane_terms *terms = &p->of_sample[sample];
    size_t low = 0, high = terms->count;
    double sum = 0.0;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (terms->all[middle].ray < ray)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < terms->count && terms->all[low].ray == ray; low++) {
        const row_pane_term *t = &terms->all[low];
        if (t->element != NO_INDEX)
            sum += ((double)t->T[0] + (double)t->T[1] + (double)t->T[2]) / 3.0 * luminance[t->element];
    }
    return sum;
}

void row_panes_gather_all(const row_panes *p, size_t sample, const float *weight, const double *B, double E[3]) {
    if (!p->of_sample) return;
    const row_pane_terms *terms = &p->of_sample[sample];
    row_panes_gather(terms->all, terms->all + terms->count, weight, B, E);
}
