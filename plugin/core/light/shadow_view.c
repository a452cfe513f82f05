/* SPDX-License-Identifier: MIT */
#include "light/shadow_view.h"

#include "base/tolerance.h"
#include "visibility/occlusion.h"
#include "visibility/surface_bvh.h"

#include <string.h>

/* Pixels beyond the border of a face, so that the four around a point on the border are all there. */
static const double RIM_PIXELS = 2.0;

/* ---- placing ---- */

static void set_axes(shadow_view *v, const double forward[3]) {
    double left[3];
    vec3_copy(v->forward, forward);
    vec3_tangents(forward, left, v->up);
    for (int k = 0; k < 3; k++) v->right[k] = -left[k];
}

void shadow_view_around(shadow_view *v, const double eye[3], int face) {
    double forward[3] = { 0, 0, 0 };
    forward[face / 2] = face % 2 ? -1.0 : 1.0;
    v->parallel = false;
    v->face = face;
    v->half = 1.0 / (1.0 - 2.0 * RIM_PIXELS / v->resolution);
    vec3_copy(v->eye, eye);
    set_axes(v, forward);
}

void shadow_view_against(shadow_view *v, const scene *s, const double toward[3]) {
    double forward[3] = { -toward[0], -toward[1], -toward[2] };
    const double radius = s->surroundings_shade ? s->radius : s->things_radius;
    v->parallel = true;
    v->half = radius / (1.0 - 2.0 * RIM_PIXELS / v->resolution);
    v->depth = 3.0 * radius;
    vec3_add_scaled(v->eye, s->surroundings_shade ? s->center : s->things_center, 1.5 * radius, toward);
    set_axes(v, forward);
}

bool shadow_view_draw(shadow_view *v, item_buffer *items, const double center[3]) {
    float half = (float)v->half;
    item_view view = { .s_low = -half,
                       .s_high = half,
                       .t_low = -half,
                       .t_high = half,
                       .width = v->resolution,
                       .height = v->resolution,
                       .parallel = v->parallel,
                       .depth = (float)v->depth };
    for (int k = 0; k < 3; k++) {
        view.eye[k] = (float)(v->eye[k] - center[k]);
        view.right[k] = (float)v->right[k];
        view.up[k] = (float)v->up[k];
        view.forward[k] = (float)v->forward[k];
    }
    item_view views[SHADOW_VIEW_BUFFERS] = { view, view, view };
    for (int k = 0; k < SHADOW_VIEW_BUFFERS; k++) views[k].y = k * v->resolution;
    views[1].edges = ITEM_EDGES_FRONT;
    views[2].edges = ITEM_EDGES_BACK;
    return item_buffer_draw(items, views, SHADOW_VIEW_BUFFERS, v->resolution, SHADOW_VIEW_BUFFERS * v->resolution,
                            false, v->ids);
}

/* ---- looking ---- */

bool shadow_view_holds(const shadow_view *v, const double point[3]) {
    if (v->parallel) return true;
    double d[3];
    vec3_sub(d, point, v->eye);
    int axis = fabs(d[0]) >= fabs(d[1]) ? 0 : 1;
    if (fabs(d[2]) > fabs(d[axis])) axis = 2;
    return v->face == 2 * axis + (d[axis] < 0.0);
}

static int clamp_pixel(const shadow_view *v, double at) {
    return at < 0.0 ? 0 : at >= v->resolution ? v->resolution - 1 : (int)at;
}

enum { CANDIDATES = 4 + 9 + 9 };

/* Ids that name what may block a point, [0] that of the pixel that it is in: of the four pixels whose centres surround
 * it, and of the nine around it among the edges. An edge is drawn at most half a pixel from where it is, and a surface
 * that covers no centre is nowhere further than that from an edge. */
static void find_candidates(const shadow_view *v, const double point[3], uint32_t id[CANDIDATES]) {
    double d[3];
    vec3_sub(d, point, v->eye);
    double scale = v->parallel ? 1.0 : vec3_dot(d, v->forward);
    double x = 0.5 * v->resolution * (1.0 + vec3_dot(d, v->right) / (scale * v->half));
    double y = 0.5 * v->resolution * (1.0 + vec3_dot(d, v->up) / (scale * v->half));
    size_t n = (size_t)v->resolution, columns[3], rows[3];
    for (int k = 0; k < 3; k++) {
        columns[k] = (size_t)clamp_pixel(v, x + k - 1);
        rows[k] = n * (size_t)clamp_pixel(v, y + k - 1);
    }
    int beside = x - floor(x) < 0.5 ? 0 : 2, above = y - floor(y) < 0.5 ? 0 : 2;
    id[0] = v->ids[rows[1] + columns[1]];
    id[1] = v->ids[rows[1] + columns[beside]];
    id[2] = v->ids[rows[above] + columns[1]];
    id[3] = v->ids[rows[above] + columns[beside]];
    for (int k = 0; k < 9; k++) {
        id[4 + k] = v->ids[n * n + rows[k / 3] + columns[k % 3]];
        id[13 + k] = v->ids[2 * n * n + rows[k / 3] + columns[k % 3]];
    }
}

static bool blocks(const shadow_view *v, const scene *s, uint32_t candidate, const surface *own, const double from[3],
                   const double point[3], bool nearest) {
    const surface *f = &s->surfaces[candidate];
    double t;
    if (!occlusion_crossing(f, from, point, &t)) return false;
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
    if (occlusion_inside(s, f, from, point, t)) return true;
    double pixel = 2.0 * v->half / v->resolution, distance = v->parallel ? 1.0 : vec3_distance(from, point);
    return nearest &&
           occlusion_by_small(f, own, from, point, t, v->parallel ? pixel : pixel * t * distance, pixel * distance);
}

/* Of light that comes from one direction nothing is in the way beside what throws shadows. */
static bool is_beside(const shadow_view *v, const double point[3]) {
    double d[3];
    vec3_sub(d, point, v->eye);
    return v->parallel && fmax(fabs(vec3_dot(d, v->right)), fabs(vec3_dot(d, v->up))) > v->half;
}

/* Where the light's path to the point begins. */
static void path_start(const shadow_view *v, const double point[3], double from[3]) {
    double d[3];
    vec3_copy(from, v->eye);
    if (!v->parallel) return;
    vec3_sub(d, point, v->eye);
    vec3_add_scaled(from, point, -vec3_dot(d, v->forward), v->forward);
}

/* A path of light to a point. */
typedef struct path {
    const shadow_view *view;
    const shadow_blockers *blockers;
    shadow_tested *tested;
    double from[3];
    const double *to;
    uint32_t own, sheet; /* the surface that the point is on */
} path;

/* Asked once for each surface; the point's own blocks nothing. */
static bool is_untested(const path *p, uint32_t candidate) {
    if (p->tested->last[candidate] == p->tested->point) return false;
    p->tested->last[candidate] = p->tested->point;
    return true;
}

/* False where the path stays on one side of the surface's plane, as most do, or ends in it: of two skins in one plane
 * neither is in the other's shade, and no light is asked for on the foot of what stands on something. */
static bool may_block(const path *p, uint32_t candidate) {
    const double *plane = p->blockers->planes + 4 * (size_t)candidate;
    double there = plane_height(plane, plane[3], p->to), here = plane_height(plane, plane[3], p->from);
    return (here > 0.0) != (there > 0.0);
}

static bool neighbour_blocks(const path *p, uint32_t candidate) {
    const scene *s = p->blockers->scene;
    const vertex_surfaces *c = &p->blockers->beside;
    for (int k = 0; k < surface_corner_count(&s->surfaces[candidate]); k++) {
        uint32_t place = c->at[4 * (size_t)candidate + (size_t)k], last = c->first[place + 1];
        if (last - c->first[place] > CORNERS_LOOKED_AT) last = c->first[place] + CORNERS_LOOKED_AT;
        for (uint32_t i = c->first[place]; i < last; i++)
            if (is_untested(p, c->surface[i]) && may_block(p, c->surface[i]) &&
                blocks(p->view, s, c->surface[i], &s->surfaces[p->own], p->from, p->to, false))
                return true;
    }
    return false;
}

bool shadow_view_reaches(const shadow_view *v, const shadow_blockers *blockers, shadow_tested *tested,
                         uint32_t surface_index, const double point[3]) {
    const scene *s = blockers->scene;
    path p = { .view = v, .blockers = blockers, .tested = tested, .to = point, .own = surface_index };
    uint32_t ids[CANDIDATES], seen[CANDIDATES], count = 0, last = 0, marks = 0;
    path_start(v, point, p.from);
    if (occlusion_by_own(s, &s->surfaces[surface_index], p.from, point)) return false;
    if (is_beside(v, point)) return true;
    find_candidates(v, point, ids);
    p.sheet = surface_sheet(s, surface_index);
    if (tested->point++ == UINT32_MAX) {
        memset(tested->last, 0, tested->surface_count * sizeof *tested->last);
        tested->point = 1;
    }
    tested->last[p.sheet] = tested->point;
    for (int k = 0; k < CANDIDATES; k++) {
        uint32_t id = ids[k] & ~ITEM_MARK;
        marks |= ids[k] & ITEM_MARK;
        if (id == last || id == 0) continue;
        last = id;
        uint32_t candidate = blockers->triangle_surface[id - 1];
        if (!is_untested(&p, candidate)) continue;
        if (blocks(v, s, candidate, &s->surfaces[surface_index], p.from, point, k == 0)) return false;
        seen[count++] = candidate;
    }
    for (uint32_t i = 0; i < count; i++)
        if (neighbour_blocks(&p, seen[i])) return false;
    return !marks || !s->tree || !surface_bvh_blocks(s->tree, s, p.sheet, p.from, point);
}

bool shadow_blockers_create(const scene *s, const uint32_t *triangle_surface, shadow_blockers *out) {
    *out = (shadow_blockers){ .scene = s,
                              .triangle_surface = triangle_surface,
                              .planes = block_new(s->memory, (4 * s->surface_count + 1) * sizeof *out->planes) };
    for (size_t i = 0; out->planes && i < s->surface_count; i++) {
        vec3_copy(out->planes + 4 * i, s->surfaces[i].normal);
        out->planes[4 * i + 3] = s->surfaces[i].plane;
    }
    return out->planes && vertex_surfaces_create(s, &out->beside);
}

void shadow_blockers_free(shadow_blockers *b) {
    vertex_surfaces_free(&b->beside);
    block_free(b->planes);
    b->planes = NULL;
}

bool shadow_tested_create(allocator *memory, size_t surface_count, shadow_tested *out) {
    *out = (shadow_tested){ .last = block_zeroed(memory, surface_count + 1, sizeof *out->last),
                            .surface_count = surface_count };
    return out->last;
}

void shadow_tested_free(shadow_tested *t) {
    block_free(t->last);
    t->last = NULL;
}
