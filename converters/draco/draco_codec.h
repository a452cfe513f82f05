/* SPDX-License-Identifier: MIT
 * How small can Draco make a triangle mesh, what did that cost in accuracy, and what is in the bytes it made?
 *
 * A thin C interface over one C++ library. No exception leaves it. Threads: all functions are independent.
 */
#ifndef HEMIBAKE_DRACO_CODEC_H
#define HEMIBAKE_DRACO_CODEC_H

#include "hemibake/hemibake.h"

HEMI_C_BEGIN

#define DRACO_CODEC_MAX_ATTRIBUTES 80
#define DRACO_CODEC_MAX_BITS       30

typedef enum draco_codec_semantic {
    DRACO_CODEC_POSITION,
    DRACO_CODEC_NORMAL,
    DRACO_CODEC_COLOR,
    DRACO_CODEC_TEXCOORD,
    DRACO_CODEC_GENERIC
} draco_codec_semantic;

typedef struct draco_codec_attribute {
    draco_codec_semantic semantic;
    uint32_t components; /* 1..4 */
    int bits;            /* quantisation, 1..DRACO_CODEC_MAX_BITS; 0: lossless */
    const float *values; /* values[components*v+k], finite */
    const float *origin; /* where quantisation begins, origin[k]; NULL: at the least values. Not for NORMAL */
    float range;         /* and how far it reaches, the same in every component; with origin only, positive */
} draco_codec_attribute;

typedef struct draco_codec_encode_desc {
    const draco_codec_attribute *attributes; /* the first is a POSITION of three components */
    uint32_t attribute_count;                /* 1..DRACO_CODEC_MAX_ATTRIBUTES */
    uint32_t vertex_count;
    const uint32_t *indices; /* indices[3*t+k] < vertex_count */
    uint32_t triangle_count; /* at least 1 */
    int level;               /* 0 (fast) .. 10 (small) */
    bool shares;             /* a second thread does a part of it, without a trace in what comes out */
} draco_codec_encode_desc;

/* Draco merges equal vertices and reorders vertices and triangles: what a decoder will find is told here, measured by
 * decoding. No triangle is lost: where the edge-breaker method drops some (corners at the same place), the sequential
 * method is used instead. */
typedef struct draco_codec_encoded {
    uint8_t *bytes;
    size_t byte_count;
    uint32_t point_count, face_count; /* after decoding; face_count = triangle_count */
    bool sequential;                  /* the edge-breaker would have lost triangles */
    uint32_t unique_ids[DRACO_CODEC_MAX_ATTRIBUTES];
    float lower[DRACO_CODEC_MAX_ATTRIBUTES][4]; /* bounds of the decoded values ... */
    float upper[DRACO_CODEC_MAX_ATTRIBUTES][4];
    double max_error[DRACO_CODEC_MAX_ATTRIBUTES]; /* ... and how far one is from its original: the length of the
                                                     difference for POSITION and NORMAL, else the largest component */
} draco_codec_encoded;

/* HEMI_ERROR_ARGUMENT: the rules above are broken; HEMI_ERROR_DATA: Draco refuses the mesh; HEMI_ERROR_MEMORY. */
hemi_result draco_codec_encode(const draco_codec_encode_desc *desc, draco_codec_encoded *out);
void draco_codec_encoded_free(draco_codec_encoded *encoded); /* NULL is fine; leaves it empty */

typedef struct draco_codec_mesh draco_codec_mesh;

/* Refuses with HEMI_ERROR_LIMIT what says it holds more points or faces than the limits, before memory is spent on
 * them; with HEMI_ERROR_DATA what is not a whole Draco mesh. Hostile bytes may still cost some seconds and 256 MiB an
 * attribute inside libdraco 1.5.5, which believes any count of texture-coordinate orientations. */
hemi_result draco_codec_decode(const uint8_t *bytes, size_t byte_count, uint32_t point_limit, uint32_t face_limit,
                               draco_codec_mesh **out);
void draco_codec_mesh_destroy(draco_codec_mesh *mesh); /* NULL is fine */

uint32_t draco_codec_mesh_point_count(const draco_codec_mesh *mesh);
uint32_t draco_codec_mesh_face_count(const draco_codec_mesh *mesh);

/* indices[3*f+k] < point_count, 3 face_count of them. */
void draco_codec_mesh_indices(const draco_codec_mesh *mesh, uint32_t *indices);

/* How many components the attribute of that unique id has; 0: there is none. */
uint32_t draco_codec_mesh_components(const draco_codec_mesh *mesh, uint32_t unique_id);

/* values[components*p+k] for every point; integers as they are stored, not normalised. False if there is no such
 * attribute or it does not have that many components. */
bool draco_codec_mesh_values(const draco_codec_mesh *mesh, uint32_t unique_id, uint32_t components, float *values);

HEMI_C_END
#endif
