/* SPDX-License-Identifier: MIT */
#include "input.h"

#include "panorama_decode.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double PI = 3.14159265358979323846;

double input_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- options ----------------------------------------------------------------------------------------------------- */

static bool parse_sun(const char *text, input_options *o) {
    int end = 0;
    o->sun[3] = 0.533; /* as the command's */
    o->has_sun = sscanf(text, "%lf,%lf,%lf%n,%lf%n", &o->sun[0], &o->sun[1], &o->sun[2], &end, &o->sun[3], &end) >= 3 &&
                 !text[end];
    return o->has_sun;
}

static bool parse_number(const char *text, double *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && *out >= 0;
}

/* The options that are a number; false: none of them. */
static bool set_number(const char *name, double x, input_options *o) {
    if (strcmp(name, "--samples") == 0)
        o->samples = (uint32_t)x;
    else if (strcmp(name, "--seconds") == 0)
        o->seconds = x;
    else if (strcmp(name, "--threads") == 0)
        o->threads = (uint32_t)x;
    else if (strcmp(name, "--seed") == 0)
        o->seed = (uint64_t)x;
    else if (strcmp(name, "--limit") == 0)
        o->limit = (uint32_t)x;
    else if (strcmp(name, "--edge") == 0)
        o->edge = x;
    else
        return false;
    return true;
}

static bool set_option(const char *name, const char *value, input_options *o) {
    double x;
    if (!value) return false;
    if (strcmp(name, "--sun") == 0) return parse_sun(value, o);
    if (strcmp(name, "--environment") == 0)
        o->environment = value;
    else if (strcmp(name, "--normals") == 0 && (strcmp(value, "faces") == 0 || strcmp(value, "file") == 0))
        o->faces = strcmp(value, "faces") == 0;
    else if (strcmp(name, "-o") == 0)
        o->output = value;
    else
        return parse_number(value, &x) && set_number(name, x, o);
    return true;
}

bool input_parse(int argc, char **argv, input_options *o) {
    *o = (input_options){ .seed = 1 };
    for (int i = 1; i < argc; i++) {
        if (argv[i][0] != '-' && o->file_count < 4) {
            o->files[o->file_count++] = argv[i];
        } else if (strcmp(argv[i], "--json") == 0) {
            o->json = true;
        } else if (!set_option(argv[i], argv[i + 1], o)) { /* argv[argc] is NULL */
            fprintf(stderr, "%s: %s is no option, or its value is malformed\n", argv[0], argv[i]);
            return false;
        } else {
            i++;
        }
    }
    return true;
}

/* ---- scene ------------------------------------------------------------------------------------------------------- */

static bool add_meshes(input *in) {
    bool ok = true;
    for (uint32_t m = 0; ok && m < gltf_asset_material_count(in->asset); m++) {
        hemi_material_desc material;
        ok = gltf_asset_material(in->asset, m, &material) && traced_scene_add_material(&in->scene, &material);
    }
    for (uint32_t i = 0; ok && i < gltf_asset_mesh_count(in->asset); i++) {
        hemi_mesh_desc mesh;
        ok = gltf_asset_mesh(in->asset, i, &mesh);
        gltf_asset_texture(in->asset, i, &mesh);
        if (gltf_asset_mesh_is_unlit(in->asset, i)) mesh.triangle_count = 0;
        if (mesh.subdivision && mesh.subdivision->scheme != HEMI_SUBDIVISION_NONE)
            fprintf(stderr, "%s is traced as the cage it is, not as the surface that it asks for\n", mesh.name);
        ok = ok && traced_scene_add_mesh(&in->scene, &mesh);
    }
    return ok;
}

static hemi_light_desc sun_light(const double sun[4]) {
    double azimuth = sun[0] * PI / 180, elevation = sun[1] * PI / 180;
    return (hemi_light_desc){ .kind = HEMI_LIGHT_DIRECTIONAL,
                              .intensity = { sun[2], sun[2], sun[2] },
                              .direction = { -cos(elevation) * sin(azimuth), -sin(elevation),
                                             cos(elevation) * cos(azimuth) },
                              .angular_diameter = sun[3] * PI / 180 };
}

static bool read_panorama(const char *path, hdr_image *out) {
    char note[PANORAMA_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    uint8_t *bytes = size > 0 ? malloc((size_t)size) : NULL;
    bool ok = bytes && fseek(file, 0, SEEK_SET) == 0 && fread(bytes, 1, (size_t)size, file) == (size_t)size;
    ok = ok && panorama_decode(bytes, (size_t)size, out, note, message) == HEMI_OK;
    free(bytes);
    fclose(file);
    return ok;
}

static bool set_sky(input *in, const char *environment) {
    hemi_sky_desc sky = { .radiance = { 1, 1, 1 } };
    if (!environment) {
        if (gltf_asset_sky(in->asset, &sky)) in->scene.sky = sky;
        return true;
    }
    if (sscanf(environment, "%lf,%lf,%lf", &sky.radiance[0], &sky.radiance[1], &sky.radiance[2]) != 3) {
        if (!read_panorama(environment, &in->panorama)) {
            fprintf(stderr, "%s is neither R,G,B nor a panorama that can be read\n", environment);
            return false;
        }
        sky.image = in->panorama.rgb;
        sky.width = in->panorama.width;
        sky.height = in->panorama.height;
    }
    in->scene.sky = sky;
    return true;
}

static bool add_lights(input *in, const input_options *o) {
    bool ok = true;
    hemi_light_desc light;
    for (uint32_t i = 0; ok && gltf_asset_light(in->asset, i, &light); i++)
        ok = traced_scene_add_light(&in->scene, &light);
    if (o->has_sun) light = sun_light(o->sun);
    return ok && (!o->has_sun || traced_scene_add_light(&in->scene, &light)) && set_sky(in, o->environment);
}

bool input_read(const char *path, const input_options *o, input *in) {
    char message[GLTF_MESSAGE_SIZE] = "out of memory";
    memset(in, 0, sizeof *in);
    if (gltf_asset_read(path, &in->asset, message) != HEMI_OK ||
        gltf_asset_read_textures(in->asset, NULL, NULL, message) != HEMI_OK) {
        fprintf(stderr, "%s: %s\n", path, message);
        return false;
    }
    in->scene.faces = o->faces;
    if (!add_meshes(in) || !add_lights(in, o) || !traced_scene_commit(&in->scene) ||
        !traced_lights_create(&in->scene, &in->lights)) {
        fprintf(stderr, "%s: it has no triangles, memory is short, or Embree refuses it\n", path);
        return false;
    }
    in->tracer = (radiance_tracer){ &in->scene, &in->lights, sobol_create(), o->seed };
    return true;
}

void input_destroy(input *in) {
    traced_lights_destroy(&in->lights);
    traced_scene_destroy(&in->scene);
    hdr_image_free(&in->panorama);
    gltf_asset_destroy(in->asset);
}
