/* SPDX-License-Identifier: MIT
 * See seen_points.h. Rays walk the triangles that the bake writes.
 */
#include "seen_points.h"

#include "geometry/area_share.h"
#include "geometry/even_points.h"
#include "geometry/triangle.h"
#include "geometry/triangle_bvh.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays from surfaces, and across and down a picture: a share of 2 % of the area is then known to a fifth of itself. */
enum { SURFACE_RAYS = 4096, PICTURE_COLUMNS = 64, PICTURE_ROWS = 48, CAMERAS_MAX = 8 };
enum { PICTURE_RAYS = PICTURE_COLUMNS * PICTURE_ROWS, RAYS_A_JOB = 64 };

/* Fewer are done before threads have started. */
enum { MANY_TRIANGLES = 1 << 14 };

/* A ray starts so far off its surface, in radii of the scene: above the roundings of float positions. */
static const double LIFT = 1e-5;

/* A point of an emitting material that shows less than this share of the material's emission shows its texture's dark
 * part, and what is reflected there. */
static const double EMITTING_SHARE = 0.5;

typedef struct world_triangle {
    uint32_t mesh, triangle;
    bool turned; /* by a mirroring transform: corners 1 and 2 are changed about */
} world_triangle;

typedef struct world {
    const seen_mesh *meshes;
    size_t *first; /* first[mesh]: its first triangle */
    world_triangle *triangles;
    triangle_bvh tree;
    jobs *jobs; /* NULL: this thread does it all */
} world;

/* ---- the world ---- */

static size_t count_triangles(const seen_mesh *meshes, size_t mesh_count) {
    size_t count = 0;
    for (size_t i = 0; i < mesh_count; i++) count += meshes[i].triangle_count;
    return count;
}

static void add_mesh(void *user, size_t mesh, unsigned worker) {
    world *w = user;
    const seen_mesh *m = &w->meshes[mesh];
    bool turned = hemi_transform_determinant(m->transform) < 0.0;
    (void)worker;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            uint32_t v = m->indices[3 * (size_t)t + (size_t)(turned && k ? 3 - k : k)];
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)v, w->tree.corners[w->first[mesh] + t][k]);
        }
        w->triangles[w->first[mesh] + t] = (world_triangle){ (uint32_t)mesh, t, turned };
    }
}

static bool build(world *w, const seen_mesh *meshes, size_t mesh_count, unsigned threads) {
    size_t count = count_triangles(meshes, mesh_count), first = 0;
    *w = (world){ .meshes = meshes,
                  .first = malloc((mesh_count + 1) * sizeof *w->first),
                  .triangles = malloc((count + 1) * sizeof *w->triangles),
                  .jobs = count < MANY_TRIANGLES ? NULL : jobs_create(threads) };
    if (!triangle_bvh_allocate(NULL, count, &w->tree) || !w->first || !w->triangles) return false;
    for (size_t i = 0; i < mesh_count; first += meshes[i++].triangle_count) w->first[i] = first;
    jobs_run(w->jobs, mesh_count, add_mesh, NULL, w);
    return triangle_bvh_build(NULL, w->jobs, &w->tree);
}

static void destroy(world *w) {
    jobs_destroy(w->jobs);
    free(w->first);
    free(w->triangles);
    triangle_bvh_free(&w->tree);
}

/* ---- rays ---- */

/* Metres to the front that is met; negative: none. */
static double trace(const world *w, const double from[3], const double direction[3], double length,
                    triangle_meeting *met) {
    double to[3];
    vec3_add_scaled(to, from, length, direction);
    return triangle_bvh_meet(&w->tree, from, to, true, NULL, met) ? met->share * length : -1.0;
}

static seen_point point_at(const world *w, size_t index, const double weights[3], double weight, seen_from from) {
    const world_triangle *t = &w->triangles[index];
    const seen_mesh *m = &w->meshes[t->mesh];
    const float *light = m->light ? m->light : m->radiance;
    seen_point out = { .weight = (float)weight, .area = from != SEEN_FROM_AFAR, .from = from };
    for (int k = 0; k < 3; k++) {
        size_t v = m->indices[3 * (size_t)t->triangle + (size_t)(t->turned && k ? 3 - k : k)];
        for (size_t c = 0; c < 3; c++) {
            out.radiance[c] += (float)weights[k] * m->radiance[3 * v + c];
            out.light[c] += (float)weights[k] * light[3 * v + c];
        }
    }
    const float emission[3] = { (float)m->emission[0], (float)m->emission[1], (float)m->emission[2] };
    double emitted = luminance(emission);
    out.emits = emitted > 0.0 && luminance(out.radiance) >= EMITTING_SHARE * emitted;
    return out;
}

/* Rays of a camera (NULL: of surfaces) that any thread may follow; what they find is taken in their order. */
typedef struct looking {
    const world *w;
    const seen_camera *camera;
    seen_from place; /* of the camera */
    double dark;     /* of surfaces: what is darker at the other end is not looked from */
    seen_point *found;
    bool *is_seen; /* found[ray] is */
} looking;

/* ---- from the scene's own surfaces ---- */

static bool look_from_surface(const looking *l, size_t i, seen_point *out) {
    const world *w = l->w;
    size_t index =
        area_share_find(w->tree.area, w->tree.count, ((double)i + 0.5) / SURFACE_RAYS * triangle_bvh_area(&w->tree));
    const double(*p)[3] = w->tree.corners[index];
    double weights[3], from[3] = { 0, 0, 0 }, normal[3], direction[3];
    even_weights(weights, even_point(i, 0), even_point(i, 1));
    triangle_cross(normal, p[0], p[1], p[2]);
    if (!(vec3_normalize(normal) > 0.0)) return false;
    for (int k = 0; k < 3; k++) vec3_add_scaled(from, from, weights[k], p[k]);
    vec3_add_scaled(from, from, LIFT * w->tree.radius, normal);
    even_direction(direction, normal, even_point(i, 2), even_point(i, 3));
    triangle_meeting met;
    double t = trace(w, from, direction, 2.1 * w->tree.radius, &met);
    *out = point_at(w, index, weights, t < 0.0 ? 1.0 : t, t < 0.0 ? SEEN_FROM_OUTSIDE : SEEN_FROM_INSIDE);
    if (t < 0.0) return true;
    seen_point other = point_at(w, met.triangle, met.weights, t, SEEN_FROM_INSIDE);
    return luminance(other.radiance) > l->dark;
}

/* ---- from a camera ---- */

/* Ray i of a grid over the picture. */
static bool look_from_camera(const looking *l, size_t i, seen_point *out) {
    const world *w = l->w;
    const seen_camera *c = l->camera;
    double forward[3], right[3], up[3], half = c->yfov > 0.0 ? tan(0.5 * c->yfov) : c->ymag;
    vec3_sub(forward, c->target, c->eye);
    vec3_normalize(forward);
    vec3_cross(right, forward, c->up);
    if (!(vec3_normalize(right) > 0.0)) vec3_tangents(forward, right, up);
    vec3_cross(up, right, forward);
    double length = 2.1 * w->tree.radius + vec3_distance(c->eye, w->tree.center);
    double s = c->aspect * half * (2 * ((double)(i % PICTURE_COLUMNS) + 0.5) / PICTURE_COLUMNS - 1);
    double t = half * (2 * ((double)(i / PICTURE_COLUMNS) + 0.5) / PICTURE_ROWS - 1), from[3], direction[3];
    vec3_copy(from, c->eye), vec3_copy(direction, forward);
    vec3_add_scaled(c->yfov > 0.0 ? direction : from, c->yfov > 0.0 ? direction : from, s, right);
    vec3_add_scaled(c->yfov > 0.0 ? direction : from, c->yfov > 0.0 ? direction : from, t, up);
    vec3_normalize(direction);
    triangle_meeting met;
    if (trace(w, from, direction, length, &met) < 0.0) return false;
    *out = point_at(w, met.triangle, met.weights, 1.0, l->place);
    return true;
}

static void follow_rays(void *user, size_t item, unsigned worker) {
    const looking *l = user;
    (void)worker;
    for (size_t i = item * RAYS_A_JOB; i < (item + 1) * RAYS_A_JOB; i++)
        l->is_seen[i] = l->camera ? look_from_camera(l, i, &l->found[i]) : look_from_surface(l, i, &l->found[i]);
}

/* Appends what they see. */
static void follow(looking *l, size_t rays, seen_points *out) {
    jobs_run(l->w->jobs, rays / RAYS_A_JOB, follow_rays, NULL, l);
    for (size_t i = 0; i < rays; i++)
        if (l->is_seen[i]) out->points[out->count++] = l->found[i];
}

/* Where the preview stands, far away. */
static seen_camera afar(const world *w) {
    const double forward[3] = { -0.22, -0.16, -1.0 };
    seen_camera c = { .up = { 0, 1, 0 }, .ymag = w->tree.radius, .aspect = 1.0 };
    vec3_copy(c.target, w->tree.center);
    vec3_add_scaled(c.eye, w->tree.center, -2.0 * w->tree.radius, forward);
    return c;
}

/* Luminance that is as good as none: sixteen stops below the brightest of what does not emit. */
static double darkness(const world *w, size_t mesh_count) {
    double brightest = 0.0;
    for (size_t i = 0; i < mesh_count; i++) {
        const seen_mesh *m = &w->meshes[i];
        if (!vec3_is_zero(m->emission)) continue;
        for (size_t k = 0; k < 3 * (size_t)m->triangle_count; k++)
            brightest = fmax(brightest, luminance(m->radiance + 3 * (size_t)m->indices[k]));
    }
    return brightest * 0x1p-16;
}

static bool shows_light(const seen_points *f, double dark) {
    for (size_t i = 0; i < f->count; i++)
        if (luminance(f->points[i].radiance) > dark) return true;
    return false;
}

static void look(looking *l, size_t mesh_count, const seen_camera *cameras, size_t camera_count, seen_points *out) {
    const seen_camera far = afar(l->w);
    l->dark = darkness(l->w, mesh_count);
    for (size_t i = 0; i < camera_count && i < CAMERAS_MAX; i++) {
        l->camera = &cameras[i], l->place = SEEN_FROM_CAMERA;
        follow(l, PICTURE_RAYS, out);
    }
    if (shows_light(out, l->dark)) return;
    out->cameras_are_dark = out->count > 0;
    out->count = 0;
    l->camera = &far, l->place = SEEN_FROM_AFAR;
    follow(l, PICTURE_RAYS, out);
    l->camera = NULL;
    follow(l, SURFACE_RAYS, out);
}

bool seen_points_find(const seen_mesh *meshes, size_t mesh_count, const seen_camera *cameras, size_t camera_count,
                      unsigned threads, seen_points *out) {
    world w;
    looking l = { .w = &w,
                  .found = malloc(SURFACE_RAYS * sizeof *l.found),
                  .is_seen = malloc(SURFACE_RAYS * sizeof *l.is_seen) };
    *out = (seen_points){ .points = malloc((CAMERAS_MAX * PICTURE_RAYS + SURFACE_RAYS) * sizeof *out->points) };
    bool ok = build(&w, meshes, mesh_count, threads) && out->points && l.found && l.is_seen;
    if (ok && triangle_bvh_area(&w.tree) > 0.0) look(&l, mesh_count, cameras, camera_count, out);
    destroy(&w);
    free(l.found);
    free(l.is_seen);
    if (ok) return true;
    free(out->points);
    *out = (seen_points){ 0 };
    return false;
}
