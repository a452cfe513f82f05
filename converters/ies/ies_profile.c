/* SPDX-License-Identifier: MIT
 * See ies_profile.h. Numbers are separated by space, line ends or commas, wherever lines break. Bounds: all numbers
 * stand in the file, so a file cannot ask for more than some times its size.
 */
#include "ies_profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Half a degree, finer than lamps are measured; and two and a half round the aim. */
enum { ROWS = 361, COLUMNS = 144 };

/* More than any goniometer gives, and little enough that the product of two does not overflow. */
enum { ANGLES_MAX = 100000 };

enum { TYPE_C = 1, TYPE_B = 2, TYPE_A = 3 };

static const double CANDELA_MAX = 1e12;

typedef struct reader {
    const char *at, *end;
    char *message;
} reader;

/* The angles are ascending; candela[vertical_count * h + v]. */
typedef struct measured {
    int type;
    size_t vertical_count, horizontal_count;
    double *vertical, *horizontal, *candela;
} measured;

static hemi_result fail(reader *r, const char *text) {
    snprintf(r->message, IES_MESSAGE_SIZE, "%s", text);
    return HEMI_ERROR_DATA;
}

/* ---- text ---- */

static bool is_separator(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '\f' || c == '\v';
}

static bool read_number(reader *r, double *out) {
    char text[64];
    size_t length = 0;
    while (r->at < r->end && is_separator(*r->at)) r->at++;
    while (r->at < r->end && !is_separator(*r->at) && length + 1 < sizeof text) text[length++] = *r->at++;
    text[length] = '\0';
    char *stop;
    *out = strtod(text, &stop);
    return length > 0 && stop == text + length && isfinite(*out);
}

/* The next line without its end; false: there is none. */
static bool next_line(reader *r, const char **line, size_t *length) {
    if (r->at >= r->end) return false;
    *line = r->at;
    while (r->at < r->end && *r->at != '\n' && *r->at != '\r') r->at++;
    *length = (size_t)(r->at - *line);
    while (r->at < r->end && (*r->at == '\n' || *r->at == '\r')) r->at++;
    return true;
}

/* Past the keywords, to what follows TILT=. */
static hemi_result skip_to_numbers(reader *r) {
    const char *line;
    size_t length;
    while (next_line(r, &line, &length)) {
        if (length < 5 || strncmp(line, "TILT=", 5) != 0) continue;
        if (length < 12 || strncmp(line, "TILT=INCLUDE", 12) != 0)
            return HEMI_OK; /* NONE, or a file, which is left out */
        double lamp, count, number;
        if (!read_number(r, &lamp) || !read_number(r, &count) || !(count >= 0.0 && count <= ANGLES_MAX))
            return fail(r, "its TILT section has no count of angles");
        for (size_t i = 0; i < 2 * (size_t)count; i++)
            if (!read_number(r, &number)) return fail(r, "its TILT section is cut short");
        return HEMI_OK;
    }
    return fail(r, "it has no line TILT=, so it is no IES LM-63 file");
}

/* ---- what was measured ---- */

static bool read_angles(reader *r, double *out, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!read_number(r, &out[i]) || fabs(out[i]) > 360.0 || (i > 0 && out[i] <= out[i - 1])) return false;
    return true;
}

static bool is_count(double x) {
    return x >= 1.0 && x <= ANGLES_MAX && x == floor(x);
}

/* lamps, lumens, multiplier, vertical, horizontal, type, units, three sizes, ballast factor, reserved, watts. */
static hemi_result read_header(reader *r, measured *out, double *scale) {
    double n[13];
    for (size_t i = 0; i < 13; i++)
        if (!read_number(r, &n[i])) return fail(r, "the thirteen numbers after TILT= are not all there");
    if (!is_count(n[3]) || !is_count(n[4])) return fail(r, "its counts of angles are no counts");
    if (n[5] != TYPE_C && n[5] != TYPE_B && n[5] != TYPE_A) return fail(r, "its photometric type is none of 1, 2, 3");
    out->vertical_count = (size_t)n[3];
    out->horizontal_count = (size_t)n[4];
    out->type = (int)n[5];
    /* The reserved factor was the ballast-lamp factor of 1991, and is 1 since. */
    *scale = n[2] * n[10] * n[11];
    return *scale >= 0.0 && *scale <= CANDELA_MAX ? HEMI_OK : fail(r, "its multipliers are negative or too large");
}

static hemi_result read_measured(reader *r, measured *out) {
    double scale;
    hemi_result result = skip_to_numbers(r);
    if (result == HEMI_OK) result = read_header(r, out, &scale);
    if (result != HEMI_OK) return result;
    size_t v = out->vertical_count, h = out->horizontal_count;
    if (v > (size_t)(r->end - r->at) || h > (size_t)(r->end - r->at) / v) return fail(r, "it is cut short");
    out->vertical = malloc(v * sizeof *out->vertical);
    out->horizontal = malloc(h * sizeof *out->horizontal);
    out->candela = malloc(v * h * sizeof *out->candela);
    if (!out->vertical || !out->horizontal || !out->candela) {
        snprintf(r->message, IES_MESSAGE_SIZE, "not enough memory to read it");
        return HEMI_ERROR_MEMORY;
    }
    if (!read_angles(r, out->vertical, v)) return fail(r, "its vertical angles do not ascend from -360 to 360");
    if (!read_angles(r, out->horizontal, h)) return fail(r, "its horizontal angles do not ascend from -360 to 360");
    for (size_t i = 0; i < v * h; i++) {
        double value;
        if (!read_number(r, &value)) return fail(r, "it has fewer candela than angles");
        out->candela[i] = scale * fmax(value, 0.0); /* noise of a measurement near 0 may be below it */
        if (!(out->candela[i] <= CANDELA_MAX)) return fail(r, "an intensity is above 1e12 candela");
    }
    return HEMI_OK;
}

/* ---- directions ---- */

/* Between which angles x lies, and how far; false: nothing was measured there. */
static bool find_between(const double *angles, size_t count, double x, size_t *low, double *part) {
    const double slack = 1e-9; /* degrees, of rounding */
    *low = 0;
    *part = 0.0;
    if (x < angles[0] - slack || x > angles[count - 1] + slack) return false;
    if (count == 1) return true;
    size_t high = count - 1;
    while (high - *low > 1) {
        size_t middle = (*low + high) / 2;
        if (angles[middle] <= x)
            *low = middle;
        else
            high = middle;
    }
    *part = fmin(fmax((x - angles[*low]) / (angles[high] - angles[*low]), 0.0), 1.0);
    return true;
}

static double value_at(const measured *m, size_t h, size_t v, double part) {
    const double *row = m->candela + m->vertical_count * h;
    return v + 1 < m->vertical_count ? (1.0 - part) * row[v] + part * row[v + 1] : row[v];
}

static double look_up(const measured *m, double vertical, double horizontal) {
    size_t v, h;
    double v_part, h_part;
    if (!find_between(m->vertical, m->vertical_count, vertical, &v, &v_part)) return 0.0;
    if (m->horizontal_count == 1) return value_at(m, 0, v, v_part);
    if (!find_between(m->horizontal, m->horizontal_count, horizontal, &h, &h_part)) return 0.0;
    return (1.0 - h_part) * value_at(m, h, v, v_part) + h_part * value_at(m, h + 1, v, v_part);
}

/* Of type C: the angle in what was measured that stands for one of 0 to 360 degrees. [LM-63-2002, 5.15] */
static double fold(const measured *m, double phi) {
    double first = m->horizontal[0], last = m->horizontal[m->horizontal_count - 1];
    if (first == 0.0 && last == 90.0) { /* four quarters alike */
        phi = phi > 180.0 ? 360.0 - phi : phi;
        return phi > 90.0 ? 180.0 - phi : phi;
    }
    if (first == 0.0 && last == 180.0) return phi > 180.0 ? 360.0 - phi : phi;
    if (first == 90.0 && last == 270.0) return phi < 90.0 ? 180.0 - phi : phi > 270.0 ? 540.0 - phi : phi;
    return phi < first ? phi + 360.0 : phi > last && phi - 360.0 >= first ? phi - 360.0 : phi;
}

/* A round that ends before it is closed goes on to where it began. */
static double intensity_c(const measured *m, double theta, double phi) {
    double first = m->horizontal[0], last = m->horizontal[m->horizontal_count - 1];
    if (first != 0.0 || last <= 180.0 || phi <= last) return look_up(m, theta, fold(m, phi));
    double part = (phi - last) / (360.0 - last);
    return (1.0 - part) * look_up(m, theta, last) + part * look_up(m, theta, first);
}

/* Only one half measured: the other is alike. */
static double unsigned_if(const double *angles, double x) {
    return angles[0] >= 0.0 ? fabs(x) : x;
}

static double intensity(const measured *m, double theta, double phi) {
    if (m->type == TYPE_C) return intensity_c(m, theta * 180.0 / PI, phi * 180.0 / PI);
    double up = sin(theta) * cos(phi), right = -sin(theta) * sin(phi), ahead = cos(theta), v, h;
    if (m->type == TYPE_A) { /* aside about the vertical, then up */
        v = asin(fmin(fmax(up, -1.0), 1.0));
        h = atan2(right, ahead);
    } else { /* up about the horizontal, then aside */
        v = atan2(up, ahead);
        h = asin(fmin(fmax(right, -1.0), 1.0));
    }
    return look_up(m, unsigned_if(m->vertical, v * 180.0 / PI), unsigned_if(m->horizontal, h * 180.0 / PI));
}

/* ---- the whole ---- */

static hemi_result sample(const measured *m, ies_profile *out) {
    out->rows = ROWS;
    out->columns = m->type == TYPE_C && m->horizontal_count == 1 ? 1 : COLUMNS;
    out->candela = malloc((size_t)out->rows * out->columns * sizeof *out->candela);
    if (!out->candela) return HEMI_ERROR_MEMORY;
    for (size_t row = 0; row < out->rows; row++)
        for (size_t column = 0; column < out->columns; column++)
            out->candela[row * out->columns + column] =
                (float)intensity(m, PI * (double)row / (out->rows - 1.0), 2.0 * PI * (double)column / out->columns);
    return HEMI_OK;
}

hemi_result ies_profile_read(const uint8_t *bytes, size_t size, ies_profile *out, char message[IES_MESSAGE_SIZE]) {
    const char *text = bytes ? (const char *)bytes : "";
    reader r = { text, text + (bytes ? size : 0), message };
    measured m = { 0 };
    *out = (ies_profile){ 0 };
    message[0] = '\0';
    hemi_result result = read_measured(&r, &m);
    if (result == HEMI_OK) result = sample(&m, out);
    if (result == HEMI_ERROR_MEMORY) snprintf(message, IES_MESSAGE_SIZE, "not enough memory to read it");
    free(m.vertical);
    free(m.horizontal);
    free(m.candela);
    return result;
}

void ies_profile_free(ies_profile *profile) {
    if (!profile) return;
    free(profile->candela);
    *profile = (ies_profile){ 0 };
}
