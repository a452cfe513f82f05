/* SPDX-License-Identifier: MIT
 * How does OpenGL draw an item buffer? An R32UI target in a frame buffer object, the primitive's number written by the
 * fragment shader, and a reversed float depth buffer (near / z, cleared to 0, greater wins), which is equally exact at
 * every distance. Depth is clamped, not clipped: with a near plane that cuts, a wall right beside the eye would be open
 * where it passes the plane.
 *
 * What has holes is drawn by a second program, which looks up the alpha of its texels and leaves out holes; and, where
 * pixels are marked, again as a whole, or-ing the mark into what is not nearer. Without holes there is neither.
 *
 * This is the only file of the core that knows OpenGL; contexts and addresses come from a gl_context_kind.
 */
#include "visibility/item_buffer.h"

#include "visibility/gl_context.h"
#include "visibility/overlap.h"

#include <GL/glcorearb.h>
#include <stdio.h>
#include <stdlib.h>

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
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                                                   \
    X(PFNGLDEPTHMASKPROC, DepthMask)                                                                                   \
    X(PFNGLDISABLEPROC, Disable)                                                                                       \
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
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                                                               \
    X(PFNGLVIEWPORTPROC, Viewport)

typedef struct gl_functions {
#define GL_MEMBER(type, name) type name;
    GL_FUNCTIONS(GL_MEMBER)
#undef GL_MEMBER
} gl_functions;

/* Triangles that follow each other, all of one layer (overlap.h) and with the same holes. */
typedef struct item_range {
    uint32_t first;
    GLsizei count;
    int layer;
    const cutout_map *holes; /* only the address and the cutoff outlive opening */
    GLuint texture;
    float cutoff;
} item_range;

/* A linked program and its uniforms, -1 where it has none. */
typedef struct item_program {
    GLuint name;
    GLint matrix, first_id, cutoff;
} item_program;

struct item_buffer {
    const gl_context_kind *kind;
    void *context;
    gl_functions gl;
    int width, height;
    item_program solid, holed, mark; /* the last two only where something has holes */
    item_range *ranges;
    size_t range_count;
    bool has_holes, marks_holes;
    uint32_t first_id;
    float near_plane;
};

/* A layer is set back by this much of the change of depth from pixel to pixel, because corners are snapped to a grid of
 * 1/256 of a pixel, differently in each triangle; and by so many roundings of the triangle's largest depth, which is
 * how far interpolation may be off. */
static const float LAYER_SLOPE = 1.0f / 32.0f, LAYER_ROUNDINGS = 8.0f;

static const char *const VERTEX_SHADER = "#version 450\n"
                                         "layout(location=0) in vec3 position;\n"
                                         "uniform mat4 clip_from_scene;\n"
                                         "void main() { gl_Position = clip_from_scene * vec4(position, 1.0); }\n";

static const char *const FRAGMENT_SHADER = "#version 450\n"
                                           "layout(location=0) out uint id;\n"
                                           "uniform uint first_id;\n"
                                           "void main() { id = first_id + uint(gl_PrimitiveID); }\n";

static const char *const HOLED_VERTEX_SHADER = "#version 450\n"
                                               "layout(location=0) in vec3 position;\n"
                                               "layout(location=1) in vec3 coordinates;\n"
                                               "uniform mat4 clip_from_scene;\n"
                                               "out vec3 place;\n"
                                               "void main() {\n"
                                               "    gl_Position = clip_from_scene * vec4(position, 1.0);\n"
                                               "    place = coordinates;\n"
                                               "}\n";

static const char *const HOLED_FRAGMENT_SHADER =
    "#version 450\n"
    "layout(location=0) out uint id;\n"
    "in vec3 place;\n"
    "uniform uint first_id;\n"
    "uniform float cutoff;\n"
    "uniform sampler2D alpha;\n"
    "void main() {\n"
    "    if (textureLod(alpha, place.xy, 0.0).r * place.z < cutoff) discard;\n"
    "    id = first_id + uint(gl_PrimitiveID);\n"
    "}\n";

static const char *const MARK_FRAGMENT_SHADER = "#version 450\n"
                                                "layout(location=0) out uint id;\n"
                                                "void main() { id = 0x80000000u; }\n";

static const gl_context_kind *kind_of(item_backend backend) {
#if HEMIBAKE_OSMESA
    if (backend == ITEM_BACKEND_OSMESA || backend == ITEM_BACKEND_DEFAULT) return &gl_context_osmesa;
#endif
#if HEMIBAKE_EGL
    if (backend == ITEM_BACKEND_EGL || backend == ITEM_BACKEND_DEFAULT) return &gl_context_egl;
#endif
    (void)backend;
    return NULL;
}

static bool load_functions(item_buffer *b) {
    bool all = true;
#define GL_LOAD(type, name)                                                                                            \
    b->gl.name = (type)b->kind->address(b->context, "gl" #name);                                                       \
    all = all && b->gl.name;
    GL_FUNCTIONS(GL_LOAD)
#undef GL_LOAD
    return all;
}

static bool create_program(const item_buffer *b, const char *vertex, const char *fragment, item_program *out) {
    const gl_functions *gl = &b->gl;
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

static bool create_programs(item_buffer *b) {
    if (!create_program(b, VERTEX_SHADER, FRAGMENT_SHADER, &b->solid)) return false;
    return !b->has_holes || (create_program(b, HOLED_VERTEX_SHADER, HOLED_FRAGMENT_SHADER, &b->holed) &&
                             create_program(b, VERTEX_SHADER, MARK_FRAGMENT_SHADER, &b->mark));
}

static GLuint create_texture(const item_buffer *b, const cutout_map *map) {
    static const GLint wraps[] = {
        [CUTOUT_REPEAT] = GL_REPEAT, [CUTOUT_CLAMP] = GL_CLAMP_TO_EDGE, [CUTOUT_MIRROR] = GL_MIRRORED_REPEAT
    };
    const gl_functions *gl = &b->gl;
    GLuint name;
    gl->GenTextures(1, &name);
    gl->BindTexture(GL_TEXTURE_2D, name);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wraps[map->wrap[0]]);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wraps[map->wrap[1]]);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, (GLsizei)map->width, (GLsizei)map->height, 0, GL_RED, GL_UNSIGNED_BYTE,
                   map->alpha);
    return name;
}

/* Ranges that share a map share its texture. */
static void upload_holes(item_buffer *b) {
    for (size_t i = 0; i < b->range_count; i++) {
        item_range *r = &b->ranges[i];
        if (!r->holes) continue;
        for (size_t k = 0; k < i && !r->texture; k++)
            if (b->ranges[k].holes == r->holes) r->texture = b->ranges[k].texture;
        if (!r->texture) r->texture = create_texture(b, r->holes);
        r->cutoff = (float)r->holes->cutoff;
    }
}

static void upload(item_buffer *b, const item_geometry *g) {
    const gl_functions *gl = &b->gl;
    GLuint array, buffers[3];
    gl->GenVertexArrays(1, &array);
    gl->BindVertexArray(array);
    gl->GenBuffers(b->has_holes ? 3 : 2, buffers);
    gl->BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(g->vertex_count * 3 * sizeof(float)), g->positions, GL_STATIC_DRAW);
    gl->EnableVertexAttribArray(0);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
    if (b->has_holes) {
        gl->BindBuffer(GL_ARRAY_BUFFER, buffers[2]);
        gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(g->vertex_count * 3 * sizeof(float)), g->coordinates,
                       GL_STATIC_DRAW);
        gl->EnableVertexAttribArray(1);
        gl->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, NULL);
        upload_holes(b);
    }
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    gl->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(g->triangle_count * 3 * sizeof(uint32_t)), g->indices,
                   GL_STATIC_DRAW);
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
    b->gl.Enable(GL_DEPTH_TEST);
    b->gl.Enable(GL_DEPTH_CLAMP);
    b->gl.Enable(GL_POLYGON_OFFSET_FILL);
    b->gl.DepthFunc(GL_GREATER);
    b->gl.Disable(GL_DITHER);
    b->gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    b->gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

static const cutout_map *holes_of(const item_geometry *g, size_t t) {
    return g->coordinates ? g->holes[t] : NULL;
}

static bool find_ranges(item_buffer *b, const item_geometry *g) {
    size_t n = g->triangle_count, count = 0;
    uint8_t *layers = malloc(n + 1);
    if (!layers || !overlap_find_layers(g->positions, g->indices, n, layers)) {
        free(layers);
        return false;
    }
    for (size_t t = 0; t < n; t++)
        count += t == 0 || layers[t] != layers[t - 1] || holes_of(g, t) != holes_of(g, t - 1);
    b->ranges = malloc((count + 1) * sizeof *b->ranges);
    for (size_t t = 0; b->ranges && t < n; t++) {
        const cutout_map *holes = holes_of(g, t);
        if (t == 0 || layers[t] != layers[t - 1] || holes != holes_of(g, t - 1))
            b->ranges[b->range_count++] = (item_range){ .first = (uint32_t)t, .layer = layers[t], .holes = holes };
        b->ranges[b->range_count - 1].count++;
        b->has_holes = b->has_holes || holes;
    }
    free(layers);
    return b->ranges;
}

/* The rest of item_buffer_open, inside the context. */
static const char *fill(item_buffer *b, const item_buffer_desc *desc) {
    if (!load_functions(b)) return "OpenGL lacks a function of 4.5";
    if (!create_programs(b)) return "OpenGL does not link the item-buffer program";
    if (!create_target(b)) return "OpenGL gives no R32UI frame buffer of the size";
    upload(b, desc->geometry);
    set_state(b);
    return b->gl.GetError() == GL_NO_ERROR ? NULL : "OpenGL failed to take the scene";
}

static const char *open_in(item_buffer *b, const item_buffer_desc *desc) {
    const char *failure;
    if (!b) return "out of memory";
    b->first_id = desc->first_id ? desc->first_id : 1;
    b->marks_holes = desc->marks_holes;
    if (desc->geometry->triangle_count > INT32_MAX / 3) return "more triangles than OpenGL can draw at once";
    if (desc->geometry->triangle_count > (uint64_t)UINT32_MAX - b->first_id + 1) return "more triangles than ids";
    b->kind = kind_of(desc->backend);
    if (b->marks_holes && desc->geometry->triangle_count >= ITEM_MARK - b->first_id) return "more triangles than ids";
    if (!b->kind) return "this build lacks the back end";
    if (!find_ranges(b, desc->geometry)) return "out of memory";
    b->width = desc->width, b->height = desc->height;
    b->context = b->kind->create(&failure);
    if (!b->context) return failure;
    failure = fill(b, desc);
    b->kind->leave(b->context);
    return failure;
}

item_buffer *item_buffer_open(const item_buffer_desc *desc, char *message, size_t message_size) {
    item_buffer *b = calloc(1, sizeof *b);
    const char *failure = open_in(b, desc);
    if (!failure) return b;
    snprintf(message, message_size, "%s", failure);
    item_buffer_destroy(b);
    return NULL;
}

item_buffer *item_buffer_create(const item_geometry *geometry, int width, int height, char *message,
                                size_t message_size) {
    const item_buffer_desc desc = { .geometry = geometry, .width = width, .height = height };
    return item_buffer_open(&desc, message, message_size);
}

void item_buffer_destroy(item_buffer *b) {
    if (!b) return;
    if (b->context) b->kind->destroy(b->context);
    free(b->ranges);
    free(b);
}

static double dot(const float a[3], const float b[3]) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Column-major rows x, y, z, w of the clip position:
 *   w = distance z along forward, x = z s' and y = z t' with s', t' in [-1, 1] over the view, z = near (depth near / w)
 * In double, so that the eye is where it is said to be to one rounding of its coordinates. */
static void clip_from_scene(float m[16], const item_view *v, float near_plane) {
    double s_scale = 2.0 / ((double)v->s_high - v->s_low), t_scale = 2.0 / ((double)v->t_high - v->t_low);
    double s_mid = 0.5 * ((double)v->s_low + v->s_high), t_mid = 0.5 * ((double)v->t_low + v->t_high);
    double eye[3] = { dot(v->right, v->eye), dot(v->up, v->eye), dot(v->forward, v->eye) };
    for (int k = 0; k < 4; k++) {
        double r = k < 3 ? v->right[k] : -eye[0], u = k < 3 ? v->up[k] : -eye[1], f = k < 3 ? v->forward[k] : -eye[2];
        m[4 * k + 0] = (float)(s_scale * (r - s_mid * f));
        m[4 * k + 1] = (float)(t_scale * (u - t_mid * f));
        m[4 * k + 2] = k < 3 ? 0.0f : near_plane;
        m[4 * k + 3] = (float)f;
    }
}

/* The same for a parallel view: w = 1, x = s', y = t', z = 1 - distance / depth. */
static void clip_from_scene_parallel(float m[16], const item_view *v) {
    double s_scale = 2.0 / ((double)v->s_high - v->s_low), t_scale = 2.0 / ((double)v->t_high - v->t_low);
    double s_mid = 0.5 * ((double)v->s_low + v->s_high), t_mid = 0.5 * ((double)v->t_low + v->t_high);
    for (int k = 0; k < 3; k++) {
        m[4 * k + 0] = (float)(s_scale * v->right[k]);
        m[4 * k + 1] = (float)(t_scale * v->up[k]);
        m[4 * k + 2] = (float)(-v->forward[k] / (double)v->depth);
        m[4 * k + 3] = 0.0f;
    }
    m[12] = (float)(-s_scale * (dot(v->right, v->eye) + s_mid));
    m[13] = (float)(-t_scale * (dot(v->up, v->eye) + t_mid));
    m[14] = (float)(1.0 + dot(v->forward, v->eye) / (double)v->depth);
    m[15] = 1.0f;
}

/* gl_PrimitiveID counts from 0 in every draw. Depth is reversed, so setting back makes it less. */
static void draw_range(const item_buffer *b, const item_program *program, const item_range *r) {
    const float back = (float)-r->layer;
    b->gl.Uniform1ui(program->first_id, b->first_id + r->first);
    b->gl.Uniform1f(program->cutoff, r->cutoff);
    if (r->texture) b->gl.BindTexture(GL_TEXTURE_2D, r->texture);
    b->gl.PolygonOffset(back * LAYER_SLOPE, back * LAYER_ROUNDINGS);
    b->gl.DrawElements(GL_TRIANGLES, 3 * r->count, GL_UNSIGNED_INT, (const char *)NULL + 12 * (size_t)r->first);
}

static void set_edges(const item_buffer *b, item_edges edges, bool cull) {
    bool none = edges == ITEM_EDGES_NONE;
    (none && !cull ? b->gl.Disable : b->gl.Enable)(GL_CULL_FACE);
    b->gl.CullFace(edges == ITEM_EDGES_BACK ? GL_FRONT : GL_BACK);
    b->gl.PolygonMode(GL_FRONT_AND_BACK, none ? GL_FILL : GL_LINE);
}

static void draw_ranges(const item_buffer *b, const item_program *program, const float m[16], bool solid, bool holed) {
    b->gl.UseProgram(program->name);
    b->gl.UniformMatrix4fv(program->matrix, 1, GL_FALSE, m);
    for (size_t i = 0; i < b->range_count; i++)
        if (b->ranges[i].texture ? holed : solid) draw_range(b, program, &b->ranges[i]);
}

static void draw_marks(const item_buffer *b, const float m[16]) {
    b->gl.Enable(GL_COLOR_LOGIC_OP);
    b->gl.LogicOp(GL_OR);
    b->gl.DepthMask(GL_FALSE);
    b->gl.DepthFunc(GL_GEQUAL);
    draw_ranges(b, &b->mark, m, false, true);
    b->gl.DepthFunc(GL_GREATER);
    b->gl.DepthMask(GL_TRUE);
    b->gl.Disable(GL_COLOR_LOGIC_OP);
}

static void draw_view(item_buffer *b, const item_view *v, bool cull) {
    float m[16];
    if (v->parallel)
        clip_from_scene_parallel(m, v);
    else
        clip_from_scene(m, v, b->near_plane);
    set_edges(b, v->edges, cull);
    b->gl.Viewport(v->x, v->y, v->width, v->height);
    bool whole = v->edges != ITEM_EDGES_NONE;
    draw_ranges(b, &b->solid, m, true, whole);
    if (!b->has_holes) return;
    if (!whole) draw_ranges(b, &b->holed, m, false, true);
    if (b->marks_holes) draw_marks(b, m);
}

bool item_buffer_draw(item_buffer *b, const item_view *views, int view_count, int width, int height, bool cull,
                      uint32_t *ids) {
    const GLuint sky[4] = { 0, 0, 0, 0 };
    const GLfloat far[1] = { 0.0f };
    if (width > b->width || height > b->height || !b->kind->enter(b->context)) return false;
    b->gl.ClearBufferuiv(GL_COLOR, 0, sky);
    b->gl.ClearBufferfv(GL_DEPTH, 0, far);
    for (int i = 0; i < view_count; i++) draw_view(b, &views[i], cull);
    b->gl.ReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids);
    bool drawn = b->gl.GetError() == GL_NO_ERROR;
    b->kind->leave(b->context);
    return drawn;
}
