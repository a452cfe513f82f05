/* SPDX-License-Identifier: MIT
 * What does a JavaScript value hold, as C? What is missing leaves *out as it was; what is of another kind throws a
 * TypeError that names the property, and the function returns false.
 */
#ifndef HEMIBAKE_NODE_JS_VALUE_H
#define HEMIBAKE_NODE_JS_VALUE_H

#include <node_api.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* *out: NULL if object has no such property, or undefined or null. */
bool js_get(napi_env env, napi_value object, const char *name, napi_value *out);

bool js_get_number(napi_env env, napi_value object, const char *name, double *out);
bool js_get_uint32(napi_env env, napi_value object, const char *name, uint32_t *out);
bool js_get_bool(napi_env env, napi_value object, const char *name, bool *out);

/* A malloc'ed copy of a string. False, without an exception: it is none, or there is no memory. */
bool js_to_text(napi_env env, napi_value value, char **out);

/* malloc'ed copy; NULL if missing. */
bool js_get_text(napi_env env, napi_value object, const char *name, char **out);

/* An array of exactly count numbers. */
bool js_get_numbers(napi_env env, napi_value object, const char *name, double *out, size_t count);

/* A malloc'ed copy of a Float32Array or Uint32Array (type), and how many numbers it has; NULL if missing. */
bool js_get_array(napi_env env, napi_value object, const char *name, napi_typedarray_type type, void **out,
                  size_t *count);

/* An Array; *count is its length, 0 if missing. */
bool js_get_list(napi_env env, napi_value object, const char *name, napi_value *out, uint32_t *count);

void js_set_number(napi_env env, napi_value object, const char *name, double value);

#endif
