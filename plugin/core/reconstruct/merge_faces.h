/* SPDX-License-Identifier: MIT
 * What is around a vertex of a flat face, and what is left when it goes? Every face has spots of its own for the
 * vertices of its triangles, with coordinates in its plane.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_MERGE_FACES_H
#define HEMIBAKE_CORE_RECONSTRUCT_MERGE_FACES_H

#include "reconstruct/merge.h"

#define MERGE_NONE UINT32_MAX

/* A spot with more triangles than this stays. */
enum { MERGE_RING_MAX = 48 };

typedef enum merge_kind { MERGE_INSIDE, MERGE_BORDER, MERGE_FIXED } merge_kind; /* border: on a straight stretch */

typedef struct merge_spot {
    double at[2];
    uint32_t vertex, face;
    uint32_t first_corner; /* of a triangle that has it; the others follow in next_corner */
    uint32_t place;        /* spots of borders in the same place have the same; MERGE_NONE inside */
    uint32_t next;         /* the next of them, in a circle */
    uint32_t leader;       /* the first of them */
    uint8_t kind;
    bool gone;
} merge_spot;

/* Somewhere in a triangle that must keep its colour: in the middle of two spots, or where a spot was (a = b). */
typedef struct merge_point {
    uint32_t a, b, next;
} merge_point;

typedef struct merge_faces {
    const merge_input *in;
    merge_spot *spots;
    uint32_t spot_count;
    uint32_t *corners, *next_corner; /* spots[corners[3*t+k]]; corners[3*t] is MERGE_NONE once t is gone */
    uint32_t *faces;                 /* of triangles */
    double *shapes;                  /* shapes[f]: the least shape that triangles of face f may have */
    uint32_t triangle_count, face_count;
    merge_point *points;
    uint32_t *first_point; /* first_point[t] */
    uint32_t point_count;
} merge_faces;

/* The triangles of a spot: corner and the two after it. On a border, `first` and `last` are the ends of the fan. */
typedef struct merge_ring {
    uint32_t count, triangle[MERGE_RING_MAX], after[MERGE_RING_MAX], before[MERGE_RING_MAX];
    uint32_t first, last;
} merge_ring;

/* What it costs to let a spot go: the largest change, in tolerances, and the worst shape of what is left. */
typedef struct merge_cost {
    double error, shape;
} merge_cost;

/* False when out of memory. */
bool merge_faces_open(const merge_input *in, const merge_triangles *triangles, merge_faces *out);
void merge_faces_free(merge_faces *m);

/* False if the spot has too many triangles, or they are no fan. */
bool merge_ring_find(const merge_faces *m, uint32_t spot, merge_ring *out);

/* False if the spot may not go into `target`, a spot of its ring. The error is that where the spot was. */
bool merge_ring_guess(const merge_faces *m, uint32_t spot, const merge_ring *ring, uint32_t target, merge_cost *out);

/* The same with the error at all points; false also if that is `limit` or more. */
bool merge_ring_cost(const merge_faces *m, uint32_t spot, const merge_ring *ring, uint32_t target, double limit,
                     merge_cost *out);

/* Lets it go there. */
void merge_ring_collapse(merge_faces *m, uint32_t spot, const merge_ring *ring, uint32_t target);

/* Adds what the points of all triangles are off by. */
void merge_faces_measure(const merge_faces *m, merge_result *out);

#endif
