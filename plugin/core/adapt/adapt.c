/* SPDX-License-Identifier: MIT
 * See adapt.h. What was found stays with the leaves: a leaf that is not split keeps its samples and their light.
 */
#include "adapt/adapt.h"

#include "adapt/refined_gather.h"
#include "adapt/worst_elements.h"
#include "scene/material.h"
#include "solver/final_gather.h"

#include <math.h>
#include <string.h>

static const char NO_MEMORY[] = "out of memory";

/* A share of the irradiance that one shooter may be off by where it is not received finely. Measured on the scenes of
 * tests/accuracy: a tenth of it changes errors by less than 0.02 %, ten times as much by 0.1 %. */
static const double RECEIVER_TOLERANCE = 5e-4;

/* So many receive at a time: what is known while shooters give to them is ten times what is kept. */
enum { NEW_AT_ONCE = 16384 };

typedef struct adapting {
    const adapt_setup *setup;
    mesh *mesh; /* that was solved with */
    direct_light *direct;
    progressive_result *solution;
    adapt_result *out;
    refinement *tree;
    mesh gradient_mesh; /* of the leaves, once they are the shooters' elements: solution->gradient */
    arena gradient_memory;
    direct_light sky; /* at the samples of the mesh that was solved with; empty without a sky */
    leaf_light known;
    double pass_low, pass_high; /* of this lot, as shares of the work */
    const refined_gather_result *receiving;
    bool is_even; /* all elements are split alike, as asked for and not by their light */
    char *message;
    size_t message_size;
} adapting;

static leaf_light light_of_mesh(const adapting *a) {
    const direct_light *d = a->direct;
    const progressive_result *r = a->solution;
    return (leaf_light){ r->irradiance, r->row_sum, d->irradiance, d->row_sum, d->uneven, r->half_difference };
}

/* What is known of the leaves; before any is split they are the elements of the mesh. */
static leaf_light known_of(const adapting *a) {
    return a->known.irradiance ? a->known : light_of_mesh(a);
}

/* ---- who waits ---- */

static bool is_over(const adapting *a) {
    return a->out->cancelled || watcher_over(&a->setup->watch);
}

/* What takes long ends if nobody waits for it. */
static bool wait(void *user) {
    adapting *a = user;
    const watcher *w = &a->setup->watch;
    double done = a->pass_low + (a->receiving ? a->receiving->done * (a->pass_high - a->pass_low) : 0.0);
    a->out->done = fmax(a->out->done, done);
    if (w->wait && !w->wait(w->user)) a->out->cancelled = true;
    return !is_over(a);
}

/* ---- light of the sky ---- */

/* Its shadows have no edges but those of contact, and a thousand directions are dear: refined elements take it from the
 * coarse one, linearly. Lights, whose shadows are sharp, are looked for anew. */

static bool wait_for_lights(void *user, double fraction) {
    (void)fraction;
    return wait(user);
}

static const char *arrive_from_lights(adapting *a, const mesh *at, direct_light *out) {
    direct_light_setup arriving = a->setup->arriving;
    arriving.mesh = at;
    arriving.progress = wait_for_lights;
    arriving.progress_user = a;
    return lights_arrive(a->setup->lights, false, &arriving, out, a->message, a->message_size);
}

static const char *open_sky(adapting *a) {
    const mesh *m = a->mesh;
    const direct_light *all = a->direct;
    if (!a->setup->lights->has_sky || !all->irradiance || a->solution->final_gather) return NULL;
    const char *failure = arrive_from_lights(a, m, &a->sky);
    if (failure || is_over(a)) return failure;
    for (size_t k = 0; k < 3 * m->sample_count; k++)
        a->sky.irradiance[k] = fmax(all->irradiance[k] - a->sky.irradiance[k], 0.0);
    for (size_t s = 0; s < m->sample_count; s++) a->sky.row_sum[s] = fmaxf(all->row_sum[s] - a->sky.row_sum[s], 0.0f);
    return NULL;
}

/* arrived += the light of the sky at the samples of a new element. */
static void add_sky(const adapting *a, const element *fine, const fine_place *place, const direct_light *arrived) {
    const element *coarse = &a->mesh->elements[place->coarse];
    int corner_count = element_corner_count(fine);
    for (int k = 0; a->sky.irradiance && k < corner_count; k++) {
        double w[4], E[3] = { 0, 0, 0 }, row_sum = 0.0;
        size_t to = fine->first_sample + (size_t)k;
        fine_place_weights(place, corner_count, k, w);
        for (size_t i = 0; i < (size_t)corner_count; i++) {
            for (size_t c = 0; c < 3; c++) E[c] += w[i] * a->sky.irradiance[3 * (coarse->first_sample + i) + c];
            row_sum += w[i] * a->sky.row_sum[coarse->first_sample + i];
        }
        for (size_t c = 0; c < 3; c++) arrived->irradiance[3 * to + c] += fmax(E[c], 0.0);
        arrived->row_sum[to] += (float)fmax(row_sum, 0.0);
    }
}

/* What arrives from lights and the sky; stays empty if there is neither. */
static const char *arrive(adapting *a, const mesh *fine, const fine_place *places, direct_light *out) {
    if (!a->direct->irradiance) return NULL;
    const char *failure = arrive_from_lights(a, fine, out);
    for (size_t e = 0; !failure && e < fine->element_count; e++) add_sky(a, &fine->elements[e], &places[e], out);
    return failure;
}

/* ---- which are split ---- */

/* From now on the shooters are as uneven as what the leaves have received. Takes the mesh and its memory. */
static bool renew_gradient(adapting *a, const mesh *whole, arena *memory, const leaf_light *at) {
    shooter_gradient next;
    bool ok = shooter_gradient_create(a->setup->refinement.scene, whole, at->irradiance, at->row_sum,
                                      a->solution->crossed, a->solution->gradient.shot, &next);
    shooter_gradient_free(&a->solution->gradient);
    arena_free(&a->gradient_memory);
    a->gradient_mesh = *whole;
    a->gradient_memory = *memory;
    memset(memory, 0, sizeof *memory);
    a->solution->gradient = next, a->solution->gradient.mesh = &a->gradient_mesh;
    return ok;
}

/* Where a texture stays, what is shown is the light alone: gives a mesh of leaves such elements, of its own. */
static bool show_demodulated(const adapting *a, const leaf *leaves, arena *memory, mesh *whole) {
    if (!*a->setup->demodulated) return true;
    element *shown = arena_alloc(memory, whole->element_count, sizeof *shown);
    for (size_t i = 0; shown && i < whole->element_count; i++) {
        shown[i] = whole->elements[i];
        shown[i].material = &(*a->setup->demodulated)[leaves[i].root];
    }
    whole->elements = shown;
    return shown;
}

/* What is judged is what will be shown. */
static bool measure(adapting *a, const leaf *leaves, uint32_t count, worst_elements *worst) {
    arena memory = { .memory = a->mesh->memory };
    mesh whole;
    const leaf_light at = known_of(a);
    bool ok = refinement_mesh(a->tree, &memory, &whole) && show_demodulated(a, leaves, &memory, &whole);
    ok = ok &&
         a->setup->indicate(&whole, &at, a->solution->crossed, a->setup->arriving.jobs, worst->errors, worst->levels);
    for (uint32_t i = 0; ok && i < count; i++)
        if (material_transmits_diffusely(a->mesh->elements[leaves[i].root].material)) worst->errors[i] = 0.0;
    if (ok) worst_elements_weigh(worst, a->setup->refinement.scene, &whole, a->solution->final_gather);
    if (ok && count > a->mesh->element_count && !a->solution->final_gather)
        ok = renew_gradient(a, &whole, &memory, &at);
    arena_free(&memory);
    return ok;
}

/* Splits the worst leaves, or fewer of them where that would be too many; *any: was any? */
static const char *split_worst(adapting *a, bool *any) {
    const adapt_setup *setup = a->setup;
    uint32_t count;
    const leaf *leaves = refinement_leaves(a->tree, &count);
    worst_elements worst;
    bool ok = worst_elements_create(a->mesh->memory, count, &worst) && measure(a, leaves, count, &worst);
    uint32_t max = setup->max_elements, max_far = setup->max_elements_far;
    size_t most = worst_elements_splits(&worst, max), far = worst_elements_splits(&worst, max_far);
    *any = false;
    while (ok && far > 0 && !*any && !watcher_over(&setup->watch)) {
        size_t marked = worst_elements_mark(&worst, leaves, setup->levels, setup->error, most, far);
        if (marked == 0) break;
        if (marked > most) max = max_far;
        refinement_result result = refinement_split(a->tree, worst.marks, max);
        *any = result == REFINEMENT_OK;
        ok = result != REFINEMENT_NO_MEMORY;
        if (*any) ok = final_gather_keep_split(a->solution->final_gather, worst.marks, count);
        most = far = marked / 2;
    }
    worst_elements_free(&worst);
    return ok ? NULL : NO_MEMORY;
}

/* ---- what the new ones receive ---- */

static const char *receive_by_rows(adapting *a, const mesh *fine, const fine_place *places,
                                   refined_gather_result *out) {
    uint32_t *roots = block_new(fine->memory, (fine->element_count + 1) * sizeof *roots);
    final_gather_result found = { 0 };
    for (size_t e = 0; roots && e < fine->element_count; e++) roots[e] = places[e].coarse;
    bool ok = roots && final_gather_solve(a->solution->final_gather, fine, roots, wait, a, &found);
    block_free(roots);
    if (!ok) return final_gather_result_free(&found), NO_MEMORY;
    *out = (refined_gather_result){ .irradiance = found.irradiance,
                                    .row_sum = found.row_sum,
                                    .half_difference = found.half_difference,
                                    .cancelled = found.cut };
    return NULL;
}

static const char *receive(adapting *a, const mesh *fine, const fine_place *places, refined_gather_result *out) {
    const refined_gather_setup setup = { .store = &a->solution->store,
                                         .irradiance = a->solution->irradiance,
                                         .row_sum = a->solution->row_sum,
                                         .gradient = &a->solution->gradient,
                                         .fine = fine,
                                         .places = places,
                                         .tolerance = RECEIVER_TOLERANCE,
                                         .emitters_are_fine = a->is_even,
                                         .wait = wait,
                                         .wait_user = a };
    if (a->solution->final_gather) return receive_by_rows(a, fine, places, out);
    a->receiving = out;
    const char *failure = refined_gather(&setup, out, a->message, a->message_size);
    a->receiving = NULL;
    a->out->fine += out->fine, a->out->pairs += out->pairs;
    return failure;
}

/* A new one has what the coarse element that it is a part of has where it is. */
static void take_coarse(adapting *a, const fine_place *place, const leaf *to) {
    const leaf_light from = light_of_mesh(a);
    const size_t first = a->mesh->elements[place->coarse].first_sample;
    for (int k = 0; k < to->sample_count; k++) {
        double w[4];
        fine_place_weights(place, to->sample_count, k, w);
        leaf_light_blend(&from, first, w, to->sample_count, &a->known, to->first_sample + (size_t)k);
    }
}

/* The new ones have what they received, if there was time for it; but what the other side of a sheet gives is known of
 * the coarse element alone. */
static void take_new(adapting *a, const leaf *leaves, uint32_t begin, uint32_t end, const mesh *fine,
                     const fine_place *places, const refined_gather_result *received, const direct_light *arrived) {
    const leaf_light found = { received->irradiance, received->row_sum, arrived->irradiance,
                               arrived->row_sum,     arrived->uneven,   received->half_difference };
    bool any = received->irradiance && !received->cancelled;
    size_t e = 0;
    for (size_t k = 0; any && found.arrived && k < 3 * fine->sample_count; k++) found.irradiance[k] += found.arrived[k];
    for (size_t i = begin; i < end; i++) {
        const leaf *l = &leaves[i];
        if (!l->is_new) continue;
        if (any && !material_transmits_diffusely(a->mesh->elements[l->root].material))
            leaf_light_copy(&found, fine->elements[e].first_sample, l->sample_count, &a->known, l->first_sample);
        else
            take_coarse(a, &places[e], l);
        e++;
    }
}

/* The new ones of the leaves from begin to end. */
static const char *light_leaves(adapting *a, const leaf *leaves, uint32_t begin, uint32_t end) {
    arena memory = { .memory = a->mesh->memory };
    mesh fine;
    direct_light arrived = { 0 };
    refined_gather_result received = { 0 };
    const char *failure = NO_MEMORY;
    fine_place *places = block_new(memory.memory, (end - begin + 1) * sizeof *places);
    size_t e = 0;
    for (size_t i = begin; places && i < end; i++)
        if (leaves[i].is_new) places[e++] = (fine_place){ leaves[i].root, leaves[i].u, leaves[i].v, leaves[i].size };
    if (places && refinement_mesh_of_new(a->tree, begin, end, &memory, &fine))
        failure = is_over(a) ? NULL : arrive(a, &fine, places, &arrived);
    if (!failure && !is_over(a)) failure = receive(a, &fine, places, &received);
    if (!failure) take_new(a, leaves, begin, end, &fine, places, &received, &arrived);
    refined_gather_free(&received);
    direct_light_free(&arrived);
    arena_free(&memory);
    block_free(places);
    return failure;
}

/* Columns that were let go are computed again for each lot, so there is only one then. */
static bool columns_are_kept(const adapting *a) {
    const shooters *s = &a->solution->kept;
    for (size_t i = 0; i < s->count; i++)
        if (s->all[i].is_counted && !s->all[i].column) return false;
    return true;
}

/* Where the lot from begin on ends, at the end of a root. */
static uint32_t end_of_lot(const leaf *leaves, uint32_t begin, uint32_t count) {
    uint32_t end = begin;
    for (uint32_t made = 0; end < count; end++) {
        if (made >= NEW_AT_ONCE && leaves[end].root != leaves[end - 1].root) break;
        made += leaves[end].is_new;
    }
    return end;
}

/* low, high: shares of the work at its begin and end. */
static const char *light_new(adapting *a, double low, double high) {
    uint32_t count;
    const leaf *leaves = refinement_leaves(a->tree, &count);
    bool kept = columns_are_kept(a);
    const leaf_light before = known_of(a);
    leaf_light next;
    const char *failure = leaf_light_follow(a->mesh->memory, leaves, count, &before, &next) ? NULL : NO_MEMORY;
    leaf_light_free(&a->known);
    a->known = next;
    for (uint32_t begin = 0, end; !failure && !a->out->cancelled && begin < count; begin = end) {
        end = kept ? end_of_lot(leaves, begin, count) : count;
        a->pass_low = low + (high - low) * begin / count;
        a->pass_high = low + (high - low) * end / count;
        failure = light_leaves(a, leaves, begin, end);
    }
    return failure;
}

/* As often as it was asked for, everywhere. */
static const char *split_evenly(adapting *a) {
    refinement_result result = REFINEMENT_OK;
    for (uint32_t level = 0; result == REFINEMENT_OK && level < a->setup->even_levels; level++)
        result = refinement_split_all(a->tree, a->setup->max_elements);
    if (result == REFINEMENT_LIMIT) return "more elements than are allowed";
    return result == REFINEMENT_OK ? light_new(a, 0.0, 1.0) : NO_MEMORY;
}

/* A thread of its own looks at all leaves, since what it finds goes from leaf to leaf. */
typedef struct splitting {
    adapting *adapting;
    bool any;
    const char *failure;
} splitting;

static void split_alone(void *user) {
    splitting *s = user;
    s->failure = split_worst(s->adapting, &s->any);
}

static bool wait_for_split(void *user) {
    return wait(((splitting *)user)->adapting);
}

static const char *split_by_light(adapting *a, bool *any) {
    const char *failure = NULL;
    for (int pass = 0; !failure && !is_over(a) && pass < a->setup->levels; pass++) {
        splitting split = { a, false, NULL };
        jobs_run_alone(split_alone, wait_for_split, &split);
        failure = split.failure;
        if (failure || !split.any) break;
        *any = true;
        a->gradient_mesh.vertices = a->mesh->vertices;
        failure = light_new(a, (double)pass / a->setup->levels, (pass + 1.0) / a->setup->levels);
    }
    return failure;
}

/* The leaves are the mesh from now on, and what is known of them is at its samples. */
static const char *replace_mesh(adapting *a) {
    uint32_t count;
    const leaf *leaves = refinement_leaves(a->tree, &count);
    if (!final_gather_keep_roots(a->solution->final_gather, leaves, count)) return NO_MEMORY;
    if (!refinement_finish(a->tree, a->setup->memory)) return NO_MEMORY;
    leaf_light old = light_of_mesh(a);
    leaf_light_free(&old);
    a->solution->irradiance = a->known.irradiance;
    a->solution->row_sum = a->known.row_sum;
    a->solution->half_difference = a->known.half_difference;
    a->direct->irradiance = a->known.arrived;
    a->direct->row_sum = a->known.direct_row_sum;
    a->direct->uneven = a->known.uneven;
    a->known = (leaf_light){ 0 };
    return a->setup->shade(a->setup->shade_user);
}

const char *adapt(const adapt_setup *setup, direct_light *direct, progressive_result *solution, adapt_result *out,
                  char *message, size_t message_size) {
    adapting a = { .setup = setup,
                   .mesh = setup->refinement.mesh,
                   .direct = direct,
                   .solution = solution,
                   .out = out,
                   .is_even = setup->even_levels > 0,
                   .message = message,
                   .message_size = message_size };
    bool any = a.is_even;
    *out = (adapt_result){ 0 };
    const char *failure = open_sky(&a);
    a.tree = failure ? NULL : refinement_create(&setup->refinement);
    if (!failure && !a.tree) failure = NO_MEMORY;
    if (!failure && is_over(&a)) any = false;
    if (!failure && !is_over(&a)) failure = a.is_even ? split_evenly(&a) : split_by_light(&a, &any);
    if (!failure && !out->cancelled && any) failure = replace_mesh(&a);
    refinement_free(a.tree);
    shooter_gradient_free(&solution->gradient);
    arena_free(&a.gradient_memory);
    direct_light_free(&a.sky);
    leaf_light_free(&a.known);
    return failure;
}
