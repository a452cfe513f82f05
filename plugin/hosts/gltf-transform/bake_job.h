/* SPDX-License-Identifier: MIT
 * One bake that JavaScript asked for: what goes in, what comes out, and who may stop it.
 *
 *     main thread   job_read     -> copies of everything; JavaScript may change its arrays
 *     own thread    job_run      -> scene, light, colours
 *     main thread   result_make  -> objects whose arrays look into the solution
 *
 * The library, with Mesa and LLVM behind it, takes some 20 ms to load, in which the event loop would stand still. So
 * there are two files: hemibake.node knows Node and loads at once; hemibake_work.so knows the library and is loaded by
 * the first bake's own thread.
 */
#ifndef HEMIBAKE_NODE_BAKE_JOB_H
#define HEMIBAKE_NODE_BAKE_JOB_H

#include "option_table.h"

#include <node_api.h>
#include <stdatomic.h>

enum { JOB_MESSAGE_SIZE = 1024 };

/* What arrays in JavaScript look into; freed with the last of them. */
typedef struct job_result {
    atomic_int users;
    hemi_solution *solution;
    void (*destroy)(hemi_solution *solution);
    hemi_statistics statistics;
    uint32_t mesh_count;
    hemi_mesh_view *views; /* of mesh i */
    float **radiance;      /* of mesh i, linear Rec.709 */
    uint16_t **colors;     /* colors[i][4*v+c]: rgb of COLOR_0 and 1, normalised */
} job_result;

typedef struct bake_job {
    hemi_material_desc *materials; /* own copies of what they point to */
    hemi_mesh_desc *meshes;
    hemi_light_desc *lights;
    hemi_sky_desc sky; /* struct_size 0: none */
    uint32_t material_count, mesh_count, light_count;
    options options;
    char *texts[OPTION_COUNT];            /* of options, in the table's order */
    double exposure_ev, clipped_fraction; /* out */
    atomic_bool stop;
    hemi_result code;
    char message[JOB_MESSAGE_SIZE]; /* why code is not HEMI_OK */
    job_result *result;
    void (*report)(void *user, const hemi_progress *progress);
    void *report_user;
} bake_job;

/* given: [[index in OPTIONS, text], ...] of those that are given, in the table's order. False: an exception is
 * pending. */
bool job_read(napi_env env, napi_value scene, napi_value given, bake_job *job);
void job_free(bake_job *job);

/* { meshes, statistics, exposure, clippedFraction } */
napi_value result_make(napi_env env, const bake_job *job);
void result_release(job_result *result);

/* What hemibake_work.so exports. */
typedef void job_run_fn(bake_job *job);
job_run_fn job_run;

/* Fills views, radiance and colors of job->result. */
hemi_result job_color(bake_job *job);

/* Materials, lights and sky from linear Rec.709 to the space that light is added up in. */
hemi_result job_convert_colors(bake_job *job);

#endif
