/* SPDX-License-Identifier: MIT */
#include "vertex_bake.h"

#include "base/jobs.h"
#include "geometry/vec3.h"

#include <stdlib.h>
#include <string.h>

/* Vertices a worker takes at a time. */
enum { CHUNK = 32 };

typedef struct task {
    const vertex_bake *bake;
    uint32_t samples;
} task;

bool vertex_bake_create(const radiance_tracer *tracer, double edge, vertex_bake *out) {
    memset(out, 0, sizeof *out);
    out->tracer = tracer;
    if (!tessellation_create(tracer->scene, edge, &out->tessellation)) return false;
    out->sums = calloc(3 * out->tessellation.vertex_count + 1, sizeof *out->sums);
    return out->sums != NULL;
}

void vertex_bake_destroy(vertex_bake *b) {
    tessellation_destroy(&b->tessellation);
    free(b->sums);
}

static void shade(const vertex_bake *b, size_t v, double rho[3], double emission[3]) {
    traced_point at;
    tessellation_point(b->tracer->scene, &b->tessellation.corners[b->tessellation.first[v]], &at);
    traced_scene_shade(b->tracer->scene, at.triangle, at.weights, rho, emission);
}

static void add_vertex(const vertex_bake *b, size_t v, uint32_t samples) {
    const tessellation *t = &b->tessellation;
    double rho[3], emission[3];
    uint32_t corner = t->first[v];
    shade(b, v, rho, emission);
    if (vec3_is_zero(rho)) return;
    for (uint32_t i = b->samples; i < b->samples + samples; i++) {
        traced_point at;
        double X[3];
        if (corner == UINT32_MAX) corner = t->first[v];
        tessellation_point(b->tracer->scene, &t->corners[corner], &at);
        corner = t->corners[corner].next;
        radiance_sample(b->tracer, &at, v, i, X);
        for (size_t c = 0; c < 3; c++) b->sums[3 * v + c] += X[c];
    }
}

static void add_chunk(void *user, size_t item, unsigned worker) {
    const task *t = user;
    (void)worker;
    for (size_t v = item * CHUNK; v < (item + 1) * CHUNK && v < t->bake->tessellation.vertex_count; v++)
        add_vertex(t->bake, v, t->samples);
}

bool vertex_bake_add(vertex_bake *b, uint32_t samples, unsigned threads) {
    task t = { b, samples };
    jobs *j = jobs_create(threads);
    bool ok = j && jobs_run(j, (b->tessellation.vertex_count + CHUNK - 1) / CHUNK, add_chunk, NULL, &t);
    jobs_destroy(j);
    b->samples += samples;
    return ok;
}

void vertex_bake_get(const vertex_bake *b, float *radiance) {
    for (size_t v = 0; v < b->tessellation.vertex_count; v++) {
        double rho[3], emission[3];
        shade(b, v, rho, emission);
        for (size_t c = 0; c < 3; c++)
            radiance[3 * v + c] = (float)(emission[c] + rho[c] * b->sums[3 * v + c] / b->samples);
    }
}
