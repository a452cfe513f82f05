/* SPDX-License-Identifier: MIT
 * What would probes say of a bake? Points on it, uniform by area as those of a .hprb file, so that one bake can be
 * compared with another as with truth.
 */
#ifndef HEMIBAKE_CLI_BAKE_PROBES_H
#define HEMIBAKE_CLI_BAKE_PROBES_H

#include "match.h"

/* The same for the same meshes. False when out of memory. */
bool bake_probes_make(const match_mesh *meshes, size_t count, probe_set *out);

#endif
