/* SPDX-License-Identifier: MIT
 * See row_allocation.h.
 */
#include "solver/row_allocation.h"

#include <math.h>

/* Rays of a kind come in fours, so that both halves are nets too, and no row gets more than this many times the mean,
 * which bounds what a single bright spot can take from the rest. */
enum { STEP = 4, OF_MEAN_MAX = 12, COUNT_MAX = 4096 };

/* From these ratios of variance to squared mean on a half, and three quarters, of the adaptive rays are guided: below,
 * what is hit is even enough for the cosine. */
static const double GUIDED_HALF = 1.0, GUIDED_MOST = 6.0;

/* With fewer targets than this, groups have seen too little to guide. */
enum { TARGETS_MIN = 6 };

/* Rays to emitters grow by no more than so many times. */
enum { REPEATS_MOST = 15 };
/* A group that sees less than this share of the mean light, as behind a slot or a door that is ajar, and whose samples
 * are off by more than so many times what they see, has its rays from a share of the adaptive ones that is kept for
 * such groups, by what they are off by of their own light: by that of the whole it would never get any. */
static const double DIM = 0.01, UNSURE = 2.0, SHARE_OF_UNSURE = 0.25;
enum { UNSURE_OF_MEAN_MAX = 64 };

/* Pilot rays of a sample, a share of the initial ones. What a group wants to know is answered by all of its elements
 * together: eight a sample were half of all rays of an apartment at draft, for errors that differ by less than 0.2 %.
 * Two, beside eight initial ones, lost a window of 0.2 m. */
enum { INITIAL_TO_PILOT = 4, PILOT_RAYS_MIN = 2, PILOT_RAYS_MAX = 4 };

static uint16_t pilot_rays(const row_counts *n) {
    int count = n->initial / INITIAL_TO_PILOT;
    return (uint16_t)(count < PILOT_RAYS_MIN ? PILOT_RAYS_MIN : count > PILOT_RAYS_MAX ? PILOT_RAYS_MAX : count);
}

/* Few rays do not know their own variance: what neighbours say counts as much. */
static double variance_of(const row_guiding *guiding, size_t e) {
    return 0.5 * ((double)guiding->seen[e].variance + row_guiding_group(guiding, e)->variance);
}

/* Of an element that looks another way than most of its group does, as the inside of a window's frame beside its front,
 * what it sees itself says more: where that is half sky, the cosine finds it. */
static double guided_share(const row_guiding *guiding, size_t e) {
    const row_group *g = row_guiding_group(guiding, e);
    double own = guiding->seen[e].mean, square = 0.5 * (own * own + g->mean * g->mean);
    double ratio = square > 0.0 ? variance_of(guiding, e) / square : 0.0;
    if (g->target_count < TARGETS_MIN) return 0.0;
    return ratio >= GUIDED_MOST ? 0.75 : ratio >= GUIDED_HALF ? 0.5 : 0.0;
}

/* Others have targets, of which the group itself has hardly seen any: it is to look there. */
static bool is_told(const row_guiding *guiding, size_t e) {
    const row_group *g = row_guiding_group(guiding, e);
    return g->own_count < TARGETS_MIN && g->target_count > g->own_count;
}

bool row_allocation_pilot(const row_rays *r, const row_guiding *guiding, row_counts *counts) {
    bool any = false;
    for (size_t e = 0; e < r->mesh->element_count; e++) {
        bool is_guided =
            material_reflects(r->mesh->elements[e].material) && (is_told(guiding, e) || guided_share(guiding, e) > 0.0);
        counts[e] =
            (row_counts){ .initial = r->counts[e].initial, .guided = is_guided ? pilot_rays(&r->counts[e]) : 0 };
        any = any || is_guided;
    }
    return any;
}

/* noise: the variance of a ray, times the area. */
static double need_of_noise(const mesh *m, size_t e, double noise) {
    const element *one = &m->elements[e];
    double rho = fmax(fmax(one->material->rho[0], one->material->rho[1]), one->material->rho[2]);
    return rho * sqrt(noise / element_corner_count(one));
}

static double need_of(const row_rays *r, const row_guiding *guiding, size_t e) {
    return need_of_noise(r->mesh, e, variance_of(guiding, e) * r->mesh->elements[e].area);
}

/* What is seen, on an average of all area. */
static double mean_light(const mesh *m, const row_guiding *guiding) {
    double sum = 0.0, area = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        sum += m->elements[e].area * (double)guiding->seen[e].mean;
        area += m->elements[e].area;
    }
    return area > 0.0 ? sum / area : 0.0;
}

/* The same by the light of the group itself; 0 where that is sure enough, or as bright as elsewhere. */
static double need_of_unsure(const row_rays *r, const row_guiding *guiding, size_t e, double light) {
    const row_group *g = row_guiding_group(guiding, e);
    bool is_unsure = g->variance > UNSURE * UNSURE * g->mean * g->mean * r->counts[e].initial;
    return g->mean > 0.0 && g->mean < DIM * light && is_unsure ? need_of(r, guiding, e) / g->mean : 0.0;
}

static uint16_t whole(double count) {
    return (uint16_t)(STEP * floor(fmin(fmax(count, 0.0), COUNT_MAX) / STEP + 0.5));
}

static double count_of(double need, double factor, double most) {
    double count = factor * need;
    return count < most ? count : most;
}

/* The factor by which needs become counts that add up to the total. */
static double factor_of(const mesh *m, const double *needs, double total, double most) {
    double low = 0.0, high = 1.0, sum = 0.0;
    for (size_t e = 0; e < m->element_count; e++) sum += needs[e] * element_corner_count(&m->elements[e]);
    if (!(sum > 0.0)) return 0.0;
    low = total / sum, high = 64.0 * low;
    for (int i = 0; i < 24; i++) {
        double middle = sqrt(low * high), spent = 0.0;
        for (size_t e = 0; e < m->element_count; e++)
            spent += count_of(needs[e], middle, most) * element_corner_count(&m->elements[e]);
        *(spent < total ? &low : &high) = middle;
    }
    return low;
}

/* counts[e] += what element e gets of so many rays of all samples. */
static void add_shares(const mesh *m, const double *needs, double total, double most, double *counts) {
    double factor = factor_of(m, needs, total, most);
    for (size_t e = 0; e < m->element_count; e++) counts[e] += count_of(needs[e], factor, most);
}

bool row_allocation_share(const row_rays *r, const row_guiding *guiding, double total, row_counts *counts) {
    const mesh *m = r->mesh;
    double mean = total / ((double)m->sample_count + 1.0), unsure = 0.0;
    double *needs = block_new(m->memory, (m->element_count + 1) * sizeof *needs);
    double *sums = block_zeroed(m->memory, m->element_count + 1, sizeof *sums);
    bool ok = needs && sums;
    const double light = mean_light(m, guiding);
    for (size_t e = 0; ok && e < m->element_count; e++) {
        needs[e] = need_of_unsure(r, guiding, e, light);
        if (needs[e] > 0.0) unsure += element_corner_count(&m->elements[e]);
    }
    double kept = fmin(mean * unsure, SHARE_OF_UNSURE * total);
    if (ok && kept > 0.0) add_shares(m, needs, kept, UNSURE_OF_MEAN_MAX * mean, sums);
    for (size_t e = 0; ok && e < m->element_count; e++) needs[e] = need_of(r, guiding, e);
    if (ok) add_shares(m, needs, total - kept, OF_MEAN_MAX * mean, sums);
    for (size_t e = 0; ok && e < m->element_count; e++) {
        double share = guided_share(guiding, e);
        counts[e] = (row_counts){ .initial = r->counts[e].initial,
                                  .cosine = whole((1.0 - share) * sums[e]),
                                  .guided = whole(share * sums[e]) };
    }
    block_free_all(needs, sums);
    return ok;
}

/* ---- rays to emitters ---- */

/* The mean variance of an element's samples, as their halves say, times its area. */
static double noise_of_halves(const mesh *m, const double *half_difference, size_t e) {
    const element *one = &m->elements[e];
    size_t corners = (size_t)element_corner_count(one);
    double sum = 0.0;
    for (size_t s = one->first_sample; s < one->first_sample + corners; s++) {
        const double *h = half_difference + 3 * s;
        double d = (h[0] + h[1] + h[2]) / 3.0;
        sum += d * d;
    }
    return one->area * (sum / (double)corners);
}

/* An element's own halves say little of its noise: those of the elements around it count as much. */
static double need_of_halves(const mesh *m, const double *noise, size_t e) {
    if (m->elements[e].is_foot) return 0.0;
    return need_of_noise(m, e, 0.5 * (noise[e] + mesh_mean_around(m, noise, e) * m->elements[e].area));
}

bool row_allocation_repeat(const mesh *m, const double *half_difference, double share, uint16_t *times) {
    size_t bytes = (m->element_count + 1) * sizeof(double);
    double *noise = block_new(m->memory, bytes), *needs = block_new(m->memory, bytes), samples = 0.0;
    bool ok = noise && needs;
    for (size_t e = 0; ok && e < m->element_count; e++) {
        noise[e] = noise_of_halves(m, half_difference, e);
        samples += element_corner_count(&m->elements[e]);
    }
    for (size_t e = 0; ok && e < m->element_count; e++) needs[e] = need_of_halves(m, noise, e);
    double factor = ok ? factor_of(m, needs, share * samples, REPEATS_MOST) : 0.0;
    for (size_t e = 0; ok && e < m->element_count; e++)
        times[e] = (uint16_t)(count_of(needs[e], factor, REPEATS_MOST) + 0.5);
    block_free_all(noise, needs);
    return ok;
}
