/* SPDX-License-Identifier: MIT
 * Which triangles show the elements? Each element as its own (mesh/triangulation.h), and of those only the ones that
 * the picture needs.
 */
#ifndef HEMIBAKE_API_OUTPUT_TRIANGLES_H
#define HEMIBAKE_API_OUTPUT_TRIANGLES_H

#include "build_scene.h"

#include "fit_samples.h"
#include "reconstruct/decimate.h"
#include "reconstruct/vertex_fit.h"

typedef struct output_triangles {
    decimate_triangles all; /* corners are vertices of the tessellation, faces surfaces of the scene */
    uint32_t *first;        /* first[i]: of mesh i; and behind the last */
} output_triangles;

/* What is to be cut: the fit of radiance, and that of what colours carry where a texture stays, or NULL. */
typedef struct output_triangles_input {
    const bake_scene *bake_scene;
    const fit_samples *samples;
    const vertex_fit_result *fit, *demodulated;
    jobs *jobs;
    double merge_error; /* as in hemi_bake_desc, resolved: nothing is merged at 0 */
} output_triangles_input;

/* What merging did, for the statistics: how many triangles there were, and by what share of the radiance at a vertex it
 * changed colours at most, and over all, as a root of mean squares. */
typedef struct decimated {
    uint32_t triangles_before;
    double error, rms;
} decimated;

hemi_result output_triangles_make(const output_triangles_input *in, output_triangles *out, decimated *merged);
void output_triangles_free(output_triangles *c);

#endif
