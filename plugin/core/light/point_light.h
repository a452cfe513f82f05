/* SPDX-License-Identifier: MIT
 * How much light do punctual lights give one point? As direct_light.h says for samples, but with what stands between
 * asked of surfaces, not of pictures: dearer a point, and exact.
 */
#ifndef HEMIBAKE_CORE_LIGHT_POINT_LIGHT_H
#define HEMIBAKE_CORE_LIGHT_POINT_LIGHT_H

#include "light/punctual.h"
#include "mesh/mesh.h"
#include "visibility/panes.h"
#include "visibility/surface_bvh.h"

typedef struct point_lights {
    const scene *scene;
    const mesh *mesh;
    surface_bvh *opaque;
    const punctual *lights;
    size_t count;
    int sun_directions; /* over the disc of a directional light */
} point_lights;

/* A point of a patch, and its smooth normal. */
typedef struct lit_point {
    uint32_t patch;
    const double *at, *normal;
    double width; /* m, of the square about it that it stands for; 0: it is a point */
} lit_point;

/* Irradiance, W/m2. scratch: for panes. False when out of memory. */
bool point_lights_irradiance(const point_lights *l, const lit_point *p, pane_crossings *scratch, double E[3]);

/* How many paths that takes a point. */
size_t point_lights_paths(const point_lights *l);

#endif
