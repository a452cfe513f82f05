/* SPDX-License-Identifier: MIT
 * How do the host's meshes become what the core solves on? Subdivided, tessellated, and laid out as a frozen scene.
 */
#ifndef HEMIBAKE_API_FREEZE_H
#define HEMIBAKE_API_FREEZE_H

#include "internal.h"

#include "mesh/mesh.h"
#include "refine.h"
#include "simplify.h"
#include "tessellate.h"
#include "visibility/mesh_items.h"
#include "visibility/surface_tree.h"

typedef struct frozen {
    arena memory;                 /* of everything the core reads */
    mesh_copy *refined;           /* refined[i]: the limit surface of mesh i, if it is subdivided */
    hemi_mesh_desc *meshes;       /* what was tessellated */
    struct stand_in *stand_ins;   /* stand_ins[i]: of mesh i, if it is too dense; see stand_in.h */
    simplify_census dense_census; /* of the meshes that are */
    size_t mesh_count;
    uint32_t *copy_of; /* copy_of[i]: the earlier mesh in whose place mesh i lies, or NO_INDEX; see coincident.h */
    uint32_t coincident_count;
    tessellation pieces;
    tessellate_range *ranges; /* the elements of each mesh in mesh.elements */
    scene scene;
    surface_tree *tree; /* what scene.tree points to */
    mesh mesh;
    clustering clusters; /* what mesh.clustering points to */
    item_geometry items;
    uint32_t clamped_materials, clamped_elements; /* of too much reflectance: that are used; that textures colour */
    bool lamps_are_cut;                           /* freeze_lamps */
    uint32_t overlapping_count, crossing_count;   /* triangles in the plane of others, and surfaces that pass through */
    uint32_t *triangle_surface;                   /* of the item geometry */
    material *shown;              /* shown[e] of element e: what its colours carry where a texture stays; or NULL */
    mesh_items patches, elements; /* as far as the method counts their pixels */
} frozen;

/* Area of the triangles of a mesh, m2, world. */
double freeze_mesh_area(const hemi_mesh_desc *m);

/* Area of all triangles of f->meshes, m2, world. */
double freeze_area(const frozen *f);

/* Refines what asks for subdivision into f->meshes. */
hemi_result freeze_refine(const hemi_scene *in, frozen *f);

/* Tessellates and builds scene, mesh and item geometry. desc has been resolved. */
hemi_result freeze_build(const hemi_scene *in, const hemi_bake_desc *desc, frozen *f);

/* Fails for elements of so many metres being more than the limit. */
hemi_result freeze_too_many(const hemi_scene *in, double element_size, const hemi_bake_desc *desc);

/* What a mesh's attributes are at a vertex of its pieces. */
void freeze_attributes(const frozen *f, const hemi_mesh_desc *m, uint32_t vertex, double *out);

/* Sets what is cut out of surfaces, and the scene's tree if anything is. False when out of memory. */
bool freeze_cutouts(frozen *f, surface *surfaces);

/* Gives the item geometry, which is otherwise complete, its holes. False when out of memory. */
bool freeze_item_holes(frozen *f);

/* Finds areas, samples and what is cut out of them from the patches and elements there are. False when out of memory.
 */
bool freeze_measure(const frozen *f, arena *memory, mesh *m);

/* Cuts patches whose elements textures make emit unevenly. False when out of memory. */
bool freeze_lamps(frozen *f);

/* Do textures say what the mesh's elements are like? */
bool freeze_is_textured(const hemi_mesh_desc *m);

/* Asks the textures of meshes what their elements reflect and emit. */
hemi_result freeze_textures(const hemi_scene *in, frozen *f);

/* Counts the materials whose reflectance was clamped, where no texture has colours of its own; logs both, once. */
void freeze_say_clamped(hemi_scene *in, frozen *f);
/* After vertices were added to f->pieces. */
void freeze_follow(frozen *f);

/* A mesh of the leaves, or of the fresh ones; patches keep what shoots. False when out of memory. */
bool freeze_leaves(const frozen *f, const tessellate_leaf *leaves, uint32_t count, bool fresh_only, arena *memory,
                   mesh *out);

/* Makes the mesh of all leaves the frozen one, with its textures. */
hemi_result freeze_take_leaves(const hemi_scene *in, frozen *f, const tessellate_leaf *leaves, uint32_t count,
                               const mesh *whole);

void frozen_free(frozen *f);

#endif
