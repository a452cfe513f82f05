/* SPDX-License-Identifier: MIT
 * Which surface is seen through each pixel? An item buffer holds the triangles of a scene and draws their ids from any
 * eye. OpenGL draws them, with a context from osmesa.c or egl.c, or rays do (ray_items.h).
 *
 * Every back end gives the same ids where the OpenGL behind it is the same Mesa; another OpenGL, and rays, may differ
 * in pixels whose centre is a rounding away from an edge.
 *
 * Through the holes of what a texture cuts out (alpha_mask.h) a pixel shows what is behind, if its centre is in one.
 * Edges are drawn whole.
 *
 * An item buffer belongs to the thread that made it, and leaves no context current there. Several may live in a thread,
 * of any back ends, and any number of threads may have theirs at once.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_ITEM_BUFFER_H
#define HEMIBAKE_CORE_VISIBILITY_ITEM_BUFFER_H

#include "base/block.h"
#include "scene/alpha_mask.h"

typedef enum item_backend {
    ITEM_BACKEND_DEFAULT, /* the pool's; else OSMesa, EGL or rays, the first that the build has */
    ITEM_BACKEND_OSMESA,
    ITEM_BACKEND_EGL, /* surfaceless: no window, no display server */
    ITEM_BACKEND_RAYS,
    ITEM_BACKENDS
} item_backend;

/* Is it in this build? DEFAULT always is. */
bool item_backend_is_there(item_backend backend);

/* Where OpenGL contexts wait between the item buffers of a bake, with their shaders compiled (item_device.h). Any
 * thread may take what another gave back. */
typedef struct item_pool item_pool;

/* NULL when out of memory. */
item_pool *item_pool_create(allocator *memory);

/* Makes so many contexts in threads of its own, while the caller goes on; once a pool. It is for who will draw: Mesa's
 * own threads stay until the process ends, and one that yields to all others is what a busy machine ends last. */
void item_pool_warm(item_pool *pool, unsigned count);

/* What draws item buffers of the pool that ask for DEFAULT, from now on; none of them is there yet. */
void item_pool_set_backend(item_pool *pool, item_backend backend);

/* What has drawn the pool's item buffers: a bit 1 << backend each. */
unsigned item_pool_used_backends(const item_pool *pool);
/* What was drawn by an earlier bake, whose results are kept, counts as drawn. */
void item_pool_count_as_used(item_pool *pool, item_backend asked);

/* When all item buffers that came from it are gone. NULL is fine. */
void item_pool_destroy(item_pool *pool);

/* What is drawn. Positions are relative to the scene's centre, so that floats hold them well. Of
 * triangles that lie in one plane and overlap, the first is seen (coplanar_overlap.h). */
typedef struct item_geometry {
    const float *positions; /* positions[3*v+k] */
    size_t vertex_count;
    const uint32_t *indices; /* indices[3*t+k]; triangle t is drawn with the id t + 1, so 0 is left for the sky */
    size_t triangle_count;
    float near_plane;                   /* distance; nothing is cut there, but what is nearer counts as equally near */
    const float *coordinates;           /* coordinates[3*v+k]: u, v, w of alpha_mask.h; NULL: nothing has holes */
    const alpha_mask_map *const *holes; /* holes[t]: what is cut out of triangle t, NULL: nothing; if coordinates */
    item_pool *pool;                    /* of whoever draws it; NULL: every item buffer makes its own context */
    const uint8_t *layers; /* of coplanar_overlap.h, of each triangle; NULL: whoever needs them looks for them */
} item_geometry;

/* Fills out[t]. False when out of memory. */
bool item_geometry_layers(const item_geometry *g, allocator *memory, uint8_t *out);

/* Only the edges of triangles, a pixel wide, of those that turn one side to the eye or the other: they show what is too
 * thin to cover a pixel's centre. Where a triangle hides its neighbour, the two turn different sides to the eye, so
 * both show the edge they share. */
typedef enum item_edges { ITEM_EDGES_NONE, ITEM_EDGES_FRONT, ITEM_EDGES_BACK } item_edges;

/* A pyramid of sight: the point eye + forward + s right + t up is drawn at s from s_low to s_high over the width of the
 * viewport, t from t_low to t_high over its height, row 0 at t_low. A parallel view is a box instead: eye + s right +
 * t up + z forward is drawn at s and t, in metres, for z from 0 to depth. */
typedef struct item_view {
    float eye[3], right[3], up[3], forward[3]; /* orthonormal axes */
    float s_low, s_high, t_low, t_high;
    int x, y, width, height; /* viewport in pixels */
    bool parallel;
    float depth; /* of a parallel view */
    item_edges edges;
} item_view;

typedef struct item_buffer item_buffer;

typedef struct item_buffer_desc {
    const item_geometry *geometry; /* copied */
    int width, height;             /* pixels at most */
    item_backend backend;
    uint32_t first_id; /* triangle t is drawn with the id first_id + t; 0 stands for 1; no id may pass UINT32_MAX */
    bool marks_holes;  /* ids of pixels that look past a triangle with holes, or at one, have ITEM_MARK */
    allocator *memory; /* for what it takes beside OpenGL; NULL: the C library */
} item_buffer_desc;

/* No id reaches it where it is used. */
#define ITEM_MARK UINT32_C(0x80000000)

/* NULL: message says why. */
item_buffer *item_buffer_open(const item_buffer_desc *desc, char *message, size_t message_size);
void item_buffer_destroy(item_buffer *b);

/* Draws views into ids[y*width+x], with width >= the extent of all viewports. cull: leave backs out. */
bool item_buffer_draw(item_buffer *b, const item_view *views, int view_count, int width, int height, bool cull,
                      uint32_t *ids);

#endif
