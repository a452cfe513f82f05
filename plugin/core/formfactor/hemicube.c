/* SPDX-License-Identifier: MIT
 * See hemicube.h.
 */
#include "formfactor/hemicube.h"

#include "base/tolerance.h"
#include "base/vec3.h"
#include "visibility/occlusion.h"

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

/* A surface and its twin are one sheet: one of the two always shows its front. */
static bool shows_front(const scene *s, uint32_t surface_index, const double eye[3]) {
    const surface *f = &s->surfaces[surface_index];
    return f->twin != NO_INDEX || surface_height(f, eye) > 0.0;
}

hemicube_closure hemicube_close(const hemicube *h, const double *weights, const scene *s,
                                const uint32_t *triangle_surface) {
    hemicube_closure sum = { 0, 0, 0 };
    size_t pixel_count = 3 * (size_t)h->resolution * (size_t)h->resolution;
    uint32_t last = 0;
    bool front = false;
    for (size_t q = 0; q < pixel_count; q++) {
        uint32_t id = h->ids[q];
        if (id == 0) {
            sum.sky += weights[q];
            continue;
        }
        if (id != last) {
            front = shows_front(s, triangle_surface[id - 1], h->eye);
            last = id;
        }
        if (front)
            sum.front += weights[q];
        else
            sum.back += weights[q];
    }
    return sum;
}

/* A place between pixel centres of one face: the four pixels around it, kept inside the face. */
typedef struct footprint {
    size_t pixel[4]; /* [0] is the nearest */
    double size;     /* edge of a pixel's footprint at unit distance */
} footprint;

/* Splits a continuous coordinate into the nearest and the second nearest of count pixels. */
static void two_nearest(double coordinate, int count, int *nearest, int *second) {
    int i = (int)coordinate;
    i = i < 0 ? 0 : i >= count ? count - 1 : i;
    int j = coordinate - i < 0.5 ? i - 1 : i + 1;
    *nearest = i;
    *second = j < 0 ? 0 : j >= count ? count - 1 : j;
}

static footprint footprint_of(const hemicube *h, const double direction[3]) {
    int n = h->resolution, half = n / 2, rows = n, first_row = 0;
    double u = vec3_dot(h->tangent, direction), v = vec3_dot(h->bitangent, direction);
    double w = vec3_dot(h->normal, direction), depth = w, s = u, t = 0.5 * n * (1 + v / w);
    double au = fabs(u), av = fabs(v);
    if (au > w || av > w) {
        int side = au >= av ? (u < 0) : 2 + (v < 0);
        depth = au >= av ? au : av;
        s = au >= av ? v : u;
        t = 0.5 * n * (w / depth);
        rows = half;
        first_row = n + side * half;
    }
    int x[2], y[2];
    two_nearest(0.5 * n * (1 + s / depth), n, &x[0], &x[1]);
    two_nearest(t, rows, &y[0], &y[1]);
    footprint f = { .size = 2.0 / n };
    for (int k = 0; k < 4; k++) f.pixel[k] = (size_t)(first_row + y[k >> 1]) * (size_t)n + (size_t)x[k & 1];
    return f;
}

/* Decides by depth whether a surface too small for the item buffer hides the point: it stands before it by more than
 * the bias, in footprints of a pixel on the receiving surface. */
static bool small_surface_hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, double t,
                                const double point[3], double pixel) {
    double distance = vec3_distance(h->eye, point), footprint_size = pixel * t * distance;
    double limit = TOLERANCE_SMALL_FACE_PIXELS * footprint_size;
    if (s->surfaces[candidate].area > limit * limit) return false;
    double cosine = surface_height(&s->surfaces[own], h->eye) / distance;
    double bias = TOLERANCE_DEPTH_BIAS_PIXELS * pixel * distance / fmax(cosine, 0.1);
    return (1 - t) * distance > bias;
}

static bool hides(const hemicube *h, const scene *s, uint32_t candidate, uint32_t own, const double point[3],
                  bool nearest, double pixel) {
    const surface *f = &s->surfaces[candidate];
    double t;
    if (!occlusion_crossing(f, h->eye, point, &t)) return false;
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
    if (occlusion_inside(s, f, h->eye, point, t)) return true;
    return nearest && small_surface_hides(h, s, candidate, own, t, point, pixel);
}

bool hemicube_sees(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t surface_index,
                   const double point[3]) {
    double direction[3];
    vec3_sub(direction, point, h->eye);
    if (vec3_dot(direction, h->normal) <= 0.0) return false;
    footprint f = footprint_of(h, direction);
    uint32_t own = surface_sheet(s, surface_index), tested = NO_INDEX;
    for (int k = 0; k < 4; k++) {
        uint32_t id = h->ids[f.pixel[k]];
        if (id == 0) continue;
        uint32_t candidate = surface_sheet(s, triangle_surface[id - 1]);
        if (candidate == own || candidate == tested) continue;
        tested = candidate;
        if (hides(h, s, candidate, own, point, k == 0, f.size)) return false;
    }
    return true;
}
