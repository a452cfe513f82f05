/* SPDX-License-Identifier: MIT
 * Which lines of edges may go, so that the faces on both sides are one, and no T-junction is made? Private to this
 * folder.
 *
 * A line from one border of the mesh to another goes as a whole or stays as a whole: it goes where the faces on both
 * sides of each of its edges make a parallelogram, where four faces meet at each vertex on the way, and where no more
 * than the two beside it meet at its ends.
 *
 *     +---+---+---+---+        +-------+-------+
 *     |   |   |   |   |        |       |       |
 *     +---+---+---+---+   ->   |       |       |     a line that ends in the corner of a notch stays
 *     |   |   |   |   |        |       |       |
 *     +---+---+---+---+        +-------+-------+
 *     |   |   |                |       |
 *     +---+---+                +-------+
 */
#ifndef HEMIBAKE_TESSELLATE_MERGE_LINES_H
#define HEMIBAKE_TESSELLATE_MERGE_LINES_H

#include "internal.h"

/* Edges are numbered 4*f+k: that of face f from its corner k to the next. */
typedef struct merge_lines {
    builder *b;
    uint32_t first_vertex, vertex_count; /* of the mesh */
    uint32_t *first, *around;            /* around[first[v] .. first[v+1]): faces that have vertex v */
    uint32_t *across;                    /* across[e]: the same edge of the face beyond, or NO_INDEX */
    uint32_t *line;                      /* line[e], where e is less than across[e]: the lowest edge of its line */
    bool *stays;                         /* of that edge */
    uint32_t *region;                    /* region[f]: the lowest of the faces that hang together with it by edges */
} merge_lines;

/* Of the faces of a mesh, whose vertices and nodes are those from these on. False when out of memory; to be freed then
 * too. */
bool merge_lines_find(builder *b, uint32_t first_vertex, uint32_t first_node, merge_lines *out);
void merge_lines_free(merge_lines *m);

/* May the edge go, with its line? */
bool merge_lines_open(const merge_lines *m, uint32_t edge);

#endif
