/* SPDX-License-Identifier: MIT
 * Which checks does a test program make, and what does a failing one print? Its operands, to the last digit.
 *
 * A test is a function whose name is a sentence; RUN(name) calls it. The program returns check_end().
 */
#ifndef HEMIBAKE_TESTS_CHECK_H
#define HEMIBAKE_TESTS_CHECK_H

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Threads of a test check too. */
#ifdef __cplusplus
#include <atomic>
typedef std::atomic<int> check_counter;
#else
typedef _Atomic int check_counter;
#endif

static check_counter check_failures, check_count;
static int check_tests;
static const char *check_test_name = "";

/* A test that checked nothing, as one whose loops ran over nothing, has failed. */
#define RUN(test)                                                                                                      \
    do {                                                                                                               \
        int check_before = check_count;                                                                                \
        check_test_name = #test;                                                                                       \
        check_tests++;                                                                                                 \
        test();                                                                                                        \
        if (check_count == check_before) {                                                                             \
            check_failures++;                                                                                          \
            fprintf(stderr, "%s: %s checked nothing\n", __FILE__, #test);                                              \
        }                                                                                                              \
    } while (0)

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        check_count++;                                                                                                 \
        if (!(condition)) {                                                                                            \
            check_failures++;                                                                                          \
            fprintf(stderr, "%s:%d: %s: %s is false\n", __FILE__, __LINE__, check_test_name, #condition);              \
        }                                                                                                              \
    } while (0)

/* |value - expected| <= tolerance; false for NaN. */
#define CHECK_NEAR(value, expected, tolerance)                                                                         \
    do {                                                                                                               \
        double check_v = (value), check_e = (expected), check_t = (tolerance);                                         \
        check_count++;                                                                                                 \
        if (!(fabs(check_v - check_e) <= check_t)) {                                                                   \
            check_failures++;                                                                                          \
            fprintf(stderr, "%s:%d: %s: %s = %.17g, expected %.17g within %.3g (off by %.3g)\n", __FILE__, __LINE__,   \
                    check_test_name, #value, check_v, check_e, check_t, fabs(check_v - check_e));                      \
        }                                                                                                              \
    } while (0)

#define CHECK_EQUAL(value, expected)                                                                                   \
    do {                                                                                                               \
        long long check_v = (long long)(value), check_e = (long long)(expected);                                       \
        check_count++;                                                                                                 \
        if (check_v != check_e) {                                                                                      \
            check_failures++;                                                                                          \
            fprintf(stderr, "%s:%d: %s: %s = %lld, expected %lld\n", __FILE__, __LINE__, check_test_name, #value,      \
                    check_v, check_e);                                                                                 \
        }                                                                                                              \
    } while (0)

#define CHECK_TEXT(value, expected)                                                                                    \
    do {                                                                                                               \
        const char *check_v = (value);                                                                                 \
        check_count++;                                                                                                 \
        if (strcmp(check_v, (expected)) != 0) {                                                                        \
            check_failures++;                                                                                          \
            fprintf(stderr, "%s:%d: %s: %s = \"%s\", expected \"%s\"\n", __FILE__, __LINE__, check_test_name, #value,  \
                    check_v, (expected));                                                                              \
        }                                                                                                              \
    } while (0)

/* A program that checked nothing has failed. */
static inline int check_end(void) {
    int count = check_count, failures = check_failures;
    printf("%d tests, %d checks, %d failures\n", check_tests, count, failures);
    return failures > 0 || count == 0 ? 1 : 0;
}

#endif
