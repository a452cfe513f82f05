/* SPDX-License-Identifier: MIT
 * See row_iteration.h.
 */
#include "solver/row_iteration.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS_MAX = 400 };

/* Blocks of so many elements are summed each by itself: the same bits whoever does. */
enum { BLOCK = 4096, SUMS = 3 };

/* Where the changes of iterations are not extrapolated they end when one is this share of the tolerance. */
static const double PLAIN = 1e-4;

/* From one iteration to the next the share of the change that is left is steady where it moves by less than this share
 * of what is missing of 1, which bounds what extrapolation is off by; and it counts as no more than SHARE_MAX. */
static const double STEADY = 0.1, SHARE_MAX = 0.9995;

/* Light settles fast where an iteration changes at most this share of what the last one did. A room 7 m long behind a
 * window of its house was 4 % too dark where the light of all decided: white walls under the sky had nearly all of
 * that. */
static const double FAST = 0.9;

static size_t block_count(const row_iteration *r) {
    return (r->element_count + BLOCK - 1) / BLOCK;
}

bool row_iteration_open(row_iteration *r) {
    size_t bands = 3 * r->element_count + 1;
    r->residual = 1.0;
    r->B = block_zeroed(r->memory, bands, sizeof *r->B);
    r->next = block_zeroed(r->memory, bands, sizeof *r->next);
    r->kept = block_zeroed(r->memory, bands, sizeof *r->kept);
    r->change = block_zeroed(r->memory, bands, sizeof *r->change);
    r->sums = block_zeroed(r->memory, SUMS * block_count(r) + 1, sizeof *r->sums);
    return r->B && r->next && r->kept && r->change && r->sums;
}

void row_iteration_free(row_iteration *r) {
    block_free_all(r->B, r->next, r->kept, r->change, r->sums);
    r->B = r->next = r->kept = r->sums = NULL;
    r->change = NULL;
}

/* Sums over area. */
typedef struct changes {
    double all;   /* what an iteration changed */
    double fast;  /* what those to come would change where light settles fast, if each changes the same share */
    double level; /* what there is */
} changes;

static void sum_block(void *user, size_t block, unsigned worker) {
    row_iteration *r = user;
    changes found = { 0 };
    size_t end = (block + 1) * BLOCK < r->element_count ? (block + 1) * BLOCK : r->element_count;
    (void)worker;
    for (size_t e = block * BLOCK; e < end; e++)
        for (size_t c = 3 * e; c < 3 * e + 3; c++) {
            double area = r->elements[e].area, change = fabs(r->next[c] - r->B[c]), last = (double)r->change[c];
            if (change <= FAST * last && last > 0.0) found.fast += area * change * change / (last - change);
            found.all += area * change;
            found.level += area * r->next[c];
            r->change[c] = (float)change;
        }
    memcpy(r->sums + SUMS * block, (double[SUMS]){ found.all, found.fast, found.level }, SUMS * sizeof *r->sums);
}

static changes changes_of(row_iteration *r) {
    changes found = { 0 };
    jobs_run(r->jobs, block_count(r), sum_block, NULL, r);
    for (size_t i = 0; i < block_count(r); i++) {
        const double *of_block = r->sums + SUMS * i;
        found.all += of_block[0], found.fast += of_block[1], found.level += of_block[2];
    }
    return found;
}

static void take_residual(row_iteration *r, double residual_w, double level_w) {
    r->residual_w = residual_w;
    r->residual = level_w > 0.0 ? fmin(residual_w / level_w, 1.0) : 0.0;
}

static void swap(row_iteration *r) {
    double *swapped = r->B;
    r->B = r->next, r->next = swapped;
}

/* Keeps what there is, and adds what the iterations to come would, if each changes this share of what the last did. */
static void extrapolate(row_iteration *r, double share) {
    double rest = share / (1.0 - share);
    size_t count = 3 * r->element_count;
    memcpy(r->kept, r->next, count * sizeof *r->kept);
    for (size_t k = 0; k < count; k++) r->next[k] = fmax(r->next[k] + rest * (r->next[k] - r->B[k]), 0.0);
}

/* Iterations alone always settle, since no row reflects all. Changes fall by the same share each time once what dies
 * out faster has died out: the rest of the series is known then and is added at once, without which rooms that reflect
 * nearly everything would take thousands of iterations. Where that does not help, as with several such rooms, it is
 * taken back and not tried again. */
void row_iteration_settle(row_iteration *r, row_tolerance tolerance) {
    double last = 0.0, last_share = 0.0, before = 0.0; /* before: the change before the last extrapolation */
    const double worth = r->worth > 0.0 ? r->worth : 1.0;
    bool may_extrapolate = true;
    for (r->count = 1; r->count <= ITERATIONS_MAX && r->go_on(r->user); r->count++) {
        r->gather(r->user, r->B, r->next);
        const changes found = changes_of(r);
        double change = found.all, share = last > 0.0 ? fmin(change / last, SHARE_MAX) : 0.0;
        if (before > 0.0 && !(change < before)) {
            memcpy(r->B, r->kept, 3 * r->element_count * sizeof *r->B);
            may_extrapolate = false, before = last = last_share = 0.0;
            continue;
        }
        take_residual(r, change * (share > 0.0 ? share / (1.0 - share) : 1.0), found.level);
        bool is_done = may_extrapolate && last > 0.0
                           ? r->residual_w <= tolerance.all * found.level
                           : change <= (may_extrapolate ? PLAIN : worth) * tolerance.all * found.level;
        is_done = is_done && found.fast <= tolerance.fast * found.level;
        bool extrapolates =
            may_extrapolate && !is_done && last_share > 0.0 && fabs(share - last_share) < STEADY * (1.0 - share);
        if (extrapolates) extrapolate(r, share);
        swap(r);
        before = extrapolates ? change : 0.0;
        last = extrapolates ? 0.0 : change;
        last_share = extrapolates ? 0.0 : share;
        if (is_done) break;
    }
}

void row_iteration_bounces(row_iteration *r, int further, bool (*may_go_on)(void *user)) {
    memset(r->B, 0, 3 * r->element_count * sizeof *r->B);
    for (r->count = 1; r->go_on(r->user); r->count++) {
        r->gather(r->user, r->B, r->next);
        const changes found = changes_of(r);
        take_residual(r, found.all, found.level);
        if (r->count > further || !may_go_on(r->user)) return;
        swap(r);
    }
}
