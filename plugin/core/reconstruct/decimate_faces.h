/* SPDX-License-Identifier: MIT
 * What is around a vertex of a flat face, and what is left when it goes? Every face has vertices of its own for the
 * vertices of its triangles, with coordinates in its plane.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_DECIMATE_FACES_H
#define HEMIBAKE_CORE_RECONSTRUCT_DECIMATE_FACES_H

#include "reconstruct/decimate.h"

#define DECIMATE_NONE UINT32_MAX

/* A vertex with more triangles than this stays. */
enum { DECIMATE_RING_MAX = 48 };

typedef enum decimate_kind { DECIMATE_INSIDE, DECIMATE_BORDER /* a straight stretch */, DECIMATE_FIXED } decimate_kind;

typedef struct decimate_vertex {
    double at[2];
    uint32_t vertex, node, face; /* in the mesh; its colour; in the plane of which face */
    uint32_t first_corner;       /* of a triangle that has it; the others follow in next_corner */
    uint32_t place;              /* vertices of borders in the same place have the same; DECIMATE_NONE inside */
    uint32_t next;               /* the next of them, in a circle */
    uint32_t leader;             /* the first of them */
    uint8_t kind;
    bool gone;
} decimate_vertex;

/* Somewhere in a triangle that must keep its colour: in the middle of two vertices, or where a vertex was (a = b). */
typedef struct decimate_point {
    uint32_t a, b, next;
} decimate_point;

typedef struct decimate_faces {
    const decimate_input *in;
    decimate_vertex *vertices;
    uint32_t vertex_count;
    uint32_t *corners, *next_corner; /* vertices[corners[3*t+k]]; corners[3*t] is DECIMATE_NONE once t is gone */
    uint32_t *faces;                 /* of triangles */
    double *shapes;                  /* shapes[f]: the least shape that triangles of face f may have */
    uint32_t triangle_count, face_count;
    decimate_point *points;
    uint32_t *first_point; /* first_point[t] */
    uint32_t point_count;
} decimate_faces;

/* The triangles of a vertex: corner and the two after it. On a border, `first` and `last` are the ends of the fan. */
typedef struct decimate_ring {
    uint32_t count, triangle[DECIMATE_RING_MAX], after[DECIMATE_RING_MAX], before[DECIMATE_RING_MAX];
    uint32_t first, last;
} decimate_ring;

/* What it costs to let a vertex go: the largest change, in tolerances, and the worst shape of what is left. */
typedef struct decimate_cost {
    double error, shape;
} decimate_cost;

/* False when out of memory. */
bool decimate_faces_open(const decimate_input *in, const decimate_triangles *triangles, decimate_faces *out);
void decimate_faces_free(decimate_faces *m);

/* False if the vertex has too many triangles, or they are no fan. */
bool decimate_ring_find(const decimate_faces *m, uint32_t vertex, decimate_ring *out);

/* False if the vertex may not go into `target`, a vertex of its ring. The error is that where the vertex was. */
bool decimate_ring_guess(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target,
                         decimate_cost *out);

/* The same with the error at all points; false also if that is `limit` or more. */
bool decimate_ring_cost(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target,
                        double limit, decimate_cost *out);

/* Lets it go there. */
void decimate_ring_collapse(decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target);

/* Adds what the points of all triangles are off by. */
void decimate_faces_measure(const decimate_faces *m, decimate_result *out);

#endif
