/* SPDX-License-Identifier: MIT
 * The paper's figure 6, aliasing: the form factor of a small square element as whole pixels of a hemi-cube count it,
 * while it shrinks and slides, at several resolutions. Writes figure6.csv and figure6.svg to the folder that is given
 * (default: here) and checks that the error falls with the resolution.
 */
#include "check.h"
#include "formfactor/hemicube.h"
#include "formfactor/hemicube_weights.h"
#include "geometry/polygon.h"
#include "plot.h"

#include <stdlib.h>

enum { RESOLUTIONS = 4, SLIDES = 80, SIZES = 6 };

static const int RESOLUTION[RESOLUTIONS] = { 50, 100, 200, 400 };
static const char *folder = ".";

/* No multiple of a pixel at any of the resolutions. */
static const double SIZE = 0.047;

/* The square of an edge `size`, one metre above the eye and slid along x, facing down. Its middle is on no edge of a
 * pixel at any of the resolutions. */
static polygon element_at(double size, double slide) {
    double x0 = slide - 0.5 * size, x1 = slide + 0.5 * size, y0 = 0.0171 - 0.5 * size, y1 = 0.0171 + 0.5 * size;
    polygon p = { { { x0, y0, 1 }, { x0, y1, 1 }, { x1, y1, 1 }, { x1, y0, 1 } }, 4 };
    return p;
}

static double exact_factor(double size, double slide) {
    const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };
    polygon p = element_at(size, slide);
    return polygon_factor(&p, origin, up);
}

/* Sum of the weights of the pixels that show the element [Baum89, eq. 7]. */
static double counted_factor(int resolution, double size, double slide) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    polygon p = element_at(size, slide);
    float positions[12];
    char message[128];
    double sum = 0.0;
    size_t pixels = 3 * (size_t)resolution * (size_t)resolution;
    for (int i = 0; i < 12; i++) positions[i] = (float)p.corner[i / 3][i % 3];
    item_geometry geometry = {
        .positions = positions, .vertex_count = 4, .indices = indices, .triangle_count = 2, .near_plane = 1e-6f
    };
    item_buffer *items =
        item_buffer_open(&(item_buffer_desc){ .geometry = &geometry, .width = resolution, .height = 3 * resolution },
                         message, sizeof message);
    hemicube h = { .resolution = resolution, .ids = malloc(pixels * sizeof(uint32_t)) };
    double *weights = malloc(pixels * sizeof *weights);
    const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };
    CHECK(items && h.ids && weights);
    if (items && h.ids && weights) {
        hemicube_weights(resolution, weights);
        hemicube_place(&h, origin, up, 0.0);
        CHECK(hemicube_draw(&h, items, origin));
        for (size_t q = 0; q < pixels; q++) sum += h.ids[q] ? weights[q] : 0.0;
    }
    item_buffer_destroy(items);
    free(h.ids);
    free(weights);
    return sum;
}

static double slide_at(int i) {
    return 0.3 + 0.06 * i / (SLIDES - 1.0);
}

static void sliding_shows_steps_that_shrink_with_the_pixels(void) {
    char path[1024];
    double x[SLIDES], y[SLIDES], worst[RESOLUTIONS];
    plot p = { .x_low = 0.3, .x_high = 0.36, .y_low = -1, .y_high = 1 };
    snprintf(path, sizeof path, "%s/figure6.csv", folder);
    FILE *csv = fopen(path, "w");
    snprintf(path, sizeof path, "%s/figure6.svg", folder);
    CHECK(csv && plot_begin(&p, path, "Relative error of counting pixels, element of 0.047", "place of the element"));
    if (!csv || !p.file) return;
    fprintf(csv, "kind,resolution,size,slide,counted,exact\n");
    for (int r = 0; r < RESOLUTIONS; r++) {
        char name[32];
        worst[r] = 0.0;
        for (int i = 0; i < SLIDES; i++) {
            double counted = counted_factor(RESOLUTION[r], SIZE, slide_at(i)), exact = exact_factor(SIZE, slide_at(i));
            x[i] = slide_at(i);
            y[i] = counted / exact - 1.0;
            worst[r] = fmax(worst[r], fabs(y[i]));
            fprintf(csv, "slide,%d,%.6g,%.6g,%.9g,%.9g\n", RESOLUTION[r], SIZE, x[i], counted, exact);
        }
        snprintf(name, sizeof name, "%d pixels", RESOLUTION[r]);
        plot_curve(&p, name, x, y, SLIDES);
        printf("element of 0.047 sliding, %3d pixels: worst error %5.1f %%\n", RESOLUTION[r], 100 * worst[r]);
    }
    for (int r = 0; r < RESOLUTIONS; r++)
        for (int k = 0; k < SIZES; k++) {
            double size = 0.2 * pow(0.5, k);
            fprintf(csv, "shrink,%d,%.6g,0.33,%.9g,%.9g\n", RESOLUTION[r], size,
                    counted_factor(RESOLUTION[r], size, 0.33), exact_factor(size, 0.33));
        }
    fclose(csv);
    plot_end(&p);
    /* An edge is misplaced by at most half a pixel at each end: the worst error is about pixels^-1. */
    CHECK(worst[3] < 0.35 * worst[0]);
    CHECK(worst[0] > 0.1);
}

static void an_element_smaller_than_a_pixel_is_missed_or_counted_whole(void) {
    /* 0.01 at 50 pixels of 0.04 each: the exact factor is a sixteenth of a pixel's. */
    double size = 0.01, least = INFINITY, most = 0.0;
    for (int i = 0; i < 12; i++) {
        double ratio = counted_factor(50, size, 0.3 + 0.004 * i) / exact_factor(size, 0.3 + 0.004 * i);
        least = fmin(least, ratio), most = fmax(most, ratio);
    }
    printf("element of a quarter of a pixel: counted from %.2f to %.2f of the exact factor\n", least, most);
    CHECK_NEAR(least, 0.0, 0.0);
    CHECK(most > 8.0);
}

int main(int argc, char **argv) {
    if (argc > 1) folder = argv[1];
    RUN(sliding_shows_steps_that_shrink_with_the_pixels);
    RUN(an_element_smaller_than_a_pixel_is_missed_or_counted_whole);
    return check_end();
}
