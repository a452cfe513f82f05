/* SPDX-License-Identifier: MIT
 * How are triangles drawn? Part of hemibake.h.
 */
#ifndef HEMIBAKE_PICTURE_H
#define HEMIBAKE_PICTURE_H

#include <hemibake/scene.h>

HEMI_C_BEGIN

typedef struct hemi_picture_mesh {
    const float *positions;  /* world, positions[3*v+k] */
    const float *colors;     /* colors[3*v+c], any linear scale */
    const uint32_t *indices; /* indices[3*t+k] */
    uint32_t vertex_count, triangle_count;
} hemi_picture_mesh;

/* What is seen at a point of a mesh: rgb holds the colour between its vertices, and is to hold what textures make of
 * it. weights: of the triangle's corners; share: of its area that one ray stands for. */
typedef void (*hemi_picture_shade_fn)(void *user, size_t mesh, uint32_t triangle, const double weights[3], double share,
                                      float rgb[3]);

/* What is cut out of a mesh; its attribute is not asked for. */
typedef struct hemi_picture_mask {
    const hemi_alpha_mask *mask; /* NULL: nothing */
    const float *coordinates;    /* coordinates[3*v+k]: u, v, w */
} hemi_picture_mask;

typedef struct hemi_picture_desc {
    uint32_t struct_size; /* sizeof(hemi_picture_desc) */
    const hemi_picture_mesh *meshes;
    size_t mesh_count;
    double eye[3], target[3], up[3]; /* all 0: a view of the whole, from outside and above */
    double vertical_fov;             /* radians; 0: 40 degrees */
    uint32_t width, height;          /* pixels, 1..8192 */
    uint32_t supersample;            /* rays a pixel and axis; 0: 3 */
    bool flat;                       /* one colour a triangle, the mean of its corners */
    bool draw_backs;                 /* default: backs are culled, as web viewers do with single-sided materials */
    float background[3];
    hemi_picture_shade_fn shade; /* NULL: colours are as between vertices */
    void *shade_user;
    const hemi_picture_mask *masks; /* masks[mesh]; NULL: nothing is cut out of any */
    const bool *blended; /* blended[mesh]: alpha * w of its mask is the share that it covers of what is behind, and cuts
                            nothing out; NULL: of none */
} hemi_picture_desc;

/* Draws triangles through the item buffer. pixels[4*(y*width+x)+c]: linear rgb and coverage, row 0 on top. */
HEMI_API hemi_result hemi_picture(hemi_context *context, const hemi_picture_desc *desc, float *pixels);

HEMI_C_END
#endif
