/* SPDX-License-Identifier: MIT
 * What light comes to a point that nobody solved for from lights and sky? From lights what point_light.h finds there;
 * whoever looks around from the point may add what sky it sees. What else arrived at the samples around it is believed,
 * and so is all of it where lights are very many.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_ARRIVED_LIGHT_H
#define HEMIBAKE_CORE_RECONSTRUCT_ARRIVED_LIGHT_H

#include "light/lights.h"
#include "light/point_light.h"

typedef struct arrived_light {
    point_lights lights; /* opaque NULL: they are not asked for */
    const mesh *mesh;
    const scene *scene;
    const double *arrived; /* arrived[3*s+c]: irradiance of samples; NULL: none */
    const lights *sky;     /* that is asked for where it is seen; NULL: what arrived from it is believed */
} arrived_light;

/* lights: what came to samples is from, unless it is NULL. sun_directions: over the disc of a directional light. False
 * when out of memory. */
bool arrived_light_open(const scene *s, const mesh *m, const double *arrived, const lights *from, int sun_directions,
                        arrived_light *out);
void arrived_light_close(arrived_light *a);

/* Adds the radiance of the sky in a direction of any length, weighed, where it is asked for. */
void arrived_light_add_sky(const arrived_light *a, const double direction[3], double weight, double L[3]);

/* Adds irradiance / pi at a point of an element, but for the sky's where that is asked for. scratch: for panes. False
 * when out of memory. */
bool arrived_light_add(const arrived_light *a, const element *e, const double point[3], const double normal[3],
                       pane_crossings *scratch, double E[3]);

#endif
