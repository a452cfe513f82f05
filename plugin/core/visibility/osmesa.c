/* SPDX-License-Identifier: MIT
 * How does OSMesa give an OpenGL context? From a software rasteriser in the process, with a colour buffer in its
 * memory.
 *
 * This is the only file of the core that knows OSMesa.
 */
#include "visibility/gl_context.h"

#include <GL/osmesa.h>

typedef struct osmesa_context {
    OSMesaContext context;
    unsigned char pixel[4]; /* OSMesa wants a colour buffer of its own; nothing is drawn there */
} osmesa_context;

static bool osmesa_enter(void *context) {
    osmesa_context *c = context;
    return OSMesaMakeCurrent(c->context, c->pixel, GL_UNSIGNED_BYTE, 1, 1);
}

static void osmesa_leave(void *context) {
    (void)context;
    OSMesaMakeCurrent(NULL, NULL, 0, 0, 0);
}

static void osmesa_destroy(void *context) {
    osmesa_context *c = context;
    if (c->context) OSMesaDestroyContext(c->context);
    block_free(c);
}

static void *osmesa_create(allocator *memory, const char **failure) {
    static const int attributes[] = {
        OSMESA_FORMAT,
        OSMESA_RGBA, /* of the unused buffer */
        OSMESA_DEPTH_BITS,
        0, /* of the same */
        OSMESA_PROFILE,
        OSMESA_CORE_PROFILE, /* ids come from the primitive's number */
        OSMESA_CONTEXT_MAJOR_VERSION,
        4, /* glClipControl is of 4.5 */
        OSMESA_CONTEXT_MINOR_VERSION,
        5,
        0,
    };
    osmesa_context *c = block_zeroed(memory, 1, sizeof *c);
    *failure = "out of memory";
    if (!c) return NULL;
    c->context = OSMesaCreateContextAttribs(attributes, NULL);
    if (c->context && osmesa_enter(c)) return c;
    *failure = "OSMesa gives no OpenGL 4.5 core context";
    osmesa_destroy(c);
    return NULL;
}

static gl_address osmesa_address(void *context, const char *name) {
    (void)context;
    return OSMesaGetProcAddress(name);
}

/* As the screen is, of the process. */
static pthread_mutex_t osmesa_turn = PTHREAD_MUTEX_INITIALIZER;

const gl_context_kind gl_context_osmesa = { osmesa_create, osmesa_destroy, osmesa_enter,
                                            osmesa_leave,  osmesa_address, &osmesa_turn };
