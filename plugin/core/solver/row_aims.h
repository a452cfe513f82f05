/* SPDX-License-Identifier: MIT
 * Where is what is bright, as seen from here? What lights a room may be small as seen from most of it: a window, the
 * sill under it, a table under a lamp. The first rays of samples near each other find such places now and then, all of
 * them together often enough. Elements are taken together in groups of neighbours; of the rays of a group that met what
 * is much brighter than the mean, a few dozen are picked by how much light they carry. Where a picked ray ends is an
 * aim: a small ball that further rays go to. A ray that ended in the sky has its aim where it passed nearest to a
 * surface, the frame of a window as a rule, so that samples elsewhere aim at the opening and not beside it.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_AIMS_H
#define HEMIBAKE_CORE_SOLVER_ROW_AIMS_H

#include "base/jobs.h"
#include "mesh/mesh.h"
#include "visibility/rays.h"

struct row_rays;

/* Those of a group, and those of the larger group that it is in. */
enum { ROW_AIMS_OWN = 40, ROW_AIMS_AROUND = 24, ROW_AIMS_MAX = ROW_AIMS_OWN + ROW_AIMS_AROUND };

/* A ball, or where radius is negative a cone of directions, whose radius at distance 1 is -radius. */
typedef struct row_target {
    double at[3], radius;
} row_target;

typedef struct row_group {
    uint32_t target_count;
    row_target targets[ROW_AIMS_MAX];
    double mean, variance; /* of the luminance that rays met: the mean, and the mean square off a sample's own mean */
} row_group;

typedef struct row_aims {
    uint32_t *of_element; /* the group of each element */
    uint32_t *order;      /* the elements of group g: order[g*size] to order[(g+1)*size-1] */
    size_t element_count, group_count;
    row_group *groups;
    float *variance; /* variance[e]: as in row_group, of the samples of element e */
} row_aims;

/* What a group's targets are as seen from one sample: cones. */
typedef struct row_aim {
    int count;
    float x[ROW_AIMS_MAX], y[ROW_AIMS_MAX], z[ROW_AIMS_MAX];
    float cosine[ROW_AIMS_MAX];  /* of each cone's half angle ... */
    float density[ROW_AIMS_MAX]; /* ... and one over its solid angle and the number of cones */
} row_aim;

/* luminance[e]: of what element e reflects; from: what the rays that there are were aimed at, NULL: none was. False
 * when out of memory. */
bool row_aims_create(const struct row_rays *r, const row_aims *from, jobs *j, const double *luminance, row_aims *out);
void row_aims_free(row_aims *a);

static inline const row_group *row_aims_group(const row_aims *a, size_t element_index) {
    return &a->groups[a->of_element[element_index]];
}

void row_aims_at(const row_aims *a, uint32_t element_index, const double from[3], const double normal[3], row_aim *out);

/* A direction for a number in [0, 1) and a point of the square; density: of such directions, per solid angle. */
void row_aim_direction(const row_aim *a, double which, const double point[2], double out[3]);
double row_aim_density(const row_aim *a, const double direction[3]);

#endif
