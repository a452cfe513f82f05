/* SPDX-License-Identifier: MIT
 * What does OpenGL get of the triangles of an item buffer, and which of them may a view show?
 *
 * An id belongs to a triangle and travels in its last vertex, from which flat varyings are taken. So that no two
 * triangles share their last vertex, some vertices are there twice. gl_PrimitiveID would need neither, but Mesa's
 * software rasteriser then takes every triangle of every draw apart, with a realloc for each: an eighth of a bake.
 *
 * A view gets only the triangles that may reach into it. A hemi-cube has five views, and few triangles are in more than
 * one or two.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_DRAWN_TRIANGLES_H
#define HEMIBAKE_CORE_VISIBILITY_DRAWN_TRIANGLES_H

#include "visibility/item_buffer.h"

typedef struct drawn_triangles {
    allocator *memory;
    float *positions;   /* positions[3*v+k]: of the vertices of triangles, no others */
    float *coordinates; /* coordinates[3*v+k]; NULL: nothing has holes */
    uint32_t *ids;      /* ids[v]: t + 1 of the triangle t whose last vertex it is */
    size_t vertex_count;
    uint32_t *indices; /* indices[3*i+k], in the order in which they are drawn */
    size_t triangle_count;
    uint32_t *kept; /* indices of the triangles that views may show, view after view */
    size_t kept_count, kept_capacity;
    float *place[3];  /* place[k][v]: positions again, as drawn_triangles_look wants them */
    uint8_t *outside; /* outside[v]: a bit for each plane of the view that the vertex is outside */
    float reach;      /* the largest coordinate of all */
} drawn_triangles;

/* order[i]: the triangle that is drawn as the i-th. False when out of memory; to be freed all the same. */
bool drawn_triangles_create(const item_geometry *g, const uint32_t *order, allocator *memory, drawn_triangles *out);
void drawn_triangles_free(drawn_triangles *d);

/* Frees positions, coordinates and ids, which OpenGL has by now. */
void drawn_triangles_forget(drawn_triangles *d);

/* Sets outside[] for a view. m: clip from scene, column-major. */
void drawn_triangles_look(drawn_triangles *d, const float m[16]);

/* Adds those of the triangles first to first + count - 1 that are not all outside one plane to those kept. False when
 * out of memory. */
bool drawn_triangles_keep(drawn_triangles *d, size_t first, size_t count);

#endif
