/* SPDX-License-Identifier: MIT
 * Is a bake as fine as its goal asks for, and no finer? On a machine whose clock is ours, so that it is always as fast.
 */
#include "bake/goal.h"
#include "check.h"

enum { ATTEMPTS_MAX = 16 };

/* Bakes that take what they are told to: cost_s for each element of draft, to the power of the elements. */
typedef struct machine {
    double now, cost_s, exponent;
    double errors[5]; /* of each quality ... */
    bool by_rows;     /* ... or the first of draft, and a power of the size */
    double falls;
    int count;
    double size[ATTEMPTS_MAX]; /* of each attempt, in elements of draft */
    bake_options attempts[ATTEMPTS_MAX];
    bake_span spans[ATTEMPTS_MAX];
} machine;

static machine m;

static double clock_of_machine(void) {
    return m.now;
}

/* How many elements a square of 1 m2 is cut to. */
static double elements_of(bake_quality quality, double scale) {
    bake_options o = { .quality = quality };
    quality_resolve(&o, 1.0, scale);
    return 1.0 / (o.element_size * o.element_size);
}

static bool attempt(void *user, const bake_options *options, const bake_span *span, bake_outcome *best) {
    (void)user;
    if (m.count == ATTEMPTS_MAX) return false;
    double scale = span->of_rows_alone && !m.by_rows ? 0.0 : span->scale;
    double size = elements_of(options->quality, scale) / elements_of(QUALITY_DRAFT, 0.0);
    m.size[m.count] = size;
    m.attempts[m.count] = *options;
    m.spans[m.count++] = *span;
    m.now += m.cost_s * pow(size, m.exponent);
    best->error = m.by_rows ? m.errors[0] * pow(size, -m.falls) : m.errors[options->quality];
    best->by_rows = m.by_rows;
    return true;
}

static double last_error(void) {
    return m.errors[0] * pow(m.size[m.count - 1], -m.falls);
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

static void a_quality_or_a_size_is_baked_as_it_is(void) {
    const bake_options asked[] = { { .quality = QUALITY_HIGH, .error_target = 1e-3, .time_limit_s = 5.0 },
                                   { .element_size = 0.1, .error_target = 1e-3 },
                                   { .patch_size = 0.1, .time_limit_s = 5.0 },
                                   { .quality = QUALITY_DEFAULT } };
    for (int i = 0; i < 4; i++) {
        m = (machine){ .now = 7.0, .cost_s = 1.0, .exponent = 1.8, .errors = { 1, 1, 1, 1, 1 } };
        reach(asked[i]);
        CHECK_EQUAL(m.count, 1);
        CHECK(memcmp(&m.attempts[0], &asked[i], sizeof asked[i]) == 0);
        CHECK_NEAR(m.spans[0].start_s, 7.0, 0);
        CHECK(m.spans[0].low == 0.0 && m.spans[0].high == 1.0);
    }
}

/* The estimate is trusted to a fifth. */
static void qualities_are_climbed_until_the_error_is_a_fifth_below_what_is_asked_for(void) {
    static const struct {
        double target;
        int count;
    } cases[] = { { 0.13, 1 }, { 0.12, 2 }, { 0.03, 3 }, { 0.02, 4 }, { 1e-6, 4 } };
    for (int i = 0; i < 5; i++) {
        m = (machine){ .cost_s = 1.0, .exponent = 1.8, .errors = { 1, 0.1, 0.05, 0.02, 0.01 } };
        reach((bake_options){ .error_target = cases[i].target });
        CHECK_EQUAL(m.count, cases[i].count);
        for (int k = 0; k < m.count; k++) CHECK_EQUAL(m.attempts[k].quality, QUALITY_DRAFT + k);
        for (int k = 1; k < m.count; k++) CHECK_NEAR(m.spans[k].low, m.spans[k - 1].high, 0);
    }
}

static void a_quality_that_time_is_too_short_for_is_not_begun(void) {
    m = (machine){ .cost_s = 1.0, .exponent = 0.0, .errors = { 1, 1, 1, 1, 1 } };
    reach((bake_options){ .error_target = 1e-3, .time_limit_s = 8.5 });
    /* One second each. After two 6.5 are left, which is enough for one that costs six times as much; after three not.
     */
    CHECK_EQUAL(m.count, 3);
    CHECK_NEAR(m.attempts[2].time_limit_s, 6.5, 1e-12);
}

/* Whichever way their errors fall: within a fifth of what is asked for where two bakes have said how they fall, and
 * within two fifths where one has not; and what led there costs less than twice what the last bake does. */
static void rows_are_as_fine_as_what_is_asked_for_and_no_finer(void) {
    for (double falls = 0.3; falls < 0.75; falls += 0.2)
        for (double target = 0.1; target > 5e-3; target *= 0.7) {
            double before = 0.0;
            m = (machine){ .cost_s = 1.0, .exponent = 1.0, .errors = { 0.01 }, .by_rows = true, .falls = falls };
            reach((bake_options){ .error_target = target });
            CHECK(m.count > 0 && last_error() <= target);
            CHECK(m.count == 1 || last_error() > (m.count == 2 ? 0.6 : 0.8) * target);
            for (int k = 0; k < m.count; k++) CHECK(m.spans[k].of_rows_alone && (k == 0 || m.size[k] > m.size[k - 1]));
            for (int k = 0; k + 1 < m.count; k++) before += m.size[k];
            CHECK(before < 2.0 * m.size[m.count - 1]);
        }
}

static void rows_that_never_get_there_end_with_reference(void) {
    m = (machine){ .cost_s = 1.0, .exponent = 1.0, .errors = { 0.01 }, .by_rows = true, .falls = 0.0 };
    reach((bake_options){ .error_target = 1e-3 });
    CHECK(m.count < ATTEMPTS_MAX);
    CHECK_NEAR(m.size[m.count - 1], elements_of(QUALITY_REFERENCE, 0.0) / elements_of(QUALITY_DRAFT, 0.0), 1e-9);
    CHECK_EQUAL(m.attempts[m.count - 1].quality, QUALITY_REFERENCE);
}

static void rows_that_time_is_too_short_for_are_not_begun(void) {
    m = (machine){ .cost_s = 1.0, .exponent = 1.0, .errors = { 0.01 }, .by_rows = true, .falls = 0.5 };
    reach((bake_options){ .error_target = 4e-3, .time_limit_s = 2.0 });
    CHECK(m.now <= 2.0 && m.count > 0 && last_error() > 4e-3);
    CHECK_NEAR(m.attempts[0].time_limit_s, 2.0, 1e-12);
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
    RUN(a_quality_or_a_size_is_baked_as_it_is);
    RUN(qualities_are_climbed_until_the_error_is_a_fifth_below_what_is_asked_for);
    RUN(a_quality_that_time_is_too_short_for_is_not_begun);
    RUN(rows_are_as_fine_as_what_is_asked_for_and_no_finer);
    RUN(rows_that_never_get_there_end_with_reference);
    RUN(rows_that_time_is_too_short_for_are_not_begun);
    RUN(time_is_used_and_not_exceeded);
    RUN(who_stops_gets_no_further_bake);
    return check_end();
}
