/* SPDX-License-Identifier: MIT
 * Which scene is asked for, under which light? A glTF asset as `hemibake bake` reads it with --scene-linear, and the
 * options --sun and --environment as it takes them. Messages go to stderr.
 */
#ifndef HEMIBAKE_ORACLE_INPUT_H
#define HEMIBAKE_ORACLE_INPUT_H

#include "gltf_asset.h"
#include "image_decode.h"
#include "radiance.h"

typedef struct input_options {
    const char *files[4]; /* what is no option, in order */
    int file_count;
    const char *environment;   /* R,G,B or FILE.hdr|.exr */
    const char *output;        /* -o */
    double sun[4];             /* azimuth, elevation, irradiance, angular diameter; degrees */
    bool has_sun, json, faces; /* faces: --normals faces */
    double edge, seconds;      /* m; s, 0: no limit */
    uint32_t samples, threads, limit;
    uint64_t seed;
} input_options;

/* False, with a line on stderr: an option that is unknown or malformed. */
bool input_parse(int argc, char **argv, input_options *out);

typedef struct input {
    gltf_asset *asset;
    hdr_image panorama;
    traced_scene scene;
    traced_lights lights;
    radiance_tracer tracer;
} input;

/* False, with a line on stderr. Destroy either way. */
bool input_read(const char *path, const input_options *o, input *out);
void input_destroy(input *in);

double input_clock(void); /* s */

#endif
