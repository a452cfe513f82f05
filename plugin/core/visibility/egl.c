/* SPDX-License-Identifier: MIT
 * How does EGL give an OpenGL context without a window? On Mesa's surfaceless platform
 * [EGL_MESA_platform_surfaceless, EGL_KHR_surfaceless_context, EGL_KHR_no_config_context]: a context with no surface at
 * all, which draws to frame buffer objects alone. Mesa takes a graphics card if it may open one, and its software
 * rasteriser otherwise.
 *
 * libEGL is loaded when the first context is made, so a program that never asks for it runs without. Neither the
 * library nor the display is ever let go: EGL has one display a process, and to terminate it ends the contexts of all
 * threads.
 *
 * This is the only file of the core that knows EGL.
 */
#include "visibility/gl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <string.h>

/* X(type, name) */
#define EGL_FUNCTIONS(X)                                                                                               \
    X(PFNEGLBINDAPIPROC, BindAPI)                                                                                      \
    X(PFNEGLCREATECONTEXTPROC, CreateContext)                                                                          \
    X(PFNEGLDESTROYCONTEXTPROC, DestroyContext)                                                                        \
    X(PFNEGLGETPLATFORMDISPLAYPROC, GetPlatformDisplay)                                                                \
    X(PFNEGLGETPROCADDRESSPROC, GetProcAddress)                                                                        \
    X(PFNEGLINITIALIZEPROC, Initialize)                                                                                \
    X(PFNEGLMAKECURRENTPROC, MakeCurrent)                                                                              \
    X(PFNEGLQUERYSTRINGPROC, QueryString)

typedef struct egl_context {
#define EGL_MEMBER(type, name) type name;
    EGL_FUNCTIONS(EGL_MEMBER)
#undef EGL_MEMBER
    EGLDisplay display;
    EGLContext context;
} egl_context;

static bool egl_load(egl_context *c) {
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL), *address;
    bool all = library != NULL;
    /* Copied as bytes: C has no cast from an object pointer to a function pointer. */
#define EGL_LOAD(type, name)                                                                                           \
    address = all ? dlsym(library, "egl" #name) : NULL;                                                                \
    memcpy(&c->name, &address, sizeof address);                                                                        \
    all = all && address;
    EGL_FUNCTIONS(EGL_LOAD)
#undef EGL_LOAD
    return all;
}

static bool egl_has(const char *extensions, const char *name) {
    size_t length = strlen(name);
    for (const char *at = extensions; at && (at = strstr(at, name)); at += length)
        if ((at == extensions || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) return true;
    return false;
}

static bool egl_open_display(egl_context *c) {
    if (!egl_has(c->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless")) return false;
    c->display = c->GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, NULL, NULL);
    if (c->display == EGL_NO_DISPLAY || !c->Initialize(c->display, NULL, NULL)) return false;
    const char *extensions = c->QueryString(c->display, EGL_EXTENSIONS);
    return egl_has(extensions, "EGL_KHR_surfaceless_context") && egl_has(extensions, "EGL_KHR_no_config_context");
}

static bool egl_enter(void *context) {
    egl_context *c = context;
    return c->MakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context);
}

static void egl_leave(void *context) {
    egl_context *c = context;
    c->MakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static void egl_destroy(void *context) {
    egl_context *c = context;
    if (c->context) c->DestroyContext(c->display, c->context);
    block_free(c);
}

static bool egl_create_context(egl_context *c) {
    static const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,        EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE,
    };
    if (!c->BindAPI(EGL_OPENGL_API)) return false;
    c->context = c->CreateContext(c->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    return c->context != EGL_NO_CONTEXT && egl_enter(c);
}

static void *egl_create(allocator *memory, const char **failure) {
    egl_context *c = block_zeroed(memory, 1, sizeof *c);
    *failure = NULL;
    if (!c)
        *failure = "out of memory";
    else if (!egl_load(c))
        *failure = "libEGL.so.1 is not installed, or is older than EGL 1.5";
    else if (!egl_open_display(c))
        *failure = "EGL has no surfaceless platform";
    else if (!egl_create_context(c))
        *failure = "EGL gives no OpenGL 4.5 core context";
    if (!*failure) return c;
    if (c) egl_destroy(c);
    return NULL;
}

static gl_address egl_address(void *context, const char *name) {
    egl_context *c = context;
    return c->GetProcAddress(name);
}

/* As the screen is, of the process. */
static pthread_mutex_t egl_turn = PTHREAD_MUTEX_INITIALIZER;

const gl_context_kind gl_context_egl = { egl_create, egl_destroy, egl_enter, egl_leave, egl_address, &egl_turn };
