/* SPDX-License-Identifier: MIT
 * See adapt.h. What was found stays with the leaves: a leaf that is not cut keeps its samples and their light.
 */
#include "adapt.h"

#include "adapt/error_indicator.h"
#include "adapt/refined_gather.h"
#include "mesh/refinement.h"
#include "reconstruct/fit_samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A share of the irradiance that one shooter may be off by where it is not received finely. Measured on the scenes of
 * tests/accuracy: a tenth of it changes errors by less than 0.02 %, ten times as much by 0.1 %. */
static const double RECEIVER_TOLERANCE = 5e-4;

/* What is off by less than this share of the goal is left: cutting it could not make up for what steps of light leave.
 */
static const double GOOD_ENOUGH = 0.5;

/* Once cut, an element is off by this much less, squared: 16 where radiance is smooth, 2 where a shadow has its edge.
 */
static const double GAIN_OF_A_CUT = 4.0;

enum { SAMPLES_MAX = 4 }; /* of a leaf */

/* So many receive at a time: what is known while shooters give to them is ten times what is kept. */
enum { FRESH_AT_ONCE = 16384 };

/* What is known at the samples of the leaves; [SAMPLES_MAX*leaf+k], times three where it has bands. */
typedef struct leaf_light {
    double *irradiance, *row_sum;
    double *arrived; /* of it; NULL: none */
    float *direct_row_sum;
} leaf_light;

typedef struct adapting {
    const adapt_setup *setup;
    bake_scene *f;
    direct_light *direct;
    progressive_result *light;
    refinement *tree;
    mesh gradient_mesh; /* of the leaves, once they are the shooters' elements: light->gradient */
    arena gradient_memory;
    direct_light sky; /* at the samples of the mesh that was solved with; empty without a sky */
    leaf_light now;
    bool even; /* all elements are cut alike, as asked for and not by their light */
    uint64_t fine, pairs;
} adapting;

/* What the leaves are off by. */
typedef struct faults {
    double *of, *areas; /* of leaves: squares integrated over them; m2 */
    double level, area; /* of all: squares of radiance, integrated; m2 */
} faults;

/* A mark and what it is worth. */
typedef struct candidate {
    double fault;
    uint32_t leaf;
} candidate;

/* ---- light of leaves -----------------------------------------------------------------------------------------------
 */

static void leaf_light_free(leaf_light *l) {
    block_free(l->irradiance);
    block_free(l->row_sum);
    block_free(l->arrived);
    block_free(l->direct_row_sum);
    memset(l, 0, sizeof *l);
}

static bool leaf_light_create(allocator *memory, size_t leaves, bool arrives, leaf_light *out) {
    size_t n = SAMPLES_MAX * leaves + 1;
    *out = (leaf_light){ .irradiance = block_zeroed(memory, 3 * n, sizeof *out->irradiance),
                         .row_sum = block_zeroed(memory, n, sizeof *out->row_sum) };
    if (arrives) out->arrived = block_zeroed(memory, 3 * n, sizeof *out->arrived);
    if (arrives) out->direct_row_sum = block_zeroed(memory, n, sizeof *out->direct_row_sum);
    return out->irradiance && out->row_sum && (!arrives || (out->arrived && out->direct_row_sum));
}

/* Copies a leaf's samples: those from `from` on there to those from `to` on here, which may be the same arrays. */
static void copy_samples(const leaf_light *in, size_t from, size_t count, const leaf_light *out, size_t to) {
    memmove(out->irradiance + 3 * to, in->irradiance + 3 * from, 3 * count * sizeof *out->irradiance);
    memmove(out->row_sum + to, in->row_sum + from, count * sizeof *out->row_sum);
    if (!in->arrived) return;
    memmove(out->arrived + 3 * to, in->arrived + 3 * from, 3 * count * sizeof *out->arrived);
    memmove(out->direct_row_sum + to, in->direct_row_sum + from, count * sizeof *out->direct_row_sum);
}

static leaf_light of_mesh(const adapting *a) {
    return (leaf_light){ .irradiance = a->light->irradiance,
                         .row_sum = a->light->row_sum,
                         .arrived = a->direct->irradiance,
                         .direct_row_sum = a->direct->row_sum };
}

static hemi_result open_leaves(adapting *a) {
    const leaf_light solved = of_mesh(a);
    const refinement_setup setup = { &a->f->scene, &a->f->mesh, &a->f->vertices, a->f->sources };
    a->tree = refinement_create(&setup);
    if (!a->tree) return HEMI_ERROR_MEMORY;
    if (a->even) return HEMI_OK;
    if (!leaf_light_create(a->f->memory.memory, a->f->mesh.element_count, solved.arrived != NULL, &a->now))
        return HEMI_ERROR_MEMORY;
    for (size_t e = 0; e < a->f->mesh.element_count; e++) {
        const element *one = &a->f->mesh.elements[e];
        copy_samples(&solved, one->first_sample, (size_t)element_corner_count(one), &a->now, SAMPLES_MAX * e);
    }
    return HEMI_OK;
}

/* ---- light of the sky ----------------------------------------------------------------------------------------------
 *
 * Its shadows have no edges but those of contact, and a thousand directions are dear: refined elements take it from the
 * coarse one, linearly. Lights, whose shadows are sharp, are looked for anew.
 */

static hemi_result arrive_from_lights(const adapting *a, const mesh *at, direct_light *out) {
    char message[160];
    direct_light_setup setup = a->setup->arriving;
    setup.mesh = at;
    const char *failure = lights_arrive_punctual(a->setup->lights, &setup, out, message, sizeof message);
    return failure ? context_core_failure(a->setup->in->context, failure) : HEMI_OK;
}

static hemi_result open_sky(adapting *a) {
    const mesh *m = &a->f->mesh;
    const direct_light *all = a->direct;
    if (!a->setup->lights->has_sky || !all->irradiance) return HEMI_OK;
    hemi_result result = arrive_from_lights(a, m, &a->sky);
    if (result != HEMI_OK) return result;
    for (size_t k = 0; k < 3 * m->sample_count; k++)
        a->sky.irradiance[k] = fmax(all->irradiance[k] - a->sky.irradiance[k], 0.0);
    for (size_t s = 0; s < m->sample_count; s++) a->sky.row_sum[s] = fmaxf(all->row_sum[s] - a->sky.row_sum[s], 0.0f);
    return HEMI_OK;
}

/* arrived += the light of the sky at the samples of a fine element. */
static void add_sky(const adapting *a, const element *fine, const fine_place *place, const direct_light *arrived) {
    const element *coarse = &a->f->mesh.elements[place->coarse];
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
static hemi_result arrive(adapting *a, const mesh *fresh, const fine_place *places, direct_light *out) {
    if (!a->direct->irradiance) return HEMI_OK;
    hemi_result result = arrive_from_lights(a, fresh, out);
    for (size_t e = 0; result == HEMI_OK && e < fresh->element_count; e++)
        add_sky(a, &fresh->elements[e], &places[e], out);
    return result;
}

/* ---- which to cut --------------------------------------------------------------------------------------------------
 */

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->fault != y->fault) return x->fault < y->fault ? 1 : -1;
    return (x->leaf > y->leaf) - (x->leaf < y->leaf);
}

/* Marks the worst until what is left is below the goal, or `most` are marked. */
static size_t mark_worst(const adapting *a, const faults *f, size_t count, size_t most, bool *marks, candidate *list) {
    const leaf *leaves = refinement_leaves(a->tree, &(uint32_t){ 0 });
    double left = 0.0, goal = a->setup->options->adapt_error * a->setup->options->adapt_error * f->level;
    double good = GOOD_ENOUGH * GOOD_ENOUGH * goal / f->area;
    size_t listed = 0, marked = 0;
    for (size_t i = 0; i < count; i++) {
        left += f->of[i];
        if ((int)leaves[i].level < a->setup->options->adapt_levels && f->of[i] > good * f->areas[i])
            list[listed++] = (candidate){ f->of[i], (uint32_t)i };
    }
    qsort(list, listed, sizeof *list, compare_candidates);
    for (; marked < listed && marked < most && left > goal; marked++) {
        marks[list[marked].leaf] = true;
        left -= list[marked].fault * (1.0 - 1.0 / GAIN_OF_A_CUT);
    }
    return marked;
}

static bool indicate(const adapting *a, const mesh *whole, const leaf_light *at, faults *f) {
    const fit_samples_input in = { .mesh = whole,
                                   .vertex_nodes = a->f->vertices.nodes,
                                   .irradiance = at->irradiance,
                                   .row_sum = at->row_sum,
                                   .direct_row_sum = at->direct_row_sum,
                                   .crossed = a->light->crossed };
    fit_samples samples;
    bool ok = fit_samples_create(&in, &samples);
    const error_indicator_input seen = { .mesh = whole,
                                         .node = samples.nodes,
                                         .node_count = a->f->vertices.node_count,
                                         .radiance = samples.radiance,
                                         .weight = samples.weight };
    ok = ok && error_indicator_measure(&seen, f->of, &f->level);
    f->area = 0.0;
    for (size_t i = 0; i < whole->element_count; i++) f->area += f->areas[i] = whole->elements[i].area;
    fit_samples_free(&samples);
    return ok;
}

/* The light of the leaves in the order of a mesh's samples; out may be where it is, since no sample comes later. */
static void put_in_order(const adapting *a, const mesh *whole, const leaf_light *out) {
    for (size_t i = 0; i < whole->element_count; i++)
        copy_samples(&a->now, SAMPLES_MAX * i, (size_t)element_corner_count(&whole->elements[i]), out,
                     whole->elements[i].first_sample);
}

/* From now on the shooters are as uneven as what the leaves have received. Takes the mesh and its memory. */
static bool renew_gradient(adapting *a, const mesh *whole, arena *memory, const leaf_light *at) {
    shooter_gradient_free(&a->light->gradient);
    arena_free(&a->gradient_memory);
    a->gradient_mesh = *whole;
    a->gradient_memory = *memory;
    memset(memory, 0, sizeof *memory);
    return shooter_gradient_create(&a->f->scene, &a->gradient_mesh, at->irradiance, at->row_sum, a->light->crossed,
                                   &a->light->gradient);
}

/* Where a texture stays, what is shown is the light alone: gives a mesh of leaves such elements, of its own. */
static bool show_demodulated(const adapting *a, const leaf *leaves, arena *memory, mesh *whole) {
    if (!a->f->demodulated) return true;
    element *shown = arena_alloc(memory, whole->element_count, sizeof *shown);
    for (size_t i = 0; shown && i < whole->element_count; i++) {
        shown[i] = whole->elements[i];
        shown[i].material = &a->f->demodulated[leaves[i].root];
    }
    whole->elements = shown;
    return shown;
}

/* What is judged is what will be shown. */
static hemi_result measure(adapting *a, const leaf *leaves, uint32_t count, faults *f) {
    arena memory = { .memory = a->f->memory.memory };
    mesh whole;
    leaf_light at = { 0 };
    bool ok = refinement_mesh(a->tree, &memory, &whole) && show_demodulated(a, leaves, &memory, &whole) &&
              leaf_light_create(a->f->memory.memory, count, a->now.arrived != NULL, &at);
    if (ok) put_in_order(a, &whole, &at);
    ok = ok && indicate(a, &whole, &at, f);
    if (ok && count > a->f->mesh.element_count) ok = renew_gradient(a, &whole, &memory, &at);
    leaf_light_free(&at);
    arena_free(&memory);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* Marks what to cut and cuts it; *cut: whether anything was. Past the budget fewer are marked, the worst. */
static hemi_result cut_leaves(adapting *a, bool *cut) {
    uint32_t count;
    const leaf *leaves = refinement_leaves(a->tree, &count);
    const bake_options *o = a->setup->options;
    allocator *memory = a->f->memory.memory;
    faults f = { .of = block_new(memory, (count + 1) * sizeof *f.of),
                 .areas = block_new(memory, (count + 1) * sizeof *f.areas) };
    candidate *list = block_new(a->f->memory.memory, (count + 1) * sizeof *list);
    bool *marks = block_new(a->f->memory.memory, count + 1);
    hemi_result result = f.of && f.areas && list && marks ? measure(a, leaves, count, &f) : HEMI_ERROR_MEMORY;
    size_t most = o->max_elements > count ? (o->max_elements - count) / 3 : 0;
    *cut = false;
    while (result == HEMI_OK && most > 0 && !*cut) {
        memset(marks, 0, count);
        size_t marked = mark_worst(a, &f, count, most, marks, list);
        if (marked == 0) break;
        refinement_result split = refinement_split(a->tree, marks, o->max_elements);
        *cut = split == REFINEMENT_OK;
        if (split == REFINEMENT_NO_MEMORY) result = HEMI_ERROR_MEMORY;
        most = marked / 2;
    }
    block_free(f.of);
    block_free(f.areas);
    block_free(list);
    block_free(marks);
    return result;
}

/* ---- what the cut ones receive -------------------------------------------------------------------------------------
 */

/* Light of leaves as they were before the split goes to where they are now; fresh ones are left for take_fresh. */
static bool move_light(adapting *a, const leaf *leaves, uint32_t count) {
    leaf_light next;
    bool ok = leaf_light_create(a->f->memory.memory, count, a->direct->irradiance != NULL, &next);
    for (size_t i = 0; ok && i < count; i++)
        if (!leaves[i].is_new)
            copy_samples(&a->now, SAMPLES_MAX * (size_t)leaves[i].origin, SAMPLES_MAX, &next, SAMPLES_MAX * i);
    leaf_light_free(&a->now);
    a->now = next;
    return ok;
}

static void take_fresh(adapting *a, const leaf *leaves, uint32_t begin, uint32_t end, const mesh *fresh,
                       const refined_gather_result *received, const direct_light *arrived) {
    const leaf_light found = { received->irradiance, received->row_sum, arrived->irradiance, arrived->row_sum };
    size_t e = 0;
    for (size_t i = begin; i < end; i++) {
        if (!leaves[i].is_new) continue;
        const element *one = &fresh->elements[e++];
        size_t samples = (size_t)element_corner_count(one);
        for (size_t k = 3 * (size_t)one->first_sample; found.arrived && k < 3 * (one->first_sample + samples); k++)
            found.irradiance[k] += found.arrived[k];
        copy_samples(&found, one->first_sample, samples, &a->now, SAMPLES_MAX * i);
    }
}

static bool wait(void *user) {
    const adapting *a = user;
    return !a->setup->progress || a->setup->progress(a->setup->progress_user, 0.0);
}

static hemi_result receive(adapting *a, const mesh *fresh, const fine_place *places, refined_gather_result *out) {
    char message[160];
    const refined_gather_setup setup = { .store = &a->light->store,
                                         .irradiance = a->light->irradiance,
                                         .row_sum = a->light->row_sum,
                                         .near = &a->light->gradient,
                                         .fine = fresh,
                                         .places = places,
                                         .tolerance = RECEIVER_TOLERANCE,
                                         .emitters_are_fine = a->even,
                                         .wait = wait,
                                         .wait_user = a };
    const char *failure = refined_gather(&setup, out, message, sizeof message);
    if (failure) return context_core_failure(a->setup->in->context, failure);
    a->fine += out->fine, a->pairs += out->pairs;
    return out->cancelled ? HEMI_CANCELLED : HEMI_OK;
}

/* The fresh ones of the leaves from begin to end. */
static hemi_result light_some(adapting *a, const leaf *leaves, uint32_t begin, uint32_t end) {
    arena memory = { .memory = a->f->memory.memory };
    mesh fresh;
    direct_light arrived = { 0 };
    refined_gather_result received = { 0 };
    hemi_result result = HEMI_ERROR_MEMORY;
    fine_place *places = block_new(a->f->memory.memory, (end - begin + 1) * sizeof *places);
    size_t e = 0;
    for (size_t i = begin; places && i < end; i++)
        if (leaves[i].is_new) places[e++] = (fine_place){ leaves[i].root, leaves[i].u, leaves[i].v, leaves[i].size };
    if (places && refinement_mesh_of_new(a->tree, begin, end, &memory, &fresh))
        result = arrive(a, &fresh, places, &arrived);
    if (result == HEMI_OK) result = receive(a, &fresh, places, &received);
    if (result == HEMI_OK) take_fresh(a, leaves, begin, end, &fresh, &received, &arrived);
    refined_gather_free(&received);
    direct_light_free(&arrived);
    arena_free(&memory);
    block_free(places);
    return result;
}

/* Columns that were let go are computed again for each lot, so there is only one then. */
static bool columns_are_kept(const adapting *a) {
    const shooters *s = &a->light->kept;
    for (size_t i = 0; i < s->count; i++)
        if (s->all[i].was_computed && !s->all[i].column) return false;
    return true;
}

/* Where the lot from begin on ends, at the end of a base. */
static uint32_t end_of_lot(const leaf *leaves, uint32_t begin, uint32_t count) {
    uint32_t end = begin;
    for (uint32_t fresh = 0; end < count; end++) {
        if (fresh >= FRESH_AT_ONCE && leaves[end].root != leaves[end - 1].root) break;
        fresh += leaves[end].is_new;
    }
    return end;
}

static hemi_result light_fresh(adapting *a) {
    uint32_t count;
    const leaf *leaves = refinement_leaves(a->tree, &count);
    bool kept = columns_are_kept(a);
    hemi_result result = move_light(a, leaves, count) ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (uint32_t begin = 0, end; result == HEMI_OK && begin < count; begin = end) {
        end = kept ? end_of_lot(leaves, begin, count) : count;
        result = light_some(a, leaves, begin, end);
    }
    return result;
}

/* ---- all of it -----------------------------------------------------------------------------------------------------
 */

/* As often as it was asked for, everywhere. */
static hemi_result cut_evenly(adapting *a) {
    const bake_options *o = a->setup->options;
    refinement_result result = REFINEMENT_OK;
    for (uint32_t level = 0; result == REFINEMENT_OK && level < a->setup->options->even_levels; level++)
        result = refinement_split_all(a->tree, o->max_elements);
    if (result == REFINEMENT_LIMIT) return HEMI_ERROR_LIMIT;
    return result == REFINEMENT_OK ? light_fresh(a) : HEMI_ERROR_MEMORY;
}

static hemi_result cut_by_light(adapting *a, bool *any) {
    hemi_result result = HEMI_OK;
    for (int pass = 0; result == HEMI_OK && pass < a->setup->options->adapt_levels; pass++) {
        bool cut;
        result = cut_leaves(a, &cut);
        if (result != HEMI_OK || !cut) break;
        *any = true;
        a->gradient_mesh.vertices = a->f->vertices.positions;
        result = light_fresh(a);
    }
    return result;
}

/* The leaves are the mesh from now on, and what is known of them goes in the order of its samples. */
static hemi_result replace_mesh(adapting *a) {
    if (!refinement_finish(a->tree, &a->f->memory)) return HEMI_ERROR_MEMORY;
    leaf_light old = of_mesh(a);
    leaf_light_free(&old);
    put_in_order(a, &a->f->mesh, &a->now);
    a->light->irradiance = a->now.irradiance;
    a->light->row_sum = a->now.row_sum;
    a->direct->irradiance = a->now.arrived;
    a->direct->row_sum = a->now.direct_row_sum;
    a->now = (leaf_light){ 0 };
    return build_textures(a->setup->in, a->f);
}

hemi_result adapt(const adapt_setup *setup, bake_scene *f, direct_light *direct, progressive_result *light,
                  double *fine_share) {
    adapting a = { .setup = setup, .f = f, .direct = direct, .light = light, .even = setup->options->even_levels > 0 };
    hemi_result result = open_sky(&a);
    if (result == HEMI_OK) result = open_leaves(&a);
    bool any = a.even;
    if (result == HEMI_OK) result = a.even ? cut_evenly(&a) : cut_by_light(&a, &any);
    if (result == HEMI_OK && any) result = replace_mesh(&a);
    *fine_share = a.pairs ? (double)a.fine / (double)a.pairs : 0.0;
    refinement_free(a.tree);
    shooter_gradient_free(&light->gradient);
    arena_free(&a.gradient_memory);
    direct_light_free(&a.sky);
    leaf_light_free(&a.now);
    return result;
}
