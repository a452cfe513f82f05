/* SPDX-License-Identifier: MIT
 * Which lights and which sky may enter a scene? Every rule of hemibake.h about them is checked here, once.
 */
#include "desc_size.h"
#include "internal.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

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

hemi_result hemi_scene_add_light(hemi_scene *scene, const hemi_light_desc *given, uint32_t *out_index) {
    hemi_light_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_light_desc, direction);
    if (!scene || !desc_take(scene->context, "light", given, least, &known, sizeof known)) return HEMI_ERROR_ARGUMENT;
    const char *fault = light_fault(desc);
    if (fault)
        return context_fail(scene->context, HEMI_ERROR_DATA, "light '%s': %s", desc->name ? desc->name : "", fault);
    if (!block_grow(&scene->context->memory, (void **)&scene->lights, &scene->light_capacity, scene->light_count,
                    sizeof *scene->lights))
        return context_out_of_memory(scene->context);
    hemi_light_desc *copy = &scene->lights[scene->light_count];
    float *profile = NULL;
    if (desc->kind == HEMI_LIGHT_POINT && desc->profile) {
        size_t size = (size_t)desc->profile_rows * desc->profile_columns * sizeof *profile;
        profile = block_new(&scene->context->memory, size);
        if (!profile) return context_out_of_memory(scene->context);
        memcpy(profile, desc->profile, size);
    }
    *copy = *desc;
    copy->name = NULL;
    copy->profile = profile;
    if (copy->outer_cone <= 0.0) copy->outer_cone = 0.25 * PI;
    if (out_index) *out_index = (uint32_t)scene->light_count;
    scene->light_count++;
    return HEMI_OK;
}

/* ---- sky ---- */

static const char *sky_fault(const hemi_sky_desc *sky) {
    if (!is_light(sky->radiance)) return "its radiance is not a number from 0 to 1e30";
    if (!sky->image) return NULL;
    if (sky->width == 0 || sky->height == 0 || sky->width > SIDE_MAX || sky->height > SIDE_MAX)
        return "its image is not 1 to 65536 texels wide and high";
    for (size_t i = 0; i < 3 * (size_t)sky->width * sky->height; i++)
        if (!(sky->image[i] >= 0.0f) || isinf(sky->image[i])) return "a texel is negative or not a number";
    return NULL;
}

hemi_result hemi_scene_set_sky(hemi_scene *scene, const hemi_sky_desc *given) {
    hemi_sky_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_sky_desc, radiance);
    if (!scene || !desc_take(scene->context, "sky", given, least, &known, sizeof known)) return HEMI_ERROR_ARGUMENT;
    const char *fault = sky_fault(desc);
    if (fault) return context_fail(scene->context, HEMI_ERROR_DATA, "sky: %s", fault);
    float *image = NULL;
    if (desc->image) {
        size_t size = 3 * (size_t)desc->width * desc->height * sizeof *image;
        image = block_new(&scene->context->memory, size);
        if (!image) return context_out_of_memory(scene->context);
        memcpy(image, desc->image, size);
    }
    block_free(scene->sky_image);
    scene->sky_image = image;
    scene->sky = *desc;
    scene->sky.image = image;
    return HEMI_OK;
}
