/* SPDX-License-Identifier: MIT
 * How do the host's meshes become what the core solves on? Subdivided, tessellated, and laid out as a bake_scene scene.
 */
#ifndef HEMIBAKE_API_BUILD_SCENE_H
#define HEMIBAKE_API_BUILD_SCENE_H

#include "internal.h"

#include "bake/quality.h"
#include "light/lights.h"
#include "mesh/mesh.h"
#include "refinement.h"
#include "simplify.h"
#include "tessellate.h"
#include "visibility/mesh_items.h"
#include "visibility/surface_bvh.h"

typedef struct bake_scene {
    arena memory;               /* of everything the core reads */
    mesh_copy *refined;         /* refined[i]: the limit surface of mesh i, if it is subdivided */
    hemi_mesh_desc *meshes;     /* what was tessellated */
    struct proxy_mesh *proxies; /* proxies[i]: of mesh i, if it is too dense; see proxy_mesh.h */
    simplify_check dense_check; /* of the meshes that are */
    size_t mesh_count;
    uint32_t
        *copy_of; /* copy_of[i]: the earlier mesh in whose place mesh i lies, or NO_INDEX; see duplicate_meshes.h */
    uint32_t duplicate_count;
    tessellation pieces;
    tessellate_range *ranges; /* the elements of each mesh in mesh.elements */
    scene scene;
    surface_bvh *tree; /* what scene.tree points to */
    mesh mesh;
    clustering clusters; /* what mesh.clustering points to */
    item_geometry items;
    uint32_t clamped_materials, clamped_elements; /* of too much reflectance: that are used; that textures colour */
    uint32_t *flat_face;                          /* flat_faces.h; NULL: nothing is decimated */
    bool *kept;              /* kept[s]: surface s is of a proxy, which is only read at the dense mesh's vertices */
    bool emitters_are_split; /* build_emitters */
    uint32_t overlapping_count, crossing_count; /* triangles in the plane of others, and surfaces that pass through */
    uint32_t *triangle_surface;                 /* of the item geometry */
    material *demodulated; /* demodulated[e] of element e: what its colours carry where a texture stays; or NULL */
    mesh_items patches, elements; /* as far as the method counts their pixels */
} bake_scene;

/* The lights and the sky of a scene as the core takes them; *memory holds what *out points to, and is a block. */
hemi_result scene_lights(const hemi_scene *in, lights *out, punctual **memory);

/* Area of the triangles of a mesh, m2, world. */
double mesh_desc_area(const hemi_mesh_desc *m);

/* Area of all triangles of f->meshes, m2, world. */
double bake_scene_area(const bake_scene *f);

/* Refines what asks for subdivision into f->meshes. */
hemi_result build_limit_surfaces(const hemi_scene *in, bake_scene *f);

/* Tessellates and builds scene, mesh and item geometry. desc has been resolved. */
hemi_result build_scene(const hemi_scene *in, const bake_options *options, bake_scene *f);

/* Fails for elements of so many metres being more than the limit. */
hemi_result fail_too_many(const hemi_scene *in, double element_size, const bake_options *options);

/* What a mesh's attributes are at a vertex of its pieces. */
void bake_scene_attributes(const bake_scene *f, const hemi_mesh_desc *m, uint32_t vertex, double *out);

/* Sets what is cut out of surfaces, and the scene's tree if anything is. False when out of memory. */
bool build_masks(bake_scene *f, surface *surfaces);

/* Gives the item geometry, which is otherwise complete, its holes. False when out of memory. */
bool build_item_masks(bake_scene *f);

/* Finds areas, samples and what is cut out of them from the patches and elements there are. False when out of memory.
 */
bool build_measure(const bake_scene *f, arena *memory, mesh *m);

/* Cuts patches whose elements textures make emit unevenly. False when out of memory. */
bool build_emitters(bake_scene *f);

/* Do textures say what the mesh's elements are like? */
bool mesh_desc_is_textured(const hemi_mesh_desc *m);

/* Asks the textures of meshes what their elements reflect and emit. */
hemi_result build_textures(const hemi_scene *in, bake_scene *f);

/* Counts the materials whose reflectance was clamped, where no texture has colours of its own; logs both, once. */
void say_clamped(hemi_scene *in, bake_scene *f);
/* After vertices were added to f->pieces. */
void bake_scene_follow(bake_scene *f);

/* A mesh of the leaves, or of the fresh ones; patches keep what shoots. False when out of memory. */
bool build_leaves(const bake_scene *f, const tessellate_leaf *leaves, uint32_t count, bool fresh_only, arena *memory,
                  mesh *out);

/* Makes the mesh of all leaves the bake_scene one, with its textures. */
hemi_result take_leaves(const hemi_scene *in, bake_scene *f, const tessellate_leaf *leaves, uint32_t count,
                        const mesh *whole);

void bake_scene_free(bake_scene *f);

#endif
