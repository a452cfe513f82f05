/* SPDX-License-Identifier: MIT
 * See seen_points.h. Rays walk a tree of boxes around the triangles that the bake writes.
 */
#include "seen_points.h"

#include "geometry/area_share.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Rays from surfaces, and across and down a picture: a share of 2 % of the area is then known to a fifth of itself. */
enum { SURFACE_RAYS = 4096, PICTURE_COLUMNS = 64, PICTURE_ROWS = 48, CAMERAS_MAX = 8 };

/* A ray starts so far off its surface, in radii of the scene: above the roundings of float positions. */
static const double LIFT = 1e-5;

/* A point of an emitting material that shows less than this share of the material's emission shows its texture's dark
 * part, and what is reflected there. */
static const double EMITTING_SHARE = 0.5;

typedef struct world_triangle {
    double corner[3][3];
    uint32_t mesh, triangle;
    bool turned; /* by a mirroring transform: corners 1 and 2 are changed about */
} world_triangle;

typedef struct world {
    const seen_mesh *meshes;
    world_triangle *triangles;
    double *area; /* of the triangles up to and with this one */
    size_t count;
    bvh tree;
    bvh_box *boxes;
    double center[3], radius;
} world;

typedef struct ray {
    const world *w;
    double from[3], step[3]; /* to the ray's far end */
    double nearest;          /* of step */
    size_t hit;
    double weights[3];
} ray;

/* ---- the world ---- */

static size_t count_triangles(const seen_mesh *meshes, size_t mesh_count) {
    size_t count = 0;
    for (size_t i = 0; i < mesh_count; i++) count += meshes[i].triangle_count;
    return count;
}

static void add_mesh(world *w, uint32_t mesh) {
    const seen_mesh *m = &w->meshes[mesh];
    bool turned = hemi_transform_determinant(m->transform) < 0.0;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        world_triangle *out = &w->triangles[w->count];
        for (int k = 0; k < 3; k++) {
            uint32_t v = m->indices[3 * (size_t)t + (size_t)(turned && k ? 3 - k : k)];
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)v, out->corner[k]);
        }
        out->mesh = mesh, out->triangle = t, out->turned = turned;
        w->area[w->count] =
            (w->count ? w->area[w->count - 1] : 0.0) + triangle_area(out->corner[0], out->corner[1], out->corner[2]);
        bvh_box_set(&w->boxes[w->count], (uint32_t)w->count, out->corner, 3, 0.0);
        w->count++;
    }
}

static void set_sphere(world *w) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t t = 0; t < w->count; t++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                low[k] = fmin(low[k], w->triangles[t].corner[i][k]);
                high[k] = fmax(high[k], w->triangles[t].corner[i][k]);
            }
    vec3_mid(w->center, low, high);
    w->radius = 0.5 * vec3_distance(low, high);
}

static bool build(world *w, const seen_mesh *meshes, size_t mesh_count) {
    size_t count = count_triangles(meshes, mesh_count);
    *w = (world){ .meshes = meshes };
    w->triangles = malloc((count + 1) * sizeof *w->triangles);
    w->area = malloc((count + 1) * sizeof *w->area);
    w->boxes = malloc((count + 1) * sizeof *w->boxes);
    w->tree.nodes = malloc(2 * (count + 1) * sizeof *w->tree.nodes);
    w->tree.items = malloc((count + 1) * sizeof *w->tree.items);
    if (!w->triangles || !w->area || !w->boxes || !w->tree.nodes || !w->tree.items) return false;
    for (size_t i = 0; i < mesh_count; i++) add_mesh(w, (uint32_t)i);
    if (w->count == 0) return true;
    set_sphere(w);
    bvh_build(&w->tree, w->boxes, w->count);
    return true;
}

static void destroy(world *w) {
    free(w->triangles);
    free(w->area);
    free(w->boxes);
    free(w->tree.nodes);
    free(w->tree.items);
}

/* ---- rays ---- */

/* Fronts alone are met. */
static void meet(ray *r, uint32_t item) {
    const world_triangle *t = &r->w->triangles[item];
    double u[3], v[3], n[3], to[3], q[3];
    vec3_sub(u, t->corner[1], t->corner[0]);
    vec3_sub(v, t->corner[2], t->corner[0]);
    vec3_cross(n, u, v);
    vec3_sub(to, r->from, t->corner[0]);
    double toward = -vec3_dot(n, r->step);
    if (!(toward > 0.0)) return;
    double s = vec3_dot(to, n) / toward;
    vec3_cross(q, to, r->step);
    double b = vec3_dot(v, q) / toward, c = -vec3_dot(u, q) / toward;
    if (s < 0.0 || s >= r->nearest || b < 0.0 || c < 0.0 || b + c > 1.0) return;
    r->nearest = s, r->hit = item;
    r->weights[0] = 1.0 - b - c, r->weights[1] = b, r->weights[2] = c;
}

static bool look_at(void *user, const uint32_t *items, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) meet(user, items[i]);
    return false;
}

/* Metres to the front that is met; negative: none. */
static double trace(const world *w, const double from[3], const double direction[3], double length, ray *r) {
    double to[3];
    *r = (ray){ .w = w, .nearest = INFINITY };
    vec3_copy(r->from, from);
    vec3_add_scaled(to, from, length, direction);
    vec3_sub(r->step, to, from);
    bvh_segment(&w->tree, from, to, look_at, r);
    return r->nearest <= 1.0 ? r->nearest * length : -1.0;
}

static double luminance(const float rgb[3]) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
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

/* ---- from the scene's own surfaces ---- */

/* The k-th coordinate of point i of a sequence that fills the unit cube of four dimensions evenly: multiples of powers
 * of 1/g, g^5 = g + 1. */
static double even(size_t i, int k) {
    static const double steps[4] = { 0.85667488385450288, 0.73389185662146350, 0.62870672103799270,
                                     0.53859725722361160 };
    double x = 0.5 + steps[k] * (double)(i + 1);
    return x - floor(x);
}

/* Leaves the surface by the cosine. */
static void set_direction(double out[3], const double normal[3], double a, double b) {
    double u[3], v[3], radius = sqrt(a), turn = 2 * PI * b;
    vec3_tangents(normal, u, v);
    for (int k = 0; k < 3; k++) out[k] = sqrt(1 - a) * normal[k];
    vec3_add_scaled(out, out, radius * cos(turn), u);
    vec3_add_scaled(out, out, radius * sin(turn), v);
}

static void look_from_surface(const world *w, size_t i, double dark, seen_points *out) {
    size_t index = area_share_find(w->area, w->count, ((double)i + 0.5) / SURFACE_RAYS * w->area[w->count - 1]);
    const double(*p)[3] = w->triangles[index].corner;
    double weights[3], from[3] = { 0, 0, 0 }, normal[3], direction[3], root = sqrt(even(i, 0));
    weights[0] = 1 - root, weights[1] = root * (1 - even(i, 1)), weights[2] = root * even(i, 1);
    triangle_cross(normal, p[0], p[1], p[2]);
    if (!(vec3_normalize(normal) > 0.0)) return;
    for (int k = 0; k < 3; k++) vec3_add_scaled(from, from, weights[k], p[k]);
    vec3_add_scaled(from, from, LIFT * w->radius, normal);
    set_direction(direction, normal, even(i, 2), even(i, 3));
    ray r;
    double t = trace(w, from, direction, 2.1 * w->radius, &r);
    if (t < 0.0) {
        out->points[out->count++] = point_at(w, index, weights, 1.0, SEEN_FROM_OUTSIDE);
        return;
    }
    seen_point other = point_at(w, r.hit, r.weights, t, SEEN_FROM_INSIDE);
    if (luminance(other.radiance) > dark) out->points[out->count++] = point_at(w, index, weights, t, SEEN_FROM_INSIDE);
}

/* ---- from a camera ---- */

/* A ray for each point of a grid over the picture. */
static void look_from_camera(const world *w, const seen_camera *c, seen_from place, seen_points *out) {
    double forward[3], right[3], up[3], half = c->yfov > 0.0 ? tan(0.5 * c->yfov) : c->ymag;
    vec3_sub(forward, c->target, c->eye);
    vec3_normalize(forward);
    vec3_cross(right, forward, c->up);
    if (!(vec3_normalize(right) > 0.0)) vec3_tangents(forward, right, up);
    vec3_cross(up, right, forward);
    double length = 2.1 * w->radius + vec3_distance(c->eye, w->center);
    for (int y = 0; y < PICTURE_ROWS; y++)
        for (int x = 0; x < PICTURE_COLUMNS; x++) {
            double s = c->aspect * half * (2 * (x + 0.5) / PICTURE_COLUMNS - 1),
                   t = half * (2 * (y + 0.5) / PICTURE_ROWS - 1);
            double from[3], direction[3];
            vec3_copy(from, c->eye), vec3_copy(direction, forward);
            vec3_add_scaled(c->yfov > 0.0 ? direction : from, c->yfov > 0.0 ? direction : from, s, right);
            vec3_add_scaled(c->yfov > 0.0 ? direction : from, c->yfov > 0.0 ? direction : from, t, up);
            vec3_normalize(direction);
            ray r;
            if (trace(w, from, direction, length, &r) >= 0.0)
                out->points[out->count++] = point_at(w, r.hit, r.weights, 1.0, place);
        }
}

/* Where the preview stands, far away. */
static seen_camera afar(const world *w) {
    const double forward[3] = { -0.22, -0.16, -1.0 };
    seen_camera c = { .up = { 0, 1, 0 }, .ymag = w->radius, .aspect = 1.0 };
    vec3_copy(c.target, w->center);
    vec3_add_scaled(c.eye, w->center, -2.0 * w->radius, forward);
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

static void look(const world *w, size_t mesh_count, const seen_camera *cameras, size_t camera_count, seen_points *out) {
    double dark = darkness(w, mesh_count);
    for (size_t i = 0; i < camera_count && i < CAMERAS_MAX; i++)
        look_from_camera(w, &cameras[i], SEEN_FROM_CAMERA, out);
    if (shows_light(out, dark)) return;
    out->cameras_are_dark = out->count > 0;
    out->count = 0;
    const seen_camera far = afar(w);
    look_from_camera(w, &far, SEEN_FROM_AFAR, out);
    for (size_t i = 0; i < SURFACE_RAYS; i++) look_from_surface(w, i, dark, out);
}

bool seen_points_find(const seen_mesh *meshes, size_t mesh_count, const seen_camera *cameras, size_t camera_count,
                      seen_points *out) {
    world w;
    *out = (seen_points){ .points = malloc((CAMERAS_MAX * PICTURE_ROWS * PICTURE_COLUMNS + SURFACE_RAYS) *
                                           sizeof *out->points) };
    bool ok = build(&w, meshes, mesh_count) && out->points;
    if (ok && w.count > 0 && w.area[w.count - 1] > 0.0) look(&w, mesh_count, cameras, camera_count, out);
    destroy(&w);
    if (ok) return true;
    free(out->points);
    *out = (seen_points){ 0 };
    return false;
}
