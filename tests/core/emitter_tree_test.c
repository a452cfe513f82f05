/* SPDX-License-Identifier: MIT
 * Are emitters picked by the light they may give, and is what is left of the number that picked one as good as a new
 * one?
 */
#include "base/sobol.h"
#include "solver/emitter_tree.h"

#include "../check.h"

enum { POINTS = 1 << 12, PARTS = 8 };

static const double FROM[3] = { 0, 0, 0 }, UP[3] = { 0, 0, 1 };

/* Two panels over a point, on either side, of which the first emits three times as much. */
static emitter_tree two_panels(tree_emitter emitters[2], tree_node nodes[3]) {
    for (int i = 0; i < 2; i++) {
        const double power = i == 0 ? 3 : 1;
        emitters[i] = (tree_emitter){ .center = { 2 * i - 1, 0, 5 }, .normal = { 0, 0, -1 }, .luminance = power };
        nodes[1 + i] =
            (tree_node){ .center = { 2 * i - 1, 0, 5 }, .axis = { 0, 0, -1 }, .radius = 0.1, .power = power };
    }
    return (emitter_tree){ .emitters = emitters, .count = 2, .nodes = nodes };
}

static void emitters_are_picked_by_their_light_and_the_rest_of_the_number_is_even(void) {
    tree_emitter emitters[2];
    tree_node nodes[3] = { { .power = 4 } };
    const emitter_tree t = two_panels(emitters, nodes);
    int first = 0, parts[2][PARTS] = { { 0 } };
    for (uint32_t i = 0; i < POINTS; i++) {
        double number = sobol_1d(i, 5), probability;
        const tree_emitter *one = emitter_tree_sample(&t, FROM, UP, &number, &probability);
        int which = one == &emitters[1];
        first += which == 0;
        CHECK_NEAR(probability, which == 0 ? 0.75 : 0.25, 1e-9);
        CHECK(number >= 0.0 && number <= 1.0);
        parts[which][(int)fmin(PARTS * number, PARTS - 1)]++;
    }
    CHECK_NEAR(first, 0.75 * POINTS, 2);
    for (int which = 0; which < 2; which++)
        for (int k = 0; k < PARTS; k++) CHECK_NEAR(parts[which][k], (which == 0 ? 0.75 : 0.25) * POINTS / PARTS, 2);
}

int main(void) {
    RUN(emitters_are_picked_by_their_light_and_the_rest_of_the_number_is_even);
    return check_end();
}
