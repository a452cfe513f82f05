/* SPDX-License-Identifier: MIT
 * How many shooters are the triangles of a mesh, where small ones go together? Those whose middles lie in one cube of a
 * patch's size and whose normals lie in one of so many solid angles are taken for one; it is what cluster.h makes of
 * them later, but for which neighbours meet.
 */
#include "tessellate.h"

#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <stdlib.h>

/* On each side of a cube around a normal, along both edges: about 22 degrees. */
enum { ANGLES = 4 };

/* Places beyond are all the same: so far from the origin are no scenes of so small patches. */
static const int64_t CELLS = 1 << 17;

static uint64_t cell_of(double at) {
    return (uint64_t)(fmin(fmax(floor(at), (double)-CELLS), (double)CELLS - 1.0) + (double)CELLS);
}

/* Which solid angle a direction lies in. */
static uint64_t angle_of(const double n[3]) {
    int side = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) > fabs(n[side])) side = 2;
    double most = fmax(fabs(n[side]), 1e-300);
    uint64_t out = (uint64_t)(2 * side) + (n[side] < 0.0);
    for (int k = 1; k < 3; k++) {
        double at = 0.5 * ANGLES * (1.0 + n[(side + k) % 3] / most);
        out = ANGLES * out + (uint64_t)fmin(at, ANGLES - 1);
    }
    return out;
}

static int compare(const void *a, const void *b) {
    uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

/* The place and direction of a triangle; false: it shoots by itself. */
static bool find_key(const hemi_mesh_desc *m, size_t t, double size, uint64_t *key) {
    double p[3][3], normal[3], middle[3];
    for (size_t k = 0; k < 3; k++)
        hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + k], p[k]);
    if (triangle_longest_squared(p[0], p[1], p[2]) > size * size) return false;
    triangle_cross(normal, p[0], p[1], p[2]);
    *key = angle_of(normal);
    for (int k = 0; k < 3; k++) {
        middle[k] = (p[0][k] + p[1][k] + p[2][k]) / 3.0;
        *key = 2 * (uint64_t)CELLS * *key + cell_of(middle[k] / size);
    }
    return true;
}

size_t tessellate_shooters(allocator *memory, const hemi_mesh_desc *m, double size) {
    size_t alone = 0, count = 0, groups = 0;
    uint64_t *keys = block_new(memory, ((size_t)m->triangle_count + 1) * sizeof *keys);
    if (!keys) return m->triangle_count;
    for (size_t t = 0; t < m->triangle_count; t++) {
        if (find_key(m, t, size, &keys[count]))
            count++;
        else
            alone++;
    }
    qsort(keys, count, sizeof *keys, compare);
    for (size_t i = 0; i < count; i++) groups += i == 0 || keys[i] != keys[i - 1];
    block_free(keys);
    return alone + groups;
}
