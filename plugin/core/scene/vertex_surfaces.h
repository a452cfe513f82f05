/* SPDX-License-Identifier: MIT
 * Which surfaces meet at a corner? Found by position, since surfaces of different meshes have vertices of their own.
 */
#ifndef HEMIBAKE_CORE_SCENE_VERTEX_SURFACES_H
#define HEMIBAKE_CORE_SCENE_VERTEX_SURFACES_H

#include "scene/scene.h"

typedef struct vertex_surfaces {
    uint32_t *at;      /* at[4*surface+k]: the place of corner k; NO_INDEX in a triangle */
    uint32_t *first;   /* surfaces of place p: surface[first[p]] to surface[first[p+1]-1] */
    uint32_t *surface; /* of two twins the one that stands for both (surface_sheet) */
} vertex_surfaces;

/* At a place where more meet, as in the middle of a disc of thin triangles, only these are looked at. */
enum { CORNERS_LOOKED_AT = 64 };

/* False when out of memory. */
bool vertex_surfaces_create(const scene *s, vertex_surfaces *out);
void vertex_surfaces_free(vertex_surfaces *c);

#endif
