/* SPDX-License-Identifier: MIT
 * Does a host light a scene anew on the rows of a solution, without a file? And are lights of groups that there are not
 * refused?
 */
#include "check.h"

#include "api/rays.h"

#include <hemibake/hemibake.h>

#include <stdbool.h>

static hemi_result add_square(hemi_scene *scene, uint32_t material, uint32_t group, const float positions[12]) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    return hemi_scene_add_mesh(scene,
                               &(hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                                                  .positions = positions,
                                                  .vertex_count = 4,
                                                  .indices = indices,
                                                  .triangle_count = 2,
                                                  .material = material,
                                                  .light_group = group },
                               NULL);
}

/* A floor of a width under a lamp. */
static hemi_scene *scene_of(hemi_context *context, float width, double emission, uint32_t group) {
    const float floor[12] = { 0, 0, 0, 0, 0, 1, width, 0, 1, width, 0, 0 };
    static const float lamp[12] = { 0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1 };
    const hemi_material_desc grey = { .struct_size = sizeof grey, .reflectance = { 0.5, 0.5, 0.5 } };
    const hemi_material_desc light = { .struct_size = sizeof light, .emission = { emission, emission, emission } };
    hemi_scene *scene = NULL;
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &grey, NULL), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &light, NULL), HEMI_OK);
    CHECK_EQUAL(add_square(scene, 0, 0, floor), HEMI_OK);
    CHECK_EQUAL(add_square(scene, 1, group, lamp), HEMI_OK);
    return scene;
}

/* The sum of what the floor shows, and of its first group if there is one. */
static double floor_of(const hemi_solution *solution, double *group) {
    hemi_mesh_view view = { .struct_size = sizeof view };
    double sum = 0.0;
    CHECK_EQUAL(hemi_solution_mesh(solution, 0, &view), HEMI_OK);
    for (size_t k = 0; k < 3 * (size_t)view.vertex_count; k++) sum += (double)view.radiance[k];
    for (size_t k = 0; group && view.light_groups && k < 3 * (size_t)view.vertex_count; k++)
        *group += (double)view.light_groups[k];
    return sum;
}

static void a_solution_that_keeps_its_rows_is_lit_anew(void) {
    hemi_context *context = NULL;
    hemi_solution *first = NULL, *same = NULL, *twice = NULL, *other = NULL;
    const hemi_bake_desc desc = { .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT, .keep_rows = true };
    CHECK_EQUAL(hemi_context_create(NULL, &context), HEMI_OK);
    hemi_scene *dim = scene_of(context, 1, 2, 0), *bright = scene_of(context, 1, 4, 0),
               *wide = scene_of(context, 2, 2, 0);
    CHECK_EQUAL(hemi_bake(dim, &desc, &first), HEMI_OK);
    CHECK_EQUAL(hemi_solution_relight(first, dim, &desc, &same), HEMI_OK);
    CHECK_EQUAL(hemi_solution_relight(first, bright, &desc, &twice), HEMI_OK);
    if (first && same) CHECK_NEAR(floor_of(same, NULL), floor_of(first, NULL), 0.0);
    /* Twice the emission is twice the light: powers of two change no digit. */
    if (first && twice) CHECK_NEAR(floor_of(twice, NULL), 2.0 * floor_of(first, NULL), 1e-6 * floor_of(twice, NULL));
    CHECK_EQUAL(hemi_solution_relight(first, wide, &desc, &other), HEMI_ERROR_BACKEND);
    CHECK_EQUAL(hemi_solution_relight(same, dim, &desc, &other), HEMI_ERROR_ARGUMENT);
    CHECK(other == NULL);
    hemi_solution_destroy(first), hemi_solution_destroy(same), hemi_solution_destroy(twice);
    hemi_scene_destroy(dim), hemi_scene_destroy(bright), hemi_scene_destroy(wide);
    hemi_context_destroy(context);
}

static void lights_are_of_groups_that_there_are(void) {
    hemi_context *context = NULL;
    hemi_solution *solution = NULL;
    hemi_bake_desc desc = { .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT, .light_groups = 1 };
    CHECK_EQUAL(hemi_context_create(NULL, &context), HEMI_OK);
    hemi_scene *scene = scene_of(context, 1, 2, 1);
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    desc.light_groups = 65;
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_ERROR_ARGUMENT);
    desc.light_groups = 2;
    CHECK_EQUAL(hemi_bake(scene, &desc, &solution), HEMI_OK);
    double none = 0.0;
    if (solution) CHECK(floor_of(solution, &none) > 0.0);
    CHECK_NEAR(none, 0.0, 0.0); /* the lamp is in the second */
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
}

/* Rows are rays, as this back end is. */
int main(void) {
    if (!has_rays()) return printf("skipped: a build without Embree\n"), 77;
    RUN(a_solution_that_keeps_its_rows_is_lit_anew);
    RUN(lights_are_of_groups_that_there_are);
    return check_end();
}
