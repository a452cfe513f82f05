/* SPDX-License-Identifier: MIT
 * Are vertices in one place found, and only those?
 */
#include "check.h"

#include "base/splitmix.h"
#include "geometry/places.h"

enum { MANY = 3000, SLOTS = 8192 };

static void as_many_slots_are_asked_for_as_are_needed(void) {
    /* Half full at most, or looking would never end; a power of two, or it would miss some. */
    for (size_t count = 0; count < 2 * MANY; count++) {
        size_t slots = places_slot_count(count);
        CHECK(slots >= 2 * count && slots > count && (slots & (slots - 1)) == 0);
    }
    CHECK_EQUAL(places_slot_count(MANY), SLOTS);
}

static void places_are_numbered_as_they_first_come(void) {
    const float positions[] = { 1, 2, 3, 1, 2, 4, 1, 2, 3, 3, 2, 1, 1, 2, 4 };
    const uint32_t expected[] = { 0, 1, 0, 2, 1 };
    uint32_t slots[16], place[5];
    CHECK_EQUAL(places_find_floats(positions, 5, slots, place), 3);
    for (int i = 0; i < 5; i++) CHECK_EQUAL(place[i], expected[i]);
}

static void minus_zero_is_zero_and_one_bit_is_another_place(void) {
    const double positions[] = { 0.0, 1.0, -0.0, -0.0, 1.0, 0.0, 0.0, nextafter(1.0, 2.0), 0.0, 0x1p-1074, 1.0, 0.0 };
    uint32_t slots[8], place[4];
    CHECK_EQUAL(places_find(positions, 4, slots, place), 3);
    CHECK_EQUAL(place[1], place[0]);
    CHECK_EQUAL(place[2], 1);
    CHECK_EQUAL(place[3], 2);
}

/* Against comparison of all pairs, on a lattice so coarse that most points are met several times. */
static void a_plain_search_finds_the_same(void) {
    static double positions[3 * MANY];
    static float floats[3 * MANY];
    static uint32_t slots[SLOTS], place[MANY], of_floats[MANY], expected[MANY];
    uint32_t count = 0;
    for (size_t i = 0; i < 3 * (size_t)MANY; i++) {
        positions[i] = floor(10.0 * splitmix_unit(i)) - 5.0;
        floats[i] = (float)positions[i];
    }
    for (size_t v = 0; v < MANY; v++) {
        size_t w = 0;
        while (positions[3 * w] != positions[3 * v] || positions[3 * w + 1] != positions[3 * v + 1] ||
               positions[3 * w + 2] != positions[3 * v + 2])
            w++;
        expected[v] = w < v ? expected[w] : count++;
    }
    CHECK_EQUAL(places_find(positions, MANY, slots, place), count);
    CHECK_EQUAL(places_find_floats(floats, MANY, slots, of_floats), count);
    CHECK(memcmp(place, expected, sizeof place) == 0);
    CHECK(memcmp(of_floats, expected, sizeof of_floats) == 0);
}

static void no_vertices_are_in_no_place(void) {
    uint32_t slots[2];
    CHECK_EQUAL(places_find(NULL, 0, slots, NULL), 0);
    CHECK_EQUAL(places_find_floats(NULL, 0, slots, NULL), 0);
}

int main(void) {
    RUN(as_many_slots_are_asked_for_as_are_needed);
    RUN(places_are_numbered_as_they_first_come);
    RUN(minus_zero_is_zero_and_one_bit_is_another_place);
    RUN(a_plain_search_finds_the_same);
    RUN(no_vertices_are_in_no_place);
    return check_end();
}
