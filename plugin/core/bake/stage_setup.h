/* SPDX-License-Identifier: MIT
 * What does each stage of a bake get to work with? The options and the scene of the bake, in the words of the stage.
 */
#ifndef HEMIBAKE_CORE_BAKE_STAGE_SETUP_H
#define HEMIBAKE_CORE_BAKE_STAGE_SETUP_H

#include "bake/bake.h"

/* What a bake needs to shoot; weights are its own. */
typedef struct shooting {
    column_setup columns;
    double *weights, *weights_light;
    double time_limit_s; /* from the start of the bake; 0: none */
} shooting;

/* False when out of memory. */
bool shooting_open(const bake_setup *setup, shooting *out);
void shooting_free(shooting *s);

/* progress: as in progressive_setup. NULL on success, else why it failed. */
const char *shooting_solve(const bake_setup *setup, const shooting *s, const direct_light *direct,
                           bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction),
                           void *user, progressive_result *out, char *message, size_t message_size);

/* progress may be NULL. */
direct_light_setup direct_light_setup_of(const bake_setup *setup, bool (*progress)(void *user, double fraction),
                                         void *user);

/* watch is the caller's. */
adapt_setup adapt_setup_of(const bake_setup *setup);

vertex_colors_setup vertex_colors_setup_of(const bake_setup *setup, const direct_light *direct,
                                           const progressive_result *solution);

#endif
