/* SPDX-License-Identifier: MIT
 * Is what panes leave of the light on a path the product over those that it crosses, each once?
 */
#include "check.h"
#include "room.h"

#include "visibility/panes.h"

static const double LOW[3] = { 0.9, 0.5, 0.2 }, HIGH[3] = { 0.5, 1.0, 0.5 };

static uint32_t glass(room *r, const double through[3]) {
    uint32_t index = room_material(r, 0.0, 0.0);
    vec3_copy(r->materials[index].transmittance, through);
    return index;
}

/* Unit squares over a floor, at z = 1 with 2 x 2 elements and at z = 2. */
static panes *make(room *r) {
    room_start(r);
    room_quad(r, (double[]){ -5, -5, 0 }, (double[]){ 10, 0, 0 }, (double[]){ 0, 10, 0 }, room_material(r, 0.5, 0), 1,
              1);
    room_quad(r, (double[]){ 0, 0, 1 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, glass(r, LOW), 1, 2);
    room_quad(r, (double[]){ 0, 0, 2 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, glass(r, HIGH), 1, 1);
    room_finish(r);
    CHECK_EQUAL(panes_mark(&r->scene, &r->mesh), 2);
    CHECK(!r->surfaces[0].pane && r->surfaces[1].pane && r->surfaces[2].pane);
    panes *p = panes_create(&r->scene, &r->mesh);
    CHECK(p != NULL);
    return p;
}

static void check_way(const panes *p, uint32_t own, const double from[3], const double to[3],
                      const double expected[3]) {
    pane_crossings scratch = { 0 };
    double T[3];
    for (int turned = 0; turned < 2; turned++) { /* light takes both ways alike */
        CHECK(panes_transmit(p, own, turned ? to : from, turned ? from : to, &scratch, T));
        for (int c = 0; c < 3; c++) CHECK_NEAR(T[c], expected[c], 1e-15);
    }
    block_free(scratch.all);
}

static void panes_multiply(void) {
    room r;
    panes *p = make(&r);
    const double both[3] = { LOW[0] * HIGH[0], LOW[1] * HIGH[1], LOW[2] * HIGH[2] }, none[3] = { 1, 1, 1 };
    check_way(p, NO_INDEX, (double[]){ 0.3, 0.2, 0 }, (double[]){ 0.3, 0.2, 3 }, both);
    check_way(p, NO_INDEX, (double[]){ 0.3, 0.2, 0 }, (double[]){ 0.3, 0.2, 1.5 }, LOW);
    check_way(p, NO_INDEX, (double[]){ 1.2, 0.2, 0 }, (double[]){ 1.2, 0.2, 3 }, none); /* beside both */
    check_way(p, 1, (double[]){ 0.3, 0.2, 0 }, (double[]){ 0.3, 0.2, 3 }, HIGH);        /* from the lower one itself */
    /* Slanted, past the outline of one. */
    check_way(p, NO_INDEX, (double[]){ 0.9, 0.2, 0.9 }, (double[]){ 1.9, 0.2, 2.9 }, LOW);
    panes_destroy(p);
    room_free(&r);
}

static void clear_panes_take_nothing(void) {
    static const double CLEAR[3] = { 1, 1, 1 };
    room r;
    room_start(&r);
    room_quad(&r, (double[]){ 0, 0, 1 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, glass(&r, CLEAR), 1, 1);
    room_finish(&r);
    CHECK_EQUAL(panes_mark(&r.scene, &r.mesh), 1);
    CHECK(r.surfaces[0].pane);
    panes *p = panes_create(&r.scene, &r.mesh);
    check_way(p, NO_INDEX, (double[]){ 0.5, 0.2, 0 }, (double[]){ 0.5, 0.2, 3 }, CLEAR);
    panes_destroy(p);
    room_free(&r);
}

/* Each pane is crossed once, wherever its elements meet. */
static void an_edge_between_elements_is_crossed_once(void) {
    room r;
    panes *p = make(&r);
    const double both[3] = { LOW[0] * HIGH[0], LOW[1] * HIGH[1], LOW[2] * HIGH[2] };
    check_way(p, NO_INDEX, (double[]){ 0.5, 0.2, 0 }, (double[]){ 0.5, 0.2, 3 }, both);
    check_way(p, NO_INDEX, (double[]){ 0.5, 0.5, 0 }, (double[]){ 0.5, 0.5, 3 }, both);
    panes_destroy(p);
    room_free(&r);
}

static void crossings_are_listed_from_the_near_one_on(void) {
    room r;
    panes *p = make(&r);
    pane_crossings found = { 0 };
    CHECK(panes_list(p, NO_INDEX, (double[]){ 0.3, 0.2, 3 }, (double[]){ 0.3, 0.2, 0 }, &found));
    CHECK_EQUAL(found.count, 2);
    if (found.count == 2) {
        CHECK_NEAR(found.all[0].t, 1.0 / 3.0, 1e-12);
        CHECK_NEAR(found.all[1].t, 2.0 / 3.0, 1e-12);
    }
    block_free(found.all);
    panes_destroy(p);
    room_free(&r);
}

int main(void) {
    RUN(panes_multiply);
    RUN(clear_panes_take_nothing);
    RUN(an_edge_between_elements_is_crossed_once);
    RUN(crossings_are_listed_from_the_near_one_on);
    return check_end();
}
