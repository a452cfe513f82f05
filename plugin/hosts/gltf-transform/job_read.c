/* SPDX-License-Identifier: MIT
 * How does a scene of JavaScript become descs of the ABI? Only kinds are checked here; the library checks the values.
 */
#include "bake_job.h"
#include "js_value.h"

#include <stdlib.h>
#include <string.h>

static bool refuse(napi_env env, const char *text) {
    napi_throw_type_error(env, "HEMI_ERROR_ARGUMENT", text);
    return false;
}

static bool read_material(napi_env env, napi_value from, hemi_material_desc *out) {
    out->struct_size = sizeof *out;
    return js_get_text(env, from, "name", (char **)&out->name) &&
           js_get_numbers(env, from, "reflectance", out->reflectance, 3) &&
           js_get_numbers(env, from, "emission", out->emission, 3) &&
           js_get_numbers(env, from, "transmission", out->transmission, 3) &&
           js_get_bool(env, from, "doubleSided", &out->double_sided);
}

static bool read_geometry(napi_env env, napi_value from, hemi_mesh_desc *out) {
    size_t positions, normals, attributes, indices;
    if (!js_get_array(env, from, "positions", napi_float32_array, (void **)&out->positions, &positions) ||
        !js_get_array(env, from, "indices", napi_uint32_array, (void **)&out->indices, &indices) ||
        !js_get_array(env, from, "normals", napi_float32_array, (void **)&out->normals, &normals) ||
        !js_get_array(env, from, "attributes", napi_float32_array, (void **)&out->attributes, &attributes) ||
        !js_get_uint32(env, from, "attributeCount", &out->attribute_count))
        return false;
    if (positions % 3 || indices % 3 || positions / 3 > UINT32_MAX || indices / 3 > UINT32_MAX)
        return refuse(env, "hemibake: positions and indices come in threes");
    out->vertex_count = (uint32_t)(positions / 3);
    out->triangle_count = (uint32_t)(indices / 3);
    if (out->normals && normals != positions) return refuse(env, "hemibake: there is not one normal a position");
    if (out->attributes && attributes != (size_t)out->attribute_count * out->vertex_count)
        return refuse(env, "hemibake: there are not attributeCount attributes a position");
    return true;
}

static bool read_mesh(napi_env env, napi_value from, hemi_mesh_desc *out) {
    hemi_subdivision_desc *cage = calloc(1, sizeof *cage);
    uint32_t scheme = 0;
    if (!cage) return refuse(env, "hemibake: out of memory");
    cage->struct_size = sizeof *cage;
    out->subdivision = cage;
    out->struct_size = sizeof *out;
    bool ok = js_get_text(env, from, "name", (char **)&out->name) && read_geometry(env, from, out) &&
              js_get_uint32(env, from, "material", &out->material) &&
              js_get_numbers(env, from, "transform", out->transform, 16) &&
              js_get_uint32(env, from, "subdivision", &scheme) &&
              js_get_uint32(env, from, "subdivisionLevel", &cage->level);
    cage->scheme = (hemi_subdivision_scheme)scheme;
    return ok;
}

static bool read_light(napi_env env, napi_value from, hemi_light_desc *out) {
    uint32_t kind = 0;
    out->struct_size = sizeof *out;
    bool ok = js_get_text(env, from, "name", (char **)&out->name) && js_get_uint32(env, from, "kind", &kind) &&
              js_get_numbers(env, from, "intensity", out->intensity, 3) &&
              js_get_numbers(env, from, "position", out->position, 3) &&
              js_get_numbers(env, from, "direction", out->direction, 3) &&
              js_get_number(env, from, "innerCone", &out->inner_cone) &&
              js_get_number(env, from, "outerCone", &out->outer_cone) &&
              js_get_number(env, from, "range", &out->range) &&
              js_get_number(env, from, "angularDiameter", &out->angular_diameter);
    out->kind = (hemi_light_kind)kind;
    return ok;
}

static bool read_lights(napi_env env, napi_value scene, bake_job *job) {
    napi_value lights, item;
    uint32_t count;
    if (!js_get_list(env, scene, "lights", &lights, &count)) return false;
    job->lights = calloc(count + 1, sizeof *job->lights);
    if (!job->lights) return refuse(env, "hemibake: out of memory");
    job->light_count = count;
    for (uint32_t i = 0; i < count; i++)
        if (napi_get_element(env, lights, i, &item) != napi_ok || !read_light(env, item, &job->lights[i])) return false;
    return true;
}

static bool read_sky(napi_env env, napi_value scene, hemi_sky_desc *out) {
    napi_value sky;
    size_t numbers;
    if (!js_get(env, scene, "sky", &sky)) return false;
    if (!sky) return true;
    out->struct_size = sizeof *out;
    for (int c = 0; c < 3; c++) out->radiance[c] = 1.0;
    if (!js_get_numbers(env, sky, "radiance", out->radiance, 3) || !js_get_uint32(env, sky, "width", &out->width) ||
        !js_get_uint32(env, sky, "height", &out->height) ||
        !js_get_array(env, sky, "image", napi_float32_array, (void **)&out->image, &numbers))
        return false;
    return !out->image || numbers == 3 * (size_t)out->width * out->height ||
           refuse(env, "hemibake: 'image' does not have three numbers a texel");
}

static bool read_scene(napi_env env, napi_value scene, bake_job *job) {
    napi_value materials, meshes, item;
    if (!js_get_list(env, scene, "materials", &materials, &job->material_count)) return false;
    job->materials = calloc(job->material_count + 1, sizeof *job->materials);
    uint32_t mesh_count;
    if (!js_get_list(env, scene, "meshes", &meshes, &mesh_count)) return false;
    job->meshes = calloc(mesh_count + 1, sizeof *job->meshes);
    job->mesh_count = job->meshes ? mesh_count : 0;
    if (!job->materials || !job->meshes) return refuse(env, "hemibake: out of memory");
    for (uint32_t i = 0; i < job->material_count; i++)
        if (napi_get_element(env, materials, i, &item) != napi_ok || !read_material(env, item, &job->materials[i]))
            return false;
    for (uint32_t i = 0; i < job->mesh_count; i++)
        if (napi_get_element(env, meshes, i, &item) != napi_ok || !read_mesh(env, item, &job->meshes[i])) return false;
    return true;
}

/* One [index, text]; index is that of OPTIONS. */
static bool read_option(napi_env env, napi_value pair, bake_job *job) {
    napi_value item;
    double index = -1.0;
    char *text = NULL, message[512] = "hemibake: ";
    if (napi_get_element(env, pair, 0, &item) != napi_ok || napi_get_value_double(env, item, &index) != napi_ok ||
        !(index >= 0 && index < OPTION_COUNT) || napi_get_element(env, pair, 1, &item) != napi_ok ||
        !js_to_text(env, item, &text))
        return refuse(env, "hemibake: an option is not [index, text]");
    const option *o = &OPTIONS[(int)index];
    free(job->texts[(int)index]);
    job->texts[(int)index] = text;
    if (option_set(o, text, &job->options)) return true;
    option_fault(o, text, message + strlen(message), sizeof message - strlen(message));
    return refuse(env, message);
}

static bool read_options(napi_env env, napi_value from, bake_job *job) {
    napi_value pair;
    uint32_t count;
    options_clear(&job->options);
    if (napi_get_array_length(env, from, &count) != napi_ok) return refuse(env, "hemibake: options are not an array");
    for (uint32_t i = 0; i < count; i++)
        if (napi_get_element(env, from, i, &pair) != napi_ok || !read_option(env, pair, job)) return false;
    return true;
}

bool job_read(napi_env env, napi_value scene, napi_value given, bake_job *job) {
    return read_scene(env, scene, job) && read_lights(env, scene, job) && read_sky(env, scene, &job->sky) &&
           read_options(env, given, job);
}

void job_free(bake_job *job) {
    for (uint32_t i = 0; job->materials && i < job->material_count; i++) free((void *)job->materials[i].name);
    for (uint32_t i = 0; i < job->mesh_count; i++) {
        free((void *)job->meshes[i].name);
        free((void *)job->meshes[i].positions);
        free((void *)job->meshes[i].normals);
        free((void *)job->meshes[i].attributes);
        free((void *)job->meshes[i].indices);
        free((void *)job->meshes[i].subdivision);
    }
    for (uint32_t i = 0; i < job->light_count; i++) free((void *)job->lights[i].name);
    free((void *)job->sky.image);
    for (int i = 0; i < OPTION_COUNT; i++) free(job->texts[i]);
    free(job->materials);
    free(job->meshes);
    free(job->lights);
    result_release(job->result);
    free(job);
}
