/* SPDX-License-Identifier: MIT
 * See memory_fit.h. Peaks were measured on the shared scenes at draft, medium and high (tests/accuracy/memory.py); the
 * constants are such that none of them is above what is predicted by more than a twentieth.
 */
#include "bake/memory_fit.h"

#include "solver/progressive.h"

#include <math.h>
#include <stdio.h>

/* Bytes of the empty process, with OpenGL and its compiler; of a face, from its neighbours to what is written; of a
 * sample, where rows are gathered and where columns are; of a ray, and of an element's form factor to a patch. */
static const double PROCESS = 100.0 * (1 << 20), FACE = 4096.0, SAMPLE_OF_ROWS = 400.0, SAMPLE_OF_COLUMNS = 900.0;
static const double RAY = 8.0, FACTOR = 6.3;

/* Rays that a sample has at least, twice since they are kept beside those that are added; samples of an element. */
static const double RAYS_LEAST = 4.0, SAMPLES_OF_AN_ELEMENT = 3.0;

/* By rows refinement adds about a quarter; columns start with few elements: what is left is halved between columns that
 * are kept and elements that are added. */
static const double GROWTH_OF_ROWS = 0.25, SHARE_OF_COLUMNS = 0.5;

static const double MIB = 1 << 20;

static bool by_rows(const bake_options *o) {
    return o->method == SOLVER_ROWS;
}

static double sample_bytes(const bake_options *o) {
    return by_rows(o) ? SAMPLE_OF_ROWS : SAMPLE_OF_COLUMNS;
}

static double sample_count(const bake_options *o, const mesh *m) {
    return ldexp((double)m->sample_count, 2 * (int)o->even_levels);
}

/* Whatever is left out. */
static double least_bytes(const bake_options *o, const scene *s, const mesh *m) {
    double samples = sample_count(o, m);
    return PROCESS + FACE * (double)s->surface_count + sample_bytes(o) * samples +
           (by_rows(o) ? RAYS_LEAST * RAY * samples : 0.0);
}

/* What rays, or columns that are kept, take beyond the least. */
static double wanted_bytes(const bake_options *o, const mesh *m) {
    double samples = (double)m->sample_count, initial = 2.0 * o->rows_initial * samples;
    if (!by_rows(o)) return FACTOR * (double)m->element_count * (double)m->patch_count;
    return RAY * fmax(fmin(initial, 3.0 * o->rows_adaptive) + o->rows_adaptive - RAYS_LEAST * samples, 0.0);
}

double memory_of_bake(const bake_options *o, const scene *s, const mesh *m) {
    return least_bytes(o, s, m) + fmin(wanted_bytes(o, m), (double)o->memory_limit);
}

uint32_t memory_most_elements(const bake_options *o) {
    double room = fmax((double)o->process_limit - PROCESS, 0.0) / (sample_bytes(o) * SAMPLES_OF_AN_ELEMENT);
    return o->process_limit > 0 && room < (double)o->max_elements ? (uint32_t)room : o->max_elements;
}

/* ---- fitting ---- */

/* Only a full matrix needs memory that cannot be done without. */
static bool check_matrix(const bake_options *o, const mesh *m, char *message, size_t message_size) {
    const progressive_setup solver = { .method = o->method, .columns.mesh = m };
    double bytes = (double)progressive_memory(&solver);
    bool fits = bytes <= (double)o->memory_limit;
    if (bytes > 0.0)
        snprintf(message, message_size, "a full matrix of %zu elements and %zu patches takes %.0f MiB%s",
                 m->element_count, m->patch_count, bytes / MIB, fits ? "" : " and fewer are allowed");
    return fits;
}

bool memory_fit(bake_options *o, const scene *s, const mesh *m, char *message, size_t message_size) {
    double limit = (double)o->process_limit, least = least_bytes(o, s, m), left = limit - least;
    message[0] = 0;
    if (o->process_limit == 0) return check_matrix(o, m, message, message_size);
    if (left < 0.0) {
        snprintf(message, message_size,
                 "%zu elements of %zu faces take about %.0f MiB at the least and %.0f are allowed; allow more, or ask "
                 "for larger elements",
                 m->element_count, s->surface_count, ceil(least / MIB), limit / MIB);
        return false;
    }
    double kept =
        by_rows(o) ? fmax(left - GROWTH_OF_ROWS * sample_bytes(o) * sample_count(o, m), 0.0) : SHARE_OF_COLUMNS * left;
    kept = fmin(kept, wanted_bytes(o, m));
    double elements = ldexp((double)m->element_count, 2 * (int)o->even_levels);
    double most = elements + (left - kept) / sample_bytes(o) * elements / (sample_count(o, m) + 1.0);
    /* Rows count what the least of rays take too. */
    o->memory_limit = (uint64_t)(kept + (by_rows(o) ? RAYS_LEAST * RAY * sample_count(o, m) : 0.0)) + 1;
    if (most < (double)o->max_elements) o->max_elements = (uint32_t)most;
    return check_matrix(o, m, message, message_size);
}
