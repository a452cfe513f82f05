/* SPDX-License-Identifier: MIT */
#include "report.h"

#include "digest.h"
#include "processes.h"

#include <cjson/cJSON.h>
#include <string.h>
#include <sys/resource.h>

/* Most memory the process has held. */
static double peak_bytes(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * (double)usage.ru_maxrss : 0.0;
}

/* What all threads have taken so far. */
static double processor_seconds(void) {
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
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
    if (digest_file(f->o->inputs[0], digest)) cJSON_AddStringToObject(input, "sha256", digest);
}

static void add_output(cJSON *root, const report_facts *f) {
    cJSON *output = cJSON_AddObjectToObject(root, "output");
    cJSON_AddStringToObject(output, "path", f->o->output);
    cJSON_AddNumberToObject(output, "bytes", (double)(f->written->main_size + f->written->bin_size));
}

static void add_scene(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry scene[] = { { "surfaces", s->scene.surfaces },
                            { "materials", s->scene.materials },
                            { "lights", s->scene.emitting_patches },
                            { "patches", s->scene.patches },
                            { "clusters", s->scene.clusters },
                            { "clustered_patches", s->scene.clustered_patches },
                            { "elements", s->scene.elements },
                            { "coarse_elements", s->scene.coarse_elements },
                            { "samples", s->scene.samples },
                            { "vertices_out", s->scene.vertices_out },
                            { "triangles_out", s->scene.triangles_out },
                            { "triangles_cut", s->scene.triangles_before_decimation },
                            { "triangles_merged", s->scene.triangles_decimated },
                            { "degenerate_triangles", s->scene.degenerate_triangles },
                            { "duplicate_triangles", s->scene.duplicate_triangles },
                            { "nonmanifold_edges", s->scene.nonmanifold_edges },
                            { "slivers", s->scene.slivers },
                            { "t_junctions", s->scene.t_junctions },
                            { "overlapping_triangles", s->scene.overlapping_triangles },
                            { "crossing_surfaces", s->scene.intersecting_surfaces },
                            { "coincident_meshes", s->scene.duplicate_meshes },
                            { "clamped_materials", s->scene.clamped_materials },
                            { "stand_in_meshes", s->scene.proxy_meshes },
                            { "stood_in_triangles", s->scene.proxied_triangles },
                            { "stand_in_triangles", s->scene.proxy_triangles },
                            { "stand_in_deviation", s->scene.proxy_error },
                            { "mesh_copies", f->o->keep_instances ? 0 : gltf_asset_mesh_copies(f->asset) } };
    cJSON *object = ADD_NUMBERS(root, "scene", scene), *skipped = cJSON_AddArrayToObject(object, "not_baked");
    for (size_t i = 0; i < gltf_asset_skipped_count(f->asset); i++)
        cJSON_AddItemToArray(skipped, cJSON_CreateString(gltf_asset_skipped(f->asset, i)));
}

static void add_cost(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry time[] = { { "total_s", f->total_s },
                           { "read_s", f->read_s },
                           { "mesh_s", s->time.mesh_s },
                           { "factors_s", s->time.factors_s },
                           { "solve_s", s->time.solve_s },
                           { "refine_s", s->time.adapt_s },
                           { "reconstruct_s", s->time.reconstruct_s },
                           { "color_s", f->color_s },
                           { "write_s", f->write_s },
                           { "picture_s", f->picture_s },
                           { "earlier_s", s->time.total_s - s->time.own_s },
                           { "processor_s", processor_seconds() } };
    const entry memory[] = { { "peak_bytes", peak_bytes() }, { "column_bytes", (double)s->memory.column_bytes } };
    ADD_NUMBERS(root, "time", time);
    ADD_NUMBERS(root, "memory", memory);
}

/* What drew item buffers, and why that. */
static void add_visibility(cJSON *solver, const report_facts *f) {
    static const char *const names[] = { "", "osmesa", "egl", "rays" };
    uint32_t drawn_by = f->statistics->solver.drawn_by;
    hemi_visibility asked = f->o->bake.visibility, by = HEMI_VISIBILITY_OSMESA;
    while (by < HEMI_VISIBILITY_RAYS && !(drawn_by >> by & 1)) by++;
    bool is_asked = asked != HEMI_VISIBILITY_DEFAULT && asked != HEMI_VISIBILITY_AUTO;
    const char *why = drawn_by >> (by + 1)         ? "and rays where it failed"
                      : is_asked                   ? "asked for"
                      : by == HEMI_VISIBILITY_RAYS ? "predicted to be faster than OpenGL, or there is none"
                                                   : "the first that is there, and predicted to be fastest";
    if (drawn_by == 0) {
        cJSON_AddNullToObject(solver, "visibility");
        return;
    }
    cJSON_AddStringToObject(solver, "visibility", names[by]);
    cJSON_AddStringToObject(solver, "visibility_why", why);
}

static void add_solver(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry solver[] = { { "threads", s->solver.threads },
                             { "processes", processes_ranks() ? processes_ranks()->count : 1 },
                             { "shots", s->solver.shots },
                             { "hemicubes", s->solver.hemicubes },
                             { "unshot_fraction", s->solver.unshot_fraction } };
    const entry light[] = { { "punctual_lights", s->arrived.punctual_lights },
                            { "sky_patches", s->arrived.sky_patches },
                            { "punctual_w", s->arrived.punctual_w },
                            { "sky_w", s->arrived.sky_w },
                            { "time_s", s->arrived.direct_light_s } };
    const entry energy[] = { { "emitted", s->energy.emitted_w },
                             { "absorbed", s->energy.absorbed_w },
                             { "escaped", s->energy.escaped_w },
                             { "unshot", s->energy.unshot_w },
                             { "residual_fraction", s->energy.residual } };
    const entry factors[] = { { "closure_min", s->factors.closure_min },
                              { "closure_mean", s->factors.closure_mean },
                              { "closure_max", s->factors.closure_max },
                              { "analytic_fraction", s->factors.analytic_fraction },
                              { "subdivided_patches", s->factors.subdivided_patches },
                              { "clipped", s->factors.clipped_columns },
                              { "fine_share", s->factors.gathered_fraction } };
    cJSON *object = ADD_NUMBERS(root, "solver", solver);
    cJSON_AddStringToObject(object, "method", options_method(s->solver.method));
    add_visibility(object, f);
    cJSON_AddBoolToObject(object, "converged", s->solver.converged);
    cJSON_AddBoolToObject(object, "rows_closed", s->solver.rows_closed);
    ADD_NUMBERS(root, "energy", energy);
    cJSON_AddBoolToObject(ADD_NUMBERS(root, "arrived", light), "sky_by_default", s->arrived.sky_by_default);
    ADD_NUMBERS(root, "factors", factors);
}

static void add_error_or_null(cJSON *object, const char *key, double value) {
    if (value >= 0.0 && value < 1e300)
        cJSON_AddNumberToObject(object, key, value);
    else
        cJSON_AddNullToObject(object, key);
}

bool report_is_unlit(const report_facts *f) {
    return !(f->colors->black.reflecting_fraction > 0.0);
}

bool report_knows_worst(const report_facts *f) {
    return f->statistics->error.worst.estimate > 0.0 && !report_is_unlit(f);
}

const char *report_worst_node(const report_facts *f) {
    hemi_mesh_desc desc;
    gltf_asset_mesh(f->asset, f->statistics->error.worst.mesh, &desc);
    return desc.name ? desc.name : "";
}

/* The part that is worst by itself. */
static void add_worst(cJSON *error, const report_facts *f) {
    const hemi_mesh_error *w = &f->statistics->error.worst;
    if (!report_knows_worst(f)) {
        cJSON_AddNullToObject(error, "worst");
        return;
    }
    const entry worst[] = { { "estimate", w->estimate }, { "light", w->light }, { "area", w->area } };
    cJSON *object = ADD_NUMBERS(error, "worst", worst);
    cJSON_AddStringToObject(object, "node", report_worst_node(f));
}

static void add_error(cJSON *root, const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const entry error[] = { { "estimate", s->error.estimate }, { "unshot", s->error.unshot },
                            { "factors", s->error.factors },   { "discretisation", s->error.discretisation },
                            { "bias", s->error.bias },         { "points", s->error.points },
                            { "merge", s->error.decimation },  { "merge_largest", s->error.decimation_largest } };
    cJSON *object = ADD_NUMBERS(root, "error", error), *curve = cJSON_AddArrayToObject(root, "curve");
    add_error_or_null(object, "reference", f->error_reference.whole);
    add_error_or_null(object, "reference_median", f->error_reference.median);
    add_error_or_null(object, "reference_95", f->error_reference.percentile95);
    add_worst(object, f);
    if (report_is_unlit(f)) cJSON_ReplaceItemInObject(object, "estimate", cJSON_CreateNull());
    const size_t count = hemi_solution_curve_count(f->solution);
    for (size_t i = 0; i < count; i++) {
        hemi_curve_point p = { .struct_size = sizeof p };
        hemi_solution_curve_point(f->solution, i, &p);
        cJSON *point = cJSON_CreateObject();
        cJSON_AddNumberToObject(point, "t_s", p.t_s);
        cJSON_AddNumberToObject(point, "shots", p.shots);
        cJSON_AddNumberToObject(point, "unshot_fraction", p.unshot_fraction);
        cJSON_AddNumberToObject(point, "error_estimate", p.error_estimate);
        cJSON_AddNumberToObject(point, "analytic", (double)p.analytic);
        cJSON_AddNumberToObject(point, "evaluations", (double)p.evaluations);
        add_error_or_null(point, "error_reference", i + 1 == count ? f->error_reference.whole : -1.0);
        cJSON_AddItemToArray(curve, point);
    }
}

/* What was chosen for each shooter: closed forms, the hemi-cube's estimate, quarters. */
static void add_shooters(cJSON *root, const report_facts *f) {
    cJSON *list = cJSON_AddArrayToObject(root, "shooters");
    for (size_t i = 0; i < hemi_solution_shooter_count(f->solution); i++) {
        hemi_shooter shooter = { .struct_size = sizeof shooter };
        hemi_solution_shooter(f->solution, i, &shooter);
        cJSON *one = cJSON_CreateObject();
        cJSON_AddNumberToObject(one, "patch", shooter.patch);
        cJSON_AddNumberToObject(one, "depth", shooter.depth);
        cJSON_AddNumberToObject(one, "shots", shooter.shots);
        cJSON_AddNumberToObject(one, "hemicubes", shooter.hemicubes);
        cJSON_AddNumberToObject(one, "analytic", (double)shooter.analytic);
        cJSON_AddNumberToObject(one, "estimated", (double)shooter.estimated);
        cJSON_AddBoolToObject(one, "split", shooter.split);
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
    add_name(color, "config", color_transform_name(t, COLOR_PART_CONFIG));
    add_name(color, "display", shown ? color_transform_name(t, COLOR_PART_DISPLAY) : NULL);
    add_name(color, "view", shown ? color_transform_name(t, COLOR_PART_VIEW) : NULL);
    add_name(color, "look", shown ? color_transform_name(t, COLOR_PART_LOOK) : NULL);
    add_name(color, "input_space", color_input_space(f->spaces->factors));
    add_name(color, "working_space", color_transform_name(t, COLOR_PART_WORKING_SPACE));
    cJSON_AddNumberToObject(color, "exposure_ev", f->colors->exposure_ev);
    cJSON_AddNumberToObject(color, "clipped_fraction", f->colors->clipped_fraction);
    cJSON_AddNumberToObject(color, "dark_fraction", f->colors->black.dark_fraction);
    cJSON_AddNumberToObject(color, "reflecting_fraction", f->colors->black.reflecting_fraction);
    add_name(color, "black", f->colors->black.line);
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

/* ---- what asset and report have in common ---- */

/* SHA-256 of what the report says of the bake itself, without input, output, times, the curve, memory and threads, as
 * text without white space. */
static void solved_digest(const report_facts *f, char digest[65]) {
    cJSON *root = cJSON_CreateObject();
    digest[0] = 0;
    add_input(root, f);
    add_scene(root, f);
    add_solver(root, f);
    add_error(root, f);
    add_color(root, f);
    cJSON_DeleteItemFromObject(root, "input");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "arrived"), "time_s");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "solver"), "threads");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "solver"), "processes");
    cJSON_DeleteItemFromObject(cJSON_GetObjectItem(root, "color"), "config"); /* a path */
    cJSON_DeleteItemFromObject(root, "curve"); /* the way there, which is another on kept rows and among processes */
    char *text = cJSON_PrintUnformatted(root);
    if (text) digest_text(text, strlen(text), digest);
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
    /* Only a bake of many asks for it, and what was interrupted is made again. */
    if (f->o->is_one_of_many && *f->input_digest && !f->is_interrupted)
        cJSON_AddStringToObject(root, "input_sha256", f->input_digest);
    char *text = cJSON_PrintUnformatted(root);
    cJSON_Delete(root);
    return text;
}

/* What of a USD stage the bake does not show. */
static void add_usd(cJSON *root, const report_facts *f) {
    if (!f->usd->is_read) return;
    cJSON *losses = cJSON_AddArrayToObject(cJSON_AddObjectToObject(root, "usd"), "losses");
    for (size_t i = 0; i < f->usd->loss_count; i++) cJSON_AddItemToArray(losses, cJSON_CreateString(f->usd->losses[i]));
}

static void add_warnings(cJSON *root, const console *c) {
    cJSON *list = cJSON_AddArrayToObject(root, "warnings");
    for (size_t i = 0; i < c->note_count; i++) cJSON_AddItemToArray(list, cJSON_CreateString(c->notes[i]));
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
    if (facts->is_interrupted) cJSON_AddTrueToObject(cJSON_GetObjectItem(root, "solver"), "interrupted");
    add_usd(root, facts);
    add_warnings(root, facts->console);
    char digest[65];
    solved_digest(facts, digest);
    cJSON_AddStringToObject(cJSON_GetObjectItem(root, "hemibake"), "report_sha256", digest);
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    return text;
}
