/* SPDX-License-Identifier: MIT
 * Which surface is seen through each pixel, by rays? The back end of item buffers that needs no OpenGL: a ray through
 * the centre of each pixel, and edges as lines of pixels with a depth each. It shows what OpenGL does but for pixels
 * whose centre is a rounding away from an edge, and for what is nearer than the near plane: there rays still know what
 * is in front.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_RAY_ITEMS_H
#define HEMIBAKE_CORE_VISIBILITY_RAY_ITEMS_H

#include "visibility/item_buffer.h"

typedef struct ray_items ray_items;

/* As item_buffer_open; desc->first_id is not 0. */
ray_items *ray_items_open(const item_buffer_desc *desc, char *message, size_t message_size);
void ray_items_destroy(ray_items *r); /* NULL is fine */

/* As item_buffer_draw, of a size that fits. */
bool ray_items_draw(ray_items *r, const item_view *views, int view_count, int width, int height, bool cull,
                    uint32_t *ids);

#endif
