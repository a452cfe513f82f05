/* SPDX-License-Identifier: MIT
 * See contact_pieces.h.
 */
#include "mesh/contact_pieces.h"

#include "geometry/triangle.h"

/* A hundredth of an element's edge is a tenth of the way from its border to its nearest sample, so a cut that is off by
 * that moves no sample to the other side. */
const double PIECES_SNAP = 0.01;

/* A line that runs through less of a piece, as a share of its longest edge, does not cut it. */
static const double LENGTH_LEAST = 0.1;

/* Pieces of four corners are quads when they depart from parallelograms by less, as a share of their edges: the areas
 * of their samples are off by as much. */
static const double PARALLELOGRAM = 0.02;

/* A triangle whose area is less than this share of its longest edge's square is none. */
static const double FLAT = 1e-6;

/* Points on an edge are that up to rounding, as a share of the edge. */
static const double ON_EDGE = 1e-6;

void pieces_open(pieces *p, const double (*corner)[3], int corner_count, const double normal[3]) {
    p->normal = normal;
    p->snap = PIECES_SNAP, p->least = 0.0, p->least_share = LENGTH_LEAST;
    p->point_count = p->corner_count = corner_count;
    p->count = 1;
    p->all[0].count = (uint8_t)corner_count;
    for (int k = 0; k < corner_count; k++) {
        p->points[k] = (piece_point){ .on_edge = NO_INDEX,
                                      .edges = (uint8_t)(1 << k | 1 << (k + corner_count - 1) % corner_count) };
        vec3_copy(p->points[k].at, corner[k]);
        p->all[0].corner[k] = (uint8_t)k;
    }
}

/* ---- points ---- */

static int add_point(pieces *p, const double at[3], uint32_t on_edge, int edges) {
    if (p->point_count == PIECE_POINTS_MAX) return -1;
    piece_point *x = &p->points[p->point_count];
    *x = (piece_point){ .on_edge = on_edge, .edges = (uint8_t)edges };
    vec3_copy(x->at, at);
    return p->point_count++;
}

int pieces_point_on_edge(pieces *p, int k, uint32_t number, const double at[3]) {
    for (int i = p->corner_count; i < p->point_count; i++)
        if (p->points[i].on_edge == number) return i;
    return add_point(p, at, number, 1 << k);
}

/* The point between two of a piece, at `at` or a little beside it. -1: no room; *ok: false when out of memory. */
static int point_between(pieces *p, int a, int b, double at[3], double reach, bool *ok) {
    int edges = p->points[a].edges & p->points[b].edges;
    for (int k = 0; k < p->corner_count; k++) {
        if (!(edges & 1 << k)) continue;
        uint32_t number = p->on_edge(p->user, k, at, reach);
        *ok = number != NO_INDEX;
        return *ok ? pieces_point_on_edge(p, k, number, at) : -1;
    }
    for (int i = p->corner_count; i < p->point_count; i++)
        if (vec3_distance(p->points[i].at, at) <= reach &&
            vec3_place_between(p->points[i].at, p->points[a].at, p->points[b].at, ON_EDGE) > 0.0)
            return i;
    return add_point(p, at, NO_INDEX, 0);
}

/* ---- cutting a piece ---- */

/* What is cut, and what the line makes of it. */
typedef struct cutting {
    pieces *p;
    const contact_line *line;
    double reach, length, along[3];   /* of the line, unit */
    int ring[PIECE_CORNERS_MAX];      /* points */
    double side[PIECE_CORNERS_MAX];   /* how far to the left of the line each is; 0: on it */
    double height[PIECE_CORNERS_MAX]; /* the same to the last bit */
    int count;
} cutting;

static double longest_edge(const pieces *p, const piece *one) {
    double longest = 0.0;
    for (int k = 0; k < one->count; k++)
        for (int i = 0; i < k; i++)
            longest = fmax(longest, vec3_distance_squared(p->points[one->corner[i]].at, p->points[one->corner[k]].at));
    return sqrt(longest);
}

static bool runs_through(const cutting *c, const piece *one, double longest) {
    double corner[PIECE_CORNERS_MAX][3], low, high;
    for (int k = 0; k < one->count; k++) vec3_copy(corner[k], c->p->points[one->corner[k]].at);
    return contact_line_clip(c->line, (const double(*)[3])corner, one->count, c->p->normal, &low, &high) &&
           (high - low) * c->length >= fmax(c->p->least, c->p->least_share * longest);
}

static void set_sides(cutting *c, const piece *one) {
    double left[3];
    vec3_cross(left, c->p->normal, c->along);
    c->count = one->count;
    for (int k = 0; k < one->count; k++) {
        double offset[3];
        c->ring[k] = one->corner[k];
        vec3_sub(offset, c->p->points[one->corner[k]].at, c->line->from);
        c->height[k] = vec3_dot(left, offset);
        c->side[k] = fabs(c->height[k]) <= c->reach ? 0.0 : c->height[k];
    }
}

/* Puts a point where the edge from k to the next corner meets the line; its place in the ring, -1: none. */
static int meet_edge(cutting *c, int k, bool *ok) {
    int next = (k + 1) % c->count;
    const double *a = c->p->points[c->ring[k]].at, *b = c->p->points[c->ring[next]].at;
    double at[3], edge[3];
    vec3_sub(edge, b, a);
    vec3_add_scaled(at, a, c->side[k] / (c->side[k] - c->side[next]), edge);
    int point =
        c->count < PIECE_CORNERS_MAX - 2 ? point_between(c->p, c->ring[k], c->ring[next], at, c->reach, ok) : -1;
    for (int i = 0; i < c->count; i++)
        if (c->ring[i] == point) return -1;
    if (point < 0) return -1;
    for (int i = c->count; i > k + 1; i--) c->ring[i] = c->ring[i - 1], c->side[i] = c->side[i - 1];
    for (int i = c->count; i > k + 1; i--) c->height[i] = c->height[i - 1];
    c->ring[k + 1] = point;
    c->side[k + 1] = c->height[k + 1] = 0.0;
    c->count++;
    return k + 1;
}

/* Where the ring goes over from the side of this sign to the other: a corner on the line if there is one, of several
 * the nearest. -1: nowhere, or there is no room. */
static int crossing(cutting *c, double sign, bool *ok) {
    for (int k = 0; k < c->count; k++) {
        if (!(c->side[k] * sign > 0.0)) continue;
        int next = (k + 1) % c->count, best = -1;
        for (; c->side[next] == 0.0; next = (next + 1) % c->count)
            if (best < 0 || fabs(c->height[next]) < fabs(c->height[best])) best = next;
        if (!(c->side[next] * sign < 0.0)) continue;
        return best >= 0 ? best : meet_edge(c, k, ok);
    }
    return -1;
}

/* The line's ends that lie on the cut, from its first point on: points. Returns how many. */
static int ends_on_cut(cutting *c, int from, int to, int ends[2]) {
    const double *a = c->p->points[c->ring[from]].at, *b = c->p->points[c->ring[to]].at;
    double cut[3], t[2];
    int count = 0;
    vec3_sub(cut, b, a);
    double length = vec3_normalize(cut);
    for (int i = 0; i < 2; i++) {
        double offset[3];
        vec3_sub(offset, i == 0 ? c->line->from : c->line->to, a);
        t[i] = vec3_dot(offset, cut);
    }
    if (t[0] > t[1]) {
        double larger = t[0];
        t[0] = t[1], t[1] = larger;
    }
    for (int i = 0; i < 2; i++) {
        double at[3];
        if (!(t[i] > c->reach && t[i] < length - c->reach)) continue;
        vec3_add_scaled(at, a, t[i], cut);
        int point = add_point(c->p, at, NO_INDEX, 0);
        if (point >= 0) ends[count++] = point;
    }
    return count;
}

static void take_ring(const cutting *c, int from, int to, const int *back, int back_count, piece *out) {
    out->count = 0;
    for (int k = from;; k = (k + 1) % c->count) {
        out->corner[out->count++] = (uint8_t)c->ring[k];
        if (k == to) break;
    }
    for (int i = 0; i < back_count; i++) out->corner[out->count++] = (uint8_t)back[i];
}

/* False when out of memory. */
static bool cut_piece(cutting *c, int index) {
    piece *one = &c->p->all[index];
    double longest = longest_edge(c->p, one);
    int ends[2], back[2];
    bool ok = true;
    if (c->p->count == PIECES_MAX || !runs_through(c, one, longest)) return true;
    c->reach = c->p->snap * longest;
    set_sides(c, one);
    int first = crossing(c, 1.0, &ok), first_point = first >= 0 ? c->ring[first] : 0;
    int second = first >= 0 ? crossing(c, -1.0, &ok) : -1;
    if (second < 0) return ok;
    for (first = 0; c->ring[first] != first_point;) first++;
    if (first == second) return ok;
    int count = c->count < PIECE_CORNERS_MAX - 2 ? ends_on_cut(c, first, second, ends) : 0;
    for (int i = 0; i < count; i++) back[i] = ends[count - 1 - i];
    take_ring(c, second, first, ends, count, one);
    take_ring(c, first, second, back, count, &c->p->all[c->p->count++]);
    return true;
}

bool pieces_cut(pieces *p, const contact_line *line) {
    cutting c = { .p = p, .line = line };
    int count = p->count;
    vec3_sub(c.along, line->to, line->from);
    c.length = vec3_normalize(c.along);
    for (int i = 0; i < count; i++)
        if (!cut_piece(&c, i)) return false;
    return true;
}

bool pieces_cut_as(pieces *p, const contact_line *line, double snap, double least_share) {
    const double own_snap = p->snap, own_share = p->least_share;
    p->snap = snap, p->least_share = least_share;
    bool ok = pieces_cut(p, line);
    p->snap = own_snap, p->least_share = own_share;
    return ok;
}

/* ---- faces ---- */

/* The ring of a piece with all points on its border. */
static int ring_of(const pieces *p, const piece *one, uint8_t ring[PIECE_POINTS_MAX]) {
    int count = 0;
    for (int k = 0; k < one->count; k++) {
        int a = one->corner[k], b = one->corner[(k + 1) % one->count];
        double last = 0.0;
        ring[count++] = (uint8_t)a;
        for (;;) { /* the next one after the last */
            double nearest = 1.0;
            int best = -1;
            for (int i = 0; i < p->point_count; i++) {
                double t = i == a || i == b
                               ? -1.0
                               : vec3_place_between(p->points[i].at, p->points[a].at, p->points[b].at, ON_EDGE);
                if (t > last && t < nearest) nearest = t, best = i;
            }
            if (best < 0 || count == PIECE_POINTS_MAX - one->count) break;
            ring[count++] = (uint8_t)best;
            last = nearest;
        }
    }
    return count;
}

static double shape_of(const pieces *p, int a, int b, int c) {
    const double *x = p->points[a].at, *y = p->points[b].at, *z = p->points[c].at;
    return triangle_area(x, y, z) / triangle_longest_squared(x, y, z);
}

/* worst[i][k]: the worst shape of the best triangles between corners i and k of the ring; split[i][k]: the third corner
 * of the one at that edge. */
typedef struct triangulation {
    float worst[PIECE_POINTS_MAX][PIECE_POINTS_MAX];
    uint8_t split[PIECE_POINTS_MAX][PIECE_POINTS_MAX];
} triangulation;

/* Without those that have no area, where points lie on one line. */
static int append_faces(const pieces *p, const triangulation *t, const uint8_t *ring, int from, int to,
                        uint8_t face[][4], int count) {
    if (to - from < 2) return count;
    int middle = t->split[from][to];
    count = append_faces(p, t, ring, from, middle, face, count);
    face[count][0] = ring[from], face[count][1] = ring[middle], face[count][2] = ring[to], face[count][3] = PIECE_NONE;
    count += shape_of(p, ring[from], ring[middle], ring[to]) > FLAT;
    return append_faces(p, t, ring, middle, to, face, count);
}

/* Those whose worst shape is the best. */
static int triangulate(const pieces *p, const uint8_t *ring, int count, uint8_t face[][4]) {
    triangulation t;
    for (int i = 0; i + 1 < count; i++) t.worst[i][i + 1] = 1.0f;
    for (int span = 2; span < count; span++)
        for (int i = 0; i + span < count; i++) {
            int k = i + span;
            t.worst[i][k] = -1.0f, t.split[i][k] = (uint8_t)(i + 1);
            for (int m = i + 1; m < k; m++) {
                float shape = (float)shape_of(p, ring[i], ring[m], ring[k]);
                shape = fminf(shape, fminf(t.worst[i][m], t.worst[m][k]));
                if (shape > t.worst[i][k]) t.worst[i][k] = shape, t.split[i][k] = (uint8_t)m;
            }
        }
    return append_faces(p, &t, ring, 0, count - 1, face, 0);
}

/* Are four points the corners of a parallelogram? */
static bool is_quad(const pieces *p, const uint8_t ring[4]) {
    double off = 0.0, size = 0.0;
    for (int k = 0; k < 3; k++) {
        double v[4];
        for (int i = 0; i < 4; i++) v[i] = p->points[ring[i]].at[k];
        off = fmax(off, fabs(v[0] + v[2] - v[1] - v[3]));
        size = fmax(size, fmax(fabs(v[1] - v[0]), fabs(v[3] - v[0])));
    }
    return off <= PARALLELOGRAM * size;
}

int pieces_faces(const pieces *p, const piece *one, uint8_t face[PIECE_POINTS_MAX][4]) {
    uint8_t ring[PIECE_POINTS_MAX];
    int count = ring_of(p, one, ring);
    if (count != 4 || !is_quad(p, ring)) return triangulate(p, ring, count, face);
    for (int k = 0; k < 4; k++) face[0][k] = ring[k];
    return 1;
}

int pieces_face_count(const pieces *p) {
    uint8_t face[PIECE_POINTS_MAX][4];
    int sum = 0;
    for (int i = 0; i < p->count; i++) sum += pieces_faces(p, &p->all[i], face);
    return sum;
}

void pieces_middle(const pieces *p, const piece *one, double out[3]) {
    out[0] = out[1] = out[2] = 0.0;
    for (int k = 0; k < one->count; k++) vec3_add_scaled(out, out, 1.0 / one->count, p->points[one->corner[k]].at);
}
