/* SPDX-License-Identifier: MIT
 * Is the mesh that is worst by itself found, however dim it is, and what says too little passed over?
 */
#include "bake/worst_part.h"
#include "check.h"
#include "room.h"

/* Elements along an edge of the bright mesh, of the dim one a quarter as large, and of one that is too few to judge. */
enum { BRIGHT_CUTS = 8, DIM_CUTS = 8, FEW_CUTS = 5 };

typedef struct parts {
    room room;
    double *squares, *levels;
} parts;

static void add_quad(room *r, double x, double edge, int cuts, uint32_t owner) {
    const double at[3] = { x, 0, 0 }, u[3] = { edge, 0, 0 }, v[3] = { 0, edge, 0 };
    r->surfaces[room_quad(r, at, u, v, 0, 1, cuts)].mesh = owner;
}

/* Radiance 1 on mesh 0, 0.01 on mesh 3, which is off by `off` of that, and none on mesh 5; mesh 0 is off by 1 %. */
static void start(parts *p, double off) {
    room *r = &p->room;
    room_start(r);
    room_material(r, 0.5, 0.0);
    add_quad(r, 0, 2, BRIGHT_CUTS, 0);
    add_quad(r, 3, 1, DIM_CUTS, 3);
    add_quad(r, 5, 1, FEW_CUTS, 4);
    add_quad(r, 7, 1, DIM_CUTS, 5);
    room_finish(r);
    p->squares = malloc(r->mesh.element_count * sizeof *p->squares);
    p->levels = malloc(r->mesh.element_count * sizeof *p->levels);
    for (size_t e = 0; e < r->mesh.element_count; e++) {
        const element *one = &r->mesh.elements[e];
        uint32_t owner = r->scene.surfaces[r->mesh.patches[one->patch].surface].mesh;
        double L = owner == 0   ? 1.0
                   : owner == 5 ? 0.0
                                : 0.01,
               wrong = owner == 0   ? 0.01
                       : owner == 4 ? 1.0
                                    : off * 0.01;
        p->levels[e] = L * L * one->area, p->squares[e] = wrong * wrong * one->area;
    }
}

static void release(parts *p) {
    free(p->squares);
    free(p->levels);
    room_free(&p->room);
}

/* sign: of the squares of what all are off by. */
static part_error worst_of(double off, double sign) {
    parts p;
    part_error found;
    start(&p, off);
    for (size_t e = 0; e < p.room.mesh.element_count; e++) p.squares[e] *= sign;
    CHECK(worst_part_find(&p.room.scene, &p.room.mesh, p.squares, p.levels, &found));
    release(&p);
    return found;
}

static void a_dim_part_is_judged_by_its_own_light(void) {
    const part_error found = worst_of(0.3, 1.0);
    CHECK_EQUAL(found.mesh, 3);
    CHECK_NEAR(found.error, 0.3, 1e-12);
    CHECK_NEAR(found.area, 1.0 / 7, 1e-12);
    /* The whole has the mean square (4 x 1 + 2 x 0.01^2) / 7. */
    CHECK_NEAR(found.light, 0.01 / sqrt((4 + 2e-4) / 7), 1e-12);
}

static void what_is_bright_is_the_worst_where_it_is(void) {
    const part_error found = worst_of(0.002, 1.0);
    CHECK_EQUAL(found.mesh, 0);
    CHECK_NEAR(found.error, 0.01, 1e-12);
}

/* Noise that is taken off may be more than there was. */
static void nothing_is_known_where_nothing_is_off(void) {
    CHECK_NEAR(worst_of(0.3, -1.0).error, 0.0, 0);
}

int main(void) {
    RUN(a_dim_part_is_judged_by_its_own_light);
    RUN(what_is_bright_is_the_worst_where_it_is);
    RUN(nothing_is_known_where_nothing_is_off);
    return check_end();
}
