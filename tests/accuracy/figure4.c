/* SPDX-License-Identifier: MIT
 * The paper's figure 4: relative error of the hemi-cube's form factor against distance in diameters, for three pixels
 * and three orientations of the element. Writes figure4.csv and figure4.svg to the folder that is given (default: here)
 * and checks what the paper says of it, beside what the closed form gives.
 */
#include "check.h"
#include "formfactor/near_distance.h"
#include "plot.h"

enum { POINTS = 120 };

static const char *const NAMES[3][3] = { { "parallel, centre", "perpendicular, centre", "radial, centre" },
                                         { "parallel, corner", "perpendicular, corner", "radial, corner" },
                                         { "parallel, side", "perpendicular, side", "radial, side" } };

static const char *folder = ".";

static double distance_at(int i) {
    return 0.1 * pow(100.0, i / (POINTS - 1.0));
}

static void the_curves_are_written(void) {
    char path[1024];
    double x[POINTS], y[POINTS];
    plot p = { .x_low = 0.1, .x_high = 10, .y_low = -1, .y_high = 1.5, .log_x = 1 };
    snprintf(path, sizeof path, "%s/figure4.csv", folder);
    FILE *csv = fopen(path, "w");
    snprintf(path, sizeof path, "%s/figure4.svg", folder);
    CHECK(csv && plot_begin(&p, path, "Relative error of the hemi-cube form factor", "distance / diameter"));
    if (!csv || !p.file) return;
    fprintf(csv, "distance");
    for (int k = 0; k < 9; k++) fprintf(csv, ",\"%s\"", NAMES[k / 3][k % 3]);
    for (int i = 0; i < POINTS; i++) {
        fprintf(csv, "\n%.6g", distance_at(i));
        for (int k = 0; k < 9; k++)
            fprintf(csv, ",%.6g",
                    near_distance_error((near_distance_pixel)(k / 3), (near_distance_normal)(k % 3), distance_at(i)));
    }
    fprintf(csv, "\n");
    fclose(csv);
    for (int k = 0; k < 9; k++) {
        for (int i = 0; i < POINTS; i++)
            x[i] = distance_at(i),
            y[i] = near_distance_error((near_distance_pixel)(k / 3), (near_distance_normal)(k % 3), x[i]);
        plot_curve(&p, NAMES[k / 3][k % 3], x, y, POINTS);
    }
    plot_end(&p);
}

static void radial_and_parallel_are_one_curve_at_the_centre(void) {
    /* The paper's caption; the two are one computation up to rounding. */
    for (int i = 0; i < POINTS; i++)
        CHECK_NEAR(near_distance_error(NEAR_DISTANCE_CENTER, NEAR_DISTANCE_RADIAL, distance_at(i)),
                   near_distance_error(NEAR_DISTANCE_CENTER, NEAR_DISTANCE_PARALLEL, distance_at(i)), 1e-12);
}

static void errors_grow_without_bound_near_and_vanish_far(void) {
    CHECK(near_distance_error(NEAR_DISTANCE_CENTER, NEAR_DISTANCE_PARALLEL, 0.01) > 100);
    CHECK(near_distance_error(NEAR_DISTANCE_CORNER, NEAR_DISTANCE_PARALLEL, 0.2) > 1);
    for (int k = 0; k < 9; k++)
        if (k != NEAR_DISTANCE_PERPENDICULAR) /* at the centre: edge-on, -1 everywhere */
            CHECK_NEAR(near_distance_error((near_distance_pixel)(k / 3), (near_distance_normal)(k % 3), 100), 0.0,
                       1e-3);
}

static void the_worst_case_needs_five_diameters_for_two_and_a_half_percent(void) {
    double distance = near_distance(0.025);
    printf("worst case below 2.5 %%: paper 5 diameters, ours %.3f\n", distance);
    double hundred = 1.0;
    while (near_distance_error(NEAR_DISTANCE_CORNER, NEAR_DISTANCE_PARALLEL, hundred) < 1.0) hundred *= 0.999;
    printf("corner, parallel: above 100 %% below %.2f diameters (paper 0.3), %.1f %% at 1 (paper 2.5 %%)\n", hundred,
           100 * fabs(near_distance_error(NEAR_DISTANCE_CORNER, NEAR_DISTANCE_PARALLEL, 1)));
    /* "At least five": the paper reads it off a plot. */
    CHECK_NEAR(distance, 5.0, 0.25);
    for (int pixel = 0; pixel < 3; pixel++)
        for (int normal = 0; normal < 3; normal++)
            if (pixel != NEAR_DISTANCE_CENTER || normal != NEAR_DISTANCE_PERPENDICULAR)
                CHECK(fabs(near_distance_error((near_distance_pixel)pixel, (near_distance_normal)normal, distance)) <=
                      0.025 + 1e-9);
}

static void the_distance_follows_the_bound_as_its_inverse_root(void) {
    /* The leading error term falls with the square of the distance. */
    CHECK_NEAR(near_distance(1e-4) / near_distance(4e-4), 2.0, 0.01);
}

int main(int argc, char **argv) {
    if (argc > 1) folder = argv[1];
    RUN(the_curves_are_written);
    RUN(radial_and_parallel_are_one_curve_at_the_centre);
    RUN(errors_grow_without_bound_near_and_vanish_far);
    RUN(the_worst_case_needs_five_diameters_for_two_and_a_half_percent);
    RUN(the_distance_follows_the_bound_as_its_inverse_root);
    return check_end();
}
