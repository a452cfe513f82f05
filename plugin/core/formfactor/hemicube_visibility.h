/* SPDX-License-Identifier: MIT
 * Which points does a hemi-cube see, and does anything stand around its eye? Pixels name the surfaces that may be in
 * the way; each is tested exactly.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_VISIBILITY_H
#define HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_VISIBILITY_H

#include "formfactor/hemicube.h"
#include "geometry/polygon.h"

/* Is a point on a surface visible from the eye? The four pixels around its direction name the candidates; each is
 * tested exactly. Surfaces of less than a few pixels are decided by depth; past what has holes all surfaces are asked.
 * triangle_surface names sheets (surface_sheet). */
bool hemicube_sees(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t surface_index,
                   const double point[3]);

/* The piece of surface around the eye. */
typedef struct hemicube_floor {
    const polygon *shape;
    double height;         /* m: what hangs lower than this over it counts; 0: what stands on it */
    const uint32_t *group; /* group[surface] is own: it belongs to the floor; NULL: none does */
    uint32_t own;
} hemicube_floor;

/* Does something stand on the floor, pass through it, or hang low over it? Looks along it, through the lowest pixels of
 * the sides. */
bool hemicube_is_crossed(const hemicube *h, const scene *s, const uint32_t *triangle_surface,
                         const hemicube_floor *floor);

#endif
