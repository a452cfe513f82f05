/* SPDX-License-Identifier: MIT
 * Does hemicube_sees say what its plain form says? The plain form looks up all four pixels in continuous coordinates
 * and tests each candidate in full; the fast one must agree everywhere, bit for bit, since a bake's result hangs on it.
 */
#include "check.h"
#include "formfactor/hemicube_visibility.h"
#include "item_rays.h"
#include "room.h"
#include "visibility/occlusion.h"

enum { N_MAX = 64 };

/* ---- the plain form ---- */

typedef struct place {
    int first_row, rows;
    double x, y;
} place;

static place place_of(int n, const double d[3]) {
    double au = fabs(d[0]), av = fabs(d[1]), half = 0.5 * n;
    if (au <= d[2] && av <= d[2]) return (place){ 0, n, half * (1 + d[0] / d[2]), half * (1 + d[1] / d[2]) };
    int side = au >= av ? (d[0] < 0) : 2 + (d[1] < 0);
    double depth = au >= av ? au : av, s = au >= av ? d[1] : d[0];
    return (place){ n + side * (n / 2), n / 2, half * (1 + s / depth), half * (d[2] / depth) };
}

static size_t pixel_at(const hemicube *h, const place *p, double x, double y) {
    int across = (int)x, row = (int)y;
    across = across < 0 ? 0 : across >= h->resolution ? h->resolution - 1 : across;
    row = row < 0 ? 0 : row >= p->rows ? p->rows - 1 : row;
    return (size_t)(p->first_row + row) * (size_t)h->resolution + (size_t)across;
}

static void four_pixels(const hemicube *h, const double direction[3], size_t pixel[4]) {
    double local[3] = { vec3_dot(h->tangent, direction), vec3_dot(h->bitangent, direction),
                        vec3_dot(h->normal, direction) };
    int n = h->resolution;
    place p = place_of(n, local);
    pixel[0] = pixel_at(h, &p, p.x, p.y);
    if (p.x >= 0.5 && p.x < n - 0.5 && p.y >= 0.5 && p.y < p.rows - 0.5) {
        /* From the pixel's number: p.x + 1 itself may round up to one further. */
        double x = floor(p.x) + (p.x - floor(p.x) < 0.5 ? -1 : 1), y = floor(p.y) + (p.y - floor(p.y) < 0.5 ? -1 : 1);
        pixel[1] = pixel_at(h, &p, x, p.y);
        pixel[2] = pixel_at(h, &p, p.x, y);
        pixel[3] = pixel_at(h, &p, x, y);
        return;
    }
    double step = vec3_length(local) / n;
    for (int k = 0; k < 3; k++) {
        double turned[3] = { local[0], local[1], local[2] };
        turned[k] += turned[k] > 0.0 ? -step : step;
        p = place_of(n, turned);
        pixel[k + 1] = pixel_at(h, &p, p.x, p.y);
    }
}

static bool small_hides(const hemicube *h, const surface *f, const surface *own, double t, const double point[3]) {
    double pixel = 2.0 / h->resolution, distance = vec3_distance(h->eye, point);
    double limit = TOLERANCE_SMALL_FACE_PIXELS * pixel * t * distance;
    if (f->area > limit * limit) return false;
    double cosine = surface_height(own, h->eye) / distance;
    return (1 - t) * distance > TOLERANCE_DEPTH_BIAS_PIXELS * pixel * distance / fmax(cosine, 0.1);
}

static bool plain_hides(const hemicube *h, const scene *s, const surface *f, const surface *own, const double point[3],
                        bool nearest) {
    double a = surface_height(f, h->eye), b = surface_height(f, point);
    if (a == b) return false;
    double t = a / (a - b);
    if (t <= TOLERANCE_SEGMENT_END || t >= 1 - TOLERANCE_SEGMENT_END) return false;
    return occlusion_inside(s, f, h->eye, point, t) || (nearest && small_hides(h, f, own, t, point));
}

/* All pixels up to two away on the same face of the cube. */
static bool plain_hidden_widely(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t own,
                                const double direction[3], const double point[3]) {
    const double local[3] = { vec3_dot(h->tangent, direction), vec3_dot(h->bitangent, direction),
                              vec3_dot(h->normal, direction) };
    place p = place_of(h->resolution, local);
    for (int k = 0; k < 25; k++) {
        uint32_t id = h->ids[pixel_at(h, &p, floor(p.x) + k % 5 - 2, floor(p.y) + k / 5 - 2)];
        uint32_t candidate = id ? surface_sheet(s, triangle_surface[id - 1]) : own;
        if (candidate != own && plain_hides(h, s, &s->surfaces[candidate], &s->surfaces[own], point, false))
            return true;
    }
    return false;
}

static bool plain_sees(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t surface_index,
                       const double point[3]) {
    double direction[3];
    size_t pixel[4];
    vec3_sub(direction, point, h->eye);
    if (vec3_dot(direction, h->normal) <= 0.0) return false;
    if (surface_height(&s->surfaces[surface_index], h->eye) <= 0.0) return false;
    four_pixels(h, direction, pixel);
    uint32_t own = surface_sheet(s, surface_index);
    bool sees_own = false;
    for (int k = 0; k < 4; k++) {
        uint32_t id = h->ids[pixel[k]];
        if (id == 0) continue;
        uint32_t candidate = surface_sheet(s, triangle_surface[id - 1]);
        sees_own = sees_own || candidate == own;
        if (candidate == own) continue;
        if (plain_hides(h, s, &s->surfaces[candidate], &s->surfaces[own], point, k == 0)) return false;
    }
    return sees_own || !plain_hidden_widely(h, s, triangle_surface, own, direction, point);
}

/* ---- scenes ---- */

static void random_scene(room *r, int plates, uint64_t *state) {
    room_start(r);
    uint32_t grey = room_material(r, 0.5, 0);
    room_box(r, (double[]){ -1, -1, 0 }, (double[]){ 1, 1, 2 }, true, grey, 1, 1);
    for (int i = 0; i < plates; i++) {
        double a[3], u[3], v[3], size = pow(10, random_in(state, -2.3, -0.1));
        for (int k = 0; k < 3; k++) a[k] = random_in(state, -0.9, 0.9);
        a[2] += 1;
        random_direction(state, u);
        random_direction(state, v);
        for (int k = 0; k < 3; k++) u[k] *= size, v[k] *= size;
        room_quad(r, a, u, v, grey, 1, 1);
    }
    /* Some plates have two sides: the surface behind is the twin of the one before. */
    for (size_t i = 6; i + 1 < r->surface_count; i += 5) {
        surface *front = &r->surfaces[i], *back = &r->surfaces[i + 1];
        for (int k = 0; k < 4; k++) back->corner[k] = front->corner[3 - k];
        surface_measure(back, r->vertices);
        front->twin = (uint32_t)i + 1, back->twin = (uint32_t)i;
    }
    room_finish(r);
    /* One sheet for the two sides, as the pipeline has it. */
    for (size_t t = 0; t < r->items.triangle_count; t++)
        r->triangle_surface[t] = surface_sheet(&r->scene, r->triangle_surface[t]);
}

/* At random inside the surface; or on its grid of 16, which symmetrical scenes put on the borders of pixels. */
static void point_on(const room *r, const surface *f, bool grid, uint64_t *state, double out[3]) {
    const double *a = scene_vertex(&r->scene, f->corner[0]), *b = scene_vertex(&r->scene, f->corner[1]);
    const double *d = scene_vertex(&r->scene, f->corner[3]);
    double u = random_unit(state), v = random_unit(state);
    if (grid) u = floor(17 * u) / 16, v = floor(17 * v) / 16;
    for (int k = 0; k < 3; k++) out[k] = a[k] + u * (b[k] - a[k]) + v * (d[k] - a[k]);
}

typedef struct tally {
    long tested, seen, different;
} tally;

static void compare(const room *r, const hemicube *h, int points, bool grid, uint64_t *state, tally *sum) {
    for (int i = 0; i < points; i++) {
        double point[3];
        uint32_t target = (uint32_t)(random_unit(state) * (double)r->surface_count);
        point_on(r, &r->surfaces[target], grid, state, point);
        bool fast = hemicube_sees(h, &r->scene, r->triangle_surface, target, point);
        bool plain = plain_sees(h, &r->scene, r->triangle_surface, target, point);
        sum->tested++;
        sum->seen += fast;
        sum->different += fast != plain;
    }
}

static void look_around(int scenes, bool grid, tally *sum) {
    static uint32_t ids[3 * N_MAX * N_MAX];
    uint64_t state = grid ? 31 : 30;
    char message[128] = "";
    for (int i = 0; i < scenes; i++) {
        room r;
        random_scene(&r, i % 50, &state);
        hemicube h = { .resolution = 8 << i % 4, .ids = ids };
        item_buffer *items = item_buffer_open(
            &(item_buffer_desc){ .geometry = &r.items, .width = h.resolution, .height = 3 * h.resolution }, message,
            sizeof message);
        CHECK(items);
        for (int eyes = 0; items && eyes < 10; eyes++) {
            const surface *f = &r.surfaces[(size_t)(random_unit(&state) * (double)r.surface_count)];
            double eye[3];
            point_on(&r, f, grid, &state, eye);
            if (!grid) vec3_add_scaled(eye, eye, TOLERANCE_EYE_LIFT * r.scene.radius, f->normal);
            hemicube_place(&h, eye, f->normal, grid ? PI / 2 * eyes : random_in(&state, 0, 2 * PI));
            CHECK(hemicube_draw(&h, items, r.scene.center));
            compare(&r, &h, 2000, grid, &state, sum);
        }
        item_buffer_destroy(items);
        room_free(&r);
    }
}

static void the_fast_form_agrees_with_the_plain_one(void) {
    tally sum = { 0, 0, 0 };
    look_around(80, false, &sum);
    printf("%ld points, %ld seen\n", sum.tested, sum.seen);
    CHECK_EQUAL(sum.different, 0);
    CHECK(sum.seen > sum.tested / 10 && sum.seen < sum.tested * 9 / 10);
}

static void it_agrees_on_the_borders_of_pixels(void) {
    tally sum = { 0, 0, 0 };
    look_around(80, true, &sum);
    printf("%ld points, %ld seen\n", sum.tested, sum.seen);
    CHECK_EQUAL(sum.different, 0);
    CHECK(sum.seen > sum.tested / 10);
}

int main(void) {
    RUN(the_fast_form_agrees_with_the_plain_one);
    RUN(it_agrees_on_the_borders_of_pixels);
    return check_end();
}
