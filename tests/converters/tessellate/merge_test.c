/* SPDX-License-Identifier: MIT
 * Does a flat grid that is finer than elements become one surface, whose pieces still know their triangles, and does
 * what is not one stay as it is?
 */
#include "check.h"
#include "tessellate.h"

#include "geometry/triangle.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 20, ROWS = 15, VERTICES = (COLUMNS + 1) * (ROWS + 1), CELLS = COLUMNS * ROWS };

/* Of 3 x 2, tilted, its columns of two widths; without the cells from a column and a row on, where these are said. */
typedef struct grid {
    float positions[3 * VERTICES], attributes[2 * VERTICES];
    uint32_t indices[6 * CELLS];
    hemi_mesh_desc mesh;
} grid;

static void make_grid(grid *g, int notch_column, int notch_row, double bend) {
    uint32_t count = 0;
    for (int j = 0; j <= ROWS; j++)
        for (int i = 0; i <= COLUMNS; i++) {
            size_t v = (size_t)(j * (COLUMNS + 1) + i);
            double u = (i < 10 ? 0.5 * i : i - 5.0) / (COLUMNS - 5.0), w = (double)j / ROWS;
            g->positions[3 * v] = (float)(3.0 * u), g->positions[3 * v + 1] = (float)(1.2 * w + bend * u * u);
            g->positions[3 * v + 2] = (float)(1.6 * w);
            g->attributes[2 * v] = (float)(0.25 + 4.0 * u), g->attributes[2 * v + 1] = (float)(1.0 - w);
        }
    for (int j = 0; j < ROWS; j++)
        for (int i = 0; i < COLUMNS; i++) {
            uint32_t a = (uint32_t)(j * (COLUMNS + 1) + i), b = a + 1, c = b + COLUMNS + 1, d = c - 1;
            const uint32_t ways[2][6] = { { a, c, d, c, a, b }, { d, a, b, b, c, d } };
            if (i >= notch_column && j >= notch_row) continue;
            memcpy(g->indices + count, ways[(i + j) % 2], sizeof *ways);
            count += 6;
        }
    g->mesh = (hemi_mesh_desc){ .struct_size = sizeof g->mesh,
                                .positions = g->positions,
                                .attributes = g->attributes,
                                .attribute_count = 2,
                                .vertex_count = VERTICES,
                                .indices = g->indices,
                                .triangle_count = count / 3 };
}

typedef struct pieces {
    mesh_vertices vertices;
    scene scene;
    mesh mesh;
} pieces;

static bool cut(const hemi_mesh_desc *m, bool merges, bool double_sided, double element_size, pieces *out) {
    const tessellate_desc how = { .meshes = m,
                                  .double_sided = &double_sided,
                                  .mesh_count = 1,
                                  .element_size = element_size,
                                  .patch_size = 2.0 * element_size,
                                  .max_elements = 100000,
                                  .merges = merges };
    memset(out, 0, sizeof *out);
    tessellation made = { .vertices = &out->vertices, .scene = &out->scene, .mesh = &out->mesh };
    hemi_result result = tessellate(&how, &made);
    CHECK_EQUAL(result, HEMI_OK);
    return result == HEMI_OK;
}

static void pieces_free(pieces *t) {
    tessellation_free(&(tessellation){ .vertices = &t->vertices, .scene = &t->scene, .mesh = &t->mesh });
}

static double area_of(const pieces *t, const uint32_t *c) {
    const double *p = t->vertices.positions;
    double area = triangle_area(p + 3 * (size_t)c[0], p + 3 * (size_t)c[1], p + 3 * (size_t)c[2]);
    return c[3] == NO_INDEX ? area
                            : area + triangle_area(p + 3 * (size_t)c[0], p + 3 * (size_t)c[2], p + 3 * (size_t)c[3]);
}

static void check_area(const pieces *t, double exact) {
    double surfaces = 0.0, elements = 0.0;
    for (size_t i = 0; i < t->scene.surface_count; i++) surfaces += area_of(t, t->scene.surfaces[i].corner);
    for (size_t i = 0; i < t->mesh.element_count; i++) elements += area_of(t, t->mesh.elements[i].corner);
    /* Floats of up to 3 are off by 1e-7. */
    CHECK_NEAR(surfaces, exact, 1e-6);
    CHECK_NEAR(elements, exact, 1e-6);
}

static void check_sources(const pieces *t, const hemi_mesh_desc *m) {
    double worst = 0.0, least = 0.0;
    uint32_t last = 0;
    for (uint32_t v = 0; v < t->vertices.count; v++) {
        const float *w = t->vertices.source_weights + 3 * (size_t)v;
        double at[3];
        uint32_t triangle = t->vertices.source_triangles[v];
        CHECK(triangle < m->triangle_count);
        mesh_vertices_interpolate(&t->vertices, v, m->indices, m->positions, 3, at);
        worst = fmax(worst, vec3_distance(at, t->vertices.positions + 3 * (size_t)v));
        for (int k = 0; k < 3; k++) least = fmin(least, w[k]);
        last = triangle > last ? triangle : last;
    }
    /* As in tessellate_test.c; the grid is affine to some roundings of floats of up to 3. */
    CHECK_NEAR(worst, 0.0, 2e-6);
    CHECK_NEAR(least, 0.0, 1e-7);
    CHECK(last > m->triangle_count / 2); /* of all over the grid */
}

static void a_fine_grid_is_one_surface_of_large_elements(void) {
    for (int sides = 1; sides <= 2; sides++) {
        grid g;
        pieces t;
        make_grid(&g, COLUMNS, ROWS, 0.0);
        if (!cut(&g.mesh, true, sides == 2, 0.5, &t)) return;
        CHECK_EQUAL(t.scene.surface_count, sides);
        CHECK(t.scene.surfaces[0].grid);
        check_area(&t, 6.0 * sides);
        /* 3 x 2 in halves of edges longer than 0.7: six by four, as of a grid of one cell. */
        CHECK_EQUAL(t.mesh.element_count, 32 * sides);
        CHECK(t.vertices.count < VERTICES);
        check_sources(&t, &g.mesh);
        pieces_free(&t);
    }
}

static void a_mean_of_vertices_finds_its_cell(void) {
    grid g;
    pieces t;
    make_grid(&g, COLUMNS, ROWS, 0.0);
    if (!cut(&g.mesh, true, false, 1.5, &t)) return;
    const source_mesh source = { .positions = g.positions, .indices = g.indices };
    const surface *f = &t.scene.surfaces[0];
    for (int i = 1; i < 50; i++) {
        double s = i / 50.0, place[3], at[3];
        uint32_t v = mesh_vertices_copy(&t.vertices, f->corner[0], 0);
        for (int k = 0; k < 3; k++)
            place[k] = (1.0 - s) * t.vertices.positions[3 * f->corner[0] + (uint32_t)k] +
                       s * t.vertices.positions[3 * f->corner[2] + (uint32_t)k];
        mesh_vertices_set_source(&t.vertices, &source, f, (uint32_t[]){ f->corner[0], f->corner[2] },
                                 (double[]){ 1.0 - s, s }, 2, v);
        mesh_vertices_interpolate(&t.vertices, v, g.indices, g.positions, 3, at);
        CHECK_NEAR(vec3_distance(at, place), 0.0, 2e-6);
    }
    pieces_free(&t);
}

/* Each of the three has whole edges in common with the next, so that there is no T-junction. */
static void a_notch_leaves_three_surfaces(void) {
    grid g;
    pieces t;
    make_grid(&g, 12, 9, 0.0);
    if (!cut(&g.mesh, true, false, 0.5, &t)) return;
    CHECK_EQUAL(t.scene.surface_count, 3);
    check_area(&t, 6.0 - (8.0 / 15.0) * 3.0 * 0.4 * 2.0);
    int shared = 0;
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 4; k++)
            for (size_t j = 0; j < 3; j++)
                for (size_t l = 0; l < 4; l++)
                    shared += t.scene.surfaces[i].corner[k] == t.scene.surfaces[j].corner[(l + 1) % 4] &&
                              t.scene.surfaces[i].corner[(k + 1) % 4] == t.scene.surfaces[j].corner[l];
    CHECK_EQUAL(shared, 4); /* two edges, from either side */
    pieces_free(&t);
}

static void check_stays(grid *g, bool merges, double element_size) {
    pieces t;
    if (!cut(&g->mesh, merges, false, element_size, &t)) return;
    CHECK_EQUAL(t.scene.surface_count, CELLS);
    for (size_t i = 0; i < t.scene.surface_count; i++) CHECK(!t.scene.surfaces[i].grid);
    pieces_free(&t);
}

static void what_is_no_grid_stays_as_it_is(void) {
    grid g;
    make_grid(&g, COLUMNS, ROWS, 0.0);
    check_stays(&g, false, 0.5);        /* nobody asks for it */
    check_stays(&g, true, 0.05);        /* elements are finer */
    make_grid(&g, COLUMNS, ROWS, 1e-4); /* it curves, by less at each line than a line is told by */
    check_stays(&g, true, 0.5);
    make_grid(&g, COLUMNS, ROWS, 0.0);
    for (uint32_t v = 0; v < VERTICES; v++) g.attributes[2 * v] *= g.attributes[2 * v];
    check_stays(&g, true, 0.5); /* each cell is affine, and all of them are not */
}

static void flat_grids_are_told_from_other_meshes(void) {
    grid g;
    make_grid(&g, COLUMNS, ROWS, 0.0);
    CHECK(tessellate_is_flat_grid(&g.mesh, NULL));
    make_grid(&g, COLUMNS, ROWS, 0.5);
    CHECK(!tessellate_is_flat_grid(&g.mesh, NULL));
    make_grid(&g, COLUMNS, ROWS, 0.0);
    for (uint32_t v = 0; v < VERTICES; v++) /* in its plane, every vertex elsewhere */
        if (v % (COLUMNS + 1) % COLUMNS != 0) g.positions[3 * v] += 0.03f * (float)sin(7.0 * v);
    CHECK(!tessellate_is_flat_grid(&g.mesh, NULL));
    make_grid(&g, COLUMNS, ROWS, 0.0);
    CHECK(tessellate_crowding(NULL, &g.mesh, 1, 1.0) < 2.5);
}

/* As many exporters write meshes: every triangle has vertices of its own. */
static void vertices_that_are_the_same_are_one(void) {
    static grid g;
    static float positions[3 * 6 * CELLS], attributes[2 * 6 * CELLS];
    static uint32_t indices[6 * CELLS];
    pieces shared, own;
    make_grid(&g, COLUMNS, ROWS, 0.0);
    for (uint32_t i = 0; i < 3 * g.mesh.triangle_count; i++) {
        memcpy(positions + 3 * (size_t)i, g.positions + 3 * (size_t)g.indices[i], 3 * sizeof *positions);
        memcpy(attributes + 2 * (size_t)i, g.attributes + 2 * (size_t)g.indices[i], 2 * sizeof *attributes);
        indices[i] = i;
    }
    if (!cut(&g.mesh, true, false, 1.0, &shared)) return;
    g.mesh.positions = positions, g.mesh.attributes = attributes, g.mesh.indices = indices;
    g.mesh.vertex_count = 3 * g.mesh.triangle_count;
    if (cut(&g.mesh, true, false, 1.0, &own)) {
        CHECK_EQUAL(own.scene.surface_count, 1);
        CHECK_EQUAL(own.mesh.element_count, shared.mesh.element_count);
        CHECK_EQUAL(own.vertices.count, shared.vertices.count);
        CHECK_EQUAL(own.vertices.node_count, shared.vertices.node_count);
    }
    pieces_free(&own);
    /* Another attribute at one of them is a seam, and the grid stays cut. */
    attributes[2 * (3 * CELLS + 1)] += 0.125f;
    if (cut(&g.mesh, true, false, 1.0, &own)) CHECK(own.scene.surface_count > 1);
    pieces_free(&own);
    pieces_free(&shared);
}

int main(void) {
    RUN(vertices_that_are_the_same_are_one);
    RUN(a_fine_grid_is_one_surface_of_large_elements);
    RUN(a_mean_of_vertices_finds_its_cell);
    RUN(a_notch_leaves_three_surfaces);
    RUN(what_is_no_grid_stays_as_it_is);
    RUN(flat_grids_are_told_from_other_meshes);
    return check_end();
}
