/* SPDX-License-Identifier: MIT
 * Which surfaces pass through others? For the report: what is inside something else is dark, which may not be meant.
 */
#ifndef HEMIBAKE_CORE_SCENE_INTERSECTIONS_H
#define HEMIBAKE_CORE_SCENE_INTERSECTIONS_H

#include "scene/scene.h"

/* How many sheets of the scene an edge of another passes through, by more than TOLERANCE_OVERLAP of the radius. Sheets
 * that only touch or share edges do not count. In a scene that asks for very many comparisons, those found so far.
 * False when out of memory. */
bool intersections_count(const scene *s, uint32_t *count);

#endif
