/* SPDX-License-Identifier: MIT
 * Are these polygons in order, and what is their form-factor matrix? hemi_factors_compute.
 */
#include "desc_size.h"
#include "internal.h"

#include "factors/factor_matrix.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

static const double TOLERANCE_DEFAULT = 1e-5;
static const uint64_t EVALUATIONS_DEFAULT = 200000;

static const char *desc_fault(const hemi_factors_desc *d) {
    if (d->polygon_count == 0) return "there is no polygon";
    if (d->polygon_count > HEMI_FACTORS_MAX) return "there are more than 8192 polygons";
    if (!d->positions || !d->corners) return "positions or corners are NULL";
    if (!(d->tolerance >= 0.0) || isinf(d->tolerance)) return "the tolerance is negative or not a number";
    for (size_t i = 0; i < d->polygon_count; i++)
        for (int c = 0; c < 4; c++)
            if (c < 3 && d->corners[4 * i + c] < 0)
                return "one of the first three corners is below 0";
            else if (d->corners[4 * i + c] >= (int64_t)d->vertex_count)
                return "a corner is past the last vertex";
    return NULL;
}

static void set_polygons(const hemi_factors_desc *d, matrix_polygon *polygons, hemi_factors *out) {
    for (size_t i = 0; i < d->polygon_count; i++) {
        double corner[4][3];
        int count = d->corners[4 * i + 3] < 0 ? 3 : 4;
        for (int c = 0; c < count; c++)
            memcpy(corner[c], d->positions + 3 * (size_t)d->corners[4 * i + c], sizeof corner[c]);
        polygon_kind kind = matrix_polygon_set(&polygons[i], (const double(*)[3])corner, count);
        out->not_planar += kind == POLYGON_NOT_PLANAR;
        out->concave += kind == POLYGON_CONCAVE;
        out->crossing += kind == POLYGON_CROSSING;
        out->no_area += kind == POLYGON_NO_AREA;
        out->not_finite += kind == POLYGON_NOT_FINITE;
        polygons[i].obstruction = d->obstructions && d->obstructions[i];
        for (int part = 0; part < polygons[i].part_count; part++) out->areas[i] += polygons[i].area[part];
    }
}

static hemi_result compute(hemi_context *context, const hemi_factors_desc *d, hemi_factors *out) {
    size_t n = d->polygon_count;
    matrix_polygon *polygons = block_zeroed(&context->memory, n, sizeof *polygons);
    out->polygon_count = d->polygon_count;
    out->areas = block_zeroed(&context->memory, n, sizeof *out->areas);
    out->factors = block_zeroed(&context->memory, n * n, sizeof *out->factors);
    out->errors = block_zeroed(&context->memory, n * n, sizeof *out->errors);
    hemi_result result = polygons && out->areas && out->factors && out->errors ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) {
        set_polygons(d, polygons, out);
        factor_matrix_setup setup = { .polygons = polygons,
                                      .count = n,
                                      .tolerance = d->tolerance > 0.0 ? d->tolerance : TOLERANCE_DEFAULT,
                                      .evaluation_limit =
                                          d->evaluation_limit ? d->evaluation_limit : EVALUATIONS_DEFAULT,
                                      .jobs = context->jobs };
        size_t unconverged = factor_matrix(&setup, out->factors, out->errors, &out->evaluations);
        if (unconverged == SIZE_MAX) result = HEMI_ERROR_MEMORY;
        out->unconverged_pairs = unconverged;
        for (size_t k = 0; k < n * n; k++) { /* K_ij = A_i F_ij to F_ij */
            double scale = out->areas[k / n] > 0.0 ? 1.0 / out->areas[k / n] : 0.0;
            out->factors[k] *= scale;
            out->errors[k] *= scale;
        }
    }
    block_free(polygons);
    return result;
}

hemi_result hemi_factors_compute(hemi_context *context, const hemi_factors_desc *given, hemi_factors *out) {
    hemi_factors_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_factors_desc, polygon_count);
    const size_t least_out = DESC_THROUGH(hemi_factors, evaluations);
    hemi_factors made = { .struct_size = sizeof made };
    if (!context || !view_give(out, least_out, &made, sizeof made) ||
        !desc_take(context, "factors", given, least, &known, sizeof known))
        return HEMI_ERROR_ARGUMENT;
    const char *fault = desc_fault(desc);
    if (fault) return context_fail(context, HEMI_ERROR_ARGUMENT, "factors: %s", fault);
    context_begin(context);
    hemi_result result = context_end(context, compute(context, desc, &made));
    if (result != HEMI_OK) hemi_factors_free(&made);
    view_give(out, least_out, &made, sizeof made);
    return result;
}

void hemi_factors_free(hemi_factors *factors) {
    if (!factors) return;
    block_free_all(factors->areas, factors->factors, factors->errors);
    hemi_factors none = { 0 };
    view_give(factors, DESC_THROUGH(hemi_factors, evaluations), &none, sizeof none);
}
