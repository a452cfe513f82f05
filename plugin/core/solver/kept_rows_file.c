/* SPDX-License-Identifier: MIT
 * See kept_rows_file.h.
 */
#include "solver/kept_rows_file.h"

#include <math.h>
#include <string.h>

/* Weights of a row are brought to 1 in floats. */
static const double SUM_MOST = 1.0 + 1e-3;

static size_t ray_total(const kept_rows *k) {
    const mesh *m = k->rays.mesh;
    size_t e = m->element_count;
    return e > 0 ? row_begin(&k->rays, e - 1, element_corner_count(&m->elements[e - 1])) : 0;
}

/* ---- writing ---- */

static void write_panes(const kept_rows *k, chunk_writer *w) {
    const row_panes *p = &k->rays.panes;
    for (size_t s = 0; p->of_sample && s < k->rays.mesh->sample_count; s++)
        chunk_write(w, "pane", p->of_sample[s].all, p->of_sample[s].count * sizeof *p->of_sample[s].all);
}

void kept_rows_write(const kept_rows *k, chunk_writer *w) {
    const row_rays *r = &k->rays;
    size_t elements = r->mesh->element_count, total = ray_total(k), open = 0;
    for (size_t i = 0; i < total; i++) open += r->hit[i] == ROW_HIT_SKY;
    chunk_write(w, "rays", r->counts, elements * sizeof *r->counts);
    chunk_write(w, "hits", r->hit, total * sizeof *r->hit);
    chunk_write(w, "wght", r->weight, total * sizeof *r->weight);
    chunk_write(w, "skyd", k->sky_direction, open * sizeof *k->sky_direction);
    write_panes(k, w);
}

/* ---- reading ---- */

static bool fail(chunk_reader *r) {
    if (r->fault == CHUNK_FINE) r->fault = CHUNK_UNEXPECTED;
    return false;
}

/* Replaces an array of so many, which has room for one more, by what is read. */
static bool read_array(chunk_reader *r, const char *tag, void **array, size_t unit, size_t expected) {
    void *found;
    size_t count;
    if (!chunk_read_block(r, tag, unit, &found, &count)) return false;
    block_free(*array);
    *array = found;
    return count == expected || fail(r);
}

/* Every hit is an element there is, or one of the marks; weights are shares. */
static bool check_rows(const kept_rows *k, size_t element_index) {
    const row_rays *r = &k->rays;
    for (int c = 0; c < element_corner_count(&r->mesh->elements[element_index]); c++) {
        size_t begin = row_begin(r, element_index, c);
        double sum = 0.0;
        for (size_t i = begin; i < begin + row_count(r, element_index); i++) {
            bool is_hit = r->hit[i] < k->with->mesh->element_count || r->hit[i] >= ROW_HIT_BACK ||
                          (r->hit[i] == ROW_HIT_PANES && r->panes.of_sample);
            if (!is_hit || !(r->weight[i] >= 0.0f)) return false;
            sum += (double)r->weight[i];
        }
        if (!(sum <= SUM_MOST)) return false;
    }
    return true;
}

static bool check_terms(const kept_rows *k, const row_pane_terms *terms, size_t ray_count) {
    for (size_t i = 0; i < terms->count; i++) {
        const row_pane_term *t = &terms->all[i];
        if (t->ray >= ray_count || (i > 0 && t->ray < terms->all[i - 1].ray)) return false;
        if (t->element >= k->with->mesh->element_count && t->element != NO_INDEX) return false;
        for (int c = 0; c < 3; c++)
            if (!(t->T[c] >= 0.0f && t->T[c] <= 1.0f)) return false;
    }
    return true;
}

static bool read_panes(chunk_reader *r, kept_rows *k) {
    const mesh *m = k->rays.mesh;
    for (size_t e = 0; k->rays.panes.of_sample && e < m->element_count; e++)
        for (int c = 0; c < element_corner_count(&m->elements[e]); c++) {
            row_pane_terms *terms = &k->rays.panes.of_sample[m->elements[e].first_sample + (size_t)c];
            void *found;
            if (!chunk_read_block(r, "pane", sizeof *terms->all, &found, &terms->count)) return false;
            terms->all = found, terms->capacity = terms->count;
            if (!check_terms(k, terms, row_count(&k->rays, e))) return fail(r);
        }
    return true;
}

/* Where the rays of each element begin, and their directions to the sky. False: they are more than there can be. */
static bool set_begins(kept_rows *k, size_t *total) {
    const mesh *m = k->rays.mesh;
    *total = 0;
    for (size_t e = 0; e < m->element_count; e++) {
        k->rays.begin[e] = *total;
        *total += row_count(&k->rays, e) * (size_t)element_corner_count(&m->elements[e]);
    }
    return *total < SIZE_MAX / sizeof(double);
}

static size_t set_sky_begins(kept_rows *k) {
    const mesh *m = k->rays.mesh;
    size_t seen = 0;
    for (size_t e = 0; e < m->element_count; e++) {
        size_t end = row_begin(&k->rays, e, element_corner_count(&m->elements[e]));
        k->sky_begin[e] = seen;
        for (size_t i = k->rays.begin[e]; i < end; i++) seen += k->rays.hit[i] == ROW_HIT_SKY;
    }
    return seen;
}

static bool read_rows(chunk_reader *r, kept_rows *k) {
    row_rays *all = &k->rays;
    size_t elements = all->mesh->element_count, total;
    if (!read_array(r, "rays", (void **)&all->counts, sizeof *all->counts, elements)) return false;
    if (!set_begins(k, &total)) return fail(r);
    if (!read_array(r, "hits", (void **)&all->hit, sizeof *all->hit, total)) return false;
    if (!read_array(r, "wght", (void **)&all->weight, sizeof *all->weight, total)) return false;
    for (size_t e = 0; e < elements; e++)
        if (!check_rows(k, e)) return fail(r);
    return read_array(r, "skyd", (void **)&k->sky_direction, sizeof *k->sky_direction, set_sky_begins(k)) &&
           read_panes(r, k);
}

kept_rows *kept_rows_read(chunk_reader *r, final_gather *with, const mesh *parts, const uint32_t *roots) {
    kept_rows *k = kept_rows_open(with, parts, roots);
    if (!k && r->fault == CHUNK_FINE) r->fault = CHUNK_NO_MEMORY;
    if (k && read_rows(r, k)) return k;
    kept_rows_free(k);
    return NULL;
}
