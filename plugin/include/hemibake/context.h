/* SPDX-License-Identifier: MIT
 * What can go wrong, who hears of it, and where do memory and threads come from? Part of hemibake.h.
 */
#ifndef HEMIBAKE_CONTEXT_H
#define HEMIBAKE_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What stands between these has the names of C, also where C++ includes it. */
#ifdef __cplusplus
#define HEMI_C_BEGIN extern "C" {
#define HEMI_C_END   }
#else
#define HEMI_C_BEGIN
#define HEMI_C_END
#endif

HEMI_C_BEGIN

#if defined(__GNUC__)
#define HEMI_API __attribute__((visibility("default")))
#else
#define HEMI_API
#endif

/* ---- results ----------------------------------------------------------------------------------------------------- */

/* X(name, text): every result code with the sentence that hemi_result_text returns for it. */
#define HEMI_RESULTS(X)                                                                                                \
    X(HEMI_OK, "done")                                                                                                 \
    X(HEMI_ERROR_ARGUMENT, "an argument breaks the rules of the interface")                                            \
    X(HEMI_ERROR_MEMORY, "out of memory")                                                                              \
    X(HEMI_ERROR_DATA, "the data is malformed")                                                                        \
    X(HEMI_ERROR_UNSUPPORTED, "the data asks for something that is not supported")                                     \
    X(HEMI_ERROR_NO_SURFACES, "there is no surface to bake")                                                           \
    X(HEMI_ERROR_NO_LIGHT, "no light reaches the front of a surface")                                                  \
    X(HEMI_ERROR_LIMIT, "a size limit is exceeded")                                                                    \
    X(HEMI_ERROR_BACKEND, "the item-buffer back end failed")                                                           \
    X(HEMI_ERROR_FILE, "a file could not be read or written")                                                          \
    X(HEMI_CANCELLED, "cancelled by the progress callback, or stopped before anything was there")

typedef enum hemi_result {
#define HEMI_RESULT_ENUM(name, text) name,
    HEMI_RESULTS(HEMI_RESULT_ENUM)
#undef HEMI_RESULT_ENUM
        HEMI_RESULT_COUNT
} hemi_result;

/* The sentence that belongs to a code; never NULL. */
HEMI_API const char *hemi_result_text(hemi_result result);

/* "MAJOR.MINOR.PATCH" of the library that is linked (HEMI_VERSION_STRING is that of the header). */
HEMI_API const char *hemi_version(void);

/* ---- context ----------------------------------------------------------------------------------------------------- */

typedef enum hemi_log_level { HEMI_LOG_ERROR, HEMI_LOG_WARNING, HEMI_LOG_INFO } hemi_log_level;

/* One line without its newline; valid during the call only. */
typedef void (*hemi_log_fn)(void *user, hemi_log_level level, const char *text);

typedef struct hemi_context hemi_context;

/* Where memory comes from: as malloc, realloc and free of C11, aligned for any type. They are called from the context's
 * threads too, several at a time, and must not call back into the library. What alloc or realloc refuse (NULL) becomes
 * HEMI_ERROR_MEMORY of the call under way, and the handles stay usable. Not through it go what the libraries below take
 * for themselves (OSMesa or EGL, OpenSubdiv, the C++ runtime) and what the C library takes for threads and sorting. */
typedef struct hemi_allocator {
    void *(*alloc)(void *user, size_t bytes); /* bytes > 0 */
    void *(*realloc)(void *user, void *block, size_t bytes);
    void (*free)(void *user, void *block);
    void *user;
} hemi_allocator;

typedef struct hemi_context_desc {
    uint32_t struct_size; /* sizeof(hemi_context_desc) */
    uint32_t threads;     /* worker threads; 0: one for each online core */
    hemi_log_fn log;      /* NULL: silence */
    void *log_user;
    hemi_allocator allocator; /* all three functions, or none: the C library's */
} hemi_context_desc;

/* desc may be NULL (all defaults). */
HEMI_API hemi_result hemi_context_create(const hemi_context_desc *desc, hemi_context **out);
/* NULL is fine. Scenes and solutions come first; so do factors, if the context has an allocator. */
HEMI_API void hemi_context_destroy(hemi_context *context);

HEMI_C_END
#endif
