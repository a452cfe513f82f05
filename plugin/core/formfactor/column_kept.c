/* SPDX-License-Identifier: MIT
 * See column_kept.h. What is kept is the head below, then runs, factors, tints, paths and what the hemi-cube saw.
 */
#include "formfactor/column_kept.h"

#include <math.h>
#include <string.h>

enum { SPLIT = 1, CROWDED = 2, CROSSED = 4, TINTED = 8, PART_COUNT = 6, DEPTH_MAX = 15 };

typedef struct kept_head {
    uint64_t run_count, factor_count, path_count, packed_count, hemicubes, analytic, evaluations, flags;
    double subpatch_scale, front, back, sky, total, scale, largest, penumbra;
} kept_head;

/* A cluster that is dissolved leaves a single patch of its number. */
static uint64_t item_of(const subpatch *shooter) {
    return (uint64_t)(shooter->cluster != NULL) << 63 | shooter->path << 32 | shooter->patch;
}

static bool has_item(const subpatch *shooter) {
    return shooter->path >> 31 == 0;
}

static kept_head head_of(const column *c) {
    return (kept_head){ .run_count = c->run_count,
                        .factor_count = c->factor_count,
                        .path_count = c->path_count,
                        .packed_count = c->packed_count,
                        .hemicubes = c->hemicubes,
                        .analytic = c->analytic,
                        .evaluations = c->evaluations,
                        .flags = (uint64_t)(c->split * SPLIT | c->crowded * CROWDED | c->crossed * CROSSED |
                                            (c->tints != NULL) * TINTED),
                        .subpatch_scale = c->subpatch_scale,
                        .front = c->closure.front,
                        .back = c->closure.back,
                        .sky = c->closure.sky,
                        .total = c->total,
                        .scale = c->scale,
                        .largest = c->largest,
                        .penumbra = c->penumbra };
}

static void set_head(column *c, const kept_head *h) {
    c->hemicubes = (uint32_t)h->hemicubes, c->analytic = h->analytic, c->evaluations = h->evaluations;
    c->split = h->flags & SPLIT, c->crowded = h->flags & CROWDED, c->crossed = h->flags & CROSSED;
    c->subpatch_scale = h->subpatch_scale;
    c->closure = (hemicube_closure){ h->front, h->back, h->sky };
    c->total = h->total, c->scale = h->scale, c->largest = h->largest, c->penumbra = h->penumbra;
}

/* The arrays of a column, the head before them. */
static size_t list(const column *c, kept_head *head, kept_part parts[PART_COUNT]) {
    const kept_part all[PART_COUNT] = { { head, sizeof *head },
                                        { c->runs, c->run_count * sizeof *c->runs },
                                        { c->factors, c->factor_count * sizeof *c->factors },
                                        { c->tints, c->tints ? 3 * c->factor_count * sizeof *c->tints : 0 },
                                        { c->paths, c->path_count * sizeof *c->paths },
                                        { c->packed, 2 * c->packed_count * sizeof *c->packed } };
    size_t size = 0;
    for (int i = 0; i < PART_COUNT; i++) parts[i] = all[i], size += all[i].size;
    return size;
}

void column_kept_give(const kept_pass *p, const subpatch *shooter, const column *c) {
    kept_part parts[PART_COUNT];
    if (!p->in || !has_item(shooter)) return;
    kept_head head = head_of(c);
    list(c, &head, parts);
    kept_give(p, item_of(shooter), parts, PART_COUNT);
}

/* ---- what is kept may be anybody's bytes ---- */

static bool are_runs(const column *c, const mesh *m) {
    size_t next = 0;
    for (size_t i = 0; i < c->run_count; i++) {
        const column_run *run = &c->runs[i];
        if (run->patch >= m->patch_count || (i > 0 && run->patch <= run[-1].patch) || run->first != next) return false;
        if (!isfinite(run->factor) || !isfinite(run->tint[0] + run->tint[1] + run->tint[2])) return false;
        next += m->patches[run->patch].sample_count;
    }
    return next == c->factor_count;
}

static bool are_factors(const float *all, size_t count) {
    bool ok = true;
    for (size_t i = 0; all && i < count; i++) ok &= all[i] >= 0.0f && all[i] < INFINITY;
    return ok;
}

/* Each leads back to the shooter. */
static bool are_paths(const column *c, uint64_t whole) {
    for (size_t i = 0; i < c->path_count; i++) {
        uint64_t path = c->paths[i];
        for (int depth = 0; path != whole && path > 0 && depth < DEPTH_MAX; depth++) path = (path - 1) / 4;
        if (path != whole) return false;
    }
    return true;
}

/* All pixels of a hemi-cube, each of a triangle that is drawn. */
static bool is_cube(const column *c, const column_setup *setup) {
    uint64_t pixels = 0, all = 3 * (uint64_t)setup->resolution * (uint64_t)setup->resolution;
    for (size_t i = 0; i < c->packed_count; i++) {
        pixels += c->packed[2 * i + 1];
        if ((c->packed[2 * i] & ~ITEM_MARK) > setup->items.triangle_count || pixels > all) return false;
    }
    return c->packed_count == 0 || pixels == all;
}

static bool is_head(const kept_head *h) {
    const double numbers[] = {
        h->subpatch_scale, h->front, h->back, h->sky, h->total, h->scale, h->largest, h->penumbra
    };
    bool ok = h->flags < 2 * TINTED && h->hemicubes <= UINT32_MAX;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) ok &= isfinite(numbers[i]) != 0;
    return ok;
}

/* Room for so many of each; NULL: there is none, or so many cannot be in so few bytes. */
static column *make_room(allocator *memory, const kept_head *h, size_t size) {
    if (h->run_count > size || h->factor_count > size || h->path_count > size || h->packed_count > size) return NULL;
    column *c = column_create(memory, h->run_count, h->factor_count);
    if (!c) return NULL;
    if (h->flags & TINTED) c->tints = block_new(memory, (3 * h->factor_count + 1) * sizeof *c->tints);
    if (h->path_count > 0) c->paths = block_new(memory, h->path_count * sizeof *c->paths);
    if (h->packed_count > 0) c->packed = block_new(memory, 2 * h->packed_count * sizeof *c->packed);
    c->path_count = c->paths ? h->path_count : 0;
    c->packed_count = c->packed ? h->packed_count : 0;
    if ((c->tints || !(h->flags & TINTED)) && c->path_count == h->path_count && c->packed_count == h->packed_count)
        return c;
    column_destroy(c);
    return NULL;
}

column *column_kept_take(const kept_pass *p, const column_setup *setup, const subpatch *shooter) {
    kept_head head;
    kept_part parts[PART_COUNT];
    size_t size = 0, at = 0;
    if (!p->in || !has_item(shooter)) return NULL;
    unsigned char *bytes = kept_take_block(p, item_of(shooter), &size);
    column *c = NULL;
    if (bytes && size >= sizeof head) {
        memcpy(&head, bytes, sizeof head);
        c = is_head(&head) ? make_room(setup->mesh->memory, &head, size) : NULL;
    }
    bool ok = c && list(c, &head, parts) == size;
    for (int i = 0; ok && i < PART_COUNT; at += parts[i++].size)
        if (parts[i].size > 0) memcpy(parts[i].bytes, bytes + at, parts[i].size);
    block_free(bytes);
    if (ok && are_runs(c, setup->mesh) && are_factors(c->factors, c->factor_count) &&
        are_factors(c->tints, 3 * c->factor_count) && are_paths(c, shooter->path) && is_cube(c, setup)) {
        set_head(c, &head);
        return c;
    }
    column_destroy(c);
    return NULL;
}
