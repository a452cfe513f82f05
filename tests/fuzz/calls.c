/* SPDX-License-Identifier: MIT
 * What do the doors make of these bytes that take no file: calls of the ABI, whole small bakes, compressed views of a
 * buffer, configurations of colour, the closed form? Bytes are read as numbers in order, and are zero at their end.
 */
#define _GNU_SOURCE 1 /* memfd_create */
#include "targets.h"

#include "color_transform.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <hemibake/hemibake.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct reader {
    const uint8_t *bytes;
    size_t size, at;
} reader;

static uint8_t next(reader *r) {
    return r->at < r->size ? r->bytes[r->at++] : 0;
}

static uint32_t next_word(reader *r) {
    uint32_t out = 0;
    for (int k = 0; k < 4; k++) out |= (uint32_t)next(r) << 8 * k;
    return out;
}

/* Any float at all: infinite, NaN, denormal. */
static float next_float(reader *r) {
    uint32_t word = next_word(r);
    float out;
    memcpy(&out, &word, sizeof out);
    return out;
}

/* Of -8 .. 8 in steps of 1/16: corners meet, and lie in planes. */
static float next_place(reader *r) {
    return (float)((int8_t)next(r)) / 16.0f;
}

/* 0 .. 1 */
static double next_share(reader *r) {
    return next(r) / 255.0;
}

/* ---- a scene ---- */

enum { MESHES_MOST = 4, VERTICES_MOST = 24, TRIANGLES_MOST = 24, ATTRIBUTES = 3, TEXELS = 4 };

typedef struct mesh_data {
    float positions[3 * VERTICES_MOST], normals[3 * VERTICES_MOST], attributes[ATTRIBUTES * VERTICES_MOST];
    uint32_t indices[3 * TRIANGLES_MOST];
    hemi_alpha_mask mask;
    hemi_subdivision_desc cage;
    uint8_t alpha[TEXELS * TEXELS];
} mesh_data;

/* wild: numbers may be anything; else what makes a scene that can be baked more often than not. */
static void add_material(reader *r, hemi_scene *scene, bool wild) {
    hemi_material_desc m = { .struct_size = sizeof m, .name = "fuzz" };
    uint8_t kind = next(r);
    m.double_sided = kind & 1;
    for (int c = 0; c < 3; c++) {
        m.reflectance[c] = wild ? (double)next_float(r) : next_share(r);
        m.emission[c] = wild ? (double)next_float(r) : kind & 2 ? 10 * next_share(r) : 0;
        m.transmission[c] = kind & 4 ? (wild ? (double)next_float(r) : next_share(r)) : 0;
        m.diffuse_transmission[c] = kind & 8 ? next_share(r) : 0;
    }
    hemi_scene_add_material(scene, &m, NULL);
}

static void set_cage(reader *r, mesh_data *d, hemi_mesh_desc *m) {
    d->cage = (hemi_subdivision_desc){ .struct_size = sizeof d->cage,
                                       .scheme = (hemi_subdivision_scheme)(next(r) % 4),
                                       .level = next(r) % 3,
                                       .tessellation = (hemi_tessellation_rule)(next(r) % 2),
                                       .boundary = (hemi_boundary)(next(r) % 4) };
    m->subdivision = &d->cage;
}

static void set_mask(reader *r, mesh_data *d, hemi_mesh_desc *m) {
    for (size_t i = 0; i < sizeof d->alpha; i++) d->alpha[i] = next(r);
    d->mask = (hemi_alpha_mask){ .struct_size = sizeof d->mask,
                                 .alpha = d->alpha,
                                 .width = TEXELS,
                                 .height = TEXELS,
                                 .wrap_u = (hemi_wrap)(next(r) % 3),
                                 .wrap_v = (hemi_wrap)(next(r) % 3),
                                 .cutoff = next_share(r) };
    m->alpha_mask = &d->mask;
}

static void add_mesh(reader *r, hemi_scene *scene, mesh_data *d, bool wild) {
    uint8_t kind = next(r);
    hemi_mesh_desc m = { .struct_size = sizeof m,
                         .name = "fuzz",
                         .positions = d->positions,
                         .vertex_count = 3 + next(r) % (VERTICES_MOST - 2),
                         .indices = d->indices,
                         .triangle_count = 1 + next(r) % TRIANGLES_MOST,
                         .material = next(r) % 4,
                         .keep_vertices = kind & 1,
                         .detail_group = kind >> 6,
                         .detail_level = kind >> 7 };
    for (uint32_t i = 0; i < 3 * m.vertex_count; i++) d->positions[i] = wild ? next_float(r) : next_place(r);
    for (uint32_t i = 0; i < 3 * m.triangle_count; i++)
        d->indices[i] = wild ? next(r) % (m.vertex_count + 1) : next(r) % m.vertex_count;
    for (uint32_t i = 0; kind & 2 && i < 3 * m.vertex_count; i++) d->normals[i] = wild ? next_float(r) : next_place(r);
    if (kind & 2) m.normals = d->normals;
    for (uint32_t i = 0; kind & 4 && i < ATTRIBUTES * m.vertex_count; i++) d->attributes[i] = next_place(r);
    if (kind & 4) m.attributes = d->attributes, m.attribute_count = ATTRIBUTES;
    if (kind & 4 && kind & 8) set_mask(r, d, &m);
    if (kind & 16) set_cage(r, d, &m);
    for (int k = 0; kind & 32 && k < 16; k++)
        m.transform[k] = wild ? (double)next_float(r) : k % 5 ? (double)next_place(r) : 1.0;
    if (kind & 32 && !wild) m.transform[3] = m.transform[7] = m.transform[11] = 0.0;
    hemi_scene_add_mesh(scene, &m, NULL);
}

static void add_light(reader *r, hemi_scene *scene, bool wild) {
    hemi_light_desc l = { .struct_size = sizeof l, .kind = (hemi_light_kind)(next(r) % (wild ? 5 : 3)) };
    for (int k = 0; k < 3; k++) {
        l.intensity[k] = wild ? (double)next_float(r) : 10 * next_share(r);
        l.position[k] = wild ? (double)next_float(r) : (double)next_place(r);
        l.direction[k] = wild ? (double)next_float(r) : (double)next_place(r);
    }
    l.inner_cone = wild ? (double)next_float(r) : 0.0;
    l.outer_cone = wild ? (double)next_float(r) : next_share(r);
    l.angular_diameter = l.kind == HEMI_LIGHT_DIRECTIONAL ? next_share(r) : 0.0;
    hemi_scene_add_light(scene, &l, NULL);
}

/* Adds what the bytes ask for; data: what meshes point to. */
static hemi_scene *make_scene(reader *r, hemi_context *context, mesh_data *data, bool wild) {
    hemi_scene *scene = NULL;
    if (hemi_scene_create(context, &scene) != HEMI_OK) return NULL;
    uint8_t what = next(r);
    for (int i = 0; i < 4; i++) add_material(r, scene, wild);
    for (int i = 0; i < 1 + what % MESHES_MOST; i++) add_mesh(r, scene, &data[i], wild);
    if (what & 16) add_light(r, scene, wild);
    if (what & 32) {
        hemi_sky_desc sky = { .struct_size = sizeof sky };
        for (int c = 0; c < 3; c++) sky.radiance[c] = wild ? (double)next_float(r) : next_share(r);
        hemi_scene_set_sky(scene, &sky);
    }
    return scene;
}

static hemi_context *make_context(void) {
    hemi_context *context = NULL;
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 1 };
    return hemi_context_create(&desc, &context) == HEMI_OK ? context : NULL;
}

void fuzz_scene(const uint8_t *bytes, size_t size) {
    reader r = { bytes, size, 0 };
    mesh_data *data = calloc(MESHES_MOST, sizeof *data);
    hemi_context *context = make_context();
    if (!data || !context) abort();
    hemi_scene_destroy(make_scene(&r, context, data, true));
    hemi_context_destroy(context);
    free(data);
}

/* ---- whole bakes ---- */

/* What comes out has finite colours that are not negative, and indices that are there. */
static void check_solution(const hemi_solution *solution) {
    for (uint32_t i = 0; i < MESHES_MOST; i++) {
        hemi_mesh_view view = { .struct_size = sizeof view };
        if (hemi_solution_mesh(solution, i, &view) != HEMI_OK) break;
        for (size_t k = 0; k < 3 * (size_t)view.vertex_count; k++)
            if (!(view.radiance[k] >= 0.0f && isfinite(view.radiance[k]))) abort();
        for (size_t k = 0; k < 3 * (size_t)view.triangle_count; k++)
            if (view.indices[k] >= view.vertex_count) abort();
    }
}

void fuzz_bake(const uint8_t *bytes, size_t size) {
    static const hemi_method METHODS[] = { HEMI_METHOD_HYBRID, HEMI_METHOD_ROWS, HEMI_METHOD_AUTO, HEMI_METHOD_PR };
    reader r = { bytes, size, 0 };
    uint8_t how = next(&r);
    mesh_data *data = calloc(MESHES_MOST, sizeof *data);
    hemi_context *context = make_context();
    if (!data || !context) abort();
    hemi_scene *scene = make_scene(&r, context, data, false);
    const hemi_bake_desc desc = { .struct_size = sizeof desc,
                                  .method = METHODS[how & 3],
                                  .quality = HEMI_QUALITY_DRAFT,
                                  .element_size = 2.0,
                                  .patch_size = 4.0,
                                  .hemicube = 16,
                                  .hemicube_light = 16,
                                  .max_elements = 3000,
                                  .adapt_levels = how & 4 ? 1 : -1,
                                  .decimate_error = how & 8 ? 0.01 : -1.0,
                                  .flat = how & 16,
                                  .visibility = HEMI_VISIBILITY_RAYS };
    hemi_solution *solution = NULL;
    hemi_result result = scene ? hemi_bake(scene, &desc, &solution) : HEMI_ERROR_MEMORY;
    if ((result == HEMI_OK) != (solution != NULL)) abort();
    if (solution) check_solution(solution);
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
    free(data);
}

/* ---- compressed views ---- */

static void put(uint8_t **to, const void *from, size_t size) {
    memcpy(*to, from, size);
    *to += size;
}

static void put_chunk(uint8_t **to, const char *kind, const void *from, size_t size) {
    uint32_t length = (uint32_t)(size + 3) / 4 * 4;
    put(to, &length, 4);
    put(to, kind, 4);
    put(to, from, size);
    for (size_t i = size; i < length; i++) put(to, " ", 1);
}

/* A GLB with one mesh, whose positions and indices are packed: the first bytes say how, the others are the streams. */
void fuzz_meshopt(const uint8_t *bytes, size_t size) {
    static const char *const FILTERS[] = { "NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL" };
    static const char *const MODES[] = { "TRIANGLES", "INDICES" };
    reader r = { bytes, size, 0 };
    uint8_t how = next(&r);
    unsigned vertices = 3 + next(&r), triangles = 1 + next(&r), part = next(&r);
    size_t rest = size > r.at ? size - r.at : 0, first = rest * part / 256;
    char json[2048];
    int length = snprintf(
        json, sizeof json,
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"EXT_meshopt_compression\"],\"extensionsRequired\":["
        "\"EXT_meshopt_compression\"],\"buffers\":[{\"byteLength\":%zu},{\"byteLength\":%u,\"extensions\":{"
        "\"EXT_meshopt_compression\":{\"fallback\":true}}}],\"bufferViews\":[{\"buffer\":1,\"byteLength\":%u,"
        "\"byteStride\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteLength\":%zu,"
        "\"byteStride\":12,\"count\":%u,\"mode\":\"ATTRIBUTES\",\"filter\":\"%s\"}}},{\"buffer\":1,\"byteOffset\":%u,"
        "\"byteLength\":%u,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":%zu,"
        "\"byteLength\":%zu,\"byteStride\":%d,\"count\":%u,\"mode\":\"%s\"}}}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":%d,\"count\":%u,"
        "\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
        "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0}",
        rest, 12 * vertices + 12 * triangles, 12 * vertices, first, vertices, FILTERS[how & 3], 12 * vertices,
        (how & 8 ? 4 : 2) * 3 * triangles, first, rest - first, how & 8 ? 4 : 2, 3 * triangles, MODES[how >> 2 & 1],
        vertices, how & 8 ? 5125 : 5123, 3 * triangles);
    size_t all = 12 + 8 + ((size_t)length + 3) / 4 * 4 + 8 + (rest + 3) / 4 * 4;
    uint8_t *glb = malloc(all), *to = glb;
    if (!glb) abort();
    uint32_t head[3] = { 0x46546c67, 2, (uint32_t)all };
    put(&to, head, sizeof head);
    put_chunk(&to, "JSON", json, (size_t)length);
    put_chunk(&to, "BIN\0", bytes + (size - rest), rest);
    fuzz_target_named("gltf")->run(glb, all);
    free(glb);
}

/* ---- colour ---- */

void fuzz_config(const uint8_t *bytes, size_t size) {
    char path[64], message[COLOR_MESSAGE_SIZE] = "";
    int file = memfd_create("fuzz.ocio", 0);
    if (file < 0 || write(file, bytes, size) != (ssize_t)size) abort();
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    const color_transform_desc desc = { .config = path };
    color_transform *transform = NULL;
    hemi_result result = color_transform_create(&desc, &transform, message);
    if ((result == HEMI_OK) != (transform != NULL) || (result != HEMI_OK) != (message[0] != 0)) abort();
    if (transform) {
        float rgb[6] = { 0.0f, 0.5f, 3.0f, INFINITY, NAN, -1.0f };
        if (color_transform_apply(transform, rgb, 2, NULL) == HEMI_OK)
            for (int k = 0; k < 6; k++)
                if (!(rgb[k] >= 0.0f && rgb[k] <= 1.0f)) abort();
    }
    color_transform_destroy(transform);
    close(file);
}

/* ---- the closed form ---- */

typedef long double real;

/* Lambert's sum as in a textbook, of the part of a triangle above the horizon; size: of the terms that cancel. */
static real textbook(const real corner[3][3], const real normal[3], real *size) {
    real clipped[4][3], sum = 0;
    int count = 0;
    *size = 0;
    for (int i = 0; i < 3; i++) {
        const real *a = corner[i], *b = corner[(i + 1) % 3];
        real ha = 0, hb = 0;
        for (int k = 0; k < 3; k++) ha += normal[k] * a[k], hb += normal[k] * b[k];
        if (ha >= 0) memcpy(clipped[count++], a, sizeof clipped[0]);
        if ((ha >= 0) == (hb >= 0)) continue;
        for (int k = 0; k < 3; k++) clipped[count][k] = a[k] + (b[k] - a[k]) * (ha / (ha - hb));
        count++;
    }
    for (int i = 0; count >= 3 && i < count; i++) {
        const real *a = clipped[i], *b = clipped[(i + 1) % count];
        real cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
        real length = sqrtl(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        real angle = atan2l(length, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]), term = 0;
        for (int k = 0; k < 3 && length > 0; k++) term += normal[k] * cross[k] / length * angle;
        sum += term;
        *size += fabsl(a[0] * b[0]) + fabsl(a[1] * b[1]) + fabsl(a[2] * b[2]) > 0 && length > 0
                     ? angle * (1 + sqrtl((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) *
                                          (b[0] * b[0] + b[1] * b[1] + b[2] * b[2])) /
                                        length)
                     : 0;
    }
    *size /= 2 * acosl(-1.0L);
    return -sum / (2 * acosl(-1.0L));
}

/* By how much the sum changes when a digit of the normal does that a double no longer has: a sliver along the horizon
 * is not known any better, whoever sums. */
static real unknown(const real corner[3][3], const real normal[3], real said) {
    real most = 0, size;
    for (int k = 0; k < 6; k++) {
        real tilted[3] = { normal[0], normal[1], normal[2] };
        tilted[k / 2] += k & 1 ? 0x1p-53L : -0x1p-53L;
        real change = fabsl(textbook(corner, tilted, &size) - said);
        if (change > most) most = change;
    }
    return most;
}

/* Places on a coarse grid, so that what is degenerate comes up, with a fine part, so that what nearly is does too. */
static double next_coordinate(reader *r) {
    return next_place(r) + ldexp((double)(int8_t)next(r), -7 - next(r) % 40);
}

void fuzz_factor(const uint8_t *bytes, size_t size) {
    reader r = { bytes, size, 0 };
    polygon p = { .count = 3 };
    double point[3], normal[3];
    real corner[3][3], up[3], terms;
    for (int k = 0; k < 3; k++) point[k] = next_coordinate(&r);
    for (int k = 0; k < 3; k++) normal[k] = next_coordinate(&r);
    if (!(vec3_normalize(normal) > 0.0)) return;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            p.corner[i][k] = next_coordinate(&r);
            corner[i][k] = (real)p.corner[i][k] - (real)point[k];
        }
    for (int k = 0; k < 3; k++) up[k] = (real)normal[k];
    double found = polygon_factor(&p, point, normal);
    if (!isfinite(found) || fabs(found) > 1 + 1e-9) abort();
    real said = textbook((const real(*)[3])corner, up, &terms);
    /* Where the oracle's own 19 digits cancel it cannot say. */
    if (terms * 1e-17L > 1e-11L * fabsl(said) || !(fabsl(said) > 0)) return;
    if (fabsl((real)found - said) > 1e-9L * fabsl(said) + 8 * unknown((const real(*)[3])corner, up, said)) {
        fprintf(stderr, "factor %.17g, the oracle says %.17Lg\n", found, said);
        abort();
    }
}
