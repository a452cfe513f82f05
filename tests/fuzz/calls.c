/* SPDX-License-Identifier: MIT
 * What do the doors make of these bytes that take no file: calls of the ABI, whole small bakes, compressed views of a
 * buffer, configurations of colour, the closed form? Bytes are read as numbers in order, and are zero at their end.
 */
#define _GNU_SOURCE 1 /* memfd_create */
#include "targets.h"

#include "color_transform.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <float.h>
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

void fuzz_scene(const uint8_t *bytes, size_t size) {
    reader r = { bytes, size, 0 };
    mesh_data *data = calloc(MESHES_MOST, sizeof *data);
    if (!data) abort();
    hemi_scene_destroy(make_scene(&r, fuzz_context(), data, true));
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
    if (!data) abort();
    hemi_scene *scene = make_scene(&r, fuzz_context(), data, false);
    const hemi_bake_desc desc = { .struct_size = sizeof desc,
                                  .method = METHODS[how & 3],
                                  .quality = HEMI_QUALITY_DRAFT,
                                  .element_size = 2.0,
                                  .patch_size = 4.0,
                                  .hemicube = 16,
                                  .hemicube_light = 16,
                                  .max_elements = 3000,
                                  .memory_limit = FUZZ_MEMORY,
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
__extension__ typedef __int128 wide;

/* A corner seen from the point; error: of it, in roundings. */
typedef struct seen_corner {
    real v[3], length, error;
} seen_corner;

static real dot_of(const real a[3], const real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Where the edge a, b crosses the horizon. What cancels in its heights moves it. */
static seen_corner cut_of(const seen_corner *a, const seen_corner *b, const real normal[3]) {
    seen_corner cut;
    real ha = dot_of(normal, a->v), hb = dot_of(normal, b->v), terms = 0;
    for (int k = 0; k < 3; k++) {
        cut.v[k] = a->v[k] + (b->v[k] - a->v[k]) * (ha / (ha - hb));
        terms += fabsl(normal[k] * a->v[k]) + fabsl(normal[k] * b->v[k]);
    }
    cut.length = sqrtl(dot_of(cut.v, cut.v));
    cut.error = (a->length + b->length) * (1 + terms / fabsl(ha - hb));
    return cut;
}

/* The term of one edge, and to error by how many roundings it is off. */
static real edge_term(const seen_corner *a, const seen_corner *b, const real normal[3], real *error) {
    const real *u = a->v, *v = b->v;
    real cross[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
    real length = sqrtl(dot_of(cross, cross)), angle = atan2l(length, dot_of(u, v));
    real sizes = a->length * b->length, relative = a->error / a->length + b->error / b->length;
    *error += angle + relative + (length > 0 ? angle * sizes * (1 + relative) / length : angle > 0 ? INFINITY : 0);
    return length > 0 ? dot_of(normal, cross) / length * angle : 0;
}

/* Lambert's sum as in a textbook, of the part of a triangle above the horizon; error: by how many roundings it is off,
 * without bound where an edge passes through the point. */
static real textbook(const real corner[3][3], const real normal[3], real *error) {
    seen_corner clipped[4], ray[3];
    real sum = 0;
    int count = 0;
    *error = 0;
    for (int i = 0; i < 3; i++) {
        memcpy(ray[i].v, corner[i], sizeof ray[i].v);
        ray[i].length = ray[i].error = sqrtl(dot_of(corner[i], corner[i]));
    }
    for (int i = 0; i < 3; i++) {
        const seen_corner *a = &ray[i], *b = &ray[(i + 1) % 3];
        bool above = dot_of(normal, a->v) >= 0;
        if (above) clipped[count++] = *a;
        if (above != (dot_of(normal, b->v) >= 0)) clipped[count++] = cut_of(a, b, normal);
    }
    for (int i = 0; count >= 3 && i < count; i++)
        sum += edge_term(&clipped[i], &clipped[(i + 1) % count], normal, error);
    *error *= LDBL_EPSILON / (2 * acosl(-1.0L));
    return -sum / (2 * acosl(-1.0L));
}

/* ---- its coordinates, which are whole numbers of UNIT ---- */

enum { STEPS = 40, UNIT_BITS = 6 + STEPS };

/* Places on a coarse grid, so that what is degenerate comes up, with a fine part, so that what nearly is does too. */
static double next_coordinate(reader *r) {
    double place = next_place(r), fine = (int8_t)next(r);
    return place + ldexp(fine, -7 - next(r) % STEPS);
}

/* Is the point in the plane of the triangle? Exactly, in whole numbers: 51 bits, 104 of a cross product, and their
 * products in two halves. */
static bool is_in_plane(const polygon *p, const double point[3]) {
    wide v[3][3], high = 0, low = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            v[i][k] = (wide)ldexp(p->corner[i][k], UNIT_BITS) - (wide)ldexp(point[k], UNIT_BITS);
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        wide cross = v[1][m] * v[2][n] - v[1][n] * v[2][m], rest = cross & (((wide)1 << 52) - 1);
        high += (cross - rest) / ((wide)1 << 52) * v[0][k];
        low += rest * v[0][k];
    }
    return low % ((wide)1 << 52) == 0 && high == -(low / ((wide)1 << 52));
}

void fuzz_factor(const uint8_t *bytes, size_t size) {
    reader r = { bytes, size, 0 };
    polygon p = { .count = 3 };
    double point[3], normal[3];
    real corner[3][3], up[3], said = 0, error = 0;
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
    if (!is_in_plane(&p, point)) said = textbook((const real(*)[3])corner, up, &error);
    /* Where the oracle's own 19 digits cancel it cannot say; 64: what counts as one rounding here may be many. */
    if (!(64 * error <= 1e-11L * fabsl(said))) return;
    /* The promise of polygon.h, and what the oracle is off by. */
    if (fabsl((real)found - said) > 1.1e-10L * fabsl(said)) {
        fprintf(stderr, "factor %.17g, the oracle says %.17Lg\n", found, said);
        abort();
    }
}
