/* SPDX-License-Identifier: MIT
 * What does one thread need to compute columns? Scratch memory that the methods (column_hybrid.c, column_emitter.c,
 * column_pixels.c) fill and column.c collects. Private to them, and to solver/subdivision.c, which says through how
 * many hemi-cubes a shooter shoots.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_COLUMN_WORKER_H
#define HEMIBAKE_CORE_FORMFACTOR_COLUMN_WORKER_H

#include "formfactor/column.h"
#include "visibility/panes.h"

/* What a subpatch gives to all samples, and where its own power goes. */
typedef struct subpatch_factors {
    float *factors; /* factors[sample], 0 where nothing arrives */
    hemicube_closure closure;
    double received; /* sum_s A_s F_s, m2 */
} subpatch_factors;

struct column_worker {
    const column_setup *setup;
    item_buffer *items;
    hemicube cube;
    double *batch;   /* unoccluded factors of one receiving patch */
    double *sum;     /* sum[sample] over the subpatches of the shooter */
    double *element; /* element[e]: weights of the pixels that show it; for COLUMN_PIXELS only */
    subpatch_factors quarters[4];
    uint32_t *reached; /* patches with a nonzero factor in sum */
    bool *is_reached;  /* of patches */
    size_t reached_count;
    uint64_t *paths; /* of the subpatches whose factors are in sum */
    size_t path_count, path_capacity, batch_capacity;
    uint8_t *seen; /* seen[k]: does any view of an emitter see the k-th sample? */
    size_t seen_capacity;
    uint32_t *candidates, *blockers; /* surfaces that may hide an emitter */
    uint32_t *packed;                /* of the hemi-cube of the whole shooter; goes to the column */
    size_t packed_count;
    pane_crossings crossings;
    column statistics; /* of the column in work; holds no arrays */
    bool failed;
};

/* Draws a hemi-cube that looks from a point of a subpatch. */
void column_look_from_point(column_worker *w, const subpatch *from, const double point[3], uint64_t path);

/* Where the k-th sample of a receiver looks for the light of a shooter from: for that of emitters it is on the smooth
 * surface which its facet stands for. False: on its facet. */
bool column_place(const column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r, uint32_t k,
                  double out[3]);

/* Does the hemi-cube drawn last, on a shooter, see the k-th sample of a receiver? */
bool column_sees_sample(const column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r,
                        uint32_t k);

/* w->batch: the factors of a receiver's samples, from what is no hole, as if nothing stood between; false if none gets
 * any. */
bool unoccluded_factors(column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r);

/* The steps of a shot through the hemi-cube of a subpatch: draws it and says where its power goes; finds the factors of
 * all samples; adds them to the sum, share being that of the shooter's area. */
void column_open_subpatch(column_worker *w, const subpatch *from, subpatch_factors *out);
void column_shoot_subpatch(column_worker *w, const subpatch *from, subpatch_factors *out);
void column_add_subpatch(column_worker *w, const subpatch *from, const subpatch_factors *f, double share);

/* The column keeps what the hemi-cube drawn last saw. */
void column_keep_cube(column_worker *w);

/* Multiplies the sums. */
void column_scale_sums(column_worker *w, double scale);

/* Takes back what was found for a subpatch and not added. */
void column_forget_reached(column_worker *w);

/* Finds what panes leave of the light of a shooter at the samples of a column. */
void column_tint(column_worker *w, const subpatch *shooter, column *c);

void column_mark_reached(column_worker *w, uint32_t patch_index);

/* Remembers that a subpatch shoots. */
void column_add_path(column_worker *w, uint64_t path);

/* factors[k] of the k-th of all samples of the receivers, past what stands between. */
void column_emitter_factors(column_worker *w, const subpatch *emitter, const mesh *m, const column_receiver *receivers,
                            size_t count, float *factors);

/* As column_receive, by the hybrid; factors are 0 and get sums. */
void column_receive_hybrid(column_worker *w, const column *c, const subpatch *shooter, const mesh *receiving,
                           const column_receiver *receivers, size_t count, float *factors);

/* Each fills w->sum, the patches reached and w->statistics, as column_setup.shoot does. */
void column_shoot_emitter(column_worker *w, const subpatch *emitter);
void column_shoot_pixels(column_worker *w, const subpatch *shooter);

#endif
