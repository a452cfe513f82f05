/* SPDX-License-Identifier: MIT */
#include "solver/row_closure.h"

#include "base/tolerance.h"

double row_closure_correction(double row_sum, double row_sum_emitters) {
    double missing = 1.0 - row_sum, carries = row_sum - row_sum_emitters + ROW_CLOSURE_EMITTER_SHARE * row_sum_emitters;
    return fabs(missing) <= TOLERANCE_ROW && carries > 0.0 ? missing / carries : 0.0;
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

double *row_closure_averages(const row_closure *r, const mesh *m, bool emitter, const column *c) {
    double *averages = block_new(m->memory, (c->run_count + 1) * sizeof *averages);
    for (size_t i = 0; averages && i < c->run_count; i++) {
        const patch *p = &m->patches[c->runs[i].patch];
        double received = 0.0;
        for (uint32_t k = 0; k < p->sample_count; k++) {
            uint32_t s = p->first_sample + k;
            received +=
                c->factors[c->runs[i].first + k] * row_closure_factor(r->correction[s], emitter) * m->sample_area[s];
        }
        averages[i] = received / p->area;
    }
    return averages;
}
