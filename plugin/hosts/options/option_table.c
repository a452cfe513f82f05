/* SPDX-License-Identifier: MIT
 * See option_table.h. The list itself is option_list.h.
 */
#include "option_table.h"

#include <stdio.h>

/* As option_list.h writes them. */
enum {
    BAKE = COMMAND_BAKE,
    COMPARE = COMMAND_COMPARE,
    RENDER = COMMAND_RENDER,
    FACTORS = COMMAND_FACTORS,
    INSPECT = COMMAND_INSPECT,
    VIEW = COMMAND_VIEW
};
enum {
    FILES = MARK_FILES,
    SCENES = MARK_SCENES,
    DOCUMENTS = MARK_DOCUMENTS,
    STAMPED = MARK_STAMPED,
    ZERO_IS_OFF = MARK_ZERO_IS_OFF
};

#define FIELD(field) (((options *)0)->field)

/* int, unsigned, long and unsigned long are 32 and 64 bits wide wherever hemibake is built. */
#define STORE(field)                                                                                                   \
    _Generic(FIELD(field), bool                                                                                        \
             : STORE_BOOL, int                                                                                         \
             : STORE_INT32, unsigned                                                                                   \
             : STORE_UINT32, long                                                                                      \
             : STORE_INT64, unsigned long                                                                              \
             : STORE_UINT64, double                                                                                    \
             : STORE_DOUBLE, default                                                                                   \
             : STORE_OTHER)

const option OPTIONS[OPTION_COUNT] = {
#define OPTION(name, argument, kind, field, low, high, commands, marks, help)                                          \
    { name, argument, KIND_##kind, offsetof(options, field), STORE(field), low, high, commands, marks, help },
#include "option_list.h"
#undef OPTION
};

_Static_assert(sizeof(int) == 4 && sizeof(long) == 8, "STORE knows how wide fields are");

const char *option_kind_name(option_kind kind) {
    static const char *const names[] = {
        [KIND_FLAG] = "flag",      [KIND_OFF] = "flag",          [KIND_TEXT] = "text",   [KIND_NUMBER] = "number",
        [KIND_SECONDS] = "number", [KIND_COUNT] = "count",       [KIND_LEVEL] = "level", [KIND_MEBIBYTES] = "count",
        [KIND_CHOICE] = "choice",  [KIND_EXPOSURE] = "exposure", [KIND_BITS] = "bits",   [KIND_SUN] = "sun",
        [KIND_SKY] = "sky",        [KIND_SIZE] = "size",         [KIND_POINT] = "point",
    };
    return names[kind];
}

void option_fault(const option *o, const char *text, char *message, size_t message_size) {
    char range[64] = "";
    if (o->high > o->low) snprintf(range, sizeof range, ", %g to %g", o->low, o->high);
    snprintf(message, message_size, "%s: '%s' is not what it takes (%s%s)", o->name, text, o->argument, range);
}
