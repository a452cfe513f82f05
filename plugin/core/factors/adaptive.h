/* SPDX-License-Identifier: MIT
 * How is a form factor integrated to a requested tolerance? Globally adaptive: the piece of the domain with the largest
 * error estimate is split, until the sum of the estimates is small enough [Piessens83, QAG]. Three kinds of domains use
 * it: triangles of an element (element_factor.c), of one in shadow (shadow_integral.c), and stretches of an outline
 * (polygon_pair.c).
 */
#ifndef HEMIBAKE_CORE_FACTORS_ADAPTIVE_H
#define HEMIBAKE_CORE_FACTORS_ADAPTIVE_H

#include "base/block.h"

/* What is asked for: |error| <= max(absolute, relative |value|). Zero = default: relative 1e-6 where both are zero, a
 * million evaluations. */
typedef struct factor_request {
    double relative, absolute;
    size_t evaluations_max;
    allocator *memory; /* NULL: the C library */
} factor_request;

typedef struct factor_estimate {
    double value;
    double error;       /* estimated, absolute; roundings included */
    size_t evaluations; /* of the integrand */
    bool converged;     /* error is within the request */
} factor_estimate;

/* Of what ran out of memory. */
static inline factor_estimate factor_failed(void) {
    return (factor_estimate){ 0.0, 1.0, 0, false };
}

enum { ADAPTIVE_PLACE = 12, ADAPTIVE_CHILDREN = 4 };

/* A part of the domain; what place means is the integrand's business. */
typedef struct adaptive_piece {
    double value, error;
    double rounding; /* of the value: does not shrink by splitting */
    double place[ADAPTIVE_PLACE];
} adaptive_piece;

typedef struct adaptive_rule {
    /* Sets value, error and rounding; may note in place what split needs to know. */
    void (*evaluate)(void *user, adaptive_piece *piece);
    /* Writes the places of the parts and returns how many they are. */
    int (*split)(void *user, const double place[ADAPTIVE_PLACE], double parts[ADAPTIVE_CHILDREN][ADAPTIVE_PLACE]);
    size_t cost;       /* evaluations of the integrand in one piece */
    size_t split_cost; /* those that split makes beside its parts' */
    bool is_dear;      /* an evaluation costs more than summing all pieces: no piece is split in vain */
    void *user;
} adaptive_rule;

/* scale times the integral over the pieces places[0 .. count). Not converged, with what it has, when it runs out of
 * evaluations or memory. */
factor_estimate adaptive_integrate(const adaptive_rule *rule, const double (*places)[ADAPTIVE_PLACE], size_t count,
                                   double scale, const factor_request *request);

/* An estimate of the error of the better of two rules, from their difference and from how much the integrand varies
 * (the integral of its distance from its mean): not less than the difference, which is the error of the worse rule, and
 * far more where the difference is not small beside the variation [Piessens83, sec. 2.2.1]. The power of that source
 * for differences of less than 1e-7 of the variation is left out: it saves a tenth of the points, and left estimates
 * below the error in 18 instead of 2 of 400,000 stretches. */
double adaptive_error(double difference, double variation);

#endif
