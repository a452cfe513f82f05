/* SPDX-License-Identifier: MIT
 * See cage_levels.h. A level halves the edges of a cage, so it takes log2(edge / element) of them until faces are as
 * small as elements. One less is taken: a curved face is a surface that shoots by itself, and four elements of it are
 * what the preset has for one shooter. A cube at level 4 takes ten times as long as at 3, at the same limit points.
 */
#include "cage_levels.h"

#include "geometry/triangle.h"

#include <math.h>
#include <stdlib.h>

/* A cage is no surface: its points lie beside the limit, so one level is the least where there is room for it. */
enum { LEVEL_LEAST = 1, LEVEL_MOST = 3 };

/* So many triangles all cages may become together: a set of dense ones is taken as it is. */
static const double TRIANGLES_MOST = 400000;

/* Elements that a scene is cut to where nobody says how large they are, as the presets of the qualities have it. */
static double element_count(const options *o) {
    static const double counts[] = { 4000, 1600, 4000, 8000, 30000 };
    return counts[o->bake.quality];
}

static double world_area(const hemi_mesh_desc *mesh) {
    double area = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], q[3][3];
        triangle_from_floats(p, mesh->positions, mesh->indices + 3 * (size_t)t);
        for (int i = 0; i < 3; i++)
            for (int r = 0; r < 3; r++)
                q[i][r] = mesh->transform[r] * p[i][0] + mesh->transform[4 + r] * p[i][1] + mesh->transform[8 + r] * p[i][2];
        area += triangle_area(q[0], q[1], q[2]);
    }
    return area;
}

static uint32_t face_count(const hemi_mesh_desc *mesh) {
    return mesh->subdivision && mesh->subdivision->face_count ? mesh->subdivision->face_count : mesh->triangle_count;
}

static uint32_t level_for(const hemi_mesh_desc *mesh, double area, double size) {
    double edge = sqrt(area / fmax(face_count(mesh), 1.0));
    double level = edge > 0.0 && size > 0.0 ? floor(log2(edge / size)) - 1.0 : 0.0;
    return (uint32_t)fmin(fmax(level, LEVEL_LEAST), LEVEL_MOST);
}

/* All cages together become this many triangles. */
static double triangles_of(const gltf_asset *asset, const uint32_t *levels) {
    double sum = 0.0;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        if (levels[i] == 0 || !gltf_asset_mesh(asset, i, &mesh)) continue;
        sum += mesh.triangle_count * pow(4.0, levels[i]);
    }
    return sum;
}

static void lower_to_room(const gltf_asset *asset, uint32_t *levels) {
    while (triangles_of(asset, levels) > TRIANGLES_MOST)
        for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
            if (levels[i] > 0) levels[i]--;
}

uint32_t *cage_levels_make(const gltf_asset *asset, const options *o) {
    uint32_t count = gltf_asset_mesh_count(asset);
    uint32_t *levels = calloc(count + 1, sizeof *levels);
    double *areas = calloc(count + 1, sizeof *areas), total = 0.0;
    hemi_mesh_desc mesh;
    for (uint32_t i = 0; levels && areas && i < count; i++) {
        gltf_asset_mesh(asset, i, &mesh);
        areas[i] = gltf_asset_mesh_is_lamp(asset, i) ? 0.0 : world_area(&mesh);
        total += areas[i];
    }
    double size = o->bake.element_size > 0.0 ? o->bake.element_size : sqrt(total / element_count(o));
    for (uint32_t i = 0; levels && areas && i < count; i++)
        if (gltf_asset_mesh_level_is_auto(asset, i) && gltf_asset_mesh(asset, i, &mesh))
            levels[i] = level_for(&mesh, areas[i], size);
    if (levels && areas) lower_to_room(asset, levels);
    if (!areas) {
        free(levels);
        levels = NULL;
    }
    free(areas);
    return levels;
}
