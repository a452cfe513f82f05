/* SPDX-License-Identifier: MIT */
#include "factors/factor_matrix.h"

#include "factors/polygon_pair.h"
#include "factors/shadow_integral.h"
#include "geometry/vec3.h"
#include "visibility/visible_part.h"

#include <float.h>
#include <string.h>

/* A quad whose fourth corner is off the plane of the others by less than this, relative to its size, is planar: text
 * formats carry six digits. */
static const double PLANAR_TOLERANCE = 1e-5;

/* What is nearer to a plane than this, relative to the scene, lies in it; see TOLERANCE_PLANE for floats. Input here is
 * double, but comes from text or floats. */
static const double PLANE_MARGIN = 1e-7;

/* ---- polygons ---- */

static bool add_part(matrix_polygon *out, const double corner[][3], const int *index, int count) {
    int at = out->part_count;
    polygon *p = &out->part[at];
    p->count = count;
    for (int i = 0; i < count; i++) vec3_copy(p->corner[i], corner[index[i]]);
    polygon_vector_area(p, out->normal[at]);
    out->area[at] = vec3_normalize(out->normal[at]);
    out->plane[at] = vec3_dot(out->normal[at], p->corner[0]);
    if (!(out->area[at] > DBL_MIN)) return false;
    out->part_count++;
    return true;
}

static void cut_along(matrix_polygon *out, const double corner[][3], int from) {
    const int first[3] = { from, (from + 1) % 4, (from + 2) % 4 }, second[3] = { from, (from + 2) % 4, (from + 3) % 4 };
    add_part(out, corner, first, 3);
    add_part(out, corner, second, 3);
}

/* How many of a quad's corners turn against its vector area, and the last of them. */
static int count_reflex(const double corner[][3], const double normal[3], int *reflex) {
    int count = 0;
    for (int i = 0; i < 4; i++) {
        double u[3], v[3], n[3];
        vec3_sub(u, corner[i], corner[(i + 3) % 4]);
        vec3_sub(v, corner[(i + 1) % 4], corner[i]);
        vec3_cross(n, u, v);
        if (vec3_dot(n, normal) < 0.0) count++, *reflex = i;
    }
    return count;
}

polygon_kind matrix_polygon_set(matrix_polygon *out, const double corner[][3], int corner_count) {
    static const int all[4] = { 0, 1, 2, 3 };
    double size = 0.0;
    int reflex = 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < corner_count; i++) {
        if (!isfinite(corner[i][0]) || !isfinite(corner[i][1]) || !isfinite(corner[i][2])) return POLYGON_NOT_FINITE;
        size = fmax(size, vec3_distance(corner[i], corner[(i + 1) % corner_count]));
    }
    if (!add_part(out, corner, all, corner_count) || out->area[0] < 1e-14 * size * size) {
        out->part_count = 0;
        return POLYGON_NO_AREA;
    }
    if (corner_count == 3) return POLYGON_PLANAR;
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < 4; i++) {
        double height = vec3_dot(out->normal[0], corner[i]);
        low = fmin(low, height), high = fmax(high, height);
    }
    bool bent = high - low > PLANAR_TOLERANCE * size;
    int reflex_count = count_reflex(corner, out->normal[0], &reflex);
    if (reflex_count == 0 && !bent) return POLYGON_PLANAR;
    out->part_count = 0;
    if (reflex_count > 1) return POLYGON_CROSSING;
    if (reflex_count == 1)
        cut_along(out, corner, reflex & 1);
    else
        cut_along(out, corner, vec3_distance(corner[1], corner[3]) < vec3_distance(corner[0], corner[2]));
    return bent ? POLYGON_NOT_PLANAR : POLYGON_CONCAVE;
}

/* ---- pairs ---- */

typedef struct matrix_run {
    const factor_matrix_setup *setup;
    double *K, *error;
    double margin;
    uint64_t *evaluations; /* of each row */
    size_t *unconverged;   /* of each row */
    bool *failed;          /* of each row: out of memory */
} matrix_run;

typedef struct pair_integrand {
    const blocker_list *blockers;
    const polygon *target;
    const double *normal;
    double margin;
    bool lost;
} pair_integrand;

static double seen_from(void *user, const double point[3]) {
    pair_integrand *p = user;
    return visible_factor(p->blockers, p->target, point, p->normal, p->margin, &p->lost);
}

static bool collect_blockers(const matrix_run *r, size_t i, size_t j, const facing_pair *pair, blocker_list *out) {
    for (size_t k = 0; k < r->setup->count; k++) {
        const matrix_polygon *p = &r->setup->polygons[k];
        if (k == i || k == j) continue;
        for (int part = 0; part < p->part_count; part++)
            if (!blocker_list_add(out, pair, &p->part[part], p->normal[part], p->plane[part])) return false;
    }
    return true;
}

static void add_integral(factor_estimate *sum, const factor_estimate *part) {
    sum->value += part->value;
    sum->error += part->error;
    sum->evaluations += part->evaluations;
    sum->converged = sum->converged && part->converged;
}

/* Nothing can stand between: one integral along the outline, over all of both polygons, since what lies behind the
 * other does not count. */
static void integrate_free(const factor_matrix_setup *setup, const polygon *from, const polygon *to, double tolerance,
                           factor_estimate *sum) {
    double area[3];
    polygon_vector_area(from, area);
    double A = vec3_length(area);
    if (!(A > 0.0)) return;
    const factor_request request = { .absolute = tolerance / A,
                                     .evaluations_max = (size_t)setup->evaluation_limit,
                                     .memory = jobs_memory(setup->jobs) };
    factor_estimate F = polygon_pair_factor(polygon_boundary(from), polygon_boundary(to), &request);
    const factor_estimate part = { A * F.value, A * F.error, F.evaluations, F.converged };
    add_integral(sum, &part);
}

/* Integrates over the smaller of two parts, so that the hidden part of the larger is cut exactly. */
static void integrate_parts(matrix_run *r, size_t i, int part_i, size_t j, int part_j, double tolerance,
                            factor_estimate *sum) {
    const matrix_polygon *a = &r->setup->polygons[i], *b = &r->setup->polygons[j];
    polygon from, to;
    polygon_clip(&from, &a->part[part_i], b->normal[part_j], b->plane[part_j] + r->margin);
    polygon_clip(&to, &b->part[part_j], a->normal[part_i], a->plane[part_i] + r->margin);
    if (from.count < 3 || to.count < 3) return;
    facing_pair pair = {
        &from, &to, a->normal[part_i], b->normal[part_j], a->plane[part_i], b->plane[part_j], r->margin
    };
    blocker_list blockers = { .memory = jobs_memory(r->setup->jobs) };
    if (!collect_blockers(r, i, j, &pair, &blockers)) {
        r->failed[i] = true;
    } else if (blockers.count == 0) {
        integrate_free(r->setup, &a->part[part_i], &b->part[part_j], tolerance, sum);
    } else {
        pair_integrand f = { &blockers, &to, a->normal[part_i], r->margin, false };
        factor_estimate part =
            shadow_integrate(&from, seen_from, &f, tolerance, r->setup->evaluation_limit, blockers.memory);
        part.converged = part.converged && !f.lost;
        add_integral(sum, &part);
    }
    blocker_list_free(&blockers);
}

static double total_area(const matrix_polygon *p) {
    return p->part_count == 0 ? 0.0 : p->part_count == 1 ? p->area[0] : p->area[0] + p->area[1];
}

static void compute_pair(matrix_run *r, size_t i, size_t j) {
    const matrix_polygon *a = &r->setup->polygons[i], *b = &r->setup->polygons[j];
    size_t n = r->setup->count;
    bool swap = total_area(b) < total_area(a);
    int parts = a->part_count * b->part_count;
    factor_estimate sum = { .converged = true };
    if (parts == 0 || a->obstruction || b->obstruction) return;
    double tolerance = r->setup->tolerance * fmin(total_area(a), total_area(b)) / parts;
    for (int p = 0; p < a->part_count; p++)
        for (int q = 0; q < b->part_count; q++) {
            if (swap)
                integrate_parts(r, j, q, i, p, tolerance, &sum);
            else
                integrate_parts(r, i, p, j, q, tolerance, &sum);
        }
    r->K[i * n + j] = r->K[j * n + i] = sum.value;
    r->error[i * n + j] = r->error[j * n + i] = sum.error;
    r->evaluations[i] += sum.evaluations;
    r->unconverged[i] += !sum.converged;
}

/* A row's pairs with all later polygons: rows are independent, so threads change nothing. */
static void compute_row(void *user, size_t i, unsigned worker) {
    matrix_run *r = user;
    (void)worker;
    for (size_t j = i + 1; j < r->setup->count; j++) compute_pair(r, i, j);
}

static double scene_radius(const factor_matrix_setup *s) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < s->count; i++)
        for (int part = 0; part < s->polygons[i].part_count; part++)
            for (int c = 0; c < s->polygons[i].part[part].count; c++)
                for (int k = 0; k < 3; k++) {
                    low[k] = fmin(low[k], s->polygons[i].part[part].corner[c][k]);
                    high[k] = fmax(high[k], s->polygons[i].part[part].corner[c][k]);
                }
    return low[0] <= high[0] ? 0.5 * vec3_distance(low, high) : 0.0;
}

size_t factor_matrix(const factor_matrix_setup *setup, double *K, double *error, uint64_t *evaluations) {
    size_t n = setup->count, unconverged = 0;
    matrix_run r = { .setup = setup, .K = K, .error = error, .margin = PLANE_MARGIN * scene_radius(setup) };
    allocator *memory = jobs_memory(setup->jobs);
    r.evaluations = block_zeroed(memory, n + 1, sizeof *r.evaluations);
    r.unconverged = block_zeroed(memory, n + 1, sizeof *r.unconverged);
    r.failed = block_zeroed(memory, n + 1, sizeof *r.failed);
    memset(K, 0, n * n * sizeof *K);
    memset(error, 0, n * n * sizeof *error);
    *evaluations = 0;
    bool ok = r.evaluations && r.unconverged && r.failed;
    if (ok) jobs_run(setup->jobs, n, compute_row, NULL, &r);
    for (size_t i = 0; ok && i < n; i++) {
        unconverged += r.unconverged[i];
        *evaluations += r.evaluations[i];
        ok = !r.failed[i];
    }
    block_free_all(r.evaluations, r.unconverged, r.failed);
    return ok ? unconverged : SIZE_MAX;
}
