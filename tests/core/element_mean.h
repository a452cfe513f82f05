/* SPDX-License-Identifier: MIT
 * What is the mean of the closed form over an element, from two polygons as a test has them?
 */
#ifndef HEMIBAKE_TESTS_CORE_ELEMENT_MEAN_H
#define HEMIBAKE_TESTS_CORE_ELEMENT_MEAN_H

#include "factors/element_factor.h"

static inline factor_estimate element_mean(polygon_loop element, polygon_loop source, const factor_request *request) {
    facing f;
    if (!facing_create(&f, element, source, request->memory)) return factor_failed();
    factor_estimate out = element_factor(&f, request);
    facing_destroy(&f);
    return out;
}

#endif
