/* SPDX-License-Identifier: MIT
 * Which lights and which sky may enter a scene? Every rule of hemibake.h about them is checked here, once; and handed
 * on, as the core takes them.
 */
#include "build_scene.h"
#include "desc_size.h"
#include "geometry/vec3.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

/* Radiance leaves as float; a scene lit by more than this would not fit. */
static const double LIGHT_MAX = 1e30;

static const uint32_t SIDE_MAX = 65536;

static bool is_light(const double rgb[3]) {
    for (int c = 0; c < 3; c++)
        if (!(rgb[c] >= 0.0 && rgb[c] <= LIGHT_MAX)) return false;
    return true;
}

/* ---- lights ---- */

static const char *profile_fault(const hemi_light_desc *l, double length) {
    if (!(length > 0.0 && isfinite(length))) return "it has a profile, but its direction has no length";
    if (l->profile_rows < 2 || l->profile_rows > SIDE_MAX || l->profile_columns < 1 || l->profile_columns > SIDE_MAX)
        return "its profile has not 2 to 65536 rows of 1 to 65536 columns";
    for (size_t i = 0; i < (size_t)l->profile_rows * l->profile_columns; i++)
        if (!(l->profile[i] >= 0.0f) || isinf(l->profile[i])) return "a number of its profile is negative or none";
    for (int k = 0; k < 3; k++)
        if (!isfinite(l->profile_axis[k])) return "the axis of its profile is not finite";
    return NULL;
}

static const char *light_fault(const hemi_light_desc *l) {
    double length = hypot(hypot(l->direction[0], l->direction[1]), l->direction[2]);
    if ((unsigned)l->kind > HEMI_LIGHT_DIRECTIONAL) return "its kind is unknown";
    if (!is_light(l->intensity)) return "its intensity is not a number from 0 to 1e30";
    for (int k = 0; k < 3; k++)
        if (l->kind != HEMI_LIGHT_DIRECTIONAL && !isfinite(l->position[k])) return "its position is not finite";
    if (l->kind != HEMI_LIGHT_POINT && !(length > 0.0 && isfinite(length))) return "its direction has no length";
    if (l->kind != HEMI_LIGHT_DIRECTIONAL && (!(l->range >= 0.0) || isinf(l->range))) return "its range is negative";
    if (l->kind == HEMI_LIGHT_DIRECTIONAL && !(l->angular_diameter >= 0.0 && l->angular_diameter < 0.5 * PI))
        return "its angular diameter is not from 0 to a quarter turn";
    if (l->kind == HEMI_LIGHT_POINT && l->profile) return profile_fault(l, length);
    double outer = l->outer_cone > 0.0 ? l->outer_cone : 0.25 * PI;
    if (l->kind == HEMI_LIGHT_SPOT && !(l->inner_cone >= 0.0 && l->inner_cone <= outer && outer <= 0.5 * PI + 1e-6))
        return "its cone is not 0 <= inner <= outer <= a quarter turn";
    return NULL;
}

hemi_result hemi_scene_add_light(hemi_scene *in, const hemi_light_desc *given, uint32_t *out_index) {
    hemi_light_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_light_desc, direction);
    if (!in || !desc_take(in->context, "light", given, least, &known, sizeof known)) return HEMI_ERROR_ARGUMENT;
    const char *fault = light_fault(desc);
    if (fault) return context_fail(in->context, HEMI_ERROR_DATA, "light '%s': %s", desc->name ? desc->name : "", fault);
    if (!block_grow(&in->context->memory, (void **)&in->lights, &in->light_capacity, in->light_count,
                    sizeof *in->lights))
        return context_out_of_memory(in->context);
    hemi_light_desc *copy = &in->lights[in->light_count];
    float *profile = NULL;
    if (desc->kind == HEMI_LIGHT_POINT && desc->profile) {
        size_t size = (size_t)desc->profile_rows * desc->profile_columns * sizeof *profile;
        profile = block_new(&in->context->memory, size);
        if (!profile) return context_out_of_memory(in->context);
        memcpy(profile, desc->profile, size);
    }
    *copy = *desc;
    copy->name = NULL;
    copy->profile = profile;
    if (copy->outer_cone <= 0.0) copy->outer_cone = 0.25 * PI;
    if (out_index) *out_index = (uint32_t)in->light_count;
    in->light_count++;
    return HEMI_OK;
}

/* ---- sky ---- */

static const char *sky_fault(const hemi_sky_desc *d) {
    if (!is_light(d->radiance)) return "its radiance is not a number from 0 to 1e30";
    if (!d->image) return NULL;
    if (d->width == 0 || d->height == 0 || d->width > SIDE_MAX || d->height > SIDE_MAX)
        return "its image is not 1 to 65536 texels wide and high";
    for (size_t i = 0; i < 3 * (size_t)d->width * d->height; i++)
        if (!(d->image[i] >= 0.0f) || isinf(d->image[i])) return "a texel is negative or not a number";
    return NULL;
}

hemi_result hemi_scene_set_sky(hemi_scene *in, const hemi_sky_desc *given) {
    hemi_sky_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_sky_desc, radiance);
    if (!in || !desc_take(in->context, "sky", given, least, &known, sizeof known)) return HEMI_ERROR_ARGUMENT;
    const char *fault = sky_fault(desc);
    if (fault) return context_fail(in->context, HEMI_ERROR_DATA, "sky: %s", fault);
    float *image = NULL;
    if (desc->image) {
        size_t size = 3 * (size_t)desc->width * desc->height * sizeof *image;
        image = block_new(&in->context->memory, size);
        if (!image) return context_out_of_memory(in->context);
        memcpy(image, desc->image, size);
    }
    block_free(in->sky_image);
    in->sky_image = image;
    in->sky = *desc;
    in->sky.image = image;
    return HEMI_OK;
}

/* ---- for the core ---- */

static punctual punctual_of(const hemi_light_desc *in) {
    static const punctual_kind kinds[] = { [HEMI_LIGHT_POINT] = PUNCTUAL_POINT,
                                           [HEMI_LIGHT_SPOT] = PUNCTUAL_SPOT,
                                           [HEMI_LIGHT_DIRECTIONAL] = PUNCTUAL_DIRECTIONAL };
    punctual out = { .kind = kinds[in->kind],
                     .cos_inner = cos(in->inner_cone),
                     .cos_outer = cos(in->outer_cone),
                     .range = in->range,
                     .angular_diameter = in->angular_diameter,
                     .profile = in->profile,
                     .profile_rows = in->profile_rows,
                     .profile_columns = in->profile_columns };
    vec3_copy(out.intensity, in->intensity);
    vec3_copy(out.position, in->position);
    vec3_copy(out.direction, in->direction);
    vec3_normalize(out.direction);
    if (in->profile) punctual_set_aside(&out, in->profile_axis);
    return out;
}

hemi_result scene_lights(const hemi_scene *in, lights *out, punctual **memory) {
    *memory = block_new(&in->context->memory, (in->light_count + 1) * sizeof **memory);
    if (!*memory) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < in->light_count; i++) (*memory)[i] = punctual_of(&in->lights[i]);
    *out = (lights){ .punctual = *memory,
                     .punctual_count = in->light_count,
                     .sky_is_given = in->sky.struct_size > 0,
                     .sky_image = { .radiance = in->sky.image, .width = in->sky.width, .height = in->sky.height } };
    vec3_copy(out->sky_radiance, in->sky.radiance);
    return HEMI_OK;
}

hemi_result scene_groups(const hemi_scene *in, const bake_options *options, arena *memory, light_groups_input *out) {
    uint32_t *of_mesh = arena_alloc(memory, in->mesh_count, sizeof *of_mesh), count = options->light_groups;
    uint32_t *of_light = arena_alloc(memory, in->light_count, sizeof *of_light);
    bool is_beyond = in->sky.light_group >= count;
    if (!of_mesh || !of_light) return HEMI_ERROR_MEMORY;
    *out = (light_groups_input){ of_mesh, of_light, in->sky.light_group };
    for (size_t i = 0; i < in->mesh_count; i++) is_beyond |= (of_mesh[i] = in->meshes[i].desc.light_group) >= count;
    for (size_t i = 0; i < in->light_count; i++) is_beyond |= (of_light[i] = in->lights[i].light_group) >= count;
    if (count == 0 || !is_beyond) return HEMI_OK;
    return context_fail(in->context, HEMI_ERROR_ARGUMENT, "a light belongs to none of %u groups", count);
}
