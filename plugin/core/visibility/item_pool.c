/* SPDX-License-Identifier: MIT
 * Where do devices wait between the item buffers of a bake? See item_buffer.h and item_device.h.
 */
#include "visibility/item_device.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

enum { WARMING_MAX = 64 };

struct item_pool {
    allocator *memory;
    pthread_mutex_t mutex;
    pthread_cond_t warmed;
    item_backend backend;
    atomic_uint used;
    item_device *idle;
    unsigned warming;
    bool refused; /* memory, while warming: whoever asks for a device next is told */
    pthread_t threads[WARMING_MAX];
    unsigned thread_count;
};

void item_pool_set_backend(item_pool *pool, item_backend backend) {
    pool->backend = backend;
    pool->used = 0;
}

unsigned item_pool_used_backends(const item_pool *pool) {
    return pool->used;
}

bool item_pool_may_choose(const item_pool *pool, item_backend asked) {
    return asked == ITEM_BACKEND_DEFAULT && (!pool || pool->backend == ITEM_BACKEND_DEFAULT);
}

item_backend item_pool_backend(item_pool *pool, item_backend asked) {
    if (pool && asked == ITEM_BACKEND_DEFAULT) asked = pool->backend;
    for (item_backend b = ITEM_BACKEND_OSMESA; asked == ITEM_BACKEND_DEFAULT && b < ITEM_BACKENDS; b++)
        if (item_backend_is_there(b)) asked = b;
    if (pool) pool->used |= 1u << asked;
    return asked;
}

void item_pool_count_as_used(item_pool *pool, item_backend asked) {
    item_pool_backend(pool, asked);
}

static void push(item_pool *pool, item_device *d) {
    d->next = pool->idle;
    pool->idle = d;
}

/* The first waiting device of the kind, out of the list. */
static item_device *pull(item_pool *pool, const gl_context_kind *kind) {
    for (item_device **at = &pool->idle; *at; at = &(*at)->next) {
        item_device *d = *at;
        if (d->kind != kind) continue;
        *at = d->next;
        return d;
    }
    return NULL;
}

item_device *item_device_take(item_pool *pool, allocator *memory, item_backend backend, const char **failure) {
    item_device *d = NULL;
    bool refused = false;
    if (pool) {
        pthread_mutex_lock(&pool->mutex);
        while (!(d = pull(pool, item_device_kind(backend))) && pool->warming)
            pthread_cond_wait(&pool->warmed, &pool->mutex);
        refused = pool->refused;
        pool->refused = false;
        if (refused && d) push(pool, d);
        pthread_mutex_unlock(&pool->mutex);
    }
    *failure = "out of memory";
    if (refused) return NULL;
    if (!d) return item_device_create(memory, backend, failure);
    if (item_device_enter(d)) return d;
    *failure = "OpenGL does not take its context back";
    item_device_destroy(d);
    return NULL;
}

/* What waits keeps no geometry and no pixels. */
static bool empty(item_device *d) {
    if (!item_device_enter(d)) return false;
    for (int i = 0; i < ITEM_BUFFERS; i++) {
        d->gl.BindBuffer(GL_ARRAY_BUFFER, d->buffers[i]);
        d->gl.BufferData(GL_ARRAY_BUFFER, 0, NULL, GL_STATIC_DRAW);
    }
    while (d->texture_count > 0) d->gl.DeleteTextures(1, &d->textures[--d->texture_count].name);
    block_free(d->textures);
    d->textures = NULL;
    while (d->target_count > 0) {
        item_target *t = &d->targets[--d->target_count];
        d->gl.DeleteFramebuffers(1, &t->framebuffer);
        d->gl.DeleteRenderbuffers(2, t->renderbuffers);
    }
    bool emptied = d->gl.GetError() == GL_NO_ERROR;
    item_device_leave(d);
    return emptied;
}

void item_device_give(item_pool *pool, item_device *d) {
    if (!pool || !empty(d)) {
        item_device_destroy(d);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    push(pool, d);
    pthread_mutex_unlock(&pool->mutex);
}

/* Draws once, because LLVM compiles at the first draw. What fails here is told when it is needed. */
static void *warm_one(void *user) {
    static const float corners[] = { 0, 0, 1, 1, 0, 1, 0, 1, 1 };
    static const uint32_t indices[] = { 0, 1, 2 };
    item_pool *pool = user;
    uint32_t ids[16];
    char message[128];
    item_geometry triangle = { .positions = corners, .vertex_count = 3, .indices = indices, .triangle_count = 1 };
    triangle.near_plane = 0.1f;
    const item_buffer_desc desc = { .geometry = &triangle, .width = 4, .height = 4, .memory = pool->memory };
    const item_view view = { .right = { 1 },
                             .up = { 0, 1 },
                             .forward = { 0, 0, 1 },
                             .s_low = -1,
                             .s_high = 1,
                             .t_low = -1,
                             .t_high = 1,
                             .width = 4,
                             .height = 4 };
    item_buffer *b = item_buffer_open(&desc, message, sizeof message);
    bool refused = b ? !item_buffer_draw(b, &view, 1, 4, 4, false, ids) : strcmp(message, "out of memory") == 0;
    item_device *d = b ? item_buffer_release(b) : NULL;
    if (d) item_device_give(pool, d);
    pthread_mutex_lock(&pool->mutex);
    pool->refused = pool->refused || refused;
    pool->warming--;
    pthread_cond_broadcast(&pool->warmed);
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

item_pool *item_pool_create(allocator *memory) {
    item_pool *pool = block_zeroed(memory, 1, sizeof *pool);
    if (!pool) return NULL;
    pool->memory = memory;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->warmed, NULL);
    return pool;
}

void item_pool_warm(item_pool *pool, unsigned count) {
    if (!pool || pool->thread_count > 0 || !item_device_kind(ITEM_BACKEND_DEFAULT)) return; /* rays need no context */
    pthread_mutex_lock(&pool->mutex);
    while (pool->thread_count < count && pool->thread_count < WARMING_MAX) {
        if (pthread_create(&pool->threads[pool->thread_count], NULL, warm_one, pool) != 0) break;
        pool->thread_count++;
    }
    pool->warming = pool->thread_count;
    pthread_mutex_unlock(&pool->mutex);
}

void item_pool_destroy(item_pool *pool) {
    if (!pool) return;
    for (unsigned i = 0; i < pool->thread_count; i++) pthread_join(pool->threads[i], NULL);
    for (item_device *d = pool->idle, *next; d; d = next) {
        next = d->next;
        item_device_destroy(d);
    }
    pthread_cond_destroy(&pool->warmed);
    pthread_mutex_destroy(&pool->mutex);
    block_free(pool);
}
