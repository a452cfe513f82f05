/* SPDX-License-Identifier: MIT
 * What does a host that opens the library at run time get hold of?
 */
#include <hemibake/plugin_table.h>

const hemi_plugin hemi_plugin_table = { .struct_size = sizeof(hemi_plugin),
                                        .abi = HEMI_PLUGIN_ABI,
                                        .result_text = hemi_result_text,
                                        .version = hemi_version,
                                        .context_create = hemi_context_create,
                                        .context_destroy = hemi_context_destroy,
                                        .scene_create = hemi_scene_create,
                                        .scene_destroy = hemi_scene_destroy,
                                        .scene_add_material = hemi_scene_add_material,
                                        .scene_add_mesh = hemi_scene_add_mesh,
                                        .bake = hemi_bake,
                                        .solution_destroy = hemi_solution_destroy,
                                        .solution_mesh = hemi_solution_mesh,
                                        .solution_statistics = hemi_solution_statistics,
                                        .solution_shooter_count = hemi_solution_shooter_count,
                                        .solution_shooter = hemi_solution_shooter,
                                        .solution_curve_count = hemi_solution_curve_count,
                                        .solution_curve_point = hemi_solution_curve_point,
                                        .picture = hemi_picture,
                                        .factors_compute = hemi_factors_compute,
                                        .factors_free = hemi_factors_free,
                                        .scene_add_light = hemi_scene_add_light,
                                        .scene_set_sky = hemi_scene_set_sky,
                                        .scene_forecast = hemi_scene_forecast,
                                        .solution_relight = hemi_solution_relight };
