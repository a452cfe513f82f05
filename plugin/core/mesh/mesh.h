/* SPDX-License-Identifier: MIT
 * What is solved for? Patches shoot, elements receive, and each element is sampled at a few points.
 *
 * Patches are planar convex pieces of surfaces, elements planar convex pieces of patches. Patches much smaller than is
 * asked for shoot together, as one cluster (mesh/cluster.h); each of them receives on its own. Elements of a patch, and
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
#include "base/jobs.h"
#include "geometry/polygon.h"
#include "scene/scene.h"

typedef struct patch {
    double center[3]; /* centroid: on the surface, since a patch is planar */
    double area, diameter;
    double coverage; /* share of its outline that is no hole: 1, or less where the surface is cut out */
    uint32_t surface;
    uint32_t corner[4]; /* into mesh.vertices; [3] is NO_INDEX in a triangle */
    uint32_t first_element, element_count;
    uint32_t first_sample, sample_count;
    bool is_smooth;    /* its samples look another way than its surface: mesh.shading */
    material material; /* its surface's, or the mean of its elements' */
    uint8_t contact;   /* contact_kind: what is in another surface or under one reflects nothing that anybody sees */
} patch;

typedef struct element {
    double area;
    uint32_t patch;
    uint32_t corner[4];
    uint32_t middle[4]; /* of the edge from corner k: the vertex that hangs there, where bit k of hanging is set */
    uint32_t first_sample;
    uint8_t hanging;
    bool is_foot;             /* no light gets to it: CONTACT_FOOT, also where the rest of its patch is open */
    const material *material; /* its surface's, or as textures make it */
} element;

enum { CLUSTER_CORNERS_MAX = 12 };

/* Patches side by side that shoot as one. Its outline need not lie in a plane. */
typedef struct cluster {
    const uint32_t *members; /* patches, ascending; the first one leads: it is the shooter */
    uint32_t member_count;
    int corner_count;
    double corner[CLUSTER_CORNERS_MAX][3]; /* of the outline, counter-clockwise seen from the front */
    double area, diameter;                 /* m2 of the members; m */
    double eye[3];                         /* on the member in the middle */
    double normal[3];                      /* unit, mean of the members */
    double spread;                         /* sine of the largest angle between that and a member's */
    double share; /* what the outline's vector area is multiplied with to be that of the members */
} cluster;

typedef struct clustering {
    cluster *clusters;
    size_t count;
    uint32_t *members;
    uint32_t *of_patch;   /* of_patch[p]: into clusters, NO_INDEX: it shoots alone */
    uint32_t *of_surface; /* the same of surfaces, which were one patch each */
} clustering;

typedef struct mesh {
    allocator *memory;      /* for what is worked out from it; NULL: the C library */
    const double *vertices; /* vertices[3*v+k], world, m */
    size_t vertex_count;
    const uint32_t *nodes; /* the colour node of vertex v: what vertices share that have one colour */
    size_t node_count;
    const float *normals; /* normals[3*v+k]: mesh_vertices.normals; NULL: every sample looks as its surface does */
    patch *patches;
    size_t patch_count;
    element *elements;
    size_t element_count;
    double *x, *y, *z;   /* of the samples */
    double *sample_area; /* what each stands for, m2 */
    double *shading;     /* shading[3*s+k]: which way sample s looks, unit; NULL: as its surface (shading_normals.h) */
    size_t sample_count;
    clustering *clustering; /* NULL: every patch shoots alone; else solving may dissolve some */
} mesh;

static inline int element_corner_count(const element *e) {
    return e->corner[3] == NO_INDEX ? 3 : 4;
}

/* The sum of the bands of what it emits. */
static inline double element_emission(const element *e) {
    return e->material->M[0] + e->material->M[1] + e->material->M[2];
}

static inline const patch *mesh_patch_of(const mesh *m, uint32_t element_index) {
    return &m->patches[m->elements[element_index].patch];
}

/* The cluster that a patch shoots with, or NULL. */
static inline const cluster *mesh_cluster(const mesh *m, uint32_t patch_index) {
    uint32_t of = m->clustering ? m->clustering->of_patch[patch_index] : NO_INDEX;
    return of == NO_INDEX ? NULL : &m->clustering->clusters[of];
}

/* The patch by whose number the shooter of a patch goes: itself, unless it is in a cluster. */
static inline uint32_t mesh_lead(const mesh *m, uint32_t patch_index) {
    const cluster *c = mesh_cluster(m, patch_index);
    return c ? c->members[0] : patch_index;
}

/* The patches that shoot as one with a lead: members[0 .. count). */
static inline const uint32_t *mesh_members(const mesh *m, const uint32_t *lead, uint32_t *count) {
    const cluster *c = mesh_cluster(m, *lead);
    *count = c ? c->member_count : 1;
    return c ? c->members : lead;
}

/* From now on the members of a cluster shoot alone. */
void mesh_dissolve(const mesh *m, uint32_t lead);

/* Of one patch, at most. */
size_t mesh_most_samples(const mesh *m);

/* Which way a sample on a surface looks: what it receives is weighted by the cosine to this. */
static inline const double *mesh_sample_normal(const mesh *m, const surface *f, size_t sample) {
    return m->shading ? m->shading + 3 * sample : f->normal;
}

/* The outline of a patch or an element. */
polygon mesh_polygon(const mesh *m, const uint32_t corner[4]);

/* Does any patch emit? */
bool mesh_emits(const mesh *m);

/* amount[e] is of element e: how much there is to an area, of it and of a few on either side of it in the mesh, which
 * are near it mostly. What one element says of its noise is little. */
double mesh_mean_around(const mesh *m, const double *amount, size_t e);

/* How many shooters there are, how many of them are clusters, and of how many patches those are. */
size_t mesh_shooter_count(const mesh *m);
size_t mesh_count_clusters(const mesh *m, size_t *patches);

/* Reference coordinates (triangulation.h) of sample k of an element. */
void element_sample_place(int corner_count, int k, double place[2]);

/* Barycentric weights of sample k over the corners of its element; weights[3] is 0 in a triangle. */
void element_sample_weights(int corner_count, int k, double weights[4]);

/* A place of what sample k of an element stands for, a quarter of a quad or what is nearest to a corner of a triangle,
 * for a point of the unit square; even points lie evenly. */
void mesh_sample_part(const mesh *m, const element *e, int k, const double square[2], double out[3]);

/* Fills areas, centres, sample ranges and samples from patches and elements whose surfaces, corners and element
 * ranges are set. False when out of memory. */
bool mesh_measure(mesh *m, arena *memory);

/* The same, without what textures cut out: what is in holes neither receives nor shoots. jobs NULL: the caller does all
 * of it. */
bool mesh_measure_in_scene(mesh *m, const scene *s, jobs *j, arena *memory);

/* Gives every patch and element the material of its surface. */
void mesh_set_materials(mesh *m, const scene *s);

/* Gives every patch the mean of its elements by area. */
void mesh_average_materials(mesh *m);

/* Replaces the patches of a mesh, a block, where their elements emit unevenly, and measures it again. False when out of
 * memory; *any: was any split? */
bool uneven_emitters_split(mesh *m, const scene *s, arena *memory, bool *any);

#endif
