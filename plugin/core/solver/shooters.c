/* SPDX-License-Identifier: MIT
 * See shooters.h.
 */
#include "solver/shooters.h"

#include "base/block.h"
#include "geometry/vec3.h"

#include <string.h>

bool shooters_create(const scene *s, const mesh *m, const double *arrived, shooters *out) {
    *out = (shooters){ .scene = s, .mesh = m };
    out->all = block_zeroed(m->memory, m->patch_count + 1, sizeof *out->all);
    if (!out->all) return false;
    out->count = out->capacity = m->patch_count;
    for (uint32_t p = 0; p < m->patch_count; p++) {
        out->all[p].piece = subpatch_of_patch(m, p);
        out->all[p].parts[0] = NO_INDEX;
    }
    shooters_reset(out, arrived);
    return true;
}

void shooter_drop_column(shooter *s) {
    column_destroy(s->column);
    block_free(s->averages);
    s->column = NULL;
    s->averages = NULL;
}

void shooters_free(shooters *s) {
    for (size_t i = 0; i < s->count; i++) shooter_drop_column(&s->all[i]);
    row_closure_free(&s->rows);
    block_free(s->all);
    block_free(s->of_sample);
    memset(s, 0, sizeof *s);
}

void shooters_direct(const shooters *s, uint32_t patch_index, const double *arrived, double E[3]) {
    const patch *p = &s->mesh->patches[patch_index];
    for (int c = 0; c < 3; c++) E[c] = 0.0;
    for (uint32_t i = p->first_sample; arrived && i < p->first_sample + p->sample_count; i++)
        for (int c = 0; c < 3; c++) E[c] += arrived[3 * (size_t)i + (size_t)c] * s->mesh->sample_area[i] / p->area;
}

void shooters_reset(shooters *s, const double *arrived) {
    for (size_t i = 0; i < s->count; i++) {
        memset(s->all[i].unshot, 0, sizeof s->all[i].unshot);
        memset(s->all[i].shot, 0, sizeof s->all[i].shot);
    }
    for (uint32_t p = 0; p < s->mesh->patch_count; p++) {
        shooter *lead = &s->all[mesh_lead(s->mesh, p)];
        const material *m = &s->mesh->patches[p].material;
        double E[3], share = s->mesh->patches[p].area / lead->piece.area;
        if (!shooter_is_whole(lead)) continue;
        shooters_direct(s, p, arrived, E);
        for (int c = 0; c < 3; c++) lead->unshot[c] += share * (m->M[c] + m->rho[c] * E[c]);
    }
}

double shooter_unshot_power(const shooter *s) {
    return (fabs(s->unshot[0]) + fabs(s->unshot[1]) + fabs(s->unshot[2])) * s->piece.area;
}

int shooter_depth(const shooter *s) {
    return subpatch_path_depth(s->piece.path);
}

/* ---- cutting -------------------------------------------------------------------------------------------------------
 */

/* How far inside a convex polygon a point of its plane is: the least distance to an edge, negative outside. */
static double depth_inside(const polygon *shape, const double normal[3], const double point[3]) {
    double least = INFINITY;
    for (int i = 0; i < shape->count; i++) {
        double edge[3], inward[3], offset[3];
        vec3_sub(edge, shape->corner[(i + 1) % shape->count], shape->corner[i]);
        vec3_cross(inward, normal, edge);
        vec3_sub(offset, point, shape->corner[i]);
        if (vec3_normalize(inward) > 0.0) least = fmin(least, vec3_dot(inward, offset));
    }
    return least;
}

static int quarter_of(const polygon quarter[4], const double normal[3], const double point[3]) {
    int best = 0;
    double deepest = -INFINITY;
    for (int q = 0; q < 4; q++) {
        double depth = depth_inside(&quarter[q], normal, point);
        if (depth > deepest) deepest = depth, best = q;
    }
    return best;
}

static bool reserve(shooters *s) {
    if (!s->of_sample) {
        s->of_sample = block_new(s->mesh->memory, (s->mesh->sample_count + 1) * sizeof *s->of_sample);
        if (!s->of_sample) return false;
        for (size_t p = 0; p < s->mesh->patch_count; p++)
            for (uint32_t k = 0; k < s->mesh->patches[p].sample_count; k++)
                s->of_sample[s->mesh->patches[p].first_sample + k] = (uint32_t)p;
    }
    if (s->count + 4 <= s->capacity) return true;
    size_t capacity = 2 * s->capacity + 4;
    shooter *grown = block_resize(s->mesh->memory, s->all, capacity * sizeof *grown);
    if (!grown) return false;
    s->all = grown;
    s->capacity = capacity;
    return true;
}

/* Hands the samples of a shooter to its quarters: their areas, and the radiosity that goes with them. */
static void share_samples(shooters *s, uint32_t index, const polygon quarter[4], const double *radiosity,
                          double power[4][3]) {
    const patch *p = &s->mesh->patches[s->all[index].piece.patch];
    const double *normal = s->scene->surfaces[p->surface].normal;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        uint32_t i = p->first_sample + k;
        if (s->of_sample[i] != index) continue;
        int q = quarter_of(quarter, normal, (double[]){ s->mesh->x[i], s->mesh->y[i], s->mesh->z[i] });
        s->of_sample[i] = s->all[index].parts[q];
        s->all[s->of_sample[i]].piece.area += s->mesh->sample_area[i];
        for (int c = 0; c < 3; c++) power[q][c] += s->mesh->sample_area[i] * radiosity[3 * (size_t)k + c];
    }
}

bool shooters_split(shooters *s, uint32_t index, const double *radiosity) {
    polygon quarter[4];
    double power[4][3] = { 0 };
    if (!reserve(s)) return false;
    shooter *whole = &s->all[index];
    polygon_quarter(&whole->piece.shape, quarter);
    for (int q = 0; q < 4; q++) {
        whole->parts[q] = (uint32_t)s->count;
        s->all[s->count++] = (shooter){ .piece = { .shape = quarter[q],
                                                   .path = subpatch_path_of_quarter(whole->piece.path, q),
                                                   .patch = whole->piece.patch },
                                        .parts = { NO_INDEX } };
    }
    share_samples(s, index, quarter, radiosity, power);
    for (int c = 0; c < 3; c++) {
        double all = power[0][c] + power[1][c] + power[2][c] + power[3][c];
        double unshot = whole->unshot[c] * whole->piece.area;
        for (int q = 0; q < 4; q++) {
            shooter *part = &s->all[whole->parts[q]];
            double share = all > 0.0 ? power[q][c] / all : part->piece.area / whole->piece.area;
            if (part->piece.area > 0.0) part->unshot[c] = unshot * share / part->piece.area;
        }
        whole->unshot[c] = 0.0;
    }
    shooter_drop_column(whole);
    return true;
}

/* ---- receiving -----------------------------------------------------------------------------------------------------
 */

static void receive_on_parts(shooters *s, const shooter *from, const column_run *run, const double B[3]) {
    const patch *p = &s->mesh->patches[run->patch];
    const double *rho = shooter_material(s, run->patch)->rho;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        uint32_t sample = p->first_sample + k;
        shooter *part = &s->all[s->of_sample[sample]];
        double share = s->mesh->sample_area[sample] / part->piece.area;
        float F = row_closure_close(&s->rows, sample, shooter_emits(s, from), from->column->factors[run->first + k]);
        for (int band = 0; band < 3; band++) part->unshot[band] += rho[band] * F * B[band] * share;
    }
}

void shooters_receive(shooters *s, const shooter *from, size_t index, const double B[3], double gain[3]) {
    const column_run *run = &from->column->runs[index];
    const double *rho = shooter_material(s, run->patch)->rho;
    shooter *whole = &s->all[mesh_lead(s->mesh, run->patch)];
    double area = s->mesh->patches[run->patch].area;
    for (int band = 0; band < 3; band++) gain[band] = rho[band] * shooter_average(from, index) * B[band];
    if (shooter_is_whole(whole))
        for (int band = 0; band < 3; band++) whole->unshot[band] += gain[band] * (area / whole->piece.area);
    else
        receive_on_parts(s, from, run, B);
    for (int band = 0; band < 3; band++) gain[band] *= area;
}

static void add_positive(const shooters *s, const shooter *one, double power[3]) {
    for (int q = 0; q < 4 && !shooter_is_whole(one); q++) add_positive(s, &s->all[one->parts[q]], power);
    for (int c = 0; c < 3; c++) power[c] += fmax(one->unshot[c], 0.0) * one->piece.area;
}

void shooters_patch_unshot(const shooters *s, uint32_t patch_index, double unshot[3]) {
    const shooter *whole = &s->all[mesh_lead(s->mesh, patch_index)];
    for (int c = 0; c < 3; c++) unshot[c] = 0.0;
    add_positive(s, whole, unshot);
    for (int c = 0; c < 3; c++) unshot[c] /= whole->piece.area;
}
