/* SPDX-License-Identifier: MIT
 * What should an item buffer show? A ray through every pixel, against every triangle, in double precision: the third
 * opinion beside two OpenGL back ends. And random scenes to look at.
 */
#ifndef HEMIBAKE_TESTS_CORE_ITEM_RAYS_H
#define HEMIBAKE_TESTS_CORE_ITEM_RAYS_H

#include "geometry/vec3.h"
#include "visibility/item_buffer.h"

#include <stdlib.h>

/* xorshift64* (Vigna 2016): the same numbers everywhere. */
static inline double random_unit(uint64_t *state) {
    *state ^= *state >> 12, *state ^= *state << 25, *state ^= *state >> 27;
    return (double)((*state * 0x2545f4914f6cdd1du) >> 11) * 0x1p-53;
}

static inline double random_in(uint64_t *state, double low, double high) {
    return low + (high - low) * random_unit(state);
}

static inline void random_direction(uint64_t *state, double out[3]) {
    do
        for (int k = 0; k < 3; k++) out[k] = random_in(state, -1, 1);
    while (vec3_dot(out, out) > 1.0 || vec3_normalize(out) < 0.01);
}

enum { SOUP_TRIANGLES_MAX = 2048 };

typedef struct soup {
    float positions[9 * SOUP_TRIANGLES_MAX];
    uint32_t indices[3 * SOUP_TRIANGLES_MAX];
    item_geometry geometry;
} soup;

static inline void soup_triangle(soup *s, const double a[3], const double b[3], const double c[3]) {
    size_t v = s->geometry.vertex_count, t = s->geometry.triangle_count;
    if (t >= SOUP_TRIANGLES_MAX) abort();
    for (int k = 0; k < 3; k++) {
        s->positions[3 * v + k] = (float)a[k], s->positions[3 * v + 3 + k] = (float)b[k];
        s->positions[3 * v + 6 + k] = (float)c[k];
        s->indices[3 * t + k] = (uint32_t)v + (uint32_t)k;
    }
    s->geometry.vertex_count += 3, s->geometry.triangle_count++;
}

static inline void soup_start(soup *s, double near_plane) {
    s->geometry = (item_geometry){ s->positions, 0, s->indices, 0, (float)near_plane, NULL, NULL, NULL, NULL };
}

/* Triangles of many sizes in a cube of half-width 1. */
static inline void soup_random(soup *s, int triangles, uint64_t *state) {
    soup_start(s, 1e-6);
    for (int t = 0; t < triangles; t++) {
        double corner[3][3], size = pow(10, random_in(state, -1.5, 0.2));
        for (int k = 0; k < 3; k++) corner[0][k] = random_in(state, -1, 1);
        for (int i = 1; i < 3; i++)
            for (int k = 0; k < 3; k++) corner[i][k] = corner[0][k] + size * random_in(state, -1, 1);
        soup_triangle(s, corner[0], corner[1], corner[2]);
    }
}

/* A view of 90 degrees from an eye along a direction. */
static inline item_view view_along(const double eye[3], const double forward[3], int size) {
    item_view v = { .s_low = -1, .s_high = 1, .t_low = -1, .t_high = 1, .width = size, .height = size };
    double right[3], up[3];
    const double other[3] = { fabs(forward[0]) < 0.6, fabs(forward[0]) >= 0.6, 0 };
    vec3_cross(right, forward, other);
    vec3_normalize(right);
    vec3_cross(up, right, forward);
    for (int k = 0; k < 3; k++) {
        v.eye[k] = (float)eye[k], v.forward[k] = (float)forward[k];
        v.right[k] = (float)right[k], v.up[k] = (float)up[k];
    }
    return v;
}

/* The ray through pixel coordinates (x, y), centres at halves. */
static inline void view_ray(const item_view *v, double x, double y, double out[3]) {
    double s = v->s_low + ((double)v->s_high - v->s_low) * x / v->width;
    double t = v->t_low + ((double)v->t_high - v->t_low) * y / v->height;
    for (int k = 0; k < 3; k++) out[k] = (double)v->forward[k] + s * v->right[k] + t * v->up[k];
}

/* Moeller & Trumbore 1997. The distance in lengths of the ray, or INFINITY. */
static inline double ray_triangle(const item_geometry *g, size_t t, const double eye[3], const double ray[3]) {
    double corner[3][3], u[3], v[3], from[3], p[3], q[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) corner[i][k] = g->positions[3 * (size_t)g->indices[3 * t + (size_t)i] + (size_t)k];
    vec3_sub(u, corner[1], corner[0]);
    vec3_sub(v, corner[2], corner[0]);
    vec3_sub(from, eye, corner[0]);
    vec3_cross(p, ray, v);
    vec3_cross(q, from, u);
    double determinant = vec3_dot(u, p);
    if (determinant == 0.0) return INFINITY;
    double b = vec3_dot(from, p) / determinant, c = vec3_dot(ray, q) / determinant, d = vec3_dot(v, q) / determinant;
    return b >= 0 && c >= 0 && b + c <= 1 && d > 0 ? d : INFINITY;
}

/* 0 for the sky, triangle + 1 otherwise. */
static inline uint32_t ray_id(const item_geometry *g, const item_view *v, double x, double y) {
    const double eye[3] = { v->eye[0], v->eye[1], v->eye[2] };
    double ray[3], nearest = INFINITY;
    uint32_t id = 0;
    view_ray(v, x, y, ray);
    for (size_t t = 0; t < g->triangle_count; t++) {
        double d = ray_triangle(g, t, eye, ray);
        if (d < nearest) nearest = d, id = (uint32_t)t + 1;
    }
    return id;
}

/* May the pixel show this id? Rays a little to all sides of the pixel's centre say so too: rasterisers snap corners to
 * a grid of 1/256 of a pixel, and clipping rounds as much again. */
static inline bool rays_agree(const item_geometry *g, const item_view *v, int x, int y, uint32_t id) {
    static const double reach = 1.0 / 64;
    if (ray_id(g, v, x + 0.5, y + 0.5) == id) return true;
    for (int i = 0; i < 8; i++) {
        double angle = i * 0.78539816339744831;
        if (ray_id(g, v, x + 0.5 + reach * cos(angle), y + 0.5 + reach * sin(angle)) == id) return true;
    }
    return false;
}

#endif
