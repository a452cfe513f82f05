/* SPDX-License-Identifier: MIT
 * hemibake bake IN -o OUT: read, solve, colour, write; report and picture beside it.
 */
#include "asset_colors.h"
#include "asset_input.h"
#include "asset_lights.h"
#include "asset_scene.h"
#include "bake_preview.h"
#include "baked_glb.h"
#include "checkpoint.h"
#include "commands.h"
#include "depfile.h"
#include "input_digest.h"
#include "interrupt.h"
#include "occlusion.h"
#include "output_file.h"
#include "path_text.h"
#include "preview.h"
#include "processes.h"
#include "reference.h"
#include "report.h"
#include "report_page.h"
#include "rows_file.h"
#include "signals.h"
#include "summary.h"
#include "usd_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In the order in which they appear: the asset itself comes last, when all that belongs to it is there. */
enum { ROWS_FILE, PREVIEW_FILE, REPORT_FILE, DEPFILE, BIN_FILE, PAYLOAD_FILE, LAYER_FILE, MAIN_FILE, OUTPUT_COUNT };

typedef struct bake_run {
    const options *o;
    console console;
    double start_s, read_s, color_s, write_s, picture_s;
    output_file files[OUTPUT_COUNT];
    char *bin_path, *payload_path; /* payload: of --layer, where the output is no USD itself */
    usd_files usd;
    options as_read; /* of the command, and what a stage says itself */
    gltf_asset *asset;
    asset_colors spaces;
    light_names groups;
    rows_file rows;
    lights_from lights;
    hemi_context *context;
    hemi_scene *scene;
    hemi_solution *solution;
    hemi_statistics statistics;
    baked_colors colors;
    gltf_output written;
    checkpoint *checkpoint;
    probe_set probes; /* of --reference */
    reference_error error_reference;
    char input_digest[65]; /* of a bake of many, as it was when it was read */
    bool is_interrupted;
} bake_run;

/* ---- outputs ----------------------------------------------------------------------------------------------------- */

/* OUT.bin beside OUT.gltf */
static bool name_bin(bake_run *b) {
    int stem = (int)(strlen(b->o->output) - strlen(".gltf"));
    b->bin_path = path_format("%.*s.bin", stem, b->o->output);
    return b->bin_path;
}

static int open_outputs(bake_run *b) {
    const options *o = b->o;
    const char *reason = "out of memory";
    bool is_usd = usd_is_output(o->output);
    int status = light_names_ask(&b->groups, o, is_usd || o->layer, &b->console);
    if (status == EXIT_DONE) status = rows_file_open(&b->rows, o, &b->console);
    if (status != EXIT_DONE) return status;
    if (!path_ends_in(o->output, ".glb") && !path_ends_in(o->output, ".gltf") && !is_usd) {
        b->console.file = o->output;
        console_error(&b->console,
                      "an output is named .glb, .gltf, .usda, .usdc or .usdz, and a folder with / at its end");
        return EXIT_USAGE;
    }
    if (o->layer && (!path_ends_in(o->layer, ".usda") || !b->usd.is_read)) {
        b->console.file = o->layer;
        console_error(&b->console, "a layer is named .usda, and lies over a stage that is baked");
        return EXIT_USAGE;
    }
    if (o->layer && !is_usd) b->payload_path = usd_payload_name(o->layer);
    if (o->layer && !is_usd && !b->payload_path) return console_unwritten(&b->console, o->layer, reason);
    if (path_ends_in(o->output, ".gltf") && !name_bin(b)) return console_unwritten(&b->console, o->output, reason);
    const char *const paths[OUTPUT_COUNT] = { b->rows.is_there ? NULL : o->rows,
                                              o->preview,
                                              o->report,
                                              o->depfile,
                                              b->bin_path,
                                              b->payload_path,
                                              o->layer,
                                              o->output };
    /* The asset's own place first: it is what the user asked for. */
    for (int i = OUTPUT_COUNT - 1; i >= 0; i--) {
        if (!output_file_open(&b->files[i], paths[i], &reason)) return console_unwritten(&b->console, paths[i], reason);
        for (int k = i + 1; k < OUTPUT_COUNT; k++)
            if (output_place_equal(&b->files[i].place, &b->files[k].place))
                return console_unwritten(&b->console, paths[i], "another output has this name too");
    }
    return EXIT_DONE;
}

static int write_output(bake_run *b, int file, const void *bytes, size_t size) {
    const char *reason = "", *path = b->files[file].path;
    return output_file_write(&b->files[file], bytes, size, &reason) ? EXIT_DONE
                                                                    : console_unwritten(&b->console, path, reason);
}

/* ---- stages ------------------------------------------------------------------------------------------------------ */

static bool watch_bake(void *user, const hemi_progress *p) {
    bake_run *b = user;
    interrupt_follow(p);
    progress_update(&b->console.progress, p);
    return true;
}

static int read_input(bake_run *b) {
    double begin = progress_seconds();
    if (b->o->is_one_of_many) input_digest(b->o, b->input_digest);
    int status = asset_input_read(b->o, &b->console, &b->usd, &b->as_read, &b->asset);
    b->read_s = progress_seconds() - begin;
    return status;
}

/* What else the command names is looked at before hours of work, not after. */
static int check_options(bake_run *b) {
    int status = preview_check_camera(b->asset, b->o, &b->console);
    return status == EXIT_DONE && b->o->reference ? reference_read(b->o->reference, b->o->root, &b->console, &b->probes)
                                                  : status;
}

static int load_colors(bake_run *b) {
    double begin = progress_seconds();
    int status = asset_colors_load(b->o, &b->console, &b->spaces);
    b->color_s += progress_seconds() - begin;
    return status;
}

/* What options ask for, and what only the command knows. */
static hemi_bake_desc bake_desc(bake_run *b) {
    hemi_bake_desc desc = b->o->bake;
    desc.progress = watch_bake;
    desc.progress_user = b;
    desc.ranks = processes_ranks();
    if (!desc.ranks) desc.stop = &signals_interrupted;
    desc.light_groups = b->groups.count;
    if (report_page_is_asked(b->o->report)) desc.vertex_errors = true;
    desc.checkpoint = checkpoint_desc(b->checkpoint);
    rows_file_ask(&b->rows, &desc);
    if (b->o->ao && desc.open_distance == 0.0) desc.open_distance = occlusion_distance(b->asset);
    desc.time_limit_s = asset_scene_time_left(b->asset, desc.time_limit_s, progress_seconds() - b->start_s, b->read_s);
    /* What several instances show in the mean needs the vertices that any of them does. */
    if (b->o->keep_instances && gltf_asset_mesh_copies(b->asset) > 0) desc.decimate_error = -1.0;
    return desc;
}

static input_lists list_inputs(const bake_run *b) {
    return (input_lists){ b->usd.is_read ? b->usd.dependencies : NULL,
                          b->lights.usd.is_read ? b->lights.usd.dependencies : NULL };
}

static int solve(bake_run *b) {
    int status = console_limit_memory(&b->console, b->o->bake.memory_limit);
    if (status == EXIT_DONE) status = console_context(&b->console, b->o->threads, &b->context);
    if (status == EXIT_DONE) status = asset_input_textures(b->o, &b->spaces, &b->console, b->asset);
    if (status == EXIT_DONE)
        status = lights_from_open(&b->lights, b->o, b->asset, &b->spaces, &b->as_read, &b->console);
    const input_lists lists = list_inputs(b);
    if (status == EXIT_DONE) status = checkpoint_open(b->o, &lists, &b->console, &b->checkpoint);
    if (status == EXIT_DONE)
        status =
            asset_scene_create(b->context, &b->lights, &b->spaces, &b->as_read, &b->groups, &b->console, &b->scene);
    if (status == EXIT_DONE) status = light_names_end(&b->groups, &b->console);
    if (status != EXIT_DONE) return status;
    uint32_t copies = b->o->keep_instances ? 0 : gltf_asset_mesh_copies(b->asset);
    if (copies)
        console_note(&b->console,
                     "%u mesh%s copied so that each instance has its own light; --keep-instances shares one", copies,
                     copies == 1 ? " is" : "es are");
    hemi_bake_desc bake = bake_desc(b);
    bake.memory_limit = console_memory_of_bake(&b->console, gltf_asset_picture_bytes(b->asset), bake.memory_limit);
    hemi_result result = hemi_bake(b->scene, &bake, &b->solution);
    if (result == HEMI_CANCELLED && signals_interrupted) return interrupt_without_answer(&b->console);
    if (result == HEMI_ERROR_NO_LIGHT) asset_lights_name_lost(b->lights.asset, &b->console);
    if (result != HEMI_OK) return EXIT_BAD_INPUT;
    b->statistics.struct_size = sizeof b->statistics;
    hemi_solution_statistics(b->solution, &b->statistics);
    return EXIT_DONE;
}

static int judge_interrupt(bake_run *b) {
    return interrupt_judge(&b->console, &b->statistics, &b->is_interrupted);
}

static int color(bake_run *b) {
    double begin = progress_seconds();
    int status = baked_colors_make(b->solution, &b->lights, b->spaces.transform, &b->as_read, &b->console, &b->colors);
    b->color_s += progress_seconds() - begin;
    if (status == EXIT_DONE && b->o->reference)
        status = reference_compare_views(b->o->reference, &b->probes, b->asset, &b->colors, &b->console,
                                         &b->error_reference);
    if (b->o->scene_linear && b->colors.clipped_fraction > 0.0)
        console_note(&b->console, "warning: COLOR_0 is clamped to [0,1] at %.1f %% of the vertices; _RADIOSITY is not",
                     100 * b->colors.clipped_fraction);
    return status;
}

static report_facts make_facts(const bake_run *b) {
    return (report_facts){ b->o,
                           b->asset,
                           b->solution,
                           &b->statistics,
                           &b->colors,
                           &b->spaces,
                           &b->written,
                           b->read_s,
                           b->color_s,
                           b->write_s,
                           b->picture_s,
                           progress_seconds() - b->start_s,
                           b->error_reference,
                           b->is_interrupted,
                           &b->usd,
                           b->input_digest,
                           &b->console };
}

static int serialise_glb(bake_run *b, bool for_usd, gltf_output *out) {
    report_facts facts = make_facts(b);
    char *extras = report_stamp(&facts);
    baked_glb glb = { b->o,   b->asset, &b->colors,     for_usd ? NULL : b->bin_path,
                      extras, for_usd,  b->usd.is_read, &b->groups };
    int status = baked_glb_make(&glb, &b->console, out);
    free(extras);
    return status;
}

/* Puts what the writer of USD has made in the place of the GLB that it was made from. */
static int take_written(bake_run *b, gltf_output *out) {
    size_t size = 0;
    uint8_t *bytes = usd_read_file(b->usd.written, &size);
    if (!bytes) return console_error(&b->console, "the writer of USD has written nothing");
    free(out->main);
    out->main = bytes;
    out->main_size = size;
    return EXIT_DONE;
}

static int serialise_usd(bake_run *b, const char *output, gltf_output *out) {
    int status = serialise_glb(b, true, out);
    if (status == EXIT_DONE) status = usd_write(&b->usd, b->o, output, out->main, out->main_size, &b->console);
    return status == EXIT_DONE ? take_written(b, out) : status;
}

static int serialise(bake_run *b) {
    double begin = progress_seconds();
    int status = usd_is_output(b->o->output) ? serialise_usd(b, b->o->output, &b->written)
                                             : serialise_glb(b, false, &b->written);
    b->write_s = progress_seconds() - begin;
    return status;
}

static int write_payload(bake_run *b) {
    if (!b->payload_path) return EXIT_DONE;
    gltf_output payload = { 0 };
    int status = serialise_usd(b, b->payload_path, &payload);
    if (status == EXIT_DONE) status = write_output(b, PAYLOAD_FILE, payload.main, payload.main_size);
    gltf_output_free(&payload);
    return status;
}

static int write_layer(bake_run *b) {
    size_t size = 0;
    if (!b->o->layer) return EXIT_DONE;
    void *bytes = usd_read_file(b->usd.layer, &size);
    int status = bytes ? write_output(b, LAYER_FILE, bytes, size)
                       : console_error(&b->console, "the writer of USD has written no layer");
    free(bytes);
    return status;
}

static int write_preview(bake_run *b) {
    unsigned char *bytes = NULL;
    size_t size = 0;
    if (!b->o->preview) return EXIT_DONE;
    double begin = progress_seconds();
    int status = bake_preview(b->context, b->asset, &b->colors, b->o, &b->console, &bytes, &size);
    if (status == EXIT_DONE) status = write_output(b, PREVIEW_FILE, bytes, size);
    b->picture_s += progress_seconds() - begin;
    free(bytes);
    return status;
}

static int write_report(bake_run *b) {
    if (!b->o->report) return EXIT_DONE;
    report_facts facts = make_facts(b);
    char *json = report_make(&facts), *text = json;
    bool is_page = report_page_is_asked(b->o->report);
    double begin = progress_seconds();
    if (is_page && json) text = report_page_make(&facts, b->context, &b->console, json);
    b->picture_s += progress_seconds() - begin;
    int status = text ? write_output(b, REPORT_FILE, text, strlen(text)) : EXIT_BAD_INPUT;
    if (is_page) free(json);
    free(text);
    return status;
}

static int write_depfile(bake_run *b) {
    if (!b->o->depfile) return EXIT_DONE;
    const input_lists lists = list_inputs(b);
    char *text = depfile_make(b->o, &lists);
    int status = text ? write_output(b, DEPFILE, text, strlen(text))
                      : console_error(&b->console, "out of memory while listing what it depends on");
    free(text);
    return status;
}

static int write_main(bake_run *b) {
    bool has_rows = b->rows.path && !b->rows.is_there;
    int status = has_rows ? write_output(b, ROWS_FILE, b->rows.bytes, b->rows.used) : EXIT_DONE;
    if (status == EXIT_DONE && b->written.bin) status = write_output(b, BIN_FILE, b->written.bin, b->written.bin_size);
    return status == EXIT_DONE ? write_output(b, MAIN_FILE, b->written.main, b->written.main_size) : status;
}

static int commit_outputs(bake_run *b) {
    output_file *files[OUTPUT_COUNT];
    const char *path = "", *reason = "";
    for (int i = 0; i < OUTPUT_COUNT; i++) files[i] = &b->files[i];
    return output_files_commit(files, OUTPUT_COUNT, &path, &reason) ? EXIT_DONE
                                                                    : console_unwritten(&b->console, path, reason);
}

/* ---- the end ----------------------------------------------------------------------------------------------------- */

static void print_summary(const bake_run *b) {
    const char *const more[] = {
        b->bin_path, b->payload_path, b->o->layer, b->o->report, b->o->preview, b->o->depfile
    };
    report_facts facts = make_facts(b);
    summary_print(&facts, more, sizeof more / sizeof *more);
}

static int run(bake_run *b) {
    int (*const stages[])(
        bake_run *) = { read_input,      check_options, open_outputs,  load_colors,   solve,
                        judge_interrupt, color,         serialise,     write_preview, write_payload,
                        write_layer,     write_report,  write_depfile, write_main,    commit_outputs };
    static const char *const names[sizeof stages / sizeof *stages] = { "read", [6] = "colour", [7] = "write" };
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        if (names[i]) progress_stage(&b->console.progress, names[i]);
        int status = stages[i](b);
        if (status != EXIT_DONE) return status;
        if (stages[i] == solve && !processes_is_first()) return EXIT_DONE;
        if (signals_interrupted && !b->solution) return interrupt_without_answer(&b->console);
    }
    progress_pause(&b->console.progress);
    if (!b->o->quiet) print_summary(b);
    if (b->is_interrupted) return EXIT_INTERRUPTED;
    return b->statistics.solver.converged ? EXIT_DONE : EXIT_NOT_CONVERGED;
}

int command_bake(const options *asked) {
    options named = *asked;
    occlusion_options(&named);
    char *payload = named.output ? NULL : usd_payload_name(named.layer);
    if (payload) named.output = payload;
    const options *o = &named;
    bake_run b = { .o = o, .as_read = named, .start_s = progress_seconds(), .error_reference = { -1.0, -1.0, -1.0 } };
    for (int i = 0; i < OUTPUT_COUNT; i++) b.files[i] = OUTPUT_FILE_NONE;
    console_start(&b.console, o);
    if (!processes_ranks()) signals_allow_interrupt();
    int status = run(&b);
    checkpoint_close(b.checkpoint, &b.console, status == EXIT_DONE);
    console_finish(&b.console, status == EXIT_DONE || status == EXIT_NOT_CONVERGED || status == EXIT_INTERRUPTED);
    for (int i = 0; i < OUTPUT_COUNT; i++) output_file_discard(&b.files[i]);
    gltf_output_free(&b.written);
    baked_colors_free(&b.colors);
    hemi_solution_destroy(b.solution);
    hemi_scene_destroy(b.scene);
    hemi_context_destroy(b.context);
    memory_limit_destroy(b.console.memory);
    asset_colors_free(&b.spaces);
    gltf_asset_destroy(b.asset);
    probe_set_destroy(&b.probes);
    usd_files_close(&b.usd);
    rows_file_close(&b.rows);
    lights_from_close(&b.lights);
    free(payload);
    free(b.payload_path);
    free(b.bin_path);
    return status;
}
