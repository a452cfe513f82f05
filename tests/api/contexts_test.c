/* SPDX-License-Identifier: MIT
 * Are contexts independent? Four threads bake four scenes at once, and each gets the bits that it gets alone.
 */
#include "check.h"

#include <hemibake/plugin_table.h>

#include <pthread.h>
#include <stdlib.h>

enum { HOSTS = 4, FLOATS_MAX = 1 << 20 };

typedef struct host {
    int number;
    bool cancel; /* refuses to go on at the second word of progress */
    hemi_result result;
    uint32_t words;
    size_t count;
    float *radiance; /* of both meshes, one after the other */
} host;

static bool heard(void *user, const hemi_progress *progress) {
    host *h = user;
    (void)progress;
    return !(++h->words > 1 && h->cancel);
}

/* A floor under an emitter, whose height and light are the host's number. */
static hemi_result add_scene(const host *h, hemi_scene *scene) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    const float y = 1.0f + 0.25f * (float)h->number;
    const float floor[12] = { 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0 },
                emitter[12] = { 0, y, 0, 1, y, 0, 1, y, 1, 0, y, 1 };
    const float *positions[] = { floor, emitter };
    hemi_result result = HEMI_OK;
    for (int i = 0; result == HEMI_OK && i < 2; i++) {
        hemi_material_desc material = { .struct_size = sizeof material, .reflectance = { 0.5, 0.6, 0.7 } };
        hemi_mesh_desc mesh = {
            .struct_size = sizeof mesh, .vertex_count = 4, .triangle_count = 2, .indices = indices
        };
        for (int c = 0; i == 1 && c < 3; c++) material.emission[c] = 1 + h->number + c;
        mesh.positions = positions[i];
        result = hemi_plugin_table.scene_add_material(scene, &material, &mesh.material);
        if (result == HEMI_OK) result = hemi_plugin_table.scene_add_mesh(scene, &mesh, NULL);
    }
    return result;
}

static void keep(host *h, const hemi_solution *solution) {
    h->radiance = malloc(FLOATS_MAX * sizeof *h->radiance);
    for (uint32_t i = 0; h->radiance && i < 2; i++) {
        hemi_mesh_view view = { .struct_size = sizeof view };
        h->result = hemi_plugin_table.solution_mesh(solution, i, &view);
        size_t count = 3 * (size_t)view.vertex_count;
        if (h->result != HEMI_OK || h->count + count > FLOATS_MAX) return;
        memcpy(h->radiance + h->count, view.radiance, count * sizeof *view.radiance);
        h->count += count;
    }
}

static void *bake(void *user) {
    host *h = user;
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 2 };
    hemi_bake_desc wish = {
        .struct_size = sizeof wish, .quality = HEMI_QUALITY_DRAFT, .progress = heard, .progress_user = h
    };
    hemi_context *context = NULL;
    hemi_scene *scene = NULL;
    hemi_solution *solution = NULL;
    h->result = hemi_plugin_table.context_create(&desc, &context);
    if (h->result == HEMI_OK) h->result = hemi_plugin_table.scene_create(context, &scene);
    if (h->result == HEMI_OK) h->result = add_scene(h, scene);
    if (h->result == HEMI_OK) h->result = hemi_plugin_table.bake(scene, &wish, &solution);
    if (h->result == HEMI_OK) keep(h, solution);
    hemi_plugin_table.solution_destroy(solution);
    hemi_plugin_table.scene_destroy(scene);
    hemi_plugin_table.context_destroy(context);
    return NULL;
}

static void bake_at_once(host hosts[HOSTS]) {
    pthread_t threads[HOSTS];
    for (int i = 0; i < HOSTS; i++) CHECK_EQUAL(pthread_create(&threads[i], NULL, bake, &hosts[i]), 0);
    for (int i = 0; i < HOSTS; i++) pthread_join(threads[i], NULL);
}

static void four_bakes_at_once_give_the_bits_of_each_alone(void) {
    host together[HOSTS] = { 0 };
    for (int i = 0; i < HOSTS; i++) together[i].number = i;
    bake_at_once(together);
    for (int i = 0; i < HOSTS; i++) {
        host alone = { .number = i };
        bake(&alone);
        CHECK_EQUAL(alone.result, HEMI_OK);
        CHECK_EQUAL(together[i].result, HEMI_OK);
        CHECK(alone.count > 0);
        CHECK_EQUAL(together[i].count, alone.count);
        if (alone.count == together[i].count && alone.radiance && together[i].radiance)
            CHECK(memcmp(alone.radiance, together[i].radiance, alone.count * sizeof(float)) == 0);
        free(alone.radiance);
        free(together[i].radiance);
    }
}

static void who_cancels_stops_only_itself(void) {
    host hosts[HOSTS] = { 0 };
    for (int i = 0; i < HOSTS; i++) hosts[i].number = i, hosts[i].cancel = i % 2 == 0;
    bake_at_once(hosts);
    for (int i = 0; i < HOSTS; i++) {
        CHECK_EQUAL(hosts[i].result, hosts[i].cancel ? HEMI_CANCELLED : HEMI_OK);
        free(hosts[i].radiance);
    }
}

static void a_desc_of_an_older_header_has_the_defaults(void) {
    hemi_context *context = NULL;
    hemi_context_desc desc = { .struct_size = offsetof(hemi_context_desc, log), .log_user = &desc };
    desc.log = (hemi_log_fn)(uintptr_t)1; /* past the end of an old desc: never called */
    CHECK_EQUAL(hemi_context_create(&desc, &context), HEMI_OK);
    CHECK_EQUAL(hemi_scene_create(context, NULL), HEMI_ERROR_ARGUMENT);
    hemi_scene *scene = NULL;
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, NULL, NULL), HEMI_ERROR_ARGUMENT);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
}

static void the_table_says_what_it_is(void) {
    CHECK_EQUAL(hemi_plugin_table.struct_size, sizeof(hemi_plugin));
    CHECK_EQUAL(hemi_plugin_table.abi, HEMI_PLUGIN_ABI);
    CHECK_TEXT(hemi_plugin_table.version(), HEMI_VERSION_STRING);
}

int main(void) {
    RUN(four_bakes_at_once_give_the_bits_of_each_alone);
    RUN(who_cancels_stops_only_itself);
    RUN(a_desc_of_an_older_header_has_the_defaults);
    RUN(the_table_says_what_it_is);
    return check_end();
}
