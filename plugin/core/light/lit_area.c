/* SPDX-License-Identifier: MIT
 * See lit_area.h. Whether light comes through at all is asked, not how much: rays that find a lamp by chance find a
 * small one hardly ever, but one room is one piece however it is lit. Where there is no room, as around a thing that a
 * lamp far away shines on, a few segments to places on emitters find it.
 */
#include "light/lit_area.h"

#include "base/arena.h"
#include "base/tolerance.h"
#include "base/union_find.h"
#include "geometry/area_share.h"
#include "geometry/even_points.h"
#include "geometry/triangle.h"
#include "geometry/vec3.h"

/* So many places know an area of half the scene to 1.6 %, and the edge of an element to 0.8 %. */
enum { PLACES = 1024, EMITTING = 128, RAYS = 16, LIGHT_RAYS = 1024, LIGHT_RAYS_LEAST = 4 };

/* Rays of a place that is known to be lit: those beside it look for themselves. */
enum { LIT_RAYS = 2 };

/* Segments of a place to others on emitters. */
enum { DIRECT = 4 };

/* Elements are made no smaller than by this; where no light was found at all, it was missed. */
static const double LEAST_SHARE = 1.0 / 16;

typedef struct place {
    double at[3], normal[3]; /* a little above the surface */
} place;

typedef struct lit_search {
    const lit_area_setup *setup;
    place *places;                   /* from `emitting` on, those of emitters */
    uint32_t *front, *back;          /* of point i of the surfaces; back is NO_PLACE where there is none */
    uint32_t *joined;                /* joined[i]: another place that light of place i reaches, or itself */
    uint32_t count, emitting, light; /* light: the number of what is no place */
    bool *passes;                    /* of each triangle */
    bool has_sky;                    /* or a sun: what is seen from outside is lit */
    bvh tree;                        /* of places */
    double lift, reach;              /* m: above surfaces; as far as anything is */
} lit_search;

enum { NO_PLACE = UINT32_MAX };

static const lit_mesh *mesh_of(const lit_search *s, size_t triangle) {
    return &s->setup->meshes[s->setup->mesh_of[triangle]];
}

/* ---- what is connected ---- */

static bool are_joined(const lit_search *s, uint32_t a, uint32_t b) {
    return union_find_root(s->joined, a) == union_find_root(s->joined, b);
}

/* ---- where places are ---- */

static uint32_t add_place(lit_search *s, size_t triangle, size_t i, double side) {
    const double(*p)[3] = s->setup->triangles.corners[triangle];
    double weights[3];
    place *out = &s->places[s->count];
    even_weights(weights, even_point(i, 0), even_point(i, 1));
    *out = (place){ .at = { 0 } };
    triangle_cross(out->normal, p[0], p[1], p[2]);
    vec3_normalize(out->normal);
    for (int k = 0; k < 3; k++) {
        out->normal[k] *= side;
        vec3_add_scaled(out->at, out->at, weights[k], p[k]);
    }
    vec3_add_scaled(out->at, out->at, s->lift, out->normal);
    s->joined[s->count] = s->count;
    return s->count++;
}

static void place_on_surfaces(lit_search *s) {
    const triangle_bvh *t = &s->setup->triangles;
    for (size_t i = 0; i < PLACES; i++) {
        size_t triangle = area_share_find(t->area, t->count, ((double)i + 0.5) / PLACES * triangle_bvh_area(t));
        s->front[i] = add_place(s, triangle, i, 1.0);
        if (mesh_of(s, triangle)->emits) union_find_join(s->joined, s->front[i], s->light);
        s->back[i] = mesh_of(s, triangle)->double_sided ? add_place(s, triangle, i, -1.0) : NO_PLACE;
    }
}

/* By the area of emitters alone, which is a small part. sums: room for one of each triangle. */
static void place_on_emitters(lit_search *s, double *sums) {
    const triangle_bvh *t = &s->setup->triangles;
    double sum = 0.0;
    for (size_t i = 0; i < t->count; i++)
        sums[i] = sum += mesh_of(s, i)->emits ? t->area[i] - (i ? t->area[i - 1] : 0.0) : 0.0;
    for (size_t i = 0; i < EMITTING && sum > 0.0; i++) {
        size_t triangle = area_share_find(sums, t->count, ((double)i + 0.5) / EMITTING * sum);
        union_find_join(s->joined, add_place(s, triangle, i, 1.0), s->light);
        if (mesh_of(s, triangle)->double_sided) union_find_join(s->joined, add_place(s, triangle, i, -1.0), s->light);
    }
}

static bool make_tree(lit_search *s) {
    bvh_box *boxes = block_new(s->setup->memory, (s->count + 1) * sizeof *boxes);
    if (!boxes) return false;
    for (uint32_t i = 0; i < s->count; i++) bvh_box_set(&boxes[i], i, &s->places[i].at, 1, 0.0);
    bvh_build(NULL, &s->tree, boxes, s->count);
    block_free(boxes);
    return true;
}

/* ---- what sees what ---- */

static bool is_ahead(const place *from, const double at[3]) {
    double to[3];
    vec3_sub(to, at, from->at);
    return vec3_dot(to, from->normal) > 0.0;
}

typedef struct neighbour {
    const lit_search *of;
    const double *at, *eye;
    uint32_t place;
} neighbour;

/* Of those that face the eye. */
static double nearer(void *user, const uint32_t *items, uint32_t count, double least) {
    neighbour *n = user;
    for (uint32_t i = 0; i < count; i++) {
        const place *p = &n->of->places[items[i]];
        double distance = vec3_distance(p->at, n->at);
        if (distance < least && is_ahead(p, n->eye)) least = distance, n->place = items[i];
    }
    return least;
}

/* Joins `from` with the place beside what a ray from it meets, if eye sees that place too. normal: of a surface around
 * the eye, or NULL. */
static void look(lit_search *s, uint32_t from, const double eye[3], const double *normal, const double direction[3]) {
    const lit_area_setup *in = s->setup;
    triangle_meeting met;
    double end[3], to[3];
    vec3_add_scaled(end, eye, s->reach, direction);
    if (!triangle_bvh_meet(&in->triangles, eye, end, false, s->passes, &met)) {
        if (s->has_sky) union_find_join(s->joined, from, s->light);
        return;
    }
    vec3_add_scaled(end, eye, met.share * s->reach, direction);
    neighbour n = { s, end, eye, NO_PLACE };
    bvh_closest(&s->tree, end, INFINITY, nearer, &n);
    if (n.place == NO_PLACE || are_joined(s, n.place, from)) return;
    vec3_sub(to, s->places[n.place].at, eye);
    if (normal && !(vec3_dot(to, normal) > 0.0)) return;
    if (!triangle_bvh_blocks(&in->triangles, eye, s->places[n.place].at, s->passes))
        union_find_join(s->joined, from, n.place);
}

static bool sees_an_emitter(const lit_search *s, uint32_t index) {
    const place *p = &s->places[index];
    for (size_t i = 0; i < DIRECT && s->emitting < s->count; i++) {
        uint32_t of = (uint32_t)(even_point(DIRECT * (size_t)index + i, 2) * (s->count - s->emitting));
        const place *e = &s->places[s->emitting + of];
        if (is_ahead(p, e->at) && is_ahead(e, p->at) &&
            !triangle_bvh_blocks(&s->setup->triangles, p->at, e->at, s->passes))
            return true;
    }
    return false;
}

static void look_from_place(lit_search *s, uint32_t index) {
    const place *p = &s->places[index];
    if (sees_an_emitter(s, index)) union_find_join(s->joined, index, s->light);
    for (size_t i = 0; i < RAYS; i++) {
        if (i >= LIT_RAYS && are_joined(s, index, s->light)) return;
        size_t number = RAYS * (size_t)index + i;
        double direction[3];
        even_direction(direction, p->normal, even_point(number, 2), even_point(number, 3));
        look(s, index, p->at, p->normal, direction);
    }
}

/* Of a light without size, all around: a spot's cone is no wall. */
static void look_from_lights(lit_search *s) {
    size_t count = s->setup->lights->punctual_count, rays = count ? LIGHT_RAYS / count : 0;
    if (rays < LIGHT_RAYS_LEAST) rays = LIGHT_RAYS_LEAST;
    for (size_t l = 0; l < count; l++)
        for (size_t i = 0; i < rays; i++) {
            double z = 2 * even_point(i, 2) - 1, r = sqrt(1 - z * z), turn = 2 * PI * even_point(i, 3);
            const double direction[3] = { r * cos(turn), r * sin(turn), z };
            if (s->setup->lights->punctual[l].kind != PUNCTUAL_DIRECTIONAL)
                look(s, s->light, s->setup->lights->punctual[l].position, NULL, direction);
        }
}

static double lit_share(lit_search *s) {
    size_t lit = 0;
    for (size_t i = 0; i < PLACES; i++)
        lit += are_joined(s, s->front[i], s->light) || (s->back[i] != NO_PLACE && are_joined(s, s->back[i], s->light));
    return (double)lit / PLACES;
}

/* What every ray needs to know. */
static void set_up(lit_search *s) {
    const triangle_bvh *t = &s->setup->triangles;
    const lights *l = s->setup->lights;
    bool any_emits = false;
    for (size_t i = 0; i < t->count; i++) {
        s->passes[i] = mesh_of(s, i)->passes;
        any_emits = any_emits || mesh_of(s, i)->emits;
    }
    s->has_sky = l->sky_is_given || (l->punctual_count == 0 && !any_emits);
    s->lift = TOLERANCE_EYE_LIFT * t->radius;
    s->reach = 3 * t->radius;
    for (size_t i = 0; i < l->punctual_count; i++) {
        s->has_sky = s->has_sky || l->punctual[i].kind == PUNCTUAL_DIRECTIONAL;
        s->reach = fmax(s->reach, 2 * t->radius + vec3_distance(l->punctual[i].position, t->center));
    }
    s->joined[s->light] = s->light;
}

double lit_area(const lit_area_setup *setup) {
    const size_t most = 2 * (PLACES + EMITTING), triangles = setup->triangles.count;
    arena memory = { .memory = setup->memory };
    lit_search s = { .setup = setup,
                     .light = (uint32_t)most,
                     .places = arena_alloc(&memory, most, sizeof *s.places),
                     .front = arena_alloc(&memory, PLACES, sizeof *s.front),
                     .back = arena_alloc(&memory, PLACES, sizeof *s.back),
                     .joined = arena_alloc(&memory, most + 1, sizeof *s.joined),
                     .passes = arena_alloc(&memory, triangles, sizeof *s.passes),
                     .tree = { .nodes = arena_alloc(&memory, 2 * most, sizeof *s.tree.nodes),
                               .items = arena_alloc(&memory, most, sizeof *s.tree.items) } };
    double *sums = arena_alloc(&memory, triangles, sizeof *sums), share = -1.0;
    if (s.places && s.front && s.back && s.joined && s.passes && s.tree.nodes && s.tree.items && sums) {
        set_up(&s);
        place_on_surfaces(&s);
        s.emitting = s.count;
        place_on_emitters(&s, sums);
        if (make_tree(&s)) {
            look_from_lights(&s);
            for (uint32_t i = s.count; i-- > 0;) look_from_place(&s, i);
            share = lit_share(&s);
        }
    }
    arena_free(&memory);
    return (share == 0.0 ? 1.0 : share < 0.0 ? share : fmax(share, LEAST_SHARE)) * triangle_bvh_area(&setup->triangles);
}
