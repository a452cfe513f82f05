/* SPDX-License-Identifier: MIT
 * What does one thread need to compute columns? Scratch memory that the methods (column_hybrid.c, column_pixels.c) fill
 * and column.c collects. Private to them.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_COLUMN_WORKER_H
#define HEMIBAKE_CORE_FORMFACTOR_COLUMN_WORKER_H

#include "formfactor/column.h"

/* What a part of the shooter gives to all samples, and where its own power goes. */
typedef struct part {
    float *factors; /* factors[sample], 0 where nothing arrives */
    hemicube_closure closure;
    double received; /* sum_s A_s F_s, m2 */
} part;

struct column_worker {
    const column_setup *setup;
    item_buffer *items;
    hemicube cube;
    double *batch;     /* unoccluded factors of one receiving patch */
    double *sum;       /* sum[sample] over the parts of the shooter */
    double *element;   /* element[e]: weights of the pixels that show it; for COLUMN_PIXELS only */
    part parts[4];     /* of the level that is being compared */
    uint32_t *reached; /* patches with a nonzero factor in sum */
    bool *is_reached;  /* of patches */
    size_t reached_count;
    uint64_t *paths; /* of the pieces whose factors are in sum */
    size_t path_count, path_capacity, batch_capacity;
    uint8_t *seen; /* seen[k]: does any view of an emitter see the k-th sample? */
    size_t seen_capacity;
    uint32_t *candidates, *blockers; /* surfaces that may hide an emitter */
    uint32_t *packed;                /* of the hemi-cube of the whole shooter; goes to the column */
    size_t packed_count;
    column statistics; /* of the column in work; holds no arrays */
    bool failed;
};

/* What shoots. */
typedef struct shooting_subpatch {
    const subpatch *piece;
    double normal[3]; /* unit, to the front */
    double plane;     /* normal . x of what is lowest */
    bool light;
    double coverage; /* share of the piece that is no hole; of a cluster, see cluster.share */
} shooting_subpatch;

/* A piece of the shooter as its hemi-cube sees the world. */
typedef struct shooter_view {
    const polygon *shape;
    double center[3], area_vector[3];
    double diameter; /* the edge of a square as large: see near_distance.h */
} shooter_view;

shooter_view shooter_view_of(const polygon *shape);

/* What a piece shoots as. */
shooting_subpatch shooting_subpatch_of(const column_worker *w, const subpatch *piece);

/* The view of a shape that is all of the source or a part of it. Of a cluster there is only the whole; its middle is on
 * its surface. */
shooter_view shooter_view_from(const shooting_subpatch *s, const polygon *shape);

/* Draws the hemi-cube over a point of the shooter. */
void column_look(column_worker *w, const shooting_subpatch *s, const double point[3], uint64_t path);

/* w->batch: the factors of a receiver's samples, from what is no hole, as if nothing stood between; false if none gets
 * any. */
bool unoccluded_factors(column_worker *w, const shooting_subpatch *s, const shooter_view *from, const mesh *m,
                        const column_receiver *r);

/* Does the hemi-cube drawn last see a sample? */
bool column_sees_sample(const column_worker *w, const mesh *m, uint32_t surface_index, uint32_t sample);

/* Fills w->sum and what goes with it for an emitter, by column_emitter.c. */
void column_shoot_emitter(column_worker *w, const shooting_subpatch *s);

/* factors[k] of the k-th of all samples of the receivers, past what stands between. */
void column_emitter_factors(column_worker *w, const shooting_subpatch *s, const mesh *m,
                            const column_receiver *receivers, size_t count, float *factors);

void column_mark_reached(column_worker *w, uint32_t patch_index);

/* Remembers that a piece shoots. */
void column_add_path(column_worker *w, uint64_t path);

/* As column_receive, by the hybrid; factors are 0 and get sums. */
void column_receive_hybrid(column_worker *w, const column *c, const subpatch *piece, const mesh *receiving,
                           const column_receiver *receivers, size_t count, float *factors);

/* Each fills w->sum, the patches reached and w->statistics. */
void column_give_hybrid(column_worker *w, const subpatch *piece);
void column_give_pixels(column_worker *w, const subpatch *piece);

#endif
