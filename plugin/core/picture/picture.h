/* SPDX-License-Identifier: MIT
 * What does a baked mesh look like? An item buffer names the triangle of each pixel, and the colour is interpolated at
 * the point where the ray through the pixel meets it.
 */
#ifndef HEMIBAKE_CORE_PICTURE_PICTURE_H
#define HEMIBAKE_CORE_PICTURE_PICTURE_H

#include "visibility/item_buffer.h"

typedef struct picture {
    const double *positions; /* positions[3*v+k], world */
    const float *colors;     /* colors[3*v+c] */
    size_t vertex_count;
    const uint32_t *indices; /* indices[3*t+k] */
    size_t triangle_count;
    double eye[3], target[3], up[3];
    double vertical_fov; /* radians */
    int width, height, supersample;
    bool flat, draw_backs;
    float background[3];
    const uint32_t *first; /* first[mesh]: of its triangles, of mesh_count meshes; and behind the last */
    size_t mesh_count;
    const float *coordinates;   /* as in item_geometry */
    const alpha_mask_map *maps; /* of meshes; without alpha: nothing is cut out; NULL: of none */
    const bool *blended;        /* blended[mesh]: its map covers, and cuts nothing out; NULL: none does */
    /* What textures make of the colour at a point of a mesh's triangle; share: of its area that a ray stands for. */
    void (*shade)(void *user, size_t mesh, uint32_t triangle, const double weights[3], double share, float rgb[3]);
    void *shade_user;
    allocator *memory; /* NULL: the C library */
} picture;

/* pixels[4*(y*width+x)+c]: rgb and coverage, row 0 on top. False: message says why. */
bool picture_draw(const picture *p, float *pixels, char *message, size_t message_size);

#endif
