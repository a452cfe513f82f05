/* SPDX-License-Identifier: MIT
 * What happens on the thread of a bake? The ABI from its beginning to its end.
 */
#include "bake_job.h"

#include <stdio.h>
#include <stdlib.h>

static void hear(void *user, hemi_log_level level, const char *text) {
    bake_job *job = user;
    if (level == HEMI_LOG_ERROR) snprintf(job->message, sizeof job->message, "%s", text);
}

static bool go_on(void *user, const hemi_progress *progress) {
    bake_job *job = user;
    job->report(job->report_user, progress);
    return !atomic_load(&job->stop);
}

static hemi_result fill_scene(bake_job *job, hemi_scene *scene) {
    hemi_result result = job_convert_colors(job);
    for (uint32_t i = 0; result == HEMI_OK && i < job->material_count; i++)
        result = hemi_scene_add_material(scene, &job->materials[i], NULL);
    for (uint32_t i = 0; result == HEMI_OK && i < job->mesh_count; i++)
        result = hemi_scene_add_mesh(scene, &job->meshes[i], NULL);
    for (uint32_t i = 0; result == HEMI_OK && i < job->light_count; i++)
        result = hemi_scene_add_light(scene, &job->lights[i], NULL);
    if (result == HEMI_OK && job->sky.struct_size > 0) result = hemi_scene_set_sky(scene, &job->sky);
    return result;
}

__attribute__((visibility("default"))) void job_run(bake_job *job) {
    hemi_context_desc desc = {
        .struct_size = sizeof desc, .threads = job->options.threads, .log = hear, .log_user = job
    };
    hemi_context *context = NULL;
    hemi_scene *scene = NULL;
    job->result = calloc(1, sizeof *job->result);
    if (job->result) {
        atomic_init(&job->result->users, 1);
        job->result->destroy = hemi_solution_destroy;
        job->result->statistics.struct_size = sizeof job->result->statistics;
    }
    job->options.bake.progress = go_on;
    job->options.bake.progress_user = job;
    job->code = job->result ? hemi_context_create(&desc, &context) : HEMI_ERROR_MEMORY;
    if (job->code == HEMI_OK) job->code = hemi_scene_create(context, &scene);
    if (job->code == HEMI_OK) job->code = fill_scene(job, scene);
    if (job->code == HEMI_OK) job->code = hemi_bake(scene, &job->options.bake, &job->result->solution);
    if (job->code == HEMI_OK) job->code = hemi_solution_statistics(job->result->solution, &job->result->statistics);
    if (job->code == HEMI_OK) job->code = job_color(job);
    if (job->code != HEMI_OK && !*job->message)
        snprintf(job->message, sizeof job->message, "%s", hemi_result_text(job->code));
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
}
