/* SPDX-License-Identifier: MIT
 * What is a primitive once it is decoded, and where does it stand? Private, C++; part of gltf_model.h.
 */
#ifndef HEMIBAKE_GLTF_GEOMETRY_H
#define HEMIBAKE_GLTF_GEOMETRY_H

#include "gltf_asset.h"

#include <memory>
#include <string>
#include <vector>

/* A vertex attribute as floats. */
struct gltf_attribute {
    std::string name;
    int components;
    bool discrete; /* integers that count or name something: never blended, the nearest corner's is taken */
    std::vector<float> values;
};

/* The triangles of one primitive, decoded. */
struct gltf_geometry {
    uint32_t vertex_count = 0;
    std::vector<float> positions, normals, colors, radiosity; /* empty: not there */
    std::vector<gltf_attribute> transferred; /* what a bake passes on: TEXCOORDs, then COLOR_1 ..., then _CUSTOM */
    std::vector<gltf_attribute> lit_only;    /* what only a lit material needs: TANGENT, COLOR_0 with alpha */
    std::vector<float> attributes;           /* transferred, COLOR_0's rgb, u v w of the alpha mask, interleaved */
    uint32_t attribute_count = 0;            /* numbers a vertex in attributes */
    int color_at = -1, mask_at = -1;         /* where the last two begin among them; -1: not there */
    std::vector<uint32_t> indices;
    std::vector<uint32_t> face_sizes; /* of polygons, fans of the triangles; empty: not known */
    bool in_world = false;            /* positions are those of a skin */
    std::vector<const char *> notes;  /* what is not as glTF has it, and is read all the same */
};

/* What extras say of a primitive as a control cage. */
struct gltf_cage {
    hemi_subdivision_desc desc{}; /* without faces; level 0: it is none after all */
    bool level_is_auto = false;   /* the host says, by the size of elements */
    std::vector<uint32_t> crease_edges, corner_vertices, holes;
    std::vector<float> crease_sharpness, corner_sharpness;
};

/* Which level of detail of what: 0 is what is seen from near. */
struct gltf_detail {
    int owner; /* the node that has levels; -1: none */
    int number;
};

/* What extras.hemibake asks; below 0: nothing. */
struct gltf_steering {
    int bake = -1, casts_shadow = -1, facets = -1;
    double element_size = 0; /* m; 0: that of the bake */
    std::string group;       /* of its light */
};

/* One primitive at one place: a mesh of gltf_asset.h. */
struct gltf_instance {
    int node, mesh, primitive;
    int copy;                    /* which instance of EXT_mesh_gpu_instancing, or -1 */
    uint32_t material, original; /* original: the first instance of the same geometry */
    double world[16];
    const gltf_geometry *geometry;
    std::shared_ptr<gltf_cage> cage;   /* null: extras do not ask for subdivision */
    hemi_subdivision_desc subdivision; /* of both; struct_size 0: there is nothing to say */
    const char *name;
    gltf_detail level;
    bool posed; /* skinned or morphed: the bake keeps its vertices */
    gltf_steering steering;
};

#endif
