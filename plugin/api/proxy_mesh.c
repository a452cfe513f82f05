/* SPDX-License-Identifier: MIT */
#include "proxy_mesh.h"

#include "closest_point.h"
#include "long_edges.h"

#include <string.h>

/* A mesh is dense if it has so many triangles, and so many times what elements of the asked size would be: below that a
 * proxy saves little and still costs its deviation. */
enum { DENSE_TRIANGLES = 2000 };
static const double DENSE_RATIO = 8.0;

/* How far a proxy may be off, in extents of the mesh, where that is less than is asked for: an emitter smaller than an
 * element keeps its shape. */
static const double DEVIATION_EXTENT = 0.005;

/* Edges of a proxy, in elements: facets of a whole element show on a sphere as blotches where light grazes it. */
static const double PROXY_EDGE = 0.65;

/* How much more it may be off where the mesh is rough all over: an element, if a tenth is asked for. */
static const double ROUGHEST = 10.0;

/* A proxy must have fewer triangles than this of the dense mesh. */
static const double WORTH_IT = 0.5;

/* Corners are counted in 32 bits. */
static const uint64_t TRIANGLES_MAX = UINT64_C(1) << 30;

/* Where a proxy's hard edge is off by its deviation, the right side of it is still nearer than the wrong one. */
static const double TURNED_DEVIATIONS = 4.0;

/* Longer than so many elements an edge of a dense mesh gets further vertices: as long as elements may be. */
static const double EDGE_LIMIT = 1.5;

/* Small shooters that face much the same way go together, and the proxy of a ball has so many, however large it is. */
static const double BALL_SHOOTERS = 50.0;

enum { VERTICES_A_JOB = 4096 };

struct proxy_mesh {
    bool is_used;
    hemi_mesh_desc dense; /* whose proxy it is */
    simplify_mesh simplified;
    double turned; /* m, world: see closest_point.h */
    double edge;   /* m, world: the dense mesh's are cut that are longer */
};

/* ---- which ---- */

/* What textures cut out has no smooth shape: it stays as it is. */
static bool is_dense(const hemi_mesh_desc *m, double element_size) {
    if (m->triangle_count < DENSE_TRIANGLES || m->alpha_mask) return false;
    return m->triangle_count > DENSE_RATIO * simplify_triangle_count(mesh_desc_area(m), element_size);
}

/* ---- proxies ---- */

static void use_proxy(bake_scene *f, size_t index, double deviation, double edge, simplify_mesh *simplified) {
    struct proxy_mesh *s = &f->proxies[index];
    hemi_mesh_desc *m = &f->meshes[index];
    s->dense = *m;
    s->simplified = *simplified;
    s->is_used = true;
    s->turned = TURNED_DEVIATIONS * deviation;
    s->edge = edge;
    memset(simplified, 0, sizeof *simplified);
    m->positions = s->simplified.positions;
    m->normals = s->simplified.normals;
    m->attributes = s->simplified.attributes;
    m->indices = s->simplified.indices;
    m->vertex_count = s->simplified.vertex_count;
    m->triangle_count = s->simplified.triangle_count;
}

/* Meshes that share borders get proxies together or not at all. */
static hemi_result replace_group(const hemi_scene *in, const bake_options *options, const size_t *members,
                                 uint32_t count, bake_scene *f) {
    const hemi_mesh_desc **meshes = block_new(f->memory.memory, count * sizeof *meshes);
    simplify_mesh *simplified = block_zeroed(f->memory.memory, count, sizeof *simplified);
    bool *double_sided = block_new(f->memory.memory, count * sizeof *double_sided);
    simplify_check check;
    uint64_t before = 0, after = 0;
    bool emits = false;
    hemi_result result = meshes && simplified && double_sided ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (uint32_t i = 0; result == HEMI_OK && i < count; i++) {
        meshes[i] = &f->meshes[members[i]];
        double_sided[i] = in->materials[meshes[i]->material].double_sided;
        emits |= !vec3_is_zero(in->materials[meshes[i]->material].emission);
        before += meshes[i]->triangle_count;
    }
    if (result == HEMI_OK && before <= TRIANGLES_MAX) {
        double size = quality_stand_in_size(options);
        double deviation = fmin(options->proxy_error * size, DEVIATION_EXTENT * mesh_descs_extent(meshes, count));
        const simplify_desc how = { .meshes = meshes,
                                    .double_sided = double_sided,
                                    .mesh_count = count,
                                    .edge = PROXY_EDGE * size,
                                    .deviation = deviation,
                                    .roughest = ROUGHEST * deviation,
                                    .keeps_area = emits,
                                    .is_quick = options->hurries,
                                    .memory = f->memory.memory };
        result = simplify_meshes(&how, simplified, &check);
        for (uint32_t i = 0; result == HEMI_OK && i < count; i++) after += simplified[i].triangle_count;
        bool worth_it = result == HEMI_OK && after > 0 && (double)after < WORTH_IT * (double)before;
        for (uint32_t i = 0; worth_it && i < count; i++)
            use_proxy(f, members[i], deviation, EDGE_LIMIT * size, &simplified[i]);
        if (worth_it) {
            f->dense_check.degenerate_count += check.degenerate_count;
            f->dense_check.duplicate_count += check.duplicate_count;
            f->dense_check.nonmanifold_count += check.nonmanifold_count;
        }
    }
    for (uint32_t i = 0; simplified && i < count; i++) simplify_mesh_free(&simplified[i]);
    block_free_all(meshes, simplified, double_sided);
    return result;
}

static hemi_result replace_dense(const hemi_scene *in, const bake_options *options, const size_t *dense, uint32_t count,
                                 bake_scene *f) {
    const hemi_mesh_desc **meshes = block_new(f->memory.memory, (count + 1) * sizeof *meshes);
    uint32_t *group = block_new(f->memory.memory, (count + 1) * sizeof *group);
    size_t *members = block_new(f->memory.memory, (count + 1) * sizeof *members);
    hemi_result result = meshes && group && members ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (uint32_t i = 0; result == HEMI_OK && i < count; i++) meshes[i] = &f->meshes[dense[i]];
    if (result == HEMI_OK) result = simplify_find_groups(f->memory.memory, meshes, count, group);
    for (uint32_t first = 0; result == HEMI_OK && first < count; first++) {
        uint32_t size = 0;
        if (group[first] != first) continue;
        for (uint32_t i = first; i < count; i++)
            if (group[i] == first) members[size++] = dense[i];
        result = replace_group(in, options, members, size, f);
    }
    block_free_all(meshes, group, members);
    return result;
}

hemi_result proxy_meshes_make(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    size_t *dense = block_new(f->memory.memory, (f->mesh_count + 1) * sizeof *dense);
    uint32_t count = 0;
    f->proxies = block_zeroed(f->memory.memory, f->mesh_count + 1, sizeof *f->proxies);
    hemi_result result = dense && f->proxies ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (size_t i = 0; result == HEMI_OK && options->proxy_error > 0.0 && i < f->mesh_count; i++)
        if (is_dense(&f->meshes[i], quality_stand_in_size(options)) &&
            !(options->decimate_error > 0.0 && tessellate_is_flat_grid(&f->meshes[i], f->memory.memory)))
            dense[count++] = i;
    if (count > 0) result = replace_dense(in, options, dense, count, f);
    block_free(dense);
    return result;
}

size_t proxy_meshes_shooter_count(const bake_scene *f, double element_size, double patch_size) {
    double count = 0.0;
    for (const hemi_mesh_desc *m = f->meshes; m < f->meshes + f->mesh_count; m++)
        count += is_dense(m, element_size) ? fmax(simplify_triangle_count(mesh_desc_area(m), element_size),
                                                  BALL_SHOOTERS * mesh_desc_balls(m))
                                           : tessellate_shooters(f->memory.memory, m, patch_size);
    return (size_t)count;
}

bool proxy_mesh_is_used(const bake_scene *f, size_t mesh_index) {
    return f->proxies && f->proxies[mesh_index].is_used;
}

void proxy_meshes_free(bake_scene *f) {
    for (size_t i = 0; f->proxies && i < f->mesh_count; i++) simplify_mesh_free(&f->proxies[i].simplified);
    block_free(f->proxies);
    f->proxies = NULL;
}

/* ---- transfer ---- */

typedef struct transfer {
    allocator *memory;
    const struct proxy_mesh *s;
    const solved_mesh *solved;
    const closest_point *surface;
    double turned;
    solved_mesh *out;
    cut_mesh cut;     /* the dense mesh, with vertices where it has too few; its own come first */
    float *distances; /* distances[job]: the largest */
} transfer;

/* Returns the triangle that was nearest. */
static uint32_t set_vertex(const transfer *g, uint32_t v, uint32_t guess, float *distance) {
    solved_mesh *out = g->out;
    bool back = v >= g->cut.vertex_count;
    const cut_vertex *at = &g->cut.vertices[back ? v - g->cut.vertex_count : v];
    float facing[3], *place = out->positions + 3 * (size_t)v, *attributes = NULL;
    if (out->attribute_count) attributes = out->attributes + (size_t)out->attribute_count * v;
    cut_vertex_place(at, &g->s->dense, g->s->simplified.dense_indices, g->s->simplified.dense_normals, back,
                     &(cut_place){ place, out->normals + 3 * (size_t)v, attributes, facing });
    closest_point_hit hit = closest_point_find(g->surface, place, facing, g->turned, guess);
    const solved_mesh *from = g->solved;
    closest_point_interpolate(&hit, from->indices, from->radiance, 3, out->radiance + 3 * (size_t)v);
    if (out->demodulated)
        closest_point_interpolate(&hit, from->indices, from->demodulated, 3, out->demodulated + 3 * (size_t)v);
    if (out->errors) closest_point_interpolate(&hit, from->indices, from->errors, 1, out->errors + v);
    if (out->source_triangles) {
        out->source_triangles[v] = at->triangle;
        memcpy(out->source_weights + 3 * (size_t)v, at->weights, sizeof at->weights);
    }
    *distance = fmaxf(*distance, (float)hit.distance);
    return hit.triangle;
}

static void set_vertices(void *user, size_t item, unsigned worker) {
    const transfer *g = user;
    uint32_t first = (uint32_t)item * VERTICES_A_JOB, end = first + VERTICES_A_JOB, guess = 0;
    (void)worker;
    if (end > g->out->vertex_count) end = g->out->vertex_count;
    for (uint32_t v = first; v < end; v++) guess = set_vertex(g, v, guess, &g->distances[item]);
}

static hemi_result fill(transfer *g, jobs *workers, uint32_t sides, double *deviation) {
    size_t jobs_count = (g->out->vertex_count + VERTICES_A_JOB - 1) / VERTICES_A_JOB;
    closest_point *tree =
        closest_point_create(g->memory, workers, g->solved->positions, g->solved->indices, g->solved->triangle_count);
    g->distances = block_zeroed(g->memory, jobs_count + 1, sizeof *g->distances);
    g->surface = tree;
    bool ok = tree && g->distances;
    if (ok) {
        jobs_run(workers, jobs_count, set_vertices, NULL, g);
        cut_mesh_triangles(&g->cut, sides, g->out->indices);
    }
    for (size_t i = 0; ok && i < jobs_count; i++) *deviation = fmax(*deviation, (double)g->distances[i]);
    block_free(g->distances);
    closest_point_destroy(tree);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

hemi_result proxy_mesh_transfer(const hemi_scene *in, const bake_scene *f, size_t mesh_index, solved_mesh *solved,
                                hemi_statistics *statistics) {
    if (!proxy_mesh_is_used(f, mesh_index) || solved->triangle_count == 0) return HEMI_OK;
    const struct proxy_mesh *s = &f->proxies[mesh_index];
    uint32_t sides = in->materials[s->dense.material].double_sided ? 2 : 1;
    double deviation = 0.0, scale = mesh_desc_scale(&s->dense);
    solved_mesh out = { .attribute_count = solved->attribute_count, .has_errors = solved->has_errors };
    transfer g = { .memory = f->memory.memory, .s = s, .solved = solved, .turned = s->turned / scale, .out = &out };
    hemi_result result = HEMI_ERROR_MEMORY;
    if (long_edges_cut(g.memory, &s->dense, s->simplified.dense_indices, s->simplified.dense_source,
                       s->simplified.dense_vertex_count, s->edge, &g.cut)) {
        out.vertex_count = sides * g.cut.vertex_count;
        out.triangle_count = sides * g.cut.triangle_count;
        if (solved_mesh_allocate(g.memory, &out, solved->source_triangles, solved->demodulated))
            result = fill(&g, in->context->jobs, sides, &deviation);
    }
    cut_mesh_free(&g.cut);
    solved_mesh_free(result == HEMI_OK ? solved : &out);
    if (result != HEMI_OK) return result;
    *solved = out;
    statistics->scene.proxy_meshes++;
    statistics->scene.proxied_triangles += s->dense.triangle_count;
    statistics->scene.proxy_triangles += s->simplified.triangle_count;
    statistics->scene.proxy_error = fmax(statistics->scene.proxy_error, scale * deviation);
    return HEMI_OK;
}
