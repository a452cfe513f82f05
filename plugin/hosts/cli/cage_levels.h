/* SPDX-License-Identifier: MIT
 * How often is a cage refined whose asset leaves that to the host? By the size of elements.
 */
#ifndef HEMIBAKE_CLI_CAGE_LEVELS_H
#define HEMIBAKE_CLI_CAGE_LEVELS_H

#include "gltf_asset.h"
#include "options.h"

/* levels[i], of mesh i of the asset; 0 where its level is not left to the host. From malloc; NULL: out of memory. */
uint32_t *cage_levels_make(const gltf_asset *asset, const options *o);

#endif
