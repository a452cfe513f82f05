/* SPDX-License-Identifier: MIT
 * Where do exceptions end? At the functions of the C interface, as a code and a message.
 */
#ifndef HEMIBAKE_GLTF_GUARDED_H
#define HEMIBAKE_GLTF_GUARDED_H

#include <hemibake/hemibake.h>

/* Runs work; what it throws becomes a code and a message, which may be NULL. `broken` is said of the rest. */
hemi_result gltf_guarded_call(char *message, const char *purpose, const char *broken, void (*call)(const void *work),
                              const void *work);

/* Takes no memory itself: without any it could not say so. */
template <typename work_t>
hemi_result gltf_guarded(char *message, const char *purpose, const char *broken, const work_t &work) {
    return gltf_guarded_call(
        message, purpose, broken, [](const void *w) { (*static_cast<const work_t *>(w))(); }, &work);
}

#endif
