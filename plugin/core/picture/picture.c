/* SPDX-License-Identifier: MIT */
#include "picture/picture.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "picture/blended.h"
#include "picture/cracks.h"

#include <stdio.h>
#include <string.h>

typedef struct camera {
    double eye[3], right[3], up[3], forward[3];
    double half_width, half_height; /* of the picture at distance 1 */
    double center[3], radius;       /* of the scene */
    double extent[3];               /* half the bounding box */
} camera;

static void find_bounds(camera *c, const picture *p) {
    double low[3], high[3];
    vec3_bounds(p->positions, p->vertex_count, low, high);
    vec3_mid(c->center, low, high);
    for (int k = 0; k < 3; k++) c->extent[k] = 0.5 * (high[k] - low[k]);
    c->radius = 0.5 * vec3_distance(low, high);
}

static void set_axes(camera *c, const double up[3]) {
    const double y_axis[3] = { 0, 1, 0 }, z_axis[3] = { 0, 0, -1 };
    vec3_cross(c->right, c->forward, vec3_length(up) > 0.0 ? up : y_axis);
    if (vec3_normalize(c->right) < 1e-6) {
        vec3_cross(c->right, c->forward, z_axis);
        vec3_normalize(c->right);
    }
    vec3_cross(c->up, c->right, c->forward);
}

/* Steps back from the centre until the corners of the bounding box fit, with a margin. */
static void frame_scene(camera *c) {
    const double margin = 1.06;
    double distance = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        double offset[3];
        for (int k = 0; k < 3; k++) offset[k] = corner >> k & 1 ? c->extent[k] : -c->extent[k];
        double nearer = -vec3_dot(offset, c->forward);
        distance = fmax(distance, nearer + margin * fabs(vec3_dot(offset, c->right)) / c->half_width);
        distance = fmax(distance, nearer + margin * fabs(vec3_dot(offset, c->up)) / c->half_height);
    }
    vec3_add_scaled(c->eye, c->center, -distance, c->forward);
}

static camera make_camera(const picture *p) {
    camera c;
    find_bounds(&c, p);
    c.half_height = tan(0.5 * p->vertical_fov);
    c.half_width = c.half_height * p->width / p->height;
    vec3_copy(c.eye, p->eye);
    vec3_sub(c.forward, p->target, p->eye);
    if (vec3_normalize(c.forward) > 0.0) {
        set_axes(&c, p->up);
        return c;
    }
    /* From in front, a little above and to the right. */
    const double towards[3] = { -0.22, -0.16, -1.0 };
    vec3_copy(c.forward, towards);
    vec3_normalize(c.forward);
    set_axes(&c, p->up);
    frame_scene(&c);
    return c;
}

static item_view view_of(const camera *c, int width, int height) {
    item_view v = { .s_low = (float)-c->half_width,
                    .s_high = (float)c->half_width,
                    .t_low = (float)-c->half_height,
                    .t_high = (float)c->half_height,
                    .width = width,
                    .height = height };
    for (int k = 0; k < 3; k++) {
        v.eye[k] = (float)(c->eye[k] - c->center[k]);
        v.right[k] = (float)c->right[k], v.up[k] = (float)c->up[k], v.forward[k] = (float)c->forward[k];
    }
    return v;
}

/* Barycentric coordinates of the point where the ray meets the triangle's plane, kept inside the triangle: the pixel's
 * centre may be a rounding outside. */
static void barycentric(const double *a, const double *b, const double *c, const double eye[3], const double ray[3],
                        double w[3]) {
    double u[3], v[3], n[3], from[3], q[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_cross(n, u, v);
    vec3_sub(from, eye, a);
    double denominator = -vec3_dot(n, ray);
    if (denominator == 0.0) denominator = 1e-300;
    vec3_cross(q, from, ray);
    w[1] = vec3_dot(v, q) / denominator;
    w[2] = -vec3_dot(u, q) / denominator;
    w[1] = fmin(fmax(w[1], 0.0), 1.0);
    w[2] = fmin(fmax(w[2], 0.0), 1.0 - w[1]);
    w[0] = 1.0 - w[1] - w[2];
}

/* The share of a triangle's area that a ray stands for, whose pixel has an area at distance 1; at most all. */
static double share_of(const double *a, const double *b, const double *c, const double eye[3], const double ray[3],
                       double pixel) {
    double u[3], v[3], n[3], to[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_cross(n, u, v);
    vec3_sub(to, a, eye);
    double toward = fabs(vec3_dot(n, ray)), t = fabs(vec3_dot(n, to)) / fmax(toward, 1e-300);
    return fmin(2.0 * pixel * t * t / fmax(toward, 1e-300), 1.0);
}

static void shade(const picture *p, uint32_t triangle, const double weights[3], double share, float rgb[3]) {
    size_t low = 0, high = p->mesh_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(p->first[middle] <= triangle ? &low : &high) = middle;
    }
    p->shade(p->shade_user, low, triangle - p->first[low], weights, share, rgb);
}

/* What is drawn, and the ray of one sample. */
typedef struct sampling {
    const picture *picture;
    const camera *camera;
    double ray[3], pixel_area; /* at distance 1 */
} sampling;

static void find_corners(const picture *p, uint32_t triangle, const double *at[3]) {
    for (int i = 0; i < 3; i++) at[i] = p->positions + 3 * (size_t)p->indices[3 * (size_t)triangle + (size_t)i];
}

/* Adds what is seen at a point of a triangle. */
static void add_color(void *user, uint32_t triangle, const double weights[3], float rgb[3]) {
    const sampling *s = user;
    const picture *p = s->picture;
    const uint32_t *corner = p->indices + 3 * (size_t)triangle;
    const double even[3] = { 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0 }, *w = p->flat ? even : weights, *at[3];
    find_corners(p, triangle, at);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) rgb[k] += (float)(w[i] * p->colors[3 * (size_t)corner[i] + k]);
    if (p->shade) shade(p, triangle, w, share_of(at[0], at[1], at[2], s->camera->eye, s->ray, s->pixel_area), rgb);
}

/* What covers all that is behind it, or the background; how far away it is along the ray. */
static double add_solid(sampling *s, uint32_t id, float rgb[3]) {
    const double *at[3], *eye = s->camera->eye;
    double w[3], place[3] = { 0, 0, 0 };
    for (int k = 0; k < 3 && !id; k++) rgb[k] = s->picture->background[k];
    if (!id) return INFINITY;
    find_corners(s->picture, id - 1, at);
    barycentric(at[0], at[1], at[2], eye, s->ray, w);
    add_color(s, id - 1, w, rgb);
    for (int i = 0; i < 3; i++) vec3_add_scaled(place, place, w[i], at[i]);
    vec3_sub(place, place, eye);
    return vec3_dot(place, s->camera->forward);
}

/* A sample of a pixel: what blends before what does not. */
static void add_sample(sampling *s, blended *b, uint32_t id, float *pixel) {
    float front[3] = { 0, 0, 0 }, solid[3] = { 0, 0, 0 };
    double end = add_solid(s, id, solid), left = blended_add(b, s->ray, end, add_color, s, front);
    for (int k = 0; k < 3; k++) pixel[k] += front[k] + (float)left * solid[k];
    pixel[3] += id ? 1.0f : (float)(1.0 - left);
}

/* ids has supersample x supersample entries a pixel, row 0 at the bottom. */
static void resolve(const picture *p, const camera *c, const uint32_t *ids, const alpha_mask_map *const *holes,
                    blended *b, float *pixels) {
    int n = p->supersample, width = n * p->width, height = n * p->height;
    sampling at = { p, c, { 0 }, 4 * c->half_width * c->half_height / ((double)width * height) };
    const crack_view cracks = { p, holes, ids, width, height, c->eye, c->forward, 2 * c->half_width / width };
    memset(pixels, 0, 4 * (size_t)p->width * (size_t)p->height * sizeof *pixels);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            float *pixel = pixels + 4 * ((size_t)((height - 1 - y) / n) * (size_t)p->width + (size_t)(x / n));
            double s = c->half_width * (2 * (x + 0.5) / width - 1), t = c->half_height * (2 * (y + 0.5) / height - 1);
            vec3_add_scaled(at.ray, c->forward, s, c->right);
            vec3_add_scaled(at.ray, at.ray, t, c->up);
            add_sample(&at, b, crack_closed(&cracks, x, y, at.ray), pixel);
        }
    for (size_t i = 0; i < 4 * (size_t)p->width * (size_t)p->height; i++) pixels[i] /= (float)(n * n);
}

/* Of all triangles; NULL: nothing is cut out. False when out of memory. */
static bool list_holes(const picture *p, const alpha_mask_map ***out) {
    *out = NULL;
    if (!p->maps) return true;
    *out = block_zeroed(p->memory, p->triangle_count + 1, sizeof **out);
    for (size_t m = 0; *out && m < p->mesh_count; m++)
        for (uint32_t t = p->first[m]; p->maps[m].alpha && !picture_blends(p, m) && t < p->first[m + 1]; t++)
            (*out)[t] = &p->maps[m];
    return *out;
}

/* Those of what covers all that is behind it; what blends has no area among them. */
static uint32_t *solid_indices(const picture *p) {
    uint32_t *out = block_new(p->memory, (3 * p->triangle_count + 1) * sizeof *out);
    if (out) memcpy(out, p->indices, 3 * p->triangle_count * sizeof *out);
    for (size_t m = 0; out && m < p->mesh_count; m++)
        for (size_t t = p->first[m]; picture_blends(p, m) && t < p->first[m + 1]; t++)
            out[3 * t + 1] = out[3 * t + 2] = out[3 * t];
    return out;
}

bool picture_draw(const picture *p, float *pixels, char *message, size_t message_size) {
    camera c = make_camera(p);
    int width = p->supersample * p->width, height = p->supersample * p->height;
    float *relative = block_new(p->memory, (3 * p->vertex_count + 1) * sizeof *relative);
    uint32_t *ids = block_new(p->memory, (size_t)width * (size_t)height * sizeof *ids);
    uint32_t *indices = solid_indices(p);
    item_buffer *items = NULL;
    blended over;
    const alpha_mask_map **holes = NULL;
    bool ok = false;
    snprintf(message, message_size, "out of memory");
    picture seen = *p;
    vec3_copy(seen.eye, c.eye);
    if (blended_create(&seen, &over) && relative && ids && indices && list_holes(p, &holes)) {
        for (size_t i = 0; i < 3 * p->vertex_count; i++) relative[i] = (float)(p->positions[i] - c.center[i % 3]);
        item_geometry geometry = { .positions = relative,
                                   .vertex_count = p->vertex_count,
                                   .indices = indices,
                                   .triangle_count = p->triangle_count,
                                   .coordinates = holes ? p->coordinates : NULL,
                                   .holes = holes,
                                   .near_plane = (float)(TOLERANCE_NEAR_PLANE * c.radius) };
        const item_buffer_desc desc = { .geometry = &geometry, .width = width, .height = height, .memory = p->memory };
        items = item_buffer_open(&desc, message, message_size);
    }
    if (items) {
        item_view view = view_of(&c, width, height);
        ok = item_buffer_draw(items, &view, 1, width, height, !p->draw_backs, ids);
        if (ok)
            resolve(p, &c, ids, holes, &over, pixels);
        else
            snprintf(message, message_size, "the item buffer could not be drawn");
    }
    item_buffer_destroy(items);
    blended_free(&over);
    block_free_all(relative, ids, indices, holes);
    return ok;
}
