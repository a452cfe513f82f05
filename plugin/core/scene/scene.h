/* SPDX-License-Identifier: MIT
 * What blocks, reflects and emits light? Planar convex surfaces and their materials, bake_scene before anything is
 * solved.
 */
#ifndef HEMIBAKE_CORE_SCENE_SCENE_H
#define HEMIBAKE_CORE_SCENE_SCENE_H

#include "base/block.h"
#include "geometry/plane.h"
#include "scene/alpha_mask.h"
#include "scene/surface_grid.h"

#define NO_INDEX UINT32_MAX

typedef struct material {
    double rho[3];                   /* reflectance; where light leaves by the other side too, of both together */
    double M[3];                     /* exitance, W/m2 */
    double transmittance[3];         /* share of light that goes straight through: see visibility/panes.h */
    double diffuse_transmittance[3]; /* share, of rho, that leaves diffusely by the other side */
} material;

/* A triangle or a planar convex quad, counter-clockwise seen from its front. */
typedef struct surface {
    double normal[3];   /* unit, to the front */
    double plane;       /* normal . x on the surface */
    double area;        /* m2 */
    uint32_t corner[4]; /* into scene.vertices; [3] is NO_INDEX in a triangle */
    uint32_t material;
    uint32_t mesh;            /* of the input */
    uint32_t triangle[2];     /* of that mesh: what the surface was; [1] is NO_INDEX unless two were one quad */
    uint32_t twin;            /* the surface back to back with this one (double-sided material), or NO_INDEX */
    const surface_grid *grid; /* what it was, if it was more; triangle is of its first cell then */
    const alpha_mask *holes;  /* that a texture cuts into it; NULL: none */
    bool pane;                /* light passes it: it blocks nothing, and scene.panes knows what it takes */
} surface;

typedef struct scene {
    allocator *memory;      /* for what is worked out from it; NULL: the C library */
    const double *vertices; /* vertices[3*v+k], world, m */
    size_t vertex_count;
    surface *surfaces;
    size_t surface_count;
    surface_grid *grids;        /* of all surfaces, a list */
    const uint32_t *neighbours; /* scene_find_neighbours; NULL: not looked for */
    const material *materials;
    size_t material_count;
    const struct surface_bvh *tree; /* where surfaces have holes; NULL: none has */
    const struct panes *panes;      /* NULL: no surface is a pane */
    const uint8_t *shining;         /* shining[i], of the input's mesh i: a scene_shining; NULL: materials say it */
    double center[3], radius;       /* of the bounding box */
    double things_center[3], things_radius; /* of a ball around all but surroundings */
    bool has_surroundings;                  /* far larger than what is among them: that ball is given */
    bool surroundings_shade;                /* they may be in the way of light, as a flat ground is not */
} scene;

static inline const double *scene_vertex(const scene *s, uint32_t index) {
    return s->vertices + 3 * (size_t)index;
}

static inline int surface_corner_count(const surface *f) {
    return f->corner[3] == NO_INDEX ? 3 : 4;
}

static inline bool material_emits(const material *m) {
    return m->M[0] > 0.0 || m->M[1] > 0.0 || m->M[2] > 0.0;
}

static inline bool material_reflects(const material *m) {
    return m->rho[0] + m->rho[1] + m->rho[2] > 0.0;
}

/* What of a mesh decides on shapes, where rows are kept: of the bake that kept them, so that other lights find its
 * elements. */
typedef enum scene_shining { SHINING_NOT, SHINING_EVENLY, SHINING_BY_PICTURE } scene_shining;

static inline bool scene_emits(const scene *s, const surface *f) {
    return s->shining ? s->shining[f->mesh] != SHINING_NOT : material_emits(&s->materials[f->material]);
}

/* Does a surface reflect less than a hundredth of any light, give none and let none through? It is black then, however
 * finely it is cut. */
static inline bool scene_is_black(const scene *s, const surface *f) {
    const material *m = &s->materials[f->material];
    bool is_dark = true;
    for (int c = 0; c < 3; c++) is_dark = is_dark && m->rho[c] < 0.01 && !(m->transmittance[c] > 0.0);
    return is_dark && !scene_emits(s, f);
}

/* Which of two surfaces in one plane that look the same way is seen? The one that shines: a lamp in the plane of its
 * ceiling. Else the first. */
static inline bool scene_shows_before(const scene *s, uint32_t a, uint32_t b) {
    bool shines = scene_emits(s, &s->surfaces[a]);
    return shines == scene_emits(s, &s->surfaces[b]) ? a < b : shines;
}

/* The one of two twins that stands for both where only the sheet matters, as in item buffers. */
static inline uint32_t surface_sheet(const scene *s, uint32_t index) {
    uint32_t twin = s->surfaces[index].twin;
    return twin < index ? twin : index;
}

/* Sets normal, plane and area from the corners. False if the surface has no area. */
bool surface_measure(surface *f, const double *vertices);

/* place[v] of each vertex (geometry/places.h), a block; NULL when out of memory. */
uint32_t *scene_find_places(const scene *s, uint32_t *place_count);

/* Sets center and radius, and the ball around all unless one is given. */
void scene_measure(scene *s);

/* Signed distance of a point to the plane of a surface; positive in front. Here, because the estimate asks it of every
 * pixel. */
static inline double surface_height(const surface *f, const double point[3]) {
    return plane_height(f->normal, f->plane, point);
}

/* neighbours[4*i+k]: a surface that shares the edge from corner k of surface i to the next, or NO_INDEX; where several
 * do, the next of them in index order, and the first after the last. False when out of memory. */
bool scene_find_neighbours(const scene *s, uint32_t *neighbours);

/* mates[4*i+k]: the edge 4*j+l of surface j on which i goes on past the edge from its corner k: the same edge run the
 * other way, of a surface that faces the same side. NO_INDEX where there is none, or more than one. False when out of
 * memory. */
bool scene_find_mates(const scene *s, uint32_t *mates);

/* How many sheets of the scene an edge of another passes through, by more than TOLERANCE_OVERLAP of the radius. Sheets
 * that only touch or share edges do not count. In a scene that asks for very many comparisons, those found so far.
 * False when out of memory. */
bool intersections_count(const scene *s, uint32_t *count);

#endif
