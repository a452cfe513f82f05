/* SPDX-License-Identifier: MIT
 * How much of the light comes from which lights? Light adds up: each group of lights settles by itself on the same rows
 * (solver/kept_rows.h), and what a bake shows is the sum.
 */
#ifndef HEMIBAKE_CORE_BAKE_LIGHT_GROUPS_H
#define HEMIBAKE_CORE_BAKE_LIGHT_GROUPS_H

#include "reconstruct/vertex_colors.h"

struct bake_setup;
struct bake_result;
struct kept_rows;

/* The group of what emits on each mesh of the scene, of each punctual light, and of the sky: below light_groups. */
typedef struct light_groups_input {
    const uint32_t *of_mesh, *of_light;
    uint32_t of_sky;
} light_groups_input;

/* One group; irradiance[3*s+c] of the samples of the mesh. */
typedef struct light_group {
    double *irradiance;
    vertex_fit_result radiance, incident; /* of the nodes; incident: as vertex_colors.irradiance */
} light_group;

typedef struct light_groups {
    size_t count;
    light_group *all;
} light_groups;

/* Once elements are what they will be: puts the sum of the groups in the place of the solution, and its books with it.
 * NULL, or why it failed, which may be in message. */
const char *light_groups_settle(const struct bake_setup *setup, watcher watch, struct kept_rows *rows,
                                struct bake_result *out, char *message, size_t message_size);

/* Colours of the nodes by each group, which add up to those that are there: what limits of the fit leave over is shared
 * as the groups are. NULL, or why it failed. */
const char *light_groups_fit(const struct bake_setup *setup, const vertex_colors_setup *how,
                             const vertex_colors *colors, const light_groups *g);

void light_groups_free(light_groups *g);

#endif
