/* SPDX-License-Identifier: MIT
 * How far is a baked mesh from the truth, and where? Triangles stream past a grid of probes; every probe remembers the
 * best triangle it has seen; the sums run over the probes in index order. */
#include "match.h"

#include "probe_grid.h"

#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a probe knows of the best triangle so far. */
typedef struct candidate {
    double distance, facing; /* metres; cosine */
    size_t mesh;             /* MATCH_NONE: none so far */
    uint32_t triangle;
    double weights[3];
} candidate;

typedef struct facet {
    double corners[3][3], normal[3]; /* world; normal is unit and on the front */
    double winding, area;            /* -1 where the mesh is mirrored; twice the triangle's */
    double low[3], high[3];
} facet;

typedef struct matching {
    const match_mesh *meshes;
    const probe_set *set;
    probe_grid grid;
    candidate *candidates; /* one a probe */
    double distance, noise;
    size_t degenerate;
    double *differences, *truths; /* of the probes that matched, in their order: |bake - truth|, |truth| */
} matching;

static const char *name_of(const match_mesh *mesh) {
    return mesh->name ? mesh->name : "(unnamed)";
}

/* ---- geometry -------------------------------------------------------------------------------------------------- */

/* False: a triangle without area. */
static bool facet_load(const hemi_mesh_desc *mesh, uint32_t triangle, facet *f) {
    double n[3];
    for (int k = 0; k < 3; k++)
        hemi_transform_point(mesh->transform, mesh->positions + 3 * (size_t)mesh->indices[3 * (size_t)triangle + k],
                             f->corners[k]);
    triangle_cross(n, f->corners[0], f->corners[1], f->corners[2]);
    f->area = vec3_length(n);
    f->winding = hemi_transform_determinant(mesh->transform) < 0.0 ? -1.0 : 1.0;
    if (triangle_is_degenerate(f->area, triangle_longest_squared(f->corners[0], f->corners[1], f->corners[2])))
        return false;
    for (int k = 0; k < 3; k++) {
        f->normal[k] = n[k] * f->winding / f->area;
        f->low[k] = fmin(f->corners[0][k], fmin(f->corners[1][k], f->corners[2][k]));
        f->high[k] = fmax(f->corners[0][k], fmax(f->corners[1][k], f->corners[2][k]));
    }
    return true;
}

/* Barycentric coordinates of the foot of x on the plane: of corner k, the part of the area that the edge facing it
 * spans with x. True if the foot lies in the triangle. */
static bool foot_weights(const facet *f, const double x[3], double weights[3]) {
    for (int k = 0; k < 3; k++) {
        const double *a = f->corners[(k + 1) % 3], *b = f->corners[(k + 2) % 3];
        double edge[3], to_x[3], n[3];
        vec3_sub(edge, b, a);
        vec3_sub(to_x, x, a);
        vec3_cross(n, edge, to_x);
        weights[k] = f->winding * vec3_dot(n, f->normal) / f->area;
    }
    return weights[0] >= 0.0 && weights[1] >= 0.0 && weights[2] >= 0.0;
}

/* Distance to the edge that faces corner k, and the weights of the nearest point on it. */
static double edge_distance(const facet *f, int k, const double x[3], double weights[3]) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double edge[3], to_x[3], away[3];
    vec3_sub(edge, f->corners[j], f->corners[i]);
    vec3_sub(to_x, x, f->corners[i]);
    double t = fmin(fmax(vec3_dot(to_x, edge) / vec3_dot(edge, edge), 0.0), 1.0);
    for (int c = 0; c < 3; c++) away[c] = to_x[c] - t * edge[c];
    weights[k] = 0.0;
    weights[i] = 1.0 - t;
    weights[j] = t;
    return vec3_length(away);
}

/* Distance from x to the triangle, and the weights of the nearest point on it. */
static double facet_distance(const facet *f, const double x[3], double height, double weights[3]) {
    if (foot_weights(f, x, weights)) return fabs(height);
    double nearest = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        double trial[3], distance = edge_distance(f, k, x, trial);
        if (distance < nearest) {
            nearest = distance;
            memcpy(weights, trial, sizeof trial);
        }
    }
    return nearest;
}

/* ---- matching -------------------------------------------------------------------------------------------------- */

/* Triangles come in order, so that of equals the first stays. */
static bool is_better(const candidate *a, const candidate *b) {
    if (b->mesh == MATCH_NONE || a->distance < b->distance) return true;
    return a->distance == b->distance && a->facing > b->facing;
}

static void visit_facet(matching *m, size_t probe_index, const facet *f, candidate trial) {
    const probe *p = &m->set->probes[probe_index];
    double x[3], n[3], from_corner[3];
    for (int k = 0; k < 3; k++) {
        x[k] = p->position[k];
        n[k] = p->normal[k];
    }
    trial.facing = vec3_dot(n, f->normal);
    if (!(trial.facing > MATCH_FACING_MIN)) return;
    vec3_sub(from_corner, x, f->corners[0]);
    double height = vec3_dot(from_corner, f->normal);
    if (fabs(height) > m->distance) return;
    trial.distance = fmax(facet_distance(f, x, height, trial.weights) - m->noise, 0.0);
    if (trial.distance + m->noise > m->distance) return;
    if (is_better(&trial, &m->candidates[probe_index])) m->candidates[probe_index] = trial;
}

static void visit_cells(matching *m, const probe_cells *cells, const facet *f, candidate trial) {
    const probe_grid *grid = &m->grid;
    for (uint32_t z = cells->first[2]; z <= cells->last[2]; z++)
        for (uint32_t y = cells->first[1]; y <= cells->last[1]; y++) {
            uint32_t begin = grid->starts[probe_grid_index(grid, cells->first[0], y, z)];
            uint32_t end = grid->starts[probe_grid_index(grid, cells->last[0], y, z) + 1];
            for (uint32_t i = begin; i < end; i++) visit_facet(m, grid->members[i], f, trial);
        }
}

static void match_one_mesh(matching *m, size_t mesh_index) {
    const hemi_mesh_desc *mesh = m->meshes[mesh_index].mesh;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        facet f;
        probe_cells cells;
        if (!facet_load(mesh, t, &f)) {
            m->degenerate++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            f.low[k] -= m->distance;
            f.high[k] += m->distance;
        }
        candidate trial = { .mesh = mesh_index, .triangle = t };
        if (probe_grid_cells(&m->grid, f.low, f.high, &cells)) visit_cells(m, &cells, &f, trial);
    }
}

/* ---- checks ---------------------------------------------------------------------------------------------------- */

static hemi_result check_mesh(const match_mesh *mesh, char *message) {
    if (!mesh->mesh) return probes_fail(HEMI_ERROR_ARGUMENT, message, "mesh %s has no geometry", name_of(mesh));
    const hemi_mesh_desc *desc = mesh->mesh;
    if (desc->triangle_count == 0) return HEMI_OK;
    if (!desc->positions || !desc->indices || !mesh->radiance)
        return probes_fail(HEMI_ERROR_ARGUMENT, message, "mesh %s has no positions, indices or radiance",
                           name_of(mesh));
    for (size_t i = 0; i < 3 * (size_t)desc->triangle_count; i++)
        if (desc->indices[i] >= desc->vertex_count)
            return probes_fail(HEMI_ERROR_DATA, message, "mesh %s: index %lu of triangle %zu is out of range",
                               name_of(mesh), (unsigned long)desc->indices[i], i / 3);
    return HEMI_OK;
}

/* Grows the box by the mesh's vertices in the world. */
static hemi_result grow_box(const match_mesh *mesh, double low[3], double high[3], char *message) {
    uint32_t count = mesh->mesh->triangle_count > 0 ? mesh->mesh->vertex_count : 0;
    for (uint32_t v = 0; v < count; v++) {
        double x[3];
        hemi_transform_point(mesh->mesh->transform, mesh->mesh->positions + 3 * (size_t)v, x);
        for (int k = 0; k < 3; k++) {
            if (!isfinite(x[k]))
                return probes_fail(HEMI_ERROR_DATA, message, "mesh %s: vertex %lu is not finite", name_of(mesh),
                                   (unsigned long)v);
            low[k] = fmin(low[k], x[k]);
            high[k] = fmax(high[k], x[k]);
        }
    }
    return HEMI_OK;
}

static hemi_result measure(matching *m, size_t mesh_count, char *message) {
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL }, high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL }, diagonal[3];
    for (size_t i = 0; i < mesh_count; i++) {
        hemi_result result = check_mesh(&m->meshes[i], message);
        if (result == HEMI_OK) result = grow_box(&m->meshes[i], low, high, message);
        if (result != HEMI_OK) return result;
    }
    if (low[0] > high[0])
        return probes_fail(HEMI_ERROR_DATA, message, "there are no triangles to compare with the probes");
    vec3_sub(diagonal, high, low);
    double length = vec3_length(diagonal);
    m->distance = MATCH_DISTANCE * length;
    m->noise = MATCH_DISTANCE_NOISE * length;
    return HEMI_OK;
}

/* ---- sums ------------------------------------------------------------------------------------------------------ */

static void baked_radiance(const match_mesh *mesh, const candidate *c, double out[3]) {
    const uint32_t *corners = mesh->mesh->indices + 3 * (size_t)c->triangle;
    for (int band = 0; band < 3; band++) {
        out[band] = 0.0;
        for (int k = 0; k < 3; k++) out[band] += c->weights[k] * mesh->radiance[3 * (size_t)corners[k] + band];
    }
}

static void add_probe(match_figure *figure, const probe *p, const double difference[3]) {
    figure->matched++;
    figure->noise_squared += 3.0 * p->standard_error * p->standard_error;
    for (int band = 0; band < 3; band++) {
        figure->difference_squared += difference[band] * difference[band];
        figure->truth_squared += (double)p->radiance[band] * p->radiance[band];
        figure->difference += difference[band];
        figure->truth += p->radiance[band];
    }
}

static void keep_worst(match_result *out, size_t probe_index, size_t mesh, const double bake[3], double difference) {
    if (out->worst_probe != MATCH_NONE && difference <= out->worst_difference) return;
    out->worst_probe = probe_index;
    out->worst_mesh = mesh;
    out->worst_difference = difference;
    for (int band = 0; band < 3; band++) out->worst_radiance[band] = (float)bake[band];
}

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* difference[i], truth[i]: lengths, of each probe that matched. */
static void rank(double *difference, const double *truth, size_t count, match_result *out) {
    double mean = 0.0;
    for (size_t i = 0; i < count; i++) mean += truth[i] / (double)count;
    for (size_t i = 0; i < count; i++) {
        double level = fmax(truth[i], MATCH_DIM_SHARE * mean);
        difference[i] = level > 0.0 ? difference[i] / level : difference[i] > 0.0 ? HUGE_VAL : 0.0;
    }
    qsort(difference, count, sizeof *difference, compare_numbers);
    out->median = difference[count / 2];
    out->percentile95 = difference[(size_t)(0.95 * (double)(count - 1))];
}

static hemi_result tally(const matching *m, match_result *out, char *message) {
    for (size_t i = 0; i < m->set->count; i++) {
        const candidate *c = &m->candidates[i];
        const probe *p = &m->set->probes[i];
        double bake[3], difference[3];
        if (c->mesh == MATCH_NONE) {
            out->unmatched++;
            out->places[i].mesh = MATCH_NONE;
            continue;
        }
        baked_radiance(&m->meshes[c->mesh], c, bake);
        for (int band = 0; band < 3; band++) difference[band] = bake[band] - p->radiance[band];
        if (!isfinite(vec3_dot(difference, difference)))
            return probes_fail(HEMI_ERROR_DATA, message, "mesh %s: the radiance of triangle %lu is not finite",
                               name_of(&m->meshes[c->mesh]), (unsigned long)c->triangle);
        add_probe(&out->total, p, difference);
        add_probe(&out->meshes[c->mesh], p, difference);
        keep_worst(out, i, c->mesh, bake, vec3_length(difference));
        match_place *place = &out->places[i];
        *place = (match_place){ .mesh = c->mesh, .triangle = c->triangle };
        vec3_copy(place->weights, c->weights);
        vec3_copy(place->radiance, bake);
        const double truth[3] = { p->radiance[0], p->radiance[1], p->radiance[2] };
        m->differences[out->total.matched - 1] = vec3_length(difference);
        m->truths[out->total.matched - 1] = vec3_length(truth);
    }
    if (out->total.matched == 0)
        return probes_fail(HEMI_ERROR_DATA, message, "none of the %zu probes lies on the mesh: is it the same scene?",
                           m->set->count);
    rank(m->differences, m->truths, out->total.matched, out);
    return HEMI_OK;
}

/* ---- public ---------------------------------------------------------------------------------------------------- */

static hemi_result match_all(matching *m, size_t mesh_count, match_result *out, char *message) {
    hemi_result result = probe_grid_create(m->set, &m->grid);
    m->candidates = malloc(m->set->count * sizeof *m->candidates);
    m->differences = malloc(m->set->count * sizeof *m->differences);
    m->truths = malloc(m->set->count * sizeof *m->truths);
    out->meshes = calloc(mesh_count, sizeof *out->meshes);
    out->places = calloc(m->set->count, sizeof *out->places);
    if (result != HEMI_OK || !m->candidates || !m->differences || !m->truths || !out->meshes || !out->places)
        return probes_fail(HEMI_ERROR_MEMORY, message, "out of memory for %zu probes", m->set->count);
    for (size_t i = 0; i < m->set->count; i++) m->candidates[i] = (candidate){ .mesh = MATCH_NONE };
    for (size_t i = 0; i < mesh_count; i++) match_one_mesh(m, i);
    return tally(m, out, message);
}

hemi_result probes_match(const match_mesh *meshes, size_t mesh_count, const probe_set *set, match_result *out,
                         char message[PROBES_MESSAGE_SIZE]) {
    *out = (match_result){ .worst_probe = MATCH_NONE, .worst_mesh = MATCH_NONE };
    message[0] = '\0';
    if (!meshes || mesh_count == 0 || !set || set->count == 0 || set->count > PROBES_COUNT_MAX)
        return probes_fail(HEMI_ERROR_ARGUMENT, message, "a comparison takes at least one mesh and one probe");
    matching m = { .meshes = meshes, .set = set };
    hemi_result result = measure(&m, mesh_count, message);
    if (result == HEMI_OK) result = match_all(&m, mesh_count, out, message);
    out->mesh_count = mesh_count;
    out->degenerate_triangles = m.degenerate;
    out->distance = m.distance;
    probe_grid_destroy(&m.grid);
    free(m.candidates);
    free(m.differences);
    free(m.truths);
    if (result != HEMI_OK) match_result_destroy(out);
    return result;
}

void match_result_destroy(match_result *result) {
    if (!result) return;
    free(result->meshes);
    free(result->places);
    *result = (match_result){ .worst_probe = MATCH_NONE, .worst_mesh = MATCH_NONE };
}

static double length_of_truth(const probe *p) {
    const double truth[3] = { p->radiance[0], p->radiance[1], p->radiance[2] };
    return vec3_length(truth);
}

double match_dim_level(const probe_set *set) {
    double sum = 0.0;
    for (size_t i = 0; i < set->count; i++) sum += length_of_truth(&set->probes[i]);
    return set->count > 0 ? MATCH_DIM_SHARE * sum / (double)set->count : 0.0;
}

double match_place_error(const probe *p, const match_place *at, double dim) {
    double difference[3], level = fmax(length_of_truth(p), dim);
    for (int k = 0; k < 3; k++) difference[k] = at->radiance[k] - (double)p->radiance[k];
    return level > 0.0 ? vec3_length(difference) / level : 0.0;
}

static double ratio(double numerator, double denominator) {
    if (denominator != 0.0) return numerator / denominator;
    return numerator == 0.0 ? 0.0 : HUGE_VAL;
}

double match_error(const match_figure *figure) {
    return sqrt(ratio(figure->difference_squared, figure->truth_squared));
}

double match_noise(const match_figure *figure) {
    return sqrt(ratio(figure->noise_squared, figure->truth_squared));
}

double match_bias(const match_figure *figure) {
    return ratio(figure->difference, figure->truth);
}
