/* SPDX-License-Identifier: MIT
 * What shoots through one hemi-cube? A patch, one of the quarters of quarters that it is subdivided to, or a cluster of
 * patches. Of a shooter (solver/shooters.h) that is subdivided, each subpatch has a hemi-cube of its own.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_SUBPATCH_H
#define HEMIBAKE_CORE_FORMFACTOR_SUBPATCH_H

#include "geometry/polygon.h"
#include "mesh/mesh.h"

typedef struct subpatch {
    polygon shape;
    double center[3];            /* on the surface: of the shape, of the member in the middle of a cluster */
    double vector_area[3], edge; /* of the shape, m2; of a square as large, m: see near_distance.h */
    double normal[3], plane;     /* unit, to the front; normal . x of what is lowest */
    double area, diameter;       /* m2: what its power is taken over; m */
    double coverage;             /* share of it that is no hole; of a cluster, see cluster.share */
    uint64_t path;               /* 0 the whole; quarter q of path p is 4 p + q + 1 */
    uint32_t patch;              /* or the one that leads the cluster */
    bool emits;                  /* a cluster does not: it is one of very many, and no shadow is its own */
    const cluster *cluster;      /* NULL: a single patch */
} subpatch;

/* The patch, or the cluster that it leads. */
subpatch subpatch_of_patch(const scene *s, const mesh *m, uint32_t patch_index);
subpatch subpatch_of_single_patch(const scene *s, const mesh *m, uint32_t patch_index);

/* Each takes a quarter of the area. */
void subpatch_quarter(const subpatch *whole, subpatch quarter[4]);

/* The one of a path, among the quarters of quarters of another. */
subpatch subpatch_of_path(const subpatch *whole, uint64_t path);

/* How often the patch was quartered to get there. */
static inline int subpatch_path_depth(uint64_t path) {
    int depth = 0;
    for (; path > 0; path = (path - 1) / 4) depth++;
    return depth;
}

#endif
