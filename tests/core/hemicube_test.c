/* SPDX-License-Identifier: MIT
 * Does a hemi-cube see what is there? Item buffers drawn by the back end, judged against rays in double precision.
 */
#include "check.h"
#include "formfactor/hemicube_visibility.h"
#include "formfactor/hemicube_weights.h"
#include "room.h"

static const double UP[3] = { 0, 0, 1 };
static const double ORIGIN[3] = { 0, 0, 0 };

typedef struct view {
    hemicube cube;
    item_buffer *items;
    double *weights;
} view;

static bool view_open(view *v, const item_geometry *g, int resolution) {
    char message[128] = "";
    size_t pixels = 3 * (size_t)resolution * (size_t)resolution;
    v->cube = (hemicube){ .resolution = resolution, .ids = malloc(pixels * sizeof(uint32_t)) };
    v->weights = malloc(pixels * sizeof *v->weights);
    v->items = item_buffer_open(&(item_buffer_desc){ .geometry = g, .width = resolution, .height = 3 * resolution },
                                message, sizeof message);
    if (v->weights) hemicube_weights(resolution, v->weights);
    if (!v->items) fprintf(stderr, "item buffer: %s\n", message);
    CHECK(v->items && v->weights && v->cube.ids);
    return v->items && v->weights && v->cube.ids;
}

static void view_close(view *v) {
    item_buffer_destroy(v->items);
    free(v->weights);
    free(v->cube.ids);
}

static bool look(view *v, const double eye[3], const double normal[3], double angle, const double center[3]) {
    hemicube_place(&v->cube, eye, normal, angle);
    bool drawn = hemicube_draw(&v->cube, v->items, center);
    CHECK(drawn);
    return drawn;
}

static hemicube_closure closure(room *r, int resolution, const double eye[3], const double normal[3], double angle) {
    view v;
    hemicube_closure c = { NAN, NAN, NAN };
    if (view_open(&v, &r->items, resolution) && look(&v, eye, normal, angle, r->scene.center))
        c = hemicube_close(&v.cube, v.weights, &r->scene, r->triangle_surface);
    view_close(&v);
    return c;
}

/* The direction through the middle of pixel (x, row), from the picture in hemicube.h. */
static void pixel_direction(const hemicube *h, int x, int row, double out[3]) {
    int n = h->resolution, half = n / 2, side = row < n ? -1 : (row - n) / half;
    double s = (2 * x + 1.0) / n - 1;
    for (int k = 0; k < 3; k++) {
        if (side < 0) {
            out[k] = h->normal[k] + s * h->tangent[k] + ((2 * row + 1.0) / n - 1) * h->bitangent[k];
            continue;
        }
        double t = (2 * ((row - n) % half) + 1.0) / n, sign = side & 1 ? -1 : 1;
        const double *forward = side < 2 ? h->tangent : h->bitangent, *across = side < 2 ? h->bitangent : h->tangent;
        out[k] = sign * forward[k] + s * across[k] + t * h->normal[k];
    }
}

/* ---- frames ---- */

static void the_frame_is_orthonormal_and_right_handed_for_every_normal(void) {
    const double normals[][3] = { { 0, 0, 1 },     { 0, 0, -1 },
                                  { 1, 0, 0 },     { 0, -1, 0 },
                                  { 0.6, 0, 0.8 }, { 0.57735026918962576, 0.57735026918962576, 0.57735026918962576 } };
    for (size_t i = 0; i < sizeof normals / sizeof *normals; i++)
        for (double angle = 0; angle < 6.5; angle += 0.7) {
            hemicube h = { .resolution = 16 };
            double cross[3];
            hemicube_place(&h, ORIGIN, normals[i], angle);
            vec3_cross(cross, h.tangent, h.bitangent);
            /* A few roundings of unit vectors. */
            CHECK_NEAR(vec3_distance(cross, h.normal), 0.0, 1e-15);
            CHECK_NEAR(vec3_length(h.tangent), 1.0, 1e-15);
            CHECK_NEAR(vec3_dot(h.tangent, h.normal), 0.0, 1e-15);
        }
}

static void the_angle_turns_the_frame_about_the_normal(void) {
    hemicube h = { .resolution = 16 }, turned = { .resolution = 16 };
    hemicube_place(&h, ORIGIN, UP, 0.0);
    hemicube_place(&turned, ORIGIN, UP, PI / 2);
    /* A quarter turn takes the tangent to the bitangent; cos(pi / 2) is 6e-17. */
    CHECK_NEAR(vec3_distance(turned.tangent, h.bitangent), 0.0, 1e-15);
}

/* ---- closure ---- */

static void in_a_closed_box_all_light_reaches_fronts(void) {
    room r;
    room_start(&r);
    room_box(&r, (double[]){ -1, 2, 0 }, (double[]){ 3, 5, 2.5 }, true, room_material(&r, 0.5, 0), 1, 1);
    room_finish(&r);
    for (int i = 0; i < 8; i++) {
        hemicube_closure c = closure(&r, 64, (double[]){ 0.3 * i - 0.9, 2.2 + 0.3 * i, 1e-5 }, UP, 0.8 * i);
        /* No crack shows the sky, and the weights sum to 1. */
        CHECK_NEAR(c.front, 1.0, 1e-12);
        CHECK_NEAR(c.back, 0.0, 0);
        CHECK_NEAR(c.sky, 0.0, 0);
    }
    room_free(&r);
}

static void backs_count_as_backs(void) {
    room r;
    room_start(&r);
    room_box(&r, (double[]){ -1, -1, -1 }, (double[]){ 1, 1, 1 }, false, room_material(&r, 0.5, 0), 1, 1);
    room_finish(&r);
    hemicube_closure c = closure(&r, 32, ORIGIN, UP, 0.4);
    /* The box as it is seen from inside: nothing but backs; weights sum to 1. */
    CHECK_NEAR(c.back, 1.0, 1e-12);
    CHECK_NEAR(c.front, 0.0, 0);
    room_free(&r);
}

static void a_sheet_with_a_twin_has_no_back(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -1, -1, 1 }, (double[]){ 2, 0, 0 }, (double[]){ 0, 2, 0 }, grey, 1, 1);
    room_quad(&r, (double[]){ -1, -1, 1 }, (double[]){ 0, 2, 0 }, (double[]){ 2, 0, 0 }, grey, 1, 1);
    room_finish(&r);
    r.items.triangle_count = 2; /* the first alone is drawn; it shows its back */
    hemicube_closure single = closure(&r, 64, ORIGIN, UP, 0.1);
    CHECK(single.back > 0.5);
    r.surfaces[0].twin = 1, r.surfaces[1].twin = 0;
    hemicube_closure twins = closure(&r, 64, ORIGIN, UP, 0.1);
    CHECK_NEAR(twins.front, single.back, 0);
    CHECK_NEAR(twins.back, 0.0, 0);
    room_free(&r);
}

static void a_room_with_a_square_overhead(room *r) {
    room_start(r);
    room_quad(r, (double[]){ -0.5, -0.5, 1 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, room_material(r, 0.5, 0), 1,
              1);
    room_finish(r);
}

static void the_closure_of_a_square_overhead_tends_to_its_closed_form(void) {
    room r;
    a_room_with_a_square_overhead(&r);
    /* Four times [Howell82, B-3] with a = b = 1/2, c = 1. */
    const double exact = 4 * (2 * (0.5 / sqrt(1.25)) * atan(0.5 / sqrt(1.25))) / (2 * PI);
    double first = 0.0, last = 0.0;
    for (int n = 16; n <= 512; n *= 2) {
        double worst = 0.0;
        for (int i = 0; i < 5; i++) {
            hemicube_closure c = closure(&r, n, ORIGIN, UP, 0.13 + 0.3 * i);
            CHECK_NEAR(c.front + c.sky, 1.0, 1e-12);
            worst = fmax(worst, fabs(c.front - exact));
        }
        /* About 2 n pixels of weight 4 / (pi n^2) lie on the border, each wrong by half of itself at most. */
        CHECK_NEAR(worst, 0.0, 4 / (PI * n));
        if (n == 16) first = worst;
        last = worst;
    }
    printf("square overhead: error %.2g at 16 pixels, %.2g at 512\n", first, last);
    /* Errors of border pixels are about random, so they fall with n^1.5 = 181; a safe part of it. */
    CHECK(last < first / 20);
    room_free(&r);
}

static void turning_the_frame_changes_the_closure_by_aliasing_only(void) {
    enum { N = 128 };
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_box(&r, (double[]){ 0.3, 0.2, 0 }, (double[]){ 1, 1.5, 1 }, false, grey, 1, 1);
    room_quad(&r, (double[]){ -2, -1, 0.5 }, (double[]){ 1, 0, 0.5 }, (double[]){ 0, 2, 0 }, grey, 1, 1);
    room_finish(&r);
    double low = 1, high = 0, back_low = 1, back_high = 0;
    for (int i = 0; i < 12; i++) {
        hemicube_closure c = closure(&r, N, ORIGIN, UP, i * PI / 6);
        low = fmin(low, c.front), high = fmax(high, c.front);
        back_low = fmin(back_low, c.back), back_high = fmax(back_high, c.back);
    }
    CHECK(low > 0.05 && back_low > 0.01);
    /* Outlines of about 4 n pixels, each wrong by half of at most 4 / (pi n^2), twice for a difference. */
    CHECK(high - low < 16 / (PI * N));
    CHECK(back_high - back_low < 16 / (PI * N));
    room_free(&r);
}

/* ---- ids ---- */

enum { CELLS = 190, GRID_TRIANGLES = 2 * CELLS * CELLS };
static const double GRID_LOW = -1.37, GRID_SIZE = 3.01;

/* A ceiling at height 1 cut to 72,200 triangles; triangle 2 (y CELLS + x) and the next are its cell (x, y). */
static item_geometry make_grid(arena *memory) {
    float *positions = arena_alloc(memory, 3 * (CELLS + 1) * (CELLS + 1), sizeof *positions);
    uint32_t *indices = arena_alloc(memory, 3 * GRID_TRIANGLES, sizeof *indices), *at = indices;
    for (int y = 0; y <= CELLS; y++)
        for (int x = 0; x <= CELLS; x++) {
            float *p = positions + 3 * (y * (CELLS + 1) + x);
            p[0] = (float)(GRID_LOW + GRID_SIZE * x / CELLS);
            p[1] = (float)(GRID_LOW + GRID_SIZE * y / CELLS);
            p[2] = 1.0f;
        }
    for (uint32_t y = 0; y < CELLS; y++)
        for (uint32_t x = 0; x < CELLS; x++) {
            uint32_t a = y * (CELLS + 1) + x, b = a + 1, c = a + CELLS + 1, d = c + 1;
            const uint32_t cell[6] = { a, c, b, b, c, d };
            memcpy(at, cell, sizeof cell);
            at += 6;
        }
    return (
        item_geometry){ positions, (CELLS + 1) * (CELLS + 1), indices, GRID_TRIANGLES, 1e-4f, NULL, NULL, NULL, NULL };
}

static void every_pixel_names_the_triangle_that_its_ray_meets(void) {
    arena memory = { 0 };
    item_geometry g = make_grid(&memory);
    view v;
    if (view_open(&v, &g, 256) && look(&v, ORIGIN, UP, 0.37, ORIGIN)) {
        int n = v.cube.resolution, wrong = 0, tested = 0, high = 0;
        for (int row = 0; row < 3 * n; row++)
            for (int x = 0; x < n; x++) {
                double d[3];
                pixel_direction(&v.cube, x, row, d);
                double s = (d[0] / d[2] - GRID_LOW) / GRID_SIZE * CELLS,
                       t = (d[1] / d[2] - GRID_LOW) / GRID_SIZE * CELLS;
                bool inside = s > 0 && t > 0 && s < CELLS && t < CELLS;
                double fs = s - floor(s), ft = t - floor(t), off = fmin(fmin(fs, 1 - fs), fmin(ft, 1 - ft));
                /* Rays within 5 % of a cell of an edge may fall on either side of it: llvmpipe snaps corners to 1/256
                 * of a pixel, which is 1 % of a cell here and more in the lowest rows of the sides. */
                if (fmin(off, fabs(fs + ft - 1)) < 0.05) continue;
                uint32_t expected = 0;
                if (inside) expected = 2 * ((uint32_t)t * CELLS + (uint32_t)s) + (fs + ft > 1) + 1;
                tested++;
                high += expected > UINT16_MAX;
                wrong += v.cube.ids[row * n + x] != expected;
            }
        CHECK_EQUAL(wrong, 0);
        CHECK(tested > 50000);
        CHECK(high > 1000);
    }
    view_close(&v);
    arena_free(&memory);
}

static void nothing_to_see_is_sky(void) {
    room r;
    a_room_with_a_square_overhead(&r);
    hemicube_closure c = closure(&r, 32, (double[]){ 0, 0, 1.5 }, UP, 0.0);
    CHECK_NEAR(c.sky, 1.0, 1e-12);
    room_free(&r);
}

static void the_nearer_surface_hides_the_farther_one(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    /* Three ceilings, two of them a millionth of the scene apart, drawn in an order that depth alone can sort out. */
    static const double heights[3] = { 1.0 + 2e-6, 1.0, 3.0 };
    for (int i = 0; i < 3; i++)
        room_quad(&r, (double[]){ -4, -4, heights[i] }, (double[]){ 0, 8, 0 }, (double[]){ 8, 0, 0 }, grey, 1, 1);
    room_finish(&r);
    view v;
    if (view_open(&v, &r.items, 64) && look(&v, ORIGIN, UP, 0.2, r.scene.center)) {
        int other = 0;
        for (int q = 0; q < 64 * 64; q++) other += v.cube.ids[q] != 3 && v.cube.ids[q] != 4;
        CHECK_EQUAL(other, 0);
    }
    view_close(&v);
    room_free(&r);
}

/* ---- the exact shadow ---- */

/* A square of side 1 at height 1 over the eye, and a ceiling at height 2 that it shades. */
static void make_shade(room *r, uint32_t *ceiling) {
    room_start(r);
    uint32_t grey = room_material(r, 0.5, 0);
    room_quad(r, (double[]){ -0.5, -0.5, 1 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, grey, 1, 1);
    *ceiling = room_quad(r, (double[]){ -6, -6, 2 }, (double[]){ 0, 12, 0 }, (double[]){ 12, 0, 0 }, grey, 1, 1);
    room_finish(r);
}

static void what_an_occluder_covers_is_not_seen_to_far_less_than_a_pixel(void) {
    room r;
    uint32_t ceiling;
    make_shade(&r, &ceiling);
    view v;
    /* 32 pixels: each is 1/8 wide on the ceiling. */
    if (view_open(&v, &r.items, 32))
        for (int turn = 0; turn < 7; turn++) {
            if (!look(&v, ORIGIN, UP, 0.9 * turn, r.scene.center)) break;
            for (int i = -9; i <= 9; i++) {
                /* The shadow is the square of side 2. A hundred-thousandth of a pixel beside its edges: */
                const double along = 0.1 * i, in = 1 - 1e-6, out = 1 + 1e-6;
                const double shaded[4][3] = {
                    { in, along, 2 }, { -in, along, 2 }, { along, in, 2 }, { along, -in, 2 }
                };
                const double lit[4][3] = {
                    { out, along, 2 }, { -out, along, 2 }, { along, out, 2 }, { along, -out, 2 }
                };
                for (int k = 0; k < 4; k++) {
                    CHECK(!hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, shaded[k]));
                    CHECK(hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, lit[k]));
                }
            }
        }
    view_close(&v);
    room_free(&r);
}

static void shadows_on_the_sides_of_the_cube_are_as_exact(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    /* A fence at x = 1 of height 0.3, and a wall at x = 2 behind it: the shadow ends at height 0.6. */
    room_quad(&r, (double[]){ 1, -9, 0 }, (double[]){ 0, 0, 0.3 }, (double[]){ 0, 18, 0 }, grey, 1, 1);
    uint32_t wall = room_quad(&r, (double[]){ 2, -9, 0 }, (double[]){ 0, 0, 9 }, (double[]){ 0, 18, 0 }, grey, 1, 1);
    room_finish(&r);
    view v;
    /* 1e-5 clears the float of 0.3 (1e-8) and is a ten-thousandth of a pixel of 32. */
    if (view_open(&v, &r.items, 32))
        for (int turn = 0; turn < 9; turn++) {
            if (!look(&v, ORIGIN, UP, 0.7 * turn, r.scene.center)) break;
            for (double y = -3; y <= 3; y += 0.21) {
                CHECK(!hemicube_sees(&v.cube, &r.scene, r.triangle_surface, wall, (double[]){ 2, y, 0.6 - 1e-5 }));
                CHECK(hemicube_sees(&v.cube, &r.scene, r.triangle_surface, wall, (double[]){ 2, y, 0.6 + 1e-5 }));
            }
        }
    view_close(&v);
    room_free(&r);
}

static void what_is_below_the_horizon_is_not_seen(void) {
    room r;
    uint32_t ceiling;
    make_shade(&r, &ceiling);
    view v;
    if (view_open(&v, &r.items, 32) && look(&v, (double[]){ 0, 0, 1.5 }, UP, 0, r.scene.center)) {
        CHECK(hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, (double[]){ 3, 0, 2 }));
        CHECK(!hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, (double[]){ 3, 0, 1.5 }));
        CHECK(!hemicube_sees(&v.cube, &r.scene, r.triangle_surface, ceiling, (double[]){ 3, 0, 1 }));
    }
    view_close(&v);
    room_free(&r);
}

static void every_sample_of_a_closed_convex_room_is_seen(void) {
    room r;
    room_start(&r);
    room_box(&r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(&r, 0.5, 0), 2, 4);
    room_finish(&r);
    view v;
    int unseen = 0, tested = 0;
    if (view_open(&v, &r.items, 32))
        for (int i = 0; i < 5; i++) {
            if (!look(&v, (double[]){ 0.1 + 0.6 * i, 0.05 + 0.4 * i, 1e-5 }, UP, i, r.scene.center)) break;
            for (size_t p = 0; p < r.mesh.patch_count; p++) {
                const patch *owner = &r.mesh.patches[p];
                if (owner->surface == 0) continue;
                for (uint32_t s = owner->first_sample; s < owner->first_sample + owner->sample_count; s++) {
                    const double point[3] = { r.mesh.x[s], r.mesh.y[s], r.mesh.z[s] };
                    unseen += !hemicube_sees(&v.cube, &r.scene, r.triangle_surface, owner->surface, point);
                    tested++;
                }
            }
        }
    CHECK_EQUAL(unseen, 0);
    CHECK(tested > 1000);
    view_close(&v);
    room_free(&r);
}

/* ---- what stands on a patch ---- */

static polygon floor_square(double x0, double y0, double x1, double y1) {
    return (polygon){ { { x0, y0, 0 }, { x1, y0, 0 }, { x1, y1, 0 }, { x0, y1, 0 } }, 4 };
}

static bool is_crossed(room *r, const double eye[3], polygon shape, double angle) {
    view v;
    bool crossed = false;
    if (view_open(&v, &r->items, 64) && look(&v, eye, UP, angle, r->scene.center))
        crossed = hemicube_is_crossed(&v.cube, &r->scene, r->triangle_surface, &(hemicube_floor){ .shape = &shape });
    view_close(&v);
    return crossed;
}

static void a_box_on_a_floor_crosses_the_piece_it_stands_on_and_no_other(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_box(&r, (double[]){ -4, -4, 0 }, (double[]){ 4, 4, 3 }, true, grey, 1, 1);
    room_box(&r, (double[]){ 0.4, 0.3, 0 }, (double[]){ 0.9, 0.8, 0.7 }, false, grey, 1, 1);
    room_finish(&r);
    for (double angle = 0; angle < 6; angle += 0.45) {
        const double eye[3] = { 0, 0, 1e-5 }, beside[3] = { -1.5, 0, 1e-5 };
        CHECK(is_crossed(&r, eye, floor_square(-1, -1, 1, 1), angle));
        /* Its footprint begins at x = 0.4: a piece that ends at 0.3 is clear of it, and so is the next one. */
        CHECK(!is_crossed(&r, eye, floor_square(-1, -1, 0.3, 1), angle));
        CHECK(!is_crossed(&r, beside, floor_square(-2, -1, -1, 1), angle));
        /* The whole floor is crossed by the box, but not by the walls at its border. */
        CHECK(is_crossed(&r, eye, floor_square(-4, -4, 4, 4), angle));
    }
    room_free(&r);
}

static void walls_at_the_border_do_not_cross_the_floor(void) {
    room r;
    room_start(&r);
    room_box(&r, (double[]){ -1, -1, 0 }, (double[]){ 1, 1, 2 }, true, room_material(&r, 0.5, 0), 1, 1);
    room_finish(&r);
    for (double angle = 0; angle < 6; angle += 0.45)
        CHECK(!is_crossed(&r, (double[]){ 0, 0, 1e-5 }, floor_square(-1, -1, 1, 1), angle));
    room_free(&r);
}

int main(void) {
    RUN(the_frame_is_orthonormal_and_right_handed_for_every_normal);
    RUN(the_angle_turns_the_frame_about_the_normal);
    RUN(in_a_closed_box_all_light_reaches_fronts);
    RUN(backs_count_as_backs);
    RUN(a_sheet_with_a_twin_has_no_back);
    RUN(the_closure_of_a_square_overhead_tends_to_its_closed_form);
    RUN(turning_the_frame_changes_the_closure_by_aliasing_only);
    RUN(every_pixel_names_the_triangle_that_its_ray_meets);
    RUN(nothing_to_see_is_sky);
    RUN(the_nearer_surface_hides_the_farther_one);
    RUN(what_an_occluder_covers_is_not_seen_to_far_less_than_a_pixel);
    RUN(shadows_on_the_sides_of_the_cube_are_as_exact);
    RUN(what_is_below_the_horizon_is_not_seen);
    RUN(every_sample_of_a_closed_convex_room_is_seen);
    RUN(a_box_on_a_floor_crosses_the_piece_it_stands_on_and_no_other);
    RUN(walls_at_the_border_do_not_cross_the_floor);
    return check_end();
}
