/* SPDX-License-Identifier: MIT
 * Where is what is bright, as seen from here? What lights a room may be small as seen from most of it: a window, the
 * sill under it, a table under a lamp. The initial rays of samples near each other find such places now and then, all
 * of them together often enough; they guide the rays to come, as in path guiding. Elements are taken together in groups
 * of neighbours. Of the rays of a group that hit what is much brighter than the mean, a few dozen are resampled by how
 * much light they carry, and where each ends is a target: a small ball, which is a cone as seen from a sample, a lobe
 * of the density that guided rays are drawn from. A ray that ended in the sky has its target where it passed nearest to
 * a surface, the frame of a window as a rule, so that samples elsewhere are guided to the opening and not beside it.
 * Groups that found too little take the targets of those around (row_borrowing.c), and look there.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_GUIDING_H
#define HEMIBAKE_CORE_SOLVER_ROW_GUIDING_H

#include "base/jobs.h"
#include "light/sky_glow.h"
#include "mesh/mesh.h"
#include "visibility/rays.h"

struct row_rays;
struct row_sharing;

/* Lobes of a group, and those that it shares with the groups of the larger one that it is in. */
enum { ROW_LOBES_OWN = 40, ROW_LOBES_SHARED = 24, ROW_LOBES_MAX = ROW_LOBES_OWN + ROW_LOBES_SHARED };

/* Groups that share what all of them found. */
enum { ROW_GROUPS_SHARING = 8 };

/* A ball, or where radius is negative a cone of directions, whose radius at distance 1 is -radius, or where it is 0 the
 * glow of a panorama (sky_glow.h), seen that way. */
typedef struct row_target {
    double at[3], radius;
} row_target;

typedef struct row_group {
    uint32_t target_count, own_count; /* own_count: of those, the first, that it found itself */
    row_target targets[ROW_LOBES_MAX];
    double mean, variance; /* of the luminance that rays hit: the mean, and the mean square off a sample's own mean */
} row_group;

/* The same of the samples of one element. */
typedef struct row_seen {
    float mean, variance;
} row_seen;

typedef struct row_guiding {
    const sky_glow *glow; /* NULL: there is none */
    uint32_t *of_element; /* the group of each element */
    uint32_t *order;      /* the elements of group g: order[g*size] to order[(g+1)*size-1] */
    size_t element_count, group_count;
    row_group *groups;
    row_seen *seen; /* seen[e] */
} row_guiding;

/* What a group's targets are as seen from one sample: cones of even density, all of equal share, and as many as are
 * the glow of a panorama. Behind the last there are cones without directions up to a multiple of eight. */
typedef struct row_lobes {
    int count, glow_count;
    const sky_glow *glow;
    float x[ROW_LOBES_MAX], y[ROW_LOBES_MAX], z[ROW_LOBES_MAX];
    float cosine[ROW_LOBES_MAX]; /* of each cone's half angle ... */
    float pdf[ROW_LOBES_MAX];    /* ... and one over its solid angle and the number of cones */
} row_lobes;

/* luminance[e]: of what element e reflects; from: what the rays that there are were guided by, NULL: none was.
 * False when out of memory, or others who share the rows are lost. */
bool row_guiding_create(const struct row_rays *r, const row_guiding *from, jobs *j, const double *luminance,
                        row_guiding *out);
void row_guiding_free(row_guiding *a);

/* Shares rows so that groups that know of each other are in one place. r: NULL, or the others. False when out of
 * memory.
 */
bool row_guiding_share(const struct row_rays *of, ranks *r, struct row_sharing *out);

static inline const row_group *row_guiding_group(const row_guiding *a, size_t element_index) {
    return &a->groups[a->of_element[element_index]];
}

/* Groups that share, and found few targets, take those of others around: what they are to look at. False when out of
 * memory. */
bool row_guiding_borrow(row_guiding *a, allocator *memory);
void row_group_set_radii(row_group *g);

void row_guiding_lobes(const row_guiding *a, uint32_t element_index, const double from[3], const double normal[3],
                       row_lobes *out);

static inline bool row_lobes_any(const row_lobes *a) {
    return a->count + a->glow_count > 0;
}

/* A direction for a point of the square, whose first coordinate picks the cone and is then stretched over it: a third
 * number of the same sequence is tied to the first, however both are scrambled, and would look at each cone along one
 * ring. pdf: the density of such directions, per steradian. */
void row_lobes_direction(const row_lobes *a, const double point[2], double out[3]);
double row_lobes_pdf(const row_lobes *a, const double direction[3]);

#endif
