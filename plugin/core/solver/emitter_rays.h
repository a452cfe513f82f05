/* SPDX-License-Identifier: MIT
 * What does a ray to an emitter say of the light that comes from it? (private to row_emitters.c)
 */
#ifndef HEMIBAKE_CORE_SOLVER_EMITTER_RAYS_H
#define HEMIBAKE_CORE_SOLVER_EMITTER_RAYS_H

#include "geometry/spherical_polygon.h"
#include "light/punctual.h"
#include "mesh/mesh.h"
#include "solver/emitter_tree.h"
#include "visibility/panes.h"
#include "visibility/rays.h"

#include <stdatomic.h>

typedef struct emitter_rays {
    const scene *scene;
    const mesh *mesh; /* whose patches emit */
    const mesh *hit;  /* whose elements rays hit; patches have the same numbers */
    const rays *rays;
    const punctual *lights; /* NULL: patches emit */
    atomic_bool *failed;    /* out of memory */
} emitter_rays;

/* A sample, and which way it looks. */
typedef struct receiver {
    double from[3];
    const double *normal, *front;
    double plane; /* of its horizon, whose normal is front: its surface, or that which shading normals tell of */
    double width; /* m, across what it stands for */
    uint64_t seed;
    uint32_t first; /* of its points in the net of its element */
    uint32_t sheet; /* of its surface */
    pane_crossings *crossings;
} receiver;

/* How rays are spread over an emitter: evenly over the solid angle that it fills, since from close by nearly all of its
 * light comes from the little that is near; evenly over its area where it is far or hardly seen. */
typedef struct emitter_aim {
    const tree_emitter *one;
    spherical_polygon seen;
    bool by_angle;
    double factor; /* form factor of what is seen of it: by angle, times the cosine of each ray */
} emitter_aim;

/* Not where the whole of it is behind either of them. */
bool emitter_may_light(const tree_emitter *one, const receiver *r);

/* The form factor from a receiver to an emitter if nothing stands between: the closed form, or that of a point. */
double emitter_factor(const emitter_rays *g, const tree_emitter *one, const receiver *r);

emitter_aim emitter_aim_at(const emitter_rays *g, const tree_emitter *one, const receiver *r);

/* The share of the light from the point of an emitter for one of the square that comes to a receiver, T[c]. *weight:
 * what it counts beside others of the same aim. */
void emitter_ray_sees(const emitter_rays *g, const emitter_aim *a, const receiver *r, const double square[2],
                      double *weight, double T[3]);

/* What one ray says of the form factor of an emitter, F[c]. */
void emitter_ray_factor(const emitter_rays *g, const emitter_aim *a, const receiver *r, const double square[2],
                        double F[3]);

/* Irradiance that one of the lights gives to a receiver, E[c]. */
void light_ray_irradiance(const emitter_rays *g, const tree_emitter *one, const receiver *r, double E[3]);

#endif
