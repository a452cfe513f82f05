/* SPDX-License-Identifier: MIT
 * What does a bake give? Meshes with their light, and what is known of how it was made. Part of hemibake.h.
 */
#ifndef HEMIBAKE_SOLUTION_H
#define HEMIBAKE_SOLUTION_H

#include <hemibake/bake.h>

HEMI_C_BEGIN

/* ---- meshes, curve and shooters ---------------------------------------------------------------------------------- */

/* The triangles of one mesh after tessellation, in the mesh's own frame. The backs of a double-sided mesh follow its
 * fronts as triangles of their own, wound the other way. */
typedef struct hemi_mesh_view {
    uint32_t struct_size; /* sizeof(hemi_mesh_view), set before the call */
    uint32_t vertex_count;
    uint32_t triangle_count;
    const uint32_t *indices; /* indices[3*t+k] */
    const float *positions;  /* positions[3*v+k] */
    const float *normals;    /* normals[3*v+k], unit */
    const float *radiance;   /* radiance[3*v+c]: outgoing (emitted + reflected), W/m2/sr; radiosity = pi times it */
    const uint32_t *source_triangles; /* of vertex v: a triangle of the mesh desc that holds it; NULL if subdivided */
    const float *source_weights;      /* source_weights[3*v+k]: its barycentric coordinates in that triangle */
    const float
        *demodulated; /* demodulated[3*v+c]: radiance divided by the texture that the host goes on showing, so that
                         demodulated times texture is radiance in the mean; NULL: the mesh has no textures */
    const float *attributes;   /* attributes[attribute_count*v+k] of the limit surface; NULL unless subdivided */
    uint32_t attribute_count;  /* as in the mesh desc */
    const float *light_groups; /* light_groups[3*(vertex_count*g+v)+c]: radiance by group g of lights alone; all of them
                                  add up to radiance. NULL: the bake was asked for none */
    uint32_t light_group_count;
    const float *errors; /* errors[v]: where the error lies, as a share of the rms radiance of all that does not emit:
                            their mean square over that is about the square of hemi_error_statistics.estimate; 0 where
                            it emits. NULL unless hemi_bake_desc.vertex_errors asks for it */
} hemi_mesh_view;

/* mesh: an index of hemi_scene_add_mesh. */
HEMI_API hemi_result hemi_solution_mesh(const hemi_solution *solution, uint32_t mesh, hemi_mesh_view *out);

/* One point of the speed-against-error curve. */
typedef struct hemi_curve_point {
    uint32_t struct_size; /* sizeof(hemi_curve_point), set before the call */
    double t_s;           /* since hemi_bake began */
    uint32_t shots;
    double unshot_fraction;
    double error_estimate;
    uint64_t analytic, evaluations; /* form factors so far: by the closed form, and all */
} hemi_curve_point;

/* Points in the order of time, 0 <= index < count; HEMI_ERROR_ARGUMENT beyond. */
HEMI_API size_t hemi_solution_curve_count(const hemi_solution *solution);
HEMI_API hemi_result hemi_solution_curve_point(const hemi_solution *solution, size_t index, hemi_curve_point *out);

/* What was decided about one shooter: a patch, or one of the quarters (of quarters) of it. */
typedef struct hemi_shooter {
    uint32_t struct_size; /* sizeof(hemi_shooter), set before the call */
    uint32_t patch;
    uint32_t depth; /* 0: the whole patch */
    uint32_t shots;
    uint32_t hemicubes;
    uint64_t analytic;  /* factors by the closed form */
    uint64_t estimated; /* factors by the hemi-cube: point estimates, or pixels counted */
    bool split;         /* drawn from quarters, by what they see or by an excess of [Baum89, eq. 10] */
} hemi_shooter;

/* All that have shot or were about to, in patch order, 0 <= index < count; HEMI_ERROR_ARGUMENT beyond. */
HEMI_API size_t hemi_solution_shooter_count(const hemi_solution *solution);
HEMI_API hemi_result hemi_solution_shooter(const hemi_solution *solution, size_t index, hemi_shooter *out);

/* ---- statistics: the groups of the command's JSON report --------------------------------------------------------- */

typedef struct hemi_scene_statistics {
    uint32_t surfaces; /* planar faces that are drawn */
    uint32_t materials;
    uint32_t emitting_patches;
    uint32_t patches;
    uint32_t clusters;          /* of small patches side by side that shoot as one ... */
    uint32_t clustered_patches; /* ... and how many patches are in them: the others shoot alone */
    uint32_t coarse_elements;   /* before they were adapted: what was solved with ... */
    uint32_t elements;          /* ... and after */
    uint32_t samples;           /* points at which light was received */
    uint32_t vertices_out, triangles_out;
    uint32_t triangles_before_decimation; /* of all elements ... */
    uint32_t triangles_decimated;         /* ... and those that the picture does not need */
    /* What was dropped or clamped. */
    uint32_t degenerate_triangles; /* without area */
    uint32_t duplicate_triangles;  /* in the place of an earlier one of their mesh */
    uint32_t duplicate_meshes;  /* in the place of an earlier one, vertex for vertex: not solved, they get its light */
    uint32_t clamped_materials; /* reflectance above HEMI_REFLECTANCE_MAX, where no texture says it otherwise */
    /* What is baked as it is, and may not be meant. */
    uint32_t nonmanifold_edges;     /* of more than two triangles */
    uint32_t slivers;               /* triangles more than twenty times as long as high, of meshes without a proxy */
    uint32_t t_junctions;           /* edges with a vertex of their mesh in the middle, of meshes without a proxy */
    uint32_t overlapping_triangles; /* that lie in the plane of an earlier one and overlap it */
    uint32_t intersecting_surfaces; /* that pass through another, or another through them */
    /* Meshes that are denser than the light on them needs are solved on simplified ones, their proxies; what is handed
     * back is whole. */
    uint32_t proxy_meshes;
    uint32_t proxied_triangles; /* of the dense meshes ... */
    uint32_t proxy_triangles;   /* ... and of their proxies */
    double proxy_error;         /* m, of the dense meshes' vertices from the proxies, the largest */
} hemi_scene_statistics;

/* Seconds. */
typedef struct hemi_time_statistics {
    double total_s, mesh_s, factors_s;
    double solve_s; /* with hemi_arrived_statistics.direct_light_s */
    double adapt_s, reconstruct_s;
    double own_s; /* of total_s, the bake that is shown: the rest led to it, where an error or a time is asked for */
} hemi_time_statistics;

typedef struct hemi_memory_statistics {
    uint64_t column_bytes; /* of form factors, kept at the end */
} hemi_memory_statistics;

typedef struct hemi_solver_statistics {
    uint32_t threads, shots, hemicubes;
    hemi_method method;     /* that was taken: HEMI_METHOD_HYBRID, ... */
    double unshot_fraction; /* of the emitted power */
    bool converged;         /* the target was met; false: the time limit came first */
    bool rows_closed;       /* the factors at every sample of a closed room were brought to sum to 1 */
    uint32_t drawn_by;      /* what drew item buffers: a bit 1 << hemi_visibility each; 0: none was drawn */
} hemi_solver_statistics;

/* Sums over rgb; emitted = absorbed + escaped + unshot. */
typedef struct hemi_energy_statistics {
    double emitted_w, absorbed_w, escaped_w, unshot_w;
    double residual; /* |emitted - absorbed - escaped - unshot| / emitted */
} hemi_energy_statistics;

/* Light that no surface emits: what it brings counts as emitted where it arrives. */
typedef struct hemi_arrived_statistics {
    uint32_t punctual_lights;
    uint32_t sky_patches;     /* directions in which the sky was looked at */
    double punctual_w, sky_w; /* sums over rgb that arrived at fronts; suns of a panorama are the sky's, or punctual
                                 where there are lights besides */
    double direct_light_s;    /* part of hemi_time_statistics.solve_s */
    bool sky_by_default;      /* nothing emitted, so a sky of radiance 1 was taken */
} hemi_arrived_statistics;

typedef struct hemi_factor_statistics {
    double closure_min, closure_mean,
        closure_max;             /* of sum_e A_e F_ei / A_i over the front fraction of the hemi-cube */
    double analytic_fraction;    /* of factor evaluations by the closed form */
    uint32_t subdivided_patches; /* shooters that were split */
    uint32_t clipped_columns;    /* whose excess was normalised away [Baum89, eq. 11] */
    double gathered_fraction;    /* of pairs of a shooter and an adapted element: gathered anew, not interpolated */
} hemi_factor_statistics;

/* What a mesh is off by, by itself: all may be right and a dim room in it not. */
typedef struct hemi_mesh_error {
    uint32_t mesh;   /* an index of hemi_scene_add_mesh */
    double estimate; /* relative error, of the light that it shows itself; 0: nothing is known */
    double light;    /* rms of that, as a share of the whole's */
    double area;     /* as a share of all */
} hemi_mesh_error;

typedef struct hemi_error_statistics {
    double estimate; /* relative error [Baum89, eq. 12], by the residual of the radiosity equation at points */
    double unshot, factors, discretisation; /* where it may come from, each by itself */
    double bias;               /* mean of what is shown against the radiosity equation; positive: shown too bright */
    uint32_t points;           /* at which the estimate was taken */
    double decimation;         /* by decimation, over all, as a relative error; estimate has it */
    double decimation_largest; /* the largest change of radiance by it, as a share of it, or of a tenth of its mean
                                  where it is darker */
    hemi_mesh_error worst;     /* of the mesh that is off by most of its own light, where rows say so */
} hemi_error_statistics;

typedef struct hemi_statistics {
    uint32_t struct_size; /* sizeof(hemi_statistics), set before the call */
    hemi_scene_statistics scene;
    hemi_time_statistics time;
    hemi_memory_statistics memory;
    hemi_solver_statistics solver;
    hemi_energy_statistics energy;
    hemi_arrived_statistics arrived;
    hemi_factor_statistics factors;
    hemi_error_statistics error;
} hemi_statistics;

HEMI_API hemi_result hemi_solution_statistics(const hemi_solution *solution, hemi_statistics *out);

HEMI_C_END
#endif
