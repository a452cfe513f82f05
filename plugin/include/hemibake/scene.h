/* SPDX-License-Identifier: MIT
 * What is lit, and by what? Materials, meshes, lights and the sky. Part of hemibake.h.
 */
#ifndef HEMIBAKE_SCENE_H
#define HEMIBAKE_SCENE_H

#include <hemibake/context.h>

HEMI_C_BEGIN

/* ---- materials and meshes ---------------------------------------------------------------------------------------- */

typedef struct hemi_scene hemi_scene;

typedef struct hemi_material_desc {
    uint32_t struct_size;   /* sizeof(hemi_material_desc) */
    const char *name;       /* for messages; may be NULL */
    double reflectance[3];  /* rho; values above HEMI_REFLECTANCE_MAX are clamped to it and reported */
    double emission[3];     /* emitted radiance, W/m2/sr, 0..1e30 */
    bool double_sided;      /* the back reflects and emits as the front does */
    double transmission[3]; /* share of the light that goes straight on past the surface: through glass, or past what
                               covers less than all of it. Both sides let through alike; where several such surfaces
                               stand in the way, their shares multiply. At most what reflectance leaves; where a mesh
                               has a texture, what that may say at most. Solved by rows, which HEMI_METHOD_AUTO takes
                               then if the build has rays; what others leave out is logged */
    double diffuse_transmission[3]; /* share that leaves diffusely by the other side, as from a lamp shade, which makes
                                       it double-sided. Together with reflectance it is clamped. Of rows too */
} hemi_material_desc;

/* A surface that reflects everything has no solution in a closed room; this is where rho is clamped. */
#define HEMI_REFLECTANCE_MAX 0.999

/* What textures make of a piece of a surface, as means over its area. */
typedef struct hemi_texture_mean {
    double reflectance[3];                                      /* rho, 0..1; clamped as a material's */
    double emission[3];                                         /* emitted radiance, W/m2/sr */
    double demodulated_reflectance[3], demodulated_emission[3]; /* the same divided by the texture that the host goes on
                                                       showing on the surface; see hemi_mesh_view.demodulated */
    double transmission[3], diffuse_transmission[3]; /* as of the material; demodulated_reflectance is of reflectance
                                                        and diffuse_transmission together */
} hemi_texture_mean;

/* Means over a planar convex polygon of 3 or 4 corners, attributes[attribute_count*i+k] of corner i. *out holds what
 * the material says. Called by hemi_bake, on its own thread unless the mesh says that any will do. */
typedef void (*hemi_texture_fn)(void *user, const double *attributes, uint32_t corner_count, hemi_texture_mean *out);

typedef enum hemi_wrap { HEMI_WRAP_REPEAT, HEMI_WRAP_CLAMP, HEMI_WRAP_MIRROR } hemi_wrap;

/* What an alpha map cuts out of a mesh: leaves out of quads, wires out of a fence. There is a hole where
 *
 *     alpha / 255 * w < cutoff,     alpha of the texel that holds (u, v), unfiltered, row 0 at v = 0
 *
 * Light and sight pass through holes; what is in one neither receives nor reflects nor emits, so that areas and powers
 * are those of what is left. Only shadows through holes larger than the distance of samples are seen as patterns; what
 * is finer comes out right in the mean. */
typedef struct hemi_alpha_mask {
    uint32_t struct_size;   /* sizeof(hemi_alpha_mask) */
    const uint8_t *alpha;   /* alpha[row*width+column]; used until the last bake of the scene */
    uint32_t width, height; /* 1..16384 */
    hemi_wrap wrap_u, wrap_v;
    uint32_t attribute; /* which of a vertex's attributes is u; the next two are v and w */
    double cutoff;      /* not negative */
} hemi_alpha_mask;

typedef enum hemi_subdivision_scheme {
    HEMI_SUBDIVISION_NONE, /* the mesh is taken as it is */
    HEMI_SUBDIVISION_CATMULL_CLARK,
    HEMI_SUBDIVISION_LOOP, /* every face a triangle */
    HEMI_SUBDIVISION_BILINEAR
} hemi_subdivision_scheme;

/* How the limit surface is tessellated. */
typedef enum hemi_tessellation_rule {
    HEMI_TESSELLATION_UNIFORM, /* every edge into 2^level */
    HEMI_TESSELLATION_ADAPTIVE /* into the power of two that its curvature asks for, at most 2^level; without
                                  T-junctions */
} hemi_tessellation_rule;

/* What a subdivision surface does along the border of an open cage. */
typedef enum hemi_boundary {
    HEMI_BOUNDARY_DEFAULT, /* edge and corner */
    HEMI_BOUNDARY_EDGE_AND_CORNER,
    HEMI_BOUNDARY_EDGE_ONLY, /* corners of one face are rounded too */
    HEMI_BOUNDARY_NONE       /* faces on the border only support those inside and are not drawn */
} hemi_boundary;

/* Which parts of face-varying attributes are interpolated linearly where they are split; OpenSubdiv's and USD's names.
 */
typedef enum hemi_face_varying {
    HEMI_FACE_VARYING_DEFAULT, /* corners plus 1 */
    HEMI_FACE_VARYING_NONE,
    HEMI_FACE_VARYING_CORNERS_ONLY,
    HEMI_FACE_VARYING_CORNERS_PLUS_1,
    HEMI_FACE_VARYING_CORNERS_PLUS_2,
    HEMI_FACE_VARYING_BOUNDARIES,
    HEMI_FACE_VARYING_ALL
} hemi_face_varying;

/* A mesh as the control cage of a subdivision surface. Vertices at one place are one vertex of the cage, whatever their
 * attributes are; those then vary by face. */
typedef struct hemi_subdivision_desc {
    uint32_t struct_size; /* sizeof(hemi_subdivision_desc) */
    hemi_subdivision_scheme scheme;
    uint32_t level; /* edges are halved so often, 1..8, and their ends moved to the limit surface */
    hemi_tessellation_rule tessellation;
    hemi_boundary boundary;
    hemi_face_varying face_varying;
    const uint32_t *face_sizes; /* corners of face f, a fan of face_sizes[f] - 2 triangles around its first corner, one
                                   face after the other. NULL: for Catmull-Clark coplanar pairs become quads */
    uint32_t face_count;        /* 0: every triangle is a face */
    const uint32_t *crease_edges;  /* crease_edges[2*i], crease_edges[2*i+1]: vertices at the ends of an edge ... */
    const float *crease_sharpness; /* ... and its sharpness: 0 smooth, from 10 on a hard edge */
    uint32_t crease_count;
    const uint32_t *corner_vertices; /* vertices that are sharp by themselves ... */
    const float *corner_sharpness;   /* ... and how much */
    uint32_t corner_count;
    const uint32_t *holes; /* faces that shape the surface but are not part of it */
    uint32_t hole_count;
} hemi_subdivision_desc;

typedef struct hemi_mesh_desc {
    uint32_t struct_size;    /* sizeof(hemi_mesh_desc) */
    const char *name;        /* for messages; may be NULL */
    const float *positions;  /* positions[3*v+k], metres, in the mesh's own frame */
    const float *normals;    /* normals[3*v+k]; where they differ is a crease. NULL: every plane is a face of its own */
    const float *attributes; /* attributes[attribute_count*v+k]: anything that must interpolate linearly over a face
                                (texture coordinates, ...), or NULL; only read to keep faces apart that may not merge */
    uint32_t attribute_count;
    uint32_t vertex_count;
    const uint32_t *indices; /* indices[3*t+k] < vertex_count */
    uint32_t triangle_count;
    uint32_t material;    /* from hemi_scene_add_material */
    double transform[16]; /* mesh to world, column-major: x_world[r] = sum_c transform[4*c+r] x[c]; all 0: identity */
    const hemi_subdivision_desc *subdivision; /* NULL: the triangles are the surface, not its control cage */
    hemi_texture_fn texture; /* NULL: the material is the same everywhere. On a subdivision surface it is asked with
                                the attributes of the limit, face-varying */
    void *texture_user;      /* both are used until the last bake of the scene */
    const hemi_alpha_mask
        *alpha_mask;       /* NULL: nothing is cut out. Needs attributes; on a subdivision surface, of its cage */
    bool keep_vertices;    /* what comes out has these vertices and triangles, in their order, with the colours on them
                              that    come closest to the light: for what is skinned or morphed. Of a double-sided mesh the
                              backs    follow. Not of a subdivision surface */
    uint32_t detail_group; /* meshes that are levels of detail of one thing have a number in common; 0: it has none */
    uint32_t detail_level; /* 0 gives and takes light as any mesh. Others take no part: they show the light that arrives
                              where level 0 is nearest and faces the same way, at their own vertices */
    double element_size;   /* target edge of its elements before they are refined, m; 0 and below: that of the bake */
    uint32_t light_group;  /* that its emission belongs to: hemi_bake_desc.light_groups */
    bool texture_is_reentrant; /* texture may be called on several threads at once */
} hemi_mesh_desc;

HEMI_API hemi_result hemi_scene_create(hemi_context *context, hemi_scene **out);
HEMI_API void hemi_scene_destroy(hemi_scene *scene); /* NULL is fine */

/* out_index may be NULL. Indices count up from 0. */
HEMI_API hemi_result hemi_scene_add_material(hemi_scene *scene, const hemi_material_desc *desc, uint32_t *out_index);

/* Triangles without area are counted and dropped; indices out of range and positions that are not finite are
 * HEMI_ERROR_DATA. A transform that mirrors turns the triangles round, so that fronts stay fronts. */
HEMI_API hemi_result hemi_scene_add_mesh(hemi_scene *scene, const hemi_mesh_desc *desc, uint32_t *out_index);

/* ---- light that no surface emits --------------------------------------------------------------------------------- */

typedef enum hemi_light_kind { HEMI_LIGHT_POINT, HEMI_LIGHT_SPOT, HEMI_LIGHT_DIRECTIONAL } hemi_light_kind;

/* Lights without a surface, as in KHR_lights_punctual. Photometric numbers fit as well, if all are: a light in candela
 * and lux beside emission in nits gives radiance in nits. A point light of intensity I gives a surface at distance r
 * the irradiance I cos / r^2, which then leaves as radiance rho / pi times that. */
typedef struct hemi_light_desc {
    uint32_t struct_size; /* sizeof(hemi_light_desc) */
    hemi_light_kind kind;
    const char *name;         /* for messages; may be NULL */
    double intensity[3];      /* W/sr; directional: irradiance of a surface that faces it, W/m2; 0..1e30 */
    double position[3];       /* world, m; not read of a directional light */
    double direction[3];      /* the way its light travels, of any length; not read of a point light */
    double inner_cone;        /* radians from the direction to where a spot begins to fade ... */
    double outer_cone;        /* ... and to where it ends: 0 <= inner <= outer <= pi / 2; 0: pi / 4 */
    double range;             /* m, where point and spot have faded out: times max(0, 1 - (r / range)^4); 0: none */
    double angular_diameter;  /* radians, below pi / 2, of a directional light that has a disc; 0: sharp shadows */
    const float *profile;     /* of a point light, a measured one: profile[profile_columns*row+column], finite and not
                                 negative, is what its intensity is multiplied by at the angle pi row / (profile_rows - 1)
                                 from direction and 2 pi column / profile_columns round it, from profile_axis on,
                                 counter-clockwise for who looks at the light; NULL: 1 everywhere */
    uint32_t profile_rows;    /* 2..65536 */
    uint32_t profile_columns; /* 1..65536; 1: the same all round */
    double profile_axis[3];   /* of any length, not along direction; all 0: any */
    uint32_t light_group;     /* that it belongs to: hemi_bake_desc.light_groups */
} hemi_light_desc;

/* HEMI_ERROR_DATA where a number is out of its range. out_index may be NULL. */
HEMI_API hemi_result hemi_scene_add_light(hemi_scene *scene, const hemi_light_desc *desc, uint32_t *out_index);

/* What is seen past all surfaces, in every direction, also from below; y is up. */
typedef struct hemi_sky_desc {
    uint32_t struct_size;   /* sizeof(hemi_sky_desc) */
    double radiance[3];     /* W/m2/sr, 0..1e30; what the image is multiplied by, if there is one */
    const float *image;     /* image[3*(row*width+column)+c]: a panorama of the whole sphere, row 0 at the zenith;
                               direction d at column (1/2 + atan2(z, x) / 2 pi) width and row (1/2 - asin(y) / pi)
                               height; finite, not negative; NULL: the same radiance everywhere */
    uint32_t width, height; /* of the image, 1..65536 */
    uint32_t light_group;   /* that it belongs to: hemi_bake_desc.light_groups */
} hemi_sky_desc;

/* Replaces the sky there was. A scene in which nothing emits and that has neither lights nor a sky is baked under a
 * sky of radiance 1, and the log says so. */
HEMI_API hemi_result hemi_scene_set_sky(hemi_scene *scene, const hemi_sky_desc *desc);

HEMI_C_END
#endif
