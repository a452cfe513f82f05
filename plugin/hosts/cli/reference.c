/* SPDX-License-Identifier: MIT */
#include "reference.h"

#include "printable.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int reference_read(const char *path, const char *root, console *c, probe_set *out) {
    char message[PROBES_MESSAGE_SIZE];
    if (probe_set_read(path, root, out, message) == HEMI_OK) return EXIT_DONE;
    c->file = path;
    console_error(c, "%s", message);
    return EXIT_BAD_INPUT;
}

static int run_match(const char *path, const probe_set *set, const match_mesh *meshes, size_t count, console *c,
                     match_result *out) {
    char message[PROBES_MESSAGE_SIZE];
    if (probes_match(meshes, count, set, out, message) == HEMI_OK) return EXIT_DONE;
    c->file = path;
    console_error(c, "%s", message);
    return EXIT_BAD_INPUT;
}

int reference_compare_views(const char *path, const probe_set *probes, const gltf_asset *asset, const baked_colors *b,
                            console *c, reference_error *error) {
    match_mesh *meshes = calloc(b->mesh_count + 1, sizeof *meshes);
    hemi_mesh_desc *descs = calloc(b->mesh_count + 1, sizeof *descs);
    match_result match = { 0 };
    int status = EXIT_BAD_INPUT;
    if (meshes && descs) {
        for (uint32_t i = 0; i < b->mesh_count; i++) {
            gltf_asset_mesh(asset, i, &descs[i]);
            descs[i].positions = b->views[i].positions;
            descs[i].vertex_count = b->views[i].vertex_count;
            descs[i].indices = b->views[i].indices;
            descs[i].triangle_count = b->views[i].triangle_count;
            meshes[i] = (match_mesh){ descs[i].name, &descs[i], b->views[i].radiance };
        }
        status = run_match(path, probes, meshes, b->mesh_count, c, &match);
        if (status == EXIT_DONE)
            *error = (reference_error){ match_error(&match.total), match.median, match.percentile95 };
    }
    match_result_destroy(&match);
    free(meshes);
    free(descs);
    return status;
}

/* ---- compare ---- */

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

static void print_json(const match_figure *nodes, const char **names, size_t count, const match_result *m) {
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
    char *text = cJSON_Print(root);
    if (text) print_json_printable(stdout, text);
    putchar('\n');
    cJSON_free(text);
    cJSON_Delete(root);
}

static void print_padded(const char *name) {
    print_printable(stdout, name);
    for (size_t i = strlen(name); i < NAME_WIDTH; i++) putchar(' ');
}

static void print_table(const match_figure *nodes, const char **names, size_t count, const match_result *m) {
    printf("%-32s %8s %10s %10s\n", "node", "probes", "error", "bias");
    for (size_t i = 0; i < count; i++) {
        if (nodes[i].matched == 0) continue;
        print_padded(names[i]);
        printf(" %8zu %9.3f%% %+9.3f%%\n", nodes[i].matched, 100 * match_error(&nodes[i]), 100 * match_bias(&nodes[i]));
    }
    printf("%-32s %8zu %9.3f%% %+9.3f%%\n", "all", m->total.matched, 100 * match_error(&m->total),
           100 * match_bias(&m->total));
    printf("relative error %.4f; %zu probes matched, %zu unmatched; noise of the reference %.4f\n",
           match_error(&m->total), m->total.matched, m->unmatched, match_noise(&m->total));
    printf("half of the probes are off by less than %.2f %%, 95 %% by less than %.2f %%, each of itself\n",
           100 * m->median, 100 * m->percentile95);
}

static size_t list_meshes(const gltf_asset *asset, match_mesh *meshes, hemi_mesh_desc *descs, bool *has_radiosity) {
    size_t count = 0;
    *has_radiosity = false;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
        *has_radiosity = *has_radiosity || gltf_asset_mesh_radiosity(asset, i);
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        const float *values = *has_radiosity ? gltf_asset_mesh_radiosity(asset, i) : gltf_asset_mesh_color(asset, i);
        if (!values || !gltf_asset_mesh(asset, i, &descs[count])) continue;
        meshes[count] = (match_mesh){ descs[count].name, &descs[count], values };
        count++;
    }
    return count;
}

int reference_compare_asset(const char *probes, const gltf_asset *asset, const options *o, console *c) {
    size_t all = gltf_asset_mesh_count(asset);
    match_mesh *meshes = calloc(all + 1, sizeof *meshes);
    hemi_mesh_desc *descs = calloc(all + 1, sizeof *descs);
    match_figure *nodes = calloc(all + 1, sizeof *nodes);
    const char **names = calloc(all + 1, sizeof *names);
    probe_set set = { 0 };
    match_result match = { 0 };
    bool has_radiosity = false;
    int status = EXIT_BAD_INPUT;
    size_t count = meshes && descs && nodes && names ? list_meshes(asset, meshes, descs, &has_radiosity) : 0;
    if (count == 0)
        console_error(c, "no mesh has _RADIOSITY or COLOR_0; bake it first, with --scene-linear");
    else
        status = reference_read(probes, o->root, c, &set);
    if (status == EXIT_DONE) status = run_match(probes, &set, meshes, count, c, &match);
    if (status == EXIT_DONE) {
        if (!has_radiosity) console_error(c, "warning: no _RADIOSITY (bake with --scene-linear); comparing COLOR_0");
        size_t node_count = by_node(meshes, &match, nodes, names);
        (o->json ? print_json : print_table)(nodes, names, node_count, &match);
    }
    match_result_destroy(&match);
    probe_set_destroy(&set);
    free(meshes);
    free(descs);
    free(nodes);
    free(names);
    return status;
}
