/* SPDX-License-Identifier: MIT
 * How is the closed form evaluated for many points at once? Points go in blocks, edge after edge, each corner's ray
 * computed once. The loops over points are free of branches and calls, so that the compiler turns them into vector
 * code; they are compiled for several instruction sets and the machine picks one at run time. The portable version is
 * always among them. Contraction into fused multiply-adds is off for the whole project, so every version gives the same
 * bits.
 *
 * An edge's term is n . (R x e) = R . (e x n) times the angle over its sine (edge_angle.h); e x n is the same for all
 * points. Edges that nowhere take up more than a right angle, which are nearly all, need one root and two divisions.
 *
 * Tried, in million edges a second on one core (Xeon, portable / AVX2 / AVX-512; tests/bench/kernels):
 *   R_g x R_g+1 and atan2 with Cephes' rational function, edge after edge over all points    121 / 241 / 302
 *   half-angle tangent and a polynomial of degree 19                                         146 / 252 / 301
 *   what is here                                                                             220 / 330 / 348
 */
#include "geometry/edge_angle.h"
#include "geometry/polygon.h"

#include "base/target_clones.h"
#include "geometry/vec3.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifdef POLYGON_BATCH_PORTABLE
#define FOR_EACH_TARGET
#else
#define FOR_EACH_TARGET TARGET_CLONES("avx512f", "avx2", "default")
#endif

static const double ONE_OVER_TWO_PI = 0.159154943091895335769;
/* Points in a block. Four sets of rays and three of terms: 10 KiB, which leaves the first cache to others. */
enum { BLOCK = 64, LANES = 8 };

typedef struct rays {
    double x[BLOCK], y[BLOCK], z[BLOCK], inverse[BLOCK]; /* of the length; 0 for no length */
} rays;

typedef struct edge {
    double x, y, z;
    double wx, wy, wz; /* edge x normal */
    double nx, ny, nz; /* normal */
} edge;

static edge edge_between(const double from[3], const double to[3], const double normal[3]) {
    double e[3], w[3];
    vec3_sub(e, to, from);
    vec3_cross(w, e, normal);
    return (edge){ e[0], e[1], e[2], w[0], w[1], w[2], normal[0], normal[1], normal[2] };
}

static inline void set_rays(rays *restrict r, const double corner[3], const rays *restrict points, size_t lanes) {
    const double cx = corner[0], cy = corner[1], cz = corner[2];
    for (size_t i = 0; i < lanes; i++) {
        double x = cx - points->x[i], y = cy - points->y[i], z = cz - points->z[i];
        r->x[i] = x, r->y[i] = y, r->z[i] = z;
        double length = sqrt(x * x + y * y + z * z);
        r->inverse[i] = length > 0.0 ? 1.0 / length : 0.0;
    }
}

/* The terms n . Gamma as for angles up to a right one; cosine (times both lengths) tells where that is wrong. The
 * nearer end goes into the product: it has the smaller roundings. */
static inline void acute_terms(double *restrict terms, double *restrict cosine, const rays *restrict a,
                               const rays *restrict b, const edge *e, size_t lanes) {
    const double wx = e->wx, wy = e->wy, wz = e->wz;
    for (size_t i = 0; i < lanes; i++) {
        double c = a->x[i] * b->x[i] + a->y[i] * b->y[i] + a->z[i] * b->z[i];
        double inverse = a->inverse[i] * b->inverse[i];
        bool nearer = a->inverse[i] > b->inverse[i];
        double x = nearer ? a->x[i] : b->x[i], y = nearer ? a->y[i] : b->y[i], z = nearer ? a->z[i] : b->z[i];
        double height = x * wx + y * wy + z * wz;
        terms[i] = height * inverse * edge_angle_over_sine(fabs(c) * inverse);
        cosine[i] = c;
    }
}

static inline bool any_negative(const double *restrict values, size_t lanes) {
    uint64_t any = 0;
    for (size_t i = 0; i < lanes; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        any |= bits;
    }
    return any >> 63;
}

/* Where an edge takes up more than a right angle, the term is what a straight angle gives less the acute one. */
static inline void obtuse_terms(double *restrict terms, const double *restrict cosine, const rays *restrict a,
                                const rays *restrict b, const edge *e, size_t lanes) {
    const double ex = e->x, ey = e->y, ez = e->z, nx = e->nx, ny = e->ny, nz = e->nz;
    for (size_t i = 0; i < lanes; i++) {
        bool nearer = a->inverse[i] > b->inverse[i];
        double x = nearer ? a->x[i] : b->x[i], y = nearer ? a->y[i] : b->y[i], z = nearer ? a->z[i] : b->z[i];
        double cx = y * ez - z * ey, cy = z * ex - x * ez, cz = x * ey - y * ex;
        double sine = sqrt(cx * cx + cy * cy + cz * cz), height = nx * cx + ny * cy + nz * cz;
        double straight = height * (PI / (sine > 0.0 ? sine : 1.0));
        terms[i] = cosine[i] < 0.0 ? (sine > 0.0 ? straight - terms[i] : 0.0) : terms[i];
    }
}

FOR_EACH_TARGET
static void factor_block(polygon_loop loop, const double *normal, const rays *restrict points, size_t padded,
                         double *restrict sums) {
    size_t lanes = padded & ~(size_t)(LANES - 1);
    rays first, ends[2];
    double terms[BLOCK], cosine[BLOCK];
    set_rays(&first, loop.corner[0], points, lanes);
    const rays *a = &first, *b;
    for (size_t g = 0; g < loop.count; g++, a = b) {
        bool closes = g + 1 == loop.count;
        const double *to = closes ? loop.corner[0] : loop.corner[g + 1];
        if (!closes) set_rays(&ends[g & 1], to, points, lanes);
        b = closes ? &first : &ends[g & 1];
        edge e = edge_between(loop.corner[g], to, normal);
        acute_terms(terms, cosine, a, b, &e, lanes);
        if (any_negative(cosine, lanes)) obtuse_terms(terms, cosine, a, b, &e, lanes);
        for (size_t i = 0; i < lanes; i++) sums[i] += terms[i];
    }
}

void polygon_loop_factor_batch(polygon_loop loop, const double normal[3], const double *x, const double *y,
                               const double *z, size_t count, double *factors) {
    rays points;
    double sums[BLOCK];
    for (size_t begin = 0; loop.count > 0 && begin < count; begin += BLOCK) {
        size_t used = count - begin < BLOCK ? count - begin : BLOCK, padded = (used + LANES - 1) / LANES * LANES;
        for (size_t i = 0; i < padded; i++) {
            size_t k = begin + (i < used ? i : used - 1);
            points.x[i] = x[k], points.y[i] = y[k], points.z[i] = z[k], sums[i] = 0.0;
        }
        factor_block(loop, normal, &points, padded, sums);
        for (size_t i = 0; i < used; i++) factors[begin + i] -= ONE_OVER_TWO_PI * sums[i];
    }
}

void polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y, const double *z,
                          size_t count, double *factors) {
    polygon_loop_factor_batch(polygon_boundary(p), normal, x, y, z, count, factors);
}
