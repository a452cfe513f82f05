/* SPDX-License-Identifier: MIT */
#include "reconstruct/vertex_errors.h"

#include "adapt/error_indicator.h"
#include "base/block.h"

#include <math.h>

/* Elements give what they are off by to their nodes, with their area. */
static void spread(const mesh *m, const fit_samples *samples, const double *fault, double *square, double *area) {
    for (size_t e = 0; e < m->element_count; e++) {
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(&m->elements[e], ring);
        if (material_emits(m->elements[e].material)) continue;
        for (int i = 0; i < places; i++) {
            uint32_t node = samples->nodes[ELEMENT_PLACES * e + ring[i]];
            square[node] += fault[e] / places;
            area[node] += m->elements[e].area / places;
        }
    }
}

double *vertex_errors_find(const mesh *m, const fit_samples *samples, double estimate) {
    size_t count = m->node_count;
    const error_indicator_input in = { .mesh = m,
                                       .node = samples->nodes,
                                       .node_count = count,
                                       .radiance = samples->radiance,
                                       .weight = samples->weight,
                                       .uneven = samples->uneven };
    double *fault = block_zeroed(m->memory, m->element_count + 1, sizeof *fault), faults = 0.0, areas = 0.0;
    double *level = block_new(m->memory, (m->element_count + 1) * sizeof *level);
    double *errors = block_zeroed(m->memory, count + 1, sizeof *errors); /* squares at first */
    double *area = block_zeroed(m->memory, count + 1, sizeof *area);
    bool ok = fault && level && errors && area && error_indicator_measure(&in, fault, level);
    if (ok) spread(m, samples, fault, errors, area);
    for (size_t v = 0; ok && v < count; v++) faults += errors[v], areas += area[v];
    for (size_t v = 0; ok && v < count; v++) {
        double share = faults > 0.0 && area[v] > 0.0 ? errors[v] / area[v] * (areas / faults) : area[v] > 0.0;
        errors[v] = estimate * sqrt(share);
    }
    if (!ok) block_free(errors);
    block_free_all(fault, level, area);
    return ok ? errors : NULL;
}
