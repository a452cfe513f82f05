/* SPDX-License-Identifier: MIT
 * What does the report say? The keys are a contract: added to, never renamed.
 */
#ifndef HEMIBAKE_CLI_REPORT_H
#define HEMIBAKE_CLI_REPORT_H

#include "asset_colors.h"
#include "baked_colors.h"
#include "reference.h"
#include "usd_files.h"

typedef struct report_facts {
    const options *o;
    const gltf_asset *asset;
    const hemi_solution *solution;
    const hemi_statistics *statistics;
    const baked_colors *colors;
    const asset_colors *spaces;
    const gltf_output *written;
    double read_s, color_s, write_s, picture_s, total_s;
    reference_error error_reference;
    bool is_interrupted;
    const usd_files *usd;
    const char *input_digest; /* "": unknown */
    const console *console;   /* what was noted */
} report_facts;

/* What asset.extras.hemibake says: version, options, mesh copies, and the digest of the report's part that is the same
 * whenever and wherever the same bake is made. The facts need no `written` yet. JSON text from malloc, or NULL. */
char *report_stamp(const report_facts *facts);

/* JSON text from malloc; NULL when out of memory. */
char *report_make(const report_facts *facts);

/* Nothing shows any light but what emits: there is nothing whose error could be estimated. */
bool report_is_unlit(const report_facts *facts);

/* Is it known which node is worst by itself? Then which: "", it has no name. */
bool report_knows_worst(const report_facts *facts);
const char *report_worst_node(const report_facts *facts);

#endif
