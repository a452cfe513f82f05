/* SPDX-License-Identifier: MIT
 * See adaptive.h. Pieces lie in a binary heap with the worst on top. Which piece comes next depends on nothing but the
 * integrand, so the same input gives the same bits.
 */
#include "factors/adaptive.h"

#include <math.h>
#include <string.h>

static const double DEFAULT_RELATIVE = 1e-6;
static const size_t DEFAULT_EVALUATIONS = 1000000;

/* What is lost of small errors in a running sum. */
static const double RUNNING_SUM = 1e-12;

typedef struct heap {
    adaptive_piece *pieces;
    size_t count, capacity;
    double error; /* running sum */
    allocator *memory;
} heap;

static bool heap_push(heap *h, const adaptive_piece *piece) {
    if (!block_grow(h->memory, (void **)&h->pieces, &h->capacity, h->count, sizeof *piece)) return false;
    size_t i = h->count++;
    for (; i > 0 && h->pieces[(i - 1) / 2].error < piece->error; i = (i - 1) / 2) h->pieces[i] = h->pieces[(i - 1) / 2];
    h->pieces[i] = *piece;
    h->error += piece->error;
    return true;
}

static adaptive_piece heap_pop(heap *h) {
    adaptive_piece top = h->pieces[0], last = h->pieces[--h->count];
    size_t i = 0;
    for (size_t child = 1; child < h->count; child = 2 * i + 1) {
        if (child + 1 < h->count && h->pieces[child + 1].error > h->pieces[child].error) child++;
        if (h->pieces[child].error <= last.error) break;
        h->pieces[i] = h->pieces[child];
        i = child;
    }
    h->pieces[i] = last;
    h->error -= top.error;
    return top;
}

typedef struct totals {
    double value, error, rounding;
} totals;

static totals heap_totals(const heap *h, double scale) {
    totals t = { 0, 0, 0 };
    for (size_t i = 0; i < h->count; i++) {
        t.value += scale * h->pieces[i].value;
        t.error += fabs(scale) * h->pieces[i].error;
        t.rounding += fabs(scale) * h->pieces[i].rounding;
    }
    return t;
}

static factor_request with_defaults(const factor_request *request) {
    factor_request r = request ? *request : (factor_request){ 0 };
    if (!(r.relative > 0.0) && !(r.absolute > 0.0)) r.relative = DEFAULT_RELATIVE;
    if (r.evaluations_max == 0) r.evaluations_max = DEFAULT_EVALUATIONS;
    return r;
}

static double tolerance_of(const factor_request *r, double value) {
    return fmax(r->absolute, r->relative * fabs(value));
}

static bool push_evaluated(heap *h, const adaptive_rule *rule, const double place[ADAPTIVE_PLACE]) {
    adaptive_piece piece;
    memcpy(piece.place, place, sizeof piece.place);
    rule->evaluate(rule->user, &piece);
    return heap_push(h, &piece);
}

/* False when out of memory. */
static bool split_worst(heap *h, const adaptive_rule *rule, size_t *evaluations) {
    double parts[ADAPTIVE_CHILDREN][ADAPTIVE_PLACE];
    adaptive_piece worst = heap_pop(h);
    int count = rule->split(rule->user, worst.place, parts);
    for (int i = 0; i < count; i++)
        if (!push_evaluated(h, rule, parts[i])) return false;
    *evaluations += (size_t)count * rule->cost + rule->split_cost;
    return true;
}

/* One by one, as long as a split cannot take more evaluations than are left. False when out of memory. */
static bool split_each(heap *h, const adaptive_rule *rule, const factor_request *r, double scale, size_t *evaluations) {
    const size_t most = ADAPTIVE_CHILDREN * rule->cost + rule->split_cost;
    while (h->count > 0 && fabs(scale) * h->error > r->absolute && *evaluations + most <= r->evaluations_max)
        if (!split_worst(h, rule, evaluations)) return false;
    return true;
}

factor_estimate adaptive_integrate(const adaptive_rule *rule, const double (*places)[ADAPTIVE_PLACE], size_t count,
                                   double scale, const factor_request *request) {
    factor_request r = with_defaults(request);
    heap h = { .memory = r.memory };
    bool memory = true;
    for (size_t i = 0; i < count && memory; i++) memory = push_evaluated(&h, rule, places[i]);
    size_t evaluations = count * rule->cost;
    if (memory && rule->is_dear) memory = split_each(&h, rule, &r, scale, &evaluations);
    totals t = heap_totals(&h, scale);
    while (memory && !rule->is_dear && h.count > 0 && evaluations < r.evaluations_max) {
        /* Below the roundings no splitting helps. */
        if (t.error <= fmax(tolerance_of(&r, t.value) - t.rounding, 0.25 * t.rounding)) break;
        /* Many pieces are split between sums, so that summing costs little. */
        for (size_t i = 0, rounds = 1 + h.count / 16; memory && i < rounds && evaluations < r.evaluations_max; i++)
            memory = split_worst(&h, rule, &evaluations);
        t = heap_totals(&h, scale);
    }
    block_free(h.pieces);
    double error = memory ? t.error + t.rounding : 1.0;
    double tolerance = tolerance_of(&r, t.value) * (rule->is_dear ? 1.0 + RUNNING_SUM : 1.0);
    return (factor_estimate){ t.value, error, evaluations, memory && error <= tolerance };
}

double adaptive_error(double difference, double variation) {
    double d = fabs(difference);
    if (!(variation > 0.0) || !(d > 0.0)) return d;
    return fmax(d, variation * fmin(1.0, pow(200.0 * d / variation, 1.5)));
}
