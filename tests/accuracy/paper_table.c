/* SPDX-License-Identifier: MIT
 * What does the paper report of form factors, and what do we get? One row a figure, ours beside the paper's, and a
 * check of each: form factors against closed forms, whole solutions on the paper's test environment against the full
 * matrix.
 */
#include "accuracy/paper_room.h"
#include "check.h"
#include "factors/polygon_pair.h"
#include "formfactor/near_distance.h"
#include "geometry/polygon.h"

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
    while (near_distance_error(NEAR_DISTANCE_CORNER, NEAR_DISTANCE_PARALLEL, hundred) < 1.0) hundred *= 0.999;
    row("figure 4, corner, parallel: above 100 % below (diameters)", "0.3", hundred, "");
    row("figure 4, corner, parallel: error at 1 diameter", "< .025",
        fabs(near_distance_error(NEAR_DISTANCE_CORNER, NEAR_DISTANCE_PARALLEL, 1.0)),
        "see figure4.csv: the closed form says more");
    row("figure 4, worst case: below 2.5 % beyond (diameters)", "5", near_distance(0.025), "");
    CHECK_NEAR(near_distance(0.025), 5.0, 0.25);
}

/* One method on the paper's room: B of its elements, and what it took. */
static double *solve(paper_room *p, jobs *j, solver_method method, progressive_result *out) {
    char message[200];
    double *B = malloc(3 * PAPER_ELEMENTS * sizeof *B);
    progressive_setup setup = paper_setup(p, method, j, paper_seconds);
    const char *failure = progressive_solve(&setup, out, message, sizeof message);
    if (failure) fprintf(stderr, "%s\n", failure);
    CHECK(B && !failure && out->converged);
    if (B && !failure) paper_radiosity(&p->room, out->irradiance, B);
    return B;
}

static void whole_solutions(void) {
    static const solver_method methods[] = { SOLVER_FM, SOLVER_PR, SOLVER_HYBRID, SOLVER_ANALYTIC };
    static paper_room p;
    progressive_result results[4];
    double *B[4];
    paper_room_create(&p);
    jobs *j = jobs_create(0);
    CHECK_EQUAL(p.room.mesh.patch_count, PAPER_PATCHES);
    CHECK_EQUAL(p.room.mesh.element_count, PAPER_ELEMENTS);
    for (int i = 0; i < 4; i++) B[i] = solve(&p, j, methods[i], &results[i]);
    double pr = paper_error(&p.room, B[0], B[1]), hybrid = paper_error(&p.room, B[0], B[2]);
    double apart = paper_error(&p.room, B[2], B[3]);
    row("328 patches, 8176 elements: error of pr against fm", ".19", pr, "");
    row("error of hybrid against fm", ".04", hybrid, "");
    row("hybrid against analytic", "< .0001", apart, "the paper's D_min is not told; ours allows 2.5 % a factor");
    row("hybrid: share of factors by the closed form", ".62",
        (double)results[2].analytic / (double)results[2].evaluations, "of samples; the paper's of pixels");
    row("time hybrid : analytic", "0.67",
        (results[2].factors_s + results[2].solve_s) / (results[3].factors_s + results[3].solve_s),
        "one run; tests/bench/paper takes the median");
    /* At least what the paper has: 4 % and 19 % are a ratio of 4.75, and 2 % is half of 4 %. */
    CHECK(hybrid <= 0.02);
    CHECK(pr >= 4 * hybrid);
    CHECK(apart <= 0.001);
    for (int i = 0; i < 4; i++) {
        free(B[i]);
        progressive_result_free(&results[i]);
    }
    jobs_destroy(j);
    paper_room_free(&p);
}

int main(void) {
    printf("%-62s %-10s %-10s\n", "what", "paper", "ours");
    RUN(rectangles_that_share_an_edge);
    RUN(figure_four);
    RUN(whole_solutions);
    return check_end();
}
