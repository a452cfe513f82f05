/* SPDX-License-Identifier: MIT
 * Into which pieces do contact lines cut one element? A line cuts the pieces that it runs through, all across them, so
 * pieces are convex; those that it does not reach stay whole. Where the line ends there is a point on the cut.
 *
 *     +---------+      +----+----+
 *     |         |      |    |    |      A line cuts the square in two; another, that begins on it, only the right
 *     |    +----|  ->  |    +----|      one. Points on cuts and edges belong to the pieces on both sides.
 *     |    |    |      |    |    |
 *     +---------+      +----+----+
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_PIECES_H
#define HEMIBAKE_CORE_MESH_CONTACT_PIECES_H

#include "scene/contact_lines.h"

enum { PIECE_POINTS_MAX = 80, PIECES_MAX = 32, PIECE_CORNERS_MAX = 24, PIECE_NONE = 255 };

/* A corner of the element (the first of its points), a point on an edge of it, or one inside. */
typedef struct piece_point {
    double at[3];
    uint32_t on_edge; /* its number for whoever knows the edges; NO_INDEX: none */
    uint8_t edges;    /* bit k: lies on the edge from corner k */
} piece_point;

/* Corners are points, counter-clockwise. */
typedef struct piece {
    uint8_t count, corner[PIECE_CORNERS_MAX];
} piece;

typedef struct pieces {
    const double *normal; /* of the surface */
    piece_point points[PIECE_POINTS_MAX];
    piece all[PIECES_MAX];
    int point_count, count, corner_count;
    double snap;               /* points that are as near are one: a share of the longest edge of what is cut */
    double least, least_share; /* lines that run through less, m, or less of a piece's longest edge, do not cut it */
    /* The number of the point on edge k of the element that is no further than `reach` from `at`, which becomes its
     * place: one that there is, or a new one. NO_INDEX when out of memory. */
    uint32_t (*on_edge)(void *user, int k, double at[3], double reach);
    void *user;
} pieces;

/* What cuts of elements may be off by, as a share of the longest edge of what is cut. */
extern const double PIECES_SNAP;

/* The whole element, to be cut as elements are. */
void pieces_open(pieces *p, const double (*corner)[3], int corner_count, const double normal[3]);

/* Cuts along a line where it is long enough. False when out of memory. */
bool pieces_cut(pieces *p, const contact_line *line);

/* The same with another snap and least share. */
bool pieces_cut_as(pieces *p, const contact_line *line, double snap, double least_share);

/* The point of the element with this number on edge k; an index into points, -1 if there is no room for one more. */
int pieces_point_on_edge(pieces *p, int k, uint32_t number, const double at[3]);

/* Triangles, or the quad, of a piece, with the points that lie on its border as corners; face[i][k]: points,
 * face[i][3]: PIECE_NONE in a triangle. Returns how many. */
int pieces_faces(const pieces *p, const piece *one, uint8_t face[PIECE_POINTS_MAX][4]);

/* How many that is of all pieces. */
int pieces_face_count(const pieces *p);

/* The mean of its corners. */
void pieces_middle(const pieces *p, const piece *one, double out[3]);

#endif
