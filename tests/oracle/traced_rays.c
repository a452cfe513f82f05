/* SPDX-License-Identifier: MIT
 * See traced_rays.h. Opaque triangles are Embree's geometry 0; those with an alpha mask, whose filter is called for
 * every candidate, are geometry 1. Results of rays depend on Embree's instruction set, so one is asked for.
 */
#include "traced_rays.h"

#include "geometry/vec3.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>

/* Two skins closer than this, of the radius, lie in one plane. */
static const double ONE_PLANE = 1e-5;

/* Fronts look the same way if the cosine between them is above that; as converters/probes/match.h has it. */
static const double SAME_SIDE = 0.5;

/* Shadow rays end before the emitter, by float rounding of the distance. */
static const double BEFORE_END = 1e-5;

enum { OPAQUE, MASKED };

/* Embree hands its context to filters: what else they must know comes after it. */
typedef struct ray_question {
    struct RTCIntersectContext context; /* first */
    double middle;                      /* of a locating ray: where the nearest is looked for */
    double best;
    struct RTCHit hit;
} ray_question;

static uint32_t number_of(const traced_scene *s, const struct RTCHit *hit) {
    return s->numbers[hit->geomID][hit->primID];
}

static void set_weights(const struct RTCHit *hit, double weights[3]) {
    weights[0] = 1 - (double)hit->u - (double)hit->v;
    weights[1] = (double)hit->u;
    weights[2] = (double)hit->v;
}

/* Cosine between a ray and the normal of what it meets: below 0 it comes from the front. */
static double cosine_along(const traced_scene *s, const struct RTCRay *ray, uint32_t triangle) {
    const double direction[3] = { (double)ray->dir_x, (double)ray->dir_y, (double)ray->dir_z };
    return vec3_dot(s->triangles[triangle].normal, direction);
}

static bool is_front(const traced_scene *s, const struct RTCRay *ray, uint32_t triangle) {
    return cosine_along(s, ray, triangle) < 0 || traced_scene_double_sided(s, triangle);
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* Column or row of a texture that holds a coordinate. */
static uint32_t texel_at(double coordinate, uint32_t count, hemi_wrap wrap) {
    double turns = floor(coordinate);
    if (wrap == HEMI_WRAP_CLAMP) coordinate = fmin(fmax(coordinate, 0), 1);
    if (wrap != HEMI_WRAP_CLAMP) coordinate -= turns;
    if (wrap == HEMI_WRAP_MIRROR && fmod(turns, 2) != 0) coordinate = 1 - coordinate;
    return (uint32_t)fmin(coordinate * count, count - 1);
}

static bool is_hole(const traced_scene *s, uint32_t triangle, const double weights[3]) {
    const traced_triangle *t = &s->triangles[triangle];
    const hemi_mesh_desc *mesh = &s->meshes[t->mesh];
    const hemi_alpha_mask *mask = mesh->alpha_mask;
    double uvw[3] = { 0, 0, 0 };
    for (uint32_t k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            uvw[k] += weights[i] *
                      (double)mesh->attributes[(size_t)mesh->attribute_count * t->vertex[i] + mask->attribute + k];
    size_t row = texel_at(uvw[1], mask->height, mask->wrap_v), column = texel_at(uvw[0], mask->width, mask->wrap_u);
    return mask->alpha[row * mask->width + column] / 255.0 * uvw[2] < mask->cutoff;
}

static void pass_through_holes(const struct RTCFilterFunctionNArguments *a) {
    const traced_scene *s = a->geometryUserPtr;
    double weights[3];
    if (!a->valid[0]) return;
    set_weights((const struct RTCHit *)a->hit, weights);
    if (is_hole(s, number_of(s, (const struct RTCHit *)a->hit), weights)) a->valid[0] = 0;
}

static void pass_through_backs(const struct RTCFilterFunctionNArguments *a) {
    const traced_scene *s = a->geometryUserPtr;
    if (a->valid[0] && !is_front(s, (const struct RTCRay *)a->ray, number_of(s, (const struct RTCHit *)a->hit)))
        a->valid[0] = 0;
}

/* Keeps the one nearest to the middle of the ray and goes on. */
static void keep_nearest(const struct RTCFilterFunctionNArguments *a) {
    const traced_scene *s = a->geometryUserPtr;
    ray_question *q = (ray_question *)a->context;
    const struct RTCRay *ray = (const struct RTCRay *)a->ray;
    const struct RTCHit *hit = (const struct RTCHit *)a->hit;
    uint32_t triangle = number_of(s, hit);
    if (!a->valid[0]) return;
    a->valid[0] = 0;
    double cosine = cosine_along(s, ray, triangle), off = fabs((double)ray->tfar - q->middle);
    if (traced_scene_double_sided(s, triangle)) cosine = -fabs(cosine);
    if (-cosine <= SAME_SIDE || off > q->best || (off == q->best && triangle >= number_of(s, &q->hit))) return;
    q->best = off;
    q->hit = *hit;
}

/* ---- building ---------------------------------------------------------------------------------------------------- */

static bool is_masked(const traced_scene *s, size_t triangle) {
    return s->meshes[s->triangles[triangle].mesh].alpha_mask != NULL;
}

static void fill(const traced_scene *s, int kind, uint32_t *numbers, float *vertices, unsigned *indices) {
    size_t p = 0;
    for (size_t t = 0; t < s->triangle_count; t++) {
        if (is_masked(s, t) != (kind == MASKED)) continue;
        for (size_t i = 0; i < 9; i++) vertices[9 * p + i] = (float)s->triangles[t].corner[i / 3][i % 3];
        for (size_t k = 0; k < 3; k++) indices[3 * p + k] = (unsigned)(3 * p + k);
        numbers[p++] = (uint32_t)t;
    }
}

static bool add_geometry(traced_scene *s, int kind) {
    size_t count = 0;
    for (size_t t = 0; t < s->triangle_count; t++) count += is_masked(s, t) == (kind == MASKED);
    s->numbers[kind] = malloc((count + 1) * sizeof **s->numbers);
    if (!s->numbers[kind]) return false;
    if (count == 0) return true;
    RTCGeometry geometry = rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                              3 * sizeof *vertices, 3 * count);
    unsigned *indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof *indices, count);
    bool ok = vertices && indices;
    if (ok) fill(s, kind, s->numbers[kind], vertices, indices);
    rtcSetGeometryUserData(geometry, s);
    if (kind == MASKED) rtcSetGeometryIntersectFilterFunction(geometry, pass_through_holes);
    if (kind == MASKED) rtcSetGeometryOccludedFilterFunction(geometry, pass_through_holes);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(s->embree, geometry, (unsigned)kind);
    rtcReleaseGeometry(geometry);
    return ok;
}

bool traced_rays_create(traced_scene *s) {
    s->device = rtcNewDevice("isa=avx2");
    if (!s->device) s->device = rtcNewDevice(NULL); /* a machine without it */
    if (!s->device) return false;
    s->embree = rtcNewScene(s->device);
    rtcSetSceneFlags(s->embree, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    if (!add_geometry(s, OPAQUE) || !add_geometry(s, MASKED)) return false;
    rtcCommitScene(s->embree);
    return rtcGetDeviceError(s->device) == RTC_ERROR_NONE;
}

void traced_rays_destroy(traced_scene *s) {
    if (s->embree) rtcReleaseScene(s->embree);
    if (s->device) rtcReleaseDevice(s->device);
    free(s->numbers[OPAQUE]);
    free(s->numbers[MASKED]);
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

static ray_question new_question(RTCFilterFunctionN filter) {
    ray_question q = { .best = INFINITY };
    rtcInitIntersectContext(&q.context);
    q.context.filter = filter;
    return q;
}

static struct RTCRay new_ray(const double origin[3], const double direction[3], double begin, double end) {
    return (struct RTCRay){ .org_x = (float)origin[0],
                            .org_y = (float)origin[1],
                            .org_z = (float)origin[2],
                            .dir_x = (float)direction[0],
                            .dir_y = (float)direction[1],
                            .dir_z = (float)direction[2],
                            .tnear = (float)begin,
                            .tfar = (float)end,
                            .mask = ~0u };
}

/* False: nothing there. */
static bool trace(const traced_scene *s, struct RTCRayHit *rh, RTCFilterFunctionN filter) {
    ray_question q = new_question(filter);
    rh->hit.geomID = rh->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(s->embree, &q.context, rh);
    return rh->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

/* The point of a hit, seen from the side that looks against a direction. */
static void set_point(const traced_scene *s, const struct RTCHit *hit, const double against[3], traced_point *out) {
    const traced_triangle *t = &s->triangles[out->triangle = number_of(s, hit)];
    set_weights(hit, out->weights);
    double side = vec3_dot(t->normal, against) > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        out->position[k] = 0;
        for (int i = 0; i < 3; i++) out->position[k] += out->weights[i] * t->corner[i][k];
        out->normal[k] = side * t->normal[k];
    }
    traced_scene_set_shading(s, out);
}

static void leave(const traced_scene *s, const traced_point *from, double origin[3]) {
    vec3_add_scaled(origin, from->eye, s->offset, from->normal);
}

traced_what traced_scene_hit(const traced_scene *s, const traced_point *from, const double direction[3],
                             traced_point *out) {
    double origin[3];
    leave(s, from, origin);
    struct RTCRayHit rh = { .ray = new_ray(origin, direction, 0, INFINITY) };
    if (!trace(s, &rh, NULL)) return TRACED_SKY;
    if (!is_front(s, &rh.ray, number_of(s, &rh.hit))) {
        double there = (double)rh.ray.tfar, reach = ONE_PLANE * s->radius;
        struct RTCRayHit back = rh;
        rh.ray = new_ray(origin, direction, fmax(there - reach, 0), there + reach);
        if (!trace(s, &rh, pass_through_backs)) {
            set_point(s, &back.hit, direction, out);
            return TRACED_BLACK;
        }
    }
    set_point(s, &rh.hit, direction, out);
    return TRACED_SURFACE;
}

/* The share of light that a ray's next surface lets past; false: none of it. The ray goes on behind it. */
static bool pass_pane(const traced_scene *s, struct RTCRayHit *rh, double passed[3]) {
    double weights[3], straight[3], diffuse[3];
    uint32_t triangle = number_of(s, &rh->hit);
    set_weights(&rh->hit, weights);
    traced_scene_transmittance(s, triangle, weights, straight, diffuse);
    for (int c = 0; c < 3; c++) passed[c] *= straight[c];
    rh->ray.tnear = rh->ray.tfar + (float)s->offset;
    return !vec3_is_zero(passed);
}

/* The ray begins off the surface, so it is turned to end where it was sent: along a grazing direction it would meet the
 * emitter itself too soon. */
bool traced_scene_blocked(const traced_scene *s, const traced_point *from, const double direction[3], double distance,
                          double passed[3]) {
    double origin[3], toward[3];
    passed[0] = passed[1] = passed[2] = 1;
    leave(s, from, origin);
    vec3_copy(toward, direction);
    if (isfinite(distance)) {
        for (int k = 0; k < 3; k++) toward[k] = from->eye[k] + distance * direction[k] - origin[k];
        distance = vec3_normalize(toward);
    }
    ray_question q = new_question(NULL);
    struct RTCRay ray = new_ray(origin, toward, 0, distance * (1 - BEFORE_END) - 2 * s->offset);
    float end = ray.tfar;
    if (!(end > 0)) return false;
    if (!s->panes) {
        rtcOccluded1(s->embree, &q.context, &ray);
        return ray.tfar < 0;
    }
    struct RTCRayHit rh = { .ray = ray };
    while (rh.ray.tnear < end && trace(s, &rh, NULL)) {
        if (!pass_pane(s, &rh, passed)) return true;
        rh.ray.tfar = end;
    }
    return false;
}

bool traced_scene_locate(const traced_scene *s, const double place[3], const double normal[3], double reach,
                         traced_point *out) {
    double origin[3], down[3] = { -normal[0], -normal[1], -normal[2] };
    vec3_add_scaled(origin, place, reach, normal);
    ray_question q = new_question(keep_nearest);
    q.middle = reach;
    struct RTCRayHit rh = { .ray = new_ray(origin, down, 0, 2 * reach) };
    rh.hit.geomID = rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(s->embree, &q.context, &rh);
    if (!isfinite(q.best)) return false;
    set_point(s, &q.hit, down, out);
    return true;
}
