/* SPDX-License-Identifier: MIT
 * What does every item buffer draw with? A device: an OpenGL context, the addresses of OpenGL's functions, the programs
 * that write ids, and frame buffers. To make one costs 10 ms, most of it malloc and LLVM, and another 20 where Mesa
 * finds no compiled shaders on disk; so a device that an item buffer has no more use for waits in a pool for the next.
 *
 * A device belongs to nobody while it waits, and its context is current in no thread. Devices of one pool are one of
 * another's equals: every item buffer uploads its own geometry and sets all state it draws with.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_ITEM_DEVICE_H
#define HEMIBAKE_CORE_VISIBILITY_ITEM_DEVICE_H

#include "visibility/gl_context.h"
#include "visibility/item_buffer.h"

#include <GL/glcorearb.h>

/* X(type, name) */
#define GL_FUNCTIONS(X)                                                                                                \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                                             \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                                                 \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                                       \
    X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                                                                     \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                                                                               \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                                       \
    X(PFNGLBUFFERDATAPROC, BufferData)                                                                                 \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)                                                         \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)                                                                           \
    X(PFNGLCLEARBUFFERUIVPROC, ClearBufferuiv)                                                                         \
    X(PFNGLCLIPCONTROLPROC, ClipControl)                                                                               \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                                           \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                                           \
    X(PFNGLCULLFACEPROC, CullFace)                                                                                     \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                                             \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                                                 \
    X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                                                               \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                                         \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                                                   \
    X(PFNGLDEPTHMASKPROC, DepthMask)                                                                                   \
    X(PFNGLDISABLEPROC, Disable)                                                                                       \
    X(PFNGLDISABLEVERTEXATTRIBARRAYPROC, DisableVertexAttribArray)                                                     \
    X(PFNGLDRAWELEMENTSPROC, DrawElements)                                                                             \
    X(PFNGLENABLEPROC, Enable)                                                                                         \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)                                                       \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)                                                       \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                                                                                 \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                                                                       \
    X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                                                                     \
    X(PFNGLGENTEXTURESPROC, GenTextures)                                                                               \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                                                                       \
    X(PFNGLGETERRORPROC, GetError)                                                                                     \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                                             \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                                                                 \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                                               \
    X(PFNGLLOGICOPPROC, LogicOp)                                                                                       \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                                               \
    X(PFNGLPOLYGONMODEPROC, PolygonMode)                                                                               \
    X(PFNGLPOLYGONOFFSETPROC, PolygonOffset)                                                                           \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                                                 \
    X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)                                                               \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                                             \
    X(PFNGLTEXIMAGE2DPROC, TexImage2D)                                                                                 \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)                                                                           \
    X(PFNGLUNIFORM1FPROC, Uniform1f)                                                                                   \
    X(PFNGLUNIFORM1UIPROC, Uniform1ui)                                                                                 \
    X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                                                                     \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                                                 \
    X(PFNGLVERTEXATTRIBIPOINTERPROC, VertexAttribIPointer)                                                             \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                                                               \
    X(PFNGLVIEWPORTPROC, Viewport)

typedef struct gl_functions {
#define GL_MEMBER(type, name) type name;
    GL_FUNCTIONS(GL_MEMBER)
#undef GL_MEMBER
} gl_functions;

/* An R32UI frame buffer with depth, of a size. */
typedef struct item_target {
    GLuint framebuffer, renderbuffers[2];
    int width, height;
} item_target;

/* A linked program and its uniforms, -1 where it has none. */
typedef struct item_program {
    GLuint name;
    GLint matrix, first_id, cutoff;
} item_program;

/* What is cut out of triangles. */
typedef struct item_texture {
    const alpha_mask_map *map; /* only its address outlives item_device_texture */
    GLuint name;
} item_texture;

/* Clearing costs as much as a target is large, and hemi-cubes of a bake have up to three sizes. */
enum { ITEM_TARGETS_MAX = 4 };

/* What of drawn_triangles.h is where. */
enum {
    ITEM_BUFFER_POSITIONS,
    ITEM_BUFFER_COORDINATES,
    ITEM_BUFFER_IDS,
    ITEM_BUFFER_INDICES, /* of all triangles */
    ITEM_BUFFER_KEPT,    /* of those in a view */
    ITEM_BUFFERS
};

typedef struct item_device {
    const gl_context_kind *kind;
    void *context;
    gl_functions gl;
    item_target targets[ITEM_TARGETS_MAX];
    int target_count;
    item_program solid, holed, mark; /* the last two once something had holes */
    GLuint buffers[ITEM_BUFFERS];
    item_texture *textures; /* of the item buffer that has the device */
    size_t texture_count;
    struct item_device *next; /* in a pool */
} item_device;

/* Makes the context current, or none; between them no other thread calls this OpenGL. */
bool item_device_enter(item_device *d);
void item_device_leave(item_device *d);

/* NULL: the build lacks the back end, or it is rays. */
const gl_context_kind *item_device_kind(item_backend backend);

/* Its context is current. NULL with *failure set. */
item_device *item_device_create(allocator *memory, item_backend backend, const char **failure);
void item_device_destroy(item_device *d);

/* A waiting device of the pool, or a new one from memory; pool may be NULL. NULL with *failure set. The context is
 * current. */
item_device *item_device_take(item_pool *pool, allocator *memory, item_backend backend, const char **failure);

/* Back to the pool, or gone. The context is not current. */
void item_device_give(item_pool *pool, item_device *d);

/* What an item buffer of the pool is drawn by: never DEFAULT. pool may be NULL. */
item_backend item_pool_backend(item_pool *pool, item_backend asked);

/* Has nobody asked for a back end, so that another may draw where one fails? */
bool item_pool_may_choose(const item_pool *pool, item_backend asked);

/* Ends an item buffer but not its device, which it returns; NULL by rays. */
item_device *item_buffer_release(item_buffer *b);

/* Binds a target of just this size; false if OpenGL gives none. */
bool item_device_bind(item_device *d, int width, int height);

/* Makes the programs for what has holes, if there are none yet; false if OpenGL does not link them. */
bool item_device_prepare_holes(item_device *d);

/* The texture of an alpha map; 0 when out of memory. */
GLuint item_device_texture(item_device *d, allocator *memory, const alpha_mask_map *map);

#endif
