/* SPDX-License-Identifier: MIT
 * What was the paper's test environment? "A sphere resting on a pillar in a cubical room", 328 patches, 8176 elements
 * [Baum89, sec. 6]. The paper gives no measures; these are ours:
 *
 *     what      patches         elements each     patches   elements
 *     walls     5 x 6 x 6       5 x 5             180       4500
 *     floor     6 x 6           7 x 7             36        1764
 *     sphere    12 x 7 facets   4 x 4             84        1344
 *     pillar    4 x 1 x 5       6 x 4             20        480
 *     top       2 x 2           2 x 3             4         24
 *     emitter      2 x 2           4 x 4             4         64
 *                                                 328       8176
 */
#ifndef HEMIBAKE_TESTS_ACCURACY_PAPER_ROOM_H
#define HEMIBAKE_TESTS_ACCURACY_PAPER_ROOM_H

#include "core/room.h"
#include "solver/progressive.h"

#include <time.h>

enum { PAPER_PATCHES = 328, PAPER_ELEMENTS = 8176, PAPER_HEMICUBE = 200, PAPER_HEMICUBE_LIGHT = 400 };

typedef struct paper_room {
    room room;
    mesh_items patches, elements;
    double *weights, *weights_light;
} paper_room;

static inline uint32_t paper_paint(room *r, double red, double green, double blue, double M) {
    uint32_t index = room_material(r, 0.0, M);
    r->materials[index].rho[0] = red, r->materials[index].rho[1] = green, r->materials[index].rho[2] = blue;
    return index;
}

static inline void paper_walls(room *r) {
    static const double corners[6][4][3] = {
        { { 0, 0, 0 }, { 3, 0, 0 }, { 3, 3, 0 }, { 0, 3, 0 } }, /* floor */
        { { 0, 0, 3 }, { 0, 3, 3 }, { 3, 3, 3 }, { 3, 0, 3 } }, /* ceiling */
        { { 0, 0, 0 }, { 0, 3, 0 }, { 0, 3, 3 }, { 0, 0, 3 } }, /* x = 0 */
        { { 3, 0, 0 }, { 3, 0, 3 }, { 3, 3, 3 }, { 3, 3, 0 } }, /* x = 3 */
        { { 0, 3, 0 }, { 3, 3, 0 }, { 3, 3, 3 }, { 0, 3, 3 } }, /* y = 3, the back */
        { { 0, 0, 0 }, { 0, 0, 3 }, { 3, 0, 3 }, { 3, 0, 0 } }, /* y = 0 */
    };
    uint32_t white = paper_paint(r, 0.7, 0.7, 0.7, 0), red = paper_paint(r, 0.7, 0.2, 0.2, 0);
    uint32_t blue = paper_paint(r, 0.2, 0.3, 0.7, 0);
    for (int i = 0; i < 6; i++)
        room_grid(r, corners[i],
                  i == 2   ? red
                  : i == 3 ? blue
                           : white,
                  i == 0 ? &(room_cuts){ 6, 6, 7, 7 } : &(room_cuts){ 6, 6, 5, 5 });
}

/* The pillar, 8 x 8 elements of the floor and 1 m high, without its buried bottom, and the sphere on it. It stands on
 * lines of the floor's grid: whatever is half under it would be one thing to a method that asks the element's centre,
 * and another to one that averages. */
static inline void paper_pillar(room *r) {
    static const double x[4] = { 21 / 14.0, 29 / 14.0, 29 / 14.0, 21 / 14.0 };
    static const double y[4] = { 20 / 14.0, 20 / 14.0, 28 / 14.0, 28 / 14.0 };
    uint32_t grey = paper_paint(r, 0.5, 0.5, 0.5, 0), ball = paper_paint(r, 0.8, 0.7, 0.3, 0);
    for (int i = 0; i < 4; i++) {
        int k = (i + 1) % 4;
        const double side[4][3] = { { x[i], y[i], 0 }, { x[k], y[k], 0 }, { x[k], y[k], 1 }, { x[i], y[i], 1 } };
        room_grid(r, side, grey, &(room_cuts){ 1, 5, 6, 4 });
    }
    const double top[4][3] = { { x[0], y[0], 1 }, { x[1], y[1], 1 }, { x[2], y[2], 1 }, { x[3], y[3], 1 } };
    room_grid(r, top, grey, &(room_cuts){ 2, 2, 2, 3 });
    /* The facets' lowest corner touches the top. */
    room_sphere(r, (double[]){ 25 / 14.0, 24 / 14.0, 1.35 }, 0.35, false, ball, 12, 7, 4);
}

static inline void paper_room_create(paper_room *p) {
    room *r = &p->room;
    room_start(r);
    paper_walls(r);
    paper_pillar(r);
    const double emitter[4][3] = { { 0.8, 0.8, 2.9 }, { 0.8, 1.8, 2.9 }, { 1.8, 1.8, 2.9 }, { 1.8, 0.8, 2.9 } };
    room_grid(r, emitter, paper_paint(r, 0, 0, 0, 20), &(room_cuts){ 2, 2, 4, 4 });
    room_finish(r);
    if (!mesh_items_create(&r->scene, &r->mesh, MESH_PATCHES, &r->memory, &p->patches) ||
        !mesh_items_create(&r->scene, &r->mesh, MESH_ELEMENTS, &r->memory, &p->elements))
        abort();
    p->weights = arena_alloc(&r->memory, 3 * PAPER_HEMICUBE * PAPER_HEMICUBE, sizeof(double));
    p->weights_light = arena_alloc(&r->memory, 3 * PAPER_HEMICUBE_LIGHT * PAPER_HEMICUBE_LIGHT, sizeof(double));
    if (!p->weights || !p->weights_light) abort();
    hemicube_weights(PAPER_HEMICUBE, p->weights);
    hemicube_weights(PAPER_HEMICUBE_LIGHT, p->weights_light);
}

static inline void paper_room_free(paper_room *p) {
    room_free(&p->room);
}

static inline progressive_setup paper_setup(paper_room *p, solver_method method, jobs *j, double (*clock)(void)) {
    progressive_setup setup = { .method = method,
                                .columns = room_columns(&p->room, 16, 3),
                                .patches = &p->patches,
                                .jobs = j,
                                .even_shooters = true, /* as the paper's are */
                                .unshot_target = 1e-4,
                                .start_s = clock(),
                                .memory_limit = UINT64_C(1) << 32,
                                .clock = clock };
    free(p->room.weights);
    p->room.weights = NULL;
    setup.columns.elements = &p->elements;
    setup.columns.resolution = PAPER_HEMICUBE;
    setup.columns.resolution_light = PAPER_HEMICUBE_LIGHT;
    setup.columns.weights = p->weights;
    setup.columns.weights_light = p->weights_light;
    return setup;
}

/* B[3*e+c] of every element: M + rho times the mean irradiance of its samples. */
static inline void paper_radiosity(const room *r, const double *irradiance, double *B) {
    for (size_t i = 0; i < r->mesh.element_count; i++) {
        const element *e = &r->mesh.elements[i];
        const material *m = &r->materials[r->surfaces[r->mesh.patches[e->patch].surface].material];
        int n = element_corner_count(e);
        for (int c = 0; c < 3; c++) {
            double E = 0.0;
            for (int k = 0; k < n; k++) E += irradiance[3 * ((size_t)e->first_sample + (size_t)k) + (size_t)c] / n;
            B[3 * i + (size_t)c] = m->M[c] + m->rho[c] * E;
        }
    }
}

/* [Baum89, eq. 12 and 13], over elements that do not emit. */
static inline double paper_error(const room *r, const double *reference, const double *B) {
    double off = 0.0, all = 0.0;
    for (size_t i = 0; i < r->mesh.element_count; i++) {
        const element *e = &r->mesh.elements[i];
        if (scene_emits(&r->scene, &r->surfaces[r->mesh.patches[e->patch].surface])) continue;
        for (size_t c = 0; c < 3; c++) {
            double d = B[3 * i + c] - reference[3 * i + c];
            off += e->area * d * d;
            all += e->area * reference[3 * i + c] * reference[3 * i + c];
        }
    }
    return sqrt(off / all);
}

static inline double paper_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
