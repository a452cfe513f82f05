/* SPDX-License-Identifier: MIT
 * See rays.h and ray_tree.h: this is the only file that knows Embree.
 */
#include "visibility/ray_tree.h"
#include "visibility/rays.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <stdio.h>

#if HEMIBAKE_EMBREE

#include <embree3/rtcore.h>

#include <math.h>
#include <string.h>

/* Holes that one ray may pass; it ends in the next surface. */
enum { HOLES_MAX = 64 };

struct ray_tree {
    RTCDevice device;
    RTCScene scene;
};

struct rays {
    const scene *scene;
    const mesh_items *items;
    ray_tree *tree;
    float reach;
};

bool rays_are_there(void) {
    return true;
}

/* ---- trees ---- */

/* Copies an array into a buffer that Embree pads as it needs. */
static bool set_buffer(RTCGeometry g, enum RTCBufferType type, enum RTCFormat format, const void *values, size_t size,
                       size_t count) {
    void *to = rtcSetNewGeometryBuffer(g, type, 0, format, size, count);
    if (to) memcpy(to, values, size * count);
    return to;
}

static bool build(ray_tree *t, const item_geometry *items) {
    RTCGeometry g = rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    t->scene = rtcNewScene(t->device);
    bool ok = g && t->scene;
    if (ok && items->triangle_count == 0) { /* all is glass */
        rtcReleaseGeometry(g);
        rtcCommitScene(t->scene);
        return rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
    }
    ok = ok &&
         set_buffer(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, items->positions, 3 * sizeof(float),
                    items->vertex_count) &&
         set_buffer(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, items->indices, 3 * sizeof(uint32_t),
                    items->triangle_count);
    if (ok) {
        rtcCommitGeometry(g);
        rtcAttachGeometry(t->scene, g);
        /* Without gaps between triangles that share an edge. */
        rtcSetSceneFlags(t->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        rtcCommitScene(t->scene);
        ok = rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
    }
    if (g) rtcReleaseGeometry(g);
    return ok;
}

ray_tree *ray_tree_create(allocator *memory, const item_geometry *items, char *message, size_t message_size) {
    ray_tree *t = block_zeroed(memory, 1, sizeof *t);
    if (t) t->device = rtcNewDevice("threads=1,isa=avx2");
    if (t && t->device && build(t, items)) return t;
    snprintf(message, message_size, "Embree could not be started, or has no room for the scene");
    ray_tree_destroy(t);
    return NULL;
}

void ray_tree_destroy(ray_tree *t) {
    if (!t) return;
    if (t->scene) rtcReleaseScene(t->scene);
    if (t->device) rtcReleaseDevice(t->device);
    block_free(t);
}

typedef struct accept_context {
    struct RTCIntersectContext context;
    ray_tree_accept accept;
    void *user;
} accept_context;

/* Rays come one by one. */
static void filter_accepted(const struct RTCFilterFunctionNArguments *a) {
    const accept_context *c = (const accept_context *)a->context;
    const struct RTCHit *hit = (const struct RTCHit *)a->hit;
    const ray_tree_hit found = { hit->primID, ((const struct RTCRay *)a->ray)->tfar, hit->u, hit->v };
    if (!c->accept(c->user, &found)) a->valid[0] = 0;
}

bool ray_tree_first(const ray_tree *t, const float from[3], const float direction[3], float near, float far,
                    ray_tree_accept accept, void *user, ray_tree_hit *out) {
    accept_context c = { .accept = accept, .user = user };
    struct RTCRayHit ray = { .ray = { .org_x = from[0],
                                      .org_y = from[1],
                                      .org_z = from[2],
                                      .tnear = near,
                                      .dir_x = direction[0],
                                      .dir_y = direction[1],
                                      .dir_z = direction[2],
                                      .tfar = far,
                                      .mask = UINT32_MAX },
                             .hit.geomID = RTC_INVALID_GEOMETRY_ID };
    rtcInitIntersectContext(&c.context);
    if (accept) c.context.filter = filter_accepted;
    rtcIntersect1(t->scene, &c.context, &ray);
    *out = (ray_tree_hit){ ray.hit.primID, ray.ray.tfar, ray.hit.u, ray.hit.v };
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

/* ---- rays of a scene ---- */

rays *rays_create(const scene *s, const mesh_items *items, char *message, size_t message_size) {
    rays *r = block_zeroed(s->memory, 1, sizeof *r);
    snprintf(message, message_size, "out of memory");
    if (!r) return NULL;
    *r = (rays){ .scene = s, .items = items, .reach = INFINITY };
    r->tree = ray_tree_create(s->memory, &items->items, message, message_size);
    if (r->tree) return r;
    rays_destroy(r);
    return NULL;
}

void rays_destroy(rays *r) {
    if (!r) return;
    ray_tree_destroy(r->tree);
    block_free(r);
}

void rays_reach(rays *r, double metres) {
    r->reach = (float)metres;
}

static bool is_in_hole(const rays *r, uint32_t triangle, const double from[3], const double direction[3], float t) {
    const surface *f = &r->scene->surfaces[r->items->surface[r->items->triangle_piece[triangle]]];
    double at[3];
    if (!f->holes) return false;
    vec3_add_scaled(at, from, (double)t, direction);
    return alpha_mask_is_hole(f->holes, at);
}

/* ---- skins ---- */

/* Where two surfaces lie in one plane and look away from each other, each is seen from its front: a back is only met
 * where there is no front within the rounding of positions, of which rays that graze it see more. */
static const double SKIN = 2.0 * TOLERANCE_OVERLAP, GRAZING = 0.05;

typedef struct skin_context {
    struct RTCIntersectContext context;
    const rays *rays;
    const double *from, *direction;
} skin_context;

/* Lets backs and holes pass; rays come one by one. */
static void filter_backs(const struct RTCFilterFunctionNArguments *a) {
    const skin_context *c = (const skin_context *)a->context;
    const struct RTCRay *ray = (const struct RTCRay *)a->ray;
    uint32_t triangle = ((const struct RTCHit *)a->hit)->primID;
    if (mesh_items_facing(c->rays->items, c->rays->scene, triangle + 1, c->from) == NO_INDEX ||
        is_in_hole(c->rays, triangle, c->from, c->direction, ray->tfar))
        a->valid[0] = 0;
}

/* A front in the place where a ray met a back. */
static uint32_t front_of_skins(const rays *r, const struct RTCRayHit *back, const double from[3],
                               const double direction[3]) {
    skin_context c = { .rays = r, .from = from, .direction = direction };
    const double normal[3] = { (double)back->hit.Ng_x, (double)back->hit.Ng_y, (double)back->hit.Ng_z };
    double cosine = fabs(vec3_dot(normal, direction)) / fmax(vec3_length(normal), 1e-300);
    float apart = (float)(SKIN * r->scene->radius / fmax(cosine, GRAZING));
    struct RTCRayHit hit = *back;
    rtcInitIntersectContext(&c.context);
    c.context.filter = filter_backs;
    hit.ray.tnear = fmaxf(back->ray.tfar - apart, 0.0f);
    hit.ray.tfar = back->ray.tfar + apart;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(r->tree->scene, &c.context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? NO_INDEX
                                                     : mesh_items_facing(r->items, r->scene, hit.hit.primID + 1, from);
}

ray_end rays_measure(const rays *r, const double from[3], const double direction[3], uint32_t *piece,
                     double *distance) {
    struct RTCIntersectContext context;
    struct RTCRayHit hit = { .ray = { .dir_x = (float)direction[0],
                                      .dir_y = (float)direction[1],
                                      .dir_z = (float)direction[2],
                                      .org_x = (float)(from[0] - r->scene->center[0]),
                                      .org_y = (float)(from[1] - r->scene->center[1]),
                                      .org_z = (float)(from[2] - r->scene->center[2]),
                                      .mask = UINT32_MAX } };
    rtcInitIntersectContext(&context);
    for (int holes = 0; holes < HOLES_MAX; holes++) {
        hit.ray.tfar = r->reach;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(r->tree->scene, &context, &hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return RAY_SKY;
        if (!is_in_hole(r, hit.hit.primID, from, direction, hit.ray.tfar)) break;
        hit.ray.tnear = nextafterf(hit.ray.tfar * (1.0f + (float)TOLERANCE_EYE_LIFT), INFINITY);
    }
    *piece = mesh_items_facing(r->items, r->scene, hit.hit.primID + 1, from);
    if (*piece == NO_INDEX) *piece = front_of_skins(r, &hit, from, direction);
    *distance = (double)hit.ray.tfar;
    return *piece == NO_INDEX ? RAY_BACK : RAY_FRONT;
}

#else

struct rays {
    int none;
};

bool rays_are_there(void) {
    return false;
}

ray_tree *ray_tree_create(allocator *memory, const item_geometry *items, char *message, size_t message_size) {
    (void)memory, (void)items;
    snprintf(message, message_size, "this build is without Embree");
    return NULL;
}

void ray_tree_destroy(ray_tree *t) {
    (void)t;
}

bool ray_tree_first(const ray_tree *t, const float from[3], const float direction[3], float near, float far,
                    ray_tree_accept accept, void *user, ray_tree_hit *out) {
    (void)t, (void)from, (void)direction, (void)near, (void)far, (void)accept, (void)user, (void)out;
    return false;
}

rays *rays_create(const scene *s, const mesh_items *items, char *message, size_t message_size) {
    (void)s, (void)items;
    snprintf(message, message_size, "this build is without Embree, which the method needs; take another method");
    return NULL;
}

void rays_destroy(rays *r) {
    (void)r;
}

void rays_reach(rays *r, double metres) {
    (void)r, (void)metres;
}

ray_end rays_measure(const rays *r, const double from[3], const double direction[3], uint32_t *piece,
                     double *distance) {
    (void)r, (void)from, (void)direction, (void)piece, (void)distance;
    return RAY_SKY;
}

#endif
