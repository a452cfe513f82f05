/* SPDX-License-Identifier: MIT
 * How much of the light of one shooting patch does every sample of the scene receive? A column of the form-factor
 * matrix: F_si for all samples s and one patch i. It is found in one of three ways, column_method.
 *
 * The hybrid of [Baum89, sec. 5]: a hemi-cube on the patch decides what is visible; the factor is the closed form near
 * the shooter and for emitters, a point estimate far away (the limit of eq. 7 and 8 for small pixels, without their
 * aliasing). A shooter that is too large is cut into quarters, each with a hemi-cube of its own (solver/subdivision.h).
 * A cluster is not cut: where it would have to be, its members must shoot alone (column.crowded). Or, for emitters in
 * scenes of few surfaces, what a sample sees of one is cut out exactly, column_emitter.c.
 *
 * Where we differ from the paper: factors are taken at fixed samples of the receiving elements, not at the points that
 * the pixels happen to hit, and averaged over the whole element, not over its visible part. So an element half in
 * shadow gets half the light, and the number of pixels on an element does not matter.
 *
 * The original way [Cohen88] is there to compare with, as it was: pixels of one hemi-cube are counted (eq. 7) and
 * turned round by reciprocity (eq. 8).
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_COLUMN_H
#define HEMIBAKE_CORE_FORMFACTOR_COLUMN_H

#include "formfactor/hemicube_weights.h"
#include "formfactor/subpatch.h"
#include "visibility/mesh_items.h"

typedef enum column_method {
    COLUMN_HYBRID,   /* closed forms for emitters and near the shooter, point estimates elsewhere */
    COLUMN_ANALYTIC, /* closed forms everywhere */
    COLUMN_PIXELS,   /* eq. 7 and 8: one value an element, no turn, no quarters, no normalisation */
} column_method;

/* The samples of one receiving patch. */
typedef struct column_run {
    uint32_t patch;
    uint32_t first; /* into column.factors; as many as the patch has samples */
    double factor;  /* patch average of the run: sum_s A_s F_si / A_patch */
    double tint[3]; /* mean over the run of what panes leave of the light; of use where the column has tints */
} column_run;

typedef struct column {
    column_run *runs;
    size_t run_count;
    float *factors;
    float *tints; /* tints[3*k+c]: what panes leave of the light of factors[k]; NULL: all of it */
    size_t factor_count;
    uint64_t *paths; /* of the subpatches: the whole, or the quarters it was cut to; NULL where pixels count */
    size_t path_count;
    uint32_t *packed; /* what the hemi-cube of a whole shooter saw (hemicube_pack); NULL: draw it again */
    size_t packed_count;
    double subpatch_scale;    /* what the subpatches' factors were multiplied with; column.scale comes on top */
    hemicube_closure closure; /* mean over the hemi-cubes of the column */
    double total;             /* sum_s A_s F_si / A_i [Baum89, eq. 10], before normalisation */
    double scale;             /* what the column was multiplied with [Baum89, eq. 11] */
    double largest;           /* of the factors */
    double penumbra;          /* share of the received power whose visibility the parts of the shooter disagree on */
    uint32_t hemicubes;
    uint64_t analytic, evaluations; /* closed forms, all factors */
    bool split;                     /* the shooter was cut */
    bool crowded;                   /* a cluster that one hemi-cube does not do for: no factors were found */
    bool crossed;                   /* something stands on the patch or passes through it */
} column;

/* The scratch memory of one worker thread. */
typedef struct column_worker column_worker;

/* What every column of a bake needs; not changed by computing one. */
typedef struct column_setup {
    column_method method;
    const scene *scene;
    const mesh *mesh;
    item_geometry items;
    item_backend backend; /* 0: default */
    const uint32_t *triangle_surface;
    const mesh_items *elements; /* for COLUMN_PIXELS */
    int resolution, resolution_light;
    const double *weights, *weights_light;
    uint64_t seed;
    /* Shoots a shooter whole, or subdivided: solver/subdivision.h. Not asked where pixels count or emitters are exact
     */
    void (*shoot)(column_worker *w, const subpatch *shooter);
    int light_depth, patch_depth; /* how often it may be quartered */
    bool keep_cubes;              /* columns keep what their hemi-cubes saw, for column_receive */
    bool exact_emitters;          /* emitters are not quartered: where one is seen in part, what is seen is cut out */
    double light_tolerance;       /* share of an emitter's power in penumbra that cuts it further */
    double near_diameters;        /* D_min: closed form nearer than this, in edges of the shooter: near_distance.h */
} column_setup;

column_worker *column_worker_create(const column_setup *setup, char *message, size_t message_size);
void column_worker_destroy(column_worker *w);

/* Some samples of a finer mesh, all on one planar polygon of a surface. */
typedef struct column_receiver {
    uint32_t surface, patch;
    uint32_t corner[4]; /* of the polygon, into mesh.vertices; [3] is NO_INDEX in a triangle */
    double center[3], diameter;
    bool is_smooth; /* patch.is_smooth */
    uint32_t first_sample, sample_count;
} column_receiver;

column_receiver column_patch_receiver(const mesh *m, uint32_t patch_index);

/* What the samples of other receivers get from a shooter whose column is known: through the same hemi-cubes, scaled
 * alike. factors[k]: of the k-th of all their samples. False when out of memory or when the back end fails. */
bool column_receive(column_worker *w, const column *c, const subpatch *shooter, const mesh *receiving,
                    const column_receiver *receivers, size_t count, float *factors);

/* The column of one shooter, in memory of its own; NULL when out of memory or when the back end fails. Depends on
 * nothing but the setup and the shooter. */
column *column_compute(column_worker *w, const subpatch *shooter);
/* Room for runs and factors, which are left unset. NULL when out of memory. */
column *column_create(allocator *memory, size_t run_count, size_t factor_count);
void column_destroy(column *c);

/* The first run of a patch or of one after it: an index up to run_count. */
size_t column_first_run(const column *c, uint32_t patch_index);

/* The run of a patch, NULL if nothing reaches it. */
const column_run *column_run_of_patch(const column *c, uint32_t patch_index);
size_t column_bytes(const column *c);

#endif
