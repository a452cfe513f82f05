/* SPDX-License-Identifier: MIT
 * How does OpenGL draw an item buffer? An R32UI target in a frame buffer object, a triangle's id written by the
 * fragment shader, and a reversed float depth buffer (near / z, cleared to 0, greater wins), which is equally exact at
 * every distance. Depth is clamped, not clipped: with a near plane that cuts, a wall right beside the eye would be open
 * where it passes the plane.
 *
 * What has holes is drawn by a second program, which looks up the alpha of its texels and leaves out holes; and, where
 * pixels are marked, again as a whole, or-ing the mark into what is not nearer. Without holes there is neither.
 *
 * This file and item_device.c, which makes what is drawn with, are the only ones of the core that know OpenGL.
 */
#include "visibility/item_buffer.h"

#include "geometry/vec3.h"
#include "scene/coplanar_overlap.h"
#include "visibility/drawn_triangles.h"
#include "visibility/item_device.h"
#include "visibility/ray_items.h"

#include <stdio.h>
#include <string.h>

static const char NO_MEMORY[] = "out of memory";

/* All triangles of one layer (coplanar_overlap.h) with the same holes: what one draw can draw. */
typedef struct item_range {
    uint32_t first, count;
    int layer;
    const alpha_mask_map *holes; /* only the address and the cutoff outlive opening */
    GLuint texture;              /* 0: none */
    float cutoff;
} item_range;

/* What of a range a view may show: triangles of one of the two index buffers. */
typedef struct item_share {
    size_t first, count;
} item_share;

struct item_buffer {
    ray_items *rays; /* NULL: OpenGL draws */
    item_device *device;
    item_pool *pool;
    int width, height;
    item_range *ranges;
    size_t range_count;
    item_share *shares; /* shares[view*range_count+range] */
    size_t share_capacity;
    bool has_holes, marks_holes;
    uint32_t first_id;
    drawn_triangles triangles;
    float near_plane;
};

/* A layer is set back by this much of the change of depth from pixel to pixel, because corners are snapped to a grid of
 * 1/256 of a pixel, differently in each triangle; and by so many roundings of the triangle's largest depth, which is
 * how far interpolation may be off. */
static const float LAYER_SLOPE = 1.0f / 32.0f, LAYER_ROUNDINGS = 8.0f;

static void give(const item_buffer *b, int buffer, size_t bytes, const void *data) {
    b->device->gl.BindBuffer(GL_ARRAY_BUFFER, b->device->buffers[buffer]);
    b->device->gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
}

static const char *upload_holes(item_buffer *b, const item_buffer_desc *desc) {
    const gl_functions *gl = &b->device->gl;
    if (!b->has_holes) {
        gl->DisableVertexAttribArray(1);
        return NULL;
    }
    if (!item_device_prepare_holes(b->device)) return "OpenGL does not link the item-buffer program";
    give(b, ITEM_BUFFER_COORDINATES, b->triangles.vertex_count * 3 * sizeof(float), b->triangles.coordinates);
    gl->EnableVertexAttribArray(1);
    for (size_t i = 0; i < b->range_count; i++) {
        item_range *r = &b->ranges[i];
        if (!r->holes) continue;
        r->texture = item_device_texture(b->device, desc->memory, r->holes);
        r->cutoff = (float)r->holes->cutoff;
        if (!r->texture) return NO_MEMORY;
    }
    return NULL;
}

static bool is_same(const item_range *a, const item_range *b) {
    return a->layer == b->layer && a->holes == b->holes;
}

static const alpha_mask_map *holes_of(const item_geometry *g, size_t t) {
    return g->coordinates ? g->holes[t] : NULL;
}

/* Of each triangle the range that it belongs to; ranges are numbered as they come first. Most are of that of the one
 * before, and there are few. False when out of memory. */
static bool list_ranges(item_buffer *b, const item_buffer_desc *desc, const uint8_t *layers, uint32_t *range) {
    const item_geometry *g = desc->geometry;
    size_t capacity = 0;
    uint32_t last = 0;
    for (size_t t = 0; t < g->triangle_count; t++) {
        const item_range wanted = { .layer = layers[t], .holes = holes_of(g, t) };
        uint32_t i = last;
        if (i >= b->range_count || !is_same(&b->ranges[i], &wanted))
            for (i = 0; i < b->range_count && !is_same(&b->ranges[i], &wanted);) i++;
        if (i == b->range_count) {
            if (!block_grow(desc->memory, (void **)&b->ranges, &capacity, i, sizeof *b->ranges)) return false;
            b->ranges[b->range_count++] = wanted;
        }
        b->ranges[i].count++;
        b->has_holes = b->has_holes || wanted.holes;
        range[t] = last = i;
    }
    return true;
}

bool item_geometry_layers(const item_geometry *g, allocator *memory, uint8_t *out) {
    if (!g->layers) return coplanar_overlap_find_layers(memory, g->positions, g->indices, g->triangle_count, out);
    memcpy(out, g->layers, g->triangle_count);
    return true;
}

/* order[i]: the triangle that is drawn as the i-th: those of a range follow each other, so that each is one draw. In
 * the order of the triangles an office had 468 draws of three triangles a frame, and Mesa compared state a third of the
 * time. */
static bool find_ranges(item_buffer *b, const item_buffer_desc *desc, uint32_t *order) {
    const item_geometry *g = desc->geometry;
    size_t n = g->triangle_count;
    uint8_t *layers = block_new(desc->memory, n + 1);
    uint32_t *range = block_new(desc->memory, (n + 1) * sizeof *range);
    bool ok = layers && range && item_geometry_layers(g, desc->memory, layers) && list_ranges(b, desc, layers, range);
    for (size_t i = 1; ok && i < b->range_count; i++)
        b->ranges[i].first = b->ranges[i - 1].first + b->ranges[i - 1].count;
    for (size_t i = 0; ok && i < b->range_count; i++) b->ranges[i].count = 0;
    for (size_t t = 0; ok && t < n; t++) {
        item_range *r = &b->ranges[range[t]];
        order[r->first + r->count++] = (uint32_t)t;
    }
    block_free_all(layers, range);
    return ok;
}

static const char *order_triangles(item_buffer *b, const item_buffer_desc *desc) {
    uint32_t *order = block_new(desc->memory, (desc->geometry->triangle_count + 1) * sizeof *order);
    bool ok = order && find_ranges(b, desc, order) &&
              drawn_triangles_create(desc->geometry, order, desc->memory, &b->triangles);
    block_free(order);
    return ok ? NULL : NO_MEMORY;
}

/* otherwise: what is said unless memory is the cause. */
static const char *cause(GLenum error, const char *otherwise) {
    return error == GL_OUT_OF_MEMORY ? NO_MEMORY : otherwise;
}

/* The rest of item_buffer_open, inside the context. */
static const char *fill(item_buffer *b, const item_buffer_desc *desc) {
    if (!item_device_bind(b->device, desc->width, desc->height))
        return cause(b->device->gl.GetError(), "OpenGL gives no R32UI frame buffer of the size");
    const drawn_triangles *d = &b->triangles;
    give(b, ITEM_BUFFER_POSITIONS, d->vertex_count * 3 * sizeof(float), d->positions);
    give(b, ITEM_BUFFER_IDS, d->vertex_count * sizeof(uint32_t), d->ids);
    give(b, ITEM_BUFFER_INDICES, d->triangle_count * 3 * sizeof(uint32_t), d->indices);
    const char *failure = upload_holes(b, desc);
    drawn_triangles_forget(&b->triangles);
    if (failure) return failure;
    GLenum error = b->device->gl.GetError();
    return error == GL_NO_ERROR ? NULL : cause(error, "OpenGL failed to take the scene");
}

static const char *open_rays(item_buffer *b, const item_buffer_desc *desc, char *message, size_t message_size) {
    item_buffer_desc numbered = *desc;
    numbered.first_id = b->first_id;
    b->rays = ray_items_open(&numbered, message, message_size);
    return b->rays ? NULL : message;
}

static const char *open_in(item_buffer *b, const item_buffer_desc *desc, char *message, size_t message_size) {
    const char *failure = NULL;
    if (!b) return NO_MEMORY;
    b->first_id = desc->first_id ? desc->first_id : 1;
    b->marks_holes = desc->marks_holes;
    if (desc->geometry->triangle_count > INT32_MAX / 3) return "more triangles than OpenGL can draw at once";
    if (desc->geometry->triangle_count > (uint64_t)UINT32_MAX - b->first_id + 1) return "more triangles than ids";
    if (b->marks_holes && desc->geometry->triangle_count >= ITEM_MARK - b->first_id) return "more triangles than ids";
    item_backend backend = item_pool_backend(desc->geometry->pool, desc->backend);
    b->width = desc->width, b->height = desc->height;
    if (backend == ITEM_BACKEND_RAYS) return open_rays(b, desc, message, message_size);
    failure = order_triangles(b, desc);
    if (failure) return failure;
    b->near_plane = desc->geometry->near_plane;
    b->pool = desc->geometry->pool;
    b->device = item_device_take(b->pool, desc->memory, backend, &failure);
    if (!b->device && strcmp(failure, NO_MEMORY) != 0 && item_pool_may_choose(b->pool, desc->backend) &&
        item_backend_is_there(ITEM_BACKEND_RAYS)) {
        item_pool_backend(b->pool, ITEM_BACKEND_RAYS);
        return open_rays(b, desc, message, message_size); /* a driver that fails is no reason to stop */
    }
    if (!b->device) return failure;
    failure = fill(b, desc);
    item_device_leave(b->device);
    return failure;
}

item_buffer *item_buffer_open(const item_buffer_desc *desc, char *message, size_t message_size) {
    item_buffer *b = block_zeroed(desc->memory, 1, sizeof *b);
    const char *failure = open_in(b, desc, message, message_size);
    if (!failure) return b;
    if (failure != message) snprintf(message, message_size, "%s", failure);
    item_buffer_destroy(b);
    return NULL;
}

item_device *item_buffer_release(item_buffer *b) {
    item_device *device = b->device;
    ray_items_destroy(b->rays);
    drawn_triangles_free(&b->triangles);
    block_free_all(b->ranges, b->shares, b);
    return device;
}

void item_buffer_destroy(item_buffer *b) {
    if (!b) return;
    item_pool *pool = b->pool;
    item_device *device = item_buffer_release(b);
    if (device) item_device_give(pool, device);
}

/* Column-major rows x, y, z, w of the clip position:
 *   w = distance z along forward, x = z s' and y = z t' with s', t' in [-1, 1] over the view, z = near (depth near / w)
 * In double, so that the eye is where it is said to be to one rounding of its coordinates. */
static void clip_from_scene(float m[16], const item_view *v, float near_plane) {
    double s_scale = 2.0 / ((double)v->s_high - v->s_low), t_scale = 2.0 / ((double)v->t_high - v->t_low);
    double s_mid = 0.5 * ((double)v->s_low + v->s_high), t_mid = 0.5 * ((double)v->t_low + v->t_high);
    double eye[3] = { vec3_dot_floats(v->right, v->eye), vec3_dot_floats(v->up, v->eye),
                      vec3_dot_floats(v->forward, v->eye) };
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
    m[12] = (float)(-s_scale * (vec3_dot_floats(v->right, v->eye) + s_mid));
    m[13] = (float)(-t_scale * (vec3_dot_floats(v->up, v->eye) + t_mid));
    m[14] = (float)(1.0 + vec3_dot_floats(v->forward, v->eye) / (double)v->depth);
    m[15] = 1.0f;
}

static void set_edges(const item_buffer *b, item_edges edges, bool cull) {
    bool none = edges == ITEM_EDGES_NONE;
    (none && !cull ? b->device->gl.Disable : b->device->gl.Enable)(GL_CULL_FACE);
    b->device->gl.CullFace(edges == ITEM_EDGES_BACK ? GL_FRONT : GL_BACK);
    b->device->gl.PolygonMode(GL_FRONT_AND_BACK, none ? GL_FILL : GL_LINE);
}

/* One view as it is drawn. */
typedef struct drawn_view {
    float clip_from_scene[16];
    const item_share *shares;
} drawn_view;

static void draw_ranges(const item_buffer *b, const item_program *program, const drawn_view *v, bool solid,
                        bool holed) {
    b->device->gl.UseProgram(program->name);
    b->device->gl.UniformMatrix4fv(program->matrix, 1, GL_FALSE, v->clip_from_scene);
    b->device->gl.Uniform1ui(program->first_id, b->first_id - 1);
    for (size_t i = 0; i < b->range_count; i++)
        if (v->shares[i].count && (b->ranges[i].texture ? holed : solid)) {
            const item_range *r = &b->ranges[i];
            const float back = (float)-r->layer; /* depth is reversed, so setting back makes it less */
            b->device->gl.Uniform1f(program->cutoff, r->cutoff);
            if (r->texture) b->device->gl.BindTexture(GL_TEXTURE_2D, r->texture);
            b->device->gl.PolygonOffset(back * LAYER_SLOPE, back * LAYER_ROUNDINGS);
            b->device->gl.DrawElements(GL_TRIANGLES, (GLsizei)(3 * v->shares[i].count), GL_UNSIGNED_INT,
                                       (const char *)NULL + 12 * v->shares[i].first);
        }
}

static void draw_marks(const item_buffer *b, const drawn_view *v) {
    b->device->gl.Enable(GL_COLOR_LOGIC_OP);
    b->device->gl.LogicOp(GL_OR);
    b->device->gl.DepthMask(GL_FALSE);
    b->device->gl.DepthFunc(GL_GEQUAL);
    draw_ranges(b, &b->device->mark, v, false, true);
    b->device->gl.DepthFunc(GL_GREATER);
    b->device->gl.DepthMask(GL_TRUE);
    b->device->gl.Disable(GL_COLOR_LOGIC_OP);
}

static void set_clip(float m[16], const item_buffer *b, const item_view *v) {
    if (v->parallel)
        clip_from_scene_parallel(m, v);
    else
        clip_from_scene(m, v, b->near_plane);
}

static bool share_what_may_be_seen(item_buffer *b, const item_view *v, item_share *shares) {
    drawn_triangles *d = &b->triangles;
    float m[16];
    set_clip(m, b, v);
    drawn_triangles_look(d, m);
    for (size_t i = 0; i < b->range_count; i++) {
        size_t before = d->kept_count;
        if (!drawn_triangles_keep(d, b->ranges[i].first, b->ranges[i].count)) return false;
        shares[i] = (item_share){ before, d->kept_count - before };
    }
    return true;
}

/* What each view may show. */
static bool distribute_views(item_buffer *b, const item_view *views, size_t view_count) {
    if (!block_reserve(b->triangles.memory, (void **)&b->shares, &b->share_capacity, view_count * b->range_count,
                       sizeof *b->shares))
        return false;
    b->triangles.kept_count = 0;
    for (size_t i = 0; i < view_count; i++) {
        item_share *shares = b->shares + i * b->range_count;
        bool whole = views[i].edges != ITEM_EDGES_NONE;
        if (!whole && !share_what_may_be_seen(b, &views[i], shares)) return false;
        /* Lines are a pixel wide, so that triangles beside a view may reach into it. */
        for (size_t k = 0; whole && k < b->range_count; k++)
            shares[k] = (item_share){ b->ranges[k].first, b->ranges[k].count };
    }
    return true;
}

static void draw_view(item_buffer *b, const item_view *v, const item_share *shares, bool cull) {
    bool whole = v->edges != ITEM_EDGES_NONE;
    drawn_view drawn = { .shares = shares };
    set_clip(drawn.clip_from_scene, b, v);
    b->device->gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER,
                             b->device->buffers[whole ? ITEM_BUFFER_INDICES : ITEM_BUFFER_KEPT]);
    set_edges(b, v->edges, cull);
    b->device->gl.Viewport(v->x, v->y, v->width, v->height);
    draw_ranges(b, &b->device->solid, &drawn, true, whole);
    if (!b->has_holes) return;
    if (!whole) draw_ranges(b, &b->device->holed, &drawn, false, true);
    if (b->marks_holes) draw_marks(b, &drawn);
}

bool item_buffer_draw(item_buffer *b, const item_view *views, int view_count, int width, int height, bool cull,
                      uint32_t *ids) {
    const GLuint sky[4] = { 0, 0, 0, 0 };
    const GLfloat far[1] = { 0.0f };
    item_device *d = b->device;
    if (width > b->width || height > b->height) return false;
    if (b->rays) return ray_items_draw(b->rays, views, view_count, width, height, cull, ids);
    if (!distribute_views(b, views, (size_t)view_count) || !item_device_enter(d)) {
        /* Whoever goes on until failures are looked at finds nothing but sky. */
        memset(ids, 0, (size_t)width * (size_t)height * sizeof *ids);
        return false;
    }
    bool drawn = item_device_bind(d, width, height);
    give(b, ITEM_BUFFER_KEPT, b->triangles.kept_count * 3 * sizeof(uint32_t), b->triangles.kept);
    d->gl.ClearBufferuiv(GL_COLOR, 0, sky);
    d->gl.ClearBufferfv(GL_DEPTH, 0, far);
    for (int i = 0; drawn && i < view_count; i++) draw_view(b, &views[i], b->shares + (size_t)i * b->range_count, cull);
    d->gl.ReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids);
    drawn = drawn && d->gl.GetError() == GL_NO_ERROR;
    item_device_leave(d);
    return drawn;
}
