/* SPDX-License-Identifier: MIT
 * Are the worst elements split, as many as there may be, and more where the goal is far off? Do those count for more
 * whose faults are seen before others?
 */
#include "adapt/worst_elements.h"
#include "check.h"

enum { COUNT = 1000, MOST = 50, FAR = 400 };
static const double GOAL = 0.01;

/* Leaves of one square metre and a radiance of 1, the first `bad` of which are off by so much. */
static size_t mark(size_t bad, double off, size_t most, size_t far, worst_elements *w) {
    static leaf leaves[COUNT];
    CHECK(worst_elements_create(NULL, COUNT, w));
    for (size_t i = 0; i < COUNT; i++) w->errors[i] = i < bad ? off * off : 0.0, w->areas[i] = 1.0;
    w->level = w->area = COUNT;
    return worst_elements_mark(w, leaves, 1, GOAL, most, far);
}

static void the_worst_are_marked_until_the_goal_is_met(void) {
    worst_elements w;
    /* 100 of 1,000 m2 that are off by 4 % are .16 of the 1,000; a split takes three quarters of .0016 away, and 50
     * leave the .1 that 1 % is. */
    CHECK_EQUAL(mark(100, 0.04, 200, 200, &w), 50);
    for (size_t i = 0; i < COUNT; i++) CHECK(!w.marks[i] || i < 100);
    worst_elements_free(&w);
    CHECK_EQUAL(mark(100, 0.005, 200, 200, &w), 0);
    worst_elements_free(&w);
}

static void there_are_more_only_where_the_goal_is_far_off(void) {
    worst_elements w;
    /* 300 that are off by 8 % are 4.4 % of the whole, less than five times the goal. */
    CHECK_EQUAL(mark(300, 0.08, MOST, FAR, &w), MOST);
    worst_elements_free(&w);
    /* Off by half, they are 27 %: all are worth it, and 300 splits leave 14 %. */
    CHECK_EQUAL(mark(300, 0.5, MOST, FAR, &w), 300);
    worst_elements_free(&w);
    CHECK_EQUAL(mark(600, 0.5, MOST, FAR, &w), FAR);
    worst_elements_free(&w);
    /* By 10 %, they are 5.5 %: no more splits than leave 5 %. */
    size_t few = mark(300, 0.1, MOST, FAR, &w);
    CHECK(few > MOST && few < 100);
    worst_elements_free(&w);
}

/* One element on a smooth patch and one on a flat one, as far off. */
static void what_is_large_and_smooth_counts_for_more(void) {
    patch patches[] = { { .is_smooth = true }, { .is_smooth = false } };
    element elements[] = { { .patch = 0, .area = 1 }, { .patch = 1, .area = 1 } };
    const mesh m = { .patches = patches, .elements = elements, .vertices = (double[]){ 0, 0, 0 } };
    const scene s = { 0 };
    for (int by_rows = 0; by_rows < 2; by_rows++) {
        worst_elements w;
        CHECK(worst_elements_create(NULL, 2, &w));
        for (int i = 0; i < 2; i++) w.errors[i] = w.levels[i] = 1.0;
        worst_elements_weigh(&w, &s, &m, by_rows);
        CHECK(by_rows ? w.errors[0] == w.errors[1] : w.errors[0] > 4.0 * w.errors[1]);
        CHECK_NEAR(w.errors[1], 1.0, 0);
        CHECK_NEAR(w.level, 2.0, 0);
        worst_elements_free(&w);
    }
}

int main(void) {
    RUN(the_worst_are_marked_until_the_goal_is_met);
    RUN(there_are_more_only_where_the_goal_is_far_off);
    RUN(what_is_large_and_smooth_counts_for_more);
    return check_end();
}
