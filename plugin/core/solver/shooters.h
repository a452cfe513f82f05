/* SPDX-License-Identifier: MIT
 * What shoots, and how much has it left? Every patch is a shooter; one that is too large for its light may be cut into
 * four (subdivision.h) that keep their own unshot radiosity, each from the samples that lie on it. Of a cluster the
 * first patch shoots for all: what the others receive is added to what it has.
 */
#ifndef HEMIBAKE_CORE_SOLVER_SHOOTERS_H
#define HEMIBAKE_CORE_SOLVER_SHOOTERS_H

#include "solver/row_closure.h"

/* What computing its column took. */
typedef struct shooter_choices {
    uint32_t hemicubes;
    uint64_t analytic, evaluations;
    bool split;
} shooter_choices;

typedef struct shooter {
    subpatch subpatch;
    double unshot[3]; /* W/m2; negative where it was shot before it came (over-shooting) */
    double shot[3];   /* W/m2: what its kept column must still deliver to the samples */
    double shot_in_all[3];
    column *column;       /* NULL: not computed, or let go */
    double *averages;     /* of the column's runs where rows are closed; NULL: they are the column's own */
    uint32_t quarters[4]; /* the shooters it was cut into; quarters[0] is NO_INDEX while it is whole */
    uint32_t shots;
    bool is_counted; /* its column is in the row sums */
    shooter_choices choices;
} shooter;

typedef struct shooters {
    const scene *scene;
    const mesh *mesh;
    shooter *all; /* shooter p < mesh->patch_count is patch p, or nothing if another leads its cluster; then quarters */
    size_t count, capacity;
    uint32_t *of_sample; /* of_sample[s]: the shooter that sample s lies on, in patches that were cut */
    row_closure rows;    /* what factors are closed with where they are summed */
} shooters;

/* Every patch a shooter, as shooters_reset leaves it. False when out of memory. */
bool shooters_create(const scene *s, const mesh *m, const double *arrived, shooters *out);
void shooters_free(shooters *s); /* and their columns */

/* Back to the beginning: M + rho E unshot, where E is what has arrived (arrived[3*s+c] of sample s, or NULL), nothing
 * shot. Columns stay. */
void shooters_reset(shooters *s, const double *arrived);

static inline bool shooter_is_whole(const shooter *s) {
    return s->quarters[0] == NO_INDEX;
}

/* Does it shoot, on its own or for a cluster? */
static inline bool shooter_leads(const shooters *s, size_t index) {
    return index >= s->mesh->patch_count || mesh_lead(s->mesh, (uint32_t)index) == index;
}

/* The patch average of a run of the shooter's column. */
static inline double shooter_average(const shooter *s, size_t run) {
    return s->averages ? s->averages[run] : s->column->runs[run].factor;
}

static inline const material *shooter_material(const shooters *s, size_t index) {
    return &s->mesh->patches[s->all[index].subpatch.patch].material;
}

static inline bool shooter_emits(const shooters *s, const shooter *one) {
    return material_emits(&s->mesh->patches[one->subpatch.patch].material);
}

/* Lets go of its column. */
void shooter_drop_column(shooter *s);

/* Mean of what has arrived at the samples of a patch, E[c]; 0 if arrived is NULL. */
void shooters_direct(const shooters *s, uint32_t patch_index, const double *arrived, double E[3]);

/* |unshot| of the bands times the area, W. */
double shooter_unshot_power(const shooter *s);

/* How often the patch was quartered to get it. */
int shooter_depth(const shooter *s);

/* unshot of the patch of a run of the shooter's column += rho F B, where F is the patch average, or in a patch that was
 * cut that of each sample. Returns the power gained in gain[c], W. */
void shooters_receive(shooters *s, const shooter *from, size_t run, const double B[3], double gain[3]);

/* Mean unshot radiosity of a patch, or of its cluster, W/m2; only what is positive counts. */
void shooters_patch_unshot(const shooters *s, uint32_t patch_index, double unshot[3]);

#endif
