/* SPDX-License-Identifier: MIT
 * Can a program outside of the tree bake? One square lights another; prints the version and the light that arrives.
 */
#include <hemibake/hemibake.h>

#include <stdio.h>

/* Names that the library has inside; a host may have them too. */
int mesh_finish(void);
int mesh_finish(void) {
    return 42;
}

static hemi_result add_square(hemi_scene *scene, double emission, const float *positions) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    hemi_material_desc material = { .struct_size = sizeof material, .reflectance = { 0.5, 0.5, 0.5 } };
    hemi_mesh_desc mesh = {
        .struct_size = sizeof mesh, .positions = positions, .vertex_count = 4, .indices = indices, .triangle_count = 2
    };
    for (int c = 0; c < 3; c++) material.emission[c] = emission;
    hemi_result result = hemi_scene_add_material(scene, &material, &mesh.material);
    return result == HEMI_OK ? hemi_scene_add_mesh(scene, &mesh, NULL) : result;
}

int main(void) {
    static const float floor[12] = { 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0 };
    static const float lamp[12] = { 0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1 };
    hemi_bake_desc wish = { .struct_size = sizeof wish, .quality = HEMI_QUALITY_DRAFT };
    hemi_context *context = NULL;
    hemi_scene *scene = NULL;
    hemi_solution *solution = NULL;
    hemi_mesh_view view = { .struct_size = sizeof view };
    hemi_result result = hemi_context_create(NULL, &context);
    if (result == HEMI_OK) result = hemi_scene_create(context, &scene);
    if (result == HEMI_OK) result = add_square(scene, 0, floor);
    if (result == HEMI_OK) result = add_square(scene, 1, lamp);
    if (result == HEMI_OK) result = hemi_bake(scene, &wish, &solution);
    if (result == HEMI_OK) result = hemi_solution_mesh(solution, 0, &view);
    if (result == HEMI_OK) printf("%s %d %.4f\n", hemi_version(), mesh_finish(), (double)view.radiance[0]);
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
    return result == HEMI_OK ? 0 : 1;
}
