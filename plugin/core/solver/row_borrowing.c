/* SPDX-License-Identifier: MIT
 * What lights a room may be so small as seen from a corner of it that no ray of all the groups that share finds it: a
 * window of 14 cm in a room of 6 m left a fifth of the floor black, and what did find it burnt. Those who see it from
 * nearer by know where it is. Shares of groups that follow each other are taken together by eights, these again, and so
 * on until all are one; whoever found little takes the targets of the smallest of these that found enough.
 */
#include "solver/row_guiding.h"

#include <string.h>

enum { CHILDREN = 8 };

/* What so many groups found together. */
typedef struct found_targets {
    uint32_t count;
    row_target targets[ROW_LOBES_SHARED];
} found_targets;

static size_t parents_of(size_t count) {
    return (count + CHILDREN - 1) / CHILDREN;
}

static size_t share_count(const row_guiding *a) {
    return (a->group_count + ROW_GROUPS_SHARING - 1) / ROW_GROUPS_SHARING;
}

/* Of all levels. */
static size_t list_count(const row_guiding *a) {
    size_t level = share_count(a), sum = level;
    for (; level > 1; sum += level) level = parents_of(level);
    return sum;
}

static found_targets of_share(const row_guiding *a, size_t share) {
    const row_group *g = &a->groups[ROW_GROUPS_SHARING * share];
    found_targets out = { .count = g->target_count - g->own_count };
    memcpy(out.targets, g->targets + g->own_count, out.count * sizeof *out.targets);
    return out;
}

/* As many as there is room for, evenly out of all. */
static found_targets joined(const found_targets *children, size_t count) {
    found_targets out = { 0 };
    size_t all = 0, before = 0;
    for (size_t i = 0; i < count; i++) all += children[i].count;
    const size_t most = all < ROW_LOBES_SHARED ? all : ROW_LOBES_SHARED;
    for (size_t i = 0; i < count; before += children[i++].count)
        for (; out.count < most; out.count++) {
            size_t which = (2 * out.count + 1) * all / (2 * most);
            if (which >= before + children[i].count) break;
            out.targets[out.count] = children[i].targets[which - before];
        }
    return out;
}

static void set_lists(const row_guiding *a, found_targets *lists) {
    size_t count = share_count(a);
    for (size_t i = 0; i < count; i++) lists[i] = of_share(a, i);
    while (count > 1) {
        size_t parents = parents_of(count);
        for (size_t i = 0; i < parents; i++) {
            size_t first = CHILDREN * i;
            lists[count + i] = joined(lists + first, count - first < CHILDREN ? count - first : CHILDREN);
        }
        lists += count, count = parents;
    }
}

/* The smallest whole that a share is in that found enough; else all. */
static const found_targets *lender_of(const found_targets *level, size_t share, size_t count) {
    while (count > 1 && level[share].count < ROW_LOBES_SHARED) {
        level += count;
        count = parents_of(count), share /= CHILDREN;
    }
    return &level[share];
}

bool row_guiding_borrow(row_guiding *a, allocator *memory) {
    found_targets *lists = block_new(memory, (list_count(a) + 1) * sizeof *lists);
    if (!lists) return false;
    set_lists(a, lists);
    for (size_t i = 0; i < a->group_count; i++) {
        row_group *g = &a->groups[i];
        if (g->target_count >= ROW_LOBES_SHARED) continue;
        const found_targets *from = lender_of(lists, i / ROW_GROUPS_SHARING, share_count(a));
        memcpy(g->targets + g->target_count, from->targets, from->count * sizeof *from->targets);
        g->target_count += from->count;
        row_group_set_radii(g);
    }
    block_free(lists);
    return true;
}
