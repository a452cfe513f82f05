/* SPDX-License-Identifier: MIT */
#include "mesh/near_emitters.h"

#include "geometry/bvh.h"
#include "geometry/vec3.h"
#include "scene/contact_lines.h"

#include <math.h>
#include <string.h>

/* What an element reflects is uneven if the light that it would move from where it falls to where it does not is more
 * than this share of what all emitters give. */
static const double SHARE = 3e-4;

/* From further away than so many of its radii an emitter is as good as a point. */
static const double FAR_RADII = 3.0;

/* So many times an element is halved along its edges at most. */
enum { LEVELS = 5, LEAVES_A_JOB = 64, POINTS = 5 };

/* Further away than this many of an element's edges an emitter lights it evenly. */
static const double REACH = 1.0;

typedef struct near_emitters {
    const refinement_setup *setup;
    const element *elements; /* of the leaves */
    const leaf *leaves;
    uint32_t count;
    bool alike;
    const deadline *latest;
    bvh tree;            /* of patches that emit */
    double all;          /* what they give, W, all bands */
    double brightest[3]; /* W/m2, of any of them */
    bool *marks;
} near_emitters;

/* An element, and what emitters give it. */
typedef struct lit_element {
    const near_emitters *near;
    const double *normal, *rho;
    polygon outline;
    double points[POINTS][3], low[3], high[3];
    int point_count;
    double reflected[POINTS]; /* W/m2, all bands */
    double most;              /* the most that one emitter makes the element brighter under it than elsewhere */
} lit_element;

static const surface *surface_of(const near_emitters *near, const patch *p) {
    return &near->setup->scene->surfaces[p->surface];
}

/* Of a surface, since patches and elements have no materials yet. */
static const material *material_of(const near_emitters *near, const patch *p) {
    return &near->setup->scene->materials[surface_of(near, p)->material];
}

static double emission_of(const near_emitters *near, const patch *p, int c) {
    if (near->alike) return scene_emits(near->setup->scene, surface_of(near, p)) ? 1.0 : 0.0;
    return material_of(near, p)->M[c];
}

static double reflected_of(const lit_element *l, const patch *emitter, double factor) {
    double sum = 0.0;
    for (int c = 0; c < 3; c++) sum += l->rho[c] * emission_of(l->near, emitter, c);
    return fmax(factor, 0.0) * emitter->coverage * sum;
}

/* The place of the outline that is nearest to a point over its plane, or about that. */
static void foot_of(const lit_element *l, const double point[3], double out[3]) {
    double offset[3];
    vec3_sub(offset, point, l->points[0]);
    vec3_add_scaled(out, point, -vec3_dot(offset, l->normal), l->normal);
    for (int k = 0; k < l->outline.count; k++) {
        const double *a = l->outline.corner[k];
        double edge[3], inward[3], from[3];
        vec3_sub(edge, l->outline.corner[(k + 1) % l->outline.count], a);
        vec3_cross(inward, l->normal, edge);
        if (!(vec3_normalize(inward) > 0.0)) continue;
        vec3_sub(from, out, a);
        double outside = fmin(vec3_dot(from, inward), 0.0);
        vec3_add_scaled(out, out, -outside, inward);
    }
}

/* Its form factor to an emitter of that radius: the closed form, or that of a point where it is far. */
static double factor_to(const lit_element *l, const patch *emitter, const polygon *shape, double radius,
                        const double point[3]) {
    double to[3];
    vec3_sub(to, emitter->center, point);
    double square = vec3_dot(to, to);
    if (square < FAR_RADII * FAR_RADII * radius * radius) return polygon_factor(shape, point, l->normal);
    double cosines = fmax(vec3_dot(to, l->normal), 0.0) * -vec3_dot(to, surface_of(l->near, emitter)->normal);
    return cosines * emitter->area / (PI * square * square);
}

static void add_emitter(lit_element *l, uint32_t index) {
    const mesh *m = l->near->setup->mesh;
    const patch *emitter = &m->patches[index];
    const polygon shape = mesh_polygon(m, emitter->corner);
    double least = INFINITY, radius = 0.0, foot[3];
    for (int k = 0; k < shape.count; k++) radius = fmax(radius, vec3_distance(emitter->center, shape.corner[k]));
    for (int k = 0; k < l->point_count; k++) {
        double given = reflected_of(l, emitter, factor_to(l, emitter, &shape, radius, l->points[k]));
        l->reflected[k] += given;
        least = fmin(least, given);
    }
    foot_of(l, emitter->center, foot);
    l->most = fmax(l->most, reflected_of(l, emitter, factor_to(l, emitter, &shape, radius, foot)) - least);
}

static bool enters(void *user, const bvh_node *n) {
    const lit_element *l = user;
    for (int k = 0; k < 3; k++)
        if (n->low[k] > l->high[k] || n->high[k] < l->low[k]) return false;
    return true;
}

static bool takes(void *user, const uint32_t *items, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) add_emitter(user, items[i]);
    return true;
}

/* The corners and the middle, and the box around what may light them unevenly. */
static void set_points(lit_element *l) {
    int count = l->outline.count;
    double *middle = l->points[count], longest = 0.0;
    for (int k = 0; k < count; k++) {
        const double *corner = l->outline.corner[k];
        vec3_copy(l->points[k], corner);
        vec3_add_scaled(middle, middle, 1.0 / count, corner);
        longest = fmax(longest, vec3_distance(corner, l->outline.corner[(k + 1) % count]));
    }
    l->point_count = count + 1;
    vec3_bounds(l->points[0], (size_t)count, l->low, l->high);
    for (int k = 0; k < 3; k++) l->low[k] -= REACH * longest, l->high[k] += REACH * longest;
}

/* W: what of the light that it reflects is more than its darkest place would reflect. */
static double unevenness(const near_emitters *near, const patch *p, const element *e) {
    const surface *own = surface_of(near, p);
    lit_element l = { .near = near,
                      .normal = own->normal,
                      .rho = material_of(near, p)->rho,
                      .outline = mesh_polygon(near->setup->mesh, e->corner) };
    double low = INFINITY, high = 0.0;
    set_points(&l);
    bvh_visit(&near->tree, enters, takes, &l);
    for (int k = 0; k < l.point_count; k++) low = fmin(low, l.reflected[k]), high = fmax(high, l.reflected[k]);
    return e->area * fmax(high - low, l.most);
}

static bool is_uneven(const near_emitters *near, const element *e) {
    const patch *p = &near->setup->mesh->patches[e->patch];
    double most = e->area * vec3_dot(material_of(near, p)->rho, near->brightest);
    if (scene_emits(near->setup->scene, surface_of(near, p)) || !(most > SHARE * near->all)) return false;
    return p->contact == CONTACT_OPEN && !e->is_foot && unevenness(near, p, e) > SHARE * near->all;
}

static void mark_job(void *user, size_t job, unsigned worker) {
    near_emitters *near = user;
    size_t begin = job * LEAVES_A_JOB, end = begin + LEAVES_A_JOB;
    (void)worker;
    for (size_t i = begin; i < end && i < near->count; i++)
        near->marks[i] = (near->leaves[i].is_new || near->leaves[i].level == 0) && !deadline_is_over(near->latest) &&
                         is_uneven(near, &near->elements[i]);
}

/* The two sides of a sheet are split alike: leaves of either have the same places among those of their surface. False
 * when out of memory. */
static bool mark_twins(const near_emitters *near) {
    const scene *s = near->setup->scene;
    uint32_t *first = block_new(s->memory, (s->surface_count + 1) * sizeof *first);
    if (!first) return false;
    for (uint32_t i = near->count; i-- > 0;) first[near->setup->mesh->patches[near->elements[i].patch].surface] = i;
    for (uint32_t i = 0; i < near->count; i++) {
        uint32_t own = near->setup->mesh->patches[near->elements[i].patch].surface, twin = s->surfaces[own].twin;
        if (near->marks[i] && twin != NO_INDEX) near->marks[first[twin] + i - first[own]] = true;
    }
    block_free(first);
    return true;
}

/* *any: is a leaf marked? False when out of memory. */
static bool mark(near_emitters *near, refinement *tree, bool *any) {
    arena memory = { .memory = near->setup->mesh->memory };
    mesh whole;
    near->leaves = refinement_leaves(tree, &near->count);
    near->marks = block_zeroed(memory.memory, near->count + (size_t)1, sizeof *near->marks);
    bool ok = near->marks && refinement_mesh(tree, &memory, &whole);
    *any = false;
    if (ok) {
        near->elements = whole.elements;
        jobs_run(near->setup->jobs, (near->count + LEAVES_A_JOB - 1) / LEAVES_A_JOB, mark_job, NULL, near);
        for (uint32_t i = 0; i < near->count; i++) *any |= near->marks[i];
        ok = mark_twins(near);
    }
    arena_free(&memory);
    return ok;
}

static bool split(near_emitters *near, uint32_t elements_max, arena *memory) {
    refinement *tree = refinement_create(near->setup);
    bool ok = tree, any = true, changed = false;
    for (int level = 0; ok && any && level < LEVELS; level++) {
        ok = mark(near, tree, &any);
        refinement_result result = ok && any ? refinement_split(tree, near->marks, elements_max) : REFINEMENT_LIMIT;
        block_free(near->marks);
        any = result == REFINEMENT_OK, changed |= any;
        ok = ok && result != REFINEMENT_NO_MEMORY;
    }
    ok = ok && (!changed || refinement_finish(tree, memory));
    refinement_free(tree);
    return ok;
}

static bool build_tree(near_emitters *near) {
    const mesh *m = near->setup->mesh;
    bvh_box *boxes = block_new(m->memory, (m->patch_count + 1) * sizeof *boxes);
    size_t count = 0;
    for (uint32_t p = 0; boxes && p < m->patch_count; p++) {
        const patch *one = &m->patches[p];
        if (!scene_emits(near->setup->scene, surface_of(near, one)) || one->contact == CONTACT_COPY) continue;
        const polygon shape = mesh_polygon(m, one->corner);
        bvh_box_set(&boxes[count++], p, shape.corner, shape.count, 0.0);
        for (int c = 0; c < 3; c++) {
            double emitted = emission_of(near, one, c);
            near->all += one->area * emitted;
            near->brightest[c] = fmax(near->brightest[c], emitted);
        }
    }
    near->tree.nodes = block_new(m->memory, (2 * count + 1) * sizeof *near->tree.nodes);
    near->tree.items = block_new(m->memory, (count + 1) * sizeof *near->tree.items);
    bool ok = boxes && near->tree.nodes && near->tree.items;
    if (ok && count > 0) bvh_build(near->setup->jobs, &near->tree, boxes, count);
    block_free(boxes);
    return ok;
}

bool near_emitters_split(const refinement_setup *setup, bool alike, uint32_t elements_max, const deadline *latest,
                         arena *memory) {
    near_emitters near = { .setup = setup, .alike = alike, .latest = latest };
    bool ok = build_tree(&near) && (!(near.all > 0.0) || split(&near, elements_max, memory));
    block_free_all(near.tree.nodes, near.tree.items);
    return ok;
}
