/* SPDX-License-Identifier: MIT */
#include "formfactor/hemicube_visibility.h"

#include "base/tolerance.h"
#include "visibility/occlusion.h"
#include "visibility/surface_bvh.h"

/* ---- a sample ---- */

/* Where a direction meets the half cube: a face, and continuous pixel coordinates on it. */
typedef struct cube_place {
    int first_row, rows;
    double x, y; /* 0..resolution, 0..rows */
} cube_place;

/* direction in the frame of the hemi-cube, above its horizon. */
static inline cube_place place_of(int resolution, const double direction[3]) {
    double u = direction[0], v = direction[1], w = direction[2], au = fabs(u), av = fabs(v), half = 0.5 * resolution;
    if (au <= w && av <= w) return (cube_place){ 0, resolution, half * (1 + u / w), half * (1 + v / w) };
    int side = au >= av ? (u < 0) : 2 + (v < 0);
    double depth = au >= av ? au : av, s = au >= av ? v : u;
    return (cube_place){ resolution + side * (resolution / 2), resolution / 2, half * (1 + s / depth),
                         half * (w / depth) };
}

static size_t pixel_at(const hemicube *h, const cube_place *p, int column, int row) {
    column = column < 0 ? 0 : column >= h->resolution ? h->resolution - 1 : column;
    row = row < 0 ? 0 : row >= p->rows ? p->rows - 1 : row;
    return (size_t)(p->first_row + row) * (size_t)h->resolution + (size_t)column;
}

/* Next to an edge of the cube the neighbours of a pixel are found by turning the direction by half a pixel, since they
 * are on another face. */
static void pixels_across_edges(const hemicube *h, const double local[3], size_t pixel[4]) {
    double step = vec3_length(local) / h->resolution;
    for (int k = 0; k < 3; k++) {
        double turned[3] = { local[0], local[1], local[2] };
        turned[k] += turned[k] > 0.0 ? -step : step;
        cube_place p = place_of(h->resolution, turned);
        pixel[k + 1] = pixel_at(h, &p, (int)p.x, (int)p.y);
    }
}

/* The four pixels whose centres surround a direction (in the frame of the hemi-cube), [0] the nearest. */
static void surrounding_pixels(const hemicube *h, const double local[3], size_t pixel[4]) {
    int n = h->resolution;
    cube_place p = place_of(n, local);
    int column = (int)p.x, row = (int)p.y;
    int dx = p.x - column < 0.5 ? -1 : 1, dy = p.y - row < 0.5 ? -1 : 1;
    bool inside =
        column < n && row < p.rows && column + dx >= 0 && column + dx < n && row + dy >= 0 && row + dy < p.rows;
    pixel[0] = pixel_at(h, &p, column, row);
    if (!inside) {
        pixels_across_edges(h, local, pixel);
        return;
    }
    pixel[1] = pixel[0] + (size_t)dx;
    pixel[2] = pixel[0] + (size_t)(dy * n);
    pixel[3] = pixel[2] + (size_t)dx;
}

/* How many strips are crossed at most, and how far around a point is looked where its surface is not seen, pixels. */
enum { STRIPS_MAX = 64, WIDE = 2 };

static inline bool hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, const double point[3],
                         bool nearest) {
    const surface *f = &s->surfaces[candidate];
    double t;
    if (!occlusion_crossing(f, h->eye, point, &t)) return false;
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
    if (occlusion_inside(s, f, h->eye, point, t)) return true;
    double pixel = 2.0 / h->resolution, distance = vec3_distance(h->eye, point);
    return nearest &&
           occlusion_by_small(f, &s->surfaces[own], h->eye, point, t, pixel * t * distance, pixel * distance);
}

/* The surfaces beyond the edges of one that is seen may be too thin in the item buffer, seen edge-on, to be seen
 * themselves. */
static bool neighbor_hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, const double point[3]) {
    if (!s->neighbours) return false;
    for (int k = 0; k < 4; k++) {
        uint32_t neighbor = s->neighbours[4 * (size_t)candidate + (size_t)k];
        if (neighbor == NO_INDEX || surface_sheet(s, neighbor) == own) continue;
        if (hides(h, s, neighbor, own, point, false)) return true;
    }
    return false;
}

/* From a surface that is seen beside the ray, over the edges that lie between, to the one that the ray meets: of strips
 * narrower than a pixel the item buffer shows one of several. */
static bool strip_hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, const double point[3]) {
    uint32_t before = NO_INDEX;
    for (int step = 0; s->neighbours && step < STRIPS_MAX && surface_sheet(s, candidate) != own; step++) {
        const surface *f = &s->surfaces[candidate];
        double t;
        if (!occlusion_crossing(f, h->eye, point, &t)) return false;
        if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
        int edge = occlusion_edge_beside(s, f, h->eye, point, t);
        if (edge < 0) return occlusion_inside(s, f, h->eye, point, t); /* unless it goes through a hole */
        uint32_t next = s->neighbours[4 * (size_t)candidate + (size_t)edge];
        if (next == NO_INDEX || next == before) return false;
        before = candidate;
        candidate = next;
    }
    return false;
}

/* The point is at a corner of something whose pixels are all beside it, or its own surface would have been seen: looks
 * at all pixels up to WIDE away on the same face of the cube. */
static bool hidden_widely(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t own,
                          const double local[3], const double point[3]) {
    cube_place p = place_of(h->resolution, local);
    uint32_t last = 0;
    for (int dy = -WIDE; dy <= WIDE; dy++)
        for (int dx = -WIDE; dx <= WIDE; dx++) {
            uint32_t id = h->ids[pixel_at(h, &p, (int)p.x + dx, (int)p.y + dy)] & ~ITEM_MARK;
            if (id == 0 || id == last) continue;
            last = id;
            uint32_t candidate = triangle_surface[id - 1];
            if (candidate == own) continue;
            if (hides(h, s, candidate, own, point, false) || neighbor_hides(h, s, candidate, own, point) ||
                strip_hides(h, s, candidate, own, point))
                return true;
        }
    return false;
}

/* Is a surface that is seen the next facet of a smooth surface, so that what is seen of it is seen of both? */
static bool continues_in(const hemicube *h, const scene *s, uint32_t seen, uint32_t own) {
    const surface *f = &s->surfaces[seen], *g = &s->surfaces[own];
    if (!s->neighbours || vec3_dot(f->normal, g->normal) < TOLERANCE_SMOOTH || !hemicube_shows_front(s, seen, h->eye))
        return false;
    for (size_t k = 0; k < 4; k++)
        if (s->neighbours[4 * (size_t)own + k] == seen) return true;
    return false;
}

/* Most points see four pixels of one triangle of their own surface. */
static inline bool all_show(const hemicube *h, const size_t pixel[4], const uint32_t *triangle_surface, uint32_t own) {
    uint32_t id = h->ids[pixel[0]];
    return id != 0 && !(id & ITEM_MARK) && id == h->ids[pixel[1]] && id == h->ids[pixel[2]] && id == h->ids[pixel[3]] &&
           triangle_surface[id - 1] == own;
}

/* Ids that repeat are looked up once. */
bool hemicube_sees(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t surface_index,
                   const double point[3]) {
    double direction[3];
    vec3_sub(direction, point, h->eye);
    double height = vec3_dot(direction, h->normal);
    if (height <= 0.0) return false;
    /* From behind a surface hides its own points, although part of the shooter may be in front of it, and those above
     * that it is in the way of. */
    const surface *f = &s->surfaces[surface_index];
    if (surface_height(f, h->eye) <= 0.0 && (surface_height(f, point) <= TOLERANCE_PLANE * s->radius ||
                                             hides(h, s, surface_index, surface_index, point, false)))
        return false;
    const double local[3] = { vec3_dot(h->tangent, direction), vec3_dot(h->bitangent, direction), height };
    size_t pixel[4];
    surrounding_pixels(h, local, pixel);
    uint32_t own = surface_sheet(s, surface_index), tested = own, last = 0, marks = 0;
    if (all_show(h, pixel, triangle_surface, own)) return true;
    bool sees_own = false;
    for (int k = 0; k < 4; k++) {
        uint32_t id = h->ids[pixel[k]] & ~ITEM_MARK;
        marks |= h->ids[pixel[k]] & ITEM_MARK;
        if (id == last || id == 0) continue;
        last = id;
        uint32_t candidate = triangle_surface[id - 1];
        sees_own = sees_own || candidate == own || continues_in(h, s, candidate, surface_index);
        if (candidate == own || candidate == tested) continue;
        tested = candidate;
        if (hides(h, s, candidate, own, point, k == 0) || neighbor_hides(h, s, candidate, own, point)) return false;
    }
    if (!sees_own && hidden_widely(h, s, triangle_surface, own, local, point)) return false;
    return !marks || !s->tree || !surface_bvh_blocks(s->tree, s, own, h->eye, point);
}

/* ---- what stands on the floor ---- */

/* The edges of a polygon as they are seen from a point in its plane. */
typedef struct border {
    double outward[POLYGON_CORNERS_MAX][3], offset[POLYGON_CORNERS_MAX];
    int count;
} border;

static border border_of(const polygon *p, const double normal[3], const double eye[3]) {
    border out;
    out.count = p->count;
    for (int i = 0; i < p->count; i++) {
        const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
        double edge[3], offset[3];
        vec3_sub(edge, b, a);
        vec3_cross(out.outward[i], edge, normal);
        vec3_sub(offset, a, eye);
        out.offset[i] = vec3_dot(out.outward[i], offset);
    }
    return out;
}

/* Distance from the eye along a direction in the polygon's plane. */
static double distance_to_border(const border *edges, const double along[3]) {
    double nearest = INFINITY;
    for (int i = 0; i < edges->count; i++) {
        double speed = vec3_dot(edges->outward[i], along), distance = edges->offset[i] / speed;
        if (speed > 0.0 && distance < nearest) nearest = distance;
    }
    return nearest;
}

static bool belongs(const hemicube_floor *floor, const scene *s, uint32_t seen) {
    uint32_t twin = s->surfaces[seen].twin;
    return floor->group && (floor->group[seen] == floor->own || (twin != NO_INDEX && floor->group[twin] == floor->own));
}

/* How far along the floor a pixel of a side sees, in lengths of `along`: the direction there on the floor. Row 0 is the
 * lowest. Infinite where it sees the sky, or the floor itself. */
static double reach_along_floor(const hemicube *h, const scene *s, const uint32_t *triangle_surface,
                                const hemicube_floor *floor, int side, int row, int x, double along[3]) {
    int n = h->resolution, half = n / 2;
    uint32_t id = h->ids[(size_t)(n + side * half + row) * (size_t)n + (size_t)x] & ~ITEM_MARK;
    if (id == 0 || belongs(floor, s, triangle_surface[id - 1])) return INFINITY;
    const double *forward = side < 2 ? h->tangent : h->bitangent, *across = side < 2 ? h->bitangent : h->tangent;
    double ray[3], t = (2 * x + 1.0) / n - 1, sign = side & 1 ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++) along[k] = sign * forward[k] + t * across[k];
    vec3_add_scaled(ray, along, (2 * row + 1.0) / n, h->normal);
    const surface *seen = &s->surfaces[triangle_surface[id - 1]];
    return -surface_height(seen, h->eye) / vec3_dot(seen->normal, ray);
}

bool hemicube_is_crossed(const hemicube *h, const scene *s, const uint32_t *triangle_surface,
                         const hemicube_floor *floor) {
    const border edges = border_of(floor->shape, h->normal, h->eye);
    int n = h->resolution, rows = floor->height > 0.0 ? (int)ceil(0.5 * TOLERANCE_LOW_SLOPE * n) : 1;
    for (int row = 0; row < rows; row++)
        for (int side = 0; side < 4; side++)
            for (int x = 0; x < n; x++) {
                double along[3] = { 0, 0, 0 },
                       reach = reach_along_floor(h, s, triangle_surface, floor, side, row, x, along);
                if (isinf(reach) || (row > 0 && !(reach > 0.0 && reach * (2 * row + 1.0) / n <= floor->height)))
                    continue;
                if (reach < (1 - TOLERANCE_CROSSING) * distance_to_border(&edges, along)) return true;
            }
    return false;
}
