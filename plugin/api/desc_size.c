/* SPDX-License-Identifier: MIT */
#include "desc_size.h"

#include "internal.h"

#include <string.h>

bool desc_take(const hemi_context *context, const char *name, const void *desc, size_t least, void *known,
               size_t known_size) {
    uint32_t size;
    memset(known, 0, known_size);
    if (!desc) {
        context_log(context, HEMI_LOG_ERROR, "%s: the desc is NULL", name);
        return false;
    }
    memcpy(&size, desc, sizeof size);
    if (size < least || size > known_size || size % sizeof size != 0) {
        context_log(context, HEMI_LOG_ERROR,
                    "%s: struct_size is %u, and hemibake %s takes %zu to %zu; set it to the sizeof of the desc, and "
                    "build host and library with the same header",
                    name, size, hemi_version(), least, known_size);
        return false;
    }
    memcpy(known, desc, size);
    return true;
}

/* No view is so large; what is not set is hardly ever below. */
enum { VIEW_SIZE_MAX = 4096 };

bool view_give(void *out, size_t least, const void *known, size_t known_size) {
    uint32_t size;
    if (!out) return false;
    memcpy(&size, out, sizeof size);
    if (size < least || size > VIEW_SIZE_MAX || size % sizeof size != 0) return false;
    memset(out, 0, size);
    memcpy(out, known, size < known_size ? size : known_size);
    memcpy(out, &size, sizeof size);
    return true;
}
