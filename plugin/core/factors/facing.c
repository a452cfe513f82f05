/* SPDX-License-Identifier: MIT */
#include "factors/facing.h"

#include "geometry/vec3.h"

#include <float.h>

/* A corner of a shared edge, or of a coplanar polygon, is off the other's plane by the roundings of the plane's normal
 * and of a dot product, some ten of a coordinate; it counts as on the plane. */
static const double ON_PLANE = 16.0 * DBL_EPSILON;

/* A corner in line with its neighbours turns by what positions in float leave of it. */
static const double STRAIGHT = 1e-5;

typedef struct plane {
    double origin[3], normal[3], area;
} plane;

/* False without three finite corners and an area. */
static bool plane_of(plane *p, polygon_loop loop) {
    if (loop.count < 3) return false;
    for (size_t i = 0; i < loop.count; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(loop.corner[i][k])) return false;
    vec3_copy(p->origin, loop.corner[0]);
    polygon_loop_vector_area(loop, p->normal);
    p->area = vec3_normalize(p->normal);
    return p->area > 0.0 && isfinite(p->area);
}

static double height_over(const plane *p, const double x[3]) {
    double d[3];
    vec3_sub(d, x, p->origin);
    double height = vec3_dot(p->normal, d);
    return fabs(height) > ON_PLANE * vec3_length(d) ? height : 0.0;
}

static bool is_flat(const plane *p, polygon_loop loop) {
    double highest = 0.0, size = 0.0;
    for (size_t i = 0; i < loop.count; i++) {
        highest = fmax(highest, fabs(height_over(p, loop.corner[i])));
        size = fmax(size, vec3_distance(loop.corner[i], p->origin));
    }
    return highest <= FACING_FLATNESS * size;
}

/* What lies in front of the plane: at most twice as many corners; 0 if none is strictly in front. */
static size_t cut(double (*out)[3], polygon_loop loop, const plane *p) {
    size_t count = 0;
    bool any = false;
    const double *a = loop.corner[loop.count - 1];
    double height_a = height_over(p, a);
    for (size_t i = 0; i < loop.count; i++) {
        const double *b = loop.corner[i];
        double height_b = height_over(p, b), edge[3];
        vec3_sub(edge, b, a);
        if ((height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0))
            vec3_add_scaled(out[count++], a, height_a / (height_a - height_b), edge);
        if (height_b >= 0.0) vec3_copy(out[count++], b);
        any = any || height_b > 0.0;
        a = b, height_a = height_b;
    }
    return any && count >= 3 ? count : 0;
}

static bool is_convex(const double (*corner)[3], size_t count, const double normal[3]) {
    for (size_t i = 0; i < count; i++) {
        double e1[3], e2[3], cross[3];
        vec3_sub(e1, corner[(i + 1) % count], corner[i]);
        vec3_sub(e2, corner[(i + 2) % count], corner[(i + 1) % count]);
        vec3_cross(cross, e1, e2);
        if (vec3_dot(cross, normal) < -STRAIGHT * vec3_length(e1) * vec3_length(e2)) return false;
    }
    return true;
}

static void set_side(facing_side *s, double (*corners)[3], size_t count, const plane *p) {
    *s = (facing_side){ .loop = { corners, count }, .area = p->area };
    vec3_copy(s->normal, p->normal);
    for (size_t i = 0; i < count; i++) vec3_add_scaled(s->center, s->center, 1.0 / (double)count, corners[i]);
    for (size_t i = 0; i < count; i++) {
        s->radius = fmax(s->radius, vec3_distance(s->center, corners[i]));
        s->perimeter += vec3_distance(corners[i], corners[(i + 1) % count]);
    }
    double left[3];
    polygon_loop_vector_area(s->loop, left);
    s->area_left = vec3_length(left);
    s->convex = is_convex((const double(*)[3])corners, count, p->normal);
}

bool facing_create(facing *f, polygon_loop element, polygon_loop source, allocator *memory) {
    plane front, back;
    *f = (facing){ .any = false, .planar = true };
    if (!plane_of(&front, element) || !plane_of(&back, source)) return true;
    f->corners = block_new(memory, 2 * (element.count + source.count) * sizeof *f->corners);
    if (!f->corners) return false;
    double(*rest)[3] = f->corners + 2 * element.count;
    set_side(&f->element, f->corners, cut(f->corners, element, &back), &front);
    set_side(&f->source, rest, cut(rest, source, &front), &back);
    f->any = f->element.loop.count > 0 && f->source.loop.count > 0;
    f->far = vec3_distance(f->element.center, f->source.center) > FACING_FAR * (f->element.radius + f->source.radius);
    f->planar = is_flat(&front, element) && is_flat(&back, source);
    return true;
}

void facing_destroy(facing *f) {
    block_free(f->corners);
    f->corners = NULL;
}
