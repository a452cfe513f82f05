/* SPDX-License-Identifier: MIT
 * Into which faces is a patch cut along contact lines? A patch shoots the mean of its elements from all of its area, so
 * where only a part of it is in the light, that part must be a patch of its own. Faces are triangles and
 * parallelograms.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_FACES_H
#define HEMIBAKE_CORE_MESH_CONTACT_FACES_H

#include "mesh/contact_pieces.h"

enum { CONTACT_FACES_MAX = 64, CONTACT_CHORDS_MAX = 4 * CONTACT_FACES_MAX };

typedef struct contact_faces {
    pieces cut;                             /* the points are corners of the faces; the first are those of the patch */
    uint8_t face[CONTACT_FACES_MAX][4];     /* points; [3] is PIECE_NONE in a triangle */
    double inward[CONTACT_FACES_MAX][4][3]; /* unit, of the edge from corner k of a face */
    int count;
    contact_line chords[CONTACT_CHORDS_MAX]; /* edges between faces */
    int chord_count;
} contact_faces;

/* Lines that run through less than `least`, m, do not cut the patch. One face: it is not cut. */
void contact_faces_find(const double (*corner)[3], int corner_count, const double normal[3],
                        const contact_line *const *lines, size_t line_count, double least, contact_faces *out);

/* The face that has a point in it, or is nearest to it. */
int contact_faces_holding(const contact_faces *f, const double point[3]);

/* A bit of each that has the middle of a piece in it. */
uint64_t contact_faces_of(const contact_faces *f, const pieces *p);

#endif
