/* SPDX-License-Identifier: MIT
 * What does Embree need to answer for a traced_scene? The one place that includes it; traced_scene.h says what is
 * asked.
 */
#ifndef HEMIBAKE_ORACLE_TRACED_RAYS_H
#define HEMIBAKE_ORACLE_TRACED_RAYS_H

#include "traced_scene.h"

/* False: out of memory, or Embree's word on the scene. */
bool traced_rays_create(traced_scene *s);
void traced_rays_destroy(traced_scene *s);

#endif
