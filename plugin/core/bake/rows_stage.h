/* SPDX-License-Identifier: MIT
 * How is a scene solved by rows? Rays carry all light: to emitters, whose closed forms say what they give where they
 * are seen, to the sky, and to whatever reflects.
 */
#ifndef HEMIBAKE_CORE_BAKE_ROWS_STAGE_H
#define HEMIBAKE_CORE_BAKE_ROWS_STAGE_H

#include "bake/stage_setup.h"
#include "solver/rows.h"

/* In the place of shooting_solve; direct: from punctual lights alone, and gets what the sky gives. NULL on success,
 * else why it failed. */
const char *rows_stage_solve(const bake_setup *setup, direct_light *direct,
                             bool (*progress)(void *user, const rows_progress *so_far), void *user,
                             progressive_result *out, char *message, size_t message_size);

/* What the solution is off by, relative rms: at samples, because rays are few; and between them, because elements are
 * large (interpolation_error.h), and because rows do not quite add up. */
typedef struct rows_error {
    double noise, interpolation;
} rows_error;

/* A solution in which nothing is ever shot: samples have what arrives from lights. False when out of memory. */
bool rows_stage_begin(const bake_setup *setup, const direct_light *direct, progressive_result *out);

/* Makes what rows found the solution, and its books. */
void rows_stage_take(const bake_setup *setup, rows_result *r, direct_light *direct, progressive_result *out);

/* Once elements are as small as they will be; what groups of lights there are settle first. NULL, or why it failed. */
const char *rows_stage_judge(const bake_setup *setup, watcher watch, bake_result *baked, rows_error *out, char *message,
                             size_t message_size);

/* Does nothing light this scene, solved by rows without a failure? A sky that is there by default has to reach more
 * than a sliver of its surfaces. */
bool rows_stage_is_dark(const bake_setup *setup, const direct_light *direct, const progressive_result *solution);

#endif
