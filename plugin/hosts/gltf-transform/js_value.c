/* SPDX-License-Identifier: MIT */
#include "js_value.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool refuse(napi_env env, const char *name, const char *what) {
    char text[128];
    snprintf(text, sizeof text, "hemibake: '%s' is not %s", name, what);
    napi_throw_type_error(env, "HEMI_ERROR_ARGUMENT", text);
    return false;
}

static napi_valuetype type_of(napi_env env, napi_value value) {
    napi_valuetype type = napi_undefined;
    if (value) napi_typeof(env, value, &type);
    return type;
}

bool js_get(napi_env env, napi_value object, const char *name, napi_value *out) {
    bool pending = false;
    *out = NULL;
    if (type_of(env, object) != napi_object) return refuse(env, name, "in an object");
    napi_get_named_property(env, object, name, out);
    napi_is_exception_pending(env, &pending); /* a getter may throw */
    if (type_of(env, *out) == napi_undefined || type_of(env, *out) == napi_null) *out = NULL;
    return !pending;
}

bool js_get_number(napi_env env, napi_value object, const char *name, double *out) {
    napi_value value;
    if (!js_get(env, object, name, &value)) return false;
    if (!value) return true;
    return napi_get_value_double(env, value, out) == napi_ok || refuse(env, name, "a number");
}

bool js_get_uint32(napi_env env, napi_value object, const char *name, uint32_t *out) {
    double value = *out;
    if (!js_get_number(env, object, name, &value)) return false;
    if (!(value >= 0.0 && value <= UINT32_MAX) || value != floor(value))
        return refuse(env, name, "a whole number from 0 up");
    *out = (uint32_t)value;
    return true;
}

bool js_get_bool(napi_env env, napi_value object, const char *name, bool *out) {
    napi_value value;
    if (!js_get(env, object, name, &value)) return false;
    if (!value) return true;
    return napi_get_value_bool(env, value, out) == napi_ok || refuse(env, name, "true or false");
}

bool js_to_text(napi_env env, napi_value value, char **out) {
    size_t size;
    if (napi_get_value_string_utf8(env, value, NULL, 0, &size) != napi_ok) return false;
    *out = malloc(size + 1);
    return *out && napi_get_value_string_utf8(env, value, *out, size + 1, &size) == napi_ok;
}

bool js_get_text(napi_env env, napi_value object, const char *name, char **out) {
    napi_value value;
    *out = NULL;
    if (!js_get(env, object, name, &value)) return false;
    return !value || js_to_text(env, value, out) || refuse(env, name, "a string");
}

bool js_get_list(napi_env env, napi_value object, const char *name, napi_value *out, uint32_t *count) {
    bool is_array = false;
    *count = 0;
    if (!js_get(env, object, name, out)) return false;
    if (!*out) return true;
    napi_is_array(env, *out, &is_array);
    if (!is_array) return refuse(env, name, "an array");
    return napi_get_array_length(env, *out, count) == napi_ok;
}

bool js_get_numbers(napi_env env, napi_value object, const char *name, double *out, size_t count) {
    napi_value list, item;
    uint32_t length;
    if (!js_get_list(env, object, name, &list, &length)) return false;
    if (!list) return true;
    if (length != count) return refuse(env, name, "an array of as many numbers as it needs");
    for (uint32_t i = 0; i < length; i++)
        if (napi_get_element(env, list, i, &item) != napi_ok || napi_get_value_double(env, item, &out[i]) != napi_ok)
            return refuse(env, name, "an array of numbers");
    return true;
}

bool js_get_array(napi_env env, napi_value object, const char *name, napi_typedarray_type type, void **out,
                  size_t *count) {
    napi_value value;
    napi_typedarray_type found = napi_int8_array;
    bool is_typed = false;
    void *data;
    *out = NULL;
    *count = 0;
    if (!js_get(env, object, name, &value)) return false;
    if (!value) return true;
    napi_is_typedarray(env, value, &is_typed);
    if (is_typed) napi_get_typedarray_info(env, value, &found, count, &data, NULL, NULL);
    if (!is_typed || found != type)
        return refuse(env, name, type == napi_float32_array ? "a Float32Array" : "a Uint32Array");
    *out = malloc(4 * *count + 1);
    if (!*out) return refuse(env, name, "small enough for memory");
    if (*count) memcpy(*out, data, 4 * *count);
    return true;
}

void js_set_number(napi_env env, napi_value object, const char *name, double value) {
    napi_value number;
    if (napi_create_double(env, value, &number) == napi_ok) napi_set_named_property(env, object, name, number);
}
