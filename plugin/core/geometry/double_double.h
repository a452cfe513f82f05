/* SPDX-License-Identifier: MIT
 * How does one compute with twice the digits of a double? A number is the unevaluated sum hi + lo, |lo| <= ulp(hi) / 2:
 * about 32 digits [Dekker71; Hida01]. Sums and products of two doubles are exact; every operation on pairs is good to
 * DD_EPSILON relative to its result (sums: to the larger operand where signs differ).
 *
 * Needs IEEE doubles without contraction, and numbers between 1e-140 and 1e140, or products lose their low half.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_DOUBLE_DOUBLE_H
#define HEMIBAKE_CORE_GEOMETRY_DOUBLE_DOUBLE_H

#include <math.h>

/* 2^-102: four roundings of a 106-bit number [Hida01, sec. 3]. */
#define DD_EPSILON 0x1p-102

typedef struct dd {
    double hi, lo;
} dd;

static inline dd dd_of(double a) {
    return (dd){ a, 0.0 };
}

/* |a| >= |b| or a = 0. */
static inline dd dd_quick_sum(double a, double b) {
    double s = a + b;
    return (dd){ s, b - (s - a) };
}

/* Exact [Knuth98, sec. 4.2.2]. */
static inline dd dd_two_sum(double a, double b) {
    double s = a + b, t = s - a;
    return (dd){ s, (a - (s - t)) + (b - t) };
}

/* Exact; halves of 26 bits multiply without rounding [Dekker71]. */
static inline dd dd_two_product(double a, double b) {
    const double split = 134217729.0; /* 2^27 + 1 */
    double p = a * b, ta = split * a, tb = split * b;
    double ah = ta - (ta - a), al = a - ah, bh = tb - (tb - b), bl = b - bh;
    return (dd){ p, ((ah * bh - p) + ah * bl + al * bh) + al * bl };
}

static inline dd dd_negate(dd a) {
    return (dd){ -a.hi, -a.lo };
}

static inline dd dd_add(dd a, dd b) {
    dd s = dd_two_sum(a.hi, b.hi), t = dd_two_sum(a.lo, b.lo);
    s = dd_quick_sum(s.hi, s.lo + t.hi);
    return dd_quick_sum(s.hi, s.lo + t.lo);
}

static inline dd dd_sub(dd a, dd b) {
    return dd_add(a, dd_negate(b));
}

static inline dd dd_mul(dd a, dd b) {
    dd p = dd_two_product(a.hi, b.hi);
    return dd_quick_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static inline dd dd_scale(dd a, double b) {
    return dd_mul(a, dd_of(b));
}

/* Long division, three digits of 53 bits. */
static inline dd dd_div(dd a, dd b) {
    double q0 = a.hi / b.hi;
    dd r = dd_sub(a, dd_scale(b, q0));
    double q1 = r.hi / b.hi;
    r = dd_sub(r, dd_scale(b, q1));
    return dd_add(dd_quick_sum(q0, q1), dd_of(r.hi / b.hi));
}

/* One step of Newton's from the double root; 0 for a <= 0. */
static inline dd dd_sqrt(dd a) {
    if (!(a.hi > 0.0)) return dd_of(0.0);
    double root = sqrt(a.hi);
    dd rest = dd_sub(a, dd_two_product(root, root));
    return dd_quick_sum(root, rest.hi / (2.0 * root));
}

static inline dd dd_dot(const dd a[3], const dd b[3]) {
    return dd_add(dd_add(dd_mul(a[0], b[0]), dd_mul(a[1], b[1])), dd_mul(a[2], b[2]));
}

static inline void dd_cross(dd out[3], const dd a[3], const dd b[3]) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = dd_sub(dd_mul(a[i], b[j]), dd_mul(a[j], b[i]));
    }
}

#endif
