/* SPDX-License-Identifier: MIT
 * Which faces, shared vertices, creases and face-varying values does the control cage have?
 */
#ifndef HEMIBAKE_SUBDIVIDE_CAGE_H
#define HEMIBAKE_SUBDIVIDE_CAGE_H

#include "subdivide.h"

#include <hemibake/allocator.h>

HEMI_C_BEGIN

/* A quad is convex if every corner turns by more than this (sine of the angle): a corner that is nearly straight was
 * no corner but a vertex on an edge. */
#define CAGE_CONVEX 0.01

/* Of a pair of triangles next to each other in the mesh the departure from a rectangle counts by this: exporters write
 * the two halves of a quad one after the other. */
#define CAGE_NEIGHBOUR 0.5

/* Edges that OpenSubdiv can hold at one vertex (16 bits). */
#define CAGE_VALENCE_MAX 65535

typedef struct cage {
    const hemi_allocator *memory;
    double *positions; /* positions[3*v+k], no two alike */
    int *sizes;        /* corners of face f */
    int *corners;      /* of all faces, one after the other; counter-clockwise */
    uint32_t vertex_count, face_count, corner_count;

    int *creases; /* creases[2*i], creases[2*i+1]: the ends of an edge */
    float *crease_sharpness;
    int *points; /* vertices that are sharp by themselves */
    float *point_sharpness;
    int *holes; /* faces */
    uint32_t crease_count, point_count, hole_count;

    double *values;     /* values[value_width*i+k]: distinct attributes of the corners at each vertex */
    int *value_corners; /* value_corners[c]: the value at corner c */
    uint32_t value_count, value_width;

    uint32_t quad_count, dropped_triangles;
} cage;

/* Codes and message as subdivide_mesh. Quads are looked for if the scheme is Catmull-Clark and the mesh does not say
 * which faces its triangles are. */
hemi_result cage_create(const hemi_allocator *memory, const hemi_mesh_desc *mesh, cage *out,
                        char message[SUBDIVIDE_MESSAGE_SIZE]);
void cage_destroy(cage *c);

/* Writes the message of a failure; its code. */
hemi_result subdivide_fail(hemi_result result, char *message, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

HEMI_C_END
#endif
