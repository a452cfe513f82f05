/* SPDX-License-Identifier: MIT
 * Which surface is seen through a pixel? The surfaces of a scene as item geometry, one sheet for the two sides of a
 * double-sided one.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_SURFACE_ITEMS_H
#define HEMIBAKE_CORE_VISIBILITY_SURFACE_ITEMS_H

#include "base/arena.h"
#include "scene/scene.h"
#include "visibility/item_buffer.h"

/* Allocates from memory; false when out of it. (*surface_of)[t]: of triangle t. */
bool surface_items_create(const scene *s, arena *memory, item_geometry *out, uint32_t **surface_of);

#endif
