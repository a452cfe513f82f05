/* SPDX-License-Identifier: MIT
 * See row_closure.h.
 */
#include "solver/row_closure.h"

#include "base/block.h"
#include "base/tolerance.h"

#include <math.h>

/* How much of a row's error is looked for in the factors of emitters: they are quartered until their parts agree, and
 * always closed forms, so an order of magnitude better than the rest. */
static const double EMITTER_SHARE = 0.1;

double row_closure_correction(double row_sum, double row_sum_emitters) {
    double missing = 1.0 - row_sum, carries = row_sum - row_sum_emitters + EMITTER_SHARE * row_sum_emitters;
    return fabs(missing) <= TOLERANCE_ROW && carries > 0.0 ? missing / carries : 0.0;
}

double row_closure_factor(double correction, bool emitter) {
    return 1.0 + (emitter ? EMITTER_SHARE : 1.0) * correction;
}

bool row_closure_find(const mesh *m, const double *row_sum, const double *row_sum_emitters, row_closure *out) {
    out->correction = block_zeroed(m->memory, m->sample_count + 1, sizeof *out->correction);
    if (!out->correction) return false;
    for (size_t s = 0; s < m->sample_count; s++)
        out->correction[s] = (float)row_closure_correction(row_sum[s], row_sum_emitters[s]);
    return true;
}

void row_closure_free(row_closure *r) {
    block_free(r->correction);
    r->correction = NULL;
}

void row_closure_apply(const row_closure *r, const column_setup *setup, uint32_t shooting_patch, column *c) {
    const mesh *m = setup->mesh;
    bool emitter = material_emits(&m->patches[shooting_patch].material);
    for (size_t i = 0; i < c->run_count; i++) {
        column_run *run = &c->runs[i];
        const patch *p = &m->patches[run->patch];
        double received = 0.0;
        for (uint32_t k = 0; k < p->sample_count; k++) {
            uint32_t s = p->first_sample + k;
            double F = c->factors[run->first + k] * row_closure_factor(r->correction[s], emitter);
            c->factors[run->first + k] = (float)F;
            received += F * m->sample_area[s];
        }
        run->factor = received / p->area;
    }
}
