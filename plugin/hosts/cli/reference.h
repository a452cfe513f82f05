/* SPDX-License-Identifier: MIT
 * How far is a bake from path-traced truth? [Baum89, eq. 12, 13] over probes, for the whole and for each node.
 */
#ifndef HEMIBAKE_CLI_REFERENCE_H
#define HEMIBAKE_CLI_REFERENCE_H

#include "baked_colors.h"
#include "match.h"

/* Probes that are there and in order, before any work is done. EXIT_DONE or an exit status with its line printed. */
int reference_read(const char *path, const char *root, console *c, probe_set *out);

/* Relative errors against truth. */
typedef struct reference_error {
    double whole;                /* [Baum89, eq. 12]; negative: there is no reference */
    double median, percentile95; /* of a probe: converters/probes/match.h */
} reference_error;

/* A solution that has just been made, against probes that were read from path. */
int reference_compare_views(const char *path, const probe_set *probes, const gltf_asset *asset, const baked_colors *b,
                            console *c, reference_error *error);

/* Probes that were read from path, against meshes. */
int reference_match(const char *path, const probe_set *set, const match_mesh *meshes, size_t count, console *c,
                    match_result *out);

#endif
