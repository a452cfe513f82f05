/* SPDX-License-Identifier: MIT
 * How do the host's meshes become what the core solves on? Subdivided, tessellated, and laid out as a frozen scene.
 */
#ifndef HEMIBAKE_API_FREEZE_H
#define HEMIBAKE_API_FREEZE_H

#include "internal.h"

#include "mesh/mesh.h"
#include "simplify.h"
#include "tessellate.h"
#include "visibility/mesh_items.h"

typedef struct frozen {
    arena memory;                 /* of everything the core reads */
    mesh_copy *refined;           /* refined[i]: the limit surface of mesh i, if it is subdivided */
    hemi_mesh_desc *meshes;       /* what was tessellated */
    struct stand_in *stand_ins;   /* stand_ins[i]: of mesh i, if it is too dense; see stand_in.h */
    simplify_census dense_census; /* of the meshes that are */
    size_t mesh_count;
    tessellation pieces;
    scene scene;
    mesh mesh;
    item_geometry items;
    uint32_t overlapping_count, crossing_count; /* triangles in the plane of others, and surfaces that pass through */
    uint32_t *triangle_surface;                 /* of the item geometry */
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

/* Asks the textures of meshes what their elements reflect and emit. */
hemi_result freeze_textures(const hemi_scene *in, frozen *f);

void frozen_free(frozen *f);

#endif
