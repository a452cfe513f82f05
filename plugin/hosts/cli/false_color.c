/* SPDX-License-Identifier: MIT */
#include "false_color.h"

#include <math.h>

/* From 0 to the full error, black by violet and orange to light yellow. */
static const double COLORS[][3] = {
    { 0.0, 0.0, 0.01 }, { 0.09, 0.01, 0.15 }, { 0.5, 0.04, 0.12 }, { 0.95, 0.3, 0.02 }, { 0.97, 0.95, 0.4 }
};
enum { COLOR_STEPS = sizeof COLORS / sizeof *COLORS - 1 };

void false_color(double share, float rgb[3]) {
    double at = fmin(fmax(share, 0.0), 1.0) * COLOR_STEPS;
    int step = at >= COLOR_STEPS ? COLOR_STEPS - 1 : (int)at;
    for (int k = 0; k < 3; k++)
        rgb[k] = (float)(COLORS[step][k] + (at - step) * (COLORS[step + 1][k] - COLORS[step][k]));
}
