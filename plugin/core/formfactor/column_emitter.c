/* SPDX-License-Identifier: MIT
 * What does every sample get from an emitter? Hemi-cubes on its corners and its centre tell which samples see nothing
 * of it; for the others, if anything is in the way, what they see of it is cut out exactly (emitter_visibility.h). So
 * penumbras have no steps, however close one looks. Through a slot a sample may see some of an emitter and none of
 * those points; it is believed to see nothing where one surface hides all of the emitter, or what hides it is a mosaic.
 */
#include "formfactor/column_worker.h"

#include "formfactor/emitter_visibility.h"

#include <string.h>

/* A corner of the emitter may touch a wall; the hemi-cube on it is moved so far towards the centre. */
static const double INSET = 0.02;

enum { VIEWS_MAX = 5 };

/* What less than this is seen of, past what hides it from all views, is seen through no slot: blockers that touch leak
 * by the tolerance of planes. A slot of 1 mm in front of a lamp of half a metre leaves ten times as much. */
static const double MISSED_LEAST = 2e-4;

/* factors: as if nothing stood between. Returns how many there are. */
static size_t start(column_worker *w, const subpatch *emitter, const mesh *m, const column_receiver *receivers,
                    size_t count, float *factors) {
    size_t next = 0;
    for (size_t r = 0; r < count; next += receivers[r++].sample_count) {
        bool any = unoccluded_factors(w, emitter, m, &receivers[r]);
        for (uint32_t k = 0; k < receivers[r].sample_count; k++)
            factors[next + k] = any && w->batch[k] > 0.0 ? (float)w->batch[k] : 0.0f;
    }
    return next;
}

static void look(column_worker *w, const subpatch *emitter, const mesh *m, const column_receiver *receivers,
                 size_t count, const float *factors) {
    size_t next = 0;
    for (size_t r = 0; r < count; next += receivers[r++].sample_count)
        for (uint32_t k = 0; k < receivers[r].sample_count; k++)
            if (factors[next + k] > 0.0f && !w->seen[next + k] && column_sees_sample(w, emitter, m, &receivers[r], k))
                w->seen[next + k] = 1;
}

/* May a sample that none of the views sees do so through a slot or a hole? */
static bool may_be_missed(const emitter_visibility *sight, size_t blockers, const polygon *emitter,
                          const double point[3]) {
    if (emitter_visibility_has_holes(sight, blockers)) return true;
    return emitter_visibility_is_exact(sight, blockers) &&
           !emitter_visibility_is_behind_one(sight, blockers, emitter, point);
}

/* What a sample gets of the emitter past so many blockers; unoccluded: without them. */
static double factor_past(column_worker *w, const emitter_visibility *sight, size_t blockers, const polygon *emitter,
                          const double point[3], const double normal[3], bool seen, double unoccluded) {
    double factor = 0.0;
    if (!seen && !may_be_missed(sight, blockers, emitter, point)) return 0.0;
    if (!emitter_visibility_factor(sight, emitter, point, normal, &factor)) w->failed = true;
    return seen || factor > MISSED_LEAST * unoccluded ? factor : 0.0;
}

/* Cuts out what the samples of one receiver see of the emitter, where they see some of it. */
static void cut_out(column_worker *w, const subpatch *emitter, const mesh *m, const column_receiver *r,
                    const uint8_t *seen, float *factors) {
    const scene *surroundings = w->setup->scene;
    emitter_visibility sight = { surroundings, NULL, 0, w->blockers };
    for (uint32_t k = 0; k < r->sample_count; k++) {
        uint32_t i = r->first_sample + k;
        double point[3];
        if (factors[k] <= 0.0f) continue;
        column_place(w, emitter, m, r, k, point);
        if (!sight.candidates) {
            sight.candidate_count = emitter_visibility_candidates(surroundings, &emitter->shape, r->center,
                                                                  0.5 * r->diameter, w->candidates);
            sight.candidates = w->candidates;
        }
        size_t blockers = emitter_visibility_list(&sight, &emitter->shape, point);
        if (seen[k] && blockers == 0) continue;
        const double *normal = mesh_sample_normal(m, &surroundings->surfaces[r->surface], i);
        double factor = factor_past(w, &sight, blockers, &emitter->shape, point, normal, seen[k], (double)factors[k]);
        w->statistics.penumbra += seen[k] ? m->sample_area[i] * factors[k] / emitter->area : 0.0;
        factors[k] = (float)(emitter->coverage * factor);
    }
}

void column_emitter_factors(column_worker *w, const subpatch *emitter, const mesh *m, const column_receiver *receivers,
                            size_t count, float *factors) {
    double points[VIEWS_MAX][3];
    int views = emitter->shape.count + 1;
    polygon_centroid(&emitter->shape, points[0]);
    for (int i = 0; i < emitter->shape.count; i++) {
        const double *corner = emitter->shape.corner[i];
        for (int k = 0; k < 3; k++) points[i + 1][k] = corner[k] + INSET * (points[0][k] - corner[k]);
    }
    size_t next = 0, samples = start(w, emitter, m, receivers, count, factors);
    if (!block_reserve(w->setup->mesh->memory, (void **)&w->seen, &w->seen_capacity, samples, 1)) w->failed = true;
    if (w->failed) return;
    memset(w->seen, 0, samples);
    for (int v = 0; v < views; v++) {
        column_look_from_point(w, emitter, points[v], emitter->path + (uint64_t)v);
        w->statistics.hemicubes++;
        hemicube_closure c =
            hemicube_close(&w->cube, w->setup->weights_light, w->setup->scene, w->setup->triangle_surface);
        w->statistics.closure.front += c.front / views;
        w->statistics.closure.back += c.back / views;
        w->statistics.closure.sky += c.sky / views;
        look(w, emitter, m, receivers, count, factors);
    }
    for (size_t r = 0; r < count; next += receivers[r++].sample_count)
        cut_out(w, emitter, m, &receivers[r], w->seen + next, factors + next);
}

void column_shoot_emitter(column_worker *w, const subpatch *emitter) {
    const mesh *m = w->setup->mesh;
    column_receiver *receivers = block_new(w->setup->mesh->memory, (m->patch_count + 1) * sizeof *receivers);
    float *factors = block_new(w->setup->mesh->memory, (m->sample_count + 1) * sizeof *factors);
    w->failed = w->failed || !receivers || !factors;
    for (size_t p = 0; !w->failed && p < m->patch_count; p++) receivers[p] = column_patch_receiver(m, (uint32_t)p);
    if (!w->failed) column_emitter_factors(w, emitter, m, receivers, m->patch_count, factors);
    for (uint32_t p = 0; !w->failed && p < m->patch_count; p++) {
        for (uint32_t i = m->patches[p].first_sample; i < m->patches[p].first_sample + m->patches[p].sample_count;
             i++) {
            w->sum[i] = factors[i];
            if (factors[i] > 0.0f) column_mark_reached(w, p);
        }
    }
    w->statistics.split = w->statistics.penumbra > 0.0;
    block_free_all(receivers, factors);
}
