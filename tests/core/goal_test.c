/* SPDX-License-Identifier: MIT
 * Is a bake as fine as its goal asks for, and no finer? On a machine whose clock is ours, so that it is always as fast.
 */
#include "bake/goal.h"
#include "check.h"

enum { ATTEMPTS_MAX = 16 };

/* Bakes that take what they are told to: cost_s for each element of draft, to the power of the elements. By rows noise
 * falls as the root of the rays that a sample has, and what elements are too large for as a power of their number. */
typedef struct machine {
    double now, cost_s, exponent;
    double errors[5];                  /* of each quality, and a power between them */
    bool by_rows;                      /* or: */
    double noise, of_emitters, uneven; /* of draft */
    double falls, crowd;               /* crowd: a bake has at least so many elements of draft */
    int count;
    double size[ATTEMPTS_MAX]; /* of each attempt, in elements of draft */
    double cost[ATTEMPTS_MAX], error[ATTEMPTS_MAX];
    bake_options attempts[ATTEMPTS_MAX];
    bake_span spans[ATTEMPTS_MAX];
} machine;

static machine m;

static double clock_of_machine(void) {
    return m.now;
}

static bake_options resolved(bake_options o, double scale) {
    quality_resolve(&o, 1.0, scale);
    return o;
}

/* How many elements a square of 1 m2 is cut to. */
static double elements_of(bake_quality quality, double scale) {
    const bake_options o = resolved((bake_options){ .quality = quality }, scale);
    return 1.0 / (o.element_size * o.element_size);
}

static double error_between(double level) {
    int q = level < QUALITY_DRAFT ? QUALITY_DRAFT : (int)level;
    return q < QUALITY_REFERENCE ? m.errors[q] * pow(m.errors[q + 1] / m.errors[q], level - q) : m.errors[q];
}

static double outcome_of_rows(const bake_options *o, bake_outcome *out) {
    static const double SMOOTHED = 0.45;
    bake_options draft = resolved((bake_options){ .quality = QUALITY_DRAFT, .method = SOLVER_ROWS }, 0.0), now = *o;
    now.method = SOLVER_ROWS;
    now.fineness.elements = out->elements = fmax(now.fineness.elements, m.crowd);
    now = resolved(now, 0.0);
    double elements = pow(draft.element_size / now.element_size, 2.0), rays = now.rows_adaptive / draft.rows_adaptive;
    out->by_rows = true;
    out->ray_noise = m.noise * sqrt(elements / rays);
    out->emitter_noise = m.of_emitters * sqrt((double)draft.rows_emitter / now.rows_emitter);
    out->uneven = m.uneven * pow(elements, -m.falls);
    m.size[m.count] = elements;
    m.cost[m.count] = elements + rays;
    return hypot(SMOOTHED * hypot(out->ray_noise, out->emitter_noise), out->uneven);
}

static bool attempt(void *user, const bake_options *options, const bake_span *span, bake_outcome *out) {
    (void)user;
    if (m.count == ATTEMPTS_MAX) return false;
    if (m.by_rows) {
        out->error = outcome_of_rows(options, out);
    } else {
        const bake_options o = resolved(*options, span->scale);
        out->error = error_between(options->fineness.level > 0.0 ? options->fineness.level : options->quality);
        m.size[m.count] = 1.0 / (o.element_size * o.element_size) / elements_of(QUALITY_DRAFT, 0.0);
        m.cost[m.count] = pow(m.size[m.count], m.exponent);
    }
    m.error[m.count] = out->error;
    m.attempts[m.count] = *options;
    m.now += m.cost_s * m.cost[m.count];
    m.spans[m.count++] = *span;
    return true;
}

static double last_error(void) {
    return m.error[m.count - 1];
}

static void reach(bake_options options) {
    const goal g = { .options = options, .start_s = m.now, .clock = clock_of_machine, .attempt = attempt };
    goal_reach(&g);
}

static void each_quality_is_finer_than_the_one_before(void) {
    for (bake_quality q = QUALITY_MEDIUM; q <= QUALITY_REFERENCE; q++)
        CHECK(elements_of(q, 0.0) > 1.5 * elements_of(q - 1, 0.0));
    CHECK_NEAR(elements_of(QUALITY_DEFAULT, 0.0) / elements_of(QUALITY_MEDIUM, 0.0), 1.0, 1e-12);
    CHECK_NEAR(elements_of(QUALITY_HIGH, 0.5) / elements_of(QUALITY_HIGH, 0.0), 0.5, 1e-12);
    for (double size = 0.3; size < 18; size *= 1.7) {
        double scale;
        bake_quality q = quality_of_size(size, &scale);
        CHECK_NEAR(elements_of(q, scale) / elements_of(QUALITY_DRAFT, 0.0), size, 1e-9 * size);
    }
}

/* No number of a preset is left out: each quality has more rays of every kind than the one before, and less error. */
static void each_quality_has_more_rays_of_every_kind_than_the_one_before(void) {
    for (bake_quality q = QUALITY_MEDIUM; q <= QUALITY_REFERENCE; q++) {
        bake_options one = { .quality = q, .method = SOLVER_ROWS },
                     before = { .quality = q - 1, .method = SOLVER_ROWS };
        quality_resolve(&one, 1.0, 0.0);
        quality_resolve(&before, 1.0, 0.0);
        /* Of a sample, and there are more samples. */
        CHECK(before.rows_initial > 0 && one.rows_initial >= before.rows_initial && one.rows_initial < 1000);
        CHECK(before.rows_emitter > 0 && one.rows_emitter > before.rows_emitter && one.rows_emitter < 1000);
        CHECK(before.rows_adaptive > 0 && one.rows_adaptive > 2 * before.rows_adaptive);
        CHECK(q < QUALITY_HIGH ? one.rows_noise == 0.0 : one.rows_noise > 0.0);
        CHECK(q < QUALITY_REFERENCE || one.rows_noise < before.rows_noise);
        CHECK(one.element_size < before.element_size && one.decimate_error < before.decimate_error);
    }
}

/* Each would be noisier than those of the quality. Larger ones have as many in all. */
static void elements_that_are_asked_to_be_finer_have_as_many_rays_each(void) {
    bake_options usual = { .method = SOLVER_ROWS };
    quality_resolve(&usual, 2.0, 0.0);
    bake_options fine = { .method = SOLVER_ROWS, .element_size = usual.element_size / 3 },
                 coarse = { .method = SOLVER_ROWS, .element_size = usual.element_size * 3 };
    quality_resolve(&fine, 2.0, 0.0);
    quality_resolve(&coarse, 2.0, 0.0);
    CHECK_NEAR(fine.rows_adaptive / usual.rows_adaptive, 9.0, 1e-9);
    CHECK_NEAR(coarse.rows_adaptive, usual.rows_adaptive, 0.0);
}

static void a_quality_or_a_size_is_baked_as_it_is(void) {
    const bake_options asked[] = { { .quality = QUALITY_HIGH, .error_target = 1e-3, .time_limit_s = 5.0 },
                                   { .element_size = 0.1, .error_target = 1e-3 },
                                   { .patch_size = 0.1, .time_limit_s = 5.0 },
                                   { .quality = QUALITY_DEFAULT } };
    for (int i = 0; i < 4; i++) {
        m = (machine){ .now = 7.0, .cost_s = 1.0, .exponent = 1.8, .errors = { 1, 1, 1, 1, 1 } };
        reach(asked[i]);
        CHECK_EQUAL(m.count, 1);
        double until_s = m.attempts[0].cuts_latest.until_s, limit_s = asked[i].time_limit_s;
        CHECK(limit_s > 0.0 ? until_s > 7.0 && until_s < 7.0 + 0.5 * limit_s : until_s == 0.0);
        m.attempts[0].cuts_latest = asked[i].cuts_latest;
        CHECK(memcmp(&m.attempts[0], &asked[i], sizeof asked[i]) == 0);
        CHECK_NEAR(m.spans[0].start_s, 7.0, 0);
        CHECK(m.spans[0].low == 0.0 && m.spans[0].high == 1.0);
    }
}

/* A first bake that is good enough is the only one, coarser than draft where much is allowed; else the last one is
 * within a fifth of what is asked for where two bakes have said how errors fall, and within two fifths where one has
 * not; or it is reference. */
static void columns_are_as_fine_as_what_is_asked_for_and_no_finer(void) {
    for (double fall = 1.5; fall < 2.6; fall += 0.25)
        for (double target = 0.12; target > 1e-3; target *= 0.8) {
            m = (machine){ .cost_s = 1.0, .exponent = 1.8 };
            for (int q = 1; q <= QUALITY_REFERENCE; q++) m.errors[q] = 0.1 * pow(fall, 1 - q);
            reach((bake_options){ .error_target = target });
            CHECK(m.count > 0 && m.count < 6);
            CHECK_EQUAL(m.attempts[0].quality, QUALITY_DRAFT);
            CHECK(target > 0.05 ? m.size[0] < 0.5 : m.size[0] <= 1.0);
            CHECK(target > 0.02 || m.size[0] == 1.0);
            CHECK(last_error() <= target || m.attempts[m.count - 1].quality == QUALITY_REFERENCE);
            CHECK(m.count == 1 || last_error() > (m.count == 2 ? 0.6 : 0.8) * target);
            for (int k = 1; k < m.count; k++) CHECK(m.error[k] < m.error[k - 1]);
            for (int k = 1; k < m.count; k++) CHECK_NEAR(m.spans[k].low, m.spans[k - 1].high, 0);
        }
}

/* Between two qualities is all that makes one finer, and at a quality it is that. */
static void what_lies_between_two_qualities_is_between_them(void) {
    for (double level = QUALITY_DRAFT; level <= QUALITY_HIGH; level++) {
        const bake_options low = resolved((bake_options){ .quality = (bake_quality)level }, 0.0),
                           high = resolved((bake_options){ .quality = (bake_quality)level + 1 }, 0.0),
                           same = resolved((bake_options){ .fineness.level = level }, 0.0),
                           half = resolved((bake_options){ .fineness.level = level + 0.5 }, 0.0);
        CHECK(same.element_size == low.element_size && same.adapt_error == low.adapt_error);
        CHECK(same.unshot_target == low.unshot_target && same.hemicube == low.hemicube);
        CHECK(half.element_size < low.element_size && half.element_size > high.element_size);
        CHECK(half.patch_size < low.patch_size && half.patch_size > high.patch_size);
        CHECK(half.adapt_error < low.adapt_error && half.adapt_error > high.adapt_error);
        CHECK(half.decimate_error < low.decimate_error && half.decimate_error > high.decimate_error);
        CHECK(half.unshot_target < low.unshot_target && half.unshot_target > high.unshot_target);
        CHECK(half.hemicube > low.hemicube && half.hemicube < high.hemicube && half.hemicube % 2 == 0);
        CHECK(half.check_points > low.check_points && half.check_points < high.check_points);
    }
}

/* An estimate knows nothing of what stand-ins are off by. */
static void stand_ins_of_coarse_rows_are_no_coarser_than_those_of_draft(void) {
    const bake_options draft = resolved((bake_options){ .quality = QUALITY_DRAFT, .method = SOLVER_ROWS }, 0.0);
    for (double elements = 0.05; elements < 10.0; elements *= 2.0) {
        bake_options asked = { .fineness = { elements, 1.0, 1.0, 1.0 }, .error_target = 0.05, .method = SOLVER_ROWS };
        bake_options rows = resolved(asked, 0.0);
        CHECK_NEAR(rows.element_size * sqrt(elements) / draft.element_size, 1.0, 1e-12);
        CHECK_NEAR(quality_stand_in_size(&rows) / fmin(rows.element_size, draft.element_size), 1.0, 1e-12);
        asked.method = SOLVER_HYBRID;
        bake_options columns = resolved(asked, 0.0);
        CHECK(quality_stand_in_size(&columns) == columns.element_size);
    }
}

/* Many times as many triangles as elements are meant: up to ten times change nothing, from there on elements are those
 * that would be a tenth of them, but no finer than draft, which is coarser by up to a factor of sqrt(2). */
static void a_crowd_is_as_fine_as_costs_little(void) {
    static const struct {
        double meant, crowding, then, size;
    } all[] = { { 0.05, 1, 0.05, 1 },
                { 0.05, 10, 0.05, 1 },
                { 0.05, 40, 0.2, 0.5 },
                { 0.05, 180, 0.9, 0.23570226 },
                { 0.05, 200, 1, 0.31622777 },
                { 0.05, 1e6, 1, 0.31622777 },
                { 1, 2.5, 1, 1 },
                { 1, 4, 1, 1.26491106 },
                { 2, 1e6, 2, 1.41421356 },
                { 0, 1e6, 0, 1.41421356 } };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        bake_options o = { .element_size = 1.0, .fineness.elements = all[i].meant };
        quality_fit_crowd(&o, all[i].crowding);
        CHECK_NEAR(o.fineness.elements, all[i].then, 1e-7);
        CHECK_NEAR(o.element_size, all[i].size, 1e-7);
    }
}

/* Light between houses changes from one to the next: elements are half as large again at most as what a quarter of the
 * area is of, but no smaller than half of what they were, and a goal that is coarser than draft stays what it is. */
static void elements_are_not_much_larger_than_what_there_is_much_of(void) {
    static const struct {
        double meant, common, size;
    } all[] = { { 0, INFINITY, 1 }, { 0, 1, 1 }, { 0, 0.6, 0.9 }, { 0, 1e-3, 0.5 }, { 0.5, 1e-3, 1 } };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        bake_options o = { .element_size = 1.0, .fineness.elements = all[i].meant };
        quality_fit_common(&o, all[i].common);
        CHECK_NEAR(o.element_size, all[i].size, 1e-7);
    }
    bake_options packed = { .element_size = 1.0 };
    quality_fit_crowd(&packed, 40.0);
    quality_fit_common(&packed, 1e-3);
    CHECK_NEAR(packed.element_size, sqrt(2.0), 1e-7);
}

/* Where a bake had more elements than it was asked for, the next goes on from there. */
static void what_a_crowd_had_is_what_the_next_goes_on_from(void) {
    m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = 0.5, .uneven = 0.04, .crowd = 0.5 };
    reach((bake_options){ .error_target = 0.02 });
    CHECK_EQUAL(m.count, 2);
    CHECK(m.attempts[0].fineness.elements < 0.1 && m.attempts[1].fineness.elements > 4.0);
}

static void columns_that_time_is_too_short_for_are_not_begun(void) {
    m = (machine){ .cost_s = 1.0, .exponent = 0.0, .errors = { 1, 1, 1, 1, 1 } };
    reach((bake_options){ .error_target = 1e-3, .time_limit_s = 16.0 });
    /* One second each. The next is a quality and a half finer, and may cost 15 times as much; 15 are left after the
     * first and 14 after the second. */
    CHECK_EQUAL(m.count, 2);
    CHECK_NEAR(m.attempts[1].time_limit_s, 15.0, 1e-12);
}

/* Whatever the error comes from: below what is asked for, by a third at most, and after few bakes, which cost less than
 * what the last does. */
static void rows_are_as_fine_as_what_is_asked_for_and_no_finer(void) {
    static const double kinds[][3] = { { 0.03, 0.0, 0.004 }, { 0.005, 0.05, 0.004 }, { 0.01, 0.0, 0.02 } };
    for (int i = 0; i < 3; i++)
        for (double falls = 0.3; falls < 0.65; falls += 0.1)
            for (double target = 0.05; target > 4e-3; target *= 0.7) {
                double before = 0.0;
                m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = falls };
                m.noise = kinds[i][0], m.of_emitters = kinds[i][1], m.uneven = kinds[i][2];
                reach((bake_options){ .error_target = target });
                const bake_fineness last = m.attempts[m.count - 1].fineness, most = quality_finest();
                bool ended = last.elements == most.elements || last.emitter_rays == most.emitter_rays;
                CHECK(m.count > 0 && m.count < 9 && (last_error() <= target || ended));
                CHECK(m.count == 1 || last_error() > 0.5 * target);
                for (int k = 0; k + 1 < m.count; k++) before += m.cost[k];
                CHECK(before < 2.5 * m.cost[m.count - 1]);
            }
}

/* Where emitters are what is noisy, more rays go to them and hardly more to all else. */
static void what_is_refined_is_what_the_error_comes_from(void) {
    m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = 0.5, .noise = 0.001, .of_emitters = 0.1, .uneven = 1e-4 };
    reach((bake_options){ .error_target = 0.02 });
    CHECK(m.count > 1);
    CHECK(m.attempts[1].fineness.emitter_rays > 3.0 && m.attempts[1].fineness.rays == m.attempts[0].fineness.rays);
    m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = 0.5, .noise = 0.001, .of_emitters = 0.0, .uneven = 0.02 };
    reach((bake_options){ .error_target = 0.02 });
    CHECK(m.count > 1);
    CHECK(m.attempts[1].fineness.elements > 3.0 * m.attempts[0].fineness.elements);
    CHECK(m.attempts[1].fineness.emitter_rays == 1.0);
}

static void rows_that_never_get_there_end_with_the_finest(void) {
    m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = 0.0, .noise = 1.0, .of_emitters = 1.0, .uneven = 1.0 };
    reach((bake_options){ .error_target = 1e-3 });
    const bake_fineness last = m.attempts[m.count - 1].fineness, most = quality_finest();
    CHECK(m.count < ATTEMPTS_MAX);
    CHECK(last.elements == most.elements && last.rays == most.rays && last.emitter_rays == most.emitter_rays);
}

static void rows_that_time_is_too_short_for_are_not_begun(void) {
    m = (machine){ .cost_s = 1.0, .by_rows = true, .falls = 0.5, .noise = 0.03, .uneven = 0.01 };
    reach((bake_options){ .error_target = 4e-3, .time_limit_s = 1.0 });
    CHECK(m.now <= 1.0 && m.count > 0 && last_error() > 4e-3);
    CHECK_NEAR(m.attempts[0].time_limit_s, 1.0, 1e-12);
}

static void time_is_used_and_not_exceeded(void) {
    for (double limit = 2.0; limit < 500.0; limit *= 3) {
        m = (machine){ .cost_s = 4.0, .exponent = 1.6, .errors = { 1, 1, 1, 1, 1 } };
        reach((bake_options){ .time_limit_s = limit });
        CHECK(m.count > 1);
        /* What is left is less than 1.3 times what the last bake took, which is most of the rest. */
        CHECK(m.now <= limit && (m.now > 0.4 * limit || m.size[m.count - 1] > 17.9));
        for (int k = 1; k < m.count; k++) {
            CHECK(m.size[k] > m.size[k - 1] && m.size[k] <= 3.0 * m.size[k - 1] * (1 + 1e-9));
            CHECK(m.attempts[k].time_limit_s < limit);
            CHECK(m.attempts[k].cuts_latest.until_s < m.spans[k].start_s + 0.5 * m.attempts[k].time_limit_s);
        }
    }
}

static void who_stops_gets_no_further_bake(void) {
    static const volatile int stop = 1;
    for (int i = 0; i < 2; i++) {
        m = (machine){ .cost_s = 1.0, .exponent = 1.8, .errors = { 1, 1, 1, 1, 1 } };
        const goal g = { .options = { .error_target = i ? 1e-3 : 0.0, .time_limit_s = 1000.0 },
                         .clock = clock_of_machine,
                         .stop = &stop,
                         .attempt = attempt };
        goal_reach(&g);
        CHECK_EQUAL(m.count, 1);
    }
}

int main(void) {
    RUN(each_quality_is_finer_than_the_one_before);
    RUN(each_quality_has_more_rays_of_every_kind_than_the_one_before);
    RUN(elements_that_are_asked_to_be_finer_have_as_many_rays_each);
    RUN(a_quality_or_a_size_is_baked_as_it_is);
    RUN(columns_are_as_fine_as_what_is_asked_for_and_no_finer);
    RUN(what_lies_between_two_qualities_is_between_them);
    RUN(stand_ins_of_coarse_rows_are_no_coarser_than_those_of_draft);
    RUN(a_crowd_is_as_fine_as_costs_little);
    RUN(elements_are_not_much_larger_than_what_there_is_much_of);
    RUN(what_a_crowd_had_is_what_the_next_goes_on_from);
    RUN(columns_that_time_is_too_short_for_are_not_begun);
    RUN(rows_are_as_fine_as_what_is_asked_for_and_no_finer);
    RUN(what_is_refined_is_what_the_error_comes_from);
    RUN(rows_that_never_get_there_end_with_the_finest);
    RUN(rows_that_time_is_too_short_for_are_not_begun);
    RUN(time_is_used_and_not_exceeded);
    RUN(who_stops_gets_no_further_bake);
    return check_end();
}
