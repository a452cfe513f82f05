/* SPDX-License-Identifier: MIT
 * Which points of a scene does somebody see, and from where?
 *
 * From the cameras that the asset has. Without one, from afar, in front, a little above and to the right, where the
 * preview stands; from all around; and from inside, wherever there is light.
 *
 * The last two are one sample. A ray leaves a random point of a front, by the cosine. If it meets nothing, the point is
 * seen from outside. If it meets a front after t metres, eyes anywhere on the way see the point: of all eyes in free
 * space and all directions in which they look,
 *
 *     integral over eyes of dw = integral over t' <= t of cos / t'^2 dA t'^2 dt' dw = t cos dw dA,
 *
 * so its weight is t. What lies in a gap or hollow has hardly any, and where the other end is dark nobody looks from.
 * Backs let rays through, as they let viewers look.
 */
#ifndef HEMIBAKE_COLOR_SEEN_POINTS_H
#define HEMIBAKE_COLOR_SEEN_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct seen_mesh {
    const float *positions, *radiance; /* positions[3*v+k]; radiance[3*v+c], linear Rec.709 */
    const float *light;                /* what the colours carry where a texture multiplies them; NULL: radiance */
    const uint32_t *indices;           /* indices[3*t+k] */
    uint32_t triangle_count;
    double transform[16]; /* all zero: none */
    double emission[3];   /* of the material; a texture may take it away in places */
} seen_mesh;

typedef struct seen_camera {
    double eye[3], target[3], up[3];
    double yfov; /* radians; 0: orthographic, ymag high each side of the middle */
    double ymag, aspect;
} seen_camera;

typedef enum seen_from { SEEN_FROM_CAMERA, SEEN_FROM_AFAR, SEEN_FROM_OUTSIDE, SEEN_FROM_INSIDE, SEEN_PLACES } seen_from;

/* Rec.709 [ITU-R BT.709-6]. Negative and NaN for what is no radiance. */
static inline double luminance(const float rgb[3]) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

typedef struct seen_point {
    float radiance[3], light[3];
    float weight; /* within its place */
    float area;   /* what it stands for of the area that is seen; all alike, but 0 from afar */
    bool emits;
    seen_from from;
} seen_point;

typedef struct seen_points {
    seen_point *points; /* from malloc, the caller's */
    size_t count;
    bool cameras_are_dark; /* surfaces are all that the cameras see, but no light on them */
} seen_points;

/* The same points on every run, with any number of threads (0: one for each core); none where nothing is seen. False:
 * out of memory. */
bool seen_points_find(const seen_mesh *meshes, size_t mesh_count, const seen_camera *cameras, size_t camera_count,
                      unsigned threads, seen_points *out);

#endif
