/* SPDX-License-Identifier: MIT
 * See item_device.h. This is the only file beside item_buffer.c that knows OpenGL.
 */
#include "visibility/item_device.h"

#include "visibility/rays.h"

#include <pthread.h>

static const char *const VERTEX_SHADER = "#version 450\n"
                                         "layout(location=0) in vec3 position;\n"
                                         "layout(location=2) in uint own_id;\n"
                                         "uniform mat4 clip_from_scene;\n"
                                         "flat out uint last_id;\n"
                                         "void main() {\n"
                                         "    gl_Position = clip_from_scene * vec4(position, 1.0);\n"
                                         "    last_id = own_id;\n"
                                         "}\n";

static const char *const FRAGMENT_SHADER = "#version 450\n"
                                           "layout(location=0) out uint id;\n"
                                           "flat in uint last_id;\n"
                                           "uniform uint first_id;\n"
                                           "void main() { id = first_id + last_id; }\n";

static const char *const HOLED_VERTEX_SHADER = "#version 450\n"
                                               "layout(location=0) in vec3 position;\n"
                                               "layout(location=1) in vec3 coordinates;\n"
                                               "layout(location=2) in uint own_id;\n"
                                               "uniform mat4 clip_from_scene;\n"
                                               "out vec3 place;\n"
                                               "flat out uint last_id;\n"
                                               "void main() {\n"
                                               "    gl_Position = clip_from_scene * vec4(position, 1.0);\n"
                                               "    place = coordinates;\n"
                                               "    last_id = own_id;\n"
                                               "}\n";

static const char *const HOLED_FRAGMENT_SHADER =
    "#version 450\n"
    "layout(location=0) out uint id;\n"
    "in vec3 place;\n"
    "flat in uint last_id;\n"
    "uniform uint first_id;\n"
    "uniform float cutoff;\n"
    "uniform sampler2D alpha;\n"
    "void main() {\n"
    "    if (textureLod(alpha, place.xy, 0.0).r * place.z < cutoff) discard;\n"
    "    id = first_id + last_id;\n"
    "}\n";

static const char *const MARK_VERTEX_SHADER = "#version 450\n"
                                              "layout(location=0) in vec3 position;\n"
                                              "uniform mat4 clip_from_scene;\n"
                                              "void main() { gl_Position = clip_from_scene * vec4(position, 1.0); }\n";

static const char *const MARK_FRAGMENT_SHADER = "#version 450\n"
                                                "layout(location=0) out uint id;\n"
                                                "void main() { id = 0x80000000u; }\n";

const gl_context_kind *item_device_kind(item_backend backend) {
#if HEMIBAKE_OSMESA
    if (backend == ITEM_BACKEND_OSMESA || backend == ITEM_BACKEND_DEFAULT) return &gl_context_osmesa;
#endif
#if HEMIBAKE_EGL
    if (backend == ITEM_BACKEND_EGL || backend == ITEM_BACKEND_DEFAULT) return &gl_context_egl;
#endif
    (void)backend;
    return NULL;
}

bool item_backend_is_there(item_backend backend) {
    if (backend == ITEM_BACKEND_RAYS) return rays_are_there();
    return backend == ITEM_BACKEND_DEFAULT || item_device_kind(backend);
}

static bool load_functions(item_device *d) {
    bool all = true;
#define GL_LOAD(type, name)                                                                                            \
    d->gl.name = (type)d->kind->address(d->context, "gl" #name);                                                       \
    all = all && d->gl.name;
    GL_FUNCTIONS(GL_LOAD)
#undef GL_LOAD
    return all;
}

static bool create_program(const item_device *d, const char *vertex, const char *fragment, item_program *out) {
    const gl_functions *gl = &d->gl;
    GLuint program = gl->CreateProgram();
    const struct {
        GLenum type;
        const char *source;
    } stages[] = { { GL_VERTEX_SHADER, vertex }, { GL_FRAGMENT_SHADER, fragment } };
    for (int i = 0; i < 2; i++) {
        GLuint shader = gl->CreateShader(stages[i].type);
        gl->ShaderSource(shader, 1, &stages[i].source, NULL);
        gl->CompileShader(shader);
        gl->AttachShader(program, shader);
    }
    GLint linked = 0;
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    *out = (item_program){ program, gl->GetUniformLocation(program, "clip_from_scene"),
                           gl->GetUniformLocation(program, "first_id"), gl->GetUniformLocation(program, "cutoff") };
    return linked;
}

bool item_device_prepare_holes(item_device *d) {
    return d->mark.name || (create_program(d, HOLED_VERTEX_SHADER, HOLED_FRAGMENT_SHADER, &d->holed) &&
                            create_program(d, MARK_VERTEX_SHADER, MARK_FRAGMENT_SHADER, &d->mark));
}

static void set_state(const item_device *d) {
    d->gl.Enable(GL_DEPTH_TEST);
    d->gl.Enable(GL_DEPTH_CLAMP);
    d->gl.Enable(GL_POLYGON_OFFSET_FILL);
    d->gl.DepthFunc(GL_GREATER);
    d->gl.Disable(GL_DITHER);
    d->gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    d->gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    d->gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

static void create_buffers(item_device *d) {
    GLuint array;
    d->gl.GenVertexArrays(1, &array);
    d->gl.BindVertexArray(array);
    d->gl.GenBuffers(ITEM_BUFFERS, d->buffers);
    d->gl.BindBuffer(GL_ARRAY_BUFFER, d->buffers[ITEM_BUFFER_COORDINATES]);
    d->gl.VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, NULL);
    d->gl.BindBuffer(GL_ARRAY_BUFFER, d->buffers[ITEM_BUFFER_IDS]);
    d->gl.EnableVertexAttribArray(2);
    d->gl.VertexAttribIPointer(2, 1, GL_UNSIGNED_INT, 0, NULL);
    d->gl.BindBuffer(GL_ARRAY_BUFFER, d->buffers[ITEM_BUFFER_POSITIONS]);
    d->gl.EnableVertexAttribArray(0);
    d->gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
}

/* ---- textures ---- */

static GLuint create_texture(const gl_functions *gl, const alpha_mask_map *map) {
    static const GLint wraps[] = {
        [ALPHA_MASK_REPEAT] = GL_REPEAT, [ALPHA_MASK_CLAMP] = GL_CLAMP_TO_EDGE, [ALPHA_MASK_MIRROR] = GL_MIRRORED_REPEAT
    };
    GLuint name;
    gl->GenTextures(1, &name);
    gl->BindTexture(GL_TEXTURE_2D, name);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wraps[map->wrap[0]]);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wraps[map->wrap[1]]);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, (GLsizei)map->width, (GLsizei)map->height, 0, GL_RED, GL_UNSIGNED_BYTE,
                   map->alpha);
    return name;
}

GLuint item_device_texture(item_device *d, allocator *memory, const alpha_mask_map *map) {
    for (size_t i = 0; i < d->texture_count; i++)
        if (d->textures[i].map == map) return d->textures[i].name;
    item_texture *grown = block_resize(memory, d->textures, (d->texture_count + 1) * sizeof *grown);
    if (!grown) return 0;
    d->textures = grown;
    grown[d->texture_count] = (item_texture){ map, create_texture(&d->gl, map) };
    return grown[d->texture_count++].name;
}

/* ---- targets ---- */

static bool set_target_size(const item_device *d, item_target *t, int width, int height) {
    const gl_functions *gl = &d->gl;
    static const GLenum formats[] = { GL_R32UI, GL_DEPTH_COMPONENT32F };
    for (int i = 0; i < 2; i++) {
        gl->BindRenderbuffer(GL_RENDERBUFFER, t->renderbuffers[i]);
        gl->RenderbufferStorage(GL_RENDERBUFFER, formats[i], width, height);
    }
    gl->BindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, t->renderbuffers[0]);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t->renderbuffers[1]);
    t->width = width, t->height = height;
    return gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool item_device_bind(item_device *d, int width, int height) {
    for (int i = 0; i < d->target_count; i++) {
        const item_target *t = &d->targets[i];
        if (t->width != width || t->height != height) continue;
        d->gl.BindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
        return true;
    }
    item_target *t = &d->targets[ITEM_TARGETS_MAX - 1]; /* the last is given up where all are in use */
    if (d->target_count < ITEM_TARGETS_MAX) {
        t = &d->targets[d->target_count++];
        d->gl.GenFramebuffers(1, &t->framebuffer);
        d->gl.GenRenderbuffers(2, t->renderbuffers);
    }
    return set_target_size(d, t, width, height);
}

/* ---- devices ---- */

bool item_device_enter(item_device *d) {
    pthread_mutex_lock(d->kind->turn);
    if (d->kind->enter(d->context)) return true;
    pthread_mutex_unlock(d->kind->turn);
    return false;
}

void item_device_leave(item_device *d) {
    d->kind->leave(d->context);
    pthread_mutex_unlock(d->kind->turn);
}

void item_device_destroy(item_device *d) {
    if (d->context) {
        pthread_mutex_lock(d->kind->turn);
        d->kind->destroy(d->context);
        pthread_mutex_unlock(d->kind->turn);
    }
    block_free_all(d->textures, d);
}

static const char *fill(item_device *d) {
    if (!load_functions(d)) return "OpenGL lacks a function of 4.5";
    if (!create_program(d, VERTEX_SHADER, FRAGMENT_SHADER, &d->solid))
        return "OpenGL does not link the item-buffer program";
    create_buffers(d);
    set_state(d);
    return NULL;
}

item_device *item_device_create(allocator *memory, item_backend backend, const char **failure) {
    item_device *d = block_zeroed(memory, 1, sizeof *d);
    *failure = "out of memory";
    if (!d) return NULL;
    d->kind = item_device_kind(backend);
    *failure = "this build lacks the back end";
    if (d->kind) {
        pthread_mutex_lock(d->kind->turn);
        d->context = d->kind->create(memory, failure);
        if (!d->context) pthread_mutex_unlock(d->kind->turn);
    }
    if (d->context) *failure = fill(d);
    if (d->context && !*failure) return d;
    if (d->context) item_device_leave(d);
    item_device_destroy(d);
    return NULL;
}
