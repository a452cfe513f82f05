/* SPDX-License-Identifier: MIT
 * How far is what is shown from what the radiosity equation says, at points that nobody solved for?
 *
 *     r(x) = L_shown(x) - rho/pi [ sum over emitters F_visible B_emitter + sum over pixels of the rest F_q B_q ]
 *
 * at random points of surfaces that do not emit, light gathered from what is shown: emitters by the closed form of what
 * a point sees of them (formfactor/emitter_visibility.h), the rest by a hemi-cube on the point, each patch as the plane
 * that fits its samples best. The error e of a solution answers e = r + K e with K the transport operator: what differs
 * from place to place hardly survives a bounce, and e = r; what is one-sided is reflected again and again, and e = r /
 * (1 - rho). So
 *
 *     error^2 = variance of r + (mean of r / (1 - rho))^2,   relative to the mean square of what was gathered,
 *
 * and one standard error of the variance more: large errors are rare, and few points miss what is rare.
 * Light of punctual lights is asked for at the point itself (light/point_light.h), unless there are very many; that of
 * the sky is what the hemi-cube sees, but past panes and holes.
 * Where a texture stays on a surface, what is shown there is what the colours carry times the texture's mean over the
 * element: detail finer than elements is shown as it is, and is no error.
 *
 * An a-posteriori estimate in the way of residual estimators [Lischinski94], with a sample for the maximum.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_RESIDUAL_H
#define HEMIBAKE_CORE_RECONSTRUCT_RESIDUAL_H

#include "base/jobs.h"
#include "light/lights.h"
#include "mesh/triangulation.h"
#include "visibility/mesh_items.h"

typedef struct residual_setup {
    const scene *scene;
    const mesh *mesh;
    const mesh_items *patches;
    item_backend backend;
    jobs *jobs;
    int resolution;        /* of the hemi-cubes */
    const double *weights; /* hemicube_weights of it */
    uint64_t seed;
    size_t point_count;
    watcher watch;              /* over: points that no worker has looked at by then do not count, but for a few */
    const double *samples;      /* samples[3*s+c]: radiance at the samples that was solved for */
    const double *arrived;      /* arrived[3*s+c]: irradiance from lights and sky; NULL: none */
    const lights *lights;       /* that it came from, unless it is NULL: then all of it is believed */
    int sun_directions;         /* over the disc of a directional light */
    const double *trust;        /* trust[s]: weight of sample s, m2 */
    const uint32_t *node;       /* node[ELEMENT_PLACES*e+i]: the colour node of place i of element e */
    const double *colors;       /* colors[3*node+c]: radiance, or what a texture that stays multiplies to radiance */
    const material *untextured; /* untextured[e]: what element e is without that texture; NULL: no texture stays */
    const uint8_t *diagonal;    /* of element e: as in vertex_fit_result */
} residual_setup;

typedef struct residual_result {
    double error;  /* estimated relative error [Baum89, eq. 12] */
    double spread; /* the part that varies from place to place */
    double bias;   /* the one-sided part, before it is reflected; signed, positive where too much is shown */
    size_t points; /* that counted: those inside something do not */
} residual_result;

/* NULL on success, else why it failed: message. The same bits for any number of threads. Without points to look at the
 * error is 0. */
const char *residual_measure(const residual_setup *setup, residual_result *out, char *message, size_t message_size);

#endif
