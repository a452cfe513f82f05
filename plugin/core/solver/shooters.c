/* SPDX-License-Identifier: MIT */
#include "solver/shooters.h"

#include <string.h>

bool shooters_create(const scene *s, const mesh *m, const double *arrived, shooters *out) {
    *out = (shooters){ .scene = s, .mesh = m };
    out->all = block_zeroed(m->memory, m->patch_count + 1, sizeof *out->all);
    if (!out->all) return false;
    out->count = out->capacity = m->patch_count;
    for (uint32_t p = 0; p < m->patch_count; p++) {
        out->all[p].subpatch = subpatch_of_patch(s, m, p);
        out->all[p].quarters[0] = NO_INDEX;
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
    block_free_all(s->all, s->of_sample);
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
        double E[3], share = s->mesh->patches[p].area / lead->subpatch.area;
        if (!shooter_is_whole(lead)) continue;
        shooters_direct(s, p, arrived, E);
        for (int c = 0; c < 3; c++) lead->unshot[c] += share * (m->M[c] + m->rho[c] * E[c]);
    }
}

double shooter_unshot_power(const shooter *s) {
    return (fabs(s->unshot[0]) + fabs(s->unshot[1]) + fabs(s->unshot[2])) * s->subpatch.area;
}

int shooter_depth(const shooter *s) {
    return subpatch_path_depth(s->subpatch.path);
}

/* ---- receiving ---- */

static void receive_on_quarters(shooters *s, const shooter *from, const column_run *run, const double B[3]) {
    const patch *p = &s->mesh->patches[run->patch];
    const double *rho = shooter_material(s, run->patch)->rho;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        uint32_t sample = p->first_sample + k;
        shooter *quarter = &s->all[s->of_sample[sample]];
        double share = s->mesh->sample_area[sample] / quarter->subpatch.area;
        float F = row_closure_close(&s->rows, sample, shooter_emits(s, from), from->column->factors[run->first + k]);
        for (int band = 0; band < 3; band++) quarter->unshot[band] += rho[band] * F * run->tint[band] * B[band] * share;
    }
}

void shooters_receive(shooters *s, const shooter *from, size_t index, const double B[3], double gain[3]) {
    const column_run *run = &from->column->runs[index];
    const double *rho = shooter_material(s, run->patch)->rho;
    shooter *whole = &s->all[mesh_lead(s->mesh, run->patch)];
    double area = s->mesh->patches[run->patch].area;
    for (int band = 0; band < 3; band++)
        gain[band] = rho[band] * shooter_average(from, index) * run->tint[band] * B[band];
    if (shooter_is_whole(whole))
        for (int band = 0; band < 3; band++) whole->unshot[band] += gain[band] * (area / whole->subpatch.area);
    else
        receive_on_quarters(s, from, run, B);
    for (int band = 0; band < 3; band++) gain[band] *= area;
}

static void add_positive(const shooters *s, const shooter *one, double power[3]) {
    for (int q = 0; q < 4 && !shooter_is_whole(one); q++) add_positive(s, &s->all[one->quarters[q]], power);
    for (int c = 0; c < 3; c++) power[c] += fmax(one->unshot[c], 0.0) * one->subpatch.area;
}

void shooters_patch_unshot(const shooters *s, uint32_t patch_index, double unshot[3]) {
    const shooter *whole = &s->all[mesh_lead(s->mesh, patch_index)];
    for (int c = 0; c < 3; c++) unshot[c] = 0.0;
    add_positive(s, whole, unshot);
    for (int c = 0; c < 3; c++) unshot[c] /= whole->subpatch.area;
}
