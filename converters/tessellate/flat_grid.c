/* SPDX-License-Identifier: MIT
 * Is a mesh made of flat grids? Its triangles lie in few planes, and those of a plane have two edges along the same two
 * directions, which are those of a parallelogram that was cut into columns and rows. merge.c makes few faces of such.
 */
#include "tessellate.h"

#include "base/pair_map.h"

/* Planes are told apart by the 512th part of a normal and the 16384th of the extent: what lies on a border of that is
 * two planes, which does no harm. */
static const double NORMALS = 512.0, DISTANCES = 16384.0;

/* Two edges run the same way if the sine between them is no more: a cell of a thousandth of the mesh is tilted by 1e-4
 * by the rounding of floats. */
static const double SAME_WAY = 1e-3;

/* A plane has so many triangles in the mean, and no more than this share are of another shape. */
enum { TRIANGLES_OF_A_PLANE = 64 };
static const double ODD_SHARE = 1e-3;

/* Of the first triangle's edges any two may be the directions: odd[k] counts the triangles that do not run along the
 * two others than k. */
typedef struct grid_plane {
    double edge[3][3];
    uint32_t odd[3];
} grid_plane;

typedef struct grid_planes {
    pair_map numbers;
    grid_plane *all;
    size_t count, capacity;
} grid_planes;

static double extent_of(const hemi_mesh_desc *m) {
    double most = 0.0;
    for (size_t i = 0; i < 3 * (size_t)m->vertex_count; i++) most = fmax(most, fabs((double)m->positions[i]));
    return most;
}

static grid_plane *plane_of(grid_planes *p, const double normal[3], double distance, double edge[3][3]) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) key = key << 16 | (uint64_t)(normal[k] * NORMALS + 2.0 * NORMALS);
    uint32_t next = (uint32_t)p->count;
    uint32_t *known = pair_map_at(&p->numbers, key, (uint64_t)(distance * DISTANCES + 4.0 * DISTANCES), next);
    if (!known || !block_grow(p->numbers.memory, (void **)&p->all, &p->capacity, p->count, sizeof *p->all)) return NULL;
    if (*known != next) return &p->all[*known];
    grid_plane *added = &p->all[p->count++];
    *added = (grid_plane){ .odd = { 0, 0, 0 } };
    for (int k = 0; k < 3; k++) vec3_copy(added->edge[k], edge[k]);
    return added;
}

static bool runs_along(const double direction[3], double edge[3][3]) {
    double most = SAME_WAY * SAME_WAY * vec3_dot(direction, direction);
    for (int k = 0; k < 3; k++) {
        double off[3];
        vec3_cross(off, direction, edge[k]);
        if (vec3_dot(off, off) <= most * vec3_dot(edge[k], edge[k])) return true;
    }
    return false;
}

/* False when out of memory. */
static bool add_triangle(grid_planes *p, const hemi_mesh_desc *m, size_t t, double extent) {
    double corner[3][3], edge[3][3], normal[3];
    for (int k = 0; k < 3; k++) vec3_from_floats(corner[k], m->positions + 3 * (size_t)m->indices[3 * t + (size_t)k]);
    for (int k = 0; k < 3; k++) vec3_sub(edge[k], corner[(k + 1) % 3], corner[k]);
    vec3_cross(normal, edge[0], edge[1]);
    if (!(vec3_normalize(normal) > 0.0)) return true;
    grid_plane *own = plane_of(p, normal, vec3_dot(normal, corner[0]) / extent, edge);
    if (!own) return false;
    bool runs[3];
    for (int k = 0; k < 3; k++) runs[k] = runs_along(own->edge[k], edge);
    for (int k = 0; k < 3; k++) own->odd[k] += !(runs[(k + 1) % 3] && runs[(k + 2) % 3]);
    return true;
}

bool tessellate_is_flat_grid(const hemi_mesh_desc *m, allocator *memory) {
    grid_planes p = { .numbers.memory = memory };
    double extent = extent_of(m), odd = 0.0;
    bool ok = extent > 0.0 && !m->alpha_mask;
    for (size_t t = 0; ok && t < m->triangle_count; t++) {
        ok = add_triangle(&p, m, t, extent);
        if (p.count * TRIANGLES_OF_A_PLANE > m->triangle_count) ok = false;
    }
    for (size_t i = 0; i < p.count; i++) {
        const uint32_t *n = p.all[i].odd;
        odd += fmin(n[0], fmin(n[1], n[2]));
    }
    pair_map_free(&p.numbers);
    block_free(p.all);
    return ok && odd <= ODD_SHARE * m->triangle_count;
}
