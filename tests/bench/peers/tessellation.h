/* SPDX-License-Identifier: MIT
 * What are the vertices of a uniform tessellation? Every triangle is halved across its longest edge until none is
 * longer than asked for; since that depends on the edge alone, neighbours halve it alike and no T-junction is left.
 * Vertices are shared within a mesh where their normals agree, as an exporter shares them.
 */
#ifndef HEMIBAKE_PEERS_TESSELLATION_H
#define HEMIBAKE_PEERS_TESSELLATION_H

#include "traced_scene.h"

/* A corner of a small triangle: where its vertex is seen from, a little inside. */
typedef struct tessellation_corner {
    float weights[3];        /* in the scene's triangle */
    uint32_t triangle, next; /* the vertex's next corner, or UINT32_MAX */
    bool back;
} tessellation_corner;

typedef struct tessellation {
    float *positions;  /* positions[3*v+k], world */
    uint32_t *indices; /* indices[3*t+k]; of corner number 3*t+k */
    tessellation_corner *corners;
    uint32_t *first; /* first[v]: a corner of the vertex */
    size_t vertex_count, triangle_count, vertex_room, triangle_room;
} tessellation;

/* False: out of memory, or more than 2^31 corners. */
bool tessellation_create(const traced_scene *s, double edge, tessellation *out);
void tessellation_destroy(tessellation *t);

void tessellation_point(const traced_scene *s, const tessellation_corner *corner, traced_point *out);

#endif
