/* SPDX-License-Identifier: MIT */
#include "mesh/contact_faces.h"

#include <string.h>

/* Elements are cut along the edges of faces and along the lines; the two must be one line for them. */
static const double SNAP = 1e-3;

/* Nobody else's edges are these. */
static uint32_t new_number(void *user, int k, double at[3], double reach) {
    uint32_t *next = user;
    (void)k, (void)at, (void)reach;
    return (*next)++;
}

static int corner_count_of(const uint8_t face[4]) {
    return face[3] == PIECE_NONE ? 3 : 4;
}

/* Every edge that is not on the border of the patch, once. */
static void list_chords(contact_faces *f) {
    for (int i = 0; i < f->count; i++) {
        int n = corner_count_of(f->face[i]);
        for (int k = 0; k < n; k++) {
            int a = f->face[i][k], b = f->face[i][(k + 1) % n];
            if (a > b || f->cut.points[a].edges & f->cut.points[b].edges) continue;
            contact_line *chord = &f->chords[f->chord_count++];
            vec3_copy(chord->from, f->cut.points[a].at);
            vec3_copy(chord->to, f->cut.points[b].at);
        }
    }
}

static void set_inward(contact_faces *f) {
    for (int i = 0; i < f->count; i++) {
        int n = corner_count_of(f->face[i]);
        for (int k = 0; k < n; k++) {
            double edge[3];
            vec3_sub(edge, f->cut.points[f->face[i][(k + 1) % n]].at, f->cut.points[f->face[i][k]].at);
            vec3_cross(f->inward[i][k], f->cut.normal, edge);
            vec3_normalize(f->inward[i][k]);
        }
    }
}

/* False if there are too many faces. */
static bool list_faces(contact_faces *f) {
    for (int i = 0; i < f->cut.count; i++) {
        uint8_t face[PIECE_POINTS_MAX][4];
        int count = pieces_faces(&f->cut, &f->cut.all[i], face);
        if (f->count + count > CONTACT_FACES_MAX) return false;
        memcpy(f->face[f->count], face, (size_t)count * sizeof *face);
        f->count += count;
    }
    return true;
}

void contact_faces_find(const double (*corner)[3], int corner_count, const double normal[3],
                        const contact_line *const *lines, size_t line_count, double least, contact_faces *out) {
    uint32_t next = 0;
    out->count = out->chord_count = 0;
    out->cut.on_edge = new_number, out->cut.user = &next;
    pieces_open(&out->cut, corner, corner_count, normal);
    out->cut.snap = SNAP, out->cut.least = least, out->cut.least_share = 0.0;
    for (size_t i = 0; i < line_count; i++) pieces_cut(&out->cut, lines[i]);
    if (out->cut.count > 1 && list_faces(out)) {
        list_chords(out);
        set_inward(out);
        return;
    }
    out->count = 1;
}

/* How far inside its nearest edge is a point? Once that is no further than `most` it does not matter. */
static double depth_in(const contact_faces *f, int face, const double point[3], double most) {
    int n = corner_count_of(f->face[face]);
    double least = INFINITY;
    for (int k = 0; k < n && least > most; k++) {
        double offset[3];
        vec3_sub(offset, point, f->cut.points[f->face[face][k]].at);
        double depth = vec3_dot(f->inward[face][k], offset);
        least = depth < least ? depth : least;
    }
    return least;
}

int contact_faces_holding(const contact_faces *f, const double point[3]) {
    double deepest = -INFINITY;
    int best = 0;
    for (int i = 0; f->count > 1 && i < f->count; i++) {
        double depth = depth_in(f, i, point, deepest);
        if (depth > deepest) deepest = depth, best = i;
    }
    return best;
}

uint64_t contact_faces_of(const contact_faces *f, const pieces *p) {
    uint64_t in = 0;
    for (int i = 0; i < p->count; i++) {
        double middle[3];
        pieces_middle(p, &p->all[i], middle);
        in |= UINT64_C(1) << contact_faces_holding(f, middle);
    }
    return in;
}
