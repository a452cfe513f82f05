/* SPDX-License-Identifier: MIT */
#include "vs3_scene.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 512, VERTICES_MAX = 1 << 20, FIELDS_MAX = 12 };

typedef struct vs3_reader {
    vs3_scene *out;
    char *message;
    unsigned line;
    size_t vertex_capacity, polygon_capacity;
    bool *known; /* of vertex numbers */
    bool ended;
} vs3_reader;

static hemi_result fail(vs3_reader *r, hemi_result result, const char *what, const char *detail) {
    snprintf(r->message, VS3_MESSAGE_SIZE, "line %u: %s%s", r->line, what, detail);
    return result;
}

static bool grow(void *array, size_t capacity, size_t size) {
    void **target = array;
    void *grown = realloc(*target, capacity * size);
    if (grown) *target = grown;
    return grown != NULL;
}

static int split_fields(char *line, char *fields[FIELDS_MAX]) {
    int count = 0;
    char *rest = NULL;
    for (char *at = strtok_r(line, " \t\r\n", &rest); at && count < FIELDS_MAX; at = strtok_r(NULL, " \t\r\n", &rest))
        fields[count++] = at;
    return count;
}

static bool parse_number(const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && isfinite(*out);
}

static bool parse_index(const char *text, long low, long high, long *out) {
    char *end;
    errno = 0;
    *out = strtol(text, &end, 10);
    return end != text && !*end && !errno && *out >= low && *out <= high;
}

/* V n x y z */
static hemi_result read_vertex(vs3_reader *r, char **field, int count) {
    vs3_scene *s = r->out;
    long number;
    double x[3];
    if (count < 5) return fail(r, HEMI_ERROR_DATA, "a vertex is: V number x y z", "");
    if (!parse_index(field[1], 1, VERTICES_MAX, &number))
        return fail(r, HEMI_ERROR_DATA, "a vertex number is 1 to 1048576, not ", field[1]);
    for (int k = 0; k < 3; k++)
        if (!parse_number(field[2 + k], &x[k]))
            return fail(r, HEMI_ERROR_DATA, "not a finite coordinate: ", field[2 + k]);
    while ((size_t)number > r->vertex_capacity) {
        size_t capacity = r->vertex_capacity ? 2 * r->vertex_capacity : 64;
        if (!grow(&s->positions, capacity, 3 * sizeof(double)) || !grow(&r->known, capacity, sizeof(bool)))
            return fail(r, HEMI_ERROR_MEMORY, "out of memory", "");
        memset(s->positions + 3 * r->vertex_capacity, 0, 3 * (capacity - r->vertex_capacity) * sizeof(double));
        memset(r->known + r->vertex_capacity, 0, (capacity - r->vertex_capacity) * sizeof(bool));
        r->vertex_capacity = capacity;
    }
    if (r->known[number - 1]) return fail(r, HEMI_ERROR_DATA, "this vertex number has been used before: ", field[1]);
    r->known[number - 1] = true;
    memcpy(s->positions + 3 * (number - 1), x, sizeof x);
    if ((uint32_t)number > s->vertex_count) s->vertex_count = (uint32_t)number;
    return HEMI_OK;
}

static bool grow_polygons(vs3_reader *r) {
    vs3_scene *s = r->out;
    if (s->polygon_count < r->polygon_capacity) return true;
    r->polygon_capacity = r->polygon_capacity ? 2 * r->polygon_capacity : 64;
    return grow(&s->corners, r->polygon_capacity, 4 * sizeof(uint32_t)) &&
           grow(&s->obstructions, r->polygon_capacity, sizeof(bool)) &&
           grow(&s->names, r->polygon_capacity, sizeof *s->names);
}

/* S n v1 v2 v3 v4 base cmb emit name, or O n v1 v2 v3 v4 */
static hemi_result read_surface(vs3_reader *r, char **field, int count) {
    vs3_scene *s = r->out;
    long corner[4] = { 0 }, base = 0, combine = 0;
    if (count < 6) return fail(r, HEMI_ERROR_DATA, "a surface is: S number v1 v2 v3 v4 base cmb emit name", "");
    for (int c = 0; c < 4; c++)
        if (!parse_index(field[2 + c], c == 3 ? 0 : 1, VERTICES_MAX, &corner[c]))
            return fail(r, HEMI_ERROR_DATA, "not a vertex number: ", field[2 + c]);
    if (count > 6 && !parse_index(field[6], -2147483647, 2147483647, &base))
        return fail(r, HEMI_ERROR_DATA, "base is not a surface number: ", field[6]);
    if (count > 7 && !parse_index(field[7], -2147483647, 2147483647, &combine))
        return fail(r, HEMI_ERROR_DATA, "cmb is not a surface number: ", field[7]);
    if (base != 0)
        return fail(r, HEMI_ERROR_UNSUPPORTED, "subsurfaces are not supported; cut the base surface and set base to 0",
                    "");
    if (s->polygon_count == HEMI_FACTORS_MAX) return fail(r, HEMI_ERROR_LIMIT, "more than 8192 surfaces", "");
    if (!grow_polygons(r)) return fail(r, HEMI_ERROR_MEMORY, "out of memory", "");
    uint32_t i = s->polygon_count++;
    for (int c = 0; c < 4; c++) s->corners[4 * (size_t)i + c] = (int32_t)corner[c] - 1;
    s->obstructions[i] = tolower((unsigned char)field[0][0]) == 'o';
    s->combined += combine != 0;
    snprintf(s->names[i], VS3_NAME_SIZE, "%s", count > 9 ? field[9] : field[1]);
    return HEMI_OK;
}

static hemi_result read_line(vs3_reader *r, char *line) {
    char *field[FIELDS_MAX], *comment = strchr(line, '!');
    if (comment) *comment = 0;
    int count = split_fields(line, field);
    if (count == 0) return HEMI_OK;
    switch (tolower((unsigned char)field[0][0])) {
    case 't':
    case 'c':
        return HEMI_OK;
    case 'f':
        if (count > 1 && field[1][0] != '3')
            return fail(r, HEMI_ERROR_UNSUPPORTED, "only geometry in three dimensions (F 3) is read", "");
        return HEMI_OK;
    case 'v':
        return read_vertex(r, field, count);
    case 's':
    case 'o':
        return read_surface(r, field, count);
    case 'e':
        r->ended = true;
        return HEMI_OK;
    default:
        return fail(r, HEMI_ERROR_DATA, "a line begins with T, C, F, V, S, O, ! or End, not with ", field[0]);
    }
}

static hemi_result check_corners(vs3_reader *r) {
    const vs3_scene *s = r->out;
    for (size_t i = 0; i < 4 * (size_t)s->polygon_count; i++) {
        if (s->corners[i] < 0) continue;
        if ((uint32_t)s->corners[i] < s->vertex_count && r->known[s->corners[i]]) continue;
        snprintf(r->message, VS3_MESSAGE_SIZE, "surface '%s': there is no vertex %d", s->names[i / 4],
                 s->corners[i] + 1);
        return HEMI_ERROR_DATA;
    }
    if (s->polygon_count > 0) return HEMI_OK;
    snprintf(r->message, VS3_MESSAGE_SIZE, "it holds no surface (lines that begin with S)");
    return HEMI_ERROR_DATA;
}

static hemi_result read_lines(vs3_reader *r, FILE *file) {
    char line[LINE_SIZE];
    while (!r->ended && fgets(line, sizeof line, file)) {
        r->line++;
        if (!strchr(line, '\n') && !feof(file))
            return fail(r, HEMI_ERROR_DATA, "a line is longer than 510 characters", "");
        if (strlen(line) == 0) return fail(r, HEMI_ERROR_DATA, "not a text file", "");
        hemi_result result = read_line(r, line);
        if (result != HEMI_OK) return result;
    }
    if (ferror(file)) return fail(r, HEMI_ERROR_FILE, "cannot be read: ", strerror(errno));
    return check_corners(r);
}

hemi_result vs3_parse(const void *bytes, size_t size, vs3_scene *out, char message[VS3_MESSAGE_SIZE]) {
    vs3_reader r = { .out = out, .message = message };
    memset(out, 0, sizeof *out);
    message[0] = 0;
    FILE *text = size > 0 ? fmemopen((void *)bytes, size, "r") : NULL;
    hemi_result result = text ? read_lines(&r, text) : size > 0 ? HEMI_ERROR_MEMORY : check_corners(&r);
    if (text) fclose(text);
    free(r.known);
    if (result == HEMI_ERROR_MEMORY && !message[0]) snprintf(message, VS3_MESSAGE_SIZE, "out of memory");
    if (result != HEMI_OK) vs3_scene_free(out);
    return result;
}

void vs3_scene_free(vs3_scene *s) {
    free(s->positions);
    free(s->corners);
    free(s->obstructions);
    free(s->names);
    memset(s, 0, sizeof *s);
}
