/* SPDX-License-Identifier: MIT
 * Are results that are kept found again, each where it belongs, and is nothing taken that is no result?
 */
#include "base/kept_results.h"
#include "check.h"
#include "formfactor/column_kept.h"
#include "room.h"

#include <math.h>
#include <string.h>

/* One result: what is under test asks for one at a time. */
typedef struct shelf {
    uint64_t key[2], size;
    unsigned char bytes[1 << 20];
    int asked;
} shelf;

static uint64_t find(void *user, const uint64_t key[2], void *bytes, uint64_t most) {
    shelf *s = user;
    s->asked++;
    if (s->size == 0 || memcmp(key, s->key, sizeof s->key) != 0) return 0;
    if (most >= s->size) memcpy(bytes, s->bytes, (size_t)s->size);
    return s->size;
}

static void add(void *user, const uint64_t key[2], const void *bytes, uint64_t size) {
    shelf *s = user;
    CHECK(size <= sizeof s->bytes);
    memcpy(s->key, key, sizeof s->key);
    memcpy(s->bytes, bytes, (size_t)size);
    s->size = size;
}

static shelf kept_shelf;

static void what_is_given_is_taken_by_the_same_pass_and_item_alone(void) {
    int a = 5, b = 6, x = 0, y = 0;
    const kept_part given[] = { { &a, sizeof a }, { &b, sizeof b } }, taken[] = { { &x, sizeof x }, { &y, sizeof y } };
    kept_shelf = (shelf){ .size = 0 };
    kept_results in = { .find = find, .add = add, .user = &kept_shelf };
    kept_pass first = kept_pass_begin(&in, NULL), second = kept_pass_begin(&in, NULL);
    kept_give(&first, 7, given, 2);
    CHECK(!kept_take(&first, 8, taken, 2));
    CHECK(!kept_take(&second, 7, taken, 2));
    CHECK(!kept_take(&first, 7, taken, 1)); /* another size */
    CHECK_EQUAL(x, 0);
    CHECK(kept_take(&first, 7, taken, 2));
    CHECK_EQUAL(x, 5);
    CHECK_EQUAL(y, 6);
}

static void numbers_that_light_cannot_be_are_not_taken(void) {
    double light[2] = { 1.0, 2.0 }, differences[2] = { -1.0, 0.5 }, x[2], y[2] = { 9.0, 9.0 };
    const kept_part given[] = { { light, sizeof light }, { differences, sizeof differences } };
    const kept_part taken[] = { { x, sizeof x }, { y, sizeof y } };
    const double bad[] = { NAN, INFINITY, -INFINITY, 1e40, -1e40 };
    kept_shelf = (shelf){ .size = 0 };
    kept_results in = { .find = find, .add = add, .user = &kept_shelf };
    kept_pass pass = kept_pass_begin(&in, NULL);
    kept_give(&pass, 0, given, 2);
    CHECK(kept_take_numbers(&pass, 0, taken, 2, 1));
    CHECK_EQUAL(y[0], -1.0);
    CHECK(!kept_take_numbers(&pass, 0, taken, 2, 2)); /* a difference is below 0 */
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (int k = 0; k < 2; k++) {
            double *changed = k ? &differences[0] : &light[1], before = *changed;
            *changed = bad[i];
            kept_give(&pass, 0, given, 2);
            *changed = before;
            y[0] = 9.0;
            CHECK(!kept_take_numbers(&pass, 0, taken, 2, 1));
            CHECK_EQUAL(y[0], 9.0); /* nothing of it */
        }
}

static void nobody_keeps_anything_and_whoever_is_stopped_neither(void) {
    volatile int stop = 1;
    int a = 5;
    const kept_part part = { &a, sizeof a };
    kept_shelf = (shelf){ .size = 0 };
    kept_results in = { .find = find, .add = add, .user = &kept_shelf, .stop = &stop };
    kept_pass stopped = kept_pass_begin(&in, NULL), none = kept_pass_begin(NULL, NULL);
    kept_give(&stopped, 0, &part, 1);
    kept_give(&none, 0, &part, 1);
    CHECK_EQUAL(kept_shelf.size, 0);
    CHECK(!kept_take(&none, 0, &part, 1));
    CHECK_EQUAL(kept_shelf.asked, 0);
}

/* ---- columns ---- */

static const double LOW[3] = { -1, -1, 0 }, HIGH[3] = { 1, 1.5, 2 };

static bool is_same(const column *a, const column *b) {
    return a->run_count == b->run_count && a->factor_count == b->factor_count && a->path_count == b->path_count &&
           a->packed_count == b->packed_count && memcmp(a->runs, b->runs, a->run_count * sizeof *a->runs) == 0 &&
           memcmp(a->factors, b->factors, a->factor_count * sizeof *a->factors) == 0 &&
           memcmp(a->paths, b->paths, a->path_count * sizeof *a->paths) == 0 &&
           memcmp(a->packed, b->packed, 2 * a->packed_count * sizeof *a->packed) == 0 && a->scale == b->scale &&
           a->total == b->total && a->largest == b->largest && a->hemicubes == b->hemicubes && a->split == b->split &&
           a->crossed == b->crossed && a->evaluations == b->evaluations && a->closure.front == b->closure.front;
}

/* Every bit of what is kept turned: none but the numbers of the light may be taken, and nothing falls over. */
static void turn_bits(kept_pass *pass, const column_setup *setup, const subpatch *from) {
    int refused = 0, taken = 0;
    for (uint64_t at = 0; at < kept_shelf.size; at += at < 256 ? 1 : 61) {
        kept_shelf.bytes[at] ^= 0x80;
        column *c = column_kept_take(pass, setup, from);
        for (size_t i = 0; c && i < c->run_count; i++) CHECK(c->runs[i].patch < setup->mesh->patch_count);
        for (size_t i = 0; c && i < c->factor_count; i++) CHECK(c->factors[i] >= 0.0f);
        c ? taken++ : refused++;
        column_destroy(c);
        kept_shelf.bytes[at] ^= 0x80;
    }
    CHECK(refused > 64);
    CHECK(taken > 0);
}

static void a_column_is_taken_as_it_was_and_none_that_is_no_column(void) {
    room r;
    room_start(&r);
    room_box(&r, LOW, HIGH, true, room_material(&r, 0.5, 0), 2, 2);
    room_finish(&r);
    column_setup setup = room_columns(&r, 32, 0);
    setup.keep_cubes = true;
    char message[128] = "";
    column_worker *w = column_worker_create(&setup, message, sizeof message);
    column *made = w ? room_column(&setup, w, 3) : NULL;
    const subpatch from = subpatch_of_patch(setup.scene, setup.mesh, 3);
    kept_shelf = (shelf){ .size = 0 };
    kept_results in = { .find = find, .add = add, .user = &kept_shelf };
    kept_pass pass = kept_pass_begin(&in, NULL);
    CHECK(made != NULL && made->packed_count > 0 && made->run_count > 0);
    if (made) column_kept_give(&pass, &from, made);
    column *taken = column_kept_take(&pass, &setup, &from);
    CHECK(made && taken && is_same(made, taken));
    turn_bits(&pass, &setup, &from);
    for (uint64_t whole = kept_shelf.size; kept_shelf.size > 0; kept_shelf.size -= kept_shelf.size > 300 ? 257 : 1)
        if (kept_shelf.size < whole) CHECK(column_kept_take(&pass, &setup, &from) == NULL);
    column_destroy(taken);
    column_destroy(made);
    column_worker_destroy(w);
    room_free(&r);
}

int main(void) {
    RUN(what_is_given_is_taken_by_the_same_pass_and_item_alone);
    RUN(numbers_that_light_cannot_be_are_not_taken);
    RUN(nobody_keeps_anything_and_whoever_is_stopped_neither);
    RUN(a_column_is_taken_as_it_was_and_none_that_is_no_column);
    return check_end();
}
