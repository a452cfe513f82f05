/* SPDX-License-Identifier: MIT
 * See instance_mean.h. All instances are in the frame of their mesh, so a vertex of one is at the same place in
 * another. Instances of another size are cut into other elements: there the nearest vertex that faces the same way
 * stands for it.
 */
#include "instance_mean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Vertices of a view by their x. */
typedef struct lookup {
    const hemi_mesh_view *view;
    uint32_t *order;
} lookup;

/* A vertex and its x, for sorting. */
typedef struct keyed {
    float x;
    uint32_t vertex;
} keyed;

static int compare(const void *a, const void *b) {
    const keyed *p = a, *q = b;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

static bool make_lookup(const hemi_mesh_view *view, lookup *out) {
    keyed *keys = malloc(((size_t)view->vertex_count + 1) * sizeof *keys);
    out->view = view;
    out->order = malloc(((size_t)view->vertex_count + 1) * sizeof *out->order);
    for (uint32_t v = 0; keys && v < view->vertex_count; v++) keys[v] = (keyed){ view->positions[3 * (size_t)v], v };
    if (keys) qsort(keys, view->vertex_count, sizeof *keys, compare);
    for (uint32_t v = 0; keys && out->order && v < view->vertex_count; v++) out->order[v] = keys[v].vertex;
    bool ok = keys && out->order;
    free(keys);
    return ok;
}

static float x_of(const lookup *l, uint32_t i) {
    return l->view->positions[3 * (size_t)l->order[i]];
}

static uint32_t first_from(const lookup *l, float x) {
    uint32_t low = 0, high = l->view->vertex_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (x_of(l, middle) < x)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Takes vertex i of the order if it is nearer than what there is; false: x alone is further away already. */
static bool try_vertex(const lookup *l, uint32_t i, const float *position, const float *normal, double *best,
                       uint32_t *found) {
    size_t v = l->order[i];
    double square = 0, facing = 0, dx = (double)x_of(l, i) - (double)position[0];
    if (dx * dx > *best) return false;
    for (int k = 0; k < 3; k++) {
        double d = (double)l->view->positions[3 * v + (size_t)k] - (double)position[k];
        square += d * d;
        facing += (double)l->view->normals[3 * v + (size_t)k] * (double)normal[k];
    }
    if (facing > 0.5 && square < *best) { /* within 60 degrees: not the other side, not round the corner */
        *best = square;
        *found = (uint32_t)v;
    }
    return true;
}

static uint32_t nearest(const lookup *l, const float *position, const float *normal) {
    uint32_t up = first_from(l, position[0]), down = up, found = UINT32_MAX, count = l->view->vertex_count;
    double best = INFINITY;
    bool more_up = true, more_down = true;
    while (more_up || more_down) {
        more_up = more_up && up < count && try_vertex(l, up++, position, normal, &best, &found);
        more_down = more_down && down > 0 && try_vertex(l, --down, position, normal, &best, &found);
    }
    return found;
}

static bool same_vertices(const hemi_mesh_view *a, const hemi_mesh_view *b) {
    return a->vertex_count == b->vertex_count &&
           memcmp(a->positions, b->positions, 12 * (size_t)a->vertex_count) == 0 &&
           memcmp(a->normals, b->normals, 12 * (size_t)a->vertex_count) == 0;
}

/* Adds the light of `from` at the vertices of `at` to sums[4*v+c], and how many were added to sums[4*v+3]. */
static bool add_light(const hemi_mesh_view *at, const hemi_mesh_view *from, double *sums) {
    lookup l = { NULL, NULL };
    bool same = same_vertices(at, from);
    if (!same && !make_lookup(from, &l)) {
        free(l.order);
        return false;
    }
    for (size_t v = 0; v < at->vertex_count; v++) {
        uint32_t there = same ? (uint32_t)v : nearest(&l, at->positions + 3 * v, at->normals + 3 * v);
        if (there == UINT32_MAX) continue;
        for (size_t c = 0; c < 3; c++) sums[4 * v + c] += (double)from->radiance[3 * (size_t)there + c];
        sums[4 * v + 3] += 1;
    }
    free(l.order);
    return true;
}

bool instance_mean(const gltf_asset *asset, hemi_mesh_view *views, uint32_t count, float **means) {
    double **sums = calloc((size_t)count + 1, sizeof *sums);
    bool ok = sums != NULL;
    for (uint32_t i = 0; ok && i < count; i++) {
        uint32_t first = gltf_asset_mesh_original(asset, i);
        const hemi_mesh_view *at = &views[first];
        if (!sums[first]) sums[first] = calloc(4 * ((size_t)at->vertex_count + 1), sizeof **sums);
        ok = sums[first] && add_light(at, &views[i], sums[first]);
    }
    for (uint32_t i = 0; ok && i < count; i++) {
        if (!sums[i]) continue;
        means[i] = malloc((3 * (size_t)views[i].vertex_count + 1) * sizeof *means[i]);
        ok = means[i] != NULL;
        for (size_t k = 0; ok && k < 3 * (size_t)views[i].vertex_count; k++)
            means[i][k] = (float)(sums[i][4 * (k / 3) + k % 3] / sums[i][4 * (k / 3) + 3]);
        if (ok) views[i].radiance = means[i];
    }
    for (uint32_t i = 0; sums && i < count; i++) free(sums[i]);
    free(sums);
    return ok;
}
