/* SPDX-License-Identifier: MIT
 * Is area dark where no light gets to, and lit where it does, however small the way is? Boxes of known area in and
 * beside each other; the triangles that rays meet first are those of a search through all.
 */
#include "check.h"

#include "base/splitmix.h"
#include "light/lit_area.h"

#include <math.h>

enum { MOST = 400 };

typedef struct boxes {
    uint32_t mesh_of[MOST];
    punctual lamp;
    lights lights;
    lit_area_setup setup; /* whose triangles are put together here */
} boxes;

enum { PLAIN, DOUBLE_SIDED, EMITTING, PASSING };

static const lit_mesh MESHES[] = {
    [DOUBLE_SIDED] = { .double_sided = true }, [EMITTING] = { .emits = true }, [PASSING] = { .passes = true }
};

static void start(boxes *b) {
    *b = (boxes){ .lights.punctual = &b->lamp, .setup = { .mesh_of = b->mesh_of, .meshes = MESHES } };
    b->setup.lights = &b->lights;
    CHECK(triangle_bvh_allocate(NULL, MOST, &b->setup.triangles));
    b->setup.triangles.count = 0;
}

/* Square to `axis` at x, out to the sides; its front looks along the axis where `ahead` is set. */
static size_t add_sheet(boxes *b, int axis, double x, const double low[3], const double high[3], bool ahead) {
    size_t first = b->setup.triangles.count;
    for (size_t t = 0; t < 2; t++)
        for (size_t i = 0; i < 3; i++) {
            double *p = b->setup.triangles.corners[first + t][ahead ? i : 2 - i];
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            size_t corner = t ? i + 1 : (i == 2 ? 3 : i);
            p[axis] = x;
            p[u] = corner == 1 || corner == 2 ? high[u] : low[u];
            p[v] = corner >= 2 ? high[v] : low[v];
        }
    b->setup.triangles.count += 2;
    return first;
}

static void add_box(boxes *b, double low, double high, bool inward) {
    const double l[3] = { low, low, low }, h[3] = { high, high, high };
    for (int axis = 0; axis < 3; axis++) {
        add_sheet(b, axis, low, l, h, inward);
        add_sheet(b, axis, high, l, h, !inward);
    }
}

static void add_lamp(boxes *b, double at) {
    b->lamp = (punctual){ .kind = PUNCTUAL_POINT, .intensity = { 1, 1, 1 }, .position = { at, at, at } };
    b->lights.punctual_count = 1;
}

/* As a share of all, and frees. */
static double lit_share(boxes *b) {
    CHECK(triangle_bvh_build(NULL, NULL, &b->setup.triangles));
    double area = lit_area(&b->setup), all = triangle_bvh_area(&b->setup.triangles);
    CHECK(lit_area(&b->setup) == area);
    triangle_bvh_free(&b->setup.triangles);
    return area / all;
}

static void two_skins_of_a_room_are_half_lit(void) {
    boxes b;
    start(&b);
    add_box(&b, -1, 1, true);
    add_box(&b, -1, 1, false);
    add_lamp(&b, 0.5);
    CHECK_NEAR(lit_share(&b), 0.5, 0.01);
}

static void under_a_sky_the_other_skin_is_lit(void) {
    boxes b;
    start(&b);
    add_box(&b, -1, 1, true);
    add_box(&b, -1, 1, false);
    b.lights.sky_is_given = true;
    CHECK_NEAR(lit_share(&b), 0.5, 0.01);
    start(&b);
    add_box(&b, -1, 1, true);
    add_box(&b, -1, 1, false);
    add_lamp(&b, 0.5);
    b.lights.sky_is_given = true;
    CHECK_NEAR(lit_share(&b), 1.0, 1e-9);
}

/* A chest in a room: outer sides are lit, inner ones are not, though both are one double-sided sheet; a second chest of
 * single sheets, within the first, has only dark. */
static void the_inside_of_a_chest_is_dark(void) {
    boxes b;
    start(&b);
    add_box(&b, -2, 2, true);
    add_box(&b, -1, 1, false);
    add_box(&b, -0.9, 0.9, true);
    add_lamp(&b, 1.5);
    const double room = 96, outer = 24, inner = 6 * 1.8 * 1.8;
    CHECK_NEAR(lit_share(&b), (room + outer) / (room + outer + inner), 0.01);
}

static void a_room_with_a_small_window_is_lit(void) {
    boxes b;
    start(&b);
    const double low[3] = { -1, -1, -1 }, high[3] = { 1, 1, 1 };
    for (int axis = 0; axis < 3; axis++) {
        if (axis) add_sheet(&b, axis, -1, low, high, true);
        add_sheet(&b, axis, 1, low, high, false);
    }
    /* 0.2 x 0.2 m in a wall of 2 x 2. */
    add_sheet(&b, 0, -1, low, (double[3]){ 0, -0.1, 1 }, true);
    add_sheet(&b, 0, -1, (double[3]){ 0, 0.1, -1 }, high, true);
    add_sheet(&b, 0, -1, (double[3]){ 0, -0.1, -1 }, (double[3]){ 0, 0.1, -0.1 }, true);
    add_sheet(&b, 0, -1, (double[3]){ 0, -0.1, 0.1 }, (double[3]){ 0, 0.1, 1 }, true);
    b.lights.sky_is_given = true;
    CHECK_NEAR(lit_share(&b), 1.0, 1e-9);
}

/* A lamp of a hundredth of the area, behind a closed pane; and the same behind a wall. */
static void a_small_emitter_lights_its_room_through_what_lets_light_through(void) {
    for (int pane = 0; pane < 2; pane++) {
        boxes b;
        start(&b);
        add_box(&b, -1, 1, true);
        size_t first = b.setup.triangles.count;
        add_box(&b, -0.2, 0.2, false);
        for (size_t i = first; i < b.setup.triangles.count; i++) b.mesh_of[i] = pane ? PASSING : PLAIN;
        first = b.setup.triangles.count;
        add_box(&b, -0.1, 0.1, false);
        for (size_t i = first; i < b.setup.triangles.count; i++) b.mesh_of[i] = EMITTING;
        double share = lit_share(&b);
        if (pane)
            CHECK_NEAR(share, 1.0, 1e-9);
        else
            CHECK_NEAR(share, 1.0 / 16, 1e-9); /* the least there is */
    }
}

/* A rug 0.1 mm above a floor of 4 m: what is between them is dark. */
static void what_lies_under_a_rug_is_dark(void) {
    boxes b;
    start(&b);
    add_box(&b, -2, 2, true);
    const double low[3] = { -1.5, 0, -1.5 }, high[3] = { 1.5, 0, 1.5 };
    double floor = -2, rug = floor + 1e-4;
    size_t first = add_sheet(&b, 1, rug, low, high, true);
    b.mesh_of[first] = b.mesh_of[first + 1] = DOUBLE_SIDED;
    add_lamp(&b, 0.5);
    CHECK_NEAR(lit_share(&b), 1 - 9.0 / 105, 0.01);
}

/* A lamp of a millionth of the area, forty times as far off as the box is wide, in nothing: half of the box and of the
 * lamp's sides are ahead of it. */
static void a_small_emitter_far_away_lights_what_is_ahead_of_it(void) {
    boxes b;
    start(&b);
    add_box(&b, -1, 1, false);
    const double low[3] = { 24, 32, -1e-3 }, high[3] = { 24, 32.002, 1e-3 };
    size_t first = add_sheet(&b, 0, 24, low, high, false);
    b.mesh_of[first] = b.mesh_of[first + 1] = EMITTING;
    CHECK_NEAR(lit_share(&b), 1.0 / 3, 0.01); /* two of six sides; lights on none of the others falls */
}

static void no_light_found_is_no_reason_for_fine_elements(void) {
    boxes b;
    start(&b);
    add_box(&b, -1, 1, true);
    CHECK_NEAR(lit_share(&b), 1.0, 1e-9);
}

/* ---- rays ---- */

static void the_first_of_many_triangles_is_met(void) {
    triangle_bvh t;
    bool passes[200] = { false };
    CHECK(triangle_bvh_allocate(NULL, 200, &t));
    for (size_t i = 0; i < 1800; i++)
        t.corners[i / 9][i / 3 % 3][i % 3] =
            2 * splitmix_unit(i / 9 * 3 + i % 3) + 0.4 * splitmix_unit(10000 + i); /* of a fifth of the cube */
    CHECK(triangle_bvh_build(NULL, NULL, &t));
    for (size_t i = 0; i < 200; i += 3) passes[i] = true;
    int met_count = 0;
    for (uint64_t q = 0; q < 500; q++) {
        double from[3], to[3];
        for (uint64_t k = 0; k < 3; k++)
            from[k] = 3 * splitmix_unit(20000 + 6 * q + k) - 0.5, to[k] = 3 * splitmix_unit(20003 + 6 * q + k) - 0.5;
        bool fronts = q % 2;
        triangle_meeting all, one, nearest = { .share = 2.0 };
        for (size_t i = 0; i < 200; i++) { /* one by one, the rest let pass */
            bool others[200];
            for (size_t j = 0; j < 200; j++) others[j] = j != i || passes[i];
            if (triangle_bvh_meet(&t, from, to, fronts, others, &one) && one.share < nearest.share) nearest = one;
        }
        bool met = triangle_bvh_meet(&t, from, to, fronts, passes, &all);
        CHECK(met == (nearest.share <= 1.0));
        CHECK(!met || (all.triangle == nearest.triangle && all.share == nearest.share && (!fronts || all.is_front)));
        if (!fronts) CHECK(triangle_bvh_blocks(&t, from, to, passes) == met);
        met_count += met;
    }
    CHECK(met_count > 50 && met_count < 450);
    triangle_bvh_free(&t);
}

int main(void) {
    RUN(two_skins_of_a_room_are_half_lit);
    RUN(under_a_sky_the_other_skin_is_lit);
    RUN(the_inside_of_a_chest_is_dark);
    RUN(a_room_with_a_small_window_is_lit);
    RUN(a_small_emitter_lights_its_room_through_what_lets_light_through);
    RUN(what_lies_under_a_rug_is_dark);
    RUN(a_small_emitter_far_away_lights_what_is_ahead_of_it);
    RUN(no_light_found_is_no_reason_for_fine_elements);
    RUN(the_first_of_many_triangles_is_met);
    return check_end();
}
