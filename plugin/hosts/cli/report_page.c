/* SPDX-License-Identifier: MIT
 * See report_page.h.
 */
#include "report_page.h"

#include "bake_preview.h"
#include "path_text.h"
#include "report_page_html.h"
#include "triangle_area.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the template has its data. */
static const char PLACE[] = "@DATA@";

/* Pictures of this size keep the page below 2 MB whatever is on them. */
enum { PICTURE_WIDTH = 960, PICTURE_HEIGHT = 720, BIN_COUNT = 60, BIN_ZERO = 30 };

bool report_page_is_asked(const char *path) {
    return path_ends_in(path, ".html") || path_ends_in(path, ".htm");
}

/* ---- what stands in it ------------------------------------------------------------------------------------------- */

/* RFC 4648 */
static char *base64(const unsigned char *bytes, size_t size) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *out = malloc(4 * ((size + 2) / 3) + 1), *to = out;
    for (size_t i = 0; out && i < size; i += 3) {
        uint32_t three = (uint32_t)bytes[i] << 16;
        if (i + 1 < size) three |= (uint32_t)bytes[i + 1] << 8;
        if (i + 2 < size) three |= bytes[i + 2];
        for (int k = 0; k < 4; k++) *to++ = letters[three >> (18 - 6 * k) & 63];
        if (i + 1 >= size) to[-2] = '=';
        if (i + 2 >= size) to[-1] = '=';
    }
    if (out) *to = 0;
    return out;
}

static options options_of_pictures(const options *o) {
    options out = *o;
    out.preview = "picture.jpg";
    out.size[0] = PICTURE_WIDTH;
    out.size[1] = PICTURE_HEIGHT;
    return out;
}

/* A page without its pictures is one all the same. */
static void add_picture(cJSON *root, const char *name, int status, unsigned char *bytes, size_t size) {
    char *text = status == EXIT_DONE ? base64(bytes, size) : NULL;
    if (text) cJSON_AddStringToObject(root, name, text);
    free(text);
    free(bytes);
}

static void add_pictures(cJSON *root, const report_facts *f, hemi_context *context, console *c) {
    const options o = options_of_pictures(f->o);
    unsigned char *bytes = NULL;
    size_t size = 0;
    int status = bake_preview_before(context, f->asset, &o, c, &bytes, &size);
    add_picture(root, "before", status, bytes, size);
    bytes = NULL;
    status = bake_preview(context, f->asset, f->colors, &o, c, &bytes, &size);
    add_picture(root, "after", status, bytes, size);
    bytes = NULL;
    double full = 0.0;
    status = bake_preview_errors(context, f->asset, f->colors, &o, c, &bytes, &size, &full);
    add_picture(root, "errors", full > 0.0 ? status : EXIT_BAD_INPUT, bytes, size);
    cJSON_AddNumberToObject(root, "full_error", full);
}

/* The bin of a triangle as large as half a square of this edge; two bins double the edge. */
static int bin_of(double area) {
    double bin = BIN_ZERO + floor(log2(2.0 * area));
    return area > 0.0 && bin > 0.0 ? (bin < BIN_COUNT ? (int)bin : BIN_COUNT - 1) : 0;
}

static void add_sizes(cJSON *root, const report_facts *f) {
    double bins[BIN_COUNT] = { 0 }, normal[3];
    int first = 0, last = BIN_COUNT - 1;
    for (uint32_t i = 0; i < f->colors->mesh_count; i++) {
        const hemi_mesh_view *v = &f->colors->views[i];
        hemi_mesh_desc mesh;
        gltf_asset_mesh(f->asset, i, &mesh);
        for (uint64_t t = 0; t < v->triangle_count; t++)
            bins[bin_of(triangle_area(v->positions, mesh.transform, v->indices + 3 * t, normal))]++;
    }
    while (first < BIN_COUNT && bins[first] == 0.0) first++;
    while (last > first && bins[last] == 0.0) last--;
    cJSON *list = cJSON_AddArrayToObject(root, "sizes");
    for (int i = first; i <= last && first < BIN_COUNT; i++) {
        const double pair[2] = { sqrt(exp2(i - BIN_ZERO)), bins[i] };
        cJSON_AddItemToArray(list, cJSON_CreateDoubleArray(pair, 2));
    }
}

/* All that a bake takes: with its value what was given, with what help says of it and of its default what was not. */
static void add_options(cJSON *root, const report_facts *f) {
    cJSON *given = cJSON_AddArrayToObject(root, "options"), *left = cJSON_AddArrayToObject(root, "defaults");
    for (int i = 0; i < OPTION_COUNT; i++) {
        const char *value = f->o->given[i], *pair[] = { OPTIONS[i].name, value ? value : OPTIONS[i].help };
        if (value || OPTIONS[i].commands & COMMAND_BAKE)
            cJSON_AddItemToArray(value ? given : left, cJSON_CreateStringArray(pair, 2));
    }
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

/* Of JSON in a script only strings have this character, and it might end the script. */
static void put_data(FILE *to, const char *json) {
    for (; *json; json++)
        if (*json == '<')
            fputs("\\u003c", to);
        else
            fputc(*json, to);
}

static char *fill(const char *json) {
    const char *page = (const char *)REPORT_PAGE, *place = strstr(page, PLACE);
    char *text = NULL;
    size_t size;
    FILE *to = open_memstream(&text, &size);
    if (!to) return NULL;
    fwrite(page, 1, (size_t)(place - page), to);
    put_data(to, json);
    fputs(place + strlen(PLACE), to);
    bool ok = ferror(to) == 0;
    if (fclose(to) == 0 && ok) return text;
    free(text);
    return NULL;
}

char *report_page_make(const report_facts *f, hemi_context *context, console *c, const char *json) {
    cJSON *root = cJSON_CreateObject();
    cJSON_AddItemToObject(root, "report", cJSON_Parse(json));
    add_options(root, f);
    add_sizes(root, f);
    add_pictures(root, f, context, c);
    char *data = cJSON_PrintUnformatted(root), *page = data ? fill(data) : NULL;
    cJSON_free(data);
    cJSON_Delete(root);
    return page;
}
