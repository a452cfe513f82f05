/* SPDX-License-Identifier: MIT
 * Into which four parts is an element split, in which order, and where does each lie in it? A quad into quads, a
 * triangle into triangles, at the middles of its edges. The two sides of a sheet are divided alike, part by part
 * (visibility/mesh_items.h), though corners of a back run the other way.
 */
#ifndef HEMIBAKE_CORE_MESH_ELEMENT_PARTS_H
#define HEMIBAKE_CORE_MESH_ELEMENT_PARTS_H

#include <stdbool.h>
#include <stdint.h>

enum { ELEMENT_PARTS = 4 };

/* Corner 0 and the edges' length in coordinates of the element, as in a leaf (mesh/refinement.h). */
typedef struct element_part {
    uint32_t corner[4];
    double u, v, size;
} element_part;

/* corner: of the element, [3] is NO_INDEX in a triangle; middle[k]: of the edge from corner k; center: of a quad. */
void element_parts(const uint32_t corner[4], const uint32_t middle[4], uint32_t center, bool is_back,
                   element_part out[ELEMENT_PARTS]);

#endif
