/* SPDX-License-Identifier: MIT
 * Which rays does a row have, and what did they hit? The rays of a sample are, in this order,
 *
 *     initial   by the cosine, as many for every sample
 *     cosine    adaptive ones by the cosine, where rows are noisy
 *     guided    adaptive ones towards what is bright (row_guiding.h), where little of what is seen is
 *
 * each of which weighs p / (n p + n' q), p and q the densities by the cosine and of guiding, n and n' how many there
 * are by either: the balance heuristic [Veach95]. The weights of a row are brought to add up to 1, as form factors do.
 * Samples of an element have the same numbers of rays, and share one net of points (base/sobol.h).
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_RAYS_H
#define HEMIBAKE_CORE_SOLVER_ROW_RAYS_H

#include "light/lights.h"
#include "solver/row_guiding.h"
#include "solver/row_panes.h"
#include "solver/row_sharing.h"

/* What a ray hit that is no element. */
#define ROW_HIT_BACK    (UINT32_MAX - 1)
#define ROW_HIT_SKY     UINT32_MAX
#define ROW_HIT_PANES   (UINT32_MAX - 2) /* an element, past panes: row_panes.h */
#define ROW_HIT_ELEMENT (UINT32_MAX - 3) /* at most */

typedef struct row_counts {
    uint16_t initial, cosine, guided;
} row_counts;

typedef struct row_rays {
    const scene *scene;
    const mesh *mesh;
    const lights *lights;
    const rays *rays;
    row_panes panes;
    const row_sharing *sharing; /* NULL: all rows are here, else those of its own */
    uint64_t seed;
    row_counts *counts; /* counts[e] */
    size_t *begin;      /* begin[e]: of the rays of the first sample of element e; those of the next ones follow */
    uint32_t *hit;
    float *weight;
    double *row_sum; /* row_sum[s]: what the rays weigh that do not hit a back */
    double *sky;     /* sky[6*s+3*h+c]: irradiance of sample s from the sky by half h of its rays, whose sum it is */
} row_rays;

/* A sample, and how its rays are drawn; lobes is NULL where none is guided. */
typedef struct row_sampler {
    uint32_t element;
    int corner;
    double from[3], axes[3][3]; /* the last axis is which way it looks */
    const double *front;        /* normal of its surface */
    uint64_t net, own;   /* seeds: of the net that its initial rays are from, and of what its element has alone */
    uint32_t row_of_net; /* which part of the net is its own */
    const row_lobes *lobes;
} row_sampler;

static inline size_t row_count(const row_rays *r, size_t e) {
    return (size_t)r->counts[e].initial + r->counts[e].cosine + r->counts[e].guided;
}

/* The rays of a sample of an element, of hit and weight. */
static inline size_t row_begin(const row_rays *r, size_t e, int corner) {
    return r->begin[e] + (size_t)corner * row_count(r, e);
}

/* Which of the two halves of a row a ray is in: rows of either half are whole estimates. */
static inline int row_half(const row_counts *n, size_t i) {
    size_t cosine = i - n->initial, guided = cosine - n->cosine;
    if (i < n->initial) return 2 * i >= n->initial;
    return cosine < n->cosine ? 2 * cosine >= n->cosine : 2 * guided >= n->guided;
}

/* Room for count rays a sample, all of them initial ones, or for those of counts, which it takes, all uncast. False
 * when out of memory. */
bool row_rays_create(row_rays *r, uint16_t count);
bool row_rays_open(row_rays *r, row_counts *counts);
void row_rays_free(row_rays *r);

/* Adaptive rays as counts say, all but the initial ones uncast. False when out of memory; r is then as before. */
bool row_rays_extend(row_rays *r, row_counts *counts);

/* A sample; the second guides its rays, if any of its element's is guided; guiding may be NULL if none is. */
row_sampler row_sampler_of(const row_rays *r, uint32_t element, int corner);
row_sampler row_sampler_guided(const row_rays *r, const row_guiding *guiding, uint32_t element, int corner,
                               row_lobes *lobes);
void row_direction(const row_rays *r, const row_sampler *at, size_t i, double out[3]);

/* Casts the rays of all samples of an element from first on, and weighs them all. guiding: NULL where none is guided.
 */
void row_rays_cast(row_rays *r, uint32_t element, size_t first, const row_guiding *guiding);

/* Leaves the samples of an element no rays but so many initial ones, as they are; they are to be cast again. */
void row_rays_truncate(row_rays *r, uint32_t element, uint16_t initial);

/* Of what an element reflects, the share that its rays carried to the sky or to backs. */
double row_escaped_share(const row_rays *r, size_t e);

/* Is the sky the same in all directions? row_sky then needs none. */
static inline bool row_sky_is_even(const row_rays *r) {
    return !r->lights->has_sky || !r->lights->sky_image.radiance;
}

/* Radiance of the sky along a ray that hit it. */
void row_sky(const row_rays *r, const row_sampler *at, size_t i, double L[3]);

#endif
