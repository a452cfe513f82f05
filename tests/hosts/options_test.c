/* SPDX-License-Identifier: MIT
 * Do the texts of options become what hemi_bake takes: 0 where nothing was said, below 0 where something is off?
 */
#include "check.h"

#include "option_table.h"

static const option *named(const char *name) {
    for (int i = 0; i < OPTION_COUNT; i++)
        if (strcmp(OPTIONS[i].name, name) == 0) return &OPTIONS[i];
    return NULL;
}

static bool set(const char *name, const char *text, options *out) {
    const option *o = named(name);
    CHECK(o != NULL);
    return o && option_set(o, text, out);
}

static void what_is_not_given_is_left_to_the_library(void) {
    options o;
    const hemi_bake_desc defaults = { .struct_size = sizeof defaults };
    options_clear(&o);
    CHECK(memcmp(&o.bake, &defaults, sizeof defaults) == 0);
    CHECK_EQUAL(o.threads, 0);
}

static void no_name_and_no_help_stands_twice(void) {
    for (int i = 0; i < OPTION_COUNT; i++)
        for (int k = 0; k < i; k++) {
            CHECK(strcmp(OPTIONS[i].name, OPTIONS[k].name) != 0);
            CHECK(strcmp(OPTIONS[i].help, OPTIONS[k].help) != 0);
        }
}

/* 0 is in the range of what it turns off, and nowhere else does it mean more than itself. */
static void nothing_of_it_is_off(void) {
    int count = 0;
    for (int i = 0; i < OPTION_COUNT; i++) {
        options o;
        if (!(OPTIONS[i].marks & MARK_ZERO_IS_OFF)) continue;
        options_clear(&o);
        CHECK(option_set(&OPTIONS[i], "0", &o));
        const void *field = (const char *)&o + OPTIONS[i].offset;
        CHECK(OPTIONS[i].store == STORE_DOUBLE ? *(const double *)field < 0.0 : *(const int32_t *)field < 0);
        count++;
    }
    CHECK_EQUAL(count, 5);
}

static void values_reach_the_desc_in_its_units(void) {
    options o;
    options_clear(&o);
    CHECK(set("--element-size", "0.25", &o) && set("--memory", "3", &o) && set("--seed", "9000000000000000", &o));
    CHECK(set("--quality", "high", &o) && set("--method", "fm", &o) && set("--refine-levels", "2", &o));
    CHECK_NEAR(o.bake.element_size, 0.25, 0);
    CHECK_EQUAL(o.bake.memory_limit, 3 << 20);
    CHECK(o.bake.seed == UINT64_C(9000000000000000));
    CHECK_EQUAL(o.bake.quality, HEMI_QUALITY_HIGH);
    CHECK_EQUAL(o.bake.method, HEMI_METHOD_FM);
    CHECK_EQUAL(o.bake.adapt_levels, 2);
    CHECK(set("--uniform", "", &o));
    CHECK(o.bake.adapt_levels < 0);
    CHECK(named("--uniform") > named("--refine-levels")); /* set later, it wins */
}

static void what_an_option_does_not_take_is_refused_by_its_range(void) {
    static const char *const bad[][2] = {
        { "--element-size", "0" },
        { "--element-size", "nan" },
        { "--element-size", "1e-400" },
        { "--element-size", "1m" },
        { "--hemicube", "64.5" },
        { "--hemicube", "" },
        { "--quality", "high|draft" },
        { "--quality", "" },
        { "--size", "5" },
        { "--size", "0x5" },
        { "--exposure", "65" },
        { "--sun", "1,2" },
        { "--sun", "1,2,3,4,5" },
        { "--draco-bits", "position" },
        { "--draco-bits", "position=31" },
        { "--ocio", "" },
    };
    char message[128];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        options o;
        options_clear(&o);
        CHECK(!set(bad[i][0], bad[i][1], &o));
    }
    option_fault(named("--size"), "5", message, sizeof message);
    CHECK_TEXT(message, "--size: '5' is not what it takes (WxH, 1 to 8192)");
}

int main(void) {
    RUN(what_is_not_given_is_left_to_the_library);
    RUN(no_name_and_no_help_stands_twice);
    RUN(nothing_of_it_is_off);
    RUN(values_reach_the_desc_in_its_units);
    RUN(what_an_option_does_not_take_is_refused_by_its_range);
    return check_end();
}
