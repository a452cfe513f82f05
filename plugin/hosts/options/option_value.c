/* SPDX-License-Identifier: MIT
 * What does the text of an option's value mean? See option_table.h.
 */
#include "option_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

/* What a number is multiplied with for the letter that may end it. */
typedef struct unit {
    char letter;
    double factor;
} unit;

static bool parse_with_unit(const char *text, double low, double high, const unit *units, double *out) {
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || errno) return false;
    for (; units->letter && *end; units++)
        if (*end == units->letter && !end[1]) value *= units->factor, end++;
    if (*end || !(value >= low && value <= high)) return false;
    *out = value;
    return true;
}

static bool parse_number(const char *text, double low, double high, double *out) {
    return parse_with_unit(text, low, high, (const unit[]){ { 0, 0 } }, out);
}

static bool parse_count(const char *text, double low, double high, double *out) {
    return parse_number(text, low, high, out) && *out == floor(*out);
}

static bool store(const option *o, double value, options *out) {
    void *field = (char *)out + o->offset;
    switch (o->store) {
    case STORE_BOOL:
        *(bool *)field = value != 0.0;
        return true;
    case STORE_INT32:
        *(int32_t *)field = (int32_t)value;
        return true;
    case STORE_UINT32:
        *(uint32_t *)field = (uint32_t)value;
        return true;
    case STORE_INT64:
        *(int64_t *)field = (int64_t)value;
        return true;
    case STORE_UINT64:
        *(uint64_t *)field = (uint64_t)value;
        return true;
    case STORE_DOUBLE:
        *(double *)field = value;
        return true;
    case STORE_OTHER:
        break;
    }
    return false;
}

/* Users say 0 for off, since that is what a number of nothing is; the library's 0 is its default. */
static bool set_number(const option *o, const char *text, options *out) {
    static const unit none[] = { { 0, 0 } }, of_share[] = { { '%', 0.01 }, { 0, 0 } };
    static const unit of_time[] = { { 's', 1 }, { 'm', 60 }, { 'h', 3600 }, { 0, 0 } };
    double value;
    bool is_number = o->kind == KIND_NUMBER || o->kind == KIND_SECONDS;
    bool is_share = o->kind == KIND_NUMBER && o->high > o->low && o->high <= 1.0;
    const unit *units = o->kind == KIND_SECONDS ? of_time : is_share ? of_share : none;
    if (!parse_with_unit(text, o->low, o->high, units, &value) || (!is_number && value != floor(value))) return false;
    if (value == 0.0 && (o->marks & MARK_ZERO_IS_OFF)) value = -1.0;
    return store(o, o->kind == KIND_MEBIBYTES ? value * (1 << 20) : value, out);
}

/* ---- others ------------------------------------------------------------------------------------------------------ */

/* The position of a word in "one|two|three", counted from 1; 0: it is none of them. */
static int position_of(const char *text, const char *words) {
    int position = 1;
    for (const char *word = words; word; position++) {
        const char *bar = strchr(word, '|');
        size_t length = bar ? (size_t)(bar - word) : strlen(word);
        if (strlen(text) == length && strncmp(text, word, length) == 0) return position;
        word = bar ? bar + 1 : NULL;
    }
    return 0;
}

/* "position=14,color=12" */
static bool parse_bits(const char *text, double low, double high, int32_t bits[4]) {
    static const char *const keys[] = { "position", "normal", "color", "texcoord" };
    char copy[128];
    if (strlen(text) >= sizeof copy) return false;
    strcpy(copy, text);
    for (char *at = copy; at;) {
        char *comma = strchr(at, ','), *equals = strchr(at, '=');
        double value;
        int key = 0;
        if (comma) *comma = 0;
        if (!equals || (comma && equals > comma)) return false;
        *equals = 0;
        while (key < 4 && strcmp(at, keys[key]) != 0) key++;
        if (key == 4 || !parse_count(equals + 1, low, high, &value)) return false;
        bits[key] = (int32_t)value;
        at = comma ? comma + 1 : NULL;
    }
    return true;
}

/* "960x720" */
static bool parse_size(const char *text, double low, double high, uint32_t size[2]) {
    char copy[32], *cross;
    double width, height;
    if (strlen(text) >= sizeof copy) return false;
    strcpy(copy, text);
    cross = strchr(copy, 'x');
    if (!cross) return false;
    *cross = 0;
    if (!parse_count(copy, low, high, &width) || !parse_count(cross + 1, low, high, &height)) return false;
    size[0] = (uint32_t)width, size[1] = (uint32_t)height;
    return true;
}

static bool parse_exposure(const char *text, double low, double high, option_exposure *out) {
    out->is_fixed = strcmp(text, "auto") != 0;
    return !out->is_fixed || parse_number(text, low, high, &out->ev);
}

static bool parse_sun(const char *text, option_sun *out) {
    double sun[4] = { 0, 0, 0, 0.533 };
    int count = 0;
    for (char *end; count < 4; text = end + 1) {
        sun[count] = strtod(text, &end);
        if (end == text || !isfinite(sun[count++])) return false;
        if (!*end) break;
        if (*end != ',' || count == 4) return false;
    }
    if (count < 3 || fabs(sun[1]) > 90.0 || sun[2] < 0.0 || sun[2] > 1e30 || sun[3] < 0.0 || sun[3] > 45.0)
        return false;
    memcpy(out->values, sun, sizeof sun);
    out->is_given = true;
    return true;
}

/* "1,2.5,-3", metres */
static bool parse_point(const char *text, option_point *out) {
    int end = 0;
    double *p = out->values;
    if (sscanf(text, "%lf,%lf,%lf%n", &p[0], &p[1], &p[2], &end) != 3 || text[end]) return false;
    out->is_given = true;
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

void options_clear(options *out) {
    *out = (options){ .bake.struct_size = sizeof out->bake,
                      .draco_level = 7,
                      .draco_bits = { 14, 10, 12, 12 },
                      .size = { 960, 720 },
                      .time_code = NAN,
                      .subdivision = HEMI_SUBDIVISION_CATMULL_CLARK };
}

static bool set_level(const option *o, const char *text, options *out) {
    return strcmp(text, "auto") == 0 ? store(o, 0.0, out) : set_number(o, text, out);
}

bool option_set(const option *o, const char *text, options *out) {
    void *field = (char *)out + o->offset;
    switch (o->kind) {
    case KIND_FLAG:
        return store(o, 1.0, out);
    case KIND_OFF:
        return store(o, -1.0, out);
    case KIND_TEXT:
    case KIND_SKY:
        *(const char **)field = text;
        return *text != 0;
    case KIND_NUMBER:
    case KIND_SECONDS:
    case KIND_COUNT:
    case KIND_MEBIBYTES:
        return set_number(o, text, out);
    case KIND_LEVEL:
        return set_level(o, text, out);
    case KIND_CHOICE:
        return position_of(text, o->argument) > 0 && store(o, position_of(text, o->argument), out);
    case KIND_EXPOSURE:
        return parse_exposure(text, o->low, o->high, field);
    case KIND_BITS:
        return parse_bits(text, o->low, o->high, field);
    case KIND_SUN:
        return parse_sun(text, field);
    case KIND_SIZE:
        return parse_size(text, o->low, o->high, field);
    case KIND_POINT:
        return parse_point(text, field);
    }
    return false;
}
