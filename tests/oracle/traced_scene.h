/* SPDX-License-Identifier: MIT
 * What does a ray meet in a scene? The same surfaces and sides as hemibake's, behind Embree: fronts reflect and emit,
 * backs absorb, a double-sided material has two fronts, holes of an alpha mask let rays through, and of two skins in
 * one plane each is met from its front. A pane lets a share of the light straight through from either side, also where
 * its back absorbs the rest.
 */
#ifndef HEMIBAKE_ORACLE_TRACED_SCENE_H
#define HEMIBAKE_ORACLE_TRACED_SCENE_H

#include <hemibake/hemibake.h>

typedef struct traced_triangle {
    double corner[3][3], normal[3]; /* world, m; unit */
    double area;
    uint32_t mesh, vertex[3]; /* of the mesh */
} traced_triangle;

/* A place on a surface, seen from one of its fronts. */
typedef struct traced_point {
    double position[3], normal[3]; /* the front's, unit */
    double shading[3];             /* by which light is received there: normal, or as the mesh's normals say */
    double weights[3];             /* of the triangle's corners */
    double eye[3], horizon[3]; /* where light is looked for from, and what of it may come from above what: position and
                                  normal, or on the surface that smooth normals tell of */
    uint32_t triangle;
} traced_point;

typedef struct traced_scene {
    hemi_material_desc *materials;
    uint32_t material_count;
    hemi_mesh_desc *meshes; /* what they point to is the caller's, until the scene is destroyed */
    uint32_t mesh_count;
    hemi_light_desc *lights;
    uint32_t light_count;
    hemi_sky_desc sky; /* radiance 0: none */
    traced_triangle *triangles;
    size_t triangle_count, triangle_room;
    double center[3], radius; /* of a ball around it */
    bool faces;               /* normals of meshes are not asked for */
    bool panes;               /* some surface lets light straight through */
    double offset;            /* m: what is nearer to a ray's origin than that is the surface that it leaves */
    struct RTCDeviceTy *device;
    struct RTCSceneTy *embree;
    uint32_t *numbers[2]; /* numbers[g][p]: the triangle that primitive p of Embree's geometry g is */
} traced_scene;

typedef enum traced_what { TRACED_SKY, TRACED_BLACK, TRACED_SURFACE } traced_what;

/* Zero first, then add, then commit once. All false: out of memory, or an index out of range. */
bool traced_scene_add_material(traced_scene *s, const hemi_material_desc *material);
bool traced_scene_add_mesh(traced_scene *s, const hemi_mesh_desc *mesh);
bool traced_scene_add_light(traced_scene *s, const hemi_light_desc *light);

/* A scene without any light gets a sky of radiance 1, as in hemibake. False also where Embree refuses. */
bool traced_scene_commit(traced_scene *s);
void traced_scene_destroy(traced_scene *s);

/* What the ray from a point on a surface meets; out is set of all but TRACED_SKY. */
traced_what traced_scene_hit(const traced_scene *s, const traced_point *from, const double direction[3],
                             traced_point *out);

/* Does anything stand between a point on a surface and one that is so far away? INFINITY: the sky. Panes do not: passed
 * is the share of the light that they let through. */
bool traced_scene_blocked(const traced_scene *s, const traced_point *from, const double direction[3], double distance,
                          double passed[3]);

/* The surface nearest to a place, within reach (m) along its normal, whose front looks the same way; false: none. */
bool traced_scene_locate(const traced_scene *s, const double place[3], const double normal[3], double reach,
                         traced_point *out);

/* What a surface reflects and emits there; textures are asked for the point itself. */
void traced_scene_shade(const traced_scene *s, uint32_t triangle, const double weights[3], double rho[3],
                        double emission[3]);

/* Turns a point to the other side of its surface. */
void traced_point_turn(traced_point *at);

/* The shares of the light that pass it there straight, and that leave it diffusely by its other side. */
void traced_scene_transmittance(const traced_scene *s, uint32_t triangle, const double weights[3], double straight[3],
                                double diffuse[3]);

/* Sets which way it looks there, on the side of the unit normal of its front, the eye and the horizon of a point whose
 * other fields are set. */
void traced_scene_set_shading(const traced_scene *s, traced_point *at);

/* Mean emission of a triangle, of its fronts. */
void traced_scene_mean_emission(const traced_scene *s, uint32_t triangle, double emission[3]);
bool traced_scene_double_sided(const traced_scene *s, uint32_t triangle);

/* Radiance of the sky towards a unit direction. */
void traced_scene_sky(const traced_scene *s, const double direction[3], double radiance[3]);

#endif
