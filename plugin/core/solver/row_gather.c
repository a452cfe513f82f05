/* SPDX-License-Identifier: MIT
 * See row_gather.h.
 */
#include "solver/row_gather.h"

#include "geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_A_JOB = 64 };

/* Adds what the rays begin .. end of a row bring from what elements reflect; the sum of their weights. Whether a ray
 * hit an element is as good as random, and is not branched on: what hit none brings nothing of element 0. */
static double gather(const row_rays *r, const double *B, size_t begin, size_t end, double E[3]) {
    double sum = 0.0, x = E[0], y = E[1], z = E[2];
    for (size_t i = begin; i < end; i++) {
        uint32_t hit = r->hit[i], is_element = hit <= ROW_HIT_ELEMENT;
        double w = (double)r->weight[i], on = w * (double)is_element;
        const double *from = B + 3 * (size_t)(hit & (0 - is_element));
        sum += w;
        x += on * from[0], y += on * from[1], z += on * from[2];
    }
    E[0] = x, E[1] = y, E[2] = z;
    return sum;
}

void row_gather(const row_rays *r, const double *B, size_t e, int corner, double E[3]) {
    size_t s = r->mesh->elements[e].first_sample + (size_t)corner, begin = row_begin(r, e, corner);
    for (size_t c = 0; c < 3; c++) E[c] = r->sky[6 * s + c] + r->sky[6 * s + 3 + c];
    gather(r, B, begin, begin + row_count(r, e), E);
    row_panes_gather_all(&r->panes, s, r->weight + begin, B, E);
}

void row_gather_element(const row_rays *r, const double *B, size_t e, const double *direct, double *irradiance,
                        double reflected[3]) {
    const mesh *m = r->mesh;
    const element *one = &m->elements[e];
    reflected[0] = reflected[1] = reflected[2] = 0.0;
    for (int k = 0; k < element_corner_count(one); k++) {
        size_t s = one->first_sample + (size_t)k;
        double *E = irradiance + 3 * s;
        row_gather(r, B, e, k, E);
        for (size_t c = 0; c < 3; c++) {
            E[c] += direct[3 * s + c];
            reflected[c] += one->material->rho[c] * E[c] * m->sample_area[s] / one->area;
        }
    }
}

static void gather_by_half(const row_rays *r, const double *B, size_t e, int corner, double E[2][3]) {
    const row_counts *n = &r->counts[e];
    size_t s = r->mesh->elements[e].first_sample + (size_t)corner, begin = row_begin(r, e, corner);
    double sum[2] = { 0.0, 0.0 };
    memcpy(E, r->sky + 6 * s, 6 * sizeof(double));
    for (size_t i = 0; i < row_count(r, e); i++) {
        int h = row_half(n, i);
        sum[h] += gather(r, B, begin + i, begin + i + 1, E[h]);
    }
    const row_pane_terms *terms = r->panes.of_sample ? &r->panes.of_sample[s] : NULL;
    for (size_t i = 0; terms && i < terms->count; i++)
        row_panes_gather(terms->all + i, terms->all + i + 1, r->weight + begin, B, E[row_half(n, terms->all[i].ray)]);
    for (int h = 0; h < 2; h++)
        for (int c = 0; c < 3; c++) E[h][c] /= fmax(sum[h], 1e-30);
}

typedef struct halves_setup {
    const row_rays *rays;
    const double *B;
    double *half_difference;
} halves_setup;

static void halve_job(void *user, size_t job, unsigned worker) {
    const halves_setup *g = user;
    const mesh *m = g->rays->mesh;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < (job + 1) * ELEMENTS_A_JOB && e < m->element_count; e++)
        for (int k = 0; row_sharing_is_own(g->rays->sharing, e) && k < element_corner_count(&m->elements[e]); k++) {
            double by[2][3], *to = g->half_difference + 3 * (m->elements[e].first_sample + (size_t)k);
            gather_by_half(g->rays, g->B, e, k, by);
            for (int c = 0; c < 3; c++) to[c] += 0.5 * (by[0][c] - by[1][c]);
        }
}

bool row_gather_halves(const row_rays *r, const double *B, jobs *j, double *half_difference) {
    halves_setup g = { r, B, half_difference };
    jobs_run(j, (r->mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB, halve_job, NULL, &g);
    return row_sharing_give_samples(r->sharing, half_difference, 3 * sizeof *half_difference);
}

void row_add_squares(const mesh *m, const double *irradiance, size_t e, double *sum) {
    const element *one = &m->elements[e];
    for (size_t s = one->first_sample; s < (size_t)one->first_sample + (size_t)element_corner_count(one); s++)
        for (size_t c = 0; c < 3; c++) {
            double B = one->material->rho[c] * irradiance[3 * s + c];
            *sum += m->sample_area[s] * B * B;
        }
}

double row_noise(const mesh *m, const double *irradiance, const double *half_difference) {
    double noise = 0.0, level = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        row_add_squares(m, half_difference, e, &noise);
        row_add_squares(m, irradiance, e, &level);
    }
    return level > 0.0 ? sqrt(noise / level) : 0.0;
}

double row_gather_added(const mesh *m, const double *irradiance, const double *before) {
    double sum = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        const element *one = &m->elements[e];
        size_t first = 3 * (size_t)one->first_sample, count = 3 * (size_t)element_corner_count(one);
        const double *through = one->material->transmittance; /* what passes arrives elsewhere */
        for (size_t i = first; i < first + count && !row_gather_is_copy(m, e); i++)
            sum += m->sample_area[i / 3] * (1.0 - through[i % 3]) * (irradiance[i] - (before ? before[i] : 0.0));
    }
    return sum;
}

typedef struct escaping {
    const row_rays *rays;
    double *escaped;
} escaping;

static void escape_job(void *user, size_t job, unsigned worker) {
    const escaping *g = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < (job + 1) * ELEMENTS_A_JOB && e < g->rays->mesh->element_count; e++)
        if (row_sharing_is_own(g->rays->sharing, e)) g->escaped[e] = row_escaped_share(g->rays, e);
}

/* escaped[e]: of what element e reflects, the share that goes to the sky or to backs. NULL: out of memory, or others
 * are lost. */
static double *find_escaped(const row_rays *r, jobs *j) {
    double *escaped = block_zeroed(r->mesh->memory, r->mesh->element_count + 1, sizeof *escaped);
    escaping g = { r, escaped };
    if (escaped) jobs_run(j, (r->mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB, escape_job, NULL, &g);
    if (escaped && row_sharing_give_elements(r->sharing, escaped, sizeof *escaped)) return escaped;
    block_free(escaped);
    return NULL;
}

bool row_gather_books(const row_rays *r, const double *irradiance, const double *B, jobs *j, double *sky_w,
                      double *absorbed_w, double *escaped_w) {
    const mesh *m = r->mesh;
    double *escaped = find_escaped(r, j);
    if (!escaped || !row_sharing_give_samples(r->sharing, r->sky, 6 * sizeof *r->sky))
        return block_free(escaped), false;
    for (size_t e = 0; e < m->element_count; e++) {
        const element *one = &m->elements[e];
        if (row_gather_is_copy(m, e)) continue;
        for (int k = 0; k < element_corner_count(one); k++) {
            size_t s = one->first_sample + (size_t)k;
            const double *from_sky = r->sky + 6 * s;
            for (size_t c = 0; c < 3; c++) {
                const double stays = 1.0 - one->material->transmittance[c]; /* the rest arrives elsewhere */
                *sky_w += m->sample_area[s] * stays * (from_sky[c] + from_sky[3 + c]);
                *absorbed_w += m->sample_area[s] * (stays - one->material->rho[c]) * irradiance[3 * s + c];
            }
        }
        for (size_t c = 3 * e; c < 3 * e + 3; c++) *escaped_w += one->area * B[c] * escaped[e];
    }
    block_free(escaped);
    return true;
}
