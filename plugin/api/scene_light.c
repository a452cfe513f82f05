/* SPDX-License-Identifier: MIT
 * See scene_light.h.
 */
#include "scene_light.h"

#include "base/block.h"
#include "geometry/vec3.h"

#include <string.h>

bool scene_light_surfaces_emit(const bake_scene *f) {
    for (size_t i = 0; i < f->mesh.patch_count; i++)
        if (material_emits(&f->mesh.patches[i].material)) return true;
    return false;
}

static punctual light_of_desc(const hemi_light_desc *in) {
    static const punctual_kind kinds[] = { [HEMI_LIGHT_POINT] = PUNCTUAL_POINT,
                                           [HEMI_LIGHT_SPOT] = PUNCTUAL_SPOT,
                                           [HEMI_LIGHT_DIRECTIONAL] = PUNCTUAL_DIRECTIONAL };
    punctual out = { .kind = kinds[in->kind],
                     .cos_inner = cos(in->inner_cone),
                     .cos_outer = cos(in->outer_cone),
                     .range = in->range,
                     .angular_diameter = in->angular_diameter };
    vec3_copy(out.intensity, in->intensity);
    vec3_copy(out.position, in->position);
    vec3_copy(out.direction, in->direction);
    vec3_normalize(out.direction);
    return out;
}

static bool take_lights(const hemi_scene *in, scene_light *out) {
    out->lights = block_new(&in->context->memory, (in->light_count + 1) * sizeof *out->lights);
    for (size_t i = 0; out->lights && i < in->light_count; i++) out->lights[i] = light_of_desc(&in->lights[i]);
    return out->lights;
}

static bool take_sky(const hemi_scene *in, int fineness, bool emits, scene_light *out) {
    static const double one[3] = { 1, 1, 1 };
    bool given = in->sky.struct_size > 0;
    const sky_image image = { in->sky.image, in->sky.width, in->sky.height };
    out->sky_by_default = !given && in->light_count == 0 && !emits;
    out->has_sky = given || out->sky_by_default;
    if (!out->has_sky) return true;
    return sky_create(&in->context->memory, given ? in->sky.radiance : one, given && in->sky.image ? &image : NULL,
                      fineness, &out->sky);
}

typedef struct watcher {
    bool (*progress)(void *user, double fraction);
    void *user;
} watcher;

static hemi_result arrive(const hemi_scene *in, hemi_quality quality, const bake_scene *f, const mesh *receiving,
                          const sky *above, double deadline_s, const watcher *w, scene_light *l, direct_light *out) {
    direct_light_quality q = quality_direct_light(quality);
    double begin = monotonic_seconds();
    char message[160];
    direct_light_setup setup = { .scene = &f->scene,
                                 .mesh = receiving,
                                 .items = &f->items,
                                 .triangle_surface = f->triangle_surface,
                                 .lights = l->lights,
                                 .light_count = in->light_count,
                                 .sky = above,
                                 .resolution = q.resolution,
                                 .resolution_sky = q.resolution_sky,
                                 .sun_directions = q.sun_directions,
                                 .jobs = in->context->jobs,
                                 .deadline_s = deadline_s,
                                 .clock = monotonic_seconds,
                                 .progress = w->progress,
                                 .progress_user = w->user };
    const char *failure = direct_light_compute(&setup, out, message, sizeof message);
    l->seconds += monotonic_seconds() - begin;
    if (failure) return context_core_failure(in->context, failure);
    return out->cancelled ? HEMI_CANCELLED : HEMI_OK;
}

hemi_result scene_light_compute(const hemi_scene *in, hemi_quality quality, double deadline_s, const bake_scene *f,
                                bool (*progress)(void *user, double fraction), void *user, scene_light *out) {
    bool emits = scene_light_surfaces_emit(f);
    const watcher w = { progress, user };
    if (!take_lights(in, out) || !take_sky(in, quality_direct_light(quality).fineness, emits, out))
        return HEMI_ERROR_MEMORY;
    if (out->sky_by_default)
        context_log(in->context, HEMI_LOG_WARNING, "nothing in the scene emits light; a sky of radiance 1 lights it");
    if (!out->has_sky && in->light_count == 0) return HEMI_OK;
    const sky *above = out->has_sky ? &out->sky : NULL;
    hemi_result result = arrive(in, quality, f, &f->mesh, above, deadline_s, &w, out, &out->direct_light);
    if (result != HEMI_OK) return result;
    if (!emits && !(out->direct_light.punctual_w + out->direct_light.sky_w > 0.0))
        return context_fail(in->context, HEMI_ERROR_NO_LIGHT,
                            "no light reaches the front of a surface: fronts are "
                            "where corners run counter-clockwise; turn them, or make materials double-sided");
    return HEMI_OK;
}

hemi_result scene_light_punctual(const hemi_scene *in, hemi_quality quality, const bake_scene *f, const mesh *receiving,
                                 scene_light *l, direct_light *out) {
    const watcher none = { NULL, NULL };
    allocator *memory = jobs_memory(in->context->jobs);
    if (in->light_count > 0) return arrive(in, quality, f, receiving, NULL, 0.0, &none, l, out);
    out->irradiance = block_zeroed(memory, 3 * receiving->sample_count + 1, sizeof *out->irradiance);
    out->row_sum = block_zeroed(memory, receiving->sample_count + 1, sizeof *out->row_sum);
    return out->irradiance && out->row_sum ? HEMI_OK : HEMI_ERROR_MEMORY;
}

const double *scene_light_irradiance(const scene_light *l) {
    return l->direct_light.irradiance;
}

void scene_light_free(scene_light *l) {
    block_free(l->lights);
    sky_free(&l->sky);
    direct_light_free(&l->direct_light);
    memset(l, 0, sizeof *l);
}
