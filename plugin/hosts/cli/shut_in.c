/* SPDX-License-Identifier: MIT
 * See shut_in.h. What lets any light through is taken as open, and what is black as white: nothing is said of which it
 * is not sure that light stays.
 */
#include "shut_in.h"

#include "geometry/area_share.h"
#include "geometry/even_points.h"
#include "geometry/light_walk.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Paths from a lamp, and from all surfaces; fewer of each of very many lamps, but so many. */
enum { LAMP_WALKS = 64, LAMP_WALKS_LEAST = 8, WALKS_OF_ALL = 1 << 18, SURFACE_WALKS = 512 };

/* What surrounds a lamp closely is nowhere wider, m, or than a share of the scene, so that no room of a small model is
 * a housing; and it is not most of the scene. */
static const double HOUSING_WIDTH = 0.7, HOUSING_SHARE = 0.2, HOUSING_PART = 0.75;

/* Of the ways out of what is shut, those past one mesh: it is that which shuts the rest in. Of all else a share may
 * poke out, as legs do through a floor. */
static const double ONE_MESH = 0.9, POKING = 0.02;

/* Of the radius: nearer to another mesh a place of the surface is in contact with it, and none of either side. */
static const double CONTACT = 1e-5;

/* A point of a lamp shines that shows this share of what its material emits; a texture may take away the rest. */
static const float SHINING = 0.5f;

static const double WHOLE_TURN = 6.28318530717958648;

typedef struct world {
    const lights_from *from;
    const hemi_mesh_view *views;
    uint32_t mesh_count;
    size_t *first; /* first[mesh]: of its triangles in the tree, which has those that light does not pass */
    triangle_bvh tree;
    bool *own;         /* own[triangle]: of mesh own_mesh */
    uint32_t own_mesh; /* UINT32_MAX: of none */
    double narrow, dark;
} world;

/* ---- the world ----------------------------------------------------------------------------------------------------
 */

/* The triangles of a mesh as the bake has them, or of what was left as it is. */
static void shape_of(const world *w, uint32_t i, hemi_mesh_desc *out) {
    gltf_asset_mesh(w->from->input, i, out);
    if (gltf_asset_mesh_is_left(w->from->input, i)) return;
    out->positions = w->views[i].positions, out->indices = w->views[i].indices;
    out->triangle_count = w->views[i].triangle_count;
}

static bool any(const double rgb[3]) {
    return rgb[0] > 0.0 || rgb[1] > 0.0 || rgb[2] > 0.0;
}

static bool blocks(const world *w, uint32_t i, const hemi_mesh_desc *mesh) {
    const gltf_asset *asset = w->from->input;
    gltf_mesh_steering own = { 0 };
    hemi_material_desc m;
    gltf_asset_material(asset, mesh->material, &m);
    gltf_asset_mesh_steering(asset, i, &own);
    return !own.is_left_out && gltf_asset_mesh_blocks(asset, i) && !gltf_asset_mesh_mask(asset, i) &&
           gltf_asset_mesh_opacity(asset, i) >= 1.0 && !any(m.transmission) && !any(m.diffuse_transmission);
}

static void corners_of(const hemi_mesh_desc *mesh, size_t t, double out[3][3]) {
    bool turned = hemi_transform_determinant(mesh->transform) < 0.0;
    for (size_t k = 0; k < 3; k++) {
        size_t v = mesh->indices[3 * t + (turned && k ? 3 - k : k)];
        hemi_transform_point(mesh->transform, mesh->positions + 3 * v, out[k]);
    }
}

static bool build(world *w) {
    size_t count = 0;
    hemi_mesh_desc mesh;
    w->first = malloc((w->mesh_count + 1) * sizeof *w->first);
    for (uint32_t i = 0; w->first && i < w->mesh_count; i++) {
        shape_of(w, i, &mesh);
        w->first[i] = count;
        if (blocks(w, i, &mesh)) count += mesh.triangle_count;
    }
    if (w->first) w->first[w->mesh_count] = count;
    if (!triangle_bvh_allocate(NULL, count, &w->tree) || !w->first) return false;
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        shape_of(w, i, &mesh);
        for (size_t t = w->first[i]; t < w->first[i + 1]; t++) corners_of(&mesh, t - w->first[i], w->tree.corners[t]);
    }
    w->own = calloc(count + 1, sizeof *w->own);
    bool ok = triangle_bvh_build(NULL, NULL, &w->tree) && w->own;
    w->narrow = fmin(HOUSING_WIDTH, HOUSING_SHARE * 2.0 * w->tree.radius);
    return ok;
}

/* The mesh of a triangle of the tree. */
static uint32_t mesh_of(const world *w, size_t triangle) {
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

static const char *name_of(const world *w, uint32_t i) {
    hemi_mesh_desc mesh;
    gltf_asset_mesh(w->from->input, i, &mesh);
    return mesh.name;
}

static void set_own(world *w, uint32_t mesh) {
    const uint32_t before = w->own_mesh;
    if (before == mesh) return;
    if (before != UINT32_MAX) memset(w->own + w->first[before], false, w->first[before + 1] - w->first[before]);
    memset(w->own + w->first[mesh], true, w->first[mesh + 1] - w->first[mesh]);
    w->own_mesh = mesh;
}

/* Place i of a triangle of a mesh, off its front, and a way from there. False: it is in contact with another mesh. */
static bool leave(world *w, uint32_t mesh, const double corner[3][3], size_t i, double from[3], double direction[3]) {
    double near[3], far[3], normal[3];
    if (!light_walk_start(corner, i, from, direction)) return false;
    triangle_cross(normal, corner[0], corner[1], corner[2]);
    vec3_normalize(normal);
    vec3_add_scaled(near, from, CONTACT * w->tree.radius, normal);
    vec3_add_scaled(far, from, -CONTACT * w->tree.radius, normal);
    set_own(w, mesh);
    return !triangle_bvh_blocks(&w->tree, near, far, w->own);
}

/* ---- lamps --------------------------------------------------------------------------------------------------------
 */

typedef struct lamps {
    size_t count, all;
    int walks;
    name_list shut, by; /* which are shut in, and what was met that is none of them */
} lamps;

static bool is_close(const world *w, const light_walk *walk) {
    double least, diagonal;
    light_walk_edges(walk, &least, &diagonal);
    return diagonal > 0.0 && diagonal <= HOUSING_PART * 2.0 * w->tree.radius;
}

static void add_lamp(const world *w, lamps *l, const char *name, uint32_t own, const light_walk *walk) {
    if (!is_close(w, walk)) return;
    name_list_add(&l->shut, name, 1.0);
    l->count++;
    uint32_t by = mesh_of(w, walk->last);
    if (by != own) name_list_add(&l->by, name_of(w, by), 1.0);
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
        corners_of(mesh, t, p);
        sum += shines(v, t, emission) ? triangle_area(p[0], p[1], p[2]) : 0.0;
        sums[t] = sum;
    }
    return sums;
}

static bool try_mesh(world *w, uint32_t i, lamps *l) {
    const hemi_mesh_view *v = &w->views[i];
    double emission[3] = { 0, 0, 0 };
    hemi_mesh_desc mesh;
    light_walk walk;
    if (gltf_asset_mesh_is_left(w->from->input, i) || v->triangle_count == 0) return true;
    lights_from_emission(w->from, i, emission);
    if (!any(emission)) return true;
    shape_of(w, i, &mesh);
    double *sums = shining_area(v, &mesh, emission);
    if (!sums) return false;
    bool out = !(sums[v->triangle_count - 1] > 0.0);
    light_walk_begin(&walk, &w->tree, w->narrow);
    for (int k = 0; k < l->walks && !out; k++) {
        double p[3][3], from[3], direction[3], share = ((double)k + 0.5) / l->walks;
        size_t t = area_share_find(sums, v->triangle_count, share * sums[v->triangle_count - 1]);
        corners_of(&mesh, t, p);
        out = leave(w, i, (const double(*)[3])p, (size_t)k, from, direction) &&
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

static void try_light(const world *w, const hemi_light_desc *light, lamps *l) {
    light_walk walk;
    if (light->kind == HEMI_LIGHT_DIRECTIONAL || !any(light->intensity)) return;
    light_walk_begin(&walk, &w->tree, w->narrow);
    for (int k = 0; k < l->walks; k++) {
        double direction[3];
        aim(light, (size_t)k, direction);
        if (light_walk_gets_out(&walk, light->position, direction, (uint64_t)k)) return;
    }
    add_lamp(w, l, light->name, UINT32_MAX, &walk);
}

static size_t count_lamps(const world *w) {
    hemi_light_desc light;
    size_t count = 0;
    for (uint32_t i = 0; gltf_asset_light(w->from->asset, i, &light); i++) count++;
    for (uint32_t i = 0, of; i < w->mesh_count; i++) count += lights_from_emits(w->from, i, &of);
    return count;
}

static bool find_lamps(world *w, char line[SHUT_IN_LINE_SIZE]) {
    char names[NAMES_TEXT_SIZE], by[NAMES_TEXT_SIZE];
    hemi_light_desc light;
    lamps l = { .all = count_lamps(w) };
    size_t walks = WALKS_OF_ALL / (l.all + 1);
    l.walks = walks > LAMP_WALKS ? LAMP_WALKS : walks < LAMP_WALKS_LEAST ? LAMP_WALKS_LEAST : (int)walks;
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

/* ---- the sky ------------------------------------------------------------------------------------------------------
 */

/* Start i of SURFACE_WALKS, by area; false: there is none. */
static bool start(world *w, size_t i, size_t *triangle, double from[3], double direction[3]) {
    double share = ((double)i + 0.5) / SURFACE_WALKS;
    *triangle = area_share_find(w->tree.area, w->tree.count, share * triangle_bvh_area(&w->tree));
    uint32_t mesh = mesh_of(w, *triangle);
    return !gltf_asset_mesh_is_left(w->from->input, mesh) &&
           leave(w, mesh, (const double(*)[3])w->tree.corners[*triangle], i, from, direction);
}

/* The mesh that is crossed last on the way out of all. */
static uint32_t outermost(const world *w, const double from[3], const double direction[3]) {
    uint32_t mesh = UINT32_MAX;
    double at[3], to[3], length = 4.2 * w->tree.radius;
    triangle_meeting met;
    vec3_copy(at, from);
    vec3_add_scaled(to, from, length, direction);
    for (int i = 0; i < SURFACE_WALKS && triangle_bvh_meet(&w->tree, at, to, false, NULL, &met); i++) {
        mesh = mesh_of(w, met.triangle);
        double left = vec3_distance(at, to);
        vec3_add_scaled(at, at, met.share * left + 1e-7 * length, direction);
    }
    return mesh;
}

/* A start on a mesh, and the mesh that shuts it in; UINT32_MAX: none does. */
typedef struct way {
    uint32_t mesh, by;
} way;

/* How many there are. */
static size_t find_ways(world *w, way ways[SURFACE_WALKS]) {
    size_t count = 0;
    for (size_t i = 0; i < SURFACE_WALKS; i++) {
        light_walk walk;
        size_t triangle;
        double from[3], direction[3];
        light_walk_begin(&walk, &w->tree, INFINITY);
        if (!start(w, i, &triangle, from, direction)) continue;
        bool out = light_walk_gets_out(&walk, from, direction, i);
        ways[count++] = (way){ mesh_of(w, triangle), out ? UINT32_MAX : outermost(w, from, direction) };
    }
    return count;
}

/* The mesh that shuts in most of what others have. */
static uint32_t most_shutting(const way *ways, size_t count) {
    uint32_t most = UINT32_MAX;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        size_t by_it = 0;
        if (ways[i].by == UINT32_MAX || ways[i].by == ways[i].mesh || ways[i].by == most) continue;
        for (size_t k = 0; k < count; k++) by_it += ways[k].by == ways[i].by && ways[k].mesh != ways[i].by;
        if (by_it > found) found = by_it, most = ways[i].by;
    }
    return most;
}

/* Is all that others have shut in, and by this one? */
static bool shuts_all(const way *ways, size_t count, uint32_t by) {
    size_t others = 0, open = 0, by_it = 0;
    for (size_t i = 0; i < count; i++) {
        if (ways[i].mesh == by) continue;
        others++;
        open += ways[i].by == UINT32_MAX;
        by_it += ways[i].by == by;
    }
    return (double)open <= POKING * (double)others && (double)by_it >= ONE_MESH * (double)(others - open);
}

static const char *sky_asked_for(const world *w, const options *o) {
    hemi_light_desc light;
    hemi_sky_desc sky;
    bool has_sky = o->environment || gltf_asset_sky(w->from->asset, &sky), has_sun = o->sun.is_given;
    for (uint32_t i = 0; gltf_asset_light(w->from->asset, i, &light); i++)
        has_sun = has_sun || light.kind == HEMI_LIGHT_DIRECTIONAL;
    return has_sky && has_sun ? "sun and sky" : has_sky ? "sky" : has_sun ? "sun" : NULL;
}

static void find_sky(world *w, const char *what, char line[SHUT_IN_LINE_SIZE]) {
    way ways[SURFACE_WALKS];
    char names[NAMES_TEXT_SIZE];
    name_list one = { 0 };
    size_t count = find_ways(w, ways);
    uint32_t by = most_shutting(ways, count);
    if (by == UINT32_MAX || !shuts_all(ways, count, by)) return;
    name_list_add(&one, name_of(w, by), 1.0);
    name_list_write(&one, names);
    snprintf(line, SHUT_IN_LINE_SIZE,
             "nothing of the %s gets in: mesh %s is closed around all else; open it, take it away, or, if it shows the "
             "sky, make its material unlit (KHR_materials_unlit)",
             what, names);
}

/* ---- what is dark -------------------------------------------------------------------------------------------------
 */

/* Does a mesh show light where there is any? */
static bool shows_light(const world *w, uint32_t i) {
    hemi_mesh_desc mesh;
    hemi_material_desc material;
    uint32_t of;
    gltf_asset_mesh(w->from->input, i, &mesh);
    gltf_asset_material(w->from->input, mesh.material, &material);
    return any(material.reflectance) && !lights_from_emits(w->from, i, &of);
}

static bool is_dark(const world *w, uint32_t mesh, size_t triangle) {
    const hemi_mesh_view *v = &w->views[mesh];
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            if ((double)v->radiance[3 * (size_t)v->indices[3 * triangle + k] + c] > w->dark) return false;
    return true;
}

static bool is_closed_in(const world *w, size_t i, const double from[3], const double direction[3]) {
    light_walk walk;
    double least, diagonal;
    light_walk_begin(&walk, &w->tree, INFINITY);
    if (light_walk_gets_out(&walk, from, direction, i)) return false;
    light_walk_edges(&walk, &least, &diagonal);
    return least > w->narrow;
}

static void find_dark(world *w, shut_in *out) {
    size_t all = 0, closed = 0;
    for (size_t i = 0; i < SURFACE_WALKS; i++) {
        double from[3], direction[3];
        size_t triangle;
        if (!start(w, i, &triangle, from, direction)) continue;
        uint32_t mesh = mesh_of(w, triangle);
        if (!shows_light(w, mesh)) continue;
        all++;
        if (!is_dark(w, mesh, triangle - w->first[mesh]) || !is_closed_in(w, i, from, direction)) continue;
        closed++;
        name_list_add(&out->dark, name_of(w, mesh), 1.0);
    }
    out->dark_fraction = all ? (double)closed / (double)all : 0.0;
}

bool shut_in_find(const lights_from *from, const hemi_mesh_view *views, double dark, const options *o, shut_in *out) {
    world w = { .from = from,
                .views = views,
                .mesh_count = gltf_asset_mesh_count(from->input),
                .own_mesh = UINT32_MAX,
                .dark = dark };
    const char *sky = sky_asked_for(&w, o);
    *out = (shut_in){ 0 };
    if (o->ao) return true;
    bool ok = build(&w);
    if (ok && triangle_bvh_area(&w.tree) > 0.0) {
        ok = find_lamps(&w, out->lamps);
        if (ok && sky) find_sky(&w, sky, out->sky);
        if (ok) find_dark(&w, out);
    }
    triangle_bvh_free(&w.tree);
    free(w.own);
    free(w.first);
    return ok;
}
