/* SPDX-License-Identifier: MIT
 * What does a ray see of surfaces that cover only a share of what is behind them? Each that it meets before it meets
 * one that covers all, the nearest first, in linear light: alpha of the mesh's map at the point, times w.
 */
#ifndef HEMIBAKE_CORE_PICTURE_BLENDED_H
#define HEMIBAKE_CORE_PICTURE_BLENDED_H

#include "geometry/triangle_bvh.h"
#include "picture/picture.h"

typedef struct blended {
    const picture *picture;
    triangle_bvh tree;
    uint32_t *triangles; /* triangles[i] of the tree, of the picture */
    uint32_t *meshes;
    bool *passed; /* passed[i]: by the ray that is followed, whose work this is */
} blended;

/* Does a mesh cover only a share of what is behind it? */
static inline bool picture_blends(const picture *p, size_t mesh) {
    return p->blended && p->maps && p->blended[mesh] && p->maps[mesh].alpha;
}

/* Of the triangles of such meshes, which may be none. False when out of memory; it is to be freed then too. */
bool blended_create(const picture *p, blended *out);
void blended_free(blended *b);

/* What a point of a triangle shows, by weights of its corners. */
typedef void (*blended_color)(void *user, uint32_t triangle, const double weights[3], float rgb[3]);

/* Along a ray from the eye, 1 along forward, as far as `end`. Adds what is seen to rgb; the share of what is behind
 * that is seen too. */
double blended_add(blended *b, const double ray[3], double end, blended_color color, void *user, float rgb[3]);

#endif
