/* SPDX-License-Identifier: MIT
 * How does JavaScript see what was baked? Typed arrays over the solution's own memory, which lives as long as any of
 * them.
 */
#include "bake_job.h"
#include "js_value.h"

#include <stdlib.h>
#include <string.h>

void result_release(job_result *r) {
    if (!r || atomic_fetch_sub(&r->users, 1) > 1) return;
    for (uint32_t i = 0; i < r->mesh_count; i++) {
        if (r->radiance) free(r->radiance[i]);
        if (r->colors) free(r->colors[i]);
    }
    free(r->radiance);
    free(r->colors);
    free(r->views);
    if (r->destroy) r->destroy(r->solution);
    free(r);
}

static void let_go(napi_env env, void *data, void *hint) {
    (void)env, (void)data;
    result_release(hint);
}

/* Hosts that forbid foreign memory (Electron) get a copy. */
static napi_value buffer_over(napi_env env, job_result *r, const void *data, size_t bytes) {
    napi_value buffer = NULL;
    void *copy;
    if (bytes == 0) return napi_create_arraybuffer(env, 0, &copy, &buffer) == napi_ok ? buffer : NULL;
    atomic_fetch_add(&r->users, 1);
    if (napi_create_external_arraybuffer(env, (void *)data, bytes, let_go, r, &buffer) == napi_ok) return buffer;
    result_release(r);
    if (napi_create_arraybuffer(env, bytes, &copy, &buffer) != napi_ok) return NULL;
    memcpy(copy, data, bytes);
    return buffer;
}

static void set_array(napi_env env, napi_value object, const char *name, job_result *r, napi_typedarray_type type,
                      size_t size, const void *data, size_t count) {
    napi_value array, buffer = data ? buffer_over(env, r, data, size * count) : NULL;
    if (buffer && napi_create_typedarray(env, type, count, buffer, 0, &array) == napi_ok)
        napi_set_named_property(env, object, name, array);
}

static napi_value make_mesh(napi_env env, job_result *r, uint32_t i) {
    const hemi_mesh_view v = r->views[i];
    napi_value mesh;
    if (napi_create_object(env, &mesh) != napi_ok) return NULL;
    const size_t n = v.vertex_count, f = sizeof(float), u = sizeof(uint32_t);
    set_array(env, mesh, "positions", r, napi_float32_array, f, v.positions, 3 * n);
    set_array(env, mesh, "normals", r, napi_float32_array, f, v.normals, 3 * n);
    set_array(env, mesh, "radiance", r, napi_float32_array, f, r->radiance[i], 3 * n);
    set_array(env, mesh, "colors", r, napi_uint16_array, sizeof(uint16_t), r->colors[i], 4 * n);
    set_array(env, mesh, "indices", r, napi_uint32_array, u, v.indices, 3 * (size_t)v.triangle_count);
    set_array(env, mesh, "sourceTriangles", r, napi_uint32_array, u, v.source_triangles, n);
    set_array(env, mesh, "errors", r, napi_float32_array, f, v.errors, n);
    set_array(env, mesh, "sourceWeights", r, napi_float32_array, f, v.source_weights, 3 * n);
    return mesh;
}

static napi_value make_statistics(napi_env env, const job_result *r) {
    const hemi_statistics s = r->statistics;
    napi_value out, converged;
    napi_create_object(env, &out);
    js_set_number(env, out, "surfaces", s.scene.surfaces);
    js_set_number(env, out, "patches", s.scene.patches);
    js_set_number(env, out, "elements", s.scene.elements);
    js_set_number(env, out, "shots", s.solver.shots);
    js_set_number(env, out, "hemicubes", s.solver.hemicubes);
    js_set_number(env, out, "clampedMaterials", s.scene.clamped_materials);
    js_set_number(env, out, "degenerateTriangles", s.scene.degenerate_triangles);
    js_set_number(env, out, "unshotFraction", s.solver.unshot_fraction);
    js_set_number(env, out, "energyResidual", s.energy.residual);
    js_set_number(env, out, "errorEstimate", s.error.estimate);
    js_set_number(env, out, "seconds", s.time.total_s);
    napi_get_boolean(env, s.solver.converged, &converged);
    napi_set_named_property(env, out, "converged", converged);
    return out;
}

napi_value result_make(napi_env env, const bake_job *job) {
    napi_value out, meshes;
    napi_create_object(env, &out);
    napi_create_array_with_length(env, job->mesh_count, &meshes);
    for (uint32_t i = 0; i < job->mesh_count; i++) {
        napi_value mesh = make_mesh(env, job->result, i);
        if (mesh) napi_set_element(env, meshes, i, mesh);
    }
    napi_set_named_property(env, out, "meshes", meshes);
    napi_set_named_property(env, out, "statistics", make_statistics(env, job->result));
    js_set_number(env, out, "exposure", job->exposure_ev);
    js_set_number(env, out, "clippedFraction", job->clipped_fraction);
    return out;
}
