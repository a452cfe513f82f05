/* SPDX-License-Identifier: MIT
 * See contact_lines.h. Surfaces are in a tree of boxes; each asks it for those that meet its plane within its box.
 *
 * A surface that crosses the plane has the line in which it does. One that only touches has the edge that touches: a
 * wall whose foot is on the floor, or a little over it or in it. One that lies in the plane, or hardly over it as a
 * rug does, has the edges where it ends. Surfaces that share an edge with this one go on from it and are no contact.
 */
#include "scene/contact_lines.h"

#include "base/tolerance.h"
#include "geometry/bvh.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* What is nearer than this to a surface touches it, relative to the scene's radius: modellers leave gaps of a
 * millimetre under walls of a room that is five wide. */
static const double TOUCHES = 4e-4;

/* But no nearer than this share of the smaller surface's size: of fine meshes all would touch all. */
static const double TOUCHES_OF_SIZE = 0.05;

/* The same of surfaces one over the other: a bar 3 mm over a sill takes the light from what is under it as if it lay
 * there, and so does a lamp 11 mm under the ceiling of a room that is five wide. */
static const double HANGS = 3e-3, HANGS_OF_SIZE = 0.02;

/* What hangs higher than that, and as low as contact_gaps say, parts what is on either side of it unless it hangs
 * higher than this share of its size: then light goes on under it. A door of 4 cm is 1 cm over its floor, a wall of 10
 * cm ends 10 cm beside another: shares of 0.04 and 0.22. */
static const double PARTS_OF_SIZE = 0.25;

/* Shorter lines are not worth a cut, relative to the scene's radius. Measured on a garage 10 m long: with lines of a
 * centimetre at least some that matter get lost, and those of a millimetre add elements and nothing else. */
static const double LENGTH_LEAST = 6e-4;

enum { POINTS_MAX = 8 };

typedef struct finder {
    const scene *s;
    uint32_t *places;
    bvh tree;
    contact_lines *out;
    size_t capacity, cover_capacity, lines_max; /* lines_max: and covers, of a job */
    double area;                                /* m2, of all surfaces */
    contact_gaps gaps;
    const deadline *latest;
    /* The surface that is asked about. */
    uint32_t own;
    double corner[4][3], low[3], high[3], size, reach; /* reach: what is further from its plane does not meet it */
    int corner_count;
    bool failed; /* out of memory */
} finder;

static double size_of(const surface *f) {
    return sqrt(f->area);
}

static int corners_of(const scene *s, const surface *f, double corner[4][3]) {
    int count = surface_corner_count(f);
    for (int k = 0; k < count; k++) vec3_copy(corner[k], scene_vertex(s, f->corner[k]));
    return count;
}

/* ---- lines ---- */

/* The outline a little larger, so that what runs along an edge is not lost to a rounding. */
static void widen(const finder *w, double margin, double out[4][3]) {
    double middle[3] = { 0, 0, 0 };
    for (int k = 0; k < w->corner_count; k++) vec3_add_scaled(middle, middle, 1.0 / w->corner_count, w->corner[k]);
    for (int k = 0; k < w->corner_count; k++) {
        double outward[3];
        vec3_sub(outward, w->corner[k], middle);
        double length = vec3_length(outward);
        vec3_add_scaled(out[k], middle, length > 0.0 ? 1.0 + margin / length : 1.0, outward);
    }
}

/* The line under two points. False when out of memory. */
static bool add_line(finder *w, const double from[3], const double to[3], double gap, double margin) {
    const surface *f = &w->s->surfaces[w->own];
    contact_line line = { .gap = gap };
    double wide[4][3], along[3], low, high;
    vec3_add_scaled(line.from, from, -surface_height(f, from), f->normal);
    vec3_add_scaled(line.to, to, -surface_height(f, to), f->normal);
    vec3_sub(along, line.to, line.from);
    widen(w, margin, wide);
    if (!contact_line_clip(&line, (const double(*)[3])wide, w->corner_count, f->normal, &low, &high)) return true;
    if ((high - low) * vec3_length(along) < LENGTH_LEAST * w->s->radius) return true;
    vec3_add_scaled(line.to, line.from, high, along);
    vec3_add_scaled(line.from, line.from, low, along);
    contact_lines *out = w->out;
    if (!block_grow(w->s->memory, (void **)&out->lines, &w->capacity, out->count, sizeof line)) return false;
    out->lines[out->count++] = line;
    return true;
}

/* ---- surfaces that meet ---- */

/* What the other surface's corners are over the plane of this one. */
typedef struct meeting {
    const surface *other;
    double corner[4][3], height[4], margin;
    int count;
} meeting;

static bool shares_edge(const finder *w, const surface *other) {
    const surface *own = &w->s->surfaces[w->own];
    int shared = 0;
    for (int i = 0; i < surface_corner_count(own); i++)
        for (int k = 0; k < surface_corner_count(other); k++)
            shared += w->places[own->corner[i]] == w->places[other->corner[k]];
    return shared >= 2;
}

/* Where the surface crosses the plane, or the corners of it that touch. */
static int meeting_points(const finder *w, const meeting *m, double points[POINTS_MAX][3]) {
    bool above = false, below = false;
    int count = 0;
    for (int k = 0; k < m->count; k++) above |= m->height[k] > m->margin, below |= m->height[k] < -m->margin;
    double margin = above && below ? TOLERANCE_IN_PLANE * w->s->radius : m->margin;
    for (int k = 0; k < m->count; k++) {
        double from = m->height[k], to = m->height[(k + 1) % m->count], edge[3];
        if (fabs(from) <= margin) vec3_copy(points[count++], m->corner[k]);
        if (!(above && below) || fabs(from) <= margin || fabs(to) <= margin || (from > 0.0) == (to > 0.0)) continue;
        vec3_sub(edge, m->corner[(k + 1) % m->count], m->corner[k]);
        vec3_add_scaled(points[count++], m->corner[k], from / (from - to), edge);
    }
    return count;
}

/* The two points that are furthest apart. */
static bool cross_plane(finder *w, const meeting *m) {
    double points[POINTS_MAX][3], most = 0.0;
    int count = meeting_points(w, m, points), from = 0, to = 0;
    if (count < 2) return true;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++) {
            double square = vec3_distance_squared(points[i], points[k]);
            if (square > most) most = square, from = k, to = i;
        }
    return !(most > 0.0) || add_line(w, points[from], points[to], 0.0, m->margin);
}

/* Under what is so high over it. */
static bool add_fades(finder *w, const meeting *m, uint32_t other, double height) {
    const surface *own = &w->s->surfaces[w->own];
    const bool *ends = w->out->sides.ends;
    const contact_outline mine = { (const double(*)[3])w->corner, ends + 4 * (size_t)w->own, own->normal,
                                   w->corner_count },
                          its = { (const double(*)[3])m->corner, ends + 4 * (size_t)other, m->other->normal, m->count };
    contact_line lines[2 * CONTACT_FADES_MAX];
    bool ok = true;
    if (!(height >= w->gaps.least && height <= w->gaps.most)) return true;
    int count = contact_line_fades(&mine, &its, height, lines);
    count += contact_line_fades(&its, &mine, height, lines + count);
    for (int i = 0; ok && i < count; i++) ok = add_line(w, lines[i].from, lines[i].to, INFINITY, 0.0);
    return ok;
}

/* How near surfaces meet, the smaller of which is of this size: those that cross, and those one over the other. */
static double touching(const finder *w, double size) {
    return fmin(TOUCHES * w->s->radius, TOUCHES_OF_SIZE * size);
}

static double hanging(const finder *w, double size) {
    return fmin(HANGS * w->s->radius, HANGS_OF_SIZE * size);
}

static double margin_of(const finder *w, double size, bool is_parallel) {
    return is_parallel ? fmax(hanging(w, size), fmin(w->gaps.parts, PARTS_OF_SIZE * size)) : touching(w, size);
}

/* Is there light between two surfaces that are so far from each other, on the front of either? */
static bool face_each_other(const finder *w, const meeting *m, double height) {
    const surface *own = &w->s->surfaces[w->own];
    bool faces = own->twin != NO_INDEX || height > 0.0;
    bool is_faced = m->other->twin != NO_INDEX || height * vec3_dot(own->normal, m->other->normal) < 0.0;
    return faces && is_faced;
}

/* Is it narrow and long enough that what is on its one side and on the other are two places? */
static bool parts_places(const finder *w, uint32_t other) {
    const flat_sides *sides = &w->out->sides;
    return flat_sides_width(sides, other) <= w->gaps.parts_width &&
           flat_sides_outline(sides, other) >= w->gaps.parts_outline;
}

static bool lie_in_plane(finder *w, const meeting *m, uint32_t other) {
    double height = 0.0, beside = hanging(w, fmin(w->size, size_of(m->other)));
    for (int k = 0; k < m->count; k++) {
        if (!(fabs(m->height[k]) <= m->margin)) return true;
        height += m->height[k] / m->count;
    }
    if (fabs(height) <= TOLERANCE_IN_PLANE * w->s->radius) height = 0.0;
    if (fabs(height) <= beside) {
        if (!block_grow(w->s->memory, (void **)&w->out->covers, &w->cover_capacity, w->out->cover_count,
                        sizeof *w->out->covers))
            return false;
        w->out->covers[w->out->cover_count++] = (contact_cover){ other, (float)height };
    } else if (!face_each_other(w, m, height) || !parts_places(w, other)) {
        return true;
    }
    for (int k = 0; k < m->count; k++)
        if (w->out->sides.ends[4 * (size_t)other + (size_t)k] &&
            !add_line(w, m->corner[k], m->corner[(k + 1) % m->count], fabs(height), beside))
            return false;
    return add_fades(w, m, other, fabs(height));
}

/* Heights of the other's corners; false if it is all above the plane or all below by more than anything reaches. */
static bool set_heights(const finder *w, meeting *m) {
    bool above = true, below = true;
    m->count = surface_corner_count(m->other);
    for (int k = 0; k < m->count; k++) {
        m->height[k] = surface_height(&w->s->surfaces[w->own], scene_vertex(w->s, m->other->corner[k]));
        above &= m->height[k] > w->reach, below &= m->height[k] < -w->reach;
    }
    return !above && !below;
}

static bool meet(finder *w, uint32_t index) {
    const surface *own = &w->s->surfaces[w->own], *other = &w->s->surfaces[index];
    meeting m = { .other = other };
    if (index == w->own || !set_heights(w, &m) || shares_edge(w, other)) return true;
    corners_of(w->s, other, m.corner);
    bool is_parallel = fabs(vec3_dot(own->normal, other->normal)) >= FLAT_SIDES_PARALLEL;
    m.margin = margin_of(w, fmin(w->size, size_of(other)), is_parallel);
    bool above = true, below = true;
    for (int k = 0; k < m.count; k++) above &= m.height[k] > m.margin, below &= m.height[k] < -m.margin;
    if (above || below) return true;
    return is_parallel ? lie_in_plane(w, &m, index) : cross_plane(w, &m);
}

/* ---- all of them ---- */

/* Does a box meet the plane of the surface, and its box or what is beside it by twice the reach? */
static bool enters(void *user, const bvh_node *n) {
    const finder *w = user;
    const surface *f = &w->s->surfaces[w->own];
    double middle[3], reach = w->reach + TOLERANCE_IN_PLANE * w->s->radius;
    double margin = fmin(2.0 * reach, fmax(HANGS * w->s->radius, w->gaps.parts));
    for (int k = 0; k < 3; k++) {
        if (n->low[k] > w->high[k] + margin || n->high[k] < w->low[k] - margin) return false;
        middle[k] = 0.5 * ((double)n->low[k] + n->high[k]);
        reach += 0.5 * ((double)n->high[k] - n->low[k]) * fabs(f->normal[k]);
    }
    return fabs(surface_height(f, middle)) <= reach;
}

/* Surfaces that follow each other are one job, with lines and covers of its own. All jobs have so many between them,
 * shared out by area, or each so many if that is more: a surface that would have more is in a tangle that no cut is of
 * use in, and has none. The ground under 40,000 houses has 160,000, and a third of the area; of a few thousand
 * triangles that all cross each other each has as many. */
enum { SURFACES_A_JOB = 64, LINES_A_JOB = 8192, LINES = 1 << 21 };

static bool is_tangle(const finder *w) {
    return w->out->count + w->out->cover_count > w->lines_max;
}

static bool takes(void *user, const uint32_t *items, uint32_t count) {
    finder *w = user;
    for (uint32_t i = 0; i < count && !w->failed; i++) w->failed = !meet(w, items[i]);
    return !w->failed && !is_tangle(w);
}

static int compare_lines(const void *a, const void *b) {
    const contact_line *x = a, *y = b;
    double p = vec3_distance_squared(x->from, x->to), q = vec3_distance_squared(y->from, y->to);
    if (p != q) return p > q ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->from[k] != y->from[k]) return x->from[k] < y->from[k] ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->to[k] != y->to[k]) return x->to[k] < y->to[k] ? -1 : 1;
    return (x->gap > y->gap) - (x->gap < y->gap);
}

/* first and first_cover count from the beginning of this finder's own lines and covers. */
static bool find_of(finder *w, uint32_t index) {
    const surface *f = &w->s->surfaces[index];
    contact_lines *out = w->out;
    size_t first = out->count;
    out->first[index] = first;
    out->first_cover[index] = out->cover_count;
    if (surface_sheet(w->s, index) != index || deadline_is_over(w->latest)) return true;
    w->own = index;
    w->corner_count = corners_of(w->s, f, w->corner);
    w->size = size_of(f);
    w->reach = fmax(margin_of(w, w->size, true), margin_of(w, w->size, false));
    vec3_bounds(w->corner[0], (size_t)w->corner_count, w->low, w->high);
    bvh_visit(&w->tree, enters, takes, w);
    if (is_tangle(w)) out->count = first, out->cover_count = out->first_cover[index];
    if (out->count > first + 1) qsort(out->lines + first, out->count - first, sizeof *out->lines, compare_lines);
    return !w->failed;
}

typedef struct finding {
    const finder *all;
    contact_lines *of_job;
    atomic_bool failed;
} finding;

static size_t job_count(const scene *s) {
    return (s->surface_count + SURFACES_A_JOB - 1) / SURFACES_A_JOB;
}

static size_t end_of_job(const scene *s, size_t job) {
    size_t end = (job + 1) * SURFACES_A_JOB;
    return end < s->surface_count ? end : s->surface_count;
}

static void find_job(void *user, size_t job, unsigned worker) {
    finding *g = user;
    finder w = *g->all;
    (void)worker;
    double own = 0.0;
    for (size_t i = job * SURFACES_A_JOB; i < end_of_job(w.s, job); i++) own += w.s->surfaces[i].area;
    w.lines_max = (size_t)fmax(LINES_A_JOB, LINES * own / w.area);
    w.out = &g->of_job[job];
    *w.out = *g->all->out; /* whose places to begin and flat sides these are too */
    for (size_t i = job * SURFACES_A_JOB; i < end_of_job(w.s, job); i++)
        if (atomic_load(&g->failed) || !find_of(&w, (uint32_t)i)) {
            atomic_store(&g->failed, true);
            return;
        }
}

/* What the jobs found, in their order. */
static bool join(const scene *s, const contact_lines *of_job, size_t job_count, contact_lines *out) {
    size_t lines = 0, covers = 0;
    for (size_t j = 0; j < job_count; j++) lines += of_job[j].count, covers += of_job[j].cover_count;
    out->lines = block_new(s->memory, (lines + 1) * sizeof *out->lines);
    out->covers = block_new(s->memory, (covers + 1) * sizeof *out->covers);
    if (!out->lines || !out->covers) return false;
    for (size_t j = 0; j < job_count; j++) {
        for (size_t i = j * SURFACES_A_JOB; i < end_of_job(s, j); i++)
            out->first[i] += out->count, out->first_cover[i] += out->cover_count;
        const contact_lines *one = &of_job[j];
        if (one->count) memcpy(out->lines + out->count, one->lines, one->count * sizeof *one->lines);
        if (one->cover_count)
            memcpy(out->covers + out->cover_count, one->covers, one->cover_count * sizeof *one->covers);
        out->count += one->count, out->cover_count += one->cover_count;
    }
    out->first[s->surface_count] = out->count, out->first_cover[s->surface_count] = out->cover_count;
    return true;
}

static bool find_all(finder *w, jobs *j) {
    const scene *s = w->s;
    size_t count = job_count(s);
    for (size_t i = 0; i < s->surface_count; i++) w->area += s->surfaces[i].area;
    finding g = { .all = w, .of_job = block_zeroed(s->memory, count + 1, sizeof *g.of_job) };
    if (g.of_job) jobs_run(j, count, find_job, NULL, &g);
    bool ok = g.of_job && !g.failed && join(s, g.of_job, count, w->out);
    for (size_t i = 0; g.of_job && i < count; i++) block_free_all(g.of_job[i].lines, g.of_job[i].covers);
    block_free(g.of_job);
    return ok;
}

static bool build_tree(finder *w, jobs *j) {
    const scene *s = w->s;
    bvh_box *boxes = block_new(s->memory, (s->surface_count + 1) * sizeof *boxes);
    size_t count = 0;
    for (uint32_t i = 0; boxes && i < s->surface_count; i++) {
        double corner[4][3];
        int corners = corners_of(s, &s->surfaces[i], corner);
        if (surface_sheet(s, i) == i) bvh_box_set(&boxes[count++], i, (const double(*)[3])corner, corners, 0.0);
    }
    w->tree.nodes = block_new(s->memory, (2 * count + 1) * sizeof *w->tree.nodes);
    w->tree.items = block_new(s->memory, (count + 1) * sizeof *w->tree.items);
    bool ok = boxes && w->tree.nodes && w->tree.items;
    if (ok) bvh_build(j, &w->tree, boxes, count);
    block_free(boxes);
    return ok;
}

bool contact_lines_find(const scene *s, const contact_gaps *gaps, const deadline *latest, jobs *j, contact_lines *out) {
    uint32_t place_count = 0;
    finder w = { .s = s, .out = out, .gaps = *gaps, .latest = latest, .places = scene_find_places(s, &place_count) };
    *out = (contact_lines){ .hidden = gaps->least,
                            .first = block_zeroed(s->memory, s->surface_count + 2, sizeof *out->first),
                            .first_cover = block_zeroed(s->memory, s->surface_count + 2, sizeof *out->first_cover) };
    bool ok = w.places && out->first && out->first_cover && build_tree(&w, j) &&
              flat_sides_find(s, w.places, &out->sides) && find_all(&w, j);
    block_free_all(w.places, w.tree.nodes, w.tree.items);
    return ok;
}

void contact_lines_free(contact_lines *l) {
    block_free_all(l->lines, l->first, l->covers, l->first_cover);
    flat_sides_free(&l->sides);
    memset(l, 0, sizeof *l);
}
