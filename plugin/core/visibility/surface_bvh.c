/* SPDX-License-Identifier: MIT */
#include "visibility/surface_bvh.h"

#include "base/tolerance.h"
#include "geometry/bvh.h"
#include "visibility/occlusion.h"

/* Boxes are this much wider than what is in them, relative to the scene's radius, so that a path along a face of one is
 * not lost to a rounding; occlusion.h decides. */
static const double BOX_MARGIN = 1e-9;

struct surface_bvh {
    bvh tree;
};

static void set_box(const scene *s, uint32_t index, bvh_box *out) {
    const surface *f = &s->surfaces[index];
    int count = surface_corner_count(f);
    double corner[4][3];
    for (int i = 0; i < count; i++) vec3_copy(corner[i], scene_vertex(s, f->corner[i]));
    bvh_box_set(out, index, corner, count, BOX_MARGIN * s->radius);
}

surface_bvh *surface_bvh_create(const scene *s) {
    surface_bvh *out = block_zeroed(s->memory, 1, sizeof *out);
    bvh_box *boxes = block_new(s->memory, (s->surface_count + 1) * sizeof *boxes);
    size_t count = 0;
    for (uint32_t i = 0; boxes && i < s->surface_count; i++)
        if (surface_sheet(s, i) == i && !s->surfaces[i].pane) set_box(s, i, &boxes[count++]);
    if (out) {
        out->tree.nodes = block_new(s->memory, (2 * count + 1) * sizeof *out->tree.nodes);
        out->tree.items = block_new(s->memory, (count + 1) * sizeof *out->tree.items);
    }
    bool ok = out && boxes && out->tree.nodes && out->tree.items;
    if (ok) bvh_build(NULL, &out->tree, boxes, count);
    block_free(boxes);
    if (ok) return out;
    surface_bvh_destroy(out);
    return NULL;
}

void surface_bvh_destroy(surface_bvh *tree) {
    if (!tree) return;
    block_free_all(tree->tree.nodes, tree->tree.items, tree);
}

typedef struct path {
    const scene *s;
    const double *from, *to;
    uint32_t own;
} path;

static bool is_blocked(void *user, const uint32_t *surfaces, uint32_t count) {
    const path *p = user;
    for (uint32_t i = 0; i < count; i++) {
        const surface *f = &p->s->surfaces[surfaces[i]];
        double t;
        if (surfaces[i] == p->own || !occlusion_crossing(f, p->from, p->to, &t)) continue;
        if (t > TOLERANCE_SEGMENT_END && t < 1 - TOLERANCE_SEGMENT_END && occlusion_inside(p->s, f, p->from, p->to, t))
            return true;
    }
    return false;
}

bool surface_bvh_blocks(const surface_bvh *tree, const scene *s, uint32_t own, const double from[3],
                        const double to[3]) {
    path p = { s, from, to, own };
    return bvh_segment(&tree->tree, from, to, is_blocked, &p);
}
