/* SPDX-License-Identifier: MIT
 *
 * How does a host that opens the library at run time call it? One symbol, `hemi_plugin_table`, holds every function of
 * hemibake.h:
 *
 *     void *library = dlopen("libhemibake.so", RTLD_NOW | RTLD_LOCAL);
 *     const hemi_plugin *hemi = dlsym(library, HEMI_PLUGIN_SYMBOL);
 *     if (!hemi || hemi->abi != HEMI_PLUGIN_ABI || hemi->struct_size < sizeof *hemi) ...another version
 *     hemi->context_create(NULL, &context);
 *
 * Members are only ever appended while `abi` stays the same; the member `name` is the function `hemi_name`.
 */
#ifndef HEMIBAKE_PLUGIN_TABLE_H
#define HEMIBAKE_PLUGIN_TABLE_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

/* Counts up when a struct or a function of hemibake.h changes in a way that old hosts would not survive. */
#define HEMI_PLUGIN_ABI    1u
#define HEMI_PLUGIN_SYMBOL "hemi_plugin_table"

typedef struct hemi_plugin {
    uint32_t struct_size; /* of the table that the library has */
    uint32_t abi;         /* HEMI_PLUGIN_ABI that it was built with */
    const char *(*result_text)(hemi_result result);
    const char *(*version)(void);
    hemi_result (*context_create)(const hemi_context_desc *desc, hemi_context **out);
    void (*context_destroy)(hemi_context *context);
    hemi_result (*scene_create)(hemi_context *context, hemi_scene **out);
    void (*scene_destroy)(hemi_scene *scene);
    hemi_result (*scene_add_material)(hemi_scene *scene, const hemi_material_desc *desc, uint32_t *out_index);
    hemi_result (*scene_add_mesh)(hemi_scene *scene, const hemi_mesh_desc *desc, uint32_t *out_index);
    hemi_result (*bake)(hemi_scene *scene, const hemi_bake_desc *desc, hemi_solution **out);
    void (*solution_destroy)(hemi_solution *solution);
    hemi_result (*solution_mesh)(const hemi_solution *solution, uint32_t mesh, hemi_mesh_view *out);
    hemi_result (*solution_statistics)(const hemi_solution *solution, hemi_statistics *out);
    size_t (*solution_shooter_count)(const hemi_solution *solution);
    hemi_result (*solution_shooter)(const hemi_solution *solution, size_t index, hemi_shooter *out);
    size_t (*solution_curve_count)(const hemi_solution *solution);
    hemi_result (*solution_curve_point)(const hemi_solution *solution, size_t index, hemi_curve_point *out);
    hemi_result (*picture)(hemi_context *context, const hemi_picture_desc *desc, float *pixels);
    hemi_result (*factors_compute)(hemi_context *context, const hemi_factors_desc *desc, hemi_factors *out);
    void (*factors_free)(hemi_factors *factors);
    hemi_result (*scene_add_light)(hemi_scene *scene, const hemi_light_desc *desc, uint32_t *out_index);
    hemi_result (*scene_set_sky)(hemi_scene *scene, const hemi_sky_desc *desc);
    hemi_result (*scene_forecast)(hemi_scene *scene, const hemi_bake_desc *desc, hemi_forecast *out);
    hemi_result (*solution_relight)(const hemi_solution *solution, hemi_scene *scene, const hemi_bake_desc *desc,
                                    hemi_solution **out);
} hemi_plugin;

HEMI_API extern const hemi_plugin hemi_plugin_table;

HEMI_C_END
#endif
