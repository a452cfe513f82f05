/* SPDX-License-Identifier: MIT
 * What is solved for? Patches shoot, elements receive, and each element is sampled at a few points.
 *
 * Patches are planar convex pieces of surfaces, elements planar convex pieces of patches. Elements of a patch, and
 * samples of an element, are contiguous: patch p owns elements [first_element, + element_count) and samples
 * [first_sample, + sample_count). A quad has four samples, at the middles of its quarters; a triangle three, at the
 * points of the rule that integrates quadratic polynomials exactly [Strang & Fix 1973].
 *
 *        3 ------- 2            2
 *        |  3   2  |           / \
 *        |         |          / 2 \
 *        |  0   1  |         / 0 1 \
 *        0 ------- 1        0 ----- 1
 */
#ifndef HEMIBAKE_CORE_MESH_MESH_H
#define HEMIBAKE_CORE_MESH_MESH_H

#include "base/arena.h"
#include "scene/scene.h"

typedef struct patch {
    double center[3]; /* centroid: on the surface, since a patch is planar */
    double area, diameter;
    double coverage; /* share of its outline that is no hole: 1, or less where the surface is cut out */
    uint32_t surface;
    uint32_t corner[4]; /* into mesh.vertices; [3] is NO_INDEX in a triangle */
    uint32_t first_element, element_count;
    uint32_t first_sample, sample_count;
    material finish; /* its surface's, or the mean of its elements' */
} patch;

typedef struct element {
    double area;
    uint32_t patch;
    uint32_t corner[4];
    uint32_t mid[4]; /* the vertex that hangs in the middle of the edge from corner k, where bit k of cut is set */
    uint32_t first_sample;
    uint8_t cut;
    const material *finish; /* its surface's, or as textures make it */
} element;

typedef struct mesh {
    allocator *memory;      /* for what is worked out from it; NULL: the C library */
    const double *vertices; /* vertices[3*v+k], world, m */
    size_t vertex_count;
    patch *patches;
    size_t patch_count;
    element *elements;
    size_t element_count;
    double *x, *y, *z;   /* of the samples */
    double *sample_area; /* what each stands for, m2 */
    size_t sample_count;
} mesh;

static inline int patch_corner_count(const patch *p) {
    return p->corner[3] == NO_INDEX ? 3 : 4;
}

static inline int element_corner_count(const element *e) {
    return e->corner[3] == NO_INDEX ? 3 : 4;
}

/* Reference coordinates (triangulation.h) of sample k of an element. */
void element_sample_place(int corner_count, int k, double place[2]);

/* Barycentric weights of sample k over the corners of its element; weights[3] is 0 in a triangle. */
void element_sample_weights(int corner_count, int k, double weights[4]);

/* Fills areas, centres, sample ranges and samples from patches and elements whose surfaces, corners and element
 * ranges are set. False when out of memory. */
bool mesh_finish(mesh *m, arena *memory);

/* Takes what textures cut out off the areas of elements, samples and patches: what is in holes neither receives nor
 * shoots. */
void mesh_cut_holes(mesh *m, const scene *s);

/* Gives every patch and element the material of its surface. */
void mesh_set_finishes(mesh *m, const scene *s);

/* Gives every patch the mean of its elements by area. */
void mesh_average_finishes(mesh *m);

#endif
