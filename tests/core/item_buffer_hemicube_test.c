/* SPDX-License-Identifier: MIT
 * Do the item buffers of a hemi-cube hold on hard cases? No crack in a closed box, walls right beside the eye, scenes
 * of any size anywhere, surfaces that lie in each other.
 */
#include "check.h"
#include "formfactor/hemicube_visibility.h"
#include "formfactor/hemicube_weights.h"
#include "item_rays.h"
#include "room.h"

enum { N = 32, PIXELS = 3 * N * N };

typedef struct view {
    hemicube cube;
    item_buffer *items;
    uint32_t ids[PIXELS];
} view;

static bool view_open(view *v, const item_geometry *g) {
    char message[128] = "";
    v->cube = (hemicube){ .resolution = N, .ids = v->ids };
    v->items =
        item_buffer_open(&(item_buffer_desc){ .geometry = g, .width = N, .height = 3 * N }, message, sizeof message);
    if (!v->items) fprintf(stderr, "item buffer: %s\n", message);
    CHECK(v->items);
    return v->items;
}

static bool look(view *v, const double eye[3], const double normal[3], double angle, const double center[3]) {
    hemicube_place(&v->cube, eye, normal, angle);
    bool drawn = v->items && hemicube_draw(&v->cube, v->items, center);
    CHECK(drawn);
    return drawn;
}

/* ---- a closed box: eight corners, twelve triangles, whose edges are shared bit by bit ---- */

typedef struct box {
    double low[3], high[3], center[3], radius;
    float positions[24];
    uint32_t indices[36];
    item_geometry geometry;
} box;

/* Corner i is high along axis k where bit k of i is set. Wall w: axis w / 2, low or high side; triangles 2w and 2w+1.
 */
static void box_finish(box *b) {
    vec3_mid(b->center, b->low, b->high);
    b->radius = 0.5 * vec3_distance(b->low, b->high);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            b->positions[3 * i + k] = (float)((i >> k & 1 ? b->high : b->low)[k] - b->center[k]);
    for (uint32_t w = 0; w < 6; w++) {
        uint32_t axis = w / 2, i = 1u << (axis + 1) % 3, k = 1u << (axis + 2) % 3, base = w % 2 ? 1u << axis : 0;
        const uint32_t quad[6] = { base, base + i, base + i + k, base, base + i + k, base + k };
        memcpy(b->indices + 6 * w, quad, sizeof quad);
    }
    b->geometry = (item_geometry){ b->positions, 8,    b->indices, 12,  (float)(TOLERANCE_NEAR_PLANE * b->radius),
                                   NULL,         NULL, NULL,       NULL };
}

static void box_random(box *b, double scale, double offset, uint64_t *state) {
    for (int k = 0; k < 3; k++) {
        b->low[k] = offset + scale * random_in(state, -1, 0);
        b->high[k] = b->low[k] + scale * random_in(state, 0.1, 2);
    }
    box_finish(b);
}

/* An eye on wall w, lifted as column.c lifts it; beside: how near to the walls around it, relative to the radius (0:
 * anywhere). */
static void eye_on_wall(const box *b, int w, double beside, uint64_t *state, double eye[3], double normal[3]) {
    int axis = w / 2;
    for (int k = 0; k < 3; k++) {
        bool high = random_unit(state) < 0.5;
        normal[k] = k == axis ? (w % 2 ? -1 : 1) : 0;
        if (beside == 0.0)
            eye[k] = random_in(state, b->low[k], b->high[k]);
        else
            eye[k] = (high ? b->high : b->low)[k] + (high ? -1 : 1) * beside * b->radius;
    }
    eye[axis] = (w % 2 ? b->high : b->low)[axis] + normal[axis] * TOLERANCE_EYE_LIFT * b->radius;
}

typedef struct tally {
    int frames, sky, own;
} tally;

static void count_leaks(box *b, int frames, double beside, uint64_t *state, tally *sum) {
    view v;
    if (view_open(&v, &b->geometry))
        for (int i = 0; i < frames; i++) {
            double eye[3], normal[3];
            int w = (int)(6 * random_unit(state));
            eye_on_wall(b, w, beside, state, eye, normal);
            if (!look(&v, eye, normal, random_in(state, 0, 2 * PI), b->center)) break;
            for (int p = 0; p < PIXELS; p++) {
                sum->sky += v.ids[p] == 0;
                sum->own += v.ids[p] != 0 && (v.ids[p] - 1) / 2 == (uint32_t)w;
            }
            sum->frames++;
        }
    item_buffer_destroy(v.items);
}

static void no_crack_of_a_closed_box_shows_the_sky_in_a_thousand_frames(void) {
    uint64_t state = 5;
    tally sum = { 0, 0, 0 };
    for (int i = 0; i < 40; i++) {
        box b;
        box_random(&b, 1, 0, &state);
        count_leaks(&b, 25, 0, &state, &sum);
    }
    CHECK_EQUAL(sum.frames, 1000);
    CHECK_EQUAL(sum.sky, 0);
    /* The wall that the eye sits on is behind its horizon. */
    CHECK_EQUAL(sum.own, 0);
}

static void walls_right_beside_the_eye_are_whole(void) {
    const double beside[] = { 1e-2, 1e-4, 1e-5, 4e-6, 2e-6, 1e-6 };
    uint64_t state = 6;
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        tally sum = { 0, 0, 0 };
        for (int k = 0; k < 10; k++) {
            box b;
            box_random(&b, 1, 0, &state);
            count_leaks(&b, 15, beside[i], &state, &sum);
        }
        CHECK_EQUAL(sum.sky, 0);
        CHECK_EQUAL(sum.own, 0);
    }
}

static void scenes_of_any_size_anywhere_are_as_tight(void) {
    const double scale[] = { 1e-4, 1, 1e4, 1, 1e-1 }, offset[] = { 0, 1e6, 1e6, -1e6, 1e6 };
    uint64_t state = 7;
    for (size_t i = 0; i < sizeof scale / sizeof *scale; i++) {
        tally sum = { 0, 0, 0 };
        for (int k = 0; k < 10; k++) {
            box b;
            box_random(&b, scale[i], offset[i], &state);
            count_leaks(&b, 10, k % 2 ? 1e-5 : 0, &state, &sum);
        }
        CHECK_EQUAL(sum.sky, 0);
        CHECK_EQUAL(sum.own, 0);
    }
}

/* ---- depth beside walls ---- */

/* A wall that passes the eye at a millionth of its length has depths of six decades in one triangle; interpolated in
 * floats it must still hide and be hidden as rays say. */
static void ids_beside_walls_are_what_rays_meet(void) {
    const double beside[] = { 0, 1e-2, 1e-4, 1e-5, 2e-6 };
    static uint32_t ids[N * N];
    uint64_t state = 8;
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        int wrong = 0;
        for (int k = 0; k < 30; k++) {
            box b;
            view v;
            double eye[3], normal[3], relative[3];
            box_random(&b, 1, 0, &state);
            if (!view_open(&v, &b.geometry)) break;
            eye_on_wall(&b, k % 6, beside[i], &state, eye, normal);
            vec3_sub(relative, eye, b.center);
            item_view w = view_along(relative, normal, N);
            CHECK(item_buffer_draw(v.items, &w, 1, N, N, false, ids));
            item_buffer_destroy(v.items);
            for (int p = 0; p < N * N; p++) wrong += !rays_agree(&b.geometry, &w, p % N, p / N, ids[p]);
        }
        CHECK_EQUAL(wrong, 0);
    }
}

/* ---- surfaces in each other ---- */

/* A point of the plane through the origin with unit normal n: u and v along its axes. */
static void in_plane(const double n[3], double u, double v, double out[3]) {
    double e[3], f[3];
    const double other[3] = { fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0 };
    vec3_cross(e, n, other);
    vec3_normalize(e);
    vec3_cross(f, n, e);
    for (int k = 0; k < 3; k++) out[k] = 0.3 * n[k] + u * e[k] + v * f[k];
}

static void add_quad(soup *s, const double n[3], double u, double v, double size, double turn) {
    double corner[4][3];
    for (int i = 0; i < 4; i++)
        in_plane(n, u + size * cos(turn + i * PI / 2), v + size * sin(turn + i * PI / 2), corner[i]);
    soup_triangle(s, corner[0], corner[1], corner[2]);
    soup_triangle(s, corner[0], corner[2], corner[3]);
}

/* Is pixel (x, y) well inside one of the triangles first .. first + 1? */
static bool covers(const soup *s, size_t first, const item_view *v, int x, int y) {
    const double eye[3] = { v->eye[0], v->eye[1], v->eye[2] };
    for (int i = 0; i < 4; i++) {
        double ray[3];
        view_ray(v, x + 0.5 + (i % 2 ? 0.1 : -0.1), y + 0.5 + (i / 2 ? 0.1 : -0.1), ray);
        if (ray_triangle(&s->geometry, first, eye, ray) == INFINITY &&
            ray_triangle(&s->geometry, first + 1, eye, ray) == INFINITY)
            return false;
    }
    return true;
}

static void of_quads_that_lie_in_each_other_the_first_is_seen_everywhere(void) {
    static soup s;
    static uint32_t ids[N * N];
    uint64_t state = 9;
    int both = 0, wrong = 0;
    for (int i = 0; i < 40; i++) {
        double n[3], diagonal[3] = { i % 3 ? 1 : 0, i % 2 ? 1 : -1, i % 5 ? 1 : -1 };
        char message[128] = "";
        random_direction(&state, n);
        /* Modellers' planes, too: along the axes' diagonals, where components are equal up to rounding. */
        vec3_normalize(diagonal);
        if (i >= 30) vec3_copy(n, diagonal);
        soup_start(&s, 1e-6);
        for (int q = 0; q < 3; q++)
            add_quad(&s, n, random_in(&state, -0.2, 0.2), random_in(&state, -0.2, 0.2), random_in(&state, 0.5, 1.5),
                     random_in(&state, 0, 6));
        item_buffer *items = item_buffer_open(&(item_buffer_desc){ .geometry = &s.geometry, .width = N, .height = N },
                                              message, sizeof message);
        CHECK(items);
        for (int frame = 0; items && frame < 20; frame++) {
            double eye[3], forward[3];
            in_plane(n, random_in(&state, -1, 1), random_in(&state, -1, 1), eye);
            /* From right above the plane to far away. */
            vec3_add_scaled(eye, eye, (frame % 2 ? -1 : 1) * pow(10, random_in(&state, -3, 0.5)), n);
            for (int k = 0; k < 3; k++) forward[k] = 0.3 * n[k] - eye[k] + random_in(&state, -0.2, 0.2);
            vec3_normalize(forward);
            item_view v = view_along(eye, forward, N);
            CHECK(item_buffer_draw(items, &v, 1, N, N, false, ids));
            for (int p = 0; p < N * N; p++)
                for (size_t first = 0, rank = 0; first < 6; first += 2) {
                    if (!covers(&s, first, &v, p % N, p / N)) continue;
                    both += rank++ > 0;
                    /* The first that covers the pixel is seen. */
                    if (rank == 1) wrong += ids[p] == 0 || ids[p] > first + 2;
                }
        }
        item_buffer_destroy(items);
    }
    printf("quads in one plane: %d of %d pixels show a later one\n", wrong, both);
    CHECK_EQUAL(wrong, 0);
    CHECK(both > 10000);
}

static void quads_that_lie_in_each_other_are_both_visible(void) {
    room r;
    view v;
    int wrong = 0;
    room_start(&r);
    room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -1, -1, 2 }, (double[]){ 0, 2, 0 }, (double[]){ 2, 0, 0 }, 0, 1, 1);
    room_quad(&r, (double[]){ -0.4, -0.7, 2 }, (double[]){ 0, 1, 0.0 }, (double[]){ 1.1, 0.3, 0 }, 0, 1, 1);
    /* And one that looks the other way. */
    room_quad(&r, (double[]){ -0.2, -0.9, 2 }, (double[]){ 1, 0.2, 0 }, (double[]){ 0.1, 1, 0 }, 0, 1, 1);
    room_finish(&r);
    if (view_open(&v, &r.items))
        for (int frame = 0; frame < 20; frame++) {
            if (!look(&v, (double[]){ 0.1 * frame - 1, 0.05 * frame, 0 }, (double[]){ 0, 0, 1 }, frame, r.scene.center))
                break;
            for (uint32_t f = 0; f < 3; f++)
                for (int i = 0; i < 100; i++) {
                    double point[3];
                    vec3_copy(point, scene_vertex(&r.scene, r.surfaces[f].corner[0]));
                    for (int k = 0; k < 3; k++)
                        point[k] +=
                            (i % 10 + 0.5) / 10 * (scene_vertex(&r.scene, r.surfaces[f].corner[1])[k] - point[k]);
                    /* What looks away is behind itself. */
                    wrong += hemicube_sees(&v.cube, &r.scene, r.triangle_surface, f, point) != (f < 2);
                }
        }
    CHECK_EQUAL(wrong, 0);
    item_buffer_destroy(v.items);
    room_free(&r);
}

/* What a point sees does not hang on how the frame is turned, but for the edges of pixels. */
static void turning_the_frame_changes_what_is_seen_by_aliasing_only(void) {
    room r;
    view v;
    static double weights[PIXELS];
    double low = INFINITY, high = -INFINITY;
    hemicube_weights(N, weights);
    room_start(&r);
    room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -0.3, -0.6, 1 }, (double[]){ 0, 1.3, 0 }, (double[]){ 1, 0, 0 }, 0, 1, 1);
    room_finish(&r);
    if (view_open(&v, &r.items))
        for (int turn = 0; turn < 60; turn++) {
            if (!look(&v, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, 2 * PI * turn / 60, r.scene.center)) break;
            hemicube_closure c = hemicube_close(&v.cube, weights, &r.scene, r.triangle_surface);
            CHECK_NEAR(c.front + c.back + c.sky, 1, 1e-12);
            low = fmin(low, c.front), high = fmax(high, c.front);
        }
    /* A perimeter of 4.6 cuts some 75 of the 32 x 32 pixels of the top, which weigh at most 1 / (pi 256) each; their
     * halves add up at random. */
    CHECK_NEAR(high, low, 2 * sqrt(75.0) * 0.5 / (PI * 256));
    CHECK(high > low);
    item_buffer_destroy(v.items);
    room_free(&r);
}

static void what_shows_its_back_blocks(void) {
    room r;
    view v;
    room_start(&r);
    room_material(&r, 0.5, 0);
    uint32_t ceiling = room_quad(&r, (double[]){ -9, -9, 2 }, (double[]){ 0, 18, 0 }, (double[]){ 18, 0, 0 }, 0, 1, 1);
    uint32_t back = room_quad(&r, (double[]){ -1, -1, 1 }, (double[]){ 2, 0, 0 }, (double[]){ 0, 2, 0 }, 0, 1, 1);
    room_finish(&r);
    if (view_open(&v, &r.items) && look(&v, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, 0.3, r.scene.center)) {
        CHECK(!hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, (double[]){ 1.9, 0, 2 }));
        CHECK(hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, (double[]){ 2.1, 0, 2 }));
        CHECK_EQUAL(r.triangle_surface[v.ids[N / 2 * N + N / 2] - 1], back);
    }
    item_buffer_destroy(v.items);
    room_free(&r);
}

int main(void) {
    RUN(no_crack_of_a_closed_box_shows_the_sky_in_a_thousand_frames);
    RUN(walls_right_beside_the_eye_are_whole);
    RUN(scenes_of_any_size_anywhere_are_as_tight);
    RUN(ids_beside_walls_are_what_rays_meet);
    RUN(of_quads_that_lie_in_each_other_the_first_is_seen_everywhere);
    RUN(quads_that_lie_in_each_other_are_both_visible);
    RUN(turning_the_frame_changes_what_is_seen_by_aliasing_only);
    RUN(what_shows_its_back_blocks);
    return check_end();
}
