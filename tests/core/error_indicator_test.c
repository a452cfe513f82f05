/* SPDX-License-Identifier: MIT
 * Does the indicator say by how much linear interpolation is off, where it is and where it is not?
 */
#include "adapt/error_indicator.h"
#include "check.h"
#include "reconstruct/vertex_errors.h"
#include "room.h"

/* A unit square of n x n elements in the plane z = 0, with a radiance that is the same in all bands. */
typedef struct field {
    room room;
    uint32_t *node;
    double *radiance, *fault, *levels, level; /* the sum of levels */
} field;

static void measure_uneven(field *f, int n, double emission, double (*radiance)(double x, double y), double variance) {
    room *r = &f->room;
    room_start(r);
    room_quad(r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, room_material(r, 0.5, emission),
              1, n);
    room_finish(r);
    const mesh *m = &r->mesh;
    f->node = calloc(ELEMENT_PLACES * m->element_count, sizeof *f->node);
    f->radiance = malloc(3 * m->sample_count * sizeof *f->radiance);
    f->fault = malloc(m->element_count * sizeof *f->fault);
    f->levels = malloc(m->element_count * sizeof *f->levels);
    for (size_t e = 0; e < m->element_count; e++)
        memcpy(f->node + ELEMENT_PLACES * e, m->elements[e].corner, 4 * sizeof *f->node);
    for (size_t i = 0; i < 3 * m->sample_count; i++) f->radiance[i] = radiance(m->x[i / 3], m->y[i / 3]);
    float *uneven = malloc(m->sample_count * sizeof *uneven);
    for (size_t s = 0; s < m->sample_count; s++) uneven[s] = (float)variance;
    const error_indicator_input in = { .mesh = m,
                                       .node = f->node,
                                       .node_count = m->vertex_count,
                                       .radiance = f->radiance,
                                       .weight = m->sample_area,
                                       .uneven = variance > 0.0 ? uneven : NULL };
    CHECK(error_indicator_measure(&in, f->fault, f->levels));
    free(uneven);
    f->level = 0.0;
    for (size_t e = 0; e < m->element_count; e++) f->level += f->levels[e];
}

static void measure(field *f, int n, double emission, double (*radiance)(double x, double y)) {
    measure_uneven(f, n, emission, radiance, 0.0);
}

static void release(field *f) {
    free(f->node);
    free(f->radiance);
    free(f->fault);
    free(f->levels);
    room_free(&f->room);
}

/* Root mean square of what element e is off by, of one band. */
static double off_by(const field *f, size_t e) {
    return sqrt(f->fault[e] / f->room.mesh.elements[e].area / 3);
}

static double plane(double x, double y) {
    return 1 + 2 * x - 3 * y;
}

static double parabola(double x, double y) {
    (void)y;
    return x * x;
}

static double step(double x, double y) {
    (void)y;
    return x < 0.5 ? 1 : 2;
}

static void what_is_linear_needs_no_finer_elements(void) {
    field f;
    measure(&f, 6, 0.0, plane);
    /* Slopes are sums of four numbers of size 1, divided by edges of a sixth. */
    for (size_t e = 0; e < f.room.mesh.element_count; e++) CHECK_NEAR(off_by(&f, e), 0.0, 1e-12);
    /* int (1 + 2x - 3y)^2 = 1 + 4/3 + 3 + 2 - 3 - 3 in each band; on samples, less the squares' spread over a quarter
     * of an element and its mean's over the element. */
    CHECK_NEAR(f.level / 3, 4.0 / 3, 13.0 / 12 / 36 + 1e-9);
    release(&f);
}

/* A step between samples looks like a slope, and of an element without neighbours nobody says that it is none; where
 * the dark is a third of the bright or more it is taken for a slope. */
static double dim_or_bright(double x, double y) {
    (void)y;
    return x < 0.5 ? 0.5 : 2;
}

static void a_step_within_an_element_alone_is_seen(void) {
    field f;
    measure(&f, 1, 0.0, dim_or_bright);
    /* The plane through the samples is off by 0.5 - 2 x of a step of 1 to either side: sqrt(1 / 12) of it, rms. */
    CHECK_NEAR(off_by(&f, 0), 1.5 * sqrt(1.0 / 12), 0.05);
    release(&f);
    measure(&f, 1, 0.0, step);
    CHECK_NEAR(off_by(&f, 0), 0.0, 1e-12);
    release(&f);
    measure(&f, 2, 0.0, dim_or_bright);
    CHECK(off_by(&f, 0) < 0.5);
    release(&f);
}

/* Of y = x^2 the best line over h is off by 0.0745 h^2, and by no more than a half more when its ends must meet. */
static void a_parabola_is_off_by_the_square_of_the_edge(void) {
    for (int n = 8; n <= 16; n *= 2) {
        field f;
        int inside = 0;
        measure(&f, n, 0.0, parabola);
        for (size_t e = 0; e < f.room.mesh.element_count; e++) {
            size_t across = e % (size_t)n;
            if (across == 0 || across + 1 == (size_t)n) continue;
            inside++;
            CHECK(off_by(&f, e) * n * n > 0.0745 && off_by(&f, e) * n * n < 1.5 * 0.0745);
        }
        CHECK_EQUAL(inside, n * (n - 2));
        release(&f);
    }
}

/* Beside a step each of two rows of elements shows half of it as a ramp: 1/12 of its square on the mean. */
static void a_step_is_off_in_the_elements_beside_it_alone(void) {
    field f;
    measure(&f, 8, 0.0, step);
    for (size_t e = 0; e < f.room.mesh.element_count; e++) {
        bool beside = e % 8 == 3 || e % 8 == 4;
        CHECK_NEAR(off_by(&f, e) * off_by(&f, e), beside ? 1.0 / 12 : 0.0, beside ? 0.01 : 1e-12);
    }
    release(&f);
}

static double even(double x, double y) {
    (void)x, (void)y;
    return 1;
}

/* What samples are the means of: rho / pi = 0.5 / pi of its root is missing from what is shown, but where it is as much
 * as a slope from sample to sample has within each, which is shown. */
static void what_differs_within_samples_is_missing(void) {
    field f;
    measure_uneven(&f, 4, 0.0, even, 0.04);
    for (size_t e = 0; e < f.room.mesh.element_count; e++) CHECK_NEAR(off_by(&f, e), 0.2 * 0.5 / PI, 1e-6);
    release(&f);
    const double within = (2 * 2 + 3 * 3) / 12.0 / 64 * (PI * PI / 0.25); /* samples are an eighth wide */
    measure_uneven(&f, 4, 0.0, plane, within);
    for (size_t e = 0; e < f.room.mesh.element_count; e++) CHECK_NEAR(off_by(&f, e), 0.0, 1e-3);
    release(&f);
    measure_uneven(&f, 4, 0.0, plane, 2 * within);
    CHECK_NEAR(off_by(&f, 5), sqrt(within) * 0.5 / PI, 1e-3);
    release(&f);
}

static void emitters_are_as_they_are(void) {
    field f;
    measure(&f, 4, 1.0, parabola);
    for (size_t e = 0; e < f.room.mesh.element_count; e++) CHECK_NEAR(f.fault[e], 0.0, 0);
    CHECK_NEAR(f.level, 0.0, 0);
    release(&f);
}

/* The mean square over the area is the square of the estimate, and it lies along the step. */
static void the_estimate_is_spread_to_where_the_error_is(void) {
    field f;
    measure(&f, 8, 0.0, step);
    const mesh *m = &f.room.mesh;
    const fit_samples samples = { .radiance = f.radiance, .weight = m->sample_area, .nodes = f.node };
    f.room.mesh.node_count = m->vertex_count;
    double *errors = vertex_errors_find(m, &samples, 0.04), square = 0.0;
    CHECK(errors);
    for (size_t e = 0; errors && e < m->element_count; e++)
        for (int k = 0; k < 4; k++) square += pow(errors[m->elements[e].corner[k]], 2) * m->elements[e].area / 4;
    CHECK_NEAR(sqrt(square), 0.04, 1e-9); /* exact but for rounding: nodes have the means of elements */
    for (size_t v = 0; errors && v < m->vertex_count; v++) {
        double x = fabs(m->vertices[3 * v] - 0.5);
        CHECK(x < 0.13 ? errors[v] > 0.04 : errors[v] < 1e-9);
    }
    block_free(errors);
    release(&f);
}

static void what_is_linear_has_no_error_at_its_vertices_and_an_emitter_none_at_all(void) {
    field f;
    measure(&f, 4, 1.0, parabola);
    const fit_samples samples = { .radiance = f.radiance, .weight = f.room.mesh.sample_area, .nodes = f.node };
    f.room.mesh.node_count = f.room.mesh.vertex_count;
    double *errors = vertex_errors_find(&f.room.mesh, &samples, 0.04);
    for (size_t v = 0; errors && v < f.room.mesh.vertex_count; v++) CHECK_NEAR(errors[v], 0.0, 0);
    block_free(errors);
    release(&f);
}

int main(void) {
    RUN(what_is_linear_needs_no_finer_elements);
    RUN(a_step_within_an_element_alone_is_seen);
    RUN(a_parabola_is_off_by_the_square_of_the_edge);
    RUN(a_step_is_off_in_the_elements_beside_it_alone);
    RUN(what_differs_within_samples_is_missing);
    RUN(emitters_are_as_they_are);
    RUN(the_estimate_is_spread_to_where_the_error_is);
    RUN(what_is_linear_has_no_error_at_its_vertices_and_an_emitter_none_at_all);
    return check_end();
}
