/* SPDX-License-Identifier: MIT
 * How is the closed form evaluated for many points at once? The loop over points is the inner one and free of branches
 * and calls, so that the compiler turns it into vector code; it is compiled for several instruction sets and the
 * machine picks one at run time. The portable version is always among them.
 *
 * Contraction into fused multiply-adds is off for the whole project, so every version gives the same bits.
 */
#include "formfactor/polygon.h"

#include <math.h>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define FOR_EACH_TARGET __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FOR_EACH_TARGET
#endif

static const double ONE_OVER_TWO_PI = 0.159154943091895335769;

/* atan2(y, x) for y >= 0, x any, not both 0. Cody-Waite style: the smaller over the larger is at most 1; above
 * tan(pi/8) it is turned by pi/4; then the rational approximation of Cephes (Moshier 1989), |error| < 2e-16. */
static inline double atan2_upper(double y, double x) {
    const double p0 = -8.750608600031904122785e-1, p1 = -1.615753718733365076637e1, p2 = -7.500855792314704667340e1;
    const double p3 = -1.228866684490136173410e2, p4 = -6.485021904942025371773e1;
    const double q0 = 2.485846490142306297962e1, q1 = 1.650270098316988542046e2, q2 = 4.328810604912902668951e2;
    const double q3 = 4.853903996359136964868e2, q4 = 1.945506571482613964425e2;
    const double tan_pi_8 = 0.414213562373095048802, pi_4 = 0.785398163397448309616;
    const double pi_2 = 1.57079632679489661923, pi = 3.14159265358979323846;
    double ax = fabs(x);
    double high = ax > y ? ax : y, low = ax > y ? y : ax;
    double turned = low > tan_pi_8 * high ? 1.0 : 0.0;
    double t = (low - turned * high) / (high + turned * low);
    double z = t * t;
    double p = (((p0 * z + p1) * z + p2) * z + p3) * z + p4;
    double q = ((((z + q0) * z + q1) * z + q2) * z + q3) * z + q4;
    double angle = turned * pi_4 + (t + t * z * (p / q));
    angle = y > ax ? pi_2 - angle : angle;
    return x < 0.0 ? pi - angle : angle;
}

FOR_EACH_TARGET
static void add_edge(const double *restrict c0, const double *restrict c1, const double *restrict n,
                     const double *restrict x, const double *restrict y, const double *restrict z, size_t count,
                     double *restrict factors) {
    const double c0x = c0[0], c0y = c0[1], c0z = c0[2], c1x = c1[0], c1y = c1[1], c1z = c1[2];
    const double nx = n[0], ny = n[1], nz = n[2];
    for (size_t i = 0; i < count; i++) {
        double ax = c0x - x[i], ay = c0y - y[i], az = c0z - z[i];
        double bx = c1x - x[i], by = c1y - y[i], bz = c1z - z[i];
        double cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
        double sine = sqrt(cx * cx + cy * cy + cz * cz), cosine = ax * bx + ay * by + az * bz;
        double safe = sine > 0.0 ? sine : 1.0;
        double ratio = atan2_upper(sine, cosine) / safe;
        double term = (nx * cx + ny * cy + nz * cz) * ratio;
        factors[i] -= ONE_OVER_TWO_PI * (sine > 0.0 ? term : 0.0);
    }
}

void polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y, const double *z,
                          size_t count, double *factors) {
    for (int g = 0; g < p->count; g++)
        add_edge(p->corner[g], p->corner[(g + 1) % p->count], normal, x, y, z, count, factors);
}
