/* SPDX-License-Identifier: MIT
 * See shut_in.h. What lets any light through is taken as open, and what is black as white: nothing is said of which it
 * is not sure that light stays.
 */
#include "shut_in.h"

#include "geometry/area_share.h"
#include "geometry/even_points.h"
#include "geometry/triangle.h"
#include "geometry/vec3.h"
#include "shut_lamps.h"
#include "shut_world.h"

#include <math.h>
#include <stdio.h>

/* Places all over the surfaces, and what is looked for from each of them where no way out was found. */
enum { PLACES = 256, LOOKS = 256 };

/* Of the ways out of what is shut, those past one mesh at least: it is that which shuts the rest in, beside rugs and
 * pictures that lie on it. Of all else a share may poke out, as legs do through a floor. */
static const double ONE_MESH = 0.5, POKING = 0.02;

/* Of the looks of a place: more of them go past all where it is outside, fewer where there is a small window. */
static const double OUTSIDE = 0.1;

/* ---- places -------------------------------------------------------------------------------------------------------
 */

/* A place on a mesh, and which mesh shuts it in; UINT32_MAX: none does. */
typedef struct place {
    uint32_t mesh, by;
    size_t number;
    double from[3], normal[3], direction[3];
    double width; /* m, of where it is shut in */
    bool is_dark, shows_light;
} place;

/* The mesh that is crossed last on the way out of all. */
static uint32_t outermost(const shut_world *w, const place *p) {
    uint32_t mesh = UINT32_MAX;
    double at[3], to[3], length = 4.2 * w->tree.radius;
    triangle_meeting met;
    vec3_copy(at, p->from);
    vec3_add_scaled(to, p->from, length, p->direction);
    for (int i = 0; i < PLACES && triangle_bvh_meet(&w->tree, at, to, false, NULL, &met); i++) {
        mesh = shut_world_mesh(w, met.triangle);
        double left = vec3_distance(at, to);
        vec3_add_scaled(at, at, met.share * left + 1e-7 * length, p->direction);
    }
    return mesh;
}

/* Does a mesh show light where there is any? */
static bool shows_light(const shut_world *w, uint32_t i) {
    hemi_mesh_desc mesh;
    hemi_material_desc material;
    uint32_t of;
    gltf_asset_mesh(w->from->input, i, &mesh);
    gltf_asset_material(w->from->input, mesh.material, &material);
    return shut_world_any(material.reflectance) && !lights_from_emits(w->from, i, &of);
}

static bool is_dark(const shut_world *w, uint32_t mesh, size_t triangle) {
    const hemi_mesh_view *v = &w->views[mesh];
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            if ((double)v->radiance[3 * (size_t)v->indices[3 * triangle + k] + c] > w->dark) return false;
    return true;
}

/* Evenly by area, how many there are. */
static size_t find_places(shut_world *w, place places[PLACES]) {
    size_t count = 0;
    for (size_t i = 0; i < PLACES; i++) {
        place *p = &places[count];
        double share = ((double)i + 0.5) / PLACES;
        size_t triangle = area_share_find(w->tree.area, w->tree.count, share * triangle_bvh_area(&w->tree));
        *p = (place){ .mesh = shut_world_mesh(w, triangle), .by = UINT32_MAX, .number = i };
        const double(*corner)[3] = (const double(*)[3])w->tree.corners[triangle];
        if (gltf_asset_mesh_is_left(w->from->input, p->mesh) ||
            !shut_world_leave(w, p->mesh, corner, i, p->from, p->direction))
            continue;
        triangle_cross(p->normal, corner[0], corner[1], corner[2]);
        vec3_normalize(p->normal);
        p->is_dark = is_dark(w, p->mesh, triangle - w->first[p->mesh]);
        p->shows_light = shows_light(w, p->mesh);
        count++;
    }
    return count;
}

static void follow(const shut_world *w, place *p) {
    light_walk walk;
    double diagonal;
    light_walk_begin(&walk, &w->tree, INFINITY);
    if (light_walk_gets_out(&walk, p->from, p->direction, p->number)) return;
    light_walk_edges(&walk, &p->width, &diagonal);
    p->by = outermost(w, p);
}

/* ---- the sky ------------------------------------------------------------------------------------------------------
 */

/* Is all that others have shut in, and mostly by this one? */
static bool shuts_all(const place *places, size_t count, uint32_t by) {
    size_t others = 0, open = 0, by_it = 0;
    for (size_t i = 0; i < count; i++) {
        if (places[i].mesh == by) continue;
        others++;
        open += places[i].by == UINT32_MAX;
        by_it += places[i].by == by;
    }
    return (double)open <= POKING * (double)others && (double)by_it >= ONE_MESH * (double)(others - open);
}

static const char *sky_asked_for(const shut_world *w, const options *o) {
    hemi_light_desc light;
    hemi_sky_desc sky;
    bool has_sky = o->environment || gltf_asset_sky(w->from->asset, &sky), has_sun = o->sun.is_given;
    for (uint32_t i = 0; gltf_asset_light(w->from->asset, i, &light); i++)
        has_sun = has_sun || light.kind == HEMI_LIGHT_DIRECTIONAL;
    return has_sky && has_sun ? "sun and sky" : has_sky ? "sky" : has_sun ? "sun" : NULL;
}

/* The mesh that does so; UINT32_MAX: none. */
static uint32_t find_shutting(const place *places, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const uint32_t by = places[i].by;
        if (by != UINT32_MAX && by != places[i].mesh && shuts_all(places, count, by)) return by;
    }
    return UINT32_MAX;
}

/* How many looks from a place go past all. */
static size_t count_past(const shut_world *w, const place *p) {
    size_t past = 0;
    const double length = 4.2 * w->tree.radius;
    for (size_t i = 0; i < LOOKS; i++) {
        double direction[3], to[3];
        even_direction(direction, p->normal, even_point(i, 0), even_point(i, 1));
        vec3_add_scaled(to, p->from, length, direction);
        past += !triangle_bvh_blocks(&w->tree, p->from, to, NULL);
    }
    return past;
}

/* Does any place that is not outside see out? */
static bool has_window(const shut_world *w, const place *places, size_t count, uint32_t by) {
    for (size_t i = 0; i < count; i++) {
        if (places[i].mesh == by) continue;
        size_t past = count_past(w, &places[i]);
        bool any = past > 0 || places[i].by == UINT32_MAX;
        if (any && (double)past < OUTSIDE * LOOKS) return true;
    }
    return false;
}

static void judge_sky(const shut_world *w, const place *places, size_t count, const char *what,
                      char line[SHUT_IN_LINE_SIZE]) {
    char names[NAMES_TEXT_SIZE];
    name_list one = { 0 };
    uint32_t by = find_shutting(places, count);
    if (by == UINT32_MAX || has_window(w, places, count, by)) return;
    name_list_add(&one, shut_world_name(w, by), 1.0);
    name_list_write(&one, names);
    snprintf(line, SHUT_IN_LINE_SIZE,
             "nothing of the %s gets in: mesh %s is closed around all else; open it, take it away, or, if it shows the "
             "sky, make its material unlit (KHR_materials_unlit)",
             what, names);
}

/* ---- what is dark -------------------------------------------------------------------------------------------------
 */

/* Of those that show light. */
static double dark_share(const place *places, size_t count) {
    size_t dark = 0, all = 0;
    for (size_t i = 0; i < count; i++) all += places[i].shows_light, dark += places[i].shows_light && places[i].is_dark;
    return all ? (double)dark / (double)all : 0.0;
}

static void judge_dark(const shut_world *w, const place *places, size_t count, shut_in *out) {
    size_t all = 0, closed = 0;
    for (size_t i = 0; i < count; i++) {
        const place *p = &places[i];
        if (!p->shows_light) continue;
        all++;
        if (!p->is_dark || p->by == UINT32_MAX || !(p->width > w->narrow)) continue;
        closed++;
        name_list_add(&out->dark, shut_world_name(w, p->mesh), 1.0);
    }
    out->dark_fraction = all ? (double)closed / (double)all : 0.0;
}

/* Where few are dark and no sky was asked for nobody is to know which are shut in. */
static void judge_places(shut_world *w, const char *sky, shut_in *out) {
    place places[PLACES];
    size_t count = find_places(w, places);
    if (!sky && dark_share(places, count) < 0.5) return;
    for (size_t i = 0; i < count; i++) follow(w, &places[i]);
    if (sky) judge_sky(w, places, count, sky, out->sky);
    judge_dark(w, places, count, out);
}

bool shut_in_find(const lights_from *from, const hemi_mesh_view *views, double dark, const options *o, shut_in *out) {
    shut_world w = { .from = from,
                     .views = views,
                     .mesh_count = gltf_asset_mesh_count(from->input),
                     .own_mesh = UINT32_MAX,
                     .dark = dark };
    *out = (shut_in){ 0 };
    if (o->ao) return true;
    bool ok = shut_world_build(&w);
    if (ok && triangle_bvh_area(&w.tree) > 0.0) {
        ok = shut_lamps_find(&w, out->lamps);
        if (ok) judge_places(&w, sky_asked_for(&w, o), out);
    }
    shut_world_free(&w);
    return ok;
}
