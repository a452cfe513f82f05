/* SPDX-License-Identifier: MIT
 * Which surfaces does light not pass, and where does a path of it begin on them? (private to shut_in.c, shut_lamps.c)
 */
#ifndef HEMIBAKE_CLI_SHUT_WORLD_H
#define HEMIBAKE_CLI_SHUT_WORLD_H

#include "lights_from.h"

#include "geometry/light_walk.h"

typedef struct shut_world {
    const lights_from *from;
    const hemi_mesh_view *views;
    uint32_t mesh_count;
    size_t *first; /* first[mesh]: of its triangles in the tree, which has those that light does not pass */
    triangle_bvh tree;
    bool *own;         /* own[triangle]: of mesh own_mesh */
    uint32_t own_mesh; /* UINT32_MAX: of none */
    double narrow, dark;
} shut_world;

/* The first fields but the tree and what is with it are the caller's. False: out of memory; it is to be freed then too.
 */
bool shut_world_build(shut_world *w);
void shut_world_free(shut_world *w);

/* A mesh with the triangles that the bake has made of it, or of what was left as it is. */
void shut_world_shape(const shut_world *w, uint32_t mesh, hemi_mesh_desc *out);

/* In the world, counter-clockwise seen from the front. */
void shut_world_corners(const hemi_mesh_desc *mesh, size_t triangle, double out[3][3]);

/* The mesh of a triangle of the tree. */
uint32_t shut_world_mesh(const shut_world *w, size_t triangle);
const char *shut_world_name(const shut_world *w, uint32_t mesh);

/* Place i of a triangle of a mesh, off its front, and a way from there. False: it is in contact with another mesh. */
bool shut_world_leave(shut_world *w, uint32_t mesh, const double corner[3][3], size_t i, double from[3],
                      double direction[3]);

static inline bool shut_world_any(const double rgb[3]) {
    return rgb[0] > 0.0 || rgb[1] > 0.0 || rgb[2] > 0.0;
}

#endif
