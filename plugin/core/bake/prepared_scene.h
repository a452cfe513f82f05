/* SPDX-License-Identifier: MIT
 * What is worked out of a scene and its mesh before light is sent into them? Elements are cut where other surfaces
 * stand on them; panes, shooters that go together, and flat faces are found; all becomes geometry of item buffers.
 */
#ifndef HEMIBAKE_CORE_BAKE_PREPARED_SCENE_H
#define HEMIBAKE_CORE_BAKE_PREPARED_SCENE_H

#include "bake/quality.h"
#include "base/jobs.h"
#include "mesh/refinement.h"
#include "visibility/mesh_items.h"
#include "visibility/panes.h"

typedef struct prepared_scene {
    panes *panes;                               /* what scene.panes points to */
    clustering clusters;                        /* what mesh.clustering points to */
    bool emitters_are_split;                    /* uneven_emitters_split */
    uint32_t *flat_face;                        /* flat_faces.h; NULL: nothing is decimated */
    uint32_t overlapping_count, crossing_count; /* triangles in the plane of others, and surfaces that pass through */
    mesh_items surfaces, patches, elements;     /* patches and elements as far as the method counts their pixels */
} prepared_scene;

/* Joins meshes that go on in each other, cuts the elements of a mesh that was just tessellated, sets the normals that
 * they are shaded by, and measures the mesh. pictures: as in neighbour_nodes.h. False when out of memory. */
bool prepared_scene_cut_elements(const bake_options *options, const refinement_setup *of, const uint32_t *pictures,
                                 jobs *j, arena *memory);

/* All else, of elements that have their materials; is_textured: pictures may glow on them. False when out of memory;
 * what there is is to be freed then too. */
bool prepared_scene_make(const bake_options *options, const refinement_setup *of, bool is_textured, arena *memory,
                         prepared_scene *out);
void prepared_scene_free(prepared_scene *p);

/* Item buffers of it come from a pool, drawn by what the options say, or else by what is fastest for its size. */
void prepared_scene_set_pool(prepared_scene *p, item_pool *pool, const bake_options *o);

#endif
