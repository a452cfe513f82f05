/* SPDX-License-Identifier: MIT
 * Do vertex colours come out as close to the samples as linear interpolation can be?
 */
#include "check.h"
#include "reconstruct/fit_parts.h"
#include "reconstruct/fit_solve.h"
#include "reconstruct/vertex_fit.h"

#include <stdlib.h>

enum { SIDE = 8 };

/* How far the smoothness term of vertex_fit.c, 2e-3 of the data's weight, may pull a vertex aside, relative to what the
 * field changes over an element. A corner of the sheet feels it most: its samples weigh 0.19 of an element there, so
 * two edges pull by 2e-3 / 0.19 = 1 % each. Away from the rim the pulls of a linear field cancel. */
static const double SMOOTHED = 0.03, SMOOTHED_INSIDE = 0.002;

typedef enum cut { QUADS, TRIANGLES, ALTERNATING } cut; /* alternating: diagonals meet in every other vertex */

typedef struct sheet {
    arena memory;
    double *vertices;
    uint32_t *nodes;
    mesh mesh;
    double *radiance, *weight;
    bool *emits; /* NULL: none does */
    size_t node_count;
} sheet;

static void add_element(sheet *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    t->mesh.elements[t->mesh.element_count++] = (element){ .corner = { a, b, c, d } };
}

/* SIDE x SIDE cells of the unit square: quads, or two triangles each. A crease at x = 1/2 gives each half its own
 * colour nodes. */
static void make_sheet(sheet *t, cut how, bool crease) {
    size_t vertices = (SIDE + 1) * (SIDE + 1);
    memset(t, 0, sizeof *t);
    t->vertices = arena_alloc(&t->memory, 3 * vertices, sizeof *t->vertices);
    t->mesh.elements = arena_alloc(&t->memory, 2 * SIDE * SIDE, sizeof *t->mesh.elements);
    t->mesh.patches = arena_alloc(&t->memory, 1, sizeof *t->mesh.patches);
    for (size_t v = 0; v < vertices; v++) {
        t->vertices[3 * v] = (double)(v % (SIDE + 1)) / SIDE;
        t->vertices[3 * v + 1] = (double)(v / (SIDE + 1)) / SIDE;
    }
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            uint32_t a = y * (SIDE + 1) + x, b = a + 1, d = a + SIDE + 1, c = d + 1;
            if (how == ALTERNATING && (x + y) % 2) {
                add_element(t, a, b, d, NO_INDEX);
                add_element(t, b, c, d, NO_INDEX);
            } else if (how != QUADS) {
                add_element(t, a, b, c, NO_INDEX);
                add_element(t, a, c, d, NO_INDEX);
            } else {
                add_element(t, a, b, c, d);
            }
        }
    t->mesh.vertices = t->vertices;
    t->mesh.vertex_count = vertices;
    t->mesh.patch_count = 1;
    t->mesh.patches[0] = (patch){ .corner = { 0, SIDE, (uint32_t)vertices - 1, (uint32_t)vertices - 1 - SIDE },
                                  .element_count = (uint32_t)t->mesh.element_count };
    if (!mesh_measure(&t->mesh, &t->memory)) abort();
    t->nodes = arena_alloc(&t->memory, ELEMENT_PLACES * t->mesh.element_count, sizeof *t->nodes);
    t->radiance = arena_alloc(&t->memory, 3 * t->mesh.sample_count, sizeof *t->radiance);
    t->weight = arena_alloc(&t->memory, t->mesh.sample_count, sizeof *t->weight);
    t->node_count = crease ? 2 * vertices : vertices;
    for (size_t e = 0; e < t->mesh.element_count; e++)
        for (int i = 0; i < 4; i++) {
            uint32_t v = t->mesh.elements[e].corner[i];
            bool right = t->mesh.x[t->mesh.elements[e].first_sample] > 0.5;
            t->nodes[ELEMENT_PLACES * e + (size_t)i] =
                v == NO_INDEX ? NO_INDEX : v + (crease && right ? (uint32_t)vertices : 0);
        }
    for (size_t s = 0; s < t->mesh.sample_count; s++) t->weight[s] = t->mesh.sample_area[s];
}

/* Three different planes over the square, positive everywhere. */
static double field(int band, double x, double y) {
    static const double slope_x[3] = { 2, -1, 0.5 }, slope_y[3] = { 1, 0.5, -2 };
    return 3 + slope_x[band] * x + slope_y[band] * y;
}

static void fill(sheet *t, double (*f)(int, double, double)) {
    for (size_t s = 0; s < t->mesh.sample_count; s++)
        for (int c = 0; c < 3; c++) t->radiance[3 * s + (size_t)c] = f(c, t->mesh.x[s], t->mesh.y[s]);
}

static bool fit(sheet *t, vertex_fit_result *out) {
    vertex_fit_input in = { .mesh = &t->mesh,
                            .node = t->nodes,
                            .node_count = t->node_count,
                            .radiance = t->radiance,
                            .emits = t->emits,
                            .weight = t->weight };
    bool ok = vertex_fit(&in, out);
    CHECK(ok);
    return ok;
}

/* ---- interpolation ---- */

/* Where a place of the reference element is. */
static void coordinates(int corners, int place, double at[2]) {
    static const double quad[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } },
                        three[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
    const double *a = corners == 4 ? quad[place % 4] : three[place % 4];
    const double *b = corners == 4 ? quad[(place + 1) % 4] : three[(place % 4 + 1) % 3];
    for (int k = 0; k < 2; k++) at[k] = place < 4 ? a[k] : (a[k] + b[k]) / 2;
}

static double signed_area(const double p[3][2]) {
    return ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])) / 2;
}

/* Every combination of hanging vertices: triangles that turn the same way, none without area, and that cover all. */
static void triangles_cover_an_element(void) {
    for (int corners = 3; corners <= 4; corners++)
        for (int hung = 0; hung < 1 << corners; hung++)
            for (int diagonal = 0; diagonal < 2; diagonal++) {
                element e = { .corner = { 0, 1, 2, corners == 4 ? 3 : NO_INDEX }, .hanging = (uint8_t)hung };
                uint8_t triangle[ELEMENT_TRIANGLES_MAX][3];
                int count = element_triangles(&e, diagonal, triangle), hanging = 0;
                double area = 0.0;
                for (int k = 0; k < corners; k++) hanging += hung >> k & 1;
                CHECK_EQUAL(count, corners + hanging - 2);
                for (int i = 0; i < count; i++) {
                    double p[3][2];
                    for (int k = 0; k < 3; k++) coordinates(corners, triangle[i][k], p[k]);
                    CHECK(signed_area(p) > 0.1);
                    area += signed_area(p);
                }
                CHECK_NEAR(area, corners == 4 ? 1.0 : 0.5, 0);
            }
}

/* At any point, the weights are positive and give the point back. */
static void weights_interpolate(void) {
    for (int corners = 3; corners <= 4; corners++)
        for (int hung = 0; hung < 1 << corners; hung++)
            for (int k = 0; k < corners; k++) {
                element e = { .corner = { 0, 1, 2, corners == 4 ? 3 : NO_INDEX }, .hanging = (uint8_t)hung };
                double at[2], w[3], x = 0, y = 0;
                uint8_t place[3];
                element_sample_place(corners, k, at);
                element_locate(&e, 0, at[0], at[1], place, w);
                for (int i = 0; i < 3; i++) {
                    double p[2];
                    coordinates(corners, place[i], p);
                    CHECK(w[i] >= -1e-15);
                    x += w[i] * p[0], y += w[i] * p[1];
                }
                CHECK_NEAR(x, at[0], 4e-16);
                CHECK_NEAR(y, at[1], 4e-16);
            }
}

/* ---- fits ---- */

/* Over the vertices that are at least so far from the rim. */
static double worst_at_vertices(const sheet *t, const vertex_fit_result *r, double (*f)(int, double, double),
                                double inside) {
    double worst = 0.0;
    for (size_t e = 0; e < t->mesh.element_count; e++)
        for (int i = 0; i < element_corner_count(&t->mesh.elements[e]); i++) {
            const double *p = t->vertices + 3 * (size_t)t->mesh.elements[e].corner[i];
            if (fmin(fmin(p[0], 1 - p[0]), fmin(p[1], 1 - p[1])) < inside) continue;
            for (int c = 0; c < 3; c++) {
                double x = r->radiance[3 * (size_t)t->nodes[ELEMENT_PLACES * e + (size_t)i] + (size_t)c];
                worst = fmax(worst, fabs(x - f(c, p[0], p[1])));
            }
        }
    return worst;
}

static void a_linear_field_comes_back_on_quads_and_triangles(void) {
    static const char *const names[] = { "quads", "triangles", "alternating triangles" };
    for (int how = 0; how < 3; how++) {
        sheet t;
        vertex_fit_result r;
        make_sheet(&t, (cut)how, false);
        fill(&t, field);
        if (fit(&t, &r)) {
            double worst = worst_at_vertices(&t, &r, field, 0), inner = worst_at_vertices(&t, &r, field, 2.0 / SIDE);
            printf("linear field on %s: rim off by up to %.2g, inside %.2g, residual %.2g\n", names[how], worst, inner,
                   r.residual);
            /* The field changes by 3 over the sheet. */
            CHECK_NEAR(worst, 0.0, SMOOTHED * 3 / SIDE);
            CHECK_NEAR(inner, 0.0, SMOOTHED_INSIDE * 3 / SIDE);
            /* Relative to a field of about 3, and the rim is a few of its many samples. */
            CHECK_NEAR(r.residual, 0.0, SMOOTHED / SIDE);
            CHECK(r.iterations > 0 && r.iterations < 100);
        }
        vertex_fit_free(&r);
        arena_free(&t.memory);
    }
}

static double rising(int band, double x, double y) {
    (void)band;
    return 1 + x + y;
}

static double falling(int band, double x, double y) {
    (void)band;
    return 2 + x - y;
}

static void quads_are_cut_along_the_level_lines_of_the_light(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, false);
    /* x + y is the same along the diagonal from corner 1 (1, 0) to corner 3 (0, 1), x - y along the other. */
    double (*const fields[2])(int, double, double) = { falling, rising };
    for (int diagonal = 0; diagonal < 2; diagonal++) {
        fill(&t, fields[diagonal]);
        if (fit(&t, &r)) {
            int other = 0;
            for (size_t e = 0; e < t.mesh.element_count; e++) other += r.diagonal[e] != diagonal;
            CHECK_EQUAL(other, 0);
            /* Both cuts reproduce the field, which changes by 2 over the sheet. */
            CHECK_NEAR(worst_at_vertices(&t, &r, fields[diagonal], 0), 0.0, SMOOTHED * 2 / SIDE);
            CHECK_NEAR(worst_at_vertices(&t, &r, fields[diagonal], 2.0 / SIDE), 0.0, SMOOTHED_INSIDE * 2 / SIDE);
        }
        vertex_fit_free(&r);
    }
    arena_free(&t.memory);
}

static double constant(int band, double x, double y) {
    (void)x, (void)y;
    return band == 0 ? 1.0 : band == 1 ? 1000.0 : 0.0;
}

static void a_constant_stays_the_same_constant(void) {
    for (int how = 0; how < 3; how++) {
        sheet t;
        vertex_fit_result r;
        make_sheet(&t, (cut)how, false);
        fill(&t, constant);
        if (fit(&t, &r))
            for (size_t v = 0; v < t.node_count; v++) {
                /* Smoothness has no quarrel with a constant: what is left is the target of the solver, 1e-7, and
                 * matrices of floats, 6e-8, some tens of them. */
                CHECK_NEAR(r.radiance[3 * v], 1.0, 3e-6);
                CHECK_NEAR(r.radiance[3 * v + 1] / 1000.0, 1.0, 3e-6);
                CHECK_NEAR(r.radiance[3 * v + 2], 0.0, 0);
            }
        vertex_fit_free(&r);
        arena_free(&t.memory);
    }
}

static double step(int band, double x, double y) {
    (void)band, (void)y;
    return x > 0.5 ? 10.0 : 1.0;
}

static void a_crease_stays_hard(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, true);
    fill(&t, step);
    if (fit(&t, &r)) {
        size_t vertices = t.mesh.vertex_count;
        for (size_t y = 0; y <= SIDE; y++) {
            size_t at_crease = y * (SIDE + 1) + SIDE / 2;
            /* Both halves are constants that share no node; see above. */
            CHECK_NEAR(r.radiance[3 * at_crease], 1.0, 3e-6);
            CHECK_NEAR(r.radiance[3 * (at_crease + vertices)], 10.0, 3e-5);
        }
        CHECK_NEAR(r.residual, 0.0, 3e-6);
    }
    vertex_fit_free(&r);
    arena_free(&t.memory);
    /* Without a crease the same light is blurred over an element. */
    make_sheet(&t, QUADS, false);
    fill(&t, step);
    if (fit(&t, &r)) CHECK(r.residual > 0.05);
    vertex_fit_free(&r);
    arena_free(&t.memory);
}

static void samples_without_weight_are_not_listened_to(void) {
    sheet t;
    vertex_fit_result clean, spoilt;
    make_sheet(&t, QUADS, false);
    fill(&t, field);
    /* A block of 3 x 3 elements is buried: its samples are dark and weigh nothing. */
    for (uint32_t y = 2; y < 5; y++)
        for (uint32_t x = 3; x < 6; x++)
            for (uint32_t k = 0; k < 4; k++) t.weight[t.mesh.elements[y * SIDE + x].first_sample + k] = 0.0;
    bool ok = fit(&t, &clean);
    for (size_t s = 0; s < t.mesh.sample_count; s++)
        for (int c = 0; t.weight[s] == 0.0 && c < 3; c++) t.radiance[3 * s + (size_t)c] = 0.0;
    if (fit(&t, &spoilt) && ok) {
        double worst = 0.0, off = 0.0;
        for (size_t v = 0; v < 3 * t.node_count; v++) worst = fmax(worst, fabs(clean.radiance[v] - spoilt.radiance[v]));
        /* The diagonals of the spoilt block are chosen anew, and that is all that may differ: with no weight on them
         * they enter no equation. */
        CHECK_NEAR(worst, 0.0, 1e-12);
        for (size_t v = 0; v < t.node_count; v++)
            off = fmax(off, fabs(spoilt.radiance[3 * v] - field(0, t.vertices[3 * v], t.vertices[3 * v + 1])));
        /* Inside the block smoothness alone carries on what is around it, and of a plane it makes a plane. */
        CHECK_NEAR(off, 0.0, SMOOTHED * 3 / SIDE);
    }
    vertex_fit_free(&clean);
    vertex_fit_free(&spoilt);
    arena_free(&t.memory);
}

static double spike(int band, double x, double y) {
    (void)band;
    return x < 0.2 && y < 0.2 ? 100.0 : 0.0;
}

static void no_vertex_goes_below_zero(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, false);
    fill(&t, spike);
    if (fit(&t, &r)) {
        double least = INFINITY, most = 0.0;
        for (size_t v = 0; v < 3 * t.node_count; v++)
            least = fmin(least, r.radiance[v]), most = fmax(most, r.radiance[v]);
        /* Least squares undershoots beside a spike; what is shown does not. */
        CHECK_NEAR(least, 0.0, 0);
        CHECK(most > 50.0 && most < 200.0);
    }
    vertex_fit_free(&r);
    arena_free(&t.memory);
}

static double curved(int band, double x, double y) {
    (void)band;
    return 1 + x * x + 2 * y * y;
}

static void least_squares_beats_what_averages_of_neighbours_give(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, false);
    fill(&t, curved);
    if (fit(&t, &r)) {
        /* h^2 / 8 times a second derivative of at most 4 is the error of interpolation, relative to a field above 1;
         * the fit spreads it to both sides. */
        CHECK(r.residual < 4.0 / (8 * SIDE * SIDE) / 2);
        CHECK(r.residual > 1e-5);
    }
    vertex_fit_free(&r);
    arena_free(&t.memory);
}

static void no_halo_rings_along_a_step(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, false);
    fill(&t, step);
    if (fit(&t, &r)) {
        double least = INFINITY, most = 0.0;
        for (size_t v = 0; v < t.node_count; v++)
            least = fmin(least, r.radiance[3 * v]), most = fmax(most, r.radiance[3 * v]);
        /* A tenth of the span of 9, half of it at a rim, is the slack that vertex_fit.c allows where samples differ;
         * where they agree, one element from the step, there is none, and the solver's 1e-7 is all that is left. */
        CHECK(least >= 1 - 4.5 && most <= 10 + 4.5);
        for (size_t v = 0; v < t.node_count; v++) {
            double x = t.vertices[3 * v];
            if (x < 0.5 - 1e-9) CHECK_NEAR(r.radiance[3 * v], 1.0, 3e-6);
            if (x > 0.5 + 1e-9) CHECK_NEAR(r.radiance[3 * v], 10.0, 3e-5);
        }
    }
    vertex_fit_free(&r);
    arena_free(&t.memory);
}

/* The edge of the sun's shadow runs through a column of elements; the shade is dim, and tinted. */
static const double shade[3] = { 0.1, 0.05, 0.01 };

static double sunlit(int band, double x, double y) {
    (void)y;
    return x > 4.5 / SIDE ? 1.0 : shade[band];
}

static void no_shade_beside_the_sun_is_black(void) {
    sheet t;
    vertex_fit_result r;
    make_sheet(&t, QUADS, false);
    fill(&t, sunlit);
    if (fit(&t, &r))
        for (size_t v = 0; v < t.node_count; v++)
            for (size_t c = 0; c < 3; c++) {
                double y = t.vertices[3 * v + 1];
                bool is_inside = y > 0.5 / SIDE && y < 1 - 0.5 / SIDE && t.vertices[3 * v] > 0.5 / SIDE;
                /* The slacks of vertex_fit.c, of the shade instead of the step. */
                CHECK(r.radiance[3 * v + c] >= (is_inside ? 0.9 : 0.5) * shade[c] - 1e-9);
            }
    vertex_fit_free(&r);
    arena_free(&t.memory);
}

static void emitters_are_left_out_of_the_residual(void) {
    sheet t;
    vertex_fit_result with, without;
    make_sheet(&t, QUADS, false);
    fill(&t, step);
    bool ok = fit(&t, &with);
    t.emits = arena_alloc(&t.memory, t.mesh.element_count, sizeof *t.emits);
    /* All that is not flat lies in the two columns of elements beside the step. */
    for (size_t e = 0; e < t.mesh.element_count; e++) {
        double x = t.mesh.x[t.mesh.elements[e].first_sample];
        t.emits[e] = fabs(x - 0.5) < 1.0 / SIDE;
    }
    if (fit(&t, &without) && ok) {
        CHECK(with.residual > 0.05);
        /* Constants on either side; see a_constant_stays_the_same_constant. */
        CHECK_NEAR(without.residual, 0.0, 3e-6);
        /* And the colours are the same. */
        CHECK(memcmp(with.radiance, without.radiance, 3 * t.node_count * sizeof *with.radiance) == 0);
    }
    vertex_fit_free(&with);
    vertex_fit_free(&without);
    arena_free(&t.memory);
}

/* What the vertex in the middle of one element's edge at the rim is off the mean of the edge's ends by, where one
 * sample is off by 1. */
static double hanging_off_its_edge(bool alone) {
    enum { AT = 3 };
    sheet t;
    vertex_fit_result r;
    double off = NAN;
    make_sheet(&t, QUADS, false);
    fill(&t, field);
    element *hung = &t.mesh.elements[AT];
    const uint32_t node = (uint32_t)t.node_count++;
    hung->hanging = 1;
    t.nodes[ELEMENT_PLACES * AT + 4] = node;
    t.radiance[3 * (size_t)hung->first_sample] += 1.0;
    if (!alone) { /* as if an element beyond the rim had a corner there */
        t.mesh.elements[SIDE - 1].hanging = 1;
        t.nodes[ELEMENT_PLACES * (SIDE - 1) + 4] = node;
    }
    if (fit(&t, &r))
        off = fabs(r.radiance[3 * (size_t)node] -
                   0.5 * (r.radiance[3 * (size_t)hung->corner[0]] + r.radiance[3 * (size_t)hung->corner[1]]));
    vertex_fit_free(&r);
    arena_free(&t.memory);
    return off;
}

static void a_vertex_that_hangs_at_a_crease_shows_what_its_edge_does(void) {
    double alone = hanging_off_its_edge(true), shared = hanging_off_its_edge(false);
    printf("one sample off by 1: a hanging vertex is off its edge by %.3f, one that others share by %.3f\n", alone,
           shared);
    /* The sample weighs a quarter of the element, and the edge all of it. */
    CHECK(alone < 0.25);
    CHECK(shared > 0.25);
}

/* A chain of nodes, each drawn to its neighbours and to one value: more than one share of a job. */
enum { CHAIN = 10000 };

static bool open_chain(fit_matrix *a, uint32_t *room) {
    for (size_t v = 0; v < CHAIN; v++) room[v] = 3;
    if (!fit_matrix_begin(NULL, CHAIN, room, a)) return false;
    for (uint32_t v = 0; v < CHAIN; v++) {
        fit_matrix_add(a, v, v, 1.0);
        for (uint32_t w = v == 0 ? 1 : v - 1; w <= v + 1 && w < CHAIN; w += 2) {
            fit_matrix_add(a, v, v, 0.25);
            fit_matrix_add(a, v, w, -0.25);
        }
        for (size_t c = 0; c < 3; c++) a->r[3 * v + c] = c == 2 ? 7.0 : sin(0.01 * (double)((c + 1) * v));
    }
    return true;
}

static void threads_that_share_a_part_give_the_same_bytes(void) {
    static uint32_t room[CHAIN];
    fit_matrix alone = { 0 }, shared = { 0 };
    jobs *j = jobs_create(3);
    bool ok = j && open_chain(&alone, room) && open_chain(&shared, room);
    CHECK(ok);
    if (ok) {
        int iterations = fit_solve(&alone, NULL, NULL);
        CHECK_EQUAL(fit_solve(&shared, j, NULL), iterations);
        CHECK(iterations > 1 && iterations < 40);
        CHECK(memcmp(alone.x, shared.x, 3 * CHAIN * sizeof *alone.x) == 0);
        for (size_t v = 0; v < CHAIN; v += 97) {
            /* 0.25 (2 - 2 cos) of a sine is left over by its neighbours; at the ends this is off. */
            double slope = 2 - 2 * cos(0.01), inner = sin(0.01 * (double)v) / (1.0 + 0.25 * slope);
            CHECK_NEAR(alone.x[3 * v + 2], 7.0, 1e-4);
            if (v > 100 && v < CHAIN - 100) CHECK_NEAR(alone.x[3 * v], inner, 1e-4);
        }
    }
    jobs_destroy(j);
    fit_matrix_free(&alone);
    fit_matrix_free(&shared);
}

static void faces_between_creases_are_parts(void) {
    sheet t;
    fit_parts p;
    make_sheet(&t, TRIANGLES, true);
    bool ok = fit_parts_find(&t.mesh, t.nodes, t.node_count, &p) && p.count == 2;
    CHECK(ok);
    if (ok)
        for (size_t i = 0; i < 2; i++) {
            CHECK_EQUAL(fit_parts_elements(&p, i), SIDE * SIDE);
            CHECK_EQUAL(fit_parts_nodes(&p, i), (SIDE + 1) * (SIDE / 2 + 1));
            for (uint32_t v = p.first_node[i]; v < p.first_node[i + 1]; v++)
                CHECK_EQUAL(p.number[p.node[v]], v - p.first_node[i]);
        }
    fit_parts_free(&p);
    arena_free(&t.memory);
    make_sheet(&t, QUADS, false);
    CHECK(fit_parts_find(&t.mesh, t.nodes, t.node_count, &p) && p.count == 1);
    fit_parts_free(&p);
    arena_free(&t.memory);
}

/* A chain of three shares' nodes, each pulled to its neighbours; of what is sought the first share has next to nothing,
 * so that what the others say decides how far to go. */
static void all_shares_of_a_large_part_are_heard(void) {
    enum { NODES = 3 * 4096 };
    static uint32_t room[NODES];
    static double sought[NODES];
    for (uint32_t v = 0; v < NODES; v++) {
        room[v] = 3;
        sought[v] = v < NODES / 3 ? 0.0 : sin(0.37 * v);
    }
    fit_matrix a = { 0 };
    if (!fit_matrix_begin(NULL, NODES, room, &a)) abort();
    for (uint32_t v = 0; v < NODES; v++) {
        double right = 2.5 * sought[v];
        fit_matrix_add(&a, v, v, 2.5);
        for (int side = -1; side <= 1; side += 2) {
            if ((side < 0 && v == 0) || (side > 0 && v == NODES - 1)) continue;
            fit_matrix_add(&a, v, (uint32_t)((int)v + side), -1.0);
            right -= sought[(int)v + side];
        }
        for (size_t c = 0; c < 3; c++) a.r[3 * v + c] = (double)(c + 1) * right;
    }
    fit_solve(&a, NULL, NULL);
    double off = 0.0;
    for (size_t v = 0; v < NODES; v++)
        for (size_t c = 0; c < 3; c++) off = fmax(off, fabs(a.x[3 * v + c] - (double)(c + 1) * sought[v]));
    CHECK_NEAR(off, 0.0, 1e-3); /* the residual is a hundred-thousandth of the first one's, of 12,288 nodes */
    fit_matrix_free(&a);
}

int main(void) {
    RUN(all_shares_of_a_large_part_are_heard);
    RUN(threads_that_share_a_part_give_the_same_bytes);
    RUN(faces_between_creases_are_parts);
    RUN(a_vertex_that_hangs_at_a_crease_shows_what_its_edge_does);
    RUN(triangles_cover_an_element);
    RUN(weights_interpolate);
    RUN(a_linear_field_comes_back_on_quads_and_triangles);
    RUN(quads_are_cut_along_the_level_lines_of_the_light);
    RUN(a_constant_stays_the_same_constant);
    RUN(a_crease_stays_hard);
    RUN(samples_without_weight_are_not_listened_to);
    RUN(no_vertex_goes_below_zero);
    RUN(no_halo_rings_along_a_step);
    RUN(no_shade_beside_the_sun_is_black);
    RUN(emitters_are_left_out_of_the_residual);
    RUN(least_squares_beats_what_averages_of_neighbours_give);
    return check_end();
}
