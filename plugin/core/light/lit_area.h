/* SPDX-License-Identifier: MIT
 * How much of a scene's area can light reach? What is shut away from every light, the other side of a wall in a scene
 * without sky, the inside of a cupboard, walls between rooms, shows nothing; so it has no say in how fine the rest is.
 *
 * Places are spread over all fronts by area. Two are connected if they see each other; each asks those beside whatever
 * its rays meet. Whatever is connected with light, over as many others as it takes, can be lit.
 */
#ifndef HEMIBAKE_CORE_LIGHT_LIT_AREA_H
#define HEMIBAKE_CORE_LIGHT_LIT_AREA_H

#include "geometry/triangle_bvh.h"
#include "light/lights.h"

typedef struct lit_mesh {
    bool double_sided, emits, passes; /* passes: light goes through, at least somewhere */
} lit_mesh;

typedef struct lit_area_setup {
    allocator *memory;
    triangle_bvh triangles;
    uint32_t *mesh_of; /* of each triangle */
    const lit_mesh *meshes;
    const lights *lights; /* not opened yet */
} lit_area_setup;

/* m2, of both sides once; the same on every run. Negative: out of memory. */
double lit_area(const lit_area_setup *setup);

#endif
