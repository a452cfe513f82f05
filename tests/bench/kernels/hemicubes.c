/* SPDX-License-Identifier: MIT
 * How many hemi-cubes are drawn in a second, by resolution and number of triangles, and how many points of surfaces are
 * found seen or hidden in them? Beside rays: for a hemi-cube one a pixel against every triangle, for a point one
 * against every surface. A box with a tessellated ball in it, seen from the floor.
 */
#include "kernels.h"

#include "formfactor/hemicube_visibility.h"
#include "formfactor/hemicube_weights.h"
#include "geometry/vec3.h"
#include "scene/scene.h"
#include "visibility/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pixels whose centre lies within a rounding of an edge may show either side of it; corners are also snapped to 1/256
 * of a pixel. Of many small triangles that is a pixel in so many. */
static const double AGREE_PIXELS = 0.98;
/* A point is decided by four pixels, and by depth where a facet is not larger than a few: 10,000 triangles on a ball
 * are that small. Measured: 0.994 there, 0.9998 with 900. */
static const double AGREE_POINTS = 0.99;

enum { POINTS = 20000 };

typedef struct ball_room {
    double *vertices;
    surface *surfaces;
    uint32_t *indices, *triangle_surface, *neighbours;
    float *positions;
    size_t vertex_count, triangle_count;
    material grey;
    scene scene;
    item_geometry items;
    item_buffer *buffer;
    hemicube cube;
    uint32_t *traced;
    uint32_t *point_surface;
    double (*points)[3];
    bool *sees;
} ball_room;

static void add_triangle(ball_room *r, uint32_t a, uint32_t b, uint32_t c) {
    surface *f = &r->surfaces[r->triangle_count];
    *f = (surface){ .corner = { a, b, c, NO_INDEX }, .twin = NO_INDEX };
    if (!surface_measure(f, r->vertices)) return; /* at the poles */
    memcpy(&r->indices[3 * r->triangle_count], (uint32_t[]){ a, b, c }, 3 * sizeof a);
    r->triangle_surface[r->triangle_count] = (uint32_t)r->triangle_count;
    r->triangle_count++;
}

static void add_vertex(ball_room *r, double x, double y, double z) {
    double *v = &r->vertices[3 * r->vertex_count++];
    v[0] = x, v[1] = y, v[2] = z;
}

/* Faces inwards. */
static void add_box(ball_room *r, double half, double height) {
    static const uint8_t quads[6][4] = { { 0, 1, 3, 2 }, { 4, 6, 7, 5 }, { 0, 4, 5, 1 },
                                         { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 5, 7, 3 } };
    uint32_t first = (uint32_t)r->vertex_count;
    for (int i = 0; i < 8; i++) add_vertex(r, i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? height : 0);
    for (int q = 0; q < 6; q++) {
        const uint8_t *c = quads[q];
        add_triangle(r, first + c[0], first + c[1], first + c[2]);
        add_triangle(r, first + c[0], first + c[2], first + c[3]);
    }
}

static void add_ball(ball_room *r, uint32_t rings, double radius, const double center[3]) {
    uint32_t first = (uint32_t)r->vertex_count, around = 2 * rings;
    for (uint32_t i = 0; i <= rings; i++)
        for (uint32_t j = 0; j < around; j++) {
            double polar = PI * i / rings, turn = 2 * PI * j / around;
            add_vertex(r, center[0] + radius * sin(polar) * cos(turn), center[1] + radius * sin(polar) * sin(turn),
                       center[2] + radius * cos(polar));
        }
    for (uint32_t i = 0; i < rings; i++)
        for (uint32_t j = 0; j < around; j++) {
            uint32_t a = first + i * around + j, b = first + i * around + (j + 1) % around;
            if (i > 0) add_triangle(r, a, a + around, b);
            if (i + 1 < rings) add_triangle(r, b, a + around, b + around);
        }
}

static bool room_make(ball_room *r, uint32_t rings) {
    size_t vertices = 8 + 2 * (size_t)rings * (rings + 1), triangles = 12 + 4 * (size_t)rings * rings;
    memset(r, 0, sizeof *r);
    r->vertices = malloc(3 * vertices * sizeof *r->vertices);
    r->positions = malloc(3 * vertices * sizeof *r->positions);
    r->surfaces = malloc(triangles * sizeof *r->surfaces);
    r->indices = malloc(3 * triangles * sizeof *r->indices);
    r->triangle_surface = malloc(triangles * sizeof *r->triangle_surface);
    r->neighbours = malloc(4 * triangles * sizeof *r->neighbours);
    if (!r->vertices || !r->positions || !r->surfaces || !r->indices || !r->triangle_surface || !r->neighbours)
        return false;
    add_box(r, 2, 3);
    if (rings) add_ball(r, rings, 0.6, (double[]){ 0.3, -0.2, 1.4 });
    r->scene = (scene){ .vertices = r->vertices,
                        .vertex_count = r->vertex_count,
                        .surfaces = r->surfaces,
                        .surface_count = r->triangle_count,
                        .materials = &r->grey,
                        .material_count = 1 };
    scene_measure(&r->scene);
    if (!scene_find_neighbours(&r->scene, r->neighbours)) return false;
    r->scene.neighbours = r->neighbours;
    for (size_t i = 0; i < 3 * r->vertex_count; i++) r->positions[i] = (float)(r->vertices[i] - r->scene.center[i % 3]);
    r->items = (item_geometry){ r->positions, r->vertex_count, r->indices, r->triangle_count, 1e-4f, NULL, NULL, NULL, NULL };
    return true;
}

static void room_free(ball_room *r) {
    free(r->vertices);
    free(r->positions);
    free(r->surfaces);
    free(r->indices);
    free(r->triangle_surface);
    free(r->neighbours);
}

/* False, with a line that says why, where a back end is not to be had. */
static bool look(ball_room *r, item_backend backend, int resolution) {
    char message[160];
    size_t pixels = 3 * (size_t)resolution * (size_t)resolution;
    const item_buffer_desc desc = {
        .geometry = &r->items, .width = resolution, .height = 3 * resolution, .backend = backend, .first_id = 1
    };
    r->cube = (hemicube){ .resolution = resolution, .ids = malloc(pixels * sizeof *r->cube.ids) };
    r->buffer = item_buffer_open(&desc, message, sizeof message);
    if (!r->buffer) printf("  none: %s\n", message);
    hemicube_place(&r->cube, (double[]){ -0.71, 0.43, 1e-6 }, (double[]){ 0, 0, 1 }, 0.3);
    return r->buffer && r->cube.ids;
}

static void look_away(ball_room *r) {
    item_buffer_destroy(r->buffer);
    free(r->cube.ids);
}

/* ---- hemi-cubes ---- */

static void draw(void *user) {
    ball_room *r = user;
    hemicube_draw(&r->cube, r->buffer, r->scene.center);
}

/* Where a ray meets a triangle (Moeller and Trumbore 1997), or infinity. */
static double meet(const ball_room *r, size_t t, const double eye[3], const double direction[3]) {
    const double *a = scene_vertex(&r->scene, r->indices[3 * t]);
    double ab[3], ac[3], p[3], s[3], q[3];
    vec3_sub(ab, scene_vertex(&r->scene, r->indices[3 * t + 1]), a);
    vec3_sub(ac, scene_vertex(&r->scene, r->indices[3 * t + 2]), a);
    vec3_cross(p, direction, ac);
    double det = vec3_dot(ab, p);
    if (det == 0.0) return INFINITY;
    vec3_sub(s, eye, a);
    double u = vec3_dot(s, p) / det;
    if (u < 0.0 || u > 1.0) return INFINITY;
    vec3_cross(q, s, ab);
    double v = vec3_dot(direction, q) / det, distance = vec3_dot(ac, q) / det;
    return v < 0.0 || u + v > 1.0 || distance <= 0.0 ? INFINITY : distance;
}

static void trace(void *user) {
    ball_room *r = user;
    for (size_t q = 0; q < 3 * (size_t)r->cube.resolution * (size_t)r->cube.resolution; q++) {
        double direction[3], nearest = INFINITY;
        const hemicube_row row = hemicube_row_at(&r->cube, q);
        vec3_add_scaled(direction, row.start, row.s, row.along);
        r->traced[q] = 0;
        for (size_t t = 0; t < r->triangle_count; t++) {
            double distance = meet(r, t, r->cube.eye, direction);
            if (distance < nearest) nearest = distance, r->traced[q] = (uint32_t)t + 1;
        }
    }
}

static double same_share(const ball_room *r) {
    size_t pixels = 3 * (size_t)r->cube.resolution * (size_t)r->cube.resolution, same = 0;
    for (size_t q = 0; q < pixels; q++) same += r->traced[q] == r->cube.ids[q];
    return (double)same / (double)pixels;
}

/* Hemi-cubes a second by rays, which must see the same; 0 past the size that they take too long for. */
static double traced_speed(ball_room *r, bool *agree) {
    size_t pixels = 3 * (size_t)r->cube.resolution * (size_t)r->cube.resolution;
    if ((double)pixels * (double)r->triangle_count > 2e8) return 0.0;
    r->traced = malloc(pixels * sizeof *r->traced);
    double taken = kernel_best(trace, r, 1), share = same_share(r);
    if (share < AGREE_PIXELS) printf("  NOT the same ids: rays agree in %.3f of the pixels\n", share);
    *agree = *agree && share >= AGREE_PIXELS;
    free(r->traced);
    return 1.0 / taken;
}

static bool print_backend(const char *name, item_backend backend) {
    static const uint32_t rings[] = { 0, 15, 50, 160 };
    static const int resolutions[] = { 64, 128, 256, 512 };
    bool agree = true;
    printf("hemi-cubes a second, %s\n  %9s %10s %10s %12s %8s\n", name, "triangles", "resolution", "drawn",
           "ray a pixel", "ratio");
    for (size_t i = 0; i < sizeof rings / sizeof *rings; i++)
        for (size_t k = 0; k < sizeof resolutions / sizeof *resolutions; k++) {
            ball_room r;
            if (!room_make(&r, rings[i])) return false;
            if (!look(&r, backend, resolutions[k])) {
                look_away(&r);
                room_free(&r);
                return agree;
            }
            draw(&r); /* shaders are compiled by the first */
            double drawn = 1.0 / kernel_best(draw, &r, 3), rays = traced_speed(&r, &agree);
            printf("  %9zu %10d %10.0f", r.triangle_count, resolutions[k], drawn);
            if (rays > 0.0)
                printf(" %12.2f %8.0f\n", rays, drawn / rays);
            else
                printf(" %12s %8s\n", "-", "-");
            look_away(&r);
            room_free(&r);
        }
    return agree;
}

bool kernel_hemicubes(void) {
    bool agree = print_backend("OSMesa", ITEM_BACKEND_OSMESA);
    agree = print_backend("EGL", ITEM_BACKEND_EGL) && agree;
    return print_backend("rays", ITEM_BACKEND_RAYS) && agree;
}

/* ---- items ---- */

static void find(void *user) {
    ball_room *r = user;
    for (size_t i = 0; i < POINTS; i++)
        r->sees[i] = hemicube_sees(&r->cube, &r->scene, r->triangle_surface, r->point_surface[i], r->points[i]);
}

static bool is_hidden(const ball_room *r, uint32_t own, const double point[3]) {
    for (size_t t = 0; t < r->triangle_count; t++) {
        double at;
        if (t == own || !occlusion_crossing(&r->surfaces[t], r->cube.eye, point, &at)) continue;
        /* Ends lie on surfaces, but for roundings. */
        if (at > 1e-6 && at < 1 - 1e-6 && occlusion_inside(&r->scene, &r->surfaces[t], r->cube.eye, point, at))
            return true;
    }
    return false;
}

static void test_all(void *user) {
    ball_room *r = user;
    for (size_t i = 0; i < POINTS; i++)
        r->sees[i] = r->points[i][2] > r->cube.eye[2] && !is_hidden(r, r->point_surface[i], r->points[i]);
}

static void scatter(ball_room *r) {
    uint64_t state = 1;
    for (size_t i = 0; i < POINTS; i++) {
        uint32_t t = (uint32_t)(kernel_random(&state) * (double)r->triangle_count);
        double u = sqrt(kernel_random(&state)), v = kernel_random(&state);
        const double weights[3] = { 1 - u, u * (1 - v), u * v };
        r->point_surface[i] = t;
        for (int k = 0; k < 3; k++) {
            r->points[i][k] = 0.0;
            for (int c = 0; c < 3; c++)
                r->points[i][k] += weights[c] * scene_vertex(&r->scene, r->indices[3 * t + (uint32_t)c])[k];
        }
    }
}

static bool print_items(ball_room *r) {
    static bool simple[POINTS];
    size_t same = 0;
    scatter(r);
    double fast = POINTS / kernel_best(find, r, 5);
    memcpy(simple, r->sees, sizeof simple);
    double slow = POINTS / kernel_best(test_all, r, 1);
    for (size_t i = 0; i < POINTS; i++) same += simple[i] == r->sees[i];
    double share = (double)same / POINTS;
    printf("  %9zu %12.2f %12.3f %8.1f %9.4f%s\n", r->triangle_count, 1e-6 * fast, 1e-6 * slow, fast / slow, share,
           share < AGREE_POINTS ? "  NOT the same" : "");
    return share >= AGREE_POINTS;
}

bool kernel_items(void) {
    static const uint32_t rings[] = { 0, 5, 15, 50 };
    bool agree = true;
    printf("points found seen or hidden by a hemi-cube of 512 pixels, millions a second\n  %9s %12s %12s %8s %9s\n",
           "triangles", "four pixels", "all surfaces", "ratio", "agree");
    for (size_t i = 0; i < sizeof rings / sizeof *rings; i++) {
        ball_room r;
        if (!room_make(&r, rings[i])) return false;
        r.points = malloc(POINTS * sizeof *r.points);
        r.point_surface = malloc(POINTS * sizeof *r.point_surface);
        r.sees = malloc(POINTS * sizeof *r.sees);
        if (look(&r, ITEM_BACKEND_DEFAULT, 512) && r.points && r.point_surface && r.sees) {
            draw(&r);
            agree = print_items(&r) && agree;
        }
        look_away(&r);
        free(r.points);
        free(r.point_surface);
        free(r.sees);
        room_free(&r);
    }
    return agree;
}
