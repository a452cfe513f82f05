/* SPDX-License-Identifier: MIT
 * Are triangles merged as they once were, where other light allows it, and only there?
 */
#include "sheets.h"

/* A wall and one round its edge, merged by light f in the way that a record says. */
static decimate_result merge_walls(sheets *s, field f, decimate_record *record) {
    *s = (sheets){ 0 };
    add_sheet(s, 24, 24, O, X, Y), add_sheet(s, 24, 24, X, Z, Y);
    fill(s, f);
    return merge_by(s, 2, NULL, record);
}

static void what_went_once_goes_again_by_the_same_light(void) {
    arena memory = { 0 };
    decimate_record record = { .memory = &memory };
    sheets first, again;
    merge_walls(&first, penumbra, &record);
    /* Every vertex that is gone went somewhere; of borders two go as one. */
    CHECK(record.count > 300);
    record.is_given = true;
    merge_walls(&again, penumbra, &record);
    CHECK_EQUAL(again.triangles.count, first.triangles.count);
    CHECK(!memcmp(again.triangles.corners, first.triangles.corners, 3 * first.triangles.count * sizeof(uint32_t)));
    free_sheets(&first), free_sheets(&again);
    arena_free(&memory);
}

/* Where the first light was even all vertices went; the other's penumbra keeps those that it needs, and where it is
 * even as few stay as without a record. */
static void by_another_light_only_what_it_allows(void) {
    arena memory = { 0 };
    decimate_record record = { .memory = &memory };
    sheets first, plain, again;
    merge_walls(&first, even, &record);
    record.is_given = true;
    merge_walls(&plain, penumbra, NULL);
    decimate_result r = merge_walls(&again, penumbra, &record);
    printf("%u triangles, %u without a record\n", again.triangles.count, plain.triangles.count);
    CHECK(r.error <= 1.0);
    CHECK(again.triangles.count <= 1.3 * plain.triangles.count);
    check_shapes(&again, 0.1, 2.0);
    CHECK_EQUAL(lone_edges(&again, &(int){ 0 }), 0);
    free_sheets(&first), free_sheets(&plain), free_sheets(&again);
    arena_free(&memory);
}

static void a_record_that_lies_is_only_another_order(void) {
    uint32_t pairs[2000], state = 7;
    for (size_t i = 0; i < 2000; i++) {
        state = state * 1664525u + 1013904223u;
        pairs[i] = i % 50 == 0 ? UINT32_MAX - (uint32_t)i % 2 : (state >> 8) % 1300;
    }
    for (size_t i = 100; i < 200; i++) pairs[i] = pairs[i - 100]; /* once more what may be gone */
    decimate_record record = { .pairs = pairs, .count = 1000, .is_given = true };
    sheets s;
    decimate_result r = merge_walls(&s, penumbra, &record);
    CHECK(r.error <= 1.0);
    check_shapes(&s, 0.1, 2.0);
    CHECK_EQUAL(lone_edges(&s, &(int){ 0 }), 0);
    free_sheets(&s);
}

int main(void) {
    RUN(what_went_once_goes_again_by_the_same_light);
    RUN(by_another_light_only_what_it_allows);
    RUN(a_record_that_lies_is_only_another_order);
    return check_end();
}
