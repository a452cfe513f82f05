/* SPDX-License-Identifier: MIT
 * What must a back end of the item buffer give? An OpenGL 4.5 core context without a window, and the addresses of
 * OpenGL's functions; item_buffer.c does the drawing.
 *
 *     osmesa.c   Mesa's off-screen library; Mesa 25.1 dropped it
 *     egl.c      EGL on Mesa's surfaceless platform
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_GL_CONTEXT_H
#define HEMIBAKE_CORE_VISIBILITY_GL_CONTEXT_H

#include "base/block.h"

#include <pthread.h>

typedef void (*gl_address)(void);

/* A back end. One thread at a time calls its OpenGL: the contexts of a process share one screen of llvmpipe
 * (Mesa 22.3), and whoever maps a buffer or reads pixels walks the lists of all contexts' scenes, while others write
 * them; a forest crashed so within seconds. Rasterising has threads of its own, in Mesa, and what is drawn is chosen
 * outside the turn.
 *
 * create: NULL with *failure set. enter makes the context current in the calling thread, leave makes none
 * current: two OpenGL libraries in one process do not know of each other's current contexts, and both together take
 * two microseconds. */
typedef struct gl_context_kind {
    void *(*create)(allocator *memory, const char **failure);
    void (*destroy)(void *context);
    bool (*enter)(void *context);
    void (*leave)(void *context);
    gl_address (*address)(void *context, const char *name);
    pthread_mutex_t *turn; /* whose turn it is in the process to call OpenGL, from making a context to destroying it */
} gl_context_kind;

extern const gl_context_kind gl_context_osmesa, gl_context_egl;

#endif
