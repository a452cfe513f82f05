/* SPDX-License-Identifier: MIT */
#include "shut_lamps.h"

#include "geometry/area_share.h"
#include "geometry/even_points.h"
#include "geometry/triangle.h"

#include <stdio.h>
#include <stdlib.h>

/* Paths from a lamp; fewer from each of very many, but so many. */
enum { WALKS = 256, WALKS_LEAST = 8, WALKS_OF_ALL = 1 << 16 };

/* What surrounds a lamp closely is not most of the scene. */
static const double HOUSING_PART = 0.75;

/* A point of a lamp shines that shows this share of what its material emits; a texture may take away the rest. */
static const float SHINING = 0.5f;

static const double WHOLE_TURN = 6.28318530717958648;

typedef struct lamps {
    size_t count, all;
    int walks;
    name_list shut, by; /* which are shut in, and what was met that is none of them */
} lamps;

static bool is_close(const shut_world *w, const light_walk *walk) {
    double least, diagonal;
    light_walk_edges(walk, &least, &diagonal);
    return diagonal > 0.0 && diagonal <= HOUSING_PART * 2.0 * w->tree.radius;
}

static void add_lamp(const shut_world *w, lamps *l, const char *name, uint32_t own, const light_walk *walk) {
    if (!is_close(w, walk)) return;
    name_list_add(&l->shut, name, 1.0);
    l->count++;
    uint32_t by = shut_world_mesh(w, walk->last);
    if (by != own) name_list_add(&l->by, shut_world_name(w, by), 1.0);
}

static bool shines(const hemi_mesh_view *v, size_t triangle, const double emission[3]) {
    const float least = SHINING * (float)(emission[0] + emission[1] + emission[2]);
    for (size_t k = 0; k < 3; k++) {
        const float *rgb = v->radiance + 3 * (size_t)v->indices[3 * triangle + k];
        if (rgb[0] + rgb[1] + rgb[2] >= least) return true;
    }
    return false;
}

/* Sums of the area of what shines of a mesh; NULL when out of memory. */
static double *shining_area(const hemi_mesh_view *v, const hemi_mesh_desc *mesh, const double emission[3]) {
    double *sums = malloc((v->triangle_count + 1) * sizeof *sums), sum = 0.0;
    for (size_t t = 0; sums && t < v->triangle_count; t++) {
        double p[3][3];
        shut_world_corners(mesh, t, p);
        sum += shines(v, t, emission) ? triangle_area(p[0], p[1], p[2]) : 0.0;
        sums[t] = sum;
    }
    return sums;
}

static bool try_mesh(shut_world *w, uint32_t i, lamps *l) {
    const hemi_mesh_view *v = &w->views[i];
    double emission[3] = { 0, 0, 0 };
    hemi_mesh_desc mesh;
    light_walk walk;
    if (gltf_asset_mesh_is_left(w->from->input, i) || v->triangle_count == 0) return true;
    lights_from_emission(w->from, i, emission);
    if (!shut_world_any(emission)) return true;
    shut_world_shape(w, i, &mesh);
    double *sums = shining_area(v, &mesh, emission);
    if (!sums) return false;
    bool out = !(sums[v->triangle_count - 1] > 0.0);
    light_walk_begin(&walk, &w->tree, w->narrow);
    for (int k = 0; k < l->walks && !out; k++) {
        double p[3][3], from[3], direction[3], share = ((double)k + 0.5) / l->walks;
        size_t t = area_share_find(sums, v->triangle_count, share * sums[v->triangle_count - 1]);
        shut_world_corners(&mesh, t, p);
        out = shut_world_leave(w, i, (const double(*)[3])p, (size_t)k, from, direction) &&
              light_walk_gets_out(&walk, from, direction, (uint64_t)k);
    }
    free(sums);
    if (!out) add_lamp(w, l, mesh.name, i, &walk);
    return true;
}

/* Direction k of those that a light shines in: evenly over the ball, or over its cone. */
static void aim(const hemi_light_desc *light, size_t k, double out[3]) {
    double axis[3], u[3], v[3], turn = WHOLE_TURN * even_point(k, 1);
    bool is_spot = light->kind == HEMI_LIGHT_SPOT;
    const double up[3] = { 0, 1, 0 };
    vec3_copy(axis, is_spot ? light->direction : up);
    vec3_normalize(axis);
    vec3_tangents(axis, u, v);
    double cone = light->outer_cone > 0.0 ? light->outer_cone : 0.125 * WHOLE_TURN;
    double cosine = 1.0 - even_point(k, 0) * (is_spot ? 1.0 - cos(cone) : 2.0),
           sine = sqrt(fmax(1.0 - cosine * cosine, 0.0));
    for (int c = 0; c < 3; c++) out[c] = cosine * axis[c] + sine * (cos(turn) * u[c] + sin(turn) * v[c]);
}

static void try_light(const shut_world *w, const hemi_light_desc *light, lamps *l) {
    light_walk walk;
    if (light->kind == HEMI_LIGHT_DIRECTIONAL || !shut_world_any(light->intensity)) return;
    light_walk_begin(&walk, &w->tree, w->narrow);
    for (int k = 0; k < l->walks; k++) {
        double direction[3];
        aim(light, (size_t)k, direction);
        if (light_walk_gets_out(&walk, light->position, direction, (uint64_t)k)) return;
    }
    add_lamp(w, l, light->name, UINT32_MAX, &walk);
}

static size_t count_lamps(const shut_world *w) {
    hemi_light_desc light;
    size_t count = 0;
    for (uint32_t i = 0; gltf_asset_light(w->from->asset, i, &light); i++) count++;
    for (uint32_t i = 0, of; i < w->mesh_count; i++) count += lights_from_emits(w->from, i, &of);
    return count;
}

bool shut_lamps_find(shut_world *w, char line[SHUT_IN_LINE_SIZE]) {
    char names[NAMES_TEXT_SIZE], by[NAMES_TEXT_SIZE];
    hemi_light_desc light;
    lamps l = { .all = count_lamps(w) };
    size_t walks = WALKS_OF_ALL / (l.all + 1);
    l.walks = walks > WALKS ? WALKS : walks < WALKS_LEAST ? WALKS_LEAST : (int)walks;
    for (uint32_t i = 0; i < w->mesh_count; i++)
        if (!try_mesh(w, i, &l)) return false;
    for (uint32_t i = 0; gltf_asset_light(w->from->asset, i, &light); i++) try_light(w, &light, &l);
    name_list_write(&l.shut, names);
    name_list_write(&l.by, by);
    if (l.count > 0)
        snprintf(
            line, SHUT_IN_LINE_SIZE,
            "%zu of %zu lamps light%s nothing but what closely surrounds %s: %s%s%s; open what shuts %s in, let it "
            "transmit light, or take it away",
            l.count, l.all, l.count == 1 ? "s" : "", l.count == 1 ? "it" : "them", names,
            l.by.count ? ", in mesh " : "", by, l.count == 1 ? "it" : "them");
    return true;
}
