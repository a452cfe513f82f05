/* SPDX-License-Identifier: MIT
 * A probe says how far off the vertices around it are, by its weights; what lies between probes is between their
 * vertices, and takes the mean of those beside it.
 */
#include "heatmap.h"

#include "false_color.h"
#include "output_file.h"
#include "preview.h"

#include "geometry/places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* From one vertex with a probe to the next there are no more triangles than this. */
enum { SPREAD_ROUNDS = 64 };

/* What no probe is near: a grey that no error has. */
static const double UNKNOWN = 0.35;

typedef struct field {
    const match_mesh *mesh;
    double *sum, *weight; /* of each vertex */
} field;

static void add_probes(field *fields, const probe_set *probes, const match_result *match) {
    double dim = match_dim_level(probes);
    for (size_t i = 0; i < probes->count; i++) {
        const match_place *at = &match->places[i];
        if (at->mesh == MATCH_NONE) continue;
        const field *f = &fields[at->mesh];
        const uint32_t *corner = f->mesh->mesh->indices + 3 * (size_t)at->triangle;
        double error = match_place_error(&probes->probes[i], at, dim);
        for (int k = 0; k < 3; k++) {
            f->sum[corner[k]] += at->weights[k] * error;
            f->weight[corner[k]] += at->weights[k];
        }
    }
}

/* What is said of the places of a mesh, so that facets with vertices of their own learn from each other. */
typedef struct places {
    uint32_t *of_vertex, *scratch;
    double *found, *share; /* of each place */
} places;

static void tell(const field *f, const places *p, uint32_t from, uint32_t to) {
    if (!(f->weight[from] > 0.0)) return;
    p->found[p->of_vertex[to]] += f->sum[from] / f->weight[from];
    p->share[p->of_vertex[to]] += 1.0;
}

/* One round: what knows nothing yet and is beside what does. Returns how many learned. */
static size_t spread(const field *f, const places *p) {
    const hemi_mesh_desc *m = f->mesh->mesh;
    size_t learned = 0;
    memset(p->found, 0, m->vertex_count * sizeof *p->found);
    memset(p->share, 0, m->vertex_count * sizeof *p->share);
    for (size_t i = 0; i < 3 * (size_t)m->triangle_count; i++)
        for (size_t k = i - i % 3; k < i - i % 3 + 3; k++) tell(f, p, m->indices[k], m->indices[i]);
    for (size_t v = 0; v < m->vertex_count; v++) {
        uint32_t at = p->of_vertex[v];
        if (f->weight[v] > 0.0 || !(p->share[at] > 0.0)) continue;
        f->sum[v] = p->found[at] / p->share[at], f->weight[v] = 1.0;
        learned++;
    }
    return learned;
}

static bool open_places(places *p, const hemi_mesh_desc *m) {
    size_t count = m->vertex_count + 1;
    *p = (places){ malloc(count * sizeof *p->of_vertex), malloc(places_slot_count(count) * sizeof *p->scratch),
                   malloc(count * sizeof *p->found), malloc(count * sizeof *p->share) };
    bool ok = p->of_vertex && p->scratch && p->found && p->share;
    if (ok) places_find_floats(m->positions, m->vertex_count, p->scratch, p->of_vertex);
    return ok;
}

static void close_places(places *p) {
    free(p->of_vertex);
    free(p->scratch);
    free(p->found);
    free(p->share);
}

static bool open_field(field *f, const match_mesh *mesh) {
    size_t count = mesh->mesh->vertex_count + 1;
    *f = (field){ mesh, calloc(count, sizeof(double)), calloc(count, sizeof(double)) };
    return f->sum && f->weight;
}

static float *color_field(const field *f, double full) {
    size_t count = f->mesh->mesh->vertex_count;
    float *rgb = malloc((3 * count + 1) * sizeof *rgb);
    places p;
    bool ok = open_places(&p, f->mesh->mesh);
    for (int round = 0; ok && round < SPREAD_ROUNDS && spread(f, &p) > 0; round++) continue;
    for (size_t v = 0; rgb && v < count; v++) {
        if (f->weight[v] > 0.0)
            false_color(full > 0.0 ? f->sum[v] / f->weight[v] / full : 0.0, rgb + 3 * v);
        else
            for (size_t k = 0; k < 3; k++) rgb[3 * v + k] = (float)UNKNOWN;
    }
    close_places(&p);
    if (ok) return rgb;
    free(rgb);
    return NULL;
}

static int draw(const gltf_asset *asset, const match_mesh *meshes, float *const *colors, const uint32_t *of_asset,
                size_t count, const options *o, console *c) {
    preview_mesh *drawn = calloc(gltf_asset_mesh_count(asset) + 1, sizeof *drawn);
    hemi_context *context = NULL;
    const char *reason = "";
    unsigned char *bytes = NULL;
    size_t size = 0;
    int status = drawn ? console_context(c, 1, &context) : EXIT_BAD_INPUT;
    for (size_t i = 0; drawn && i < count; i++)
        drawn[of_asset[i]] = (preview_mesh){ .shape = *meshes[i].mesh, .colors = colors[i] };
    if (status == EXIT_DONE)
        status = preview_draw(context, asset, drawn, gltf_asset_mesh_count(asset), false, o, c, &bytes, &size);
    if (status == EXIT_DONE && !output_file_save(o->heatmap, bytes, size, &reason))
        status = console_unwritten(c, o->heatmap, reason);
    hemi_context_destroy(context);
    free(bytes);
    free(drawn);
    return status;
}

int heatmap_write(const gltf_asset *asset, const match_mesh *meshes, const uint32_t *of_asset, size_t count,
                  const probe_set *probes, const match_result *match, const options *o, console *c, double *full) {
    field *fields = calloc(count + 1, sizeof *fields);
    float **colors = calloc(count + 1, sizeof *colors);
    bool ok = fields && colors;
    *full = match->percentile95;
    for (size_t i = 0; ok && i < count; i++) ok = open_field(&fields[i], &meshes[i]);
    if (ok) add_probes(fields, probes, match);
    for (size_t i = 0; ok && i < count; i++) ok = (colors[i] = color_field(&fields[i], *full)) != NULL;
    int status =
        ok ? draw(asset, meshes, colors, of_asset, count, o, c) : console_error(c, "out of memory for the heatmap");
    for (size_t i = 0; fields && colors && i < count; i++) {
        free(fields[i].sum);
        free(fields[i].weight);
        free(colors[i]);
    }
    free(fields);
    free(colors);
    return status;
}
