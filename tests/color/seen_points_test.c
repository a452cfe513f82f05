/* SPDX-License-Identifier: MIT
 * Are those points seen that eyes outside, inside or in a camera see, and no others? */
#include "check.h"
#include "seen_points.h"

#include <stdlib.h>

static const uint32_t OUTWARD[36] = { 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                      2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6 };
static const float LIT[24] = { 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 };
static const float DARK[24] = { 0 };

typedef struct box {
    float positions[24];
    uint32_t indices[36];
    seen_mesh mesh;
} box;

static void make_box(box *b, double half, bool inward, const float *radiance) {
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++) b->positions[3 * v + k] = (float)(v >> k & 1 ? half : -half);
    for (int i = 0; i < 36; i++) b->indices[i] = OUTWARD[inward && i % 3 ? i / 3 * 3 + 3 - i % 3 : i];
    b->mesh =
        (seen_mesh){ .positions = b->positions, .radiance = radiance, .indices = b->indices, .triangle_count = 12 };
}

/* Share of the points that were seen from there. */
static double share(const seen_points *seen, seen_from from) {
    size_t found = 0;
    for (size_t i = 0; i < seen->count; i++) found += seen->points[i].from == from;
    return seen->count ? (double)found / (double)seen->count : 0.0;
}

static void a_solid_is_seen_from_outside_alone(void) {
    box b;
    seen_points seen;
    make_box(&b, 1.0, false, LIT);
    CHECK(seen_points_find(&b.mesh, 1, NULL, 0, 1, &seen));
    CHECK(seen.count > 4096);
    CHECK_NEAR(share(&seen, SEEN_FROM_INSIDE), 0.0, 0.0);
    free(seen.points);
}

/* A lit room within a shell: the shell's outside from outside, the room from inside, by the length of the view. */
static void a_lit_room_is_seen_from_inside_and_a_dark_one_is_not(void) {
    for (int lit = 0; lit < 2; lit++) {
        box inner, outer;
        seen_points seen;
        make_box(&inner, 1.0, true, lit ? LIT : DARK);
        make_box(&outer, 1.1, false, LIT);
        const seen_mesh meshes[2] = { inner.mesh, outer.mesh };
        CHECK(seen_points_find(meshes, 2, NULL, 0, 1, &seen));
        CHECK(lit ? share(&seen, SEEN_FROM_INSIDE) > 0.2 : share(&seen, SEEN_FROM_INSIDE) == 0.0);
        CHECK(share(&seen, SEEN_FROM_OUTSIDE) > 0.2);
        free(seen.points);
    }
}

/* Two sheets that face each other, a hundredth of their width apart: what lies between has hardly any weight. */
static void a_gap_has_little_weight(void) {
    const float sheets[24] = { -1, 0,     -1, -1, 0,     1,  1, 0,     1, 1,  0,     -1,
                               -1, 0.02f, -1, 1,  0.02f, -1, 1, 0.02f, 1, -1, 0.02f, 1 };
    const uint32_t indices[12] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7 };
    const seen_mesh mesh = { .positions = sheets, .radiance = LIT, .indices = indices, .triangle_count = 4 };
    seen_points seen;
    double inside = 0.0;
    CHECK(seen_points_find(&mesh, 1, NULL, 0, 1, &seen));
    for (size_t i = 0; i < seen.count; i++)
        inside += seen.points[i].from == SEEN_FROM_INSIDE ? seen.points[i].weight : 0.0;
    printf("4096 rays in the gap weigh %.3g\n", inside);
    CHECK(inside > 0.0 && inside < 0.1 * 4096);
    free(seen.points);
}

static void a_camera_is_asked_alone_where_it_sees_light(void) {
    for (int lit = 0; lit < 2; lit++) {
        box b;
        seen_points seen;
        const seen_camera camera = {
            .eye = { 0, 0, 5 }, .target = { 0, 0, 0 }, .up = { 0, 1, 0 }, .yfov = 1.0, .aspect = 1.0
        };
        make_box(&b, 1.0, false, lit ? LIT : DARK);
        CHECK(seen_points_find(&b.mesh, 1, &camera, 1, 1, &seen));
        CHECK_NEAR(share(&seen, SEEN_FROM_CAMERA), lit ? 1.0 : 0.0, 0.0);
        CHECK(seen.cameras_are_dark == !lit);
        free(seen.points);
    }
}

/* Into a room through the back of its wall, which is four times as bright as the wall opposite. */
static void backs_are_seen_through(void) {
    box b;
    seen_points seen;
    float radiance[24];
    const seen_camera camera = {
        .eye = { 0, 0, 5 }, .target = { 0, 0, 0 }, .up = { 0, 1, 0 }, .yfov = 0.1, .aspect = 1.0
    };
    for (int i = 0; i < 24; i++) radiance[i] = i / 3 >> 2 & 1 ? 4.0f : 1.0f;
    make_box(&b, 1.0, true, radiance);
    CHECK(seen_points_find(&b.mesh, 1, &camera, 1, 1, &seen));
    CHECK(seen.count > 0);
    for (size_t i = 0; i < seen.count; i++) CHECK_NEAR(seen.points[i].radiance[0], 1.0, 1e-6);
    free(seen.points);
}

/* Where a material that emits 10 shows 1, it is its texture's dark part that is seen. */
static void the_dark_part_of_a_texture_that_emits_is_no_lamp(void) {
    box b;
    seen_points seen;
    for (int strength = 1; strength <= 10; strength += 9) {
        make_box(&b, 1.0, false, LIT);
        for (int c = 0; c < 3; c++) b.mesh.emission[c] = strength;
        CHECK(seen_points_find(&b.mesh, 1, NULL, 0, 1, &seen));
        CHECK(seen.count > 0 && seen.points[0].emits == (strength == 1));
        free(seen.points);
    }
}

int main(void) {
    RUN(a_solid_is_seen_from_outside_alone);
    RUN(a_lit_room_is_seen_from_inside_and_a_dark_one_is_not);
    RUN(a_gap_has_little_weight);
    RUN(a_camera_is_asked_alone_where_it_sees_light);
    RUN(backs_are_seen_through);
    RUN(the_dark_part_of_a_texture_that_emits_is_no_lamp);
    return check_end();
}
