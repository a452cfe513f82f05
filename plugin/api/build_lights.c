/* SPDX-License-Identifier: MIT
 * How do the host's lights and sky become what the core looks for light from?
 */
#include "build_scene.h"

static punctual punctual_of(const hemi_light_desc *in) {
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

hemi_result scene_lights(const hemi_scene *in, lights *out, punctual **memory) {
    *memory = block_new(&in->context->memory, (in->light_count + 1) * sizeof **memory);
    if (!*memory) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < in->light_count; i++) (*memory)[i] = punctual_of(&in->lights[i]);
    *out = (lights){ .punctual = *memory,
                     .punctual_count = in->light_count,
                     .sky_is_given = in->sky.struct_size > 0,
                     .sky_image = { in->sky.image, in->sky.width, in->sky.height } };
    vec3_copy(out->sky_radiance, in->sky.radiance);
    return HEMI_OK;
}
