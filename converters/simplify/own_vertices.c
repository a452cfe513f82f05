/* SPDX-License-Identifier: MIT */
#include "own_vertices.h"

#include "closest_point.h"

#include "geometry/places.h"
#include "geometry/triangle.h"

#include <math.h>
#include <string.h>

/* Colours that the samples leave open go to the mean of what is around: this much of the matrix's diagonal, far below
 * what a sample weighs and far above what rounding makes of it. */
static const double PULL = 1e-3;

/* Iterations of conjugate gradients, and the share of the residual where they end: the matrix is that of masses, whose
 * condition is below ten with its diagonal taken out. */
enum { ITERATIONS = 60 };
static const double SETTLED = 1e-10;

enum { BANDS = 6 }; /* of both kinds of values */

/* The samples of one side are vertices of the solved mesh, each with the area around it. */
typedef struct fit {
    allocator *memory;
    const hemi_mesh_desc *source;
    const own_vertices_input *solved;
    uint32_t *group; /* of a vertex of the source: vertices of one group have one colour */
    uint32_t group_count;
    float *area;                       /* of a vertex of the solved mesh; 0: it is of the other side */
    double *mass;                      /* mass[g]: area around a group */
    double *value, *mean, *low, *high; /* [BANDS*g+b] */
} fit;

/* ---- samples ---- */

/* Vertices in one place with one normal have one colour; without normals, those in one place have. */
static bool find_groups(fit *f) {
    const hemi_mesh_desc *m = f->source;
    size_t count = m->vertex_count;
    uint32_t *slots = block_new(f->memory, places_slot_count(count) * sizeof *slots + 1),
             *direction = block_zeroed(f->memory, count + 1, sizeof *direction);
    float *pairs = block_new(f->memory, 3 * count * sizeof *pairs + 1);
    bool ok = slots && direction && pairs;
    if (ok) f->group_count = places_find_floats(m->positions, count, slots, f->group);
    if (ok && m->normals) {
        places_find_floats(m->normals, count, slots, direction);
        for (size_t v = 0; v < count; v++) { /* numbers below 2^24 are floats; more vertices are each on their own */
            pairs[3 * v] = (float)f->group[v], pairs[3 * v + 1] = (float)direction[v];
            pairs[3 * v + 2] = count < (1 << 24) ? 0.0f : (float)v;
        }
        f->group_count = places_find_floats(pairs, count, slots, f->group);
    }
    block_free_all(slots, direction, pairs);
    return ok;
}

/* Of which side of the source a triangle that was solved is. */
static bool is_back(const fit *f, const uint32_t *corner) {
    double p[3][3], n[3], m[3];
    triangle_from_floats(p, f->solved->positions, corner);
    triangle_cross(n, p[0], p[1], p[2]);
    triangle_from_floats(p, f->source->positions,
                         f->source->indices + 3 * (size_t)f->solved->source_triangles[corner[0]]);
    triangle_cross(m, p[0], p[1], p[2]);
    return vec3_dot(n, m) < 0.0;
}

static void gather_areas(fit *f, bool back) {
    memset(f->area, 0, f->solved->vertex_count * sizeof *f->area);
    for (size_t t = 0; t < f->solved->triangle_count; t++) {
        const uint32_t *corner = f->solved->indices + 3 * t;
        double p[3][3];
        if (is_back(f, corner) != back) continue;
        triangle_from_floats(p, f->solved->positions, corner);
        double area = triangle_area(p[0], p[1], p[2]);
        for (int i = 0; i < 3; i++) f->area[corner[i]] += (float)(area / 3.0);
    }
}

static double sample_value(const fit *f, size_t v, size_t band) {
    const float *values = f->solved->values[band / 3];
    return values ? (double)values[3 * v + band % 3] : 0.0;
}

static uint32_t corner_group(const fit *f, size_t v, int i) {
    return f->group[f->source->indices[3 * (size_t)f->solved->source_triangles[v] + (size_t)i]];
}

/* Means, and between what colours may be. */
static void gather_samples(fit *f) {
    for (size_t v = 0; v < f->solved->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double w = (double)f->solved->source_weights[3 * v + (size_t)i], a = (double)f->area[v] * w;
            uint32_t g = corner_group(f, v, i);
            if (!(a > 0.0)) continue;
            for (size_t b = 0; b < BANDS; b++) {
                double x = sample_value(f, v, b), *low = &f->low[BANDS * g + b], *high = &f->high[BANDS * g + b];
                f->mean[BANDS * g + b] += a * x;
                *low = f->mass[g] > 0.0 ? fmin(*low, x) : x;
                *high = f->mass[g] > 0.0 ? fmax(*high, x) : x;
            }
            f->mass[g] += a;
        }
    for (uint32_t g = 0; g < f->group_count; g++)
        for (size_t b = 0; b < BANDS; b++)
            f->value[BANDS * g + b] = f->mean[BANDS * g + b] /= f->mass[g] > 0.0 ? f->mass[g] : 1.0;
}

/* ---- least squares ---- */

/* out = (samples' normal matrix + pull) x, or with x NULL the right side. */
static void multiply(const fit *f, size_t band, const double *x, double *out) {
    for (uint32_t g = 0; g < f->group_count; g++) out[g] = PULL * f->mass[g] * (x ? x[g] : f->mean[BANDS * g + band]);
    for (size_t v = 0; v < f->solved->vertex_count; v++) {
        const float *w = f->solved->source_weights + 3 * v;
        double at = 0.0;
        if (!(f->area[v] > 0.0f)) continue;
        for (int i = 0; x && i < 3; i++) at += (double)w[i] * x[corner_group(f, v, i)];
        if (!x) at = sample_value(f, v, band);
        for (int i = 0; i < 3; i++) out[corner_group(f, v, i)] += (double)f->area[v] * (double)w[i] * at;
    }
}

static double product(const double *a, const double *b, uint32_t count) {
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

/* Conjugate gradients from the means on, the mass taken out. scratch: five times as many numbers as groups. */
static void solve_band(fit *f, size_t band, double *scratch) {
    uint32_t n = f->group_count;
    double *x = scratch, *r = x + n, *z = r + n, *p = z + n, *q = p + n;
    for (uint32_t g = 0; g < n; g++) x[g] = f->mean[BANDS * g + band];
    multiply(f, band, NULL, r);
    multiply(f, band, x, q);
    for (uint32_t g = 0; g < n; g++) {
        r[g] -= q[g];
        p[g] = z[g] = f->mass[g] > 0.0 ? r[g] / f->mass[g] : 0.0;
    }
    double rz = product(r, z, n), first = rz;
    for (int i = 0; i < ITERATIONS && rz > SETTLED * first; i++) {
        multiply(f, band, p, q);
        double curvature = product(p, q, n), step = curvature > 0.0 ? rz / curvature : 0.0, before = rz;
        for (uint32_t g = 0; g < n; g++) {
            x[g] += step * p[g], r[g] -= step * q[g];
            z[g] = f->mass[g] > 0.0 ? r[g] / f->mass[g] : 0.0;
        }
        rz = product(r, z, n);
        for (uint32_t g = 0; g < n; g++) p[g] = z[g] + rz / before * p[g];
    }
    for (uint32_t g = 0; g < n; g++)
        f->value[BANDS * g + band] = fmin(fmax(x[g], f->low[BANDS * g + band]), f->high[BANDS * g + band]);
}

/* ---- the whole ---- */

/* What lies in no sample: that of the nearest point. */
static void set_nearest(const fit *f, const closest_point *surface, const float *position, const float *normal,
                        bool back, double value[BANDS]) {
    float facing[3];
    for (size_t k = 0; k < 3; k++) facing[k] = back ? -normal[k] : normal[k];
    closest_point_hit hit = closest_point_find(surface, position, facing, 0.0, 0);
    for (size_t b = 0; b < BANDS; b++) value[b] = 0.0;
    for (size_t i = 0; hit.triangle != UINT32_MAX && i < 3; i++)
        for (size_t b = 0; b < BANDS; b++)
            value[b] += hit.weights[i] * sample_value(f, f->solved->indices[3 * (size_t)hit.triangle + i], b);
}

static void write_position(const fit *f, const closest_point *surface, const float *normals, bool back,
                           float *const out[2]) {
    for (size_t v = 0; v < f->source->vertex_count; v++) {
        double nearest[BANDS];
        const double *value = f->value + BANDS * (size_t)f->group[v];
        if (!(f->mass[f->group[v]] > 0.0)) {
            set_nearest(f, surface, f->source->positions + 3 * v, normals + 3 * v, back, nearest);
            value = nearest;
        }
        for (size_t b = 0; b < BANDS; b++)
            if (out[b / 3]) out[b / 3][3 * v + b % 3] = (float)value[b];
    }
}

static bool fit_side(fit *f, const closest_point *surface, const float *normals, bool back, float *const out[2]) {
    size_t n = f->group_count, bands = BANDS * n;
    double *numbers = block_zeroed(f->memory, 4 * bands + 6 * n + 1, sizeof *numbers);
    if (!numbers) return false;
    f->value = numbers, f->mean = f->value + bands, f->low = f->mean + bands, f->high = f->low + bands;
    f->mass = f->high + bands;
    gather_areas(f, back);
    gather_samples(f);
    for (size_t b = 0; b < BANDS; b++)
        if (f->solved->values[b / 3]) solve_band(f, b, f->mass + n);
    write_position(f, surface, normals, back, out);
    block_free(numbers);
    return true;
}

bool own_vertices_fit(allocator *memory, const hemi_mesh_desc *source, const own_vertices_input *solved,
                      const float *normals, uint32_t sides, float *const out[2]) {
    size_t n = source->vertex_count;
    fit f = { .memory = memory, .source = source, .solved = solved };
    f.group = block_zeroed(memory, n + 1, sizeof *f.group);
    f.area = block_new(memory, solved->vertex_count * sizeof *f.area + 1);
    closest_point *surface =
        closest_point_create(memory, NULL, solved->positions, solved->indices, solved->triangle_count);
    bool ok = f.group && f.area && surface && find_groups(&f);
    for (uint32_t side = 0; ok && side < sides; side++) {
        float *const to[2] = { out[0] ? out[0] + 3 * n * side : NULL, out[1] ? out[1] + 3 * n * side : NULL };
        ok = fit_side(&f, surface, normals, side == 1, to);
    }
    closest_point_destroy(surface);
    block_free_all(f.group, f.area);
    return ok;
}

bool own_vertices_mean(allocator *memory, const hemi_mesh_desc *source, const own_vertices_input *solved,
                       const float *from, uint32_t sides, float *out) {
    size_t n = source->vertex_count;
    double *sum = block_zeroed(memory, 2 * n + 1, sizeof *sum), *weight = sum ? sum + n : NULL;
    for (size_t v = 0; sum && v < solved->vertex_count; v++)
        for (size_t i = 0; i < 3; i++) {
            uint32_t at = source->indices[3 * (size_t)solved->source_triangles[v] + i];
            double w = (double)solved->source_weights[3 * v + i];
            sum[at] += w * (double)from[v], weight[at] += w;
        }
    for (size_t v = 0; sum && v < n * sides; v++)
        out[v] = weight[v % n] > 0.0 ? (float)(sum[v % n] / weight[v % n]) : 0.0f;
    block_free(sum);
    return sum;
}

/* ---- the mesh as it came ---- */

static void set_normals(const hemi_mesh_desc *m, const own_vertices_mesh *out) {
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3];
        triangle_from_floats(p, m->positions, m->indices + 3 * t);
        triangle_cross(n, p[0], p[1], p[2]);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                out->normals[3 * (size_t)m->indices[3 * t + (size_t)i] + (size_t)k] += (float)n[k];
    }
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *to = out->normals + 3 * v;
        const float *given = m->normals ? m->normals + 3 * v : to;
        double length = sqrt(vec3_dot_floats(given, given));
        if (!(length > 0.0)) given = to, length = sqrt(vec3_dot_floats(to, to));
        for (int k = 0; k < 3; k++) to[k] = length > 0.0 ? (float)(given[k] / length) : k == 1;
    }
}

static void set_sources(const hemi_mesh_desc *m, const own_vertices_mesh *out) {
    for (size_t c = 3 * (size_t)m->triangle_count; c-- > 0;) {
        size_t v = m->indices[c];
        out->source_triangles[v] = (uint32_t)(c / 3);
        memset(out->source_weights + 3 * v, 0, 3 * sizeof *out->source_weights);
        out->source_weights[3 * v + c % 3] = 1.0f;
    }
}

static void add_backs(const hemi_mesh_desc *m, const own_vertices_mesh *out) {
    size_t n = m->vertex_count, corners = 3 * (size_t)m->triangle_count;
    memcpy(out->positions + 3 * n, out->positions, 3 * n * sizeof *out->positions);
    memcpy(out->source_triangles + n, out->source_triangles, n * sizeof *out->source_triangles);
    memcpy(out->source_weights + 3 * n, out->source_weights, 3 * n * sizeof *out->source_weights);
    for (size_t i = 0; i < 3 * n; i++) out->normals[3 * n + i] = -out->normals[i];
    for (size_t c = 0; c < corners; c++) out->indices[corners + c] = m->indices[c - c % 3 + 2 - c % 3] + (uint32_t)n;
}

void own_vertices_lay_out(const hemi_mesh_desc *m, uint32_t sides, const own_vertices_mesh *out) {
    memset(out->source_triangles, 0, sides * (size_t)m->vertex_count * sizeof *out->source_triangles);
    memcpy(out->positions, m->positions, 3 * (size_t)m->vertex_count * sizeof *out->positions);
    memcpy(out->indices, m->indices, 3 * (size_t)m->triangle_count * sizeof *out->indices);
    set_normals(m, out);
    set_sources(m, out);
    if (sides == 2) add_backs(m, out);
}
