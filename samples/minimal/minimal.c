/* SPDX-License-Identifier: MIT
 * How does a program use hemibake without any file? Two unit squares face to face, one metre apart: the upper one emits
 * 1 W/m2/sr, the lower one reflects half of what it gets. Prints the radiosity of both.
 *
 *     cc -std=c11 minimal.c -lhemibake
 */
#include <hemibake/hemibake.h>

#include <stdio.h>

static void print_log(void *user, hemi_log_level level, const char *text) {
    (void)user, (void)level;
    fprintf(stderr, "minimal: %s\n", text);
}

static hemi_result add_square(hemi_scene *scene, uint32_t material, const float positions[12]) {
    static const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    return hemi_scene_add_mesh(scene,
                               &(hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                                                  .positions = positions,
                                                  .vertex_count = 4,
                                                  .indices = indices,
                                                  .triangle_count = 2,
                                                  .material = material },
                               NULL);
}

static hemi_result build(hemi_scene *scene) {
    /* Counter-clockwise seen from the front: the floor looks up, the lamp down. */
    static const float floor[12] = { 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0 };
    static const float lamp[12] = { 0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1 };
    const hemi_material_desc grey = { .struct_size = sizeof grey, .name = "grey", .reflectance = { 0.5, 0.5, 0.5 } };
    const hemi_material_desc light = { .struct_size = sizeof light, .name = "light", .emission = { 1, 1, 1 } };
    uint32_t grey_index, light_index;
    hemi_result result = hemi_scene_add_material(scene, &grey, &grey_index);
    if (result == HEMI_OK) result = hemi_scene_add_material(scene, &light, &light_index);
    if (result == HEMI_OK) result = add_square(scene, grey_index, floor);
    return result == HEMI_OK ? add_square(scene, light_index, lamp) : result;
}

/* Area-weighted mean radiosity of a mesh: pi times the mean radiance, W/m2. All triangles of these squares are alike.
 */
static double mean_radiosity(const hemi_mesh_view *view) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 3 * view->triangle_count; i++) sum += view->radiance[3 * (size_t)view->indices[i] + 1];
    return 3.14159265358979323846 * sum / (3.0 * view->triangle_count);
}

static hemi_result bake(hemi_scene *scene) {
    static const char *const names[] = { "floor", "lamp" };
    hemi_solution *solution;
    hemi_result result = hemi_bake(scene, NULL, &solution);
    if (result != HEMI_OK) return result;
    for (uint32_t i = 0; i < 2; i++) {
        hemi_mesh_view view = { .struct_size = sizeof view };
        hemi_solution_mesh(solution, i, &view);
        printf("%s: radiosity %.4f W/m2 over %u triangles\n", names[i], mean_radiosity(&view), view.triangle_count);
    }
    printf("closed form of the floor: 0.5 x 0.199825 x pi = %.4f W/m2\n", 0.5 * 0.199825 * 3.14159265358979323846);
    hemi_solution_destroy(solution);
    return HEMI_OK;
}

int main(void) {
    hemi_context *context;
    hemi_scene *scene = NULL;
    const hemi_context_desc desc = { .struct_size = sizeof desc, .log = print_log };
    hemi_result result = hemi_context_create(&desc, &context);
    if (result != HEMI_OK) return 1;
    result = hemi_scene_create(context, &scene);
    if (result == HEMI_OK) result = build(scene);
    if (result == HEMI_OK) result = bake(scene);
    if (result != HEMI_OK) fprintf(stderr, "minimal: %s\n", hemi_result_text(result));
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
    return result == HEMI_OK ? 0 : 1;
}
