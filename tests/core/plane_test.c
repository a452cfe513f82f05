/* SPDX-License-Identifier: MIT
 * Is what lies in a plane found in it, and what lies beside it by more than the margin not?
 */
#include "check.h"

#include "geometry/plane.h"

/* x + 2 y + 2 z = 6 */
static const double NORMAL[3] = { 1 / 3., 2 / 3., 2 / 3. };

static void height_is_the_distance_with_a_sign(void) {
    const double on[3] = { 6, 0, 0 }, above[3] = { 7, 2, 2 }, below[3] = { 0, 0, 0 };
    CHECK_NEAR(plane_height(NORMAL, 2.0, on), 0.0, 1e-15);
    CHECK_NEAR(plane_height(NORMAL, 2.0, above), 3.0, 1e-15);
    CHECK_NEAR(plane_height(NORMAL, 2.0, below), -2.0, 1e-15);
}

static void a_margin_holds_on_both_sides_and_for_every_point(void) {
    double points[3][3] = { { 6, 0, 0 }, { 0, 3, 0 }, { 0, 0, 3 } };
    CHECK(plane_holds(NORMAL, 2.0, points, 3, 1e-12));
    for (int i = 0; i < 3; i++)
        for (int side = -1; side <= 1; side += 2) {
            points[i][0] += side * 3e-3; /* by 1e-3 */
            CHECK(plane_holds(NORMAL, 2.0, points, 3, 1.01e-3));
            CHECK(!plane_holds(NORMAL, 2.0, points, 3, 0.99e-3));
            CHECK_EQUAL(plane_holds(NORMAL, 2.0, points, i, 0.99e-3), true);
            points[i][0] -= side * 3e-3;
        }
    points[1][1] = NAN;
    CHECK(!plane_holds(NORMAL, 2.0, points, 3, 1.0));
}

static void a_facet_continues_another_up_to_the_angle(void) {
    const double up[3] = { 0, 0, 1 }, down[3] = { 0, 0, -1 };
    for (double angle = 1e-4; angle < 0.1; angle *= 3) {
        const double within[3] = { sin(0.99 * angle), 0, cos(0.99 * angle) },
                     beyond[3] = { 0, sin(1.01 * angle), cos(1.01 * angle) };
        CHECK(plane_continues(up, within, angle));
        CHECK(plane_continues(within, up, angle));
        CHECK(!plane_continues(up, beyond, angle));
    }
    CHECK(plane_continues(up, up, 0.0));
    CHECK(!plane_continues(up, down, 0.1)); /* the same plane, but its back */
}

int main(void) {
    RUN(height_is_the_distance_with_a_sign);
    RUN(a_margin_holds_on_both_sides_and_for_every_point);
    RUN(a_facet_continues_another_up_to_the_angle);
    return check_end();
}
