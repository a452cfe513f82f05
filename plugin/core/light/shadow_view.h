/* SPDX-License-Identifier: MIT
 * Is a point lit from here? A square item buffer, drawn from a light or from infinitely far along a direction, and two
 * of edges only. The four pixels around a point, and nine of the edges each, name what may block it, and with each
 * surface those it shares a corner with. All are tested exactly, in double, so the edge of a shadow is not the edge of
 * a pixel. Surfaces of less than a few pixels are decided by depth as well.
 *
 * Without the edges a wall that is seen edge-on covers no pixel's centre, and light leaks along its foot: up to 0.5 %
 * of a sky into a closed room, measured. Without the neighbours a sixth of the sun came into a closed sphere where its
 * facets are a pixel wide, since a pixel has the id of only one of them.
 */
#ifndef HEMIBAKE_CORE_LIGHT_SHADOW_VIEW_H
#define HEMIBAKE_CORE_LIGHT_SHADOW_VIEW_H

#include "scene/vertex_surfaces.h"
#include "visibility/item_buffer.h"

enum { SHADOW_VIEW_FACES = 6 /* around a point: +x -x +y -y +z -z */, SHADOW_VIEW_BUFFERS = 3 };

typedef struct shadow_view {
    bool parallel;
    double eye[3]; /* of a parallel view: in front of the whole scene */
    double right[3], up[3], forward[3];
    double half;    /* half the width: m, or a tangent */
    double depth;   /* of a parallel view, m */
    int resolution; /* pixels across */
    int face;       /* of the cube around a point */
    uint32_t *ids;  /* ids[row*resolution+column], then as many of each kind of edges; 3 resolution^2 of the caller's */
} shadow_view;

/* Sets up a view along one face of the cube around a point, or the view of the whole scene against a unit direction.
 * resolution and ids have been set. */
void shadow_view_around(shadow_view *v, const double eye[3], int face);
void shadow_view_against(shadow_view *v, const scene *s, const double toward[3]);

bool shadow_view_draw(shadow_view *v, item_buffer *items, const double center[3]);

/* Is the point within the view? Of the faces around a point it is within exactly one. */
bool shadow_view_holds(const shadow_view *v, const double point[3]);

/* What may block. triangle_surface: of the item geometry, naming sheets (surface_sheet). */
typedef struct shadow_blockers {
    const scene *scene;
    const uint32_t *triangle_surface;
    vertex_surfaces beside; /* the surfaces that share a vertex */
    double *planes; /* planes[4*surface]: unit normal, and normal . x on it; close together, since most are only asked
                       on which side two points are */
} shadow_blockers;

bool shadow_blockers_create(const scene *s, const uint32_t *triangle_surface,
                            shadow_blockers *out); /* as vertex_surfaces_create */
void shadow_blockers_free(shadow_blockers *b);

/* Which surfaces have been tested for a point? Scratch memory of one thread: a surface beside several that are seen is
 * tested once. */
typedef struct shadow_tested {
    uint32_t *last; /* last[surface]: the point it was tested for; from block_new */
    uint32_t point; /* counts from 1 */
    size_t surface_count;
} shadow_tested;

bool shadow_tested_create(allocator *memory, size_t surface_count, shadow_tested *out); /* false when out of memory */
void shadow_tested_free(shadow_tested *t);

/* Does light along the view reach a point of a surface whose front is turned to it? */
bool shadow_view_reaches(const shadow_view *v, const shadow_blockers *blockers, shadow_tested *tested,
                         uint32_t surface_index, const double point[3]);

#endif
