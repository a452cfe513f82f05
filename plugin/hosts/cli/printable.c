/* SPDX-License-Identifier: MIT */
#include "printable.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* What is printed of a code point that is not; NOT_UTF8 is none. */
static const uint32_t NOT_UTF8 = UINT32_MAX;

/* The code point at text and how many bytes it takes; a byte that begins none is NOT_UTF8, of one byte. [RFC 3629] */
static uint32_t read_code_point(const unsigned char *text, size_t *length) {
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    unsigned char first = text[0];
    size_t count = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    uint32_t code = count == 1 ? first : first & (0x7fu >> count);
    *length = 1;
    for (size_t i = 1; i < count; i++) {
        if (text[i] >> 6 != 2) return NOT_UTF8;
        code = code << 6 | (text[i] & 0x3fu);
    }
    if (count == 0 || code < least[count] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return NOT_UTF8;
    *length = count;
    return code;
}

static bool is_printed(uint32_t code) {
    static const struct {
        uint32_t first, last;
    } hidden[] = { { 0, 0x1f },          /* C0 */
                   { 0x7f, 0x9f },       /* DEL and C1; 0x9b begins an escape sequence as ESC [ does */
                   { 0x61c, 0x61c },     /* Arabic letter mark */
                   { 0x200e, 0x200f },   /* left-to-right and right-to-left marks */
                   { 0x2028, 0x202e },   /* separators; embeddings and overrides of direction */
                   { 0x2066, 0x2069 },   /* isolates of direction */
                   { 0xfff9, 0xfffb },   /* interlinear annotation */
                   { 0xe0000, 0xe007f }, /* tags, which nobody sees */
                   { NOT_UTF8, NOT_UTF8 } };
    for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++)
        if (code >= hidden[i].first && code <= hidden[i].last) return false;
    return true;
}

char *printable(char *text) {
    char *to = text;
    size_t length;
    for (const char *from = text; *from; from += length) {
        uint32_t code = read_code_point((const unsigned char *)from, &length);
        if (!is_printed(code)) {
            *to++ = '?';
            continue;
        }
        memmove(to, from, length);
        to += length;
    }
    *to = 0;
    return text;
}

void print_printable(FILE *to, const char *text) {
    size_t length;
    for (; *text; text += length) {
        bool shown = is_printed(read_code_point((const unsigned char *)text, &length));
        fwrite(shown ? text : "?", 1, shown ? length : 1, to);
    }
}

void print_padded(const char *name, size_t width) {
    print_printable(stdout, name);
    for (size_t i = strlen(name); i < width; i++) putchar(' ');
}

void print_failure(const char *file, const char *text) {
    fputs("hemibake: ", stderr);
    print_printable(stderr, file);
    fputs(": ", stderr);
    print_printable(stderr, text);
    fputc('\n', stderr);
}

void print_json_printable(FILE *to, const char *json) {
    size_t length;
    for (; *json; json += length) {
        uint32_t code = read_code_point((const unsigned char *)json, &length);
        bool is_space = *json == '\n' || *json == '\t'; /* between values; in strings they are escaped */
        if (is_space || is_printed(code))
            fwrite(json, 1, length, to);
        else if (code == NOT_UTF8)
            fputs("\\ufffd", to);
        else if (code < 0x10000)
            fprintf(to, "\\u%04x", (unsigned)code);
        else
            fprintf(to, "\\u%04x\\u%04x", (unsigned)(0xd7c0 + (code >> 10)), (unsigned)(0xdc00 + (code & 0x3ff)));
    }
}
