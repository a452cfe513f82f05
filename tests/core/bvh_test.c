/* SPDX-License-Identifier: MIT
 * Does the tree of boxes find what a search through all items finds?
 */
#include "check.h"

#include "base/splitmix.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"

enum { MANY = 500, QUERIES = 400 };

typedef struct soup {
    double corner[MANY][3][3];
    bvh_node nodes[2 * MANY];
    uint32_t items[MANY];
    bvh tree;
} soup;

static double random_in(uint64_t seed, double low, double high) {
    return low + (high - low) * splitmix_unit(seed);
}

/* Triangles of a tenth of the cube that they lie in; every third is flat along an axis, as walls are. */
static void make_soup(soup *s, size_t count, double margin) {
    static bvh_box boxes[MANY];
    for (size_t t = 0; t < count; t++) {
        for (size_t i = 0; i < 9; i++)
            s->corner[t][i / 3][i % 3] = random_in(3 * t + i % 3, -1.0, 1.0) + random_in(10000 + 9 * t + i, -0.1, 0.1);
        for (size_t i = 0; t % 3 == 0 && i < 3; i++) s->corner[t][i][t / 3 % 3] = random_in(t, -1.0, 1.0);
        bvh_box_set(&boxes[t], (uint32_t)t, s->corner[t], 3, margin);
    }
    s->tree = (bvh){ .nodes = s->nodes, .items = s->items };
    bvh_build(NULL, &s->tree, boxes, count);
}

/* The items that a search was asked about. */
typedef struct search {
    bool about[MANY];
    uint32_t wanted; /* that ends the search */
} search;

static bool stops(void *user, const uint32_t *items, uint32_t count) {
    search *a = user;
    for (uint32_t i = 0; i < count; i++) {
        a->about[items[i]] = true;
        if (items[i] == a->wanted) return true;
    }
    return false;
}

/* The least and the largest middle along an axis of what is under a node. */
static void span_of(const soup *s, uint32_t n, size_t axis, double *least, double *most) {
    const bvh_node *at = &s->nodes[n];
    for (uint32_t i = at->first; i < at->first + at->count; i++) {
        double middle = 0.0;
        for (size_t k = 0; k < 3; k++) middle += (float)s->corner[s->items[i]][k][axis];
        *least = fmin(*least, middle), *most = fmax(*most, middle);
    }
    for (uint32_t child = 0; at->count == 0 && child < 2; child++) span_of(s, at->first + child, axis, least, most);
}

static uint32_t count_under(const soup *s, uint32_t n) {
    const bvh_node *at = &s->nodes[n];
    return at->count ? at->count : count_under(s, at->first) + count_under(s, at->first + 1);
}

static void halves_lie_beside_each_other(void) {
    static soup s;
    make_soup(&s, MANY, 0.0);
    for (uint32_t n = 0; n < s.tree.node_count; n++) {
        const bvh_node *at = &s.nodes[n];
        size_t axis = 0;
        double span[2][2] = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY } };
        if (at->count) continue;
        for (size_t k = 1; k < 3; k++)
            if (at->high[k] - at->low[k] > at->high[axis] - at->low[axis]) axis = k;
        for (uint32_t i = 0; i < 2; i++) span_of(&s, at->first + i, axis, &span[i][0], &span[i][1]);
        CHECK(span[0][1] <= span[1][0] + 1e-6); /* middles are sums of floats */
        CHECK_EQUAL(count_under(&s, at->first), count_under(&s, n) / 2);
    }
}

static void every_item_is_in_one_leaf_that_holds_it(void) {
    static soup s;
    for (size_t count = 0; count <= MANY; count += count < 20 ? 1 : 60) {
        uint8_t seen[MANY] = { 0 };
        make_soup(&s, count, 0.0);
        CHECK(s.tree.node_count <= (count ? 2 * count - 1 : 0));
        for (uint32_t n = 0; n < s.tree.node_count; n++) {
            const bvh_node *at = &s.nodes[n];
            for (uint32_t i = at->first; i < at->first + at->count; i++) {
                seen[s.items[i]]++;
                for (int k = 0; k < 9; k++) {
                    double x = s.corner[s.items[i]][k / 3][k % 3];
                    CHECK(at->low[k % 3] <= x && x <= at->high[k % 3]);
                }
            }
        }
        for (size_t i = 0; i < count; i++) CHECK_EQUAL(seen[i], 1);
    }
}

/* A segment through a point of a triangle must be asked about it, wherever the point lies: at a corner, in a flat box,
 * on the face of one. Segments along the axes have no inverse there. */
static void a_segment_is_asked_about_all_it_meets(void) {
    static soup s;
    make_soup(&s, MANY, 1e-9);
    for (uint64_t q = 0; q < QUERIES; q++) {
        const double(*c)[3] = s.corner[q % MANY];
        double u = q % 2 ? random_in(q, 0.0, 0.5) : 0.0, v = q % 2 ? random_in(q + 7, 0.0, 0.5) : 0.0, on[3], from[3],
               to[3];
        for (int k = 0; k < 3; k++) {
            double d = q % 5 == (uint64_t)k ? 0.0 : random_in(3 * q + (uint64_t)k, -1.0, 1.0);
            on[k] = (1 - u - v) * c[0][k] + u * c[1][k] + v * c[2][k];
            from[k] = on[k] - 0.5 * d, to[k] = on[k] + d;
        }
        search a = { .wanted = UINT32_MAX };
        CHECK(!bvh_segment(&s.tree, from, to, stops, &a));
        CHECK(a.about[q % MANY]);
        a.wanted = (uint32_t)(q % MANY);
        CHECK(bvh_segment(&s.tree, from, to, stops, &a));
    }
}

/* Of so many boxes that all threads work. */
static void threads_make_the_same_tree(void) {
    enum { COUNT = 40001 };
    static bvh_box boxes[2][COUNT];
    static bvh_node nodes[2][2 * COUNT];
    static uint32_t items[2][COUNT];
    bvh tree[2];
    jobs *j = jobs_create(3);
    CHECK(j != NULL);
    for (int i = 0; i < 2; i++) {
        for (uint32_t t = 0; t < COUNT; t++) {
            double points[2][3];
            for (uint64_t k = 0; k < 6; k++) points[k / 3][k % 3] = random_in(6 * t + k, -1.0, 1.0);
            bvh_box_set(&boxes[i][t], t, (const double(*)[3])points, 2, 0.0);
        }
        tree[i] = (bvh){ .nodes = nodes[i], .items = items[i] };
        bvh_build(i ? j : NULL, &tree[i], boxes[i], COUNT);
    }
    jobs_destroy(j);
    CHECK_EQUAL(tree[0].node_count, tree[1].node_count);
    CHECK_EQUAL(memcmp(items[0], items[1], sizeof items[0]), 0);
    CHECK_EQUAL(memcmp(nodes[0], nodes[1], tree[0].node_count * sizeof *nodes[0]), 0);
    uint32_t held = 0;
    for (uint32_t n = 0; n < tree[1].node_count; n++) held += nodes[1][n].count;
    CHECK_EQUAL(held, COUNT);
}

static void a_segment_is_asked_about_little_else(void) {
    static soup s;
    size_t all = 0;
    make_soup(&s, MANY, 0.0);
    for (uint64_t q = 0; q < QUERIES; q++) {
        search a = { .wanted = UINT32_MAX };
        double from[3], to[3];
        for (uint64_t k = 0; k < 3; k++) from[k] = random_in(6 * q + k, -1, 1), to[k] = random_in(6 * q + k + 3, -1, 1);
        bvh_segment(&s.tree, from, to, stops, &a);
        for (size_t i = 0; i < MANY; i++) all += a.about[i];
    }
    /* A segment of length 1.3 (the mean in this cube) meets boxes of side 0.2 in a tube of 0.3 x 0.3: a seventieth of
     * the items, and leaves of four are three times as wide. */
    CHECK(all < QUERIES * MANY / 8);
    double far[3] = { 5, 5, 5 }, away[3] = { 6, 5, 5 };
    search a = { .wanted = UINT32_MAX };
    bvh_segment(&s.tree, far, away, stops, &a);
    for (size_t i = 0; i < MANY; i++) CHECK(!a.about[i]);
}

typedef struct probe {
    const soup *s;
    double at[3];
    size_t asked;
} probe;

static double nearest(void *user, const uint32_t *items, uint32_t count, double least) {
    probe *p = user;
    for (uint32_t i = 0; i < count; i++, p->asked++) {
        const double(*c)[3] = p->s->corner[items[i]];
        double w[3], d = sqrt(triangle_nearest(w, c[0], c[1], c[2], p->at));
        if (d < least) least = d;
    }
    return least;
}

static double remembered;

static double nearest_remembered(void *user, const uint32_t *items, uint32_t count, double least) {
    return remembered = nearest(user, items, count, least);
}

static void the_nearest_of_all_is_found(void) {
    static soup s;
    static uint32_t all[MANY];
    size_t asked = 0;
    make_soup(&s, MANY, 0.0);
    for (uint32_t i = 0; i < MANY; i++) all[i] = i;
    for (uint64_t q = 0; q < QUERIES; q++) {
        probe p = { &s, { random_in(3 * q, -2, 2), random_in(3 * q + 1, -2, 2), random_in(3 * q + 2, -2, 2) }, 0 };
        double expected = nearest(&p, all, MANY, INFINITY);
        p.asked = 0;
        remembered = INFINITY;
        bvh_closest(&s.tree, p.at, INFINITY, nearest_remembered, &p);
        CHECK_NEAR(remembered, expected, 0.0);
        asked += p.asked;
        p.asked = 0;
        bvh_closest(&s.tree, p.at, 0.0, nearest_remembered, &p);
        CHECK_EQUAL(p.asked, 0);
    }
    CHECK(asked < QUERIES * MANY / 8);
}

static void boxes_are_rounded_outwards(void) {
    const double x = 1.0 + 0x1p-40, points[2][3] = { { x, -x, 0.1 }, { x, -x, 0.3 } };
    bvh_box box;
    bvh_box_set(&box, 7, points, 2, 0.0);
    CHECK_EQUAL(box.item, 7);
    CHECK_NEAR(box.low[0], 1.0, 0.0);
    CHECK_NEAR(box.high[0], nextafterf(1.0f, 2.0f), 0.0);
    CHECK_NEAR(box.low[1], -nextafterf(1.0f, 2.0f), 0.0);
    CHECK_NEAR(box.high[1], -1.0, 0.0);
    CHECK(box.low[2] <= 0.1 && box.high[2] >= 0.3);
}

int main(void) {
    RUN(halves_lie_beside_each_other);
    RUN(every_item_is_in_one_leaf_that_holds_it);
    RUN(a_segment_is_asked_about_all_it_meets);
    RUN(threads_make_the_same_tree);
    RUN(a_segment_is_asked_about_little_else);
    RUN(the_nearest_of_all_is_found);
    RUN(boxes_are_rounded_outwards);
    return check_end();
}
