/* SPDX-License-Identifier: MIT
 * See report.h.
 */
#include "report.h"

#include <cjson/cJSON.h>
#include <sha256.h>
#include <string.h>
#include <sys/resource.h>

double report_peak_bytes(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * (double)usage.ru_maxrss : 0.0;
}

bool report_digest(const char *path, char digest[65]) {
    return SHA256File(path, digest) != NULL;
}

/* One number of an object of the report. */
typedef struct entry {
    const char *key;
    double value;
} entry;

static cJSON *add_numbers(cJSON *root, const char *name, const entry *entries, size_t count) {
    cJSON *object = cJSON_AddObjectToObject(root, name);
    for (size_t i = 0; i < count; i++) cJSON_AddNumberToObject(object, entries[i].key, entries[i].value);
    return object;
}

#define ADD_NUMBERS(root, name, entries) add_numbers(root, name, entries, sizeof(entries) / sizeof *(entries))

static void add_input(cJSON *root, const report_facts *f) {
    char digest[65] = "";
    cJSON *hemibake = cJSON_AddObjectToObject(root, "hemibake");
    cJSON_AddStringToObject(hemibake, "version", hemi_version());
    cJSON *input = cJSON_AddObjectToObject(root, "input");
    cJSON_AddStringToObject(input, "path", f->o->inputs[0]);
    if (report_digest(f->o->inputs[0], digest)) cJSON_AddStringToObject(input, "sha256", digest);
}

static void add_output(cJSON *root, const report_facts *f) {
    cJSON *output = cJSON_AddObjectToObject(root, "output");
    cJSON_AddStringToObject(output, "path", f->o->output);
    cJSON_AddNumberToObject(output, "bytes", (double)(f->written->main_size + f->written->bin_size));
}

static void add_scene(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry scene[] = { { "surfaces", s->surfaces },
                            { "materials", s->materials },
                            { "lights", s->lights },
                            { "patches", s->patches },
                            { "clusters", s->clusters },
                            { "clustered_patches", s->clustered_patches },
                            { "elements", s->elements },
                            { "coarse_elements", s->coarse_elements },
                            { "samples", s->samples },
                            { "vertices_out", s->vertices_out },
                            { "triangles_out", s->triangles_out },
                            { "triangles_cut", s->triangles_cut },
                            { "triangles_merged", s->triangles_merged },
                            { "degenerate_triangles", s->degenerate_triangles },
                            { "duplicate_triangles", s->duplicate_triangles },
                            { "nonmanifold_edges", s->nonmanifold_edges },
                            { "slivers", s->slivers },
                            { "t_junctions", s->t_junctions },
                            { "overlapping_triangles", s->overlapping_triangles },
                            { "crossing_surfaces", s->crossing_surfaces },
                            { "coincident_meshes", s->duplicate_meshes },
                            { "clamped_materials", s->clamped_materials },
                            { "stand_in_meshes", s->proxy_meshes },
                            { "stood_in_triangles", s->proxied_triangles },
                            { "stand_in_triangles", s->proxy_triangles },
                            { "stand_in_deviation", s->proxy_error },
                            { "mesh_copies", f->o->keep_instances ? 0 : gltf_asset_mesh_copies(f->asset) } };
    cJSON *object = ADD_NUMBERS(root, "scene", scene), *skipped = cJSON_AddArrayToObject(object, "not_baked");
    for (size_t i = 0; i < gltf_asset_skipped_count(f->asset); i++)
        cJSON_AddItemToArray(skipped, cJSON_CreateString(gltf_asset_skipped(f->asset, i)));
}

static void add_cost(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry time[] = { { "total_s", f->total_s },
                           { "read_s", f->read_s },
                           { "mesh_s", s->mesh_s },
                           { "factors_s", s->factors_s },
                           { "solve_s", s->solve_s },
                           { "refine_s", s->refine_s },
                           { "reconstruct_s", s->reconstruct_s },
                           { "color_s", f->color_s },
                           { "write_s", f->write_s } };
    const entry memory[] = { { "peak_bytes", report_peak_bytes() }, { "column_bytes", (double)s->column_bytes } };
    ADD_NUMBERS(root, "time", time);
    ADD_NUMBERS(root, "memory", memory);
}

static void add_solver(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry solver[] = { { "threads", s->threads },
                             { "shots", s->shots },
                             { "hemicubes", s->hemicubes },
                             { "unshot_fraction", s->unshot_fraction } };
    const entry light[] = { { "punctual_lights", s->punctual_lights },
                            { "sky_patches", s->sky_patches },
                            { "punctual_w", s->punctual_w },
                            { "sky_w", s->sky_w },
                            { "time_s", s->arrival_s } };
    const entry energy[] = { { "emitted", s->emitted_w },
                             { "absorbed", s->absorbed_w },
                             { "escaped", s->escaped_w },
                             { "unshot", s->unshot_w },
                             { "residual_fraction", s->energy_residual } };
    const entry factors[] = { { "closure_min", s->closure_min },
                              { "closure_mean", s->closure_mean },
                              { "closure_max", s->closure_max },
                              { "analytic_fraction", s->analytic_fraction },
                              { "subdivided_patches", s->subdivided_patches },
                              { "clipped", s->clipped },
                              { "fine_share", s->fine_share } };
    cJSON *object = ADD_NUMBERS(root, "solver", solver);
    cJSON_AddStringToObject(object, "method", options_method(f->o));
    cJSON_AddBoolToObject(object, "converged", s->converged);
    cJSON_AddBoolToObject(object, "rows_closed", s->rows_closed);
    ADD_NUMBERS(root, "energy", energy);
    cJSON_AddBoolToObject(ADD_NUMBERS(root, "arrived", light), "sky_by_default", s->sky_by_default);
    ADD_NUMBERS(root, "factors", factors);
}

static void add_error_or_null(cJSON *object, const char *key, double value) {
    if (value >= 0.0 && value < 1e300)
        cJSON_AddNumberToObject(object, key, value);
    else
        cJSON_AddNullToObject(object, key);
}

static void add_error(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const hemi_curve_point *points;
    size_t count;
    const entry error[] = { { "estimate", s->error_estimate }, { "unshot", s->error_unshot },
                            { "factors", s->error_factors },   { "discretisation", s->error_discretisation },
                            { "bias", s->error_bias },         { "points", s->error_points },
                            { "merge", s->error_merge },       { "merge_largest", s->merge_error } };
    cJSON *object = ADD_NUMBERS(root, "error", error), *curve = cJSON_AddArrayToObject(root, "curve");
    add_error_or_null(object, "reference", f->error_reference);
    if (hemi_solution_curve(f->solution, &points, &count) != HEMI_OK) return;
    for (size_t i = 0; i < count; i++) {
        cJSON *point = cJSON_CreateObject();
        cJSON_AddNumberToObject(point, "t_s", points[i].t_s);
        cJSON_AddNumberToObject(point, "shots", points[i].shots);
        cJSON_AddNumberToObject(point, "unshot_fraction", points[i].unshot_fraction);
        cJSON_AddNumberToObject(point, "error_estimate", points[i].error_estimate);
        cJSON_AddNumberToObject(point, "analytic", (double)points[i].analytic);
        cJSON_AddNumberToObject(point, "evaluations", (double)points[i].evaluations);
        add_error_or_null(point, "error_reference", i + 1 == count ? f->error_reference : -1.0);
        cJSON_AddItemToArray(curve, point);
    }
}

/* What was chosen for each shooter: closed forms, the hemi-cube's estimate, quarters. */
static void add_shooters(cJSON *root, const report_facts *f) {
    const hemi_shooter *all;
    size_t count;
    cJSON *list = cJSON_AddArrayToObject(root, "shooters");
    if (hemi_solution_shooters(f->solution, &all, &count) != HEMI_OK) return;
    for (size_t i = 0; i < count; i++) {
        cJSON *one = cJSON_CreateObject();
        cJSON_AddNumberToObject(one, "patch", all[i].patch);
        cJSON_AddNumberToObject(one, "depth", all[i].depth);
        cJSON_AddNumberToObject(one, "shots", all[i].shots);
        cJSON_AddNumberToObject(one, "hemicubes", all[i].hemicubes);
        cJSON_AddNumberToObject(one, "analytic", (double)all[i].analytic);
        cJSON_AddNumberToObject(one, "estimated", (double)all[i].estimated);
        cJSON_AddBoolToObject(one, "split", all[i].split);
        cJSON_AddItemToArray(list, one);
    }
}

static void add_name(cJSON *object, const char *key, const char *text) {
    if (text && *text)
        cJSON_AddStringToObject(object, key, text);
    else
        cJSON_AddNullToObject(object, key);
}

static void add_color(cJSON *root, const report_facts *f) {
    const color_transform *t = f->spaces->transform;
    const bool shown = !f->o->scene_linear;
    cJSON *color = cJSON_AddObjectToObject(root, "color");
    add_name(color, "config", color_transform_config(t));
    add_name(color, "display", shown ? color_transform_display(t) : NULL);
    add_name(color, "view", shown ? color_transform_view(t) : NULL);
    add_name(color, "look", shown ? color_transform_look(t) : NULL);
    add_name(color, "input_space", color_input_space(f->spaces->factors));
    add_name(color, "working_space", color_transform_working_space(t));
    cJSON_AddNumberToObject(color, "exposure_ev", f->colors->exposure_ev);
    cJSON_AddNumberToObject(color, "clipped_fraction", f->colors->clipped_fraction);
}

static void add_encoding(cJSON *root, const report_facts *f) {
    const gltf_output *w = f->written;
    const entry draco[] = { { "bytes_before", (double)w->geometry_bytes_before },
                            { "bytes_after", (double)w->geometry_bytes_after },
                            { "max_position_error", w->max_position_error },
                            { "max_normal_error", w->max_normal_error },
                            { "max_color_error", w->max_color_error },
                            { "max_texcoord_error", w->max_texcoord_error },
                            { "level", f->o->no_draco ? -1 : (double)f->o->draco_level } };
    const entry bits[] = { { "position", f->o->draco_bits[0] },
                           { "normal", f->o->draco_bits[1] },
                           { "color", f->o->draco_bits[2] },
                           { "texcoord", f->o->draco_bits[3] } };
    cJSON *object = ADD_NUMBERS(root, "draco", draco);
    ADD_NUMBERS(object, "bits", bits);
    if (f->o->no_draco) cJSON_DeleteItemFromObject(object, "level");
    if (f->o->no_draco) cJSON_DeleteItemFromObject(object, "bits");
}

/* ---- what asset and report have in common
 * ---------------------------------------------------------------------------- */

/* SHA-256 of what the report says of the bake itself, without input, output, times, memory and threads, as text without
 * white space. */
static void solved_digest(const report_facts *f, char digest[65]) {
    cJSON *root = cJSON_CreateObject(), *point;
    digest[0] = 0;
    add_input(root, f);
    add_scene(root, f);
    add_solver(root, f);
    add_error(root, f);
    add_color(root, f);
    cJSON_DeleteItemFromObject(root, "input");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "arrived"), "time_s");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "solver"), "threads");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "color"), "config"); /* a path */
    cJSON_ArrayForEach(point, cJSON_GetObjectItem(root, "curve")) cJSON_DeleteItemFromObject(point, "t_s");
    char *text = cJSON_PrintUnformatted(root);
    if (text) SHA256Data((const uint8_t *)text, strlen(text), digest);
    cJSON_free(text);
    cJSON_Delete(root);
}

char *report_stamp(const report_facts *f) {
    char digest[65];
    const char *name, *value;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "version", hemi_version());
    cJSON *given = cJSON_AddObjectToObject(root, "options");
    for (int i = 0; options_recorded(f->o, i, &name, &value); i++) {
        if (*value)
            cJSON_AddStringToObject(given, name, value);
        else
            cJSON_AddTrueToObject(given, name);
    }
    cJSON_AddNumberToObject(root, "mesh_copies", f->o->keep_instances ? 0 : gltf_asset_mesh_copies(f->asset));
    solved_digest(f, digest);
    cJSON_AddStringToObject(root, "report_sha256", digest);
    char *text = cJSON_PrintUnformatted(root);
    cJSON_Delete(root);
    return text;
}

char *report_make(const report_facts *facts) {
    cJSON *root = cJSON_CreateObject();
    add_input(root, facts);
    add_output(root, facts);
    add_scene(root, facts);
    add_cost(root, facts);
    add_solver(root, facts);
    add_error(root, facts);
    add_shooters(root, facts);
    add_color(root, facts);
    add_encoding(root, facts);
    char digest[65];
    solved_digest(facts, digest);
    cJSON_AddStringToObject(cJSON_GetObjectItem(root, "hemibake"), "report_sha256", digest);
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    return text;
}
