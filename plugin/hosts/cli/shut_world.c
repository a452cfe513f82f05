/* SPDX-License-Identifier: MIT */
#include "shut_world.h"

#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <stdlib.h>
#include <string.h>

/* What surrounds a lamp closely is nowhere wider, m, or than a share of the scene, so that no room of a small model is
 * a housing. */
static const double HOUSING_WIDTH = 0.7, HOUSING_SHARE = 0.2;

/* Of the radius: nearer to another mesh a place of the surface is in contact with it, and none of either side. */
static const double CONTACT = 1e-5;

void shut_world_shape(const shut_world *w, uint32_t i, hemi_mesh_desc *out) {
    gltf_asset_mesh(w->from->input, i, out);
    if (gltf_asset_mesh_is_left(w->from->input, i)) return;
    out->positions = w->views[i].positions, out->indices = w->views[i].indices;
    out->triangle_count = w->views[i].triangle_count;
}

static bool blocks(const shut_world *w, uint32_t i, const hemi_mesh_desc *mesh) {
    const gltf_asset *asset = w->from->input;
    gltf_mesh_steering own = { 0 };
    hemi_material_desc m;
    gltf_asset_material(asset, mesh->material, &m);
    gltf_asset_mesh_steering(asset, i, &own);
    return !own.is_left_out && gltf_asset_mesh_blocks(asset, i) && !gltf_asset_mesh_mask(asset, i) &&
           gltf_asset_mesh_opacity(asset, i) >= 1.0 && !shut_world_any(m.transmission) &&
           !shut_world_any(m.diffuse_transmission);
}

void shut_world_corners(const hemi_mesh_desc *mesh, size_t t, double out[3][3]) {
    bool turned = hemi_transform_determinant(mesh->transform) < 0.0;
    for (size_t k = 0; k < 3; k++) {
        size_t v = mesh->indices[3 * t + (turned && k ? 3 - k : k)];
        hemi_transform_point(mesh->transform, mesh->positions + 3 * v, out[k]);
    }
}

bool shut_world_build(shut_world *w) {
    size_t count = 0;
    hemi_mesh_desc mesh;
    w->first = malloc((w->mesh_count + 1) * sizeof *w->first);
    for (uint32_t i = 0; w->first && i < w->mesh_count; i++) {
        shut_world_shape(w, i, &mesh);
        w->first[i] = count;
        if (blocks(w, i, &mesh)) count += mesh.triangle_count;
    }
    if (w->first) w->first[w->mesh_count] = count;
    if (!triangle_bvh_allocate(NULL, count, &w->tree) || !w->first) return false;
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        shut_world_shape(w, i, &mesh);
        for (size_t t = w->first[i]; t < w->first[i + 1]; t++)
            shut_world_corners(&mesh, t - w->first[i], w->tree.corners[t]);
    }
    w->own = calloc(count + 1, sizeof *w->own);
    bool ok = triangle_bvh_build(NULL, NULL, &w->tree) && w->own;
    w->narrow = fmin(HOUSING_WIDTH, HOUSING_SHARE * 2.0 * w->tree.radius);
    return ok;
}

uint32_t shut_world_mesh(const shut_world *w, size_t triangle) {
    uint32_t low = 0, high = w->mesh_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (w->first[middle] <= triangle)
            low = middle;
        else
            high = middle;
    }
    return low;
}

const char *shut_world_name(const shut_world *w, uint32_t i) {
    hemi_mesh_desc mesh;
    gltf_asset_mesh(w->from->input, i, &mesh);
    return mesh.name;
}

static void set_own(shut_world *w, uint32_t mesh) {
    const uint32_t before = w->own_mesh;
    if (before == mesh) return;
    if (before != UINT32_MAX) memset(w->own + w->first[before], false, w->first[before + 1] - w->first[before]);
    memset(w->own + w->first[mesh], true, w->first[mesh + 1] - w->first[mesh]);
    w->own_mesh = mesh;
}

bool shut_world_leave(shut_world *w, uint32_t mesh, const double corner[3][3], size_t i, double from[3],
                      double direction[3]) {
    double near[3], far[3], normal[3];
    if (!light_walk_start(corner, i, from, direction)) return false;
    triangle_cross(normal, corner[0], corner[1], corner[2]);
    vec3_normalize(normal);
    vec3_add_scaled(near, from, CONTACT * w->tree.radius, normal);
    vec3_add_scaled(far, from, -CONTACT * w->tree.radius, normal);
    set_own(w, mesh);
    return !triangle_bvh_blocks(&w->tree, near, far, w->own);
}

void shut_world_free(shut_world *w) {
    triangle_bvh_free(&w->tree);
    free(w->own);
    free(w->first);
}
