/* SPDX-License-Identifier: MIT
 * Which surface is seen through each pixel? An item buffer holds the surfaces of a scene and draws their ids from any
 * eye. Drawing is a back end's work (osmesa.c); nothing here knows which.
 *
 * An item buffer belongs to the thread that made it.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_ITEM_BUFFER_H
#define HEMIBAKE_CORE_VISIBILITY_ITEM_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What is drawn. Positions are relative to the scene's centre, so that floats hold them well. */
typedef struct item_geometry {
    const float *positions; /* positions[3*v+k] */
    size_t vertex_count;
    const uint32_t *indices; /* indices[3*t+k]; triangle t is drawn with the id t + 1, so 0 is left for the sky */
    size_t triangle_count;
    float near_plane; /* distance */
} item_geometry;

/* A pyramid of sight: the point eye + forward + s right + t up is drawn at s from s_low to s_high over the width of the
 * viewport, t from t_low to t_high over its height, row 0 at t_low. */
typedef struct item_view {
    float eye[3], right[3], up[3], forward[3]; /* orthonormal axes */
    float s_low, s_high, t_low, t_high;
    int x, y, width, height; /* viewport in pixels */
} item_view;

typedef struct item_buffer item_buffer;

/* width x height pixels at most. NULL: message says why. */
item_buffer *item_buffer_create(const item_geometry *geometry, int width, int height, char *message, size_t message_size);
void item_buffer_destroy(item_buffer *b);

/* Draws views into ids[y*width+x], with width >= the extent of all viewports. cull: leave backs out. */
bool item_buffer_draw(item_buffer *b, const item_view *views, int view_count, int width, int height, bool cull,
                      uint32_t *ids);

#endif
