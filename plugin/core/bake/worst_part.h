/* SPDX-License-Identifier: MIT
 * Which part of the scene is worst by itself? What a bake is off by is a share of all light, and most of it may be
 * elsewhere: who stands in a dim room beside a bright one, or sits in a car on a sunny place, sees what the room or the
 * car is off by of its own light.
 */
#ifndef HEMIBAKE_CORE_BAKE_WORST_PART_H
#define HEMIBAKE_CORE_BAKE_WORST_PART_H

#include "mesh/mesh.h"

typedef struct part_error {
    uint32_t mesh; /* of the input */
    double error;  /* of its own light, relative rms; 0: nothing is known */
    double light;  /* rms of that, as a share of the whole's */
    double area;   /* as a share of all */
} part_error;

/* squares[e], levels[e]: of what element e is off by, and of its radiance, integrated. False when out of memory. */
bool worst_part_find(const scene *s, const mesh *m, const double *squares, const double *levels, part_error *out);

#endif
