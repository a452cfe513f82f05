/* SPDX-License-Identifier: MIT
 * Do the rows of form-factor matrices close, do known factors come out within their reported errors, and are odd
 * polygons handled as documented?
 */
#include "check.h"
#include "factors/factor_matrix.h"

#include <stdint.h>
#include <stdlib.h>

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

int main(void) {
    RUN(the_cube_has_its_known_factors_and_closes);
    RUN(sheared_boxes_close);
    RUN(an_l_shaped_room_closes_round_its_corner);
    RUN(threads_change_no_bit);
    RUN(a_wall_between_two_squares_leaves_nothing);
    RUN(half_a_wall_in_the_plane_of_symmetry_leaves_what_its_mirror_leaves);
    RUN(odd_polygons_are_named_and_never_give_nan);
    return check_end();
}
