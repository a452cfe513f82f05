/* SPDX-License-Identifier: MIT
 * Do several processes that share a bake get what one gets alone, to the byte? Threads stand for processes here: each
 * has a context and a scene of its own, and what they exchange goes through the memory that they have in common.
 */
#include "check.h"

#include "api/rays.h"

#include <hemibake/hemibake.h>

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { RANKS_MAX = 4, MESHES = 7, SPHERE_RINGS = 16, SPHERE_SIDES = 32 };

/* What they have in common. */
typedef struct meeting {
    pthread_barrier_t barrier;
    uint32_t count;
    unsigned char *bytes[RANKS_MAX];
    unsigned exchanges;
} meeting;

typedef struct process {
    meeting *at;
    hemi_ranks ranks;
    bool lit_by_sky, glazed, loses;
    hemi_result result;
    size_t size;
    unsigned char *radiance;
    double error, absorbed_w;
} process;

static bool exchange(void *user, void *bytes, const uint64_t *begin) {
    process *p = user;
    meeting *at = p->at;
    at->bytes[p->ranks.rank] = bytes;
    pthread_barrier_wait(&at->barrier);
    for (uint32_t r = 0; r < at->count; r++)
        if (r != p->ranks.rank)
            memcpy((unsigned char *)bytes + begin[r], at->bytes[r] + begin[r], begin[r + 1] - begin[r]);
    if (p->ranks.rank == 0) at->exchanges++;
    pthread_barrier_wait(&at->barrier);
    return !p->loses;
}

/* ---- a room of many elements ---- */

static void add_quad(hemi_scene *scene, uint32_t material, const float positions[12]) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    const hemi_mesh_desc mesh = { .struct_size = sizeof mesh,
                                  .positions = positions,
                                  .vertex_count = 4,
                                  .indices = indices,
                                  .triangle_count = 2,
                                  .material = material };
    CHECK_EQUAL(hemi_scene_add_mesh(scene, &mesh, NULL), HEMI_OK);
}

static void add_ball(hemi_scene *scene, uint32_t material) {
    static float at[3 * (SPHERE_RINGS + 1) * SPHERE_SIDES];
    static uint32_t corners[6 * SPHERE_RINGS * SPHERE_SIDES];
    static pthread_mutex_t made = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&made);
    for (uint32_t i = 0; i <= SPHERE_RINGS; i++)
        for (uint32_t k = 0; k < SPHERE_SIDES; k++) {
            double down = 3.14159265358979 * i / SPHERE_RINGS, round = 2 * 3.14159265358979 * k / SPHERE_SIDES;
            float *p = at + 3 * (i * SPHERE_SIDES + k);
            p[0] = (float)(2 + 0.7 * sin(down) * cos(round)), p[1] = (float)(1 + 0.7 * cos(down));
            p[2] = (float)(2 - 0.7 * sin(down) * sin(round));
        }
    for (uint32_t i = 0; i < SPHERE_RINGS; i++)
        for (uint32_t k = 0; k < SPHERE_SIDES; k++) {
            uint32_t next = (k + 1) % SPHERE_SIDES, a = i * SPHERE_SIDES + k, b = i * SPHERE_SIDES + next;
            const uint32_t two[6] = { a, a + SPHERE_SIDES, b, b, a + SPHERE_SIDES, b + SPHERE_SIDES };
            memcpy(corners + 6 * (size_t)(i * SPHERE_SIDES + k), two, sizeof two);
        }
    const hemi_mesh_desc mesh = { .struct_size = sizeof mesh,
                                  .positions = at,
                                  .vertex_count = (SPHERE_RINGS + 1) * SPHERE_SIDES,
                                  .indices = corners,
                                  .triangle_count = 2 * SPHERE_RINGS * SPHERE_SIDES,
                                  .material = material };
    CHECK_EQUAL(hemi_scene_add_mesh(scene, &mesh, NULL), HEMI_OK);
    pthread_mutex_unlock(&made);
}

static hemi_scene *scene_of(hemi_context *context, const process *p) {
    static const float floor[12] = { 0, 0, 0, 0, 0, 4, 4, 0, 4, 4, 0, 0 },
                       ceiling[12] = { 0, 3, 0, 4, 3, 0, 4, 3, 4, 0, 3, 4 };
    static const float left[12] = { 0, 0, 0, 0, 3, 0, 0, 3, 4, 0, 0, 4 },
                       right[12] = { 4, 0, 0, 4, 0, 4, 4, 3, 4, 4, 3, 0 };
    static const float back[12] = { 0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0 };
    static const float lamp[12] = { 1, 2.9f, 1, 2, 2.9f, 1, 2, 2.9f, 2, 1, 2.9f, 2 };
    static const float pane[12] = { 0, 0, 3.9f, 4, 0, 3.9f, 4, 3, 3.9f, 0, 3, 3.9f };
    const hemi_material_desc grey = { .struct_size = sizeof grey, .reflectance = { 0.7, 0.6, 0.5 } },
                             light = { .struct_size = sizeof light, .emission = { 5, 5, 4 } },
                             glass = { .struct_size = sizeof glass,
                                       .reflectance = { 0.1, 0.1, 0.1 },
                                       .double_sided = true,
                                       .transmission = { 0.6, 0.7, 0.6 } };
    hemi_scene *scene = NULL;
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &grey, NULL), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &light, NULL), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &glass, NULL), HEMI_OK);
    const float *walls[] = { floor, ceiling, left, right, back };
    for (size_t i = 0; i < sizeof walls / sizeof *walls; i++) add_quad(scene, 0, walls[i]);
    add_ball(scene, 0);
    if (p->glazed) add_quad(scene, 2, pane);
    if (p->lit_by_sky) {
        const hemi_sky_desc sky = { .struct_size = sizeof sky, .radiance = { 1, 1, 1.2 } };
        CHECK_EQUAL(hemi_scene_set_sky(scene, &sky), HEMI_OK);
    } else {
        add_quad(scene, 1, lamp);
    }
    return scene;
}

/* ---- bakes ---- */

static void keep(process *p, const hemi_solution *solution) {
    hemi_statistics found = { .struct_size = sizeof found };
    hemi_mesh_view view = { .struct_size = sizeof view };
    CHECK_EQUAL(hemi_solution_statistics(solution, &found), HEMI_OK);
    p->error = found.error.estimate, p->absorbed_w = found.energy.absorbed_w;
    for (uint32_t i = 0; i < MESHES; i++) {
        CHECK_EQUAL(hemi_solution_mesh(solution, i, &view), HEMI_OK);
        size_t more = 3 * (size_t)view.vertex_count * sizeof *view.radiance;
        p->radiance = realloc(p->radiance, p->size + more);
        memcpy(p->radiance + p->size, view.radiance, more);
        p->size += more;
    }
}

static void *bake(void *user) {
    process *p = user;
    hemi_context *context = NULL;
    hemi_solution *solution = NULL;
    hemi_bake_desc desc = {
        .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT, .method = HEMI_METHOD_ROWS, .element_size = 0.2
    };
    const hemi_context_desc one = { .struct_size = sizeof one, .threads = 1 };
    if (p->ranks.count > 0) desc.ranks = &p->ranks;
    CHECK_EQUAL(hemi_context_create(&one, &context), HEMI_OK);
    hemi_scene *scene = scene_of(context, p);
    p->result = hemi_bake(scene, &desc, &solution);
    if (solution) keep(p, solution);
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
    return NULL;
}

static void bake_shared(process *all, meeting *at, uint32_t count) {
    pthread_t threads[RANKS_MAX];
    *at = (meeting){ .count = count };
    pthread_barrier_init(&at->barrier, NULL, count);
    for (uint32_t r = 0; r < count; r++) {
        all[r].at = at;
        all[r].ranks = (hemi_ranks){ sizeof(hemi_ranks), r, count, exchange, &all[r] };
        pthread_create(&threads[r], NULL, bake, &all[r]);
    }
    for (uint32_t r = 0; r < count; r++) pthread_join(threads[r], NULL);
    pthread_barrier_destroy(&at->barrier);
}

static void check_alike(bool lit_by_sky, bool glazed, uint32_t first, uint32_t last) {
    process alone = { .lit_by_sky = lit_by_sky, .glazed = glazed };
    bake(&alone);
    CHECK_EQUAL(alone.result, HEMI_OK);
    CHECK(alone.size > 0);
    for (uint32_t count = first; count <= last; count *= 2) {
        process all[RANKS_MAX] = { { 0 } };
        meeting at;
        for (uint32_t r = 0; r < count; r++) all[r].lit_by_sky = lit_by_sky, all[r].glazed = glazed;
        bake_shared(all, &at, count);
        CHECK(at.exchanges > 0);
        for (uint32_t r = 0; r < count; r++) {
            CHECK_EQUAL(all[r].result, HEMI_OK);
            CHECK(all[r].size == alone.size && memcmp(all[r].radiance, alone.radiance, alone.size) == 0);
            CHECK(all[r].error == alone.error && all[r].absorbed_w == alone.absorbed_w);
            free(all[r].radiance);
        }
    }
    free(alone.radiance);
}

static void a_lamp_gives_the_same_light(void) {
    check_alike(false, false, 1, 4);
}

static void a_sky_behind_a_pane_gives_the_same_light(void) {
    check_alike(true, true, 3, 3);
}

static void who_loses_the_others_says_so(void) {
    process all[2] = { { .loses = true }, { .loses = true } };
    meeting at;
    bake_shared(all, &at, 2);
    for (int r = 0; r < 2; r++) CHECK_EQUAL(all[r].result, HEMI_ERROR_BACKEND);
    CHECK(all[0].radiance == NULL);
}

static void what_cannot_be_shared_is_refused(void) {
    hemi_context *context = NULL;
    hemi_solution *solution = NULL;
    process p = { .lit_by_sky = true };
    volatile int stop = 0;
    const hemi_checkpoint nobody = { .struct_size = sizeof nobody };
    hemi_ranks ranks = { sizeof ranks, 1, 1, exchange, NULL };
    hemi_bake_desc desc = { .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT, .ranks = &ranks };
    CHECK_EQUAL(hemi_context_create(NULL, &context), HEMI_OK);
    hemi_scene *scene = scene_of(context, &p);
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    ranks.rank = 0, desc.stop = &stop;
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    desc.stop = NULL, desc.time_limit_s = 5;
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    desc.time_limit_s = 0, desc.checkpoint = &nobody;
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
}

int main(void) {
    if (!has_rays()) return printf("skipped: a build without Embree\n"), 77;
    RUN(a_lamp_gives_the_same_light);
    RUN(a_sky_behind_a_pane_gives_the_same_light);
    RUN(who_loses_the_others_says_so);
    RUN(what_cannot_be_shared_is_refused);
    return check_end();
}
