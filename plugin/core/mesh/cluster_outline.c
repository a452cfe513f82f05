/* SPDX-License-Identifier: MIT */
#include "mesh/cluster_outline.h"

#include "geometry/triangle.h"

/* Corners that change the area of the outline by less than this share are always left out. */
static const double STRAIGHT = 1e-3;

/* A corner of the outline: its vertex, and those before and after it that are still there. */
typedef struct outline_corner {
    uint32_t vertex, before, after;
    bool gone;
} outline_corner;

static bool is_border(const cluster_edges *e, uint32_t edge) {
    uint32_t mate = e->mate[edge];
    return mate == NO_INDEX || e->group[mate / 4] != e->group[edge / 4];
}

static uint32_t next_edge(const cluster_edges *e, uint32_t edge) {
    uint32_t i = edge / 4, k = edge % 4 + 1;
    return 4 * i + (k == (uint32_t)surface_corner_count(&e->scene->surfaces[i]) ? 0 : k);
}

/* The edge of the outline that follows one: turns about its end through all surfaces there. NO_INDEX if there is none
 * within `most` turns. */
static uint32_t follow(const cluster_edges *e, uint32_t edge, size_t most) {
    uint32_t at = next_edge(e, edge);
    for (size_t turns = 0; turns < most; turns++) {
        if (is_border(e, at)) return at;
        at = next_edge(e, e->mate[at]);
    }
    return NO_INDEX;
}

static uint32_t first_edge(const cluster_edges *e, const uint32_t *surfaces, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < (uint32_t)surface_corner_count(&e->scene->surfaces[surfaces[i]]); k++)
            if (is_border(e, 4 * surfaces[i] + k)) return 4 * surfaces[i] + k;
    return NO_INDEX;
}

/* One way round must meet all edges. */
static bool trace(const cluster_edges *e, uint32_t first, size_t turns, size_t edge_count, outline_corner *out) {
    uint32_t at = first;
    if (first == NO_INDEX || edge_count < 3) return false;
    for (size_t i = 0; i < edge_count; i++) {
        out[i] = (outline_corner){ .vertex = e->scene->surfaces[at / 4].corner[at % 4],
                                   .before = (uint32_t)(i ? i - 1 : edge_count - 1),
                                   .after = (uint32_t)(i + 1 < edge_count ? i + 1 : 0) };
        at = follow(e, at, turns);
        if (at == NO_INDEX || (at == first) != (i + 1 == edge_count)) return false;
    }
    return true;
}

static const double *position(const cluster_edges *e, const outline_corner *all, uint32_t index) {
    return scene_vertex(e->scene, all[index].vertex);
}

/* Returns a corner that is left. */
static uint32_t leave_out(const cluster_edges *e, outline_corner *all, size_t count, double area) {
    uint32_t some = 0;
    for (size_t left = count; left > 3; left--) {
        uint32_t least = NO_INDEX;
        double least_area = INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            double a = all[i].gone ? INFINITY
                                   : triangle_area(position(e, all, i), position(e, all, all[i].before),
                                                   position(e, all, all[i].after));
            if (a < least_area) least = i, least_area = a;
        }
        if (left <= CLUSTER_CORNERS_MAX && least_area > STRAIGHT * area) break;
        if (least == NO_INDEX) break;
        all[least].gone = true;
        all[all[least].before].after = all[least].after;
        all[all[least].after].before = all[least].before;
        some = all[least].after;
    }
    return some;
}

bool cluster_outline(const cluster_edges *e, const uint32_t *surfaces, size_t count, size_t edge_count, cluster *out) {
    outline_corner *all = block_zeroed(e->scene->memory, edge_count + 1, sizeof *all);
    bool ok = all && trace(e, first_edge(e, surfaces, count), 4 * count, edge_count, all);
    out->corner_count = 0;
    if (ok) {
        uint32_t first = leave_out(e, all, edge_count, out->area), at = first;
        do {
            vec3_copy(out->corner[out->corner_count++], position(e, all, at));
            at = all[at].after;
        } while (at != first && out->corner_count < CLUSTER_CORNERS_MAX);
        ok = at == first;
    }
    block_free(all);
    return ok;
}
