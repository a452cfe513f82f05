/* SPDX-License-Identifier: MIT
 * See bvh.h. Halves by number leave no more than 32 levels.
 */
#include "geometry/bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So few boxes, of which a half may be a leaf, are sorted, and more after so many halvings at most. */
enum { LEAF_ITEMS = 4, STACK = 64, SORTED_ITEMS = 2 * LEAF_ITEMS + 1, TRIES_MOST = 64 };

/* From so many items on the tree is made in so many parts, by all threads. */
enum { MANY_ITEMS = 1 << 14, PARTS = 64 };

/* Comparisons instead of fmin and fmax, which are calls: boxes hold no NaN. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}

static inline double greater(double a, double b) {
    return a > b ? a : b;
}

/* ---- building ---- */

static float round_down(double x) {
    float f = (float)x;
    return f > x ? nextafterf(f, -INFINITY) : f;
}

static float round_up(double x) {
    float f = (float)x;
    return f < x ? nextafterf(f, INFINITY) : f;
}

void bvh_box_set(bvh_box *box, uint32_t item, const double (*points)[3], int count, double margin) {
    box->item = item;
    for (int k = 0; k < 3; k++) {
        double low = points[0][k], high = points[0][k];
        box->middle[k] = (float)points[0][k];
        for (int i = 1; i < count; i++) {
            low = lesser(low, points[i][k]);
            high = greater(high, points[i][k]);
            box->middle[k] += (float)points[i][k];
        }
        box->low[k] = round_down(low - margin);
        box->high[k] = round_up(high + margin);
    }
}

static int compare(const bvh_box *a, const bvh_box *b, int axis) {
    if (a->middle[axis] != b->middle[axis]) return a->middle[axis] < b->middle[axis] ? -1 : 1;
    return (a->item > b->item) - (a->item < b->item);
}

static int compare_x(const void *a, const void *b) {
    return compare(a, b, 0);
}

static int compare_y(const void *a, const void *b) {
    return compare(a, b, 1);
}

static int compare_z(const void *a, const void *b) {
    return compare(a, b, 2);
}

static void swap(bvh_box *a, bvh_box *b) {
    bvh_box t = *a;
    *a = *b;
    *b = t;
}

/* The median of the first, the middle and the last, put first. */
static void take_median(bvh_box *boxes, size_t count, int axis) {
    bvh_box *a = boxes, *b = boxes + count / 2, *c = boxes + count - 1;
    if (compare(a, b, axis) > 0) swap(a, b);
    if (compare(b, c, axis) > 0) swap(b, c);
    if (compare(a, b, axis) > 0) swap(a, b);
    swap(a, b);
}

/* Puts those before the first box in order before it, and says how many they are. */
static size_t partition(bvh_box *boxes, size_t count, int axis) {
    size_t low = 1, high = count - 1;
    for (;;) {
        while (low <= high && compare(&boxes[low], &boxes[0], axis) < 0) low++;
        while (low <= high && compare(&boxes[high], &boxes[0], axis) > 0) high--;
        if (low >= high) break;
        swap(&boxes[low++], &boxes[high--]);
    }
    swap(&boxes[0], &boxes[high]);
    return high;
}

/* By insertion, which for so few is the fastest. */
static void sort_few(bvh_box *boxes, size_t count, int axis) {
    for (size_t i = 1; i < count; i++) {
        const bvh_box one = boxes[i];
        size_t at = i;
        for (; at > 0 && compare(&one, &boxes[at - 1], axis) < 0; at--) boxes[at] = boxes[at - 1];
        boxes[at] = one;
    }
}

/* Puts the lowest `half` boxes first, in any order: no more than that is asked of halves that are split again. A bad
 * order of the input ends in a sort, so that it costs no more than one [Musser97]. */
static void select_half(bvh_box *boxes, size_t count, size_t half, int axis) {
    static int (*const order[3])(const void *, const void *) = { compare_x, compare_y, compare_z };
    for (int tries = 0; count > SORTED_ITEMS && tries < TRIES_MOST; tries++) {
        take_median(boxes, count, axis);
        size_t at = partition(boxes, count, axis);
        if (at == half) return;
        if (at > half)
            count = at;
        else
            boxes += at + 1, half -= at + 1, count -= at + 1;
        if (half == 0 || count == 0) return;
    }
    if (count > SORTED_ITEMS)
        qsort(boxes, count, sizeof *boxes, order[axis]);
    else
        sort_few(boxes, count, axis);
}

static void set_bounds(bvh_node *n, const bvh_box *boxes) {
    for (int k = 0; k < 3; k++) {
        n->low[k] = INFINITY, n->high[k] = -INFINITY;
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            n->low[k] = boxes[i].low[k] < n->low[k] ? boxes[i].low[k] : n->low[k];
            n->high[k] = boxes[i].high[k] > n->high[k] ? boxes[i].high[k] : n->high[k];
        }
    }
}

/* How many nodes are above so many items, and above one more. Halves have no other numbers of items than these two. */
static void count_nodes(size_t items, size_t out[2]) {
    size_t of_half[2];
    if (items < LEAF_ITEMS) {
        out[0] = out[1] = 1;
        return;
    }
    count_nodes(items / 2, of_half);
    bool is_odd = items % 2 != 0;
    out[0] = items <= LEAF_ITEMS ? 1 : 1 + of_half[0] + of_half[is_odd];
    out[1] = 1 + of_half[is_odd] + of_half[1];
}

/* A node whose items are in place, and the first number of those below it. */
typedef struct part {
    uint32_t node, next;
} part;

/* Halves a node; false: it is a leaf. Numbers are those of a walk through the whole tree, whoever makes which part. */
static bool halve(bvh *tree, part whole, bvh_box *boxes, part halves[2]) {
    bvh_node *n = &tree->nodes[whole.node];
    uint32_t first = n->first, half = n->count / 2, child = whole.next;
    size_t nodes[2];
    int axis = 0;
    set_bounds(n, boxes);
    if (n->count <= LEAF_ITEMS) return false;
    for (int k = 1; k < 3; k++)
        if (n->high[k] - n->low[k] > n->high[axis] - n->low[axis]) axis = k;
    select_half(boxes + first, n->count, half, axis);
    count_nodes(half, nodes);
    tree->nodes[child] = (bvh_node){ .first = first, .count = half };
    tree->nodes[child + 1] = (bvh_node){ .first = first + half, .count = n->count - half };
    halves[0] = (part){ child, child + 2 };
    halves[1] = (part){ child + 1, child + 1 + (uint32_t)nodes[0] };
    n->first = child;
    n->count = 0;
    return true;
}

static void split(bvh *tree, part whole, bvh_box *boxes) {
    part halves[2];
    if (!halve(tree, whole, boxes, halves)) return;
    split(tree, halves[0], boxes);
    split(tree, halves[1], boxes);
}

typedef struct building {
    bvh *tree;
    bvh_box *boxes;
    part parts[PARTS], halves[PARTS];
} building;

static void halve_part(void *user, size_t i, unsigned worker) {
    building *b = user;
    (void)worker;
    halve(b->tree, b->parts[i], b->boxes, b->halves + 2 * i);
}

static void split_part(void *user, size_t i, unsigned worker) {
    building *b = user;
    (void)worker;
    split(b->tree, b->parts[i], b->boxes);
}

void bvh_build(jobs *j, bvh *tree, bvh_box *boxes, size_t count) {
    building b = { .tree = tree, .boxes = boxes, .parts = { { 0, 1 } } };
    size_t parts = 1, nodes[2];
    tree->node_count = 0;
    if (count == 0) return;
    count_nodes(count, nodes);
    tree->node_count = (uint32_t)nodes[0];
    tree->nodes[0] = (bvh_node){ .count = (uint32_t)count };
    for (; count >= MANY_ITEMS && parts < PARTS; parts *= 2) {
        jobs_run(j, parts, halve_part, NULL, &b);
        memcpy(b.parts, b.halves, 2 * parts * sizeof *b.parts);
    }
    jobs_run(count >= MANY_ITEMS ? j : NULL, parts, split_part, NULL, &b);
    for (size_t i = 0; i < count; i++) tree->items[i] = boxes[i].item;
}

/* ---- looking ---- */

/* Does the segment from + t d, t in [0, 1], meet the box? inverse: 1 / d. */
static inline bool meets(const bvh_node *n, const double from[3], const double inverse[3]) {
    double enter = 0.0, leave = 1.0;
    for (int k = 0; k < 3; k++) {
        double a = (n->low[k] - from[k]) * inverse[k], b = (n->high[k] - from[k]) * inverse[k];
        enter = greater(enter, lesser(a, b));
        leave = lesser(leave, greater(a, b));
    }
    return enter <= leave;
}

/* 1 / d, and where d is 0 a number so large that what lies beside the box misses it, but finite: 0 times it is 0. */
static double inverse_of(double d) {
    static const double LARGEST = 1e300;
    return fabs(d) * LARGEST > 1.0 ? 1.0 / d : LARGEST;
}

bool bvh_segment(const bvh *tree, const double from[3], const double to[3], bvh_stops stops, void *user) {
    uint32_t waiting[STACK], count = 0;
    double inverse[3];
    for (int k = 0; k < 3; k++) inverse[k] = inverse_of(to[k] - from[k]);
    if (tree->node_count > 0) waiting[count++] = 0;
    while (count > 0) {
        const bvh_node *n = &tree->nodes[waiting[--count]];
        if (!meets(n, from, inverse)) continue;
        if (n->count > 0) {
            if (stops(user, tree->items + n->first, n->count)) return true;
        } else {
            waiting[count++] = n->first + 1;
            waiting[count++] = n->first;
        }
    }
    return false;
}

static inline double squared_distance(const bvh_node *n, const double point[3]) {
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = greater(greater(n->low[k] - point[k], point[k] - n->high[k]), 0.0);
        sum += d * d;
    }
    return sum;
}

void bvh_closest(const bvh *tree, const double point[3], double least, bvh_nearest nearest, void *user) {
    struct waiting {
        uint32_t node;
        double squared;
    } waiting[STACK];
    uint32_t count = 0;
    if (tree->node_count > 0) waiting[count++] = (struct waiting){ 0, squared_distance(tree->nodes, point) };
    while (count > 0) {
        struct waiting next = waiting[--count];
        const bvh_node *n = &tree->nodes[next.node];
        if (next.squared >= least * least) continue;
        if (n->count > 0) {
            least = nearest(user, tree->items + n->first, n->count, least);
            continue;
        }
        struct waiting a = { n->first, squared_distance(&tree->nodes[n->first], point) },
                       b = { n->first + 1, squared_distance(&tree->nodes[n->first + 1], point) };
        bool b_first = b.squared < a.squared;
        waiting[count++] = b_first ? a : b;
        waiting[count++] = b_first ? b : a;
    }
}

bool bvh_visit(const bvh *tree, bvh_enters enters, bvh_takes takes, void *user) {
    uint32_t waiting[STACK], count = 0;
    if (tree->node_count > 0) waiting[count++] = 0;
    while (count > 0) {
        const bvh_node *n = &tree->nodes[waiting[--count]];
        if (!enters(user, n)) continue;
        if (n->count > 0) {
            if (!takes(user, tree->items + n->first, n->count)) return false;
        } else {
            waiting[count++] = n->first + 1;
            waiting[count++] = n->first;
        }
    }
    return true;
}
