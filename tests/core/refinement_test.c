/* SPDX-License-Identifier: MIT
 * Are refined elements balanced, without T-junctions, and do they cover what they covered?
 */
#include "check.h"
#include "geometry/triangle.h"
#include "mesh/refinement.h"
#include "tessellate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A box, whose edges are hard, and a single triangle beside it. */
static const float POSITIONS[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1,    1, 0,
                                   1, 1, 1, 1, 0, 1, 1, 2, 0, 0, 3, 0, 0, 2, 1.5f, 0 };
static const uint32_t INDICES[] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 7,
                                    6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5, 8, 9, 10 };

typedef struct refined {
    mesh_vertices vertices;
    scene scene;
    mesh mesh;
    source_mesh source;
    refinement *r;
    arena memory;
} refined;

/* smooth: faces share vertices, so a vertex may have its source in any of them. */
static bool open(refined *c, bool double_sided, bool smooth) {
    hemi_mesh_desc box = { .positions = POSITIONS,
                           .indices = INDICES,
                           .vertex_count = sizeof POSITIONS / sizeof *POSITIONS / 3,
                           .triangle_count = sizeof INDICES / sizeof *INDICES / 3,
                           .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
    if (smooth) box.normals = POSITIONS;
    const tessellate_desc desc = { .meshes = &box,
                                   .double_sided = &double_sided,
                                   .is_proxy = &(bool){ false },
                                   .mesh_count = 1,
                                   .element_size = 0.5,
                                   .patch_size = 0.5,
                                   .max_elements = 100000 };
    *c = (refined){ .source = { .positions = POSITIONS, .indices = INDICES } };
    tessellation made = { .vertices = &c->vertices, .scene = &c->scene, .mesh = &c->mesh };
    CHECK_EQUAL(tessellate(&desc, &made), HEMI_OK);
    CHECK(mesh_measure(&c->mesh, &c->memory));
    const refinement_setup setup = { &c->scene, &c->mesh, &c->vertices, &c->source, NULL };
    c->r = refinement_create(&setup);
    CHECK(c->r);
    return c->r;
}

static void clean(refined *c) {
    refinement_free(c->r);
    tessellation_free(&(tessellation){ .vertices = &c->vertices, .scene = &c->scene, .mesh = &c->mesh });
    arena_free(&c->memory);
}

/* The mesh of the leaves as they are. */
static mesh mesh_of(refined *c) {
    mesh m = { 0 };
    CHECK(refinement_mesh(c->r, &c->memory, &m));
    return m;
}

static uint64_t random_bits(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state >> 33;
}

static void split_some(refined *c, uint64_t *state, unsigned one_in) {
    uint32_t count;
    refinement_leaves(c->r, &count);
    bool *marks = calloc(count + 1, 1);
    for (uint32_t i = 0; i < count; i++) marks[i] = random_bits(state) % one_in == 0;
    CHECK_EQUAL(refinement_split(c->r, marks, 1000000), REFINEMENT_OK);
    free(marks);
}

static const double *at(const refined *c, uint32_t vertex) {
    return c->vertices.positions + 3 * (size_t)vertex;
}

static double area_of(const refined *c, const element *e) {
    double sum = 0.0;
    for (int i = 1; i + 1 < element_corner_count(e); i++) {
        double n[3];
        triangle_cross(n, at(c, e->corner[0]), at(c, e->corner[i]), at(c, e->corner[i + 1]));
        sum += 0.5 * vec3_length(n);
    }
    return sum;
}

/* Is a corner of any leaf at a point? Points are eighths of powers of two: exact. */
static bool is_corner(const refined *c, const mesh *m, const double p[3]) {
    for (size_t i = 0; i < m->element_count; i++)
        for (int k = 0; k < element_corner_count(&m->elements[i]); k++)
            if (memcmp(at(c, m->elements[i].corner[k]), p, 3 * sizeof *p) == 0) return true;
    return false;
}

static void between(const double a[3], const double b[3], double share, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] + share * (b[k] - a[k]);
}

/* A corner in the middle of an edge hangs there; none lies elsewhere on it. */
static void check_edges(refined *c) {
    const mesh m = mesh_of(c);
    for (size_t i = 0; i < m.element_count; i++) {
        const element *e = &m.elements[i];
        int n = element_corner_count(e);
        for (int k = 0; k < n; k++) {
            const double *a = at(c, e->corner[k]), *b = at(c, e->corner[(k + 1) % n]);
            double middle[3], quarter[3];
            between(a, b, 0.5, middle);
            CHECK_EQUAL(is_corner(c, &m, middle), (e->hanging >> k & 1) != 0);
            if (e->hanging >> k & 1) CHECK_EQUAL(memcmp(at(c, e->middle[k]), middle, sizeof middle), 0);
            for (int q = 1; q < 4; q += 2) {
                between(a, b, 0.25 * q, quarter);
                CHECK(!is_corner(c, &m, quarter));
            }
        }
    }
}

/* Leaves of a patch are together, and those of a mesh have the samples one after the other. */
static void check_mesh(refined *c) {
    const mesh m = mesh_of(c);
    uint32_t count, next = 0, sample = 0;
    const leaf *leaves = refinement_leaves(c->r, &count);
    CHECK_EQUAL(m.element_count, count);
    for (size_t p = 0; p < m.patch_count; p++) {
        CHECK_EQUAL(m.patches[p].first_element, next);
        CHECK_EQUAL(m.patches[p].first_sample, sample);
        for (uint32_t i = 0; i < m.patches[p].element_count; i++, next++) {
            CHECK_EQUAL(m.elements[next].patch, p);
            CHECK_EQUAL(c->mesh.elements[leaves[next].root].patch, p);
            CHECK_EQUAL(m.elements[next].first_sample, sample);
            CHECK_EQUAL(leaves[next].first_sample, sample);
            CHECK_EQUAL(leaves[next].sample_count, element_corner_count(&m.elements[next]));
            CHECK_NEAR(m.elements[next].area, area_of(c, &m.elements[next]), 1e-12);
            sample += (uint32_t)element_corner_count(&m.elements[next]);
        }
    }
    CHECK_EQUAL(next, count);
    CHECK_EQUAL(m.sample_count, sample);
}

/* What the source of a vertex says of its place, in the mesh's frame, which is the world's here. */
static void check_sources(const refined *c) {
    for (uint32_t v = 0; v < c->vertices.count; v++) {
        const float *w = c->vertices.source_weights + 3 * (size_t)v;
        for (int k = 0; k < 3; k++) {
            double p = 0.0;
            for (int i = 0; i < 3; i++)
                p += w[i] * POSITIONS[3 * INDICES[3 * c->vertices.source_triangles[v] + (uint32_t)i] + (uint32_t)k];
            CHECK(w[k] >= 0.0f);
            /* Weights are floats, of places that are eighths of powers of two. */
            CHECK_NEAR(p, at(c, v)[k], 1e-6);
        }
    }
}

static void leaves_are_balanced_and_cover_all(void) {
    for (int kind = 0; kind < 4; kind++) {
        refined c;
        uint64_t state = 7;
        int sides = 1 + kind % 2;
        if (!open(&c, sides == 2, kind >= 2)) return;
        for (int pass = 0; pass < 4; pass++) {
            double area = 0.0;
            uint32_t count, levels = 0;
            split_some(&c, &state, 6);
            const leaf *leaves = refinement_leaves(c.r, &count);
            const mesh m = mesh_of(&c);
            for (uint32_t i = 0; i < count; i++) {
                area += area_of(&c, &m.elements[i]);
                if (leaves[i].level > levels) levels = leaves[i].level;
            }
            check_mesh(&c);
            CHECK(levels >= (uint32_t)pass);
            CHECK_NEAR(area, sides * 6.75, 1e-9);
            /* The two sides of a sheet are in one place and cut each for itself. */
            if (sides == 1) check_edges(&c);
        }
        check_sources(&c);
        clean(&c);
    }
}

/* Nothing changes when the budget is too small, and a smaller wish can still be met. */
static void a_budget_is_kept(void) {
    refined c;
    uint32_t count, before;
    if (!open(&c, false, false)) return;
    refinement_leaves(c.r, &before);
    bool *marks = malloc(before);
    memset(marks, 1, before);
    CHECK_EQUAL(refinement_split(c.r, marks, before + 3), REFINEMENT_LIMIT);
    refinement_leaves(c.r, &count);
    CHECK_EQUAL(count, before);
    memset(marks, 0, before);
    marks[0] = true;
    CHECK_EQUAL(refinement_split(c.r, marks, before + 3), REFINEMENT_OK);
    refinement_leaves(c.r, &count);
    CHECK_EQUAL(count, before + 3);
    check_edges(&c);
    free(marks);
    clean(&c);
}

/* Where leaves say they lie on their root is where they lie. */
static void leaves_know_their_place(void) {
    refined c;
    uint64_t state = 3;
    uint32_t count;
    if (!open(&c, false, false)) return;
    for (int pass = 0; pass < 3; pass++) split_some(&c, &state, 3);
    const leaf *leaves = refinement_leaves(c.r, &count);
    const mesh m = mesh_of(&c);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *root = c.mesh.elements[leaves[i].root].corner, *own = m.elements[i].corner;
        const double *o = at(&c, root[0]), *u = at(&c, root[1]),
                     *v = at(&c, root[element_corner_count(&m.elements[i]) - 1]);
        for (int k = 0; k < 3; k++) {
            double first = o[k] + leaves[i].u * (u[k] - o[k]) + leaves[i].v * (v[k] - o[k]);
            double second = first + leaves[i].size * (u[k] - o[k]);
            CHECK_NEAR(first, at(&c, own[0])[k], 1e-12);
            CHECK_NEAR(second, at(&c, own[1])[k], 1e-12);
        }
    }
    clean(&c);
}

/* Twice a quarter: sixteen of each, as large together as what they were, and none with a vertex that hangs. Then they
 * are the mesh. */
static void all_are_split_alike(void) {
    for (int smooth = 0; smooth < 2; smooth++) {
        refined c;
        double before = 0.0, after = 0.0;
        uint32_t roots, count;
        if (!open(&c, smooth == 0, smooth == 1)) return;
        refinement_leaves(c.r, &roots);
        for (uint32_t i = 0; i < roots; i++) before += area_of(&c, &c.mesh.elements[i]);
        CHECK_EQUAL(refinement_split_all(c.r, 4 * roots - 1), REFINEMENT_LIMIT);
        CHECK_EQUAL(refinement_split_all(c.r, 4 * roots), REFINEMENT_OK);
        CHECK_EQUAL(refinement_split_all(c.r, 16 * roots), REFINEMENT_OK);
        check_mesh(&c);
        check_edges(&c);
        CHECK(refinement_finish(c.r, &c.memory));
        const leaf *leaves = refinement_leaves(c.r, &count);
        CHECK_EQUAL(count, 16 * roots);
        CHECK_EQUAL(c.mesh.element_count, count);
        for (uint32_t i = 0; i < count; i++) {
            after += c.mesh.elements[i].area;
            CHECK(leaves[i].is_new && c.mesh.elements[i].hanging == 0 && leaves[i].root == i / 16);
        }
        CHECK_NEAR(after, before, 1e-12 * before);
        clean(&c);
    }
}

/* What is new is in a mesh of its own, in the order of the leaves; the lots of a refinement have all of it. */
static void new_leaves_are_a_mesh(void) {
    refined c;
    uint64_t state = 5;
    uint32_t count;
    if (!open(&c, true, false)) return;
    for (int pass = 0; pass < 2; pass++) split_some(&c, &state, 4);
    const leaf *leaves = refinement_leaves(c.r, &count);
    const mesh all = mesh_of(&c);
    uint32_t middle = count / 2, i = 0;
    while (middle < count && leaves[middle].root == leaves[middle - 1].root) middle++;
    for (int lot = 0; lot < 2; lot++) {
        mesh m;
        CHECK(refinement_mesh_of_new(c.r, lot ? middle : 0, lot ? count : middle, &c.memory, &m));
        CHECK(m.element_count > 0 && m.element_count < count);
        for (size_t e = 0; e < m.element_count; e++, i++) {
            while (i < count && !leaves[i].is_new) i++;
            CHECK_EQUAL(memcmp(m.elements[e].corner, all.elements[i].corner, sizeof m.elements[e].corner), 0);
            CHECK_EQUAL(m.elements[e].patch, all.elements[i].patch);
        }
    }
    while (i < count && !leaves[i].is_new) i++;
    CHECK_EQUAL(i, count);
    clean(&c);
}

int main(void) {
    RUN(leaves_are_balanced_and_cover_all);
    RUN(all_are_split_alike);
    RUN(a_budget_is_kept);
    RUN(new_leaves_are_a_mesh);
    RUN(leaves_know_their_place);
    return check_end();
}
