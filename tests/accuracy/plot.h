/* SPDX-License-Identifier: MIT
 * How do curves become an SVG picture? Axes with ticks, one polyline a curve, a legend; logarithmic where asked.
 */
#ifndef HEMIBAKE_TESTS_PLOT_H
#define HEMIBAKE_TESTS_PLOT_H

#include <math.h>
#include <stdio.h>

enum { PLOT_WIDTH = 760, PLOT_HEIGHT = 480, PLOT_LEFT = 70, PLOT_RIGHT = 200, PLOT_TOP = 40, PLOT_BOTTOM = 50 };

typedef struct plot {
    FILE *file;
    double x_low, x_high, y_low, y_high;
    int log_x, log_y;
    int curves;
} plot;

static inline double plot_place(double value, double low, double high, int logarithmic) {
    if (logarithmic) value = log10(value), low = log10(low), high = log10(high);
    return (value - low) / (high - low);
}

static inline double plot_x(const plot *p, double x) {
    return PLOT_LEFT + (PLOT_WIDTH - PLOT_LEFT - PLOT_RIGHT) * plot_place(x, p->x_low, p->x_high, p->log_x);
}

static inline double plot_y(const plot *p, double y) {
    y = y < p->y_low ? p->y_low : y > p->y_high ? p->y_high : y;
    return PLOT_HEIGHT - PLOT_BOTTOM -
           (PLOT_HEIGHT - PLOT_TOP - PLOT_BOTTOM) * plot_place(y, p->y_low, p->y_high, p->log_y);
}

static inline void plot_ticks(plot *p, int vertical) {
    double low = vertical ? p->y_low : p->x_low, high = vertical ? p->y_high : p->x_high;
    int logarithmic = vertical ? p->log_y : p->log_x;
    for (int i = 0; i <= 5; i++) {
        double value = logarithmic ? low * pow(high / low, i / 5.0) : low + (high - low) * i / 5.0;
        double x = vertical ? PLOT_LEFT : plot_x(p, value), y = vertical ? plot_y(p, value) : PLOT_HEIGHT - PLOT_BOTTOM;
        double x2 = vertical ? PLOT_WIDTH - PLOT_RIGHT : x, y2 = vertical ? y : PLOT_TOP;
        fprintf(p->file, "<line x1='%.1f' y1='%.1f' x2='%.1f' y2='%.1f' stroke='#ddd'/>\n", x, y, x2, y2);
        fprintf(p->file, "<text x='%.1f' y='%.1f' text-anchor='%s'>%.3g</text>\n", vertical ? x - 6 : x,
                vertical ? y + 4 : y + 18, vertical ? "end" : "middle", value);
    }
}

/* False if the file cannot be made. */
static inline int plot_begin(plot *p, const char *path, const char *title, const char *x_label) {
    p->file = fopen(path, "w");
    if (!p->file) return 0;
    p->curves = 0;
    fprintf(p->file,
            "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' font-family='sans-serif' font-size='12'>\n"
            "<rect width='100%%' height='100%%' fill='white'/>\n<text x='%d' y='22' font-size='15'>%s</text>\n"
            "<text x='%d' y='%d' text-anchor='middle'>%s</text>\n",
            PLOT_WIDTH, PLOT_HEIGHT, PLOT_LEFT, title, (PLOT_WIDTH - PLOT_RIGHT + PLOT_LEFT) / 2, PLOT_HEIGHT - 12,
            x_label);
    plot_ticks(p, 0);
    plot_ticks(p, 1);
    return 1;
}

static inline void plot_curve(plot *p, const char *name, const double *x, const double *y, int count) {
    static const char *const colors[] = { "#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#8c564b",
                                          "#e377c2", "#7f7f7f", "#bcbd22", "#17becf" };
    const char *color = colors[p->curves % 9];
    fprintf(p->file, "<polyline fill='none' stroke='%s' stroke-width='1.6' points='", color);
    for (int i = 0; i < count; i++) fprintf(p->file, "%.1f,%.1f ", plot_x(p, x[i]), plot_y(p, y[i]));
    fprintf(p->file, "'/>\n<text x='%d' y='%d' fill='%s'>%s</text>\n", PLOT_WIDTH - PLOT_RIGHT + 10,
            PLOT_TOP + 14 + 18 * p->curves, color, name);
    p->curves++;
}

static inline void plot_end(plot *p) {
    fprintf(p->file, "</svg>\n");
    fclose(p->file);
}

#endif
