/* SPDX-License-Identifier: MIT */
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

struct rays {
    const scene *scene;
    const mesh_items *items;
    RTCDevice device;
    RTCScene tree;
    float reach;
};

bool rays_are_there(void) {
    return true;
}

/* Copies an array into a buffer that Embree pads as it needs. */
static bool set_buffer(RTCGeometry g, enum RTCBufferType type, enum RTCFormat format, const void *values, size_t size,
                       size_t count) {
    void *to = rtcSetNewGeometryBuffer(g, type, 0, format, size, count);
    if (to) memcpy(to, values, size * count);
    return to;
}

static bool build(rays *r) {
    const item_geometry *items = &r->items->items;
    RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    r->tree = rtcNewScene(r->device);
    bool ok = g && r->tree;
    if (ok && items->triangle_count == 0) { /* all is glass */
        rtcReleaseGeometry(g);
        rtcCommitScene(r->tree);
        return rtcGetDeviceError(r->device) == RTC_ERROR_NONE;
    }
    ok = ok &&
         set_buffer(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, items->positions, 3 * sizeof(float),
                    items->vertex_count) &&
         set_buffer(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, items->indices, 3 * sizeof(uint32_t),
                    items->triangle_count);
    if (ok) {
        rtcCommitGeometry(g);
        rtcAttachGeometry(r->tree, g);
        /* Without gaps between triangles that share an edge. */
        rtcSetSceneFlags(r->tree, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        rtcCommitScene(r->tree);
        ok = rtcGetDeviceError(r->device) == RTC_ERROR_NONE;
    }
    if (g) rtcReleaseGeometry(g);
    return ok;
}

rays *rays_create(const scene *s, const mesh_items *items, char *message, size_t message_size) {
    rays *r = block_zeroed(s->memory, 1, sizeof *r);
    if (r) {
        *r = (rays){ .scene = s, .items = items, .device = rtcNewDevice("threads=1,isa=avx2"), .reach = INFINITY };
        if (r->device && build(r)) return r;
    }
    snprintf(message, message_size, "Embree could not be started, or has no room for the scene");
    rays_destroy(r);
    return NULL;
}

void rays_destroy(rays *r) {
    if (!r) return;
    if (r->tree) rtcReleaseScene(r->tree);
    if (r->device) rtcReleaseDevice(r->device);
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
    rtcIntersect1(r->tree, &c.context, &hit);
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
        rtcIntersect1(r->tree, &context, &hit);
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
