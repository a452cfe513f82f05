/* SPDX-License-Identifier: MIT
 * How is a scene lit anew on the rows of an earlier bake? Rows know of no light, so what a bake keeps of itself is
 * which elements it split, what the rays of each sample hit, and how triangles were merged:
 *
 *   - of the first bake, read from what it kept: another geometry, or options that make other rows, are refused;
 *   - by the lights that there are now: direct light, emitters, the sky along rays that escape, all bounces, noise, the
 *     fit, the estimate, and whether triangles may be merged as they were (decimate_record).
 *
 * Elements are fine where the first lights needed it, and rays go where they were bright: by others the estimate says
 * what that costs. By the same lights the result is the same, byte for byte.
 */
#ifndef HEMIBAKE_CORE_BAKE_RELIGHT_STAGE_H
#define HEMIBAKE_CORE_BAKE_RELIGHT_STAGE_H

#include "bake/stage_setup.h"

enum { RELIGHT_MESSAGE_SIZE = 240 };

/* What its rows hit is a matter of this geometry alone. */
uint64_t relight_digest(const scene *s, const mesh *m);

/* Before a scene is made of its meshes: opens what the store points to, and where store->read is begins to read, and
 * sets s->shining, by which elements are those of the bake that kept its rows. NULL, or why it failed. */
const char *relight_stage_begin(rows_store *store, arena *memory, size_t mesh_count, scene *s,
                                char message[RELIGHT_MESSAGE_SIZE]);

/* In the place of rows_stage_solve and of adapting, where setup->rows.read is. NULL, or why it failed. */
const char *relight_stage_solve(const bake_setup *setup, direct_light *direct, bool (*go_on)(void *user), void *user,
                                progressive_result *out, char *message, size_t message_size);

/* Once elements are what they will be: rows are cast that are kept, all light settles on them, each group of it where
 * there are any, and they are written where that is asked for. NULL, or why it failed. */
const char *relight_stage_settle(const bake_setup *setup, watcher watch, struct bake_result *out, char *message,
                                 size_t message_size);

/* Once triangles are merged: writes how, after the rows. NULL, or why it failed. */
const char *relight_stage_end(const bake_setup *setup);

#endif
