/* SPDX-License-Identifier: MIT */
#include "visibility/visible_part.h"

#include "geometry/plane.h"

#include <string.h>

/* A fragment of more corners than this is cut in two before it is clipped again, so that clipping always has room. */
enum { FRAGMENTS_MAX = 96, CORNERS_SPLIT = 6 };

/* ---- which blockers ---- */

static bool all_below(const polygon *p, const double normal[3], double plane) {
    for (int i = 0; i < p->count; i++)
        if (vec3_dot(normal, p->corner[i]) > plane) return false;
    return true;
}

/* Does a plane through an edge of `edges` and a corner of `corners` have both on one side and the blocker on the other?
 * Such planes bound the convex hull of two convex polygons. */
static bool is_outside_hull(const polygon *edges, const polygon *corners, const polygon *shape, double margin) {
    for (int i = 0; i < edges->count; i++) {
        const double *a = edges->corner[i], *b = edges->corner[(i + 1) % edges->count];
        for (int j = 0; j < corners->count; j++) {
            double along[3], across[3], n[3];
            vec3_sub(along, b, a);
            vec3_sub(across, corners->corner[j], a);
            vec3_cross(n, along, across);
            if (vec3_normalize(n) == 0.0) continue;
            for (int side = 0; side < 2; side++) {
                double plane = vec3_dot(n, a);
                if (all_below(edges, n, plane + margin) && all_below(corners, n, plane + margin)) {
                    double flipped[3] = { -n[0], -n[1], -n[2] };
                    if (all_below(shape, flipped, -plane + margin)) return true;
                }
                n[0] = -n[0], n[1] = -n[1], n[2] = -n[2];
            }
        }
    }
    return false;
}

bool blocker_list_add(blocker_list *list, const facing_pair *pair, const polygon *shape, const double normal[3],
                      double plane) {
    polygon front, between;
    if (all_below(shape, pair->normal_a, pair->plane_a + pair->margin)) return true;
    if (all_below(shape, pair->normal_b, pair->plane_b + pair->margin)) return true;
    polygon_clip(&front, shape, pair->normal_a, pair->plane_a + pair->margin);
    polygon_clip(&between, &front, pair->normal_b, pair->plane_b + pair->margin);
    if (between.count < 3) return true;
    if (is_outside_hull(pair->a, pair->b, &between, pair->margin) ||
        is_outside_hull(pair->b, pair->a, &between, pair->margin))
        return true;
    if (!block_grow(list->memory, (void **)&list->blockers, &list->capacity, list->count, sizeof *list->blockers))
        return false;
    blocker *added = &list->blockers[list->count++];
    added->shape = between;
    vec3_copy(added->normal, normal);
    added->plane = plane;
    return true;
}

void blocker_list_free(blocker_list *list) {
    block_free(list->blockers);
    *list = (blocker_list){ .memory = list->memory };
}

/* ---- what is left ---- */

typedef struct fragments {
    polygon piece[FRAGMENTS_MAX];
    int count;
    bool lost;
} fragments;

static void push(fragments *f, const polygon *p) {
    if (p->count < 3) return;
    if (f->count == FRAGMENTS_MAX) {
        f->lost = true;
        return;
    }
    f->piece[f->count++] = *p;
}

/* The side plane of the pyramid from the point through edge i of the blocker, its normal to the inside. False for an
 * edge that points at the point. */
static bool side_plane(const blocker *b, int i, const double point[3], double n[3]) {
    double u[3], v[3], w[3], center[3];
    vec3_sub(u, b->shape.corner[i], point);
    vec3_sub(v, b->shape.corner[(i + 1) % b->shape.count], point);
    vec3_cross(n, u, v);
    if (vec3_normalize(n) == 0.0) return false;
    polygon_centroid(&b->shape, center);
    vec3_sub(w, center, point);
    if (vec3_dot(n, w) < 0.0) n[0] = -n[0], n[1] = -n[1], n[2] = -n[2];
    return true;
}

/* Cuts away side by side what lies outside the pyramid; what remains is hidden. */
static void subtract(fragments *out, polygon rest, const blocker *b, const double point[3]) {
    for (int i = 0; i < b->shape.count && rest.count >= 3; i++) {
        double n[3], flipped[3];
        polygon outside, inside;
        if (!side_plane(b, i, point, n)) continue;
        double plane = vec3_dot(n, point);
        for (int k = 0; k < 3; k++) flipped[k] = -n[k];
        polygon_clip(&outside, &rest, flipped, -plane);
        polygon_clip(&inside, &rest, n, plane);
        push(out, &outside);
        rest = inside;
    }
}

static void subtract_piece(fragments *out, const polygon *piece, const blocker *b, const double point[3]) {
    if (piece->count <= CORNERS_SPLIT) {
        subtract(out, *piece, b, point);
        return;
    }
    int half = piece->count / 2;
    polygon first = { .count = half + 1 }, second = { .count = piece->count - half + 1 };
    memcpy(first.corner, piece->corner, (size_t)(half + 1) * sizeof *first.corner);
    memcpy(second.corner, piece->corner + half, (size_t)(piece->count - half) * sizeof *second.corner);
    vec3_copy(second.corner[piece->count - half], piece->corner[0]);
    subtract(out, first, b, point);
    subtract(out, second, b, point);
}

double visible_factor(const blocker_list *list, const polygon *target, const double point[3], const double normal[3],
                      double margin, bool *lost) {
    fragments front, back;
    fragments *now = &front, *next = &back;
    double sum = 0.0;
    front.count = 1;
    front.lost = false;
    front.piece[0] = *target;
    for (size_t i = 0; i < list->count && now->count > 0; i++) {
        const blocker *b = &list->blockers[i];
        /* Seen edge-on it hides nothing. */
        if (fabs(plane_height(b->normal, b->plane, point)) <= margin) continue;
        next->count = 0;
        next->lost = now->lost;
        for (int k = 0; k < now->count; k++) subtract_piece(next, &now->piece[k], b, point);
        fragments *swap = now;
        now = next;
        next = swap;
    }
    if (now->lost) *lost = true;
    for (int k = 0; k < now->count; k++) sum += polygon_factor(&now->piece[k], point, normal);
    return sum;
}
