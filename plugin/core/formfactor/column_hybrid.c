/* SPDX-License-Identifier: MIT
 * What does every sample get from a subpatch, by the hybrid of [Baum89, sec. 5]? See column.h for how and where it
 * differs from the paper.
 */
#include "formfactor/column_worker.h"

#include "base/splitmix.h"
#include "base/tolerance.h"
#include "formfactor/hemicube_visibility.h"
#include "geometry/vec3.h"
#include "scene/contact_lines.h"

#include <string.h>

static void place(column_worker *w, const subpatch *from, const double point[3], uint64_t path) {
    const column_setup *setup = w->setup;
    double eye[3];
    w->cube.resolution = from->emits ? setup->resolution_light : setup->resolution;
    vec3_add_scaled(eye, point, TOLERANCE_EYE_LIFT * setup->scene->radius, from->normal);
    /* The turn about the normal is so that the pixel grids of neighbours do not line up to a plaid. */
    double turn = splitmix_unit(splitmix(setup->seed ^ splitmix(from->patch)) ^ path) * 2.0 * PI;
    hemicube_place(&w->cube, eye, from->normal, turn);
}

void column_look_from_point(column_worker *w, const subpatch *from, const double point[3], uint64_t path) {
    place(w, from, point, path);
    if (!hemicube_draw(&w->cube, w->items, w->setup->scene->center)) w->failed = true;
}

static void look(column_worker *w, const subpatch *from) {
    column_look_from_point(w, from, from->center, from->path);
}

bool column_sees_sample(const column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r,
                        uint32_t k) {
    double point[3];
    column_place(w, from, m, r, k, point);
    return hemicube_sees(&w->cube, w->setup->scene, w->setup->triangle_surface, r->surface, point);
}

/* ---- all samples of the mesh ---- */

void column_open_subpatch(column_worker *w, const subpatch *from, subpatch_factors *out) {
    const column_setup *setup = w->setup;
    look(w, from);
    w->statistics.hemicubes++;
    out->closure = hemicube_close(&w->cube, from->emits ? setup->weights_light : setup->weights, setup->scene,
                                  setup->triangle_surface);
}

/* Writes the factors of one receiving patch; false if none of its samples gets any. */
static bool receive(column_worker *w, const subpatch *from, uint32_t receiver_index, subpatch_factors *out) {
    const mesh *m = w->setup->mesh;
    const column_receiver r = column_patch_receiver(m, receiver_index);
    float *factors = out->factors + r.first_sample;
    bool any = false;
    memset(factors, 0, r.sample_count * sizeof *factors);
    if (m->patches[receiver_index].contact == CONTACT_FOOT || !unoccluded_factors(w, from, m, &r)) return false;
    for (uint32_t k = 0; k < r.sample_count; k++) {
        uint32_t i = r.first_sample + k;
        if (w->batch[k] <= 0.0 || !column_sees_sample(w, from, m, &r, k)) continue;
        factors[k] = (float)w->batch[k];
        if (m->patches[receiver_index].contact != CONTACT_COPY) out->received += m->sample_area[i] * w->batch[k];
        any = true;
    }
    return any;
}

void column_shoot_subpatch(column_worker *w, const subpatch *from, subpatch_factors *out) {
    out->received = 0.0;
    for (uint32_t p = 0; p < w->setup->mesh->patch_count; p++)
        if (receive(w, from, p, out)) column_mark_reached(w, p);
}

void column_add_subpatch(column_worker *w, const subpatch *from, const subpatch_factors *f, double share) {
    const mesh *m = w->setup->mesh;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->sample_count; k++)
            w->sum[receiver->first_sample + k] += f->factors[receiver->first_sample + k];
    }
    w->statistics.closure.front += share * f->closure.front;
    w->statistics.closure.back += share * f->closure.back;
    w->statistics.closure.sky += share * f->closure.sky;
    column_add_path(w, from->path);
}

void column_keep_cube(column_worker *w) {
    w->packed_count = hemicube_pack(&w->cube, NULL);
    w->packed = block_new(w->setup->mesh->memory, (2 * w->packed_count + 1) * sizeof *w->packed);
    if (w->packed)
        hemicube_pack(&w->cube, w->packed);
    else
        w->packed_count = 0;
}

void column_scale_sums(column_worker *w, double scale) {
    const mesh *m = w->setup->mesh;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->sample_count; k++) w->sum[receiver->first_sample + k] *= scale;
    }
    w->statistics.subpatch_scale *= scale;
    w->statistics.closure.front *= scale;
    w->statistics.closure.back *= scale;
    w->statistics.closure.sky *= scale;
}

void column_forget_reached(column_worker *w) {
    for (size_t i = 0; i < w->reached_count; i++) w->is_reached[w->reached[i]] = false;
    w->reached_count = 0;
}

/* ---- other receivers ---- */

void column_receive_hybrid(column_worker *w, const column *c, const subpatch *shooter, const mesh *receiving,
                           const column_receiver *receivers, size_t count, float *factors) {
    if (shooter->emits && w->setup->exact_emitters)
        column_emitter_factors(w, shooter, receiving, receivers, count, factors);
    for (size_t i = 0; i < c->path_count; i++) {
        const subpatch from = subpatch_of_path(shooter, c->paths[i]);
        if (c->packed) {
            place(w, &from, from.center, from.path);
            hemicube_unpack(&w->cube, c->packed, c->packed_count);
        } else {
            look(w, &from);
        }
        float *next = factors;
        for (size_t r = 0; r < count; next += receivers[r++].sample_count) {
            if (!unoccluded_factors(w, &from, receiving, &receivers[r])) continue;
            for (uint32_t k = 0; k < receivers[r].sample_count; k++)
                if (w->batch[k] > 0.0 && column_sees_sample(w, &from, receiving, &receivers[r], k))
                    next[k] += (float)w->batch[k];
        }
    }
}
