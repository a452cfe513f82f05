/* SPDX-License-Identifier: MIT
 * Does light settle in a dim room beside a bright outside, without waiting for what is shut in white?
 */
#include "check.h"
#include "solver/row_iteration.h"

#include <math.h>
#include <stdlib.h>

/* Elements of 1 m2 that each see themselves alone: a part of what it reflects comes back. */
enum { OUTSIDE, ROOM, SHUT_IN, ELEMENTS };

static const double GIVEN[ELEMENTS] = { 1.0, 1e-4, 3e-8 }, BACK[ELEMENTS] = { 0.0, 0.7, 0.999 };

static void gather(void *user, const double *B, double *next) {
    (void)user;
    for (size_t k = 0; k < (size_t)3 * ELEMENTS; k++) next[k] = GIVEN[k / 3] + BACK[k / 3] * B[k];
}

static bool go_on(void *user) {
    (void)user;
    return true;
}

static row_iteration settle(const element *elements, row_tolerance tolerance) {
    row_iteration r = { .elements = elements, .element_count = ELEMENTS, .gather = gather, .go_on = go_on };
    CHECK(row_iteration_open(&r));
    row_iteration_settle(&r, tolerance);
    return r;
}

static double settled(size_t e) {
    return GIVEN[e] / (1.0 - BACK[e]);
}

static void a_dim_room_settles_beside_a_bright_outside(void) {
    element elements[ELEMENTS] = { { .area = 1.0 }, { .area = 1.0 }, { .area = 1.0 } };
    row_iteration r = settle(elements, ROW_ITERATION_CONVERGED);
    CHECK_NEAR(r.B[3 * OUTSIDE], 1.0, 1e-12);
    /* 1e-5 of all light is 3 % of the room's. */
    CHECK_NEAR(r.B[3 * ROOM] / settled(ROOM), 1.0, 0.04);
    CHECK(r.count < 40);
    row_iteration_free(&r);
    /* The light of all alone ends before the room has half of its own. */
    r = settle(elements, (row_tolerance){ ROW_ITERATION_CONVERGED.all, INFINITY });
    CHECK(r.B[3 * ROOM] < 0.7 * settled(ROOM));
    row_iteration_free(&r);
}

int main(void) {
    RUN(a_dim_room_settles_beside_a_bright_outside);
    return check_end();
}
