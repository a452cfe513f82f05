/* SPDX-License-Identifier: MIT
 * How does the transform of a hemi_mesh_desc take a mesh to the world? Its rule in code, for those who read descs:
 * column-major, affine, and all 0 means identity (transform[15] is 1 in every other).
 */
#ifndef HEMIBAKE_MESH_TRANSFORM_H
#define HEMIBAKE_MESH_TRANSFORM_H

/* x_world[r] = sum_c m[4*c+r] x[c] + m[12+r] */
static inline void hemi_transform_point(const double m[16], const float x[3], double out[3]) {
    for (int r = 0; r < 3; r++)
        out[r] = m[15] == 0.0 ? (double)x[r] : m[r] * x[0] + m[4 + r] * x[1] + m[8 + r] * x[2] + m[12 + r];
}

/* Of the linear part; 0, not 1, for the all-zero transform. Below 0 the transform mirrors and turns triangles over. */
static inline double hemi_transform_determinant(const double m[16]) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
           m[8] * (m[1] * m[6] - m[2] * m[5]);
}

#endif
