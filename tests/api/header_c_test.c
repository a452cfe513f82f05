/* SPDX-License-Identifier: MIT
 * Does the public header stand alone in C11, and does the example at its top work as it is printed there?
 */
#include <hemibake/hemibake.h>

#include "check.h"

static const float CORNERS[12] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
static const uint32_t TRIANGLES[6] = { 0, 1, 2, 0, 2, 3 };

static void the_example_of_the_header_bakes(void) {
    hemi_context *context = NULL;
    hemi_scene *scene = NULL;
    hemi_solution *solution = NULL;
    hemi_mesh_view view = { .struct_size = sizeof view };
    uint32_t material_index = 9;
    hemi_material_desc material = { .struct_size = sizeof material,
                                    .reflectance = { 0.5, 0.5, 0.5 },
                                    .emission = { 1.0, 2.0, 3.0 } };
    CHECK_EQUAL(hemi_context_create(&(hemi_context_desc){ .struct_size = sizeof(hemi_context_desc) }, &context),
                HEMI_OK);
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_material(scene, &material, &material_index), HEMI_OK);
    CHECK_EQUAL(material_index, 0);
    hemi_mesh_desc mesh = { .struct_size = sizeof mesh,
                            .positions = CORNERS,
                            .vertex_count = 4,
                            .indices = TRIANGLES,
                            .triangle_count = 2,
                            .material = material_index };
    CHECK_EQUAL(hemi_scene_add_mesh(scene, &mesh, NULL), HEMI_OK);
    CHECK_EQUAL(hemi_bake(scene, &(hemi_bake_desc){ .struct_size = sizeof(hemi_bake_desc) }, &solution), HEMI_OK);
    CHECK_EQUAL(hemi_solution_mesh(solution, 0, &view), HEMI_OK);
    CHECK(view.vertex_count >= 4 && view.triangle_count >= 2);
    /* A surface lit by nothing but itself shows its own emission, to the solver's 1e-7 and floats. */
    for (uint32_t v = 0; v < view.vertex_count; v++)
        for (uint32_t c = 0; c < 3; c++) CHECK_NEAR(view.radiance[3 * v + c], 1.0 + c, 1e-5 * (1.0 + c));
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
}

static void codes_and_their_texts_are_one_list(void) {
    static const char *const texts[] = {
#define TEXT(name, text) text,
        HEMI_RESULTS(TEXT)
#undef TEXT
    };
    CHECK_EQUAL(sizeof texts / sizeof *texts, HEMI_RESULT_COUNT);
    for (int i = 0; i < HEMI_RESULT_COUNT; i++) CHECK_TEXT(hemi_result_text((hemi_result)i), texts[i]);
    CHECK_EQUAL(HEMI_OK, 0);
}

int main(void) {
    RUN(the_example_of_the_header_bakes);
    RUN(codes_and_their_texts_are_one_list);
    return check_end();
}
