/* SPDX-License-Identifier: MIT
 * Which vertex colours and triangles show the light that was solved for, and how far off are they? Fit, measure,
 * decimate.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_VERTEX_COLORS_H
#define HEMIBAKE_CORE_RECONSTRUCT_VERTEX_COLORS_H

#include "reconstruct/output_triangles.h"
#include "reconstruct/residual.h"

typedef struct vertex_colors_setup {
    fit_samples_input samples;        /* what was solved for */
    residual_setup residual;          /* scene, patches, jobs, resolution, seed, points; the rest is found here */
    output_triangles_input triangles; /* scene, nodes, inputs, faces, jobs, error; the rest is found here */
    const material *demodulated; /* demodulated[e]: element e without the texture that stays on it; NULL: none stays */
    watcher watch;               /* over: what is left is ended soon, with what there is */
    bool fits_irradiance;        /* irradiance / pi too, for what gets the light of a mesh in its place */
} vertex_colors_setup;

typedef struct vertex_colors {
    fit_samples samples;
    vertex_fit_result radiance;    /* of the nodes */
    vertex_fit_result demodulated; /* what colours carry where a texture stays */
    vertex_fit_result irradiance;  /* over pi: what a white surface would show */
    output_triangles triangles;
    decimation_figures decimation;
    double error;    /* estimated relative error [Baum89, eq. 12], decimation included */
    double bias;     /* as in residual_result */
    double residual; /* of the fit of what is shown, relative */
    double uneven;   /* where rows were gathered: what elements are too large for, relative */
    size_t points;   /* that the estimate is from */
} vertex_colors;

/* Takes the radiance of the samples; what was solved for is then read again only where there are several fits. False
 * when out of memory. */
bool vertex_colors_open(const vertex_colors_setup *setup, vertex_colors *out);

/* NULL on success, else why it failed. */
const char *vertex_colors_fit(const vertex_colors_setup *setup, vertex_colors *out);
const char *vertex_colors_measure(const vertex_colors_setup *setup, vertex_colors *out, char *message,
                                  size_t message_size);
/* The same where rows were gathered, from their noise at samples: fitting averages it away, but for the share that
 * nodes are of samples, and what else the fit leaves over is what linear colours cannot show. */
void vertex_colors_estimate(const vertex_colors_setup *setup, double noise, double uneven, vertex_colors *out);
const char *vertex_colors_decimate(const vertex_colors_setup *setup, vertex_colors *out);
void vertex_colors_free(vertex_colors *v);

#endif
