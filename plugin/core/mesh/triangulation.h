/* SPDX-License-Identifier: MIT
 * Which triangles show an element? A triangle itself, a quad two along a diagonal. Where a neighbour is finer, a vertex
 * hangs in the middle of their common edge; the element is then shown as a fan around the first of these, so that no
 * edge has a T-junction.
 *
 *     3 --- 2     3 --- 2     places: 0-3 the corners, 4-7 the middles of the edges that begin there
 *     |   / |     | \ / |
 *     | /   |     | / \ |     reference coordinates: corner 0 is (0,0), corner 1 (1,0), the last (0,1)
 *     0 --- 1     0 -4- 1
 */
#ifndef HEMIBAKE_CORE_MESH_TRIANGULATION_H
#define HEMIBAKE_CORE_MESH_TRIANGULATION_H

#include "mesh/mesh.h"

enum { ELEMENT_PLACES = 8, ELEMENT_TRIANGLES_MAX = 6 };

/* The places around an element, counter-clockwise from corner 0; how many. */
int element_ring(const element *e, uint8_t ring[ELEMENT_PLACES]);

/* triangle[i][k]: a place. diagonal: 0 cuts a quad without hanging vertices from corner 0 to 2, 1 from 1 to 3. Returns
 * how many. */
int element_triangles(const element *e, int diagonal, uint8_t triangle[ELEMENT_TRIANGLES_MAX][3]);

/* The triangle that shows reference point (u, v), and the weights of its places there. */
void element_locate(const element *e, int diagonal, double u, double v, uint8_t place[3], double weights[3]);

static inline uint32_t element_vertex(const element *e, int place) {
    return place < 4 ? e->corner[place] : e->middle[place - 4];
}

#endif
