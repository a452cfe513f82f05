/* SPDX-License-Identifier: MIT
 * How was a value written before it was parsed? cJSON prints 1.0 as 1 and knows integers up to 2^53 only; a tree whose
 * numbers keep their text prints what was read.
 */
#include "gltf_json.h"

#include <cjson/cJSON.h>

#include <string.h>

static const char *skip_space(const char *at) {
    return at + strspn(at, " \t\r\n");
}

/* Past a string that begins at its quote. */
static const char *skip_string(const char *at) {
    for (at++; *at && *at != '"'; at++)
        if (*at == '\\' && at[1]) at++;
    return *at ? at + 1 : at;
}

static bool keep_text(cJSON *item, const char *begin, const char *end) {
    size_t size = (size_t)(end - begin);
    char *text = cJSON_malloc(size + 1);
    if (!text) return false;
    memcpy(text, begin, size);
    text[size] = '\0';
    cJSON_free(item->valuestring);
    item->valuestring = text;
    item->type = cJSON_Raw | (item->type & ~0xFF);
    return true;
}

/* Digits alone, few enough for a double, come out as they went in. */
static bool prints_alike(const char *begin, const char *end) {
    size_t size = (size_t)(end - begin);
    return size < 10 && strspn(begin, "0123456789") >= size;
}

/* Walks text and tree together; where the value ends, or NULL without memory. */
static const char *walk(cJSON *item, const char *at) {
    const char *end;
    bool object = cJSON_IsObject(item);
    at = skip_space(at);
    if (object || cJSON_IsArray(item)) {
        at = skip_space(at + 1);
        for (cJSON *child = item->child; child; child = child->next) {
            if (object) at = skip_space(skip_string(at)) + 1;
            at = walk(child, at);
            if (!at) return NULL;
            at = skip_space(at);
            if (*at == ',') at = skip_space(at + 1);
        }
        return at + 1;
    }
    if (*at == '"') {
        end = skip_string(at);
        return !memchr(at, '\\', (size_t)(end - at)) || keep_text(item, at, end) ? end : NULL;
    }
    end = at + strcspn(at, ",]} \t\r\n");
    return !cJSON_IsNumber(item) || prints_alike(at, end) || keep_text(item, at, end) ? end : NULL;
}

cJSON *gltf_json_parse_exactly(const char *text) {
    cJSON *root = cJSON_Parse(text);
    if (root && walk(root, text)) return root;
    cJSON_Delete(root);
    return NULL;
}
