/* SPDX-License-Identifier: MIT
 * hemibake factors IN: the form-factor matrix of the input polygons as CSV.
 */
#include "commands.h"
#include "console.h"
#include "file_read.h"
#include "gltf_asset.h"
#include "output_file.h"
#include "path_text.h"
#include "printable.h"
#include "vs3_scene.h"

#include <hemibake/mesh_transform.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As of any asset. */
static const uint64_t FILE_SIZE_MAX = UINT64_C(1) << 31;

/* By its name; what has none of the known ones, as a FIFO of the shell's, by whether it begins as glTF does. */
static bool is_vs3(const char *path, const uint8_t *bytes, size_t size) {
    size_t first = 0;
    if (path_ends_in(path, ".vs3")) return true;
    if (path_ends_in(path, ".glb") || path_ends_in(path, ".gltf")) return false;
    while (first < size && bytes[first] && strchr(" \t\r\n", bytes[first])) first++;
    return first < size && bytes[first] != '{' && !(size >= 4 && memcmp(bytes, "glTF", 4) == 0);
}

static void add_mesh(const hemi_mesh_desc *mesh, vs3_scene *out) {
    uint32_t first = out->vertex_count;
    bool turn = hemi_transform_determinant(mesh->transform) < 0.0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        hemi_transform_point(mesh->transform, mesh->positions + 3 * (size_t)v,
                             out->positions + 3 * (size_t)(first + v));
    out->vertex_count += mesh->vertex_count;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *index = mesh->indices + 3 * (size_t)t;
        int32_t *corner = out->corners + 4 * (size_t)out->polygon_count;
        corner[0] = (int32_t)(first + index[0]);
        corner[1] = (int32_t)(first + index[turn ? 2 : 1]);
        corner[2] = (int32_t)(first + index[turn ? 1 : 2]);
        corner[3] = -1;
        snprintf(out->names[out->polygon_count++], VS3_NAME_SIZE, "%.20s/%u", mesh->name ? mesh->name : "", t);
    }
}

/* Every triangle of the asset is a polygon. */
static hemi_result list_gltf(const options *o, const uint8_t *bytes, size_t byte_count, vs3_scene *out, char *message,
                             size_t size) {
    char text[GLTF_MESSAGE_SIZE];
    gltf_asset *asset;
    uint64_t vertices = 0, triangles = 0;
    hemi_mesh_desc mesh;
    const gltf_limits limits = { .root = o->root, .bytes = bytes, .byte_count = byte_count };
    hemi_result result = gltf_asset_read_within(o->inputs[0], &limits, &asset, text);
    snprintf(message, size, "%s", text);
    if (result != HEMI_OK) return result;
    for (uint32_t i = 0; gltf_asset_mesh(asset, i, &mesh); i++)
        vertices += mesh.vertex_count, triangles += mesh.triangle_count;
    if (triangles == 0 || triangles > HEMI_FACTORS_MAX) {
        snprintf(message, size, "it has %llu triangles; factors takes 1 to %u polygons", (unsigned long long)triangles,
                 HEMI_FACTORS_MAX);
        gltf_asset_destroy(asset);
        return HEMI_ERROR_LIMIT;
    }
    out->positions = malloc(3 * (size_t)vertices * sizeof *out->positions);
    out->corners = malloc(4 * (size_t)triangles * sizeof *out->corners);
    out->obstructions = calloc((size_t)triangles, sizeof *out->obstructions);
    out->names = malloc((size_t)triangles * sizeof *out->names);
    bool ok = out->positions && out->corners && out->obstructions && out->names;
    for (uint32_t i = 0; ok && gltf_asset_mesh(asset, i, &mesh); i++) add_mesh(&mesh, out);
    gltf_asset_destroy(asset);
    if (!ok) snprintf(message, size, "out of memory");
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* Names go between quotes; a quote in one is doubled (RFC 4180). */
static void print_name(FILE *to, const char *name) {
    char part[VS3_NAME_SIZE];
    fputc('"', to);
    for (; *name; name += strlen(part)) {
        snprintf(part, sizeof part, "%.*s", (int)(strcspn(name + 1, "\"") + 1), name);
        if (*name == '"') fputc('"', to);
        print_printable(to, part);
    }
    fputc('"', to);
}

static void print_csv(FILE *to, const vs3_scene *s, const hemi_factors *f) {
    size_t n = f->polygon_count;
    fprintf(to, "surface,name,area,closure");
    for (size_t j = 0; j < n; j++)
        if (!s->obstructions[j]) fprintf(to, ",F_%zu", j + 1);
    for (size_t j = 0; j < n; j++)
        if (!s->obstructions[j]) fprintf(to, ",error_%zu", j + 1);
    fprintf(to, "\n");
    for (size_t i = 0; i < n; i++) {
        double closure = 0.0;
        if (s->obstructions[i]) continue;
        for (size_t j = 0; j < n; j++) closure += f->factors[i * n + j];
        fprintf(to, "%zu,", i + 1);
        print_name(to, s->names[i]);
        fprintf(to, ",%.12g,%.12g", f->areas[i], closure);
        for (size_t j = 0; j < n; j++)
            if (!s->obstructions[j]) fprintf(to, ",%.12g", f->factors[i * n + j]);
        for (size_t j = 0; j < n; j++)
            if (!s->obstructions[j]) fprintf(to, ",%.3g", f->errors[i * n + j]);
        fprintf(to, "\n");
    }
}

static void report_oddities(console *c, const vs3_scene *s, const hemi_factors *f) {
    const struct {
        uint64_t count;
        const char *text;
    } lines[] = { { f->not_planar, "quads are not planar: each is taken as two triangles" },
                  { f->concave, "quads are concave: each is taken as two triangles" },
                  { f->crossing, "quads cross themselves: left out" },
                  { f->no_area, "polygons have no area: left out" },
                  { f->not_finite, "polygons have corners that are not finite: left out" },
                  { s->combined, "surfaces ask to be combined (cmb): their rows stay apart" },
                  { f->unconverged_pairs, "pairs stayed above the tolerance: see their errors" } };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (lines[i].count && !c->quiet)
            console_error(c, "warning: %llu %s", (unsigned long long)lines[i].count, lines[i].text);
}

static int write_csv(const options *o, console *c, const vs3_scene *s, const hemi_factors *f) {
    const char *reason = "out of memory";
    char *text = NULL;
    size_t size = 0;
    if (!o->output) {
        print_csv(stdout, s, f);
        return EXIT_DONE; /* or what streams_close says */
    }
    FILE *memory = open_memstream(&text, &size);
    bool ok = memory != NULL;
    if (memory) print_csv(memory, s, f), ok = fclose(memory) == 0;
    ok = ok && output_file_save(o->output, text, size, &reason);
    free(text);
    return ok ? EXIT_DONE : console_unwritten(c, o->output, reason);
}

static int compute(const options *o, console *c, const vs3_scene *s) {
    hemi_factors_desc desc = { .struct_size = sizeof desc,
                               .positions = s->positions,
                               .vertex_count = s->vertex_count,
                               .corners = s->corners,
                               .obstructions = s->obstructions,
                               .polygon_count = s->polygon_count,
                               .tolerance = o->tolerance };
    hemi_context *context;
    hemi_factors factors = { .struct_size = sizeof factors };
    int status = console_context(c, o->threads, &context);
    if (status != EXIT_DONE) return status;
    status = EXIT_BAD_INPUT;
    hemi_result result = hemi_factors_compute(context, &desc, &factors);
    if (result == HEMI_ERROR_MEMORY) console_error(c, "out of memory");
    if (result == HEMI_OK) {
        report_oddities(c, s, &factors);
        status = write_csv(o, c, s, &factors);
        hemi_factors_free(&factors);
    }
    hemi_context_destroy(context);
    return status;
}

static hemi_result read_polygons(const options *o, vs3_scene *out, char *message, size_t size) {
    const char *path = o->inputs[0];
    uint8_t *bytes;
    size_t byte_count;
    hemi_result result = file_read_bytes(path, o->root, FILE_SIZE_MAX, &bytes, &byte_count, message);
    if (result == HEMI_OK)
        result = is_vs3(path, bytes, byte_count) ? vs3_parse(bytes, byte_count, out, message)
                                                 : list_gltf(o, bytes, byte_count, out, message, size);
    free(bytes);
    return result;
}

int command_factors(const options *o) {
    char message[GLTF_MESSAGE_SIZE];
    vs3_scene polygons = { 0 };
    console c = { 0 };
    console_start(&c, o);
    hemi_result result = read_polygons(o, &polygons, message, sizeof message);
    if (result != HEMI_OK) console_error(&c, "%s", message);
    int status = result == HEMI_OK ? compute(o, &c, &polygons) : EXIT_BAD_INPUT;
    vs3_scene_free(&polygons);
    return status;
}
