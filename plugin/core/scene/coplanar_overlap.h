/* SPDX-License-Identifier: MIT
 * Which triangles lie in each other? Where two lie in one plane and overlap (a picture on a wall without thickness, an
 * object exported twice), the rounding of depth decides pixel by pixel which is seen, and otherwise in the next frame.
 * In layers they can be drawn so that the first is.
 */
#ifndef HEMIBAKE_CORE_SCENE_COPLANAR_OVERLAP_H
#define HEMIBAKE_CORE_SCENE_COPLANAR_OVERLAP_H

#include "base/block.h"

#include <stdint.h>

enum { COPLANAR_OVERLAP_LAYERS_MAX = 256 };

/* layers[t]: 0, or one more than the highest layer of the triangles before t that overlap t in one plane (255 at most).
 * What overlaps by less than a millionth of the scene does not. False when out of memory. */
bool coplanar_overlap_find_layers(allocator *memory, const float *positions, const uint32_t *indices,
                                  size_t triangle_count, uint8_t *layers);

#endif
