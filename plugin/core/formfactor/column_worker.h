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
    column statistics; /* of the column in work; holds no arrays */
    bool failed;
};

void column_mark_reached(column_worker *w, uint32_t patch_index);

/* Remembers that a piece shoots. */
void column_add_path(column_worker *w, uint64_t path);

/* As column_receive, by the hybrid; factors are 0 and get sums. */
void column_receive_hybrid(column_worker *w, const column *c, const column_piece *piece, const mesh *receiving,
                           const column_receiver *receivers, size_t count, float *factors);

/* Each fills w->sum, the patches reached and w->statistics. */
void column_give_hybrid(column_worker *w, const column_piece *piece);
void column_give_pixels(column_worker *w, const column_piece *piece);

#endif
