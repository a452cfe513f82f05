/* SPDX-License-Identifier: MIT
 *
 * hemibake: diffuse global illumination for triangle meshes, as a C library.
 *
 * Units: metres and watts. Per rgb band: reflectance rho (0..1), radiance L (W/m2/sr), exitance M = pi L and
 * radiosity B = pi L (W/m2). Every colour in this header is scene-linear; no colour space is assumed. What is
 * passed in and what comes out is radiance: a surface lit by nothing but itself shows its own `emission`.
 *
 * Frames: right-handed; the front of a triangle is where its corners run counter-clockwise. Fronts reflect and
 * emit; backs block and absorb. A double-sided material makes two surfaces back to back.
 *
 * In short:
 *
 *     hemi_context *context;
 *     hemi_scene *scene;
 *     hemi_solution *solution;
 *     hemi_context_create(&(hemi_context_desc){ .struct_size = sizeof(hemi_context_desc) }, &context);
 *     hemi_scene_create(context, &scene);
 *     hemi_scene_add_material(scene, &material, &material_index);
 *     hemi_scene_add_mesh(scene, &mesh, NULL);
 *     hemi_bake(scene, &(hemi_bake_desc){ .struct_size = sizeof(hemi_bake_desc) }, &solution);
 *     hemi_mesh_view view = { .struct_size = sizeof view };
 *     hemi_solution_mesh(solution, 0, &view);          // vertices, triangles, radiance
 *     hemi_solution_destroy(solution); hemi_scene_destroy(scene); hemi_context_destroy(context);
 *
 * Memory: what goes in is copied before the call returns. Views point into the solution and live as long as it. All
 * that the library takes for a context comes from the context's allocator, if the host gives one.
 * Threads: calls on one context must not overlap; different contexts are independent.
 * Errors: whatever can fail returns a hemi_result; the text goes to the context's log callback, on the calling
 * thread. The library never prints, exits, aborts or reads the environment. The item buffers are drawn by Mesa's
 * llvmpipe, which reads LP_NUM_THREADS when its first context is made: a host that sets it to 0 before the first
 * bake is served best, since hemibake brings its own threads.
 *
 * Defaults: the zero of a field of a desc is its default, which only the library knows; hosts pass zero for what their
 * users did not say. Where something can be off, a negative number is off, and counts that can be off are signed.
 *
 * Versions: a major version is one ABI. Within it functions and result codes are only added, and fields only at the end
 * of structs that begin with struct_size; all other structs stay as they are, the groups of hemi_statistics too. Who
 * owns the memory of a struct sets its struct_size:
 *
 *     a desc, that the host fills            sizeof the desc. From an older host it is shorter, and what it lacks is
 *                                            the default; from a newer one it is longer: HEMI_ERROR_ARGUMENT, and a
 *                                            line that says so.
 *     a view, that the library fills         sizeof the view, before the call. The library writes what both know, and
 *                                            zeroes what only the host knows. A size that no version has had is
 *                                            HEMI_ERROR_ARGUMENT.
 *     what the library passes by pointer     The library sets it (hemi_progress). A host with a newer header reads a
 *                                            field only if it is within the size.
 *
 * Lists that may grow so are counted and read one by one into a view, never as arrays, since a host would step through
 * an array by the size that it knows. plugin_table.h serves hosts that use dlopen.
 */
#ifndef HEMIBAKE_H
#define HEMIBAKE_H

#define HEMI_VERSION_MAJOR  1
#define HEMI_VERSION_MINOR  0
#define HEMI_VERSION_PATCH  0
#define HEMI_VERSION_STRING "1.0.0" /* everything that says a version takes it from here */

#include <hemibake/bake.h>
#include <hemibake/context.h>
#include <hemibake/factors.h>
#include <hemibake/picture.h>
#include <hemibake/scene.h>
#include <hemibake/solution.h>

#endif
