/* SPDX-License-Identifier: MIT
 * What does the paper report of form factors, and what do we get? One row a figure, ours beside the paper's, and a
 * check of each against its closed form. The rows on whole solutions need the full matrix and the original progressive
 * refinement, which the solver does not have yet; they are listed, and left open.
 */
#include "check.h"
#include "formfactor/polygon.h"
#include "formfactor/polygon_pair.h"
#include "formfactor/proximity.h"

/* S1 = 1 x 5 on the floor, S2 = 1 x 1 upright on the shared unit edge. */
static const polygon S1 = { { { 0, 0, 0 }, { 5, 0, 0 }, { 5, 1, 0 }, { 0, 1, 0 } }, 4 };
static const polygon S2 = { { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 0, 0, 1 } }, 4 };
static const double UP[3] = { 0, 0, 1 }, ALONG[3] = { 1, 0, 0 };
static const double CENTER1[3] = { 2.5, 0.5, 0 }, CENTER2[3] = { 0, 0.5, 0.5 };

/* [Howell82, C-14] */
static const double F12_EXACT = 0.049379801134337785;

static void row(const char *what, const char *paper, double ours, const char *remark) {
    printf("%-62s %-10s %-10.5g %s\n", what, paper, ours, remark);
}

static void open_row(const char *what, const char *paper) {
    printf("%-62s %-10s %-10s needs --method fm and pr\n", what, paper, "-");
}

static void rectangles_that_share_an_edge(void) {
    const factor_request request = { .absolute = 1e-10 };
    double F12 = polygon_pair_factor(polygon_boundary(&S1), polygon_boundary(&S2), &request).value;
    double F21 = polygon_pair_factor(polygon_boundary(&S2), polygon_boundary(&S1), &request).value;
    double F_d12 = polygon_factor(&S2, CENTER1, UP), F_d21 = polygon_factor(&S1, CENTER2, ALONG);
    row("F21", ".247", F21, "");
    row("F12", ".0494", F12, "");
    row("F_d12, from the centre of S1", ".00857", F_d12, "");
    row("F_d21, from the centre of S2", ".238", F_d21, "a misprint: the closed form gives .24686");
    row("I2 / I1 of pr, instead of .247", ".0429", 5 * F_d12, "5 F_d12");
    /* 1e-10 was asked for. */
    CHECK_NEAR(F12, F12_EXACT, 1e-10);
    CHECK_NEAR(F21, 5 * F12_EXACT, 1e-10);
    /* What the paper prints, to its last digit. */
    CHECK_NEAR(F_d12, 0.00857, 5e-6);
    CHECK_NEAR(5 * F_d12, 0.0429, 1e-4);
}

static void figure_four(void) {
    double hundred = 1.0;
    while (proximity_error(PROXIMITY_CORNER, PROXIMITY_PARALLEL, hundred) < 1.0) hundred *= 0.999;
    row("figure 4, corner, parallel: above 100 % below (diameters)", "0.3", hundred, "");
    row("figure 4, corner, parallel: error at 1 diameter", "< .025",
        fabs(proximity_error(PROXIMITY_CORNER, PROXIMITY_PARALLEL, 1.0)), "see figure4.csv: the closed form says more");
    row("figure 4, worst case: below 2.5 % beyond (diameters)", "5", proximity_distance(0.025), "");
    CHECK_NEAR(proximity_distance(0.025), 5.0, 0.25);
}

static void whole_solutions(void) {
    open_row("328 patches, 8176 elements: error of pr / hybrid against fm", "19 % / 4 %");
    open_row("hybrid against analytic, every iteration", "< .01 %");
    open_row("share of pixels done analytically", "62 %");
    open_row("time hybrid : analytic", "47.5:70.9");
}

int main(void) {
    printf("%-62s %-10s %-10s\n", "what", "paper", "ours");
    RUN(rectangles_that_share_an_edge);
    RUN(figure_four);
    whole_solutions();
    return check_end();
}
