/* SPDX-License-Identifier: MIT
 * Which triangles does the picture not need? Those of flat faces whose vertices others give the same colour to.
 *
 * A vertex goes into one of its neighbours, and its triangles with it, where what is left
 *
 *     - stays in its face: vertices inside it may go, and vertices on a straight stretch of its border, with all that
 *       lie in the same place on other faces at once, so that no border has a vertex on one side only;
 *     - turns as before, and is no needle;
 *     - interpolates to within the tolerance, in every band, at every vertex that went and at the middle of every edge
 *       that there was.
 *
 * Vertices go in rounds, those that cost least first, and none beside another in one round: so triangles grow evenly,
 * and a point is looked at as often as triangles double, not as often as vertices go.
 *
 * What went where may be recorded, and done again first by other colours, as far as these allow: one way is looked at
 * for each vertex in the place of all. By the same colours the same is left.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_DECIMATE_H
#define HEMIBAKE_CORE_RECONSTRUCT_DECIMATE_H

#include "base/arena.h"
#include "base/jobs.h"

#include <stdint.h>

enum { DECIMATE_FIELDS_MAX = 2 };

/* A colour of three bands at nodes, and by how much it may change. */
typedef struct decimate_field {
    const double *values;    /* values[3*n+c] */
    const double *tolerance; /* tolerance[n] > 0 */
} decimate_field;

/* Which vertices went into which, in their order, as numbers that are the same for the same triangles. */
typedef struct decimate_record {
    uint32_t *pairs; /* pairs[2*i], which went, pairs[2*i+1], where; of a border the first of those in its place */
    size_t count;
    bool is_given; /* else they are found, in an array of the arena */
    arena *memory;
} decimate_record;

typedef struct decimate_input {
    jobs *jobs;              /* whose memory it takes */
    watcher watch;           /* over: what would go after that stays */
    const double *positions; /* positions[3*v+k] */
    const uint32_t *nodes;   /* the node of vertex v, that has its colours */
    uint32_t vertex_count;
    const bool *kept;     /* kept[f]: face f stays as it is; NULL: none does */
    const bool *emitters; /* emitters[f]: face f is not in decimate_result; NULL: all are */
    decimate_field fields[DECIMATE_FIELDS_MAX];
    int field_count;
    decimate_record *record; /* NULL: nobody asks */
} decimate_input;

/* Triangles of vertices; those of a face are planar, counter-clockwise, and follow each other. */
typedef struct decimate_triangles {
    uint32_t *corners; /* corners[3*t+k] */
    uint32_t *faces;   /* faces[t]: does not fall */
    uint32_t count;
} decimate_triangles;

/* Of the points that were looked at. */
typedef struct decimate_result {
    double error;  /* what any band of field 0 changed by at most, in tolerances there */
    double square; /* what it changed by, squared and integrated over area, all bands */
} decimate_result;

/* Leaves fewer triangles, in the order they had. False when out of memory. The same for any number of threads. */
bool decimate(const decimate_input *in, decimate_triangles *triangles, decimate_result *out);

#endif
