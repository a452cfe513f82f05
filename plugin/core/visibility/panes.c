/* SPDX-License-Identifier: MIT */
#include "visibility/panes.h"

#include "base/tolerance.h"
#include "geometry/bvh.h"
#include "visibility/surface_bvh.h"

#include <stdlib.h>
#include <string.h>

/* Boxes are so much wider than what is in them, relative to the scene's radius; see surface_bvh.c. */
static const double BOX_MARGIN = 1e-9;

/* Crossings of one place of one plane, which lie on an edge that two elements share, are one. */
static const double SAME_PLACE = 1e-9;

/* Points of a polygon along each side that are looked at through panes, if those near its corners and its middle do not
 * agree on what panes leave. */
enum { GRID = 4 };

/* An element of a sheet. */
typedef struct pane {
    double corner[4][3], normal[3], plane, transmittance[3];
    int corner_count;
    uint32_t surface, front, back; /* elements; NO_INDEX: it has no back */
    const alpha_mask *holes;
} pane;

struct panes {
    const scene *scene;
    pane *all;
    size_t count;
    bvh tree;
    surface_bvh *opaque;
    double low[3], high[3]; /* of all */
};

/* ---- which surfaces are panes ---- */

static bool lets_through(const material *m) {
    return m->transmittance[0] > 0.0 || m->transmittance[1] > 0.0 || m->transmittance[2] > 0.0;
}

/* Clear glass takes none; it is not even looked for. */
static bool takes_light(const material *m) {
    return m->transmittance[0] < 1.0 || m->transmittance[1] < 1.0 || m->transmittance[2] < 1.0;
}

size_t panes_mark(scene *s, const mesh *m) {
    size_t count = 0;
    for (size_t i = 0; i < s->surface_count; i++) s->surfaces[i].pane = false;
    for (size_t e = 0; e < m->element_count; e++) {
        surface *f = &s->surfaces[m->patches[m->elements[e].patch].surface];
        if (f->pane || !lets_through(m->elements[e].material)) continue;
        f->pane = true;
        if (f->twin != NO_INDEX) s->surfaces[f->twin].pane = true;
        count++;
    }
    return count;
}

/* ---- building ---- */

static void set_pane(panes *p, const mesh *m, const uint32_t *first, uint32_t index) {
    const element *e = &m->elements[index];
    uint32_t of = m->patches[e->patch].surface, twin = p->scene->surfaces[of].twin;
    const surface *f = &p->scene->surfaces[of];
    pane *out = &p->all[p->count++];
    *out = (pane){ .plane = f->plane,
                   .corner_count = element_corner_count(e),
                   .surface = of,
                   .front = index,
                   .back = twin == NO_INDEX ? NO_INDEX : first[twin] + index - first[of],
                   .holes = f->holes };
    vec3_copy(out->normal, f->normal);
    vec3_copy(out->transmittance, e->material->transmittance);
    for (int k = 0; k < out->corner_count; k++) vec3_copy(out->corner[k], m->vertices + 3 * (size_t)e->corner[k]);
}

/* The two sides of a sheet are divided alike (mesh_items.c). */
static bool set_panes(panes *p, const mesh *m) {
    const scene *s = p->scene;
    uint32_t *first = block_new(s->memory, (s->surface_count + 1) * sizeof *first);
    if (!first) return false;
    for (size_t i = 0; i < s->surface_count; i++) first[i] = NO_INDEX;
    for (uint32_t e = 0; e < m->element_count; e++) {
        uint32_t of = m->patches[m->elements[e].patch].surface;
        if (first[of] == NO_INDEX) first[of] = e;
    }
    for (uint32_t e = 0; e < m->element_count; e++) {
        uint32_t of = m->patches[m->elements[e].patch].surface;
        if (s->surfaces[of].pane && surface_sheet(s, of) == of && takes_light(m->elements[e].material))
            set_pane(p, m, first, e);
    }
    block_free(first);
    return true;
}

static bool build_tree(panes *p) {
    bvh_box *boxes = block_new(p->scene->memory, (p->count + 1) * sizeof *boxes);
    p->tree.nodes = block_new(p->scene->memory, (2 * p->count + 1) * sizeof *p->tree.nodes);
    p->tree.items = block_new(p->scene->memory, (p->count + 1) * sizeof *p->tree.items);
    bool ok = boxes && p->tree.nodes && p->tree.items;
    for (int k = 0; k < 3; k++) p->low[k] = INFINITY, p->high[k] = -INFINITY;
    for (size_t i = 0; ok && i < p->count; i++) {
        const pane *one = &p->all[i];
        bvh_box_set(&boxes[i], (uint32_t)i, (const double(*)[3])one->corner, one->corner_count,
                    BOX_MARGIN * p->scene->radius);
        for (int k = 0; k < 3; k++) {
            p->low[k] = fmin(p->low[k], (double)boxes[i].low[k]);
            p->high[k] = fmax(p->high[k], (double)boxes[i].high[k]);
        }
    }
    if (ok) bvh_build(NULL, &p->tree, boxes, p->count);
    block_free(boxes);
    return ok;
}

panes *panes_create(const scene *s, const mesh *m) {
    panes *p = block_zeroed(s->memory, 1, sizeof *p);
    if (!p) return NULL;
    p->scene = s;
    p->all = block_new(s->memory, (m->element_count + 1) * sizeof *p->all);
    p->opaque = surface_bvh_create(s);
    if (p->all && p->opaque && set_panes(p, m) && build_tree(p)) return p;
    panes_destroy(p);
    return NULL;
}

void panes_destroy(panes *p) {
    if (!p) return;
    surface_bvh_destroy(p->opaque);
    block_free_all(p->tree.nodes, p->tree.items, p->all, p);
}

/* ---- paths ---- */

typedef struct path {
    const panes *panes;
    uint32_t own;
    const double *from, *to;
    pane_crossings *out;
    bool failed;
} path;

/* How far a point of the plane is outside the outline, m; negative inside. */
static double outside(const pane *p, const double point[3]) {
    double most = -INFINITY;
    for (int k = 0; k < p->corner_count; k++) {
        double edge[3], offset[3], side[3];
        vec3_sub(edge, p->corner[k + 1 < p->corner_count ? k + 1 : 0], p->corner[k]);
        vec3_sub(offset, point, p->corner[k]);
        vec3_cross(side, edge, offset);
        double length = vec3_length(edge);
        if (length > 0.0) most = fmax(most, -vec3_dot(side, p->normal) / length);
    }
    return most;
}

static void add_crossing(path *w, const pane *p) {
    double a = plane_height(p->normal, p->plane, w->from), b = plane_height(p->normal, p->plane, w->to), point[3],
           way[3], tolerance = TOLERANCE_EDGE * w->panes->scene->radius;
    if (p->surface == w->own || (a > 0.0) == (b > 0.0)) return;
    double t = a / (a - b);
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return;
    vec3_sub(way, w->to, w->from);
    vec3_add_scaled(point, w->from, t, way);
    double beyond = outside(p, point);
    if (beyond > tolerance || (p->holes && alpha_mask_is_hole(p->holes, point))) return;
    pane_crossings *out = w->out;
    if (!block_grow(w->panes->scene->memory, (void **)&out->all, &out->capacity, out->count, sizeof *out->all)) {
        w->failed = true;
        return;
    }
    out->all[out->count++] =
        (pane_crossing){ t, p->transmittance, a > 0.0 ? p->front : p->back, p->normal, beyond >= -tolerance };
}

static bool look_in_leaf(void *user, const uint32_t *items, uint32_t count) {
    path *w = user;
    for (uint32_t i = 0; i < count; i++) add_crossing(w, &w->panes->all[items[i]]);
    return w->failed;
}

static int compare_crossings(const void *a, const void *b) {
    const pane_crossing *x = a, *y = b;
    if (x->t != y->t) return x->t < y->t ? -1 : 1;
    return (x->transmittance > y->transmittance) - (x->transmittance < y->transmittance); /* the order of elements */
}

/* Where a path goes through the edge between two elements, both are listed. */
static void join_at_edges(pane_crossings *c) {
    size_t kept = 0;
    for (size_t i = 0; i < c->count; i++) {
        const pane_crossing *last = kept ? &c->all[kept - 1] : NULL, *one = &c->all[i];
        bool same = last && last->on_edge && one->on_edge && one->t - last->t <= SAME_PLACE &&
                    fabs(vec3_dot(one->normal, last->normal)) > 1.0 - SAME_PLACE;
        if (!same) c->all[kept++] = c->all[i];
    }
    c->count = kept;
}

bool panes_list(const panes *p, uint32_t own, const double from[3], const double to[3], pane_crossings *out) {
    path w = { p, own, from, to, out, false };
    out->count = 0;
    if (p->count > 0) bvh_segment(&p->tree, from, to, look_in_leaf, &w);
    if (out->count > 1) qsort(out->all, out->count, sizeof *out->all, compare_crossings);
    join_at_edges(out);
    return !w.failed;
}

bool panes_transmit(const panes *p, uint32_t own, const double from[3], const double to[3], pane_crossings *scratch,
                    double T[3]) {
    T[0] = T[1] = T[2] = 1.0;
    if (!panes_list(p, own, from, to, scratch)) return false;
    for (size_t i = 0; i < scratch->count; i++)
        for (int c = 0; c < 3; c++) T[c] *= scratch->all[i].transmittance[c];
    return true;
}

/* ---- what shines through ---- */

/* May a pane lie between a point and a polygon? By the boxes of both. */
static bool may_meet(const panes *p, const polygon *shape, const double point[3]) {
    for (int k = 0; k < 3; k++) {
        double low = point[k], high = point[k];
        for (int i = 0; i < shape->count; i++) {
            low = fmin(low, shape->corner[i][k]);
            high = fmax(high, shape->corner[i][k]);
        }
        if (high < p->low[k] || low > p->high[k]) return false;
    }
    return true;
}

/* A point of a convex polygon, u and v in (0, 1); *weight: what its place stands for. */
static void point_on(const polygon *p, double u, double v, double out[3], double *weight) {
    bool quad = p->count == 4;
    const double *d = p->corner[quad ? 3 : 0];
    *weight = quad ? 1.0 : v;
    for (int k = 0; k < 3; k++)
        out[k] =
            (1 - v) * ((1 - u) * p->corner[0][k] + u * p->corner[1][k]) + v * ((1 - u) * d[k] + u * p->corner[2][k]);
}

/* From a point of a surface to a polygon that shines on it. */
typedef struct view {
    const panes *panes;
    const polygon *shape;
    const double *point, *normal;
    uint32_t own;
    double area[3]; /* of the polygon */
    pane_crossings *scratch;
} view;

/* T to a place on the polygon, and what the place weighs: nothing where it is not seen. False when out of memory. */
static bool look(const view *v, double at_u, double at_v, double to[3], double *weight, double T[3]) {
    double way[3];
    point_on(v->shape, at_u, at_v, to, weight);
    vec3_sub(way, to, v->point);
    double r2 = vec3_dot(way, way), leaving = fmax(-vec3_dot(way, v->area), 0.0);
    *weight *= r2 > 0.0 ? leaving * fmax(vec3_dot(way, v->normal), 0.0) / (r2 * r2) : 0.0;
    return panes_transmit(v->panes, v->own, v->point, to, v->scratch, T);
}

/* Do the places near the corners and the middle have the same T? */
static bool transmit_corners(const view *v, double T[3], bool *same) {
    static const double places[][2] = { { 0.5, 0.5 }, { 0.02, 0.02 }, { 0.98, 0.02 }, { 0.02, 0.98 }, { 0.98, 0.98 } };
    *same = true;
    for (size_t i = 0; *same && i < sizeof places / sizeof *places; i++) {
        double to[3], weight, one[3];
        if (!look(v, places[i][0], places[i][1], to, &weight, one)) return false;
        if (i == 0) vec3_copy(T, one);
        *same = vec3_equal(T, one);
    }
    return true;
}

bool panes_transmit_polygon(const panes *p, uint32_t surface_index, const polygon *shape, const double point[3],
                            pane_crossings *scratch, double T[3]) {
    const scene *s = p->scene;
    view v = { p, shape, point, s->surfaces[surface_index].normal, surface_sheet(s, surface_index), { 0 }, scratch };
    double seen[3] = { 0, 0, 0 }, all = 0.0, any[3] = { 0, 0, 0 }, any_all = 0.0;
    bool same = true;
    T[0] = T[1] = T[2] = 1.0;
    if (p->count == 0 || !may_meet(p, shape, point)) return true;
    polygon_vector_area(shape, v.area);
    if (!transmit_corners(&v, T, &same)) return false;
    for (int i = 0; !same && i < GRID * GRID; i++) {
        double to[3], weight, one[3];
        if (!look(&v, (i % GRID + 0.5) / GRID, (i / GRID + 0.5) / GRID, to, &weight, one)) return false;
        if (!(weight > 0.0)) continue;
        vec3_add_scaled(any, any, weight, one);
        any_all += weight;
        if (surface_bvh_blocks(p->opaque, s, v.own, to, point)) continue;
        vec3_add_scaled(seen, seen, weight, one);
        all += weight;
    }
    for (int c = 0; !same && c < 3; c++) T[c] = all > 0.0 ? seen[c] / all : any_all > 0.0 ? any[c] / any_all : T[c];
    return true;
}
