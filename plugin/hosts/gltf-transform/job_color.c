/* SPDX-License-Identifier: MIT
 * How does radiance become COLOR_0? Metered, exposed, through the view of an OpenColorIO configuration, to 16 bits.
 */
#include "bake_job.h"

#include "color_input.h"
#include "color_transform.h"
#include "exposure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static hemi_result open_transform(bake_job *job, color_transform **out) {
    const options *o = &job->options;
    const char *from_environment = getenv("OCIO");
    const char *config = o->ocio ? o->ocio : from_environment && *from_environment ? from_environment : NULL;
    const color_transform_desc desc = { .config = config,
                                        .display = o->display,
                                        .view = o->view,
                                        .look = o->look,
                                        .working_space = o->working_space };
    return color_transform_create(&desc, out, job->message);
}

static hemi_result convert(const color_input *input, double rgb[3]) {
    float color[3] = { (float)rgb[0], (float)rgb[1], (float)rgb[2] };
    if (color_input_is_identity(input)) return HEMI_OK;
    hemi_result result = color_input_apply(input, color, 1, NULL);
    for (int c = 0; c < 3; c++) rgb[c] = color[c];
    return result;
}

static hemi_result convert_sky(const color_input *input, hemi_sky_desc *sky) {
    if (sky->image && !color_input_is_identity(input)) {
        hemi_result result = color_input_apply(input, (float *)sky->image, (size_t)sky->width * sky->height, NULL);
        if (result != HEMI_OK) return result;
    }
    /* With an image it is a factor, in whatever space. */
    return sky->image ? HEMI_OK : convert(input, sky->radiance);
}

hemi_result job_convert_colors(bake_job *job) {
    const color_input_desc factors = { .origin = COLOR_ORIGIN_FACTOR };
    color_transform *transform = NULL;
    color_input *input = NULL;
    hemi_result result = open_transform(job, &transform);
    if (result == HEMI_OK) result = color_input_create(transform, &factors, &input, job->message);
    for (uint32_t i = 0; result == HEMI_OK && i < job->material_count; i++) {
        result = convert(input, job->materials[i].reflectance);
        if (result == HEMI_OK) result = convert(input, job->materials[i].emission);
    }
    for (uint32_t i = 0; result == HEMI_OK && i < job->light_count; i++)
        result = convert(input, job->lights[i].intensity);
    if (result == HEMI_OK) result = convert_sky(input, &job->sky);
    color_input_destroy(input);
    color_transform_destroy(transform);
    return result;
}

/* ---- metering ---------------------------------------------------------------------------------------------------- */

static seen_mesh seen_mesh_of(const bake_job *job, uint32_t i, const hemi_mesh_view *v) {
    seen_mesh out = { .positions = v->positions,
                      .radiance = job->result->radiance[i],
                      .indices = v->indices,
                      .triangle_count = v->triangle_count };
    memcpy(out.transform, job->meshes[i].transform, sizeof out.transform);
    memcpy(out.emission, job->materials[job->meshes[i].material].emission, sizeof out.emission);
    return out;
}

static hemi_result meter(bake_job *job, const color_transform *transform, const hemi_mesh_view *views) {
    seen_mesh *meshes = calloc(job->mesh_count + 1, sizeof *meshes);
    seen_points seen = { 0 };
    for (uint32_t i = 0; meshes && i < job->mesh_count; i++) meshes[i] = seen_mesh_of(job, i, &views[i]);
    bool ok = meshes && seen_points_find(meshes, job->mesh_count, NULL, 0, job->options.threads, &seen);
    if (ok) job->exposure_ev = exposure_meter(seen.points, seen.count, color_transform_white(transform));
    free(seen.points);
    free(meshes);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* ---- colours ----------------------------------------------------------------------------------------------------- */

/* A configuration that cannot say what linear Rec.709 is gives its own values. */
static hemi_result to_rec709(const color_transform *transform, const hemi_mesh_view *view, float **out) {
    *out = malloc((3 * (size_t)view->vertex_count + 1) * sizeof **out);
    if (!*out) return HEMI_ERROR_MEMORY;
    memcpy(*out, view->radiance, 3 * (size_t)view->vertex_count * sizeof **out);
    hemi_result result = color_transform_apply_rec709(transform, *out, view->vertex_count);
    return result == HEMI_ERROR_UNSUPPORTED ? HEMI_OK : result;
}

static void quantise(const float *rgb, size_t count, uint16_t *out) {
    for (size_t v = 0; v < count; v++) {
        for (int c = 0; c < 3; c++) out[4 * v + c] = (uint16_t)lround(fmin(fmax(rgb[3 * v + c], 0), 1) * 65535);
        out[4 * v + 3] = 65535;
    }
}

static hemi_result color_mesh(bake_job *job, const color_transform *transform, const hemi_mesh_view *view, uint32_t i,
                              size_t *clipped) {
    const size_t count = view->vertex_count;
    const float *from = job->options.scene_linear ? job->result->radiance[i] : view->radiance;
    float *rgb = malloc((3 * count + 1) * sizeof *rgb);
    job->result->colors[i] = malloc((4 * count + 1) * sizeof *job->result->colors[i]);
    hemi_result result = rgb && job->result->colors[i] ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) memcpy(rgb, from, 3 * count * sizeof *rgb);
    if (result == HEMI_OK && !job->options.scene_linear) {
        size_t outside = 0;
        exposure_apply(rgb, count, job->exposure_ev);
        result = color_transform_apply(transform, rgb, count, &outside);
        *clipped += outside;
    }
    if (result == HEMI_OK) quantise(rgb, count, job->result->colors[i]);
    free(rgb);
    return result;
}

static hemi_result color_all(bake_job *job, const color_transform *transform, hemi_mesh_view *views) {
    size_t vertex_count = 0, clipped = 0;
    hemi_result result = HEMI_OK;
    for (uint32_t i = 0; result == HEMI_OK && i < job->mesh_count; i++) {
        views[i].struct_size = sizeof views[i];
        result = hemi_solution_mesh(job->result->solution, i, &views[i]);
        if (result == HEMI_OK) result = to_rec709(transform, &views[i], &job->result->radiance[i]);
        vertex_count += views[i].vertex_count;
    }
    job->exposure_ev = job->options.scene_linear ? 0.0 : job->options.exposure.ev;
    if (result == HEMI_OK && !job->options.exposure.is_fixed && !job->options.scene_linear)
        result = meter(job, transform, views);
    for (uint32_t i = 0; result == HEMI_OK && i < job->mesh_count; i++)
        result = color_mesh(job, transform, &views[i], i, &clipped);
    job->clipped_fraction = vertex_count ? (double)clipped / (double)vertex_count : 0.0;
    return result;
}

hemi_result job_color(bake_job *job) {
    color_transform *transform = NULL;
    hemi_mesh_view *views = job->result->views = calloc(job->mesh_count + 1, sizeof *views);
    job->result->mesh_count = job->mesh_count;
    job->result->radiance = calloc(job->mesh_count + 1, sizeof *job->result->radiance);
    job->result->colors = calloc(job->mesh_count + 1, sizeof *job->result->colors);
    hemi_result result = views && job->result->radiance && job->result->colors ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) result = open_transform(job, &transform);
    if (result == HEMI_OK) result = color_all(job, transform, views);
    color_transform_destroy(transform);
    return result;
}
