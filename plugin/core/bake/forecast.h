/* SPDX-License-Identifier: MIT
 * What will a bake cost, of a scene that is cut to patches and elements already?
 */
#ifndef HEMIBAKE_CORE_BAKE_FORECAST_H
#define HEMIBAKE_CORE_BAKE_FORECAST_H

#include "bake/quality.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

typedef struct forecast {
    double elements, samples; /* that are solved in the end; what adapting adds is not known before there is light */
    double processor_s;       /* of all threads together */
    double memory_bytes;      /* of the process, at its peak */
} forecast;

/* o: resolved; emits: does any surface? Within a factor 2 on the scenes that tests/accuracy/forecast.py lists. */
forecast forecast_make(const bake_options *o, const scene *s, const mesh *m, bool emits);

/* s of a bake of limit_s, after which it ends with what it has: a share of them, or sooner where so much (1: all) of
 * what makes colours of light, and what is written then, takes longer than is left. mesh_s: until it looked for light.
 */
double forecast_end_s(double limit_s, double share, double colors, const scene *s, const mesh *m, double mesh_s);

/* Would cutting the elements of so many triangles, and looking for their faults, leave no time for their light? said:
 * what the user should know of it, one line, where it is so. */
bool forecast_hurries(double limit_s, double triangles, char said[QUALITY_LINE_SIZE]);

#endif
