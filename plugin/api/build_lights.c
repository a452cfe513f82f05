/* SPDX-License-Identifier: MIT
 * How do the host's lights and sky become what the core looks for light from?
 */
#include "build_scene.h"

/* Two directions that are square to the aim: where the profile's columns begin, and a quarter turn on. */
static void set_frame(const hemi_light_desc *in, punctual *out) {
    double along = vec3_dot(in->profile_axis, out->direction), back[3], other[3];
    for (int k = 0; k < 3; k++) {
        out->aside[0][k] = in->profile_axis[k] - along * out->direction[k];
        back[k] = -out->direction[k];
    }
    if (!(vec3_normalize(out->aside[0]) > 1e-9)) vec3_tangents(back, out->aside[0], other);
    vec3_cross(out->aside[1], back, out->aside[0]);
}

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
    if (in->profile) set_frame(in, &out);
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
