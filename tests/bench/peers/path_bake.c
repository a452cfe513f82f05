/* SPDX-License-Identifier: MIT
 * How far is a bake by path tracing from the truth, and how long does it take? A line of JSON for each rung of paths.
 *
 *     path_bake vertices SCENE.glb PROBES.hprb --edge M             vertices of a uniform tessellation
 *     path_bake fitted SCENE.glb PROBES.hprb BAKED.glb              least squares over the triangles of our own output,
 *     path_bake fitted SCENE.glb PROBES.hprb --edge M               or over those of a uniform tessellation
 *     path_bake area SCENE.glb                                      m2 of all fronts
 *
 * with the options of ../../oracle/pathtrace.c. Seconds are those since the start: reading, building, tracing and
 * fitting, without judging and writing. The judge is that of `hemibake compare`.
 */
#include "fitted_bake.h"
#include "input.h"
#include "match.h"
#include "vertex_bake.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_DEFAULT = 64, SAMPLES_MAX = 1 << 20 };

/* How smooth a fit may want to be: core's own, and what few paths need. All are judged, the best counts. */
static const double SMOOTHNESS[] = { 2e-3, 2e-2, 1e-1, 5e-1 };

typedef struct bake {
    const input_options *options;
    input in;
    gltf_asset *mesh; /* of fitted */
    probe_set set;
    vertex_bake vertices;
    fitted_bake fitted;
    bool is_fitted;
    double begin, judging; /* s */
    hemi_mesh_desc desc;   /* what is judged */
    float *radiance;
} bake;

static void tessellation_desc(bake *b) {
    const tessellation *t = &b->vertices.tessellation;
    b->desc = (hemi_mesh_desc){ .positions = t->positions,
                                .indices = t->indices,
                                .vertex_count = (uint32_t)t->vertex_count,
                                .triangle_count = (uint32_t)t->triangle_count };
}

static bool fit_to_asset(bake *b) {
    uint32_t count = gltf_asset_mesh_count(b->mesh);
    hemi_mesh_desc *meshes = malloc((count + 1) * sizeof *meshes);
    if (!meshes) return false;
    for (uint32_t i = 0; i < count; i++) gltf_asset_mesh(b->mesh, i, &meshes[i]);
    bool ok = fitted_bake_create(&b->in.tracer, meshes, count, &b->fitted);
    free(meshes);
    return ok;
}

static bool open_bake(bake *b) {
    char message[GLTF_MESSAGE_SIZE], of_probes[PROBES_MESSAGE_SIZE];
    const input_options *o = b->options;
    if (!input_read(o->files[1], o, &b->in)) return false;
    if (probe_set_read(o->files[2], NULL, &b->set, of_probes) != HEMI_OK) {
        fprintf(stderr, "%s: %s\n", o->files[2], of_probes);
        return false;
    }
    if (!b->is_fitted || o->edge > 0) {
        if (!vertex_bake_create(&b->in.tracer, o->edge, &b->vertices)) return false;
        tessellation_desc(b);
        return !b->is_fitted || fitted_bake_create(&b->in.tracer, &b->desc, 1, &b->fitted);
    }
    if (gltf_asset_read(o->files[3], &b->mesh, message) != HEMI_OK) {
        fprintf(stderr, "%s: %s\n", o->files[3], message);
        return false;
    }
    return fit_to_asset(b);
}

static bool set_output(bake *b) {
    if (b->is_fitted) {
        b->desc = (hemi_mesh_desc){ .positions = b->fitted.positions,
                                    .indices = b->fitted.indices,
                                    .vertex_count = (uint32_t)b->fitted.vertex_count,
                                    .triangle_count = (uint32_t)b->fitted.triangle_count };
    }
    b->radiance = malloc((3 * (size_t)b->desc.vertex_count + 1) * sizeof *b->radiance);
    return b->radiance != NULL;
}

static void close_bake(bake *b) {
    free(b->radiance);
    vertex_bake_destroy(&b->vertices);
    fitted_bake_destroy(&b->fitted);
    probe_set_destroy(&b->set);
    gltf_asset_destroy(b->mesh);
    input_destroy(&b->in);
}

/* Judges what is in radiance and prints a line; seconds: what came of it took. */
static bool judge(bake *b, uint32_t samples, double smoothness, double seconds) {
    char message[PROBES_MESSAGE_SIZE];
    match_mesh mesh = { "bake", &b->desc, b->radiance };
    match_result match;
    if (probes_match(&mesh, 1, &b->set, &match, message) != HEMI_OK) {
        fprintf(stderr, "%s: %s\n", b->options->files[2], message);
        return false;
    }
    printf(
        "{\"samples\": %u, \"smoothness\": %g, \"vertices\": %u, \"seconds\": %.4f, \"error\": %.6f, \"bias\": %.6f, "
        "\"unmatched\": %zu}\n",
        samples, smoothness, b->desc.vertex_count, seconds, match_error(&match.total), match_bias(&match.total),
        match.unmatched);
    fflush(stdout);
    match_result_destroy(&match);
    return true;
}

/* One rung: what has been traced takes so many seconds, and each way to show it what that takes. */
static bool show(bake *b, uint32_t samples, double traced) {
    if (!b->is_fitted) {
        vertex_bake_get(&b->vertices, b->radiance);
        return judge(b, samples, 0, traced);
    }
    for (size_t i = 0; i < sizeof SMOOTHNESS / sizeof *SMOOTHNESS; i++) {
        double before = input_clock();
        if (!fitted_bake_get(&b->fitted, SMOOTHNESS[i], b->radiance)) return false;
        if (!judge(b, samples, SMOOTHNESS[i], traced + input_clock() - before)) return false;
    }
    return true;
}

static bool climb(bake *b) {
    const input_options *o = b->options;
    uint32_t most = o->samples ? o->samples : o->seconds > 0 ? SAMPLES_MAX : SAMPLES_DEFAULT;
    for (uint32_t samples = 1; samples <= most; samples *= 2) {
        bool ok = b->is_fitted ? fitted_bake_climb(&b->fitted, samples, o->threads)
                               : vertex_bake_add(&b->vertices, samples - b->vertices.samples, o->threads);
        double now = input_clock(), traced = now - b->begin - b->judging;
        if (!ok || !show(b, samples, traced)) return false;
        b->judging += input_clock() - now;
        if (o->seconds > 0 && 2 * traced > o->seconds) break;
    }
    return true;
}

static int print_area(const input_options *o) {
    input in;
    double area = 0;
    bool ok = input_read(o->files[1], o, &in);
    for (uint32_t t = 0; ok && t < in.scene.triangle_count; t++)
        area += in.scene.triangles[t].area * (traced_scene_double_sided(&in.scene, t) ? 2 : 1);
    if (ok) printf("%.9g\n", area);
    input_destroy(&in);
    return ok ? 0 : 1;
}

int main(int argc, char **argv) {
    input_options o;
    bake b = { .options = &o, .begin = input_clock() };
    bool ok = input_parse(argc, argv, &o) && o.file_count >= 2;
    if (ok && strcmp(o.files[0], "area") == 0) return print_area(&o);
    b.is_fitted = ok && strcmp(o.files[0], "fitted") == 0;
    bool is_vertices = ok && strcmp(o.files[0], "vertices") == 0, cuts = o.edge > 0;
    ok = ok && (b.is_fitted || (is_vertices && cuts)) && o.file_count == (cuts ? 3 : 4);
    if (!ok) {
        fprintf(stderr, "usage: path_bake vertices|fitted|area SCENE.glb ...; path_bake.c says what\n");
        return 2;
    }
    ok = open_bake(&b) && set_output(&b) && climb(&b);
    close_bake(&b);
    return ok ? 0 : 1;
}
