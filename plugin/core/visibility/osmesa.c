/* SPDX-License-Identifier: MIT
 * How does OSMesa draw an item buffer? An R32UI target in a frame buffer object, the primitive's number written by the
 * fragment shader, and a reversed float depth buffer (near / z, cleared to 0, greater wins), which is equally exact at
 * every distance.
 *
 * This is the only file of the core that knows OpenGL. Mesa 25.1 dropped OSMesa; another back end replaces this file.
 */
#define GL_GLEXT_PROTOTYPES 0
#include "visibility/item_buffer.h"

#include <GL/osmesa.h>
/* osmesa.h brings gl.h; the rest of OpenGL 4.5 comes from the context. */
#include <GL/glext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* X(type, name): every entry point beyond OpenGL 1.1. */
#define GL_FUNCTIONS(X)                                                                                                \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                                             \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                                             \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                                           \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                                           \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                                             \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                                               \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                                             \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                                                 \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)                                                                 \
    X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                                                                     \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                                                                       \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                                       \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                                                                                 \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                                                 \
    X(PFNGLBUFFERDATAPROC, BufferData)                                                                                 \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)                                                       \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                                                               \
    X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                                                                     \
    X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                                                                     \
    X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)                                                               \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                                                                       \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                                       \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)                                                       \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)                                                         \
    X(PFNGLCLEARBUFFERUIVPROC, ClearBufferuiv)                                                                         \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)                                                                           \
    X(PFNGLCLIPCONTROLPROC, ClipControl)

typedef struct gl_functions {
#define GL_MEMBER(type, name) type name;
    GL_FUNCTIONS(GL_MEMBER)
#undef GL_MEMBER
} gl_functions;

struct item_buffer {
    OSMesaContext context;
    gl_functions gl;
    int width, height;
    GLint matrix_location;
    GLsizei index_count;
    float near_plane;
    unsigned char pixel[64]; /* OSMesa wants a colour buffer of its own; nothing is drawn there */
};

static const char *const VERTEX_SHADER = "#version 450\n"
                                         "layout(location=0) in vec3 position;\n"
                                         "uniform mat4 clip_from_scene;\n"
                                         "void main() { gl_Position = clip_from_scene * vec4(position, 1.0); }\n";

static const char *const FRAGMENT_SHADER = "#version 450\n"
                                           "layout(location=0) out uint id;\n"
                                           "void main() { id = uint(gl_PrimitiveID) + 1u; }\n";

static bool load_functions(gl_functions *gl) {
    bool all = true;
    OSMESAproc address;
    /* Copied as bytes: the generic function pointer of OSMesa is none that C lets one cast quietly. */
#define LOAD_FUNCTION(type, name)                                                                                      \
    address = OSMesaGetProcAddress("gl" #name);                                                                        \
    memcpy(&gl->name, &address, sizeof address);                                                                       \
    all = all && address;
    GL_FUNCTIONS(LOAD_FUNCTION)
#undef LOAD_FUNCTION
    return all;
}

static bool create_context(item_buffer *b) {
    const int attributes[] = { OSMESA_FORMAT,          OSMESA_RGBA, OSMESA_DEPTH_BITS,            0,
                               OSMESA_PROFILE,         OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 4,
                               OSMESA_CONTEXT_MINOR_VERSION, 5, 0 };
    b->context = OSMesaCreateContextAttribs(attributes, NULL);
    return b->context && OSMesaMakeCurrent(b->context, b->pixel, GL_UNSIGNED_BYTE, 1, 1);
}

static bool create_program(item_buffer *b) {
    const gl_functions *gl = &b->gl;
    GLuint program = gl->CreateProgram();
    const struct {
        GLenum type;
        const char *source;
    } stages[] = { { GL_VERTEX_SHADER, VERTEX_SHADER }, { GL_FRAGMENT_SHADER, FRAGMENT_SHADER } };
    for (int i = 0; i < 2; i++) {
        GLuint shader = gl->CreateShader(stages[i].type);
        gl->ShaderSource(shader, 1, &stages[i].source, NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
    }
    GLint linked = 0;
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    gl->UseProgram(program);
    b->matrix_location = gl->GetUniformLocation(program, "clip_from_scene");
    return linked;
}

static void upload(item_buffer *b, const item_geometry *g) {
    const gl_functions *gl = &b->gl;
    GLuint array, buffers[2];
    gl->GenVertexArrays(1, &array);
    gl->BindVertexArray(array);
    gl->GenBuffers(2, buffers);
    gl->BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(g->vertex_count * 3 * sizeof(float)), g->positions, GL_STATIC_DRAW);
    gl->EnableVertexAttribArray(0);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(g->triangle_count * 3 * sizeof(uint32_t)), g->indices,
                   GL_STATIC_DRAW);
    b->index_count = (GLsizei)(3 * g->triangle_count);
    b->near_plane = g->near_plane;
}

static bool create_target(item_buffer *b) {
    const gl_functions *gl = &b->gl;
    GLuint framebuffer, targets[2];
    gl->GenFramebuffers(1, &framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl->GenRenderbuffers(2, targets);
    gl->BindRenderbuffer(GL_RENDERBUFFER, targets[0]);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_R32UI, b->width, b->height);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, targets[0]);
    gl->BindRenderbuffer(GL_RENDERBUFFER, targets[1]);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, b->width, b->height);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, targets[1]);
    return gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static void set_state(const item_buffer *b) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDisable(GL_DITHER);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    b->gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

static const char *create(item_buffer *b, const item_geometry *geometry) {
    if (geometry->triangle_count > INT32_MAX / 3) return "more triangles than OpenGL can draw at once";
    if (!create_context(b)) return "OSMesa gives no OpenGL 4.5 core context";
    if (!load_functions(&b->gl)) return "OSMesa lacks an OpenGL 4.5 function";
    if (!create_program(b)) return "OSMesa does not link the item-buffer program";
    if (!create_target(b)) return "OSMesa gives no R32UI frame buffer of the size";
    upload(b, geometry);
    set_state(b);
    return glGetError() == GL_NO_ERROR ? NULL : "OSMesa failed to take the scene";
}

item_buffer *item_buffer_create(const item_geometry *geometry, int width, int height, char *message,
                                size_t message_size) {
    item_buffer *b = calloc(1, sizeof *b);
    if (b) b->width = width, b->height = height;
    const char *failure = b ? create(b, geometry) : "out of memory";
    if (!failure) return b;
    snprintf(message, message_size, "%s", failure);
    item_buffer_destroy(b);
    return NULL;
}

void item_buffer_destroy(item_buffer *b) {
    if (!b) return;
    if (b->context) OSMesaDestroyContext(b->context);
    free(b);
}

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Column-major rows x, y, z, w of the clip position:
 *   w = distance z along forward, x = z s' and y = z t' with s', t' in [-1, 1] over the view, z = near (depth near / w) */
static void clip_from_scene(float m[16], const item_view *v, float near_plane) {
    float s_scale = 2.0f / (v->s_high - v->s_low), t_scale = 2.0f / (v->t_high - v->t_low);
    float s_mid = 0.5f * (v->s_low + v->s_high), t_mid = 0.5f * (v->t_low + v->t_high);
    float eye[3] = { dot(v->right, v->eye), dot(v->up, v->eye), dot(v->forward, v->eye) };
    for (int k = 0; k < 4; k++) {
        float r = k < 3 ? v->right[k] : -eye[0], u = k < 3 ? v->up[k] : -eye[1], f = k < 3 ? v->forward[k] : -eye[2];
        m[4 * k + 0] = s_scale * (r - s_mid * f);
        m[4 * k + 1] = t_scale * (u - t_mid * f);
        m[4 * k + 2] = k < 3 ? 0.0f : near_plane;
        m[4 * k + 3] = f;
    }
}

bool item_buffer_draw(item_buffer *b, const item_view *views, int view_count, int width, int height, bool cull,
                      uint32_t *ids) {
    const GLuint sky[4] = { 0, 0, 0, 0 };
    const GLfloat far[1] = { 0.0f };
    if (width > b->width || height > b->height) return false;
    if (!OSMesaMakeCurrent(b->context, b->pixel, GL_UNSIGNED_BYTE, 1, 1)) return false;
    b->gl.ClearBufferuiv(GL_COLOR, 0, sky);
    b->gl.ClearBufferfv(GL_DEPTH, 0, far);
    if (cull)
        glEnable(GL_CULL_FACE);
    else
        glDisable(GL_CULL_FACE);
    for (int i = 0; i < view_count; i++) {
        float m[16];
        clip_from_scene(m, &views[i], b->near_plane);
        b->gl.UniformMatrix4fv(b->matrix_location, 1, GL_FALSE, m);
        glViewport(views[i].x, views[i].y, views[i].width, views[i].height);
        glDrawElements(GL_TRIANGLES, b->index_count, GL_UNSIGNED_INT, NULL);
    }
    glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids);
    return glGetError() == GL_NO_ERROR;
}
