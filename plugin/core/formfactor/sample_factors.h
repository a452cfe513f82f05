/* SPDX-License-Identifier: MIT
 * What do the samples of a patch receive from a polygon in front of its surface, if nothing stands between? The closed
 * form is n . V with one vector V a sample, so where normals of shading differ V is found along three axes.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_SAMPLE_FACTORS_H
#define HEMIBAKE_CORE_FORMFACTOR_SAMPLE_FACTORS_H

#include "geometry/polygon.h"
#include "mesh/mesh.h"

/* factors[k] += F of sample first + k, from what is not below the surface (polygon_clip) and in front of the sample. */
void sample_factors_add(const mesh *m, const surface *facing, bool is_smooth, const polygon *above, size_t first,
                        size_t count, double *factors);

#endif
