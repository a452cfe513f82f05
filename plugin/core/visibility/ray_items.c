/* SPDX-License-Identifier: MIT
 * See ray_items.h.
 */
#include "visibility/ray_items.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "visibility/ray_tree.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct ray_items {
    item_buffer_desc desc;
    item_geometry geometry; /* of copies; the maps of holes are whose they were */
    float *positions, *coordinates;
    uint32_t *indices;
    const alpha_mask_map **holes;
    uint8_t *layers; /* of coplanar_overlap.h; NULL: no triangles lie in each other */
    ray_tree *tree;
    float same_place; /* how far apart in depth triangles in one plane may seem, m */
    float *depth;     /* of edges, one over their distance */
    size_t depth_capacity;
};

/* ---- opening ---- */

static bool copy(allocator *memory, const void *from, size_t bytes, void **out) {
    *out = block_new(memory, bytes + 1);
    if (*out && bytes) memcpy(*out, from, bytes);
    return *out;
}

static bool find_layers(ray_items *r) {
    const item_geometry *g = &r->geometry;
    bool any = false;
    r->layers = block_new(r->desc.memory, g->triangle_count + 1);
    if (!r->layers || !item_geometry_layers(g, r->desc.memory, r->layers)) return false;
    for (size_t t = 0; t < g->triangle_count; t++) any = any || r->layers[t];
    if (any) return true;
    block_free(r->layers);
    r->layers = NULL;
    return true;
}

static bool copy_geometry(ray_items *r, const item_geometry *g) {
    allocator *memory = r->desc.memory;
    size_t places = 3 * g->vertex_count * sizeof(float);
    if (!copy(memory, g->positions, places, (void **)&r->positions) ||
        !copy(memory, g->indices, 3 * g->triangle_count * sizeof(uint32_t), (void **)&r->indices))
        return false;
    r->geometry = *g;
    r->geometry.positions = r->positions, r->geometry.indices = r->indices;
    float extent = 0.0f;
    for (size_t i = 0; i < 3 * g->vertex_count; i++) extent = fmaxf(extent, fabsf(g->positions[i]));
    r->same_place = 2.0f * (float)TOLERANCE_OVERLAP * extent;
    if (!g->coordinates) return true;
    if (!copy(memory, g->coordinates, places, (void **)&r->coordinates) ||
        !copy(memory, g->holes, g->triangle_count * sizeof *g->holes, (void **)&r->holes))
        return false;
    r->geometry.coordinates = r->coordinates, r->geometry.holes = r->holes;
    return true;
}

ray_items *ray_items_open(const item_buffer_desc *desc, char *message, size_t message_size) {
    ray_items *r = block_zeroed(desc->memory, 1, sizeof *r);
    snprintf(message, message_size, "out of memory");
    if (!r) return NULL;
    r->desc = *desc;
    if (copy_geometry(r, desc->geometry) && find_layers(r))
        r->tree = ray_tree_create(desc->memory, &r->geometry, message, message_size);
    if (r->tree) return r;
    ray_items_destroy(r);
    return NULL;
}

void ray_items_destroy(ray_items *r) {
    if (!r) return;
    ray_tree_destroy(r->tree);
    block_free_all(r->positions, r->coordinates, r->indices, r->holes, r->layers, r->depth, r);
}

/* ---- surfaces ---- */

/* What one ray asks of hits. */
typedef struct pixel_ray {
    const ray_items *items;
    const float *direction;
    bool cull, mirrored; /* mirrored: the view's axes are left-handed, as seen along forward */
    float nearest_holed; /* distance of the nearest hit on a triangle with holes */
    uint8_t layer;       /* of the lowest hit in one place ... */
    ray_tree_hit lowest; /* ... that one, and where it is looked for */
} pixel_ray;

static const float *corner_of(const ray_items *r, uint32_t triangle, int k) {
    return r->positions + 3 * (size_t)r->indices[3 * (size_t)triangle + (size_t)k];
}

/* The normal of a triangle, as long as twice its area. */
static void normal_of(const ray_items *r, uint32_t triangle, double out[3]) {
    double e[2][3];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)corner_of(r, triangle, i + 1)[k] - (double)corner_of(r, triangle, 0)[k];
    vec3_cross(out, e[0], e[1]);
}

static bool is_back(const pixel_ray *p, uint32_t triangle) {
    double n[3];
    normal_of(p->items, triangle, n);
    return (vec3_dot_floats(p->direction, (float[3]){ (float)n[0], (float)n[1], (float)n[2] }) > 0.0) != p->mirrored;
}

static bool is_in_hole(const ray_items *r, const ray_tree_hit *hit) {
    const alpha_mask_map *map = r->holes[hit->triangle];
    const uint32_t *at = r->indices + 3 * (size_t)hit->triangle;
    double uvw[3], u = (double)hit->u, v = (double)hit->v;
    for (size_t k = 0; k < 3; k++)
        uvw[k] = (1.0 - u - v) * (double)r->coordinates[3 * (size_t)at[0] + k] +
                 u * (double)r->coordinates[3 * (size_t)at[1] + k] + v * (double)r->coordinates[3 * (size_t)at[2] + k];
    return alpha_mask_map_is_hole(map, uvw);
}

static bool counts(void *user, const ray_tree_hit *hit) {
    pixel_ray *p = user;
    if (p->cull && is_back(p, hit->triangle)) return false;
    if (!p->items->holes || !p->items->holes[hit->triangle]) return true;
    p->nearest_holed = fminf(p->nearest_holed, hit->distance);
    return !is_in_hole(p->items, hit);
}

/* Passes by all hits, and keeps the lowest layer. */
static bool is_lowest(void *user, const ray_tree_hit *hit) {
    pixel_ray *p = user;
    uint8_t layer = p->items->layers[hit->triangle];
    if (layer < p->layer && counts(user, hit)) p->layer = layer, p->lowest = *hit;
    return false;
}

/* The id of what a ray shows. */
static uint32_t id_along(const ray_items *r, pixel_ray *p, const float from[3], const float direction[3], float far) {
    ray_tree_hit hit, unused;
    bool asks = p->cull || r->holes;
    p->direction = direction, p->nearest_holed = INFINITY;
    bool is_hit = ray_tree_first(r->tree, from, direction, 0.0f, far, asks ? counts : NULL, p, &hit);
    if (is_hit && r->layers && r->layers[hit.triangle] > 0) {
        float apart = r->same_place + hit.distance * (float)TOLERANCE_OVERLAP;
        p->layer = r->layers[hit.triangle], p->lowest = hit;
        ray_tree_first(r->tree, from, direction, fmaxf(hit.distance - apart, 0.0f), hit.distance + apart, is_lowest, p,
                       &unused);
        hit = p->lowest;
    }
    uint32_t id = is_hit ? r->desc.first_id + hit.triangle : 0;
    bool marked =
        r->desc.marks_holes && p->nearest_holed <= (is_hit ? hit.distance : INFINITY) && isfinite(p->nearest_holed);
    return marked ? id | ITEM_MARK : id;
}

/* Are the view's axes such that what turns to the eye runs round clockwise in the picture? */
static bool is_mirrored(const item_view *v) {
    const double right[3] = { (double)v->right[0], (double)v->right[1], (double)v->right[2] };
    const double up[3] = { (double)v->up[0], (double)v->up[1], (double)v->up[2] };
    double toward[3];
    vec3_cross(toward, right, up);
    return vec3_dot_floats(v->forward, (float[3]){ (float)toward[0], (float)toward[1], (float)toward[2] }) > 0.0;
}

static void draw_surfaces(const ray_items *r, const item_view *v, int width, bool cull, uint32_t *ids) {
    pixel_ray p = { .items = r, .cull = cull, .mirrored = is_mirrored(v) };
    double s_step = ((double)v->s_high - (double)v->s_low) / v->width;
    double t_step = ((double)v->t_high - (double)v->t_low) / v->height;
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            double s = (double)v->s_low + s_step * (x + 0.5), t = (double)v->t_low + t_step * (y + 0.5);
            float from[3], direction[3];
            for (int k = 0; k < 3; k++) {
                double aside = s * (double)v->right[k] + t * (double)v->up[k];
                from[k] = v->parallel ? (float)((double)v->eye[k] + aside) : v->eye[k];
                direction[k] = v->parallel ? v->forward[k] : (float)((double)v->forward[k] + aside);
            }
            ids[(size_t)(v->y + y) * (size_t)width + (size_t)(v->x + x)] =
                id_along(r, &p, from, direction, v->parallel ? v->depth : INFINITY);
        }
}

/* ---- edges ---- */

/* A point as a view shows it: pixels (from the view's corner) times w, w, and what depth is compared by, times w. */
typedef struct shown_point {
    double x, y, w, z;
} shown_point;

static shown_point show(const item_view *v, const float place[3]) {
    double to[3], right = 0.0, up = 0.0, forward = 0.0;
    for (int k = 0; k < 3; k++) {
        to[k] = (double)place[k] - (double)v->eye[k];
        right += to[k] * (double)v->right[k], up += to[k] * (double)v->up[k], forward += to[k] * (double)v->forward[k];
    }
    double w = v->parallel ? 1.0 : forward;
    return (shown_point){ (right - (double)v->s_low * w) / ((double)v->s_high - (double)v->s_low) * v->width,
                          (up - (double)v->t_low * w) / ((double)v->t_high - (double)v->t_low) * v->height, w,
                          v->parallel ? 1.0 - forward / (double)v->depth : 1.0 };
}

static shown_point between(const shown_point *a, const shown_point *b, double share) {
    return (shown_point){ a->x + share * (b->x - a->x), a->y + share * (b->y - a->y), a->w + share * (b->w - a->w),
                          a->z + share * (b->z - a->z) };
}

/* Cuts a line to what is in front of the eye and in the view; false: nothing of it. [Liang84] */
static bool clip(const item_view *v, shown_point *a, shown_point *b) {
    double low = 0.0, high = 1.0, least = v->parallel ? 0.0 : 1e-30;
    const double inside[5][2] = { { a->w - least, b->w - least },
                                  { a->x, b->x },
                                  { v->width * a->w - a->x, v->width * b->w - b->x },
                                  { a->y, b->y },
                                  { v->height * a->w - a->y, v->height * b->w - b->y } };
    for (int i = 0; i < 5; i++) {
        double from = inside[i][0], to = inside[i][1];
        if (from < 0.0 && to < 0.0) return false;
        if (from < 0.0) low = fmax(low, from / (from - to));
        if (to < 0.0) high = fmin(high, from / (from - to));
    }
    if (low > high) return false;
    shown_point first = between(a, b, low), last = between(a, b, high);
    *a = first, *b = last;
    return a->w > 0.0 && b->w > 0.0;
}

typedef struct edge_view {
    ray_items *items;
    const item_view *view;
    int width;
    uint32_t *ids;
    bool marks; /* ids are there: what has holes and is as near marks them */
} edge_view;

static void set_pixel(const edge_view *e, double x, double y, double z, uint32_t id) {
    int column = (int)floor(x), row = (int)floor(y);
    if (column < 0 || row < 0 || column >= e->view->width || row >= e->view->height) return;
    size_t at = (size_t)row * (size_t)e->view->width + (size_t)column;
    size_t to = (size_t)(e->view->y + row) * (size_t)e->width + (size_t)(e->view->x + column);
    float depth = (float)z;
    if (e->marks) {
        if (depth >= e->items->depth[at]) e->ids[to] |= ITEM_MARK;
        return;
    }
    if (!(depth > e->items->depth[at])) return;
    e->items->depth[at] = depth, e->ids[to] = id;
}

/* A pixel a step along the longer side, at centres. */
static void draw_line(const edge_view *e, shown_point a, shown_point b, uint32_t id) {
    if (!clip(e->view, &a, &b)) return;
    double x[2] = { a.x / a.w, b.x / b.w }, y[2] = { a.y / a.w, b.y / b.w }, z[2] = { a.z / a.w, b.z / b.w };
    bool wide = fabs(x[1] - x[0]) >= fabs(y[1] - y[0]);
    const double *along = wide ? x : y, *across = wide ? y : x;
    int from = along[0] <= along[1] ? 0 : 1, to = 1 - from;
    double length = along[to] - along[from];
    for (double at = floor(along[from] + 0.5) + 0.5; at < along[to] && length > 0.0; at += 1.0) {
        double share = (at - along[from]) / length, other = across[from] + share * (across[to] - across[from]);
        set_pixel(e, wide ? at : other, wide ? other : at, z[from] + share * (z[to] - z[from]), id);
    }
}

/* Does a triangle turn the side to the eye whose edges are drawn? */
static bool is_drawn(const edge_view *e, uint32_t triangle, bool mirrored) {
    double n[3], toward = 0.0;
    const float *corner = corner_of(e->items, triangle, 0);
    const item_view *v = e->view;
    normal_of(e->items, triangle, n);
    for (int k = 0; k < 3; k++)
        toward += n[k] * (v->parallel ? -(double)v->forward[k] : (double)v->eye[k] - (double)corner[k]);
    bool front = (toward > 0.0) != mirrored;
    return toward != 0.0 && front == (v->edges == ITEM_EDGES_FRONT);
}

static void draw_edges(const edge_view *e) {
    const ray_items *r = e->items;
    bool mirrored = is_mirrored(e->view);
    for (uint32_t t = 0; t < r->geometry.triangle_count; t++) {
        if ((e->marks && !(r->holes && r->holes[t])) || !is_drawn(e, t, mirrored)) continue;
        shown_point corner[3];
        for (int k = 0; k < 3; k++) corner[k] = show(e->view, corner_of(r, t, k));
        for (int k = 0; k < 3; k++) draw_line(e, corner[k], corner[(k + 1) % 3], r->desc.first_id + t);
    }
}

static bool draw_edge_view(ray_items *r, const item_view *v, int width, uint32_t *ids) {
    size_t pixels = (size_t)v->width * (size_t)v->height;
    edge_view e = { .items = r, .view = v, .width = width, .ids = ids };
    if (!block_reserve(r->desc.memory, (void **)&r->depth, &r->depth_capacity, pixels, sizeof *r->depth)) return false;
    memset(r->depth, 0, pixels * sizeof *r->depth);
    draw_edges(&e);
    e.marks = true;
    if (r->desc.marks_holes && r->holes) draw_edges(&e);
    return true;
}

bool ray_items_draw(ray_items *r, const item_view *views, int view_count, int width, int height, bool cull,
                    uint32_t *ids) {
    memset(ids, 0, (size_t)width * (size_t)height * sizeof *ids);
    for (int i = 0; i < view_count; i++) {
        if (views[i].edges == ITEM_EDGES_NONE)
            draw_surfaces(r, &views[i], width, cull, ids);
        else if (!draw_edge_view(r, &views[i], width, ids))
            return false;
    }
    return true;
}
