/* SPDX-License-Identifier: MIT
 * How do the host's meshes become what the core solves on? Subdivided, tessellated, and laid out as a bake_scene scene.
 */
#ifndef HEMIBAKE_API_BUILD_SCENE_H
#define HEMIBAKE_API_BUILD_SCENE_H

#include "internal.h"

#include "bake/light_groups.h"
#include "bake/prepared_scene.h"
#include "light/lights.h"
#include "mesh_descs.h"
#include "simplify.h"
#include "tessellate.h"
#include "visibility/surface_bvh.h"

typedef struct bake_scene {
    arena memory;               /* of everything the core reads */
    mesh_copy *limit_surfaces;  /* limit_surfaces[i]: of mesh i, if it is subdivided */
    hemi_mesh_desc *meshes;     /* what was tessellated */
    source_mesh *sources;       /* the same for the core */
    uint32_t *pictures;         /* of meshes: neighbour_nodes.h */
    struct proxy_mesh *proxies; /* proxies[i]: of mesh i, if it is too dense; see proxy_mesh.h */
    simplify_check dense_check; /* of the meshes that are */
    size_t mesh_count;
    uint32_t *copy_of; /* copy_of[i]: the earlier mesh in whose place mesh i lies, or NO_INDEX; duplicate_meshes.h */
    uint32_t duplicate_count;
    bool *is_level; /* is_level[i]: mesh i is a level of detail that takes no part; detail_levels.h */
    uint32_t level_count;
    wide_ground ground;
    mesh_vertices vertices; /* of scene and mesh */
    scene scene;
    surface_bvh *tree;                /* what scene.tree points to */
    bool solves_diffuse_transmission; /* the method knows light that leaves by the other side */
    mesh mesh;
    tessellate_check check;                       /* of the meshes, without the dense ones */
    uint32_t clamped_materials, clamped_elements; /* of too much reflectance: that are used; that textures colour */
    bool *kept;            /* kept[s]: surface s is of a proxy, which is only read at the dense mesh's vertices */
    material *demodulated; /* demodulated[e] of element e: what its colours carry where a texture stays; or NULL */
    prepared_scene prepared;
} bake_scene;

/* The lights and the sky of a scene as the core takes them; *memory holds what *out points to, and is a block. */
hemi_result scene_lights(const hemi_scene *in, lights *out, punctual **memory);

/* The groups of its lights, as many as options say. */
hemi_result scene_groups(const hemi_scene *in, const bake_options *options, arena *memory, light_groups_input *out);

/* What light can reach of f->meshes, m2 (lit_area.h). Negative when out of memory. */
double bake_scene_lit_area(const hemi_scene *in, const bake_scene *f, const lights *l);

/* Makes the limit surface of what asks for subdivision one of f->meshes. */
hemi_result build_limit_surfaces(const hemi_scene *in, bake_scene *f);

/* Tessellates and builds scene, mesh and item geometry. options have been resolved. */
hemi_result build_scene(const hemi_scene *in, const bake_options *options, bake_scene *f);

/* Fails for elements of so many metres being more than the limit. */
hemi_result fail_too_many(const hemi_scene *in, double element_size, const bake_options *options);

/* What a mesh's attributes are at a vertex. */
void bake_scene_attributes(const bake_scene *f, const hemi_mesh_desc *m, uint32_t vertex, double *out);

/* Sets what is cut out of surfaces, and the scene's tree if anything is. False when out of memory. */
bool build_masks(bake_scene *f);
alpha_mask_map alpha_map_of(const hemi_alpha_mask *given);

/* Do textures say what the mesh's elements are like? */
bool mesh_desc_is_textured(const hemi_mesh_desc *m);

/* What a mesh shows of irradiance / pi, and what of it a texture that stays multiplies. attributes: room for three
 * times those of the mesh; the first of them are set. */
void mesh_desc_shade(const hemi_scene *in, const hemi_mesh_desc *m, const double incident[3], double *attributes,
                     double radiance[3], double demodulated[3]);

/* Gives elements and patches their materials, of surfaces and of textures. */
hemi_result build_textures(const hemi_scene *in, bake_scene *f);

/* Counts the materials whose reflectance was clamped, where no texture has colours of its own; logs both, once. */
void say_clamped(hemi_scene *in, bake_scene *f);

void bake_scene_free(bake_scene *f);

#endif
