/* SPDX-License-Identifier: MIT
 * Do the rows of form-factor matrices close, do known factors come out within their reported errors, and are odd
 * polygons handled as documented?
 */
#include "check.h"
#include "factors/factor_matrix.h"

#include <stdint.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

enum { POLYGONS_MAX = 16 };

typedef struct matrix_case {
    matrix_polygon polygons[POLYGONS_MAX];
    size_t count, unconverged;
    double K[POLYGONS_MAX * POLYGONS_MAX], error[POLYGONS_MAX * POLYGONS_MAX];
    uint64_t evaluations;
} matrix_case;

static void add(matrix_case *m, const double corner[][3], int count) {
    CHECK_EQUAL(matrix_polygon_set(&m->polygons[m->count++], corner, count), POLYGON_PLANAR);
}

static void compute(matrix_case *m, double tolerance, unsigned threads) {
    jobs *j = jobs_create(threads);
    factor_matrix_setup setup = { m->polygons, m->count, tolerance, 400000, j };
    m->unconverged = factor_matrix(&setup, m->K, m->error, &m->evaluations);
    jobs_destroy(j);
}

static double row_sum(const matrix_case *m, size_t i) {
    double sum = 0.0;
    for (size_t j = 0; j < m->count; j++) sum += m->K[i * m->count + j];
    return sum / m->polygons[i].area[0];
}

/* The six faces of the image of the unit cube under x -> origin + X a + Y b + Z c, seen from inside. */
static void add_box(matrix_case *m, const double a[3], const double b[3], const double c[3]) {
    static const int faces[6][4] = { { 0, 1, 3, 2 }, { 4, 6, 7, 5 }, { 0, 4, 5, 1 },
                                     { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 5, 7, 3 } };
    for (int f = 0; f < 6; f++) {
        double corner[4][3];
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                int v = faces[f][i];
                corner[i][k] = (v & 1 ? a[k] : 0) + (v & 2 ? b[k] : 0) + (v & 4 ? c[k] : 0);
            }
        add(m, (const double(*)[3])corner, 4);
    }
}

static void the_cube_has_its_known_factors_and_closes(void) {
    static matrix_case m;
    const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 }, z[3] = { 0, 0, 1 };
    add_box(&m, x, y, z);
    compute(&m, 2e-7, 2);
    CHECK_EQUAL(m.unconverged, 0);
    for (size_t i = 0; i < 6; i++) {
        /* Issue's figure for closed scenes: 1e-6. */
        CHECK_NEAR(row_sum(&m, i), 1.0, 1e-6);
        for (size_t j = 0; j < 6; j++) {
            double expected = i == j ? 0.0 : (i ^ 1) == j ? 0.19982489569838746 : 0.20004377607540316;
            CHECK_NEAR(m.K[i * 6 + j], expected, 2e-7);
            CHECK(fabs(m.K[i * 6 + j] - expected) <= m.error[i * 6 + j] + 1e-15);
            CHECK(m.error[i * 6 + j] <= 2e-7);
        }
    }
}

static double random_unit(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

static void sheared_boxes_close(void) {
    uint64_t state = 7;
    for (int n = 0; n < 6; n++) {
        static matrix_case m;
        double axis[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
        for (int i = 0; i < 9; i++) axis[i / 3][i % 3] += 0.8 * (random_unit(&state) - 0.5);
        memset(&m, 0, sizeof m);
        add_box(&m, axis[0], axis[1], axis[2]);
        compute(&m, 2e-7, 2);
        for (size_t i = 0; i < 6; i++) CHECK_NEAR(row_sum(&m, i), 1.0, 1e-6);
    }
}

/* An L of three unit cells: six walls, three floors, three ceilings. */
static void add_l_room(matrix_case *m) {
    static const double plan[6][2] = { { 0, 0 }, { 2, 0 }, { 2, 1 }, { 1, 1 }, { 1, 2 }, { 0, 2 } };
    static const double cells[3][4] = { { 0, 0, 1, 1 }, { 1, 0, 2, 1 }, { 0, 1, 1, 2 } };
    for (int i = 0; i < 6; i++) {
        const double *p = plan[i], *q = plan[(i + 1) % 6];
        const double wall[4][3] = { { p[0], p[1], 0 }, { p[0], p[1], 1 }, { q[0], q[1], 1 }, { q[0], q[1], 0 } };
        add(m, wall, 4);
    }
    for (int i = 0; i < 3; i++) {
        const double *c = cells[i];
        const double floor[4][3] = { { c[0], c[1], 0 }, { c[2], c[1], 0 }, { c[2], c[3], 0 }, { c[0], c[3], 0 } };
        const double ceiling[4][3] = { { c[0], c[1], 1 }, { c[0], c[3], 1 }, { c[2], c[3], 1 }, { c[2], c[1], 1 } };
        add(m, floor, 4);
        add(m, ceiling, 4);
    }
}

static void an_l_shaped_room_closes_round_its_corner(void) {
    static matrix_case m;
    add_l_room(&m);
    compute(&m, 1e-5, 2);
    for (size_t i = 0; i < 12; i++) {
        CHECK_NEAR(row_sum(&m, i), 1.0, 1e-4);
        /* What looks away or lies in one plane sees nothing. */
        CHECK_NEAR(m.K[i * 12 + i], 0.0, 0.0);
    }
    /* The ends of the two arms: each hides behind the inner corner from the other. */
    CHECK_NEAR(m.K[1 * 12 + 4], 0.0, 1e-12);
}

static void threads_change_no_bit(void) {
    static matrix_case one, two;
    add_l_room(&one);
    add_l_room(&two);
    compute(&one, 1e-4, 1);
    compute(&two, 1e-4, 2);
    CHECK(memcmp(one.K, two.K, sizeof one.K) == 0);
    CHECK_EQUAL(one.evaluations, two.evaluations);
}

static void a_wall_between_two_squares_leaves_nothing(void) {
    static matrix_case m;
    const double floor[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
    const double roof[4][3] = { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } };
    const double wall[4][3] = { { -1, -1, .5 }, { 2, -1, .5 }, { 2, 2, .5 }, { -1, 2, .5 } };
    add(&m, floor, 4);
    add(&m, roof, 4);
    add(&m, wall, 4);
    m.polygons[2].obstruction = true;
    compute(&m, 1e-6, 1);
    CHECK_NEAR(m.K[1], 0.0, 0.0);
    CHECK_NEAR(m.K[2], 0.0, 0.0);
}

static void half_a_wall_in_the_plane_of_symmetry_leaves_what_its_mirror_leaves(void) {
    /* The two halves of a wall hide complementary parts: what passes each sums to what passes none. */
    static matrix_case m;
    double sum = 0.0, whole = 0.19982489569838746, estimate = 0.0;
    for (int side = 0; side < 2; side++) {
        const double floor[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
        const double roof[4][3] = { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } };
        const double split = 0.3, x0 = side ? split : -3, x1 = side ? 4 : split;
        const double wall[4][3] = { { x0, -3, .5 }, { x1, -3, .5 }, { x1, 4, .5 }, { x0, 4, .5 } };
        memset(&m, 0, sizeof m);
        add(&m, floor, 4);
        add(&m, roof, 4);
        add(&m, wall, 4);
        m.polygons[2].obstruction = true;
        compute(&m, 1e-6, 1);
        sum += m.K[1];
        estimate += m.error[1];
    }
    CHECK_NEAR(sum, whole, 2e-6);
    CHECK(fabs(sum - whole) <= estimate);
}

static void odd_polygons_are_named_and_never_give_nan(void) {
    static matrix_case m;
    const double bow_tie[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1.5, 1, 0 } };
    const double bent[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0.2 }, { 0, 1, 0 } };
    const double dart[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.2, 0.2, 0 }, { 0, 1, 0 } };
    const double line[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 } };
    const double not_finite[3][3] = { { 0, 0, 0 }, { 1, 0, (double)NAN }, { 0, 1, 0 } };
    const double roof[4][3] = { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } };
    CHECK_EQUAL(matrix_polygon_set(&m.polygons[0], bow_tie, 4), POLYGON_CROSSING);
    CHECK_EQUAL(matrix_polygon_set(&m.polygons[1], bent, 4), POLYGON_NOT_PLANAR);
    CHECK_EQUAL(matrix_polygon_set(&m.polygons[2], dart, 4), POLYGON_CONCAVE);
    CHECK_EQUAL(matrix_polygon_set(&m.polygons[3], line, 4), POLYGON_NO_AREA);
    CHECK_EQUAL(matrix_polygon_set(&m.polygons[4], not_finite, 3), POLYGON_NOT_FINITE);
    CHECK_EQUAL(m.polygons[1].part_count, 2);
    CHECK_EQUAL(m.polygons[2].part_count, 2);
    /* The dart's two triangles: 0.2 m2 in all. */
    CHECK_NEAR(m.polygons[2].area[0] + m.polygons[2].area[1], 0.2, 1e-15);
    m.count = 5;
    add(&m, roof, 4);
    compute(&m, 1e-4, 1);
    for (size_t i = 0; i < m.count * m.count; i++) CHECK(isfinite(m.K[i]) && m.K[i] >= 0.0);
    CHECK(m.K[2 * m.count + 5] > 0.0);
}

/* ---- oracles ---- */

/* The factor from a small area to a parallel rectangle whose corner is right above it, sides a, b, distance c
 * (the double integral of cos cos / (pi r2), as in hemicube_weights.h). Odd in a and in b. */
static double corner_factor(double a, double b, double c) {
    double x = sqrt(a * a + c * c), y = sqrt(b * b + c * c);
    return (a / x * atan(b / x) + b / y * atan(a / y)) / (2 * PI);
}

/* To the rectangle low .. high at height c, from the origin of a plane that looks up; nothing where it is inside out.
 */
static double rectangle_factor(double x0, double x1, double y0, double y1, double c) {
    if (x0 >= x1 || y0 >= y1) return 0.0;
    return corner_factor(x1, y1, c) - corner_factor(x0, y1, c) - corner_factor(x1, y0, c) + corner_factor(x0, y0, c);
}

/* Gauss-Legendre, 8 points on [-1, 1] (Abramowitz & Stegun 1964, table 25.4). */
static const double GAUSS_X[4] = { 0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623 };
static const double GAUSS_W[4] = { 0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626 };

typedef double (*plane_function)(const void *user, double x, double y);

/* Over breaks[0] .. breaks[n-1] in both directions, 4 panels between breaks: 1e-12 for integrands that are smooth
 * between them on the scale of a panel. */
static double gauss(plane_function f, const void *user, const double *x_breaks, int nx, const double *y_breaks,
                    int ny) {
    double sum = 0.0;
    for (int i = 0; i < 4 * (nx - 1); i++)
        for (int j = 0; j < 4 * (ny - 1); j++) {
            double hx = (x_breaks[i / 4 + 1] - x_breaks[i / 4]) / 8, hy = (y_breaks[j / 4 + 1] - y_breaks[j / 4]) / 8;
            double mx = x_breaks[i / 4] + (2 * (i % 4) + 1) * hx, my = y_breaks[j / 4] + (2 * (j % 4) + 1) * hy;
            for (int p = 0; p < 8; p++)
                for (int q = 0; q < 8; q++)
                    sum += hx * hy * GAUSS_W[p / 2] * GAUSS_W[q / 2] *
                           f(user, mx + (p % 2 ? -hx : hx) * GAUSS_X[p / 2], my + (q % 2 ? -hy : hy) * GAUSS_X[q / 2]);
        }
    return sum;
}

/* ---- displaced squares with an obstruction between them ---- */

/* Receiver 0..1 squared at z = 0; light 0..1 squared at z = 1, displaced by (dx, dy); between them at z = 1/2 the
 * square low..high. Its shadow on the light from (x, y) is 2 low - x .. 2 high - x. */
typedef struct obstructed {
    double dx, dy, low[2], high[2];
} obstructed;

static double obstructed_factor(const void *user, double x, double y) {
    const obstructed *o = user;
    double x0 = o->dx, x1 = o->dx + 1, y0 = o->dy, y1 = o->dy + 1;
    return rectangle_factor(x0 - x, x1 - x, y0 - y, y1 - y, 1) -
           rectangle_factor(fmax(x0, 2 * o->low[0] - x) - x, fmin(x1, 2 * o->high[0] - x) - x,
                            fmax(y0, 2 * o->low[1] - y) - y, fmin(y1, 2 * o->high[1] - y) - y, 1);
}

/* Where the shadow's borders pass the light's, as x varies over 0..1: 2 b - x = l. Sorted, with both ends. */
static int obstructed_breaks(const obstructed *o, int axis, double breaks[6]) {
    double displaced = axis ? o->dy : o->dx, edges[2] = { displaced, displaced + 1 };
    int n = 0;
    breaks[n++] = 0;
    for (int i = 0; i < 4; i++) {
        double x = 2 * (i / 2 ? o->high : o->low)[axis] - edges[i % 2];
        if (x > 0 && x < 1) breaks[n++] = x;
    }
    breaks[n++] = 1;
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && breaks[k] < breaks[k - 1]; k--) {
            double swap = breaks[k];
            breaks[k] = breaks[k - 1], breaks[k - 1] = swap;
        }
    return n;
}

static double obstructed_exact(const obstructed *o) {
    double x_breaks[6], y_breaks[6];
    int nx = obstructed_breaks(o, 0, x_breaks), ny = obstructed_breaks(o, 1, y_breaks);
    return gauss(obstructed_factor, o, x_breaks, nx, y_breaks, ny);
}

static void set_square(double corner[4][3], const double low[2], const double high[2], double z, bool up) {
    for (int i = 0; i < 4; i++) {
        int k = up ? i : 3 - i;
        corner[i][0] = k == 1 || k == 2 ? high[0] : low[0], corner[i][1] = k >= 2 ? high[1] : low[1], corner[i][2] = z;
    }
}

static void displaced_squares_with_an_obstruction_match_their_closed_form(void) {
    const obstructed cases[] = {
        { 0, 0, { 0.25, 0.25 }, { 0.75, 0.75 } },     { 0, 0, { 0.4, 0.4 }, { 0.6, 0.6 } },
        { 0.3, 0.2, { 0.25, 0.25 }, { 0.75, 0.75 } }, { 0.5, -0.7, { 0.3, -0.2 }, { 0.9, 0.45 } },
        { 1.5, 0, { 0.5, 0 }, { 1.2, 0.6 } },         { 0, 0, { 0.45, -3 }, { 0.5, 3 } }
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static matrix_case m;
        const obstructed *o = &cases[i];
        const double zero[2] = { 0, 0 }, one[2] = { 1, 1 }, low[2] = { o->dx, o->dy },
                     high[2] = { o->dx + 1, o->dy + 1 };
        double corner[4][3], before = INFINITY, exact = obstructed_exact(o);
        for (double tolerance = 1e-2; tolerance > 5e-6; tolerance /= 10) {
            memset(&m, 0, sizeof m);
            set_square(corner, zero, one, 0, true);
            add(&m, (const double(*)[3])corner, 4);
            set_square(corner, low, high, 1, false);
            add(&m, (const double(*)[3])corner, 4);
            set_square(corner, o->low, o->high, 0.5, true);
            add(&m, (const double(*)[3])corner, 4);
            m.polygons[2].obstruction = true;
            compute(&m, tolerance, 1);
            CHECK_EQUAL(m.unconverged, 0);
            CHECK_NEAR(m.K[1], exact, m.error[1]);
            CHECK(m.error[1] <= tolerance * (1 + 1e-9) && m.error[1] <= before);
            before = m.error[1];
        }
        printf("obstruction %zu: F %.8f, exact %.8f, reported %.1e\n", i, m.K[1], exact, m.error[1]);
    }
}

int main(void) {
    RUN(the_cube_has_its_known_factors_and_closes);
    RUN(sheared_boxes_close);
    RUN(an_l_shaped_room_closes_round_its_corner);
    RUN(threads_change_no_bit);
    RUN(a_wall_between_two_squares_leaves_nothing);
    RUN(half_a_wall_in_the_plane_of_symmetry_leaves_what_its_mirror_leaves);
    RUN(odd_polygons_are_named_and_never_give_nan);
    RUN(displaced_squares_with_an_obstruction_match_their_closed_form);
    return check_end();
}
