/* SPDX-License-Identifier: MIT
 * How much light do emitters give to a sample, by shadow rays? Where they are few each is sampled: its closed form,
 * times the share of it that rays to points spread over it see; emitters that give little of the whole share a few rays
 * between them. Where they are very many each ray is for one that is drawn by importance, from a tree of them whose
 * nodes say about how much light comes from there, and counts by how likely that was. So does each that is for one of a
 * crowd of punctual lights.
 *
 * A column is exact and costs a look at the whole scene for each emitter; rays cost the same however many there are.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_EMITTERS_H
#define HEMIBAKE_CORE_SOLVER_ROW_EMITTERS_H

#include "base/deadline.h"
#include "base/jobs.h"
#include "light/lights.h"
#include "mesh/mesh.h"
#include "visibility/rays.h"

typedef struct row_emitters_setup {
    const scene *scene;
    const mesh *mesh;
    const mesh *hit; /* whose elements rays hit, and of whose samples these are parts; NULL: the same */
    const rays *rays;
    jobs *jobs;
    const lights *lights; /* which are asked, too, if they are a crowd; NULL: none */
    uint64_t seed;
    int ray_count;            /* of a sample */
    bool (*wait)(void *user); /* as jobs_wait_fn; may be NULL */
    void *wait_user;
    const deadline
        *latest; /* by then the least rays of all samples, and rays_after more of each, are cast; may be NULL */
    double rays_after;
    bool *is_late;      /* set where that needed fewer rays than were meant; NULL where latest is */
    double *irradiance; /* irradiance[3*s+c]: what they give is added */
    double *
        half_difference; /* half_difference[3*s+c]: half the difference of what either half of the rays says is added */
    double *lights_w;    /* what of it arrived from lights, W; NULL: nobody asks */
} row_emitters_setup;

/* False when out of memory. Samples that no worker came to when wait said false, or when what must still come left no
 * more time, do with the least rays. */
bool row_emitters_gather(const row_emitters_setup *setup);

#endif
