/* SPDX-License-Identifier: MIT */
#include "comparison.h"

#include "asset_input.h"
#include "bake_probes.h"
#include "heatmap.h"
#include "path_text.h"
#include "preview.h"
#include "printable.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is compared of one asset: its meshes that have light. */
typedef struct lit_meshes {
    match_mesh *meshes;
    hemi_mesh_desc *descs;
    uint32_t *of_asset; /* which meshes of the asset they are */
    size_t count;
} lit_meshes;

typedef struct comparing {
    const options *o;
    console *c;
    const gltf_asset *asset;
    const char *reference;    /* probes, or another bake */
    const match_mesh *meshes; /* those of own */
    lit_meshes own;
    probe_set set;
    match_result match;
    size_t *worst, worst_count; /* probes, the worst first */
} comparing;

/* ---- what is printed --------------------------------------------------------------------------------------------- */

/* Of the sum of squares that the error is. */
static double share_of(const comparing *a, size_t i) {
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = a->match.places[i].radiance[k] - (double)a->set.probes[i].radiance[k];
        square += d * d;
    }
    return a->match.total.difference_squared > 0.0 ? square / a->match.total.difference_squared : 0.0;
}

static void add_figure(match_figure *sum, const match_figure *f) {
    sum->matched += f->matched;
    sum->difference_squared += f->difference_squared;
    sum->truth_squared += f->truth_squared;
    sum->noise_squared += f->noise_squared;
    sum->difference += f->difference;
    sum->truth += f->truth;
}

/* Figures of a node's primitives in one; primitives of a node follow each other. Returns how many nodes there are. */
static size_t by_node(const match_mesh *meshes, const match_result *match, match_figure *nodes, const char **names) {
    size_t count = 0;
    for (size_t i = 0; i < match->mesh_count; i++) {
        const char *name = meshes[i].name ? meshes[i].name : "";
        if (count == 0 || strcmp(names[count - 1], name) != 0) {
            memset(&nodes[count], 0, sizeof nodes[count]);
            names[count++] = name;
        }
        add_figure(&nodes[count - 1], &match->meshes[i]);
    }
    return count;
}

static void add_number(cJSON *object, const char *key, double value) {
    if (value < 1e300)
        cJSON_AddNumberToObject(object, key, value);
    else
        cJSON_AddNullToObject(object, key);
}

enum { NAME_WIDTH = 32 };

static void add_worst(cJSON *root, const comparing *a) {
    cJSON *list = cJSON_AddArrayToObject(root, "worst");
    for (size_t i = 0; i < a->worst_count; i++) {
        cJSON *one = cJSON_CreateObject();
        const probe *p = &a->set.probes[a->worst[i]];
        const match_place *at = &a->match.places[a->worst[i]];
        const double truth[3] = { p->radiance[0], p->radiance[1], p->radiance[2] },
                     position[3] = { p->position[0], p->position[1], p->position[2] };
        cJSON_AddStringToObject(one, "node", a->meshes[at->mesh].name ? a->meshes[at->mesh].name : "");
        cJSON_AddNumberToObject(one, "share", share_of(a, a->worst[i]));
        cJSON_AddItemToObject(one, "position", cJSON_CreateDoubleArray(position, 3));
        cJSON_AddItemToObject(one, "reference", cJSON_CreateDoubleArray(truth, 3));
        cJSON_AddItemToObject(one, "baked", cJSON_CreateDoubleArray(at->radiance, 3));
        cJSON_AddItemToArray(list, one);
    }
}

static void print_json(const comparing *a, const match_figure *nodes, const char **names, size_t count) {
    const match_result *m = &a->match;
    cJSON *root = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(root, "nodes");
    add_number(root, "error", match_error(&m->total));
    add_number(root, "bias", match_bias(&m->total));
    add_number(root, "probe_error_median", m->median);
    add_number(root, "probe_error_95", m->percentile95);
    add_number(root, "reference_noise", match_noise(&m->total));
    cJSON_AddNumberToObject(root, "matched", (double)m->total.matched);
    cJSON_AddNumberToObject(root, "unmatched", (double)m->unmatched);
    for (size_t i = 0; i < count; i++) {
        cJSON *node = cJSON_CreateObject();
        cJSON_AddStringToObject(node, "name", names[i]);
        cJSON_AddNumberToObject(node, "matched", (double)nodes[i].matched);
        if (nodes[i].matched) {
            add_number(node, "error", match_error(&nodes[i]));
            add_number(node, "bias", match_bias(&nodes[i]));
        }
        cJSON_AddItemToArray(list, node);
    }
    if (a->o->worst > 0) add_worst(root, a);
    char *text = cJSON_Print(root);
    if (text) print_json_printable(stdout, text);
    putchar('\n');
    cJSON_free(text);
    cJSON_Delete(root);
}

static void print_worst(const comparing *a) {
    if (a->worst_count == 0) return;
    printf("%-32s %8s %26s %24s %24s\n", "where it sits", "share", "x y z, m", "reference", "baked");
    for (size_t i = 0; i < a->worst_count; i++) {
        const probe *p = &a->set.probes[a->worst[i]];
        const match_place *at = &a->match.places[a->worst[i]];
        const float *x = p->position, *L = p->radiance;
        print_padded(a->meshes[at->mesh].name ? a->meshes[at->mesh].name : "", NAME_WIDTH);
        printf(" %7.2f%% %8.3f %8.3f %8.3f %8.3g %7.3g %7.3g %8.3g %7.3g %7.3g\n", 100 * share_of(a, a->worst[i]),
               (double)x[0], (double)x[1], (double)x[2], (double)L[0], (double)L[1], (double)L[2], at->radiance[0],
               at->radiance[1], at->radiance[2]);
    }
}

static void print_table(const comparing *a, const match_figure *nodes, const char **names, size_t count) {
    const match_result *m = &a->match;
    printf("%-32s %8s %10s %10s\n", "node", "probes", "error", "bias");
    for (size_t i = 0; i < count; i++) {
        if (nodes[i].matched == 0) continue;
        print_padded(names[i], NAME_WIDTH);
        printf(" %8zu %9.3f%% %+9.3f%%\n", nodes[i].matched, 100 * match_error(&nodes[i]), 100 * match_bias(&nodes[i]));
    }
    printf("%-32s %8zu %9.3f%% %+9.3f%%\n", "all", m->total.matched, 100 * match_error(&m->total),
           100 * match_bias(&m->total));
    printf("relative error %.4f; %zu probes matched, %zu unmatched; noise of the reference %.4f\n",
           match_error(&m->total), m->total.matched, m->unmatched, match_noise(&m->total));
    printf("half of the probes are off by less than %.2f %%, 95 %% by less than %.2f %%, each of itself\n",
           100 * m->median, 100 * m->percentile95);
    print_worst(a);
}

/* ---- the worst --------------------------------------------------------------------------------------------------- */

/* Keeps the worst so far in order, the worst first; of equals the first. */
static void keep_worst(comparing *a, size_t i) {
    double share = share_of(a, i);
    size_t at = a->worst_count;
    while (at > 0 && share_of(a, a->worst[at - 1]) < share) at--;
    if (at >= a->o->worst) return;
    if (a->worst_count < a->o->worst) a->worst_count++;
    memmove(a->worst + at + 1, a->worst + at, (a->worst_count - at - 1) * sizeof *a->worst);
    a->worst[at] = i;
}

static bool find_worst(comparing *a) {
    a->worst = malloc((a->o->worst + 1) * sizeof *a->worst);
    for (size_t i = 0; a->worst && i < a->set.count; i++)
        if (a->match.places[i].mesh != MATCH_NONE) keep_worst(a, i);
    return a->worst;
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

static bool has_radiosity(const gltf_asset *asset) {
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
        if (gltf_asset_mesh_radiosity(asset, i)) return true;
    return false;
}

/* False when out of memory. */
static bool list_meshes(const gltf_asset *asset, bool radiosity, lit_meshes *out) {
    size_t all = gltf_asset_mesh_count(asset) + 1;
    *out = (lit_meshes){ calloc(all, sizeof *out->meshes), calloc(all, sizeof *out->descs),
                         calloc(all, sizeof *out->of_asset), 0 };
    if (!out->meshes || !out->descs || !out->of_asset) return false;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        const float *values = radiosity ? gltf_asset_mesh_radiosity(asset, i) : gltf_asset_mesh_color(asset, i);
        hemi_mesh_desc *desc = &out->descs[out->count];
        if (!values || !gltf_asset_mesh(asset, i, desc)) continue;
        out->meshes[out->count] = (match_mesh){ desc->name, desc, values };
        out->of_asset[out->count++] = i;
    }
    return true;
}

static void free_meshes(lit_meshes *m) {
    free(m->meshes);
    free(m->descs);
    free(m->of_asset);
}

/* ---- the reference ----------------------------------------------------------------------------------------------- */

static const char NO_LIGHT[] = "no mesh has _RADIOSITY or COLOR_0; bake it first, with --scene-linear";

/* Lists both bakes; radiosity where both have it. */
static int take_bake(comparing *a, const gltf_asset *other) {
    lit_meshes of_other = { 0 };
    bool radiosity = has_radiosity(a->asset) && has_radiosity(other);
    bool ok = list_meshes(a->asset, radiosity, &a->own) && list_meshes(other, radiosity, &of_other);
    const char *fault = !ok ? "out of memory" : of_other.count == 0 ? NO_LIGHT : NULL;
    if (!fault && !bake_probes_make(of_other.meshes, of_other.count, &a->set)) fault = "out of memory";
    free_meshes(&of_other);
    a->c->file = fault ? a->reference : a->c->file;
    if (fault) console_error(a->c, "%s", fault);
    if (!fault && !radiosity)
        console_error(a->c, "warning: not both have _RADIOSITY (bake with --scene-linear); comparing COLOR_0");
    return fault ? EXIT_BAD_INPUT : EXIT_DONE;
}

static int read_bake(comparing *a) {
    gltf_asset *other = NULL;
    int status = asset_input_open(a->reference, a->o, a->c, &other);
    if (status == EXIT_DONE) status = take_bake(a, other);
    gltf_asset_destroy(other);
    return status;
}

static int read_probes(comparing *a) {
    bool radiosity = has_radiosity(a->asset);
    if (!list_meshes(a->asset, radiosity, &a->own)) return EXIT_BAD_INPUT;
    if (a->own.count > 0 && !radiosity)
        console_error(a->c, "warning: no _RADIOSITY (bake with --scene-linear); comparing COLOR_0");
    return a->own.count > 0 ? reference_read(a->reference, a->o->root, a->c, &a->set) : EXIT_DONE;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int print(comparing *a) {
    match_figure *nodes = calloc(a->own.count + 1, sizeof *nodes);
    const char **names = calloc(a->own.count + 1, sizeof *names);
    bool ok = nodes && names && find_worst(a);
    size_t count = ok ? by_node(a->meshes, &a->match, nodes, names) : 0;
    if (ok) (a->o->json ? print_json : print_table)(a, nodes, names, count);
    free(nodes);
    free(names);
    return ok ? EXIT_DONE : console_error(a->c, "out of memory while comparing");
}

static int draw(comparing *a) {
    double full = 0.0;
    if (!a->o->heatmap) return EXIT_DONE;
    int status =
        heatmap_write(a->asset, a->meshes, a->own.of_asset, a->own.count, &a->set, &a->match, a->o, a->c, &full);
    if (status == EXIT_DONE && !a->o->json)
        printf("heatmap %s: black is right, light yellow off by %.2f %% and more, each of itself\n", a->o->heatmap,
               100 * full);
    return status;
}

/* Reads the reference, and finds where its points lie. */
static int match(comparing *a) {
    bool is_asset = path_ends_in(a->reference, ".glb") || path_ends_in(a->reference, ".gltf");
    int status = is_asset ? read_bake(a) : read_probes(a);
    if (status == EXIT_DONE && a->own.count == 0) status = console_error(a->c, "%s", NO_LIGHT);
    a->meshes = a->own.meshes;
    if (status != EXIT_DONE) return status;
    return reference_match(a->reference, &a->set, a->meshes, a->own.count, a->c, &a->match);
}

static void forget(comparing *a) {
    free(a->worst);
    match_result_destroy(&a->match);
    probe_set_destroy(&a->set);
    free_meshes(&a->own);
}

int comparison_make(const gltf_asset *asset, const options *o, console *c) {
    comparing a = { .o = o, .c = c, .asset = asset, .reference = o->inputs[1] };
    int status = o->heatmap ? preview_check_camera(asset, o, c) : EXIT_DONE;
    if (status == EXIT_DONE) status = match(&a);
    if (status == EXIT_DONE) status = print(&a);
    if (status == EXIT_DONE) status = draw(&a);
    forget(&a);
    return status;
}

/* The error that is drawn lightest, then rows of place, normal and error. */
static bool list_points(const comparing *a, float **values, size_t *count) {
    double dim = match_dim_level(&a->set);
    *count = 0;
    *values = malloc((7 * a->set.count + 1) * sizeof **values);
    if (!*values) return false;
    (*values)[(*count)++] = (float)a->match.percentile95;
    for (size_t i = 0; i < a->set.count; i++) {
        const probe *p = &a->set.probes[i];
        if (a->match.places[i].mesh == MATCH_NONE) continue;
        for (int k = 0; k < 3; k++) (*values)[(*count)++] = p->position[k];
        for (int k = 0; k < 3; k++) (*values)[(*count)++] = p->normal[k];
        (*values)[(*count)++] = (float)match_place_error(p, &a->match.places[i], dim);
    }
    return true;
}

int comparison_points(const gltf_asset *asset, const options *o, console *c, float **values, size_t *count) {
    comparing a = { .o = o, .c = c, .asset = asset, .reference = o->reference };
    int status = match(&a);
    if (status == EXIT_DONE && !list_points(&a, values, count))
        status = console_error(c, "out of memory while comparing");
    forget(&a);
    return status;
}
