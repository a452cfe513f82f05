/* SPDX-License-Identifier: MIT
 * Are refined elements balanced, without T-junctions, and do they cover what they covered?
 */
#include "check.h"
#include "refinement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A box, whose edges are hard, and a single triangle beside it. */
static const float POSITIONS[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1,    1, 0,
                                   1, 1, 1, 1, 0, 1, 1, 2, 0, 0, 3, 0, 0, 2, 1.5f, 0 };
static const uint32_t INDICES[] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 7,
                                    6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5, 8, 9, 10 };

typedef struct cut_up {
    hemi_mesh_desc mesh;
    tessellation t;
    refinement *r;
} cut_up;

/* smooth: faces share vertices, so a vertex may have its source in any of them. */
static bool cut(cut_up *c, bool double_sided, bool smooth) {
    c->mesh = (hemi_mesh_desc){ .positions = POSITIONS,
                                .indices = INDICES,
                                .vertex_count = sizeof POSITIONS / sizeof *POSITIONS / 3,
                                .triangle_count = sizeof INDICES / sizeof *INDICES / 3,
                                .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
    if (smooth) c->mesh.normals = POSITIONS;
    const tessellate_desc desc = { .meshes = &c->mesh,
                                   .double_sided = &double_sided,
                                   .is_proxy = &(bool){ false },
                                   .mesh_count = 1,
                                   .element_size = 0.5,
                                   .patch_size = 0.5,
                                   .max_elements = 100000 };
    CHECK_EQUAL(tessellate(&desc, &c->t), HEMI_OK);
    return refinement_create(&c->t, &c->mesh, &c->r) == HEMI_OK;
}

static void clean(cut_up *c) {
    refinement_free(c->r);
    tessellation_free(&c->t);
}

static uint64_t random_bits(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state >> 33;
}

static void split_some(cut_up *c, uint64_t *state, unsigned one_in) {
    uint32_t count;
    refinement_leaves(c->r, &count);
    bool *marks = calloc(count + 1, 1);
    for (uint32_t i = 0; i < count; i++) marks[i] = random_bits(state) % one_in == 0;
    CHECK_EQUAL(refinement_split(c->r, marks, 1000000), HEMI_OK);
    free(marks);
}

static int corners_of(const tessellate_leaf *l) {
    return l->corner[3] == TESSELLATE_NONE ? 3 : 4;
}

static const double *at(const cut_up *c, uint32_t vertex) {
    return c->t.positions + 3 * (size_t)vertex;
}

static double leaf_area(const cut_up *c, const tessellate_leaf *l) {
    double sum = 0.0;
    for (int i = 1; i + 1 < corners_of(l); i++) {
        double u[3], v[3];
        for (int k = 0; k < 3; k++) {
            u[k] = at(c, l->corner[i])[k] - at(c, l->corner[0])[k];
            v[k] = at(c, l->corner[i + 1])[k] - at(c, l->corner[0])[k];
        }
        const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
        sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}

/* Is a corner of any leaf at a point? Points are eighths of powers of two: exact. */
static bool is_corner(const cut_up *c, const double p[3]) {
    uint32_t count;
    const tessellate_leaf *leaves = refinement_leaves(c->r, &count);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < corners_of(&leaves[i]); k++)
            if (memcmp(at(c, leaves[i].corner[k]), p, 3 * sizeof *p) == 0) return true;
    return false;
}

static void between(const double a[3], const double b[3], double share, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] + share * (b[k] - a[k]);
}

/* A corner in the middle of an edge hangs there; none lies elsewhere on it. */
static void check_edges(const cut_up *c) {
    uint32_t count;
    const tessellate_leaf *leaves = refinement_leaves(c->r, &count);
    for (uint32_t i = 0; i < count; i++) {
        const tessellate_leaf *l = &leaves[i];
        int n = corners_of(l);
        for (int k = 0; k < n; k++) {
            const double *a = at(c, l->corner[k]), *b = at(c, l->corner[(k + 1) % n]);
            double middle[3], quarter[3];
            between(a, b, 0.5, middle);
            CHECK_EQUAL(is_corner(c, middle), (l->cut >> k & 1) != 0);
            if (l->cut >> k & 1) CHECK_EQUAL(memcmp(at(c, l->mid[k]), middle, sizeof middle), 0);
            for (int q = 1; q < 4; q += 2) {
                between(a, b, 0.25 * q, quarter);
                CHECK(!is_corner(c, quarter));
            }
        }
    }
}

/* What the source of a vertex says of its place, in the mesh's frame, which is the world's here. */
static void check_sources(const cut_up *c) {
    for (uint32_t v = 0; v < c->t.vertex_count; v++) {
        const float *w = c->t.source_weights + 3 * (size_t)v;
        for (int k = 0; k < 3; k++) {
            double p = 0.0;
            for (int i = 0; i < 3; i++)
                p += w[i] * POSITIONS[3 * INDICES[3 * c->t.source_triangles[v] + (uint32_t)i] + (uint32_t)k];
            CHECK(w[k] >= 0.0f);
            /* Weights are floats, of places that are eighths of powers of two. */
            CHECK_NEAR(p, at(c, v)[k], 1e-6);
        }
    }
}

static void leaves_are_balanced_and_cover_all(void) {
    for (int kind = 0; kind < 4; kind++) {
        cut_up c;
        uint64_t state = 7;
        int sides = 1 + kind % 2;
        if (!cut(&c, sides == 2, kind >= 2)) return;
        for (int pass = 0; pass < 4; pass++) {
            double area = 0.0;
            uint32_t count, levels = 0;
            split_some(&c, &state, 6);
            const tessellate_leaf *leaves = refinement_leaves(c.r, &count);
            for (uint32_t i = 0; i < count; i++) {
                area += leaf_area(&c, &leaves[i]);
                if (leaves[i].level > levels) levels = leaves[i].level;
            }
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
    cut_up c;
    uint32_t count, before;
    if (!cut(&c, false, false)) return;
    refinement_leaves(c.r, &before);
    bool *marks = malloc(before);
    memset(marks, 1, before);
    CHECK_EQUAL(refinement_split(c.r, marks, before + 3), HEMI_ERROR_LIMIT);
    refinement_leaves(c.r, &count);
    CHECK_EQUAL(count, before);
    memset(marks, 0, before);
    marks[0] = true;
    CHECK_EQUAL(refinement_split(c.r, marks, before + 3), HEMI_OK);
    refinement_leaves(c.r, &count);
    CHECK_EQUAL(count, before + 3);
    check_edges(&c);
    free(marks);
    clean(&c);
}

/* Where leaves say they lie on their base is where they lie. */
static void leaves_know_their_place(void) {
    cut_up c;
    uint64_t state = 3;
    uint32_t count;
    if (!cut(&c, false, false)) return;
    for (int pass = 0; pass < 3; pass++) split_some(&c, &state, 3);
    const tessellate_leaf *leaves = refinement_leaves(c.r, &count);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *base = c.t.elements[leaves[i].base].corner;
        const double *o = at(&c, base[0]), *u = at(&c, base[1]), *v = at(&c, base[corners_of(&leaves[i]) - 1]);
        for (int k = 0; k < 3; k++) {
            double first = o[k] + leaves[i].u * (u[k] - o[k]) + leaves[i].v * (v[k] - o[k]);
            double second = first + leaves[i].size * (u[k] - o[k]);
            CHECK_NEAR(first, at(&c, leaves[i].corner[0])[k], 1e-12);
            CHECK_NEAR(second, at(&c, leaves[i].corner[1])[k], 1e-12);
        }
    }
    clean(&c);
}

/* Twice a quarter: sixteen of each, as large together as what they were, and none with a vertex that hangs. */
static void all_are_cut_alike(void) {
    for (int smooth = 0; smooth < 2; smooth++) {
        cut_up c;
        double before = 0.0, after = 0.0;
        uint32_t roots, count;
        if (!cut(&c, smooth == 0, smooth == 1)) return;
        const tessellate_leaf *leaves = refinement_leaves(c.r, &roots);
        for (uint32_t i = 0; i < roots; i++) before += leaf_area(&c, &leaves[i]);
        CHECK_EQUAL(refinement_split_all(c.r, 4 * roots - 1), HEMI_ERROR_LIMIT);
        CHECK_EQUAL(refinement_split_all(c.r, 4 * roots), HEMI_OK);
        CHECK_EQUAL(refinement_split_all(c.r, 16 * roots), HEMI_OK);
        leaves = refinement_leaves(c.r, &count);
        CHECK_EQUAL(count, 16 * roots);
        for (uint32_t i = 0; i < count; i++) {
            after += leaf_area(&c, &leaves[i]);
            CHECK(leaves[i].fresh && leaves[i].cut == 0 && leaves[i].base == i / 16);
        }
        CHECK_NEAR(after, before, 1e-12 * before);
        check_edges(&c);
        clean(&c);
    }
}

int main(void) {
    RUN(leaves_are_balanced_and_cover_all);
    RUN(all_are_cut_alike);
    RUN(a_budget_is_kept);
    RUN(leaves_know_their_place);
    return check_end();
}
