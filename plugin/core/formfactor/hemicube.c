/* SPDX-License-Identifier: MIT
 * See hemicube.h.
 */
#include "formfactor/hemicube.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "visibility/occlusion.h"
#include "visibility/surface_bvh.h"

void hemicube_place(hemicube *h, const double eye[3], const double normal[3], double angle) {
    /* Any axis not along the normal will do; the least component is furthest from it. */
    double axis[3] = { 0, 0, 0 }, u[3], v[3];
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    if (fabs(normal[2]) < fabs(normal[least])) least = 2;
    axis[least] = 1.0;
    vec3_cross(u, axis, normal);
    vec3_normalize(u);
    vec3_cross(v, normal, u);
    double c = cos(angle), s = sin(angle);
    for (int k = 0; k < 3; k++) {
        h->tangent[k] = c * u[k] + s * v[k];
        h->bitangent[k] = c * v[k] - s * u[k];
    }
    vec3_copy(h->eye, eye);
    vec3_copy(h->normal, normal);
}

static void set_axis(float out[3], const double a[3], double sign) {
    for (int k = 0; k < 3; k++) out[k] = (float)(sign * a[k]);
}

static item_view view_of_face(const hemicube *h, int face, const double center[3]) {
    int n = h->resolution, half = n / 2;
    item_view v = { .s_low = -1, .s_high = 1, .t_low = face ? 0 : -1, .t_high = 1, .width = n };
    v.y = face ? n + (face - 1) * half : 0;
    v.height = face ? half : n;
    for (int k = 0; k < 3; k++) v.eye[k] = (float)(h->eye[k] - center[k]);
    const double *sideways = face == 1 || face == 2 ? h->bitangent : h->tangent;
    const double *forward = face == 0 ? h->normal : face == 1 || face == 2 ? h->tangent : h->bitangent;
    set_axis(v.right, sideways, 1);
    set_axis(v.up, face ? h->normal : h->bitangent, 1);
    set_axis(v.forward, forward, face == 2 || face == 4 ? -1 : 1);
    return v;
}

bool hemicube_draw(hemicube *h, item_buffer *items, const double center[3]) {
    item_view views[5];
    for (int face = 0; face < 5; face++) views[face] = view_of_face(h, face, center);
    return item_buffer_draw(items, views, 5, h->resolution, 3 * h->resolution, false, h->ids);
}

/* The end of the run of equal ids that begins at q. Looks at eight at a time, which compilers turn into vector code. */
static size_t run_end(const uint32_t *ids, size_t q, size_t count) {
    const uint32_t id = ids[q++];
    for (; q + 8 <= count; q += 8) {
        uint32_t other = 0;
        for (size_t i = 0; i < 8; i++) other |= ids[q + i] ^ id;
        if (other) break;
    }
    while (q < count && ids[q] == id) q++;
    return q;
}

size_t hemicube_pack(const hemicube *h, uint32_t *runs) {
    size_t pixel_count = 3 * (size_t)h->resolution * (size_t)h->resolution, count = 0;
    for (size_t q = 0, end; q < pixel_count; q = end, count++) {
        end = run_end(h->ids, q, pixel_count);
        if (runs) runs[2 * count] = h->ids[q], runs[2 * count + 1] = (uint32_t)(end - q);
    }
    return count;
}

void hemicube_unpack(hemicube *h, const uint32_t *runs, size_t count) {
    uint32_t *at = h->ids;
    for (size_t i = 0; i < count; i++) {
        const uint32_t id = runs[2 * i], length = runs[2 * i + 1];
        for (uint32_t k = 0; k < length; k++) at[k] = id;
        at += length;
    }
}

/* A surface and its twin are one sheet: one of the two always shows its front. */
static bool shows_front(const scene *s, uint32_t surface_index, const double eye[3]) {
    const surface *f = &s->surfaces[surface_index];
    return f->twin != NO_INDEX || surface_height(f, eye) > 0.0;
}

/* In four sums, since each addition waits for the one before it in its sum. */
static double sum_of(const double *weights, size_t count) {
    double sum[4] = { 0, 0, 0, 0 }, rest = 0.0;
    size_t i = 0;
    for (; i + 4 <= count; i += 4)
        for (size_t k = 0; k < 4; k++) sum[k] += weights[i + k];
    for (; i < count; i++) rest += weights[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest;
}

hemicube_closure hemicube_close(const hemicube *h, const double *weights, const scene *s,
                                const uint32_t *triangle_surface) {
    hemicube_closure sum = { 0, 0, 0 };
    size_t pixel_count = 3 * (size_t)h->resolution * (size_t)h->resolution;
    for (size_t q = 0, end; q < pixel_count; q = end) {
        end = run_end(h->ids, q, pixel_count);
        double weight = sum_of(weights + q, end - q);
        uint32_t id = h->ids[q] & ~ITEM_MARK;
        if (id == 0)
            sum.sky += weight;
        else if (shows_front(s, triangle_surface[id - 1], h->eye))
            sum.front += weight;
        else
            sum.back += weight;
    }
    return sum;
}

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

/* Decides by depth whether a surface too small for the item buffer hides the point: it stands before it by more than
 * the bias, in footprints of a pixel on the receiving surface. */
static bool small_surface_hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, double t,
                                const double point[3], double pixel) {
    double distance = vec3_distance(h->eye, point), footprint_size = pixel * t * distance;
    double limit = TOLERANCE_SMALL_FACE_PIXELS * footprint_size;
    if (s->surfaces[candidate].area > limit * limit || s->surfaces[candidate].holes) return false;
    double cosine = surface_height(&s->surfaces[own], h->eye) / distance;
    double bias = TOLERANCE_DEPTH_BIAS_PIXELS * pixel * distance / fmax(cosine, 0.1);
    return (1 - t) * distance > bias;
}

static inline bool hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, const double point[3],
                         bool nearest) {
    const surface *f = &s->surfaces[candidate];
    double t;
    if (!occlusion_crossing(f, h->eye, point, &t)) return false;
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
    if (occlusion_inside(s, f, h->eye, point, t)) return true;
    return nearest && small_surface_hides(h, s, candidate, own, t, point, 2.0 / h->resolution);
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
static bool goes_on_as(const hemicube *h, const scene *s, uint32_t seen, uint32_t own) {
    const surface *f = &s->surfaces[seen], *g = &s->surfaces[own];
    if (!s->neighbours || vec3_dot(f->normal, g->normal) < TOLERANCE_SMOOTH || !shows_front(s, seen, h->eye))
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
    /* From behind a surface hides its own points, although part of the shooter may be in front of it. */
    if (height <= 0.0 || surface_height(&s->surfaces[surface_index], h->eye) <= 0.0) return false;
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
        sees_own = sees_own || candidate == own || goes_on_as(h, s, candidate, surface_index);
        if (candidate == own || candidate == tested) continue;
        tested = candidate;
        if (hides(h, s, candidate, own, point, k == 0) || neighbor_hides(h, s, candidate, own, point)) return false;
    }
    if (!sees_own && hidden_widely(h, s, triangle_surface, own, local, point)) return false;
    return !marks || !s->tree || !surface_bvh_blocks(s->tree, s, own, h->eye, point);
}

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
