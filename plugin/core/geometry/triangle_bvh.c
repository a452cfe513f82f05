/* SPDX-License-Identifier: MIT */
#include "geometry/triangle_bvh.h"

#include "geometry/triangle.h"

typedef struct segment {
    const triangle_bvh *of;
    double from[3], step[3]; /* to the segment's end */
    bool fronts_alone, any_will_do;
    const bool *passes;
    double nearest; /* of step */
    triangle_meeting *out;
} segment;

/* ---- building ---- */

bool triangle_bvh_allocate(allocator *memory, size_t count, triangle_bvh *out) {
    *out = (triangle_bvh){ .count = count };
    out->corners = block_new(memory, (count + 1) * sizeof *out->corners);
    out->area = block_new(memory, (count + 1) * sizeof *out->area);
    out->tree.nodes = block_new(memory, 2 * (count + 1) * sizeof *out->tree.nodes);
    out->tree.items = block_new(memory, (count + 1) * sizeof *out->tree.items);
    return out->corners && out->area && out->tree.nodes && out->tree.items;
}

static void set_sphere(triangle_bvh *t) {
    const bvh_node *all = t->tree.nodes;
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = (double)all->low[k], high[k] = (double)all->high[k];
    vec3_mid(t->center, low, high);
    t->radius = 0.5 * vec3_distance(low, high);
}

enum { TRIANGLES_A_JOB = 1 << 12 };

typedef struct measuring {
    triangle_bvh *t;
    bvh_box *boxes;
} measuring;

static void measure(void *user, size_t item, unsigned worker) {
    const measuring *m = user;
    size_t first = item * TRIANGLES_A_JOB, end = first + TRIANGLES_A_JOB;
    (void)worker;
    for (size_t i = first; i < end && i < m->t->count; i++) {
        const double(*p)[3] = m->t->corners[i];
        m->t->area[i] = triangle_area(p[0], p[1], p[2]);
        bvh_box_set(&m->boxes[i], (uint32_t)i, p, 3, 0.0);
    }
}

bool triangle_bvh_build(allocator *memory, jobs *j, triangle_bvh *t) {
    bvh_box *boxes = block_new(memory, (t->count + 1) * sizeof *boxes);
    double sum = 0.0;
    if (!boxes) return false;
    size_t parts = (t->count + TRIANGLES_A_JOB - 1) / TRIANGLES_A_JOB;
    jobs_run(parts > 1 ? j : NULL, parts, measure, NULL, &(measuring){ t, boxes });
    for (size_t i = 0; i < t->count; i++) t->area[i] = sum += t->area[i];
    bvh_build(j, &t->tree, boxes, t->count);
    if (t->count > 0) set_sphere(t);
    block_free(boxes);
    return true;
}

void triangle_bvh_free(triangle_bvh *t) {
    block_free_all(t->corners, t->area, t->tree.nodes, t->tree.items);
    *t = (triangle_bvh){ 0 };
}

/* ---- meeting ---- */

static bool meet(segment *s, uint32_t item) {
    const double(*p)[3] = s->of->corners[item];
    double u[3], v[3], n[3], to[3], q[3];
    vec3_sub(u, p[1], p[0]);
    vec3_sub(v, p[2], p[0]);
    vec3_cross(n, u, v);
    vec3_sub(to, s->from, p[0]);
    double toward = -vec3_dot(n, s->step);
    if (toward == 0.0 || (s->fronts_alone && toward < 0.0)) return false;
    double share = vec3_dot(to, n) / toward;
    vec3_cross(q, to, s->step);
    double b = vec3_dot(v, q) / toward, c = -vec3_dot(u, q) / toward;
    if (!(share >= 0.0 && share < s->nearest && b >= 0.0 && c >= 0.0 && b + c <= 1.0)) return false;
    s->nearest = share;
    if (s->out) *s->out = (triangle_meeting){ item, share, { 1.0 - b - c, b, c }, toward > 0.0 };
    return true;
}

static bool look_at(void *user, const uint32_t *items, uint32_t count) {
    segment *s = user;
    for (uint32_t i = 0; i < count; i++)
        if (!(s->passes && s->passes[items[i]]) && meet(s, items[i]) && s->any_will_do) return true;
    return false;
}

static bool ask(segment *s, const double from[3], const double to[3]) {
    vec3_copy(s->from, from);
    vec3_sub(s->step, to, from);
    s->nearest = nextafter(1.0, 2.0);
    return bvh_segment(&s->of->tree, from, to, look_at, s) || s->nearest <= 1.0;
}

bool triangle_bvh_meet(const triangle_bvh *t, const double from[3], const double to[3], bool fronts_alone,
                       const bool *passes, triangle_meeting *out) {
    segment s = { .of = t, .fronts_alone = fronts_alone, .passes = passes, .out = out };
    return ask(&s, from, to);
}

bool triangle_bvh_blocks(const triangle_bvh *t, const double from[3], const double to[3], const bool *passes) {
    segment s = { .of = t, .any_will_do = true, .passes = passes };
    return ask(&s, from, to);
}
