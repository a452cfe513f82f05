/* SPDX-License-Identifier: MIT
 * See forecast.h. Each cost is proportional to what it is spent on, with constants measured on the shared scenes at
 * draft, medium and high (tests/accuracy/forecast.py; Intel Xeon, processor time).
 */
#include "bake/forecast.h"

#include "bake/memory_fit.h"

#include <math.h>
#include <stdio.h>

/* s: starting, with the colour configuration and the first threads. */
static const double START_S = 0.1;

/* s a ray of rows, most of it in Embree; a sample, from making it to its colour; a surface, from finding its face to
 * writing it. */
static const double RAY_S = 0.5e-6, SAMPLE_S = 5e-6, SURFACE_S = 20e-6;

/* s a patch of columns whose hemi-cube has 128 pixels across, and a point at which the error is measured. */
static const double PATCH_S = 1.6e-3, CHECK_S = 1.2e-3;
static const double HEMICUBE_PIXELS = 128.0;

/* s a sample, from its light to its colour; an element, for the triangles that it adds to what is written; a surface
 * or element, until light is looked for. Where those took longer, what follows will too, up to so many times; what
 * starting takes says nothing of that. */
static const double COLOR_S = 2.5e-6, WRITTEN_S = 2.5e-6, MESH_S = 10e-6, SLOWER_MOST = 3.0;

/* No work that more time makes better is ended before so much of a limit is over. */
static const double SHARE_LEAST = 0.25;

/* Where the mesh would take more than this share of a limit it is made as it comes. */
static const double SHARE_OF_MESH = 0.5;

static void add_rows(const bake_options *o, bool emits, forecast *out) {
    double rays = out->samples * (o->rows_initial + (emits ? o->rows_emitter : 0)) + o->rows_adaptive;
    out->processor_s += RAY_S * rays;
}

static void add_columns(const bake_options *o, const mesh *m, forecast *out) {
    double size = o->hemicube / HEMICUBE_PIXELS, patches = (double)m->patch_count;
    out->processor_s += PATCH_S * patches * size * size + CHECK_S * (double)o->check_points;
}

forecast forecast_make(const bake_options *o, const scene *s, const mesh *m, bool emits) {
    double quartered = ldexp(1.0, 2 * (int)o->even_levels);
    forecast out = { .elements = quartered * (double)m->element_count, .samples = quartered * (double)m->sample_count };
    out.processor_s = START_S + SAMPLE_S * out.samples + SURFACE_S * (double)s->surface_count;
    out.memory_bytes = memory_of_bake(o, s, m);
    if (o->method == SOLVER_ROWS)
        add_rows(o, emits, &out);
    else
        add_columns(o, m, &out);
    return out;
}

double forecast_end_s(double limit_s, double share, double colors, const scene *s, const mesh *m, double mesh_s) {
    double slower = (mesh_s - START_S) / (MESH_S * ((double)(s->surface_count + m->element_count) + 1.0));
    double after_s = colors * COLOR_S * (double)m->sample_count + WRITTEN_S * (double)m->element_count;
    double end_s = limit_s - fmin(fmax(slower, 1.0), SLOWER_MOST) * after_s;
    return fmax(fmin(share * limit_s, end_s), SHARE_LEAST * limit_s);
}

bool forecast_hurries(double limit_s, double triangles, char said[QUALITY_LINE_SIZE]) {
    snprintf(said, QUALITY_LINE_SIZE,
             "%.0f triangles are more than there is time for: they are not cut where others stand on them or near "
             "lamps, and what lies in each other is neither joined nor counted",
             triangles);
    return limit_s > 0.0 && MESH_S * triangles > SHARE_OF_MESH * limit_s;
}
