/* SPDX-License-Identifier: MIT
 * Which lights shine by a measured profile? EXT_lights_ies at nodes.
 */
#include "gltf_model.h"

void gltf_add_profile(gltf_asset &, int, const double *) {}
