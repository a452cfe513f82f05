/* SPDX-License-Identifier: MIT
 * Where does light come from, and with which density is it looked for there? One light is picked by its power, then a
 * place on it: evenly on an emitting triangle, by brightness on the panorama of a sky, on the disc of a sun. A sky of
 * one radiance is found by the directions that a surface reflects to, and is never picked.
 */
#ifndef HEMIBAKE_ORACLE_TRACED_LIGHTS_H
#define HEMIBAKE_ORACLE_TRACED_LIGHTS_H

#include "traced_scene.h"

typedef struct traced_lights {
    const traced_scene *scene;
    uint32_t *emitters; /* triangles; the punctual lights come after them, and then the sky */
    size_t emitter_count, count;
    double *cumulative; /* cumulative[i]: share of the power of lights 0 to i */
    uint32_t *index;    /* index[triangle]: which emitter it is, or UINT32_MAX */
    double *rows;       /* rows[r]: share of the sky's flux in rows 0 to r of its panorama; NULL: never picked */
    double *columns;    /* columns[r*width+c]: the same within row r */
} traced_lights;

/* What one sample finds. */
typedef struct traced_light_sample {
    double toward[3], distance; /* unit; m, INFINITY for the sky and the sun */
    double radiance[3];         /* or irradiance at a surface that faces it, of a light without size */
    double density;             /* per steradian; of a light without size the share it is picked with */
    bool sizeless;              /* no other direction can find it */
} traced_light_sample;

/* False: out of memory. */
bool traced_lights_create(const traced_scene *s, traced_lights *out);
void traced_lights_destroy(traced_lights *l);

/* False: this one gives the point no light. */
bool traced_lights_sample(const traced_lights *l, const traced_point *at, const double u[2], traced_light_sample *out);

/* The density with which traced_lights_sample looks in the direction in which a ray has met a point, or the sky. */
double traced_lights_density_at(const traced_lights *l, const traced_point *from, const traced_point *met);
double traced_lights_density_of_sky(const traced_lights *l, const double direction[3]);

#endif
