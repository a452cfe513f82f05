/* SPDX-License-Identifier: MIT
 * Which triangles show the elements? Each element as its own (mesh/triangulation.h), and of those only the ones that
 * the picture needs.
 */
#ifndef HEMIBAKE_API_CUT_H
#define HEMIBAKE_API_CUT_H

#include "freeze.h"

#include "reconstruct/merge.h"
#include "reconstruct/vertex_fit.h"
#include "shown.h"

typedef struct cut_triangles {
    merge_triangles all; /* corners are vertices of the tessellation, faces surfaces of the scene */
    uint32_t *first;     /* first[i]: of mesh i; and behind the last */
} cut_triangles;

/* What is to be cut: the fit of radiance, and that of what colours carry where a texture stays, or NULL. */
typedef struct cut_input {
    const frozen *frozen;
    const shown_samples *samples;
    const vertex_fit_result *fit, *shown;
    jobs *jobs;
    double merge_error; /* as in hemi_bake_desc, resolved: nothing is merged at 0 */
} cut_input;

/* What merging did, for the statistics: how many triangles there were, and by what share of the radiance at a vertex it
 * changed colours at most, and over all, as a root of mean squares. */
typedef struct cut_merged {
    uint32_t triangles_before;
    double error, rms;
} cut_merged;

hemi_result cut_elements(const cut_input *in, cut_triangles *out, cut_merged *merged);
void cut_free(cut_triangles *c);

#endif
