/* SPDX-License-Identifier: MIT
 * Which surface, patch or element is seen through a pixel? The pieces of a scene as item geometry, one to two triangles
 * a piece, one sheet for the two sides of a double-sided one. Item buffers of surfaces are the cheapest to draw; the
 * others are for methods that count the pixels of a piece. Panes (panes.h) are left out: what is behind them is seen.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_MESH_ITEMS_H
#define HEMIBAKE_CORE_VISIBILITY_MESH_ITEMS_H

#include "mesh/mesh.h"
#include "visibility/item_buffer.h"

typedef enum mesh_pieces { MESH_SURFACES, MESH_PATCHES, MESH_ELEMENTS } mesh_pieces;

typedef struct mesh_items {
    item_geometry items;
    uint32_t *triangle_piece; /* of each triangle; of two sides of a sheet the first is drawn */
    uint32_t *surface;        /* of each piece */
    uint32_t *twin;           /* of each piece: the piece on the other side of its sheet, or NO_INDEX */
} mesh_items;

/* Allocates from memory; false when out of it. */
bool mesh_items_create(const scene *s, const mesh *m, mesh_pieces pieces, arena *memory, mesh_items *out);

/* The piece whose front a pixel of this id shows to the eye, NO_INDEX if it shows a back. id > 0. */
static inline uint32_t mesh_items_facing(const mesh_items *items, const scene *s, uint32_t id, const double eye[3]) {
    uint32_t piece = items->triangle_piece[id - 1];
    return surface_height(&s->surfaces[items->surface[piece]], eye) > 0.0 ? piece : items->twin[piece];
}

#endif
