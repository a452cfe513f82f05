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
 *     hemi_solution_mesh(solution, 0, &view);          // vertices, triangles, radiance
 *     hemi_solution_destroy(solution); hemi_scene_destroy(scene); hemi_context_destroy(context);
 *
 * Memory: what goes in is copied before the call returns. Views point into the solution and live as long as it.
 * Threads: calls on one context must not overlap; different contexts are independent.
 * Errors: whatever can fail returns a hemi_result; the text goes to the context's log callback, on the calling
 * thread. The library never prints, exits, aborts or reads the environment. The item buffers are drawn by Mesa's
 * llvmpipe, which reads LP_NUM_THREADS when its first context is made: a host that sets it to 0 before the first
 * bake is served best, since hemibake brings its own threads.
 *
 * Versions: every desc begins with its size. A host built with an older header is understood: what its descs lack is
 * the default. One built with a newer header gets HEMI_ERROR_ARGUMENT. plugin_table.h serves hosts that use dlopen.
 */
#ifndef HEMIBAKE_H
#define HEMIBAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HEMI_VERSION_MAJOR  0
#define HEMI_VERSION_MINOR  1
#define HEMI_VERSION_PATCH  0
#define HEMI_VERSION_STRING "0.1.0"

#if defined(__GNUC__)
#define HEMI_API __attribute__((visibility("default")))
#else
#define HEMI_API
#endif

/* ---- results --------------------------------------------------------------------------------------------------- */

/* X(name, text): every result code with the sentence that hemi_result_text returns for it. */
#define HEMI_RESULTS(X)                                                                                                \
    X(HEMI_OK, "done")                                                                                                 \
    X(HEMI_ERROR_ARGUMENT, "an argument breaks the rules of the interface")                                            \
    X(HEMI_ERROR_MEMORY, "out of memory")                                                                              \
    X(HEMI_ERROR_DATA, "the data is malformed")                                                                        \
    X(HEMI_ERROR_UNSUPPORTED, "the data asks for something that is not supported")                                     \
    X(HEMI_ERROR_NO_SURFACES, "there is no surface to bake")                                                           \
    X(HEMI_ERROR_NO_LIGHT, "nothing in the scene emits light")                                                         \
    X(HEMI_ERROR_LIMIT, "a size limit is exceeded")                                                                    \
    X(HEMI_ERROR_BACKEND, "the item-buffer back end failed")                                                           \
    X(HEMI_ERROR_FILE, "a file could not be read or written")                                                          \
    X(HEMI_CANCELLED, "cancelled by the progress callback")

typedef enum hemi_result {
#define HEMI_RESULT_ENUM(name, text) name,
    HEMI_RESULTS(HEMI_RESULT_ENUM)
#undef HEMI_RESULT_ENUM
        HEMI_RESULT_COUNT
} hemi_result;

/* The sentence that belongs to a code; never NULL. */
HEMI_API const char *hemi_result_text(hemi_result result);

/* "MAJOR.MINOR.PATCH" of the library that is linked (HEMI_VERSION_STRING is that of the header). */
HEMI_API const char *hemi_version(void);

/* ---- context --------------------------------------------------------------------------------------------------- */

typedef enum hemi_log_level { HEMI_LOG_ERROR, HEMI_LOG_WARNING, HEMI_LOG_INFO } hemi_log_level;

/* One line without its newline; valid during the call only. */
typedef void (*hemi_log_fn)(void *user, hemi_log_level level, const char *text);

typedef struct hemi_context hemi_context;

typedef struct hemi_context_desc {
    uint32_t struct_size; /* sizeof(hemi_context_desc) */
    uint32_t threads;     /* worker threads; 0: one for each online core */
    hemi_log_fn log;      /* NULL: silence */
    void *log_user;
} hemi_context_desc;

/* desc may be NULL (all defaults). */
HEMI_API hemi_result hemi_context_create(const hemi_context_desc *desc, hemi_context **out);
HEMI_API void hemi_context_destroy(hemi_context *context); /* NULL is fine; destroy scenes and solutions first */

/* ---- scene ----------------------------------------------------------------------------------------------------- */

typedef struct hemi_scene hemi_scene;

typedef struct hemi_material_desc {
    uint32_t struct_size;  /* sizeof(hemi_material_desc) */
    const char *name;      /* for messages; may be NULL */
    double reflectance[3]; /* rho; values above HEMI_REFLECTANCE_MAX are clamped to it and reported */
    double emission[3];    /* emitted radiance, W/m2/sr, 0..1e30 */
    bool double_sided;     /* the back reflects and emits as the front does */
} hemi_material_desc;

/* A surface that reflects everything has no solution in a closed room; this is where rho is clamped. */
#define HEMI_REFLECTANCE_MAX 0.999

typedef enum hemi_subdivision {
    HEMI_SUBDIVISION_NONE,
    HEMI_SUBDIVISION_CATMULL_CLARK,
    HEMI_SUBDIVISION_LOOP
} hemi_subdivision;

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
    hemi_subdivision subdivision; /* the triangles are the control cage of this scheme ... */
    uint32_t subdivision_level;   /* ... refined this often, then moved to the limit surface */
} hemi_mesh_desc;

HEMI_API hemi_result hemi_scene_create(hemi_context *context, hemi_scene **out);
HEMI_API void hemi_scene_destroy(hemi_scene *scene); /* NULL is fine */

/* out_index may be NULL. Indices count up from 0. */
HEMI_API hemi_result hemi_scene_add_material(hemi_scene *scene, const hemi_material_desc *desc, uint32_t *out_index);

/* Triangles without area are counted and dropped; indices out of range and positions that are not finite are
 * HEMI_ERROR_DATA. A transform that mirrors turns the triangles round, so that fronts stay fronts. */
HEMI_API hemi_result hemi_scene_add_mesh(hemi_scene *scene, const hemi_mesh_desc *desc, uint32_t *out_index);

/* ---- bake ------------------------------------------------------------------------------------------------------ */

typedef enum hemi_quality {
    HEMI_QUALITY_DEFAULT, /* medium */
    HEMI_QUALITY_DRAFT,
    HEMI_QUALITY_MEDIUM,
    HEMI_QUALITY_HIGH,
    HEMI_QUALITY_REFERENCE
} hemi_quality;

typedef struct hemi_progress {
    double fraction;        /* 0..1 of the whole bake, never falls */
    const char *stage;      /* "mesh", "factors", "solve", "reconstruct" */
    uint32_t shots;         /* patches shot so far */
    double unshot_fraction; /* power still to be shot / power emitted */
} hemi_progress;

/* Called on the thread that called hemi_bake. Return false to stop: hemi_bake then returns HEMI_CANCELLED. */
typedef bool (*hemi_progress_fn)(void *user, const hemi_progress *progress);

/* How radiosity is solved. The others are what [Baum89] compares the hybrid with. */
typedef enum hemi_method {
    HEMI_METHOD_DEFAULT,  /* hybrid */
    HEMI_METHOD_HYBRID,   /* hemi-cubes decide visibility; closed forms for lamps and near the shooter */
    HEMI_METHOD_ANALYTIC, /* closed forms everywhere */
    HEMI_METHOD_PR,       /* the original progressive refinement: pixels are counted */
    HEMI_METHOD_FM        /* full matrix: hemi-cubes on all elements; memory as elements times patches */
} hemi_method;

typedef struct hemi_bake_desc {
    uint32_t struct_size; /* sizeof(hemi_bake_desc) */
    hemi_method method;
    hemi_quality quality;    /* presets of every field below that is 0 */
    double element_size;     /* target edge of an element, m */
    double patch_size;       /* target edge of a patch, m */
    uint32_t hemicube;       /* pixels across the top of a hemi-cube; 16..4096 */
    uint32_t hemicube_light; /* the same on emitters */
    double unshot_target;    /* stop when this fraction of the emitted power is unshot */
    double error_target;     /* stop when the estimated relative error is below this */
    double time_limit_s;     /* stop shooting after this many seconds; the solution says it did not converge */
    uint64_t memory_limit;   /* bytes for kept form-factor columns; past it columns are computed again, and a full
                                matrix is refused (HEMI_ERROR_LIMIT). 0: 4 GiB */
    double light_tolerance;  /* share of an emitter's power in penumbra that quarters it further; 0: 0.005 */
    uint64_t seed;           /* of the hemi-cubes' turns about their normals */
    uint32_t max_elements;   /* refuse to make more than this; 0: 4,000,000 */
    hemi_progress_fn progress;
    void *progress_user;
    const volatile int *finish; /* NULL, or a flag that a signal handler or another thread sets: stop shooting soon and
                                   return what is there, as at the time limit */
} hemi_bake_desc;

typedef struct hemi_solution hemi_solution;

/* Solves the radiosity of the scene. desc may be NULL (all defaults). The scene can be baked again. */
HEMI_API hemi_result hemi_bake(hemi_scene *scene, const hemi_bake_desc *desc, hemi_solution **out);
HEMI_API void hemi_solution_destroy(hemi_solution *solution); /* NULL is fine */

/* ---- what a bake gives ----------------------------------------------------------------------------------------- */

/* The triangles of one mesh after tessellation, in the mesh's own frame. The backs of a double-sided mesh follow its
 * fronts as triangles of their own, wound the other way. */
typedef struct hemi_mesh_view {
    uint32_t vertex_count;
    uint32_t triangle_count;
    const uint32_t *indices; /* indices[3*t+k] */
    const float *positions;  /* positions[3*v+k] */
    const float *normals;    /* normals[3*v+k], unit */
    const float *radiance;   /* radiance[3*v+c]: outgoing (emitted + reflected), W/m2/sr; radiosity = pi times it */
    const uint32_t *source_triangles; /* of vertex v: a triangle of the mesh desc that holds it; NULL if subdivided */
    const float *source_weights;      /* source_weights[3*v+k]: its barycentric coordinates in that triangle */
} hemi_mesh_view;

HEMI_API hemi_result hemi_solution_mesh(const hemi_solution *solution, uint32_t mesh, hemi_mesh_view *out);

/* One point of the speed-against-error curve. */
typedef struct hemi_curve_point {
    double t_s; /* since hemi_bake began */
    uint32_t shots;
    double unshot_fraction;
    double error_estimate;
    uint64_t analytic, evaluations; /* form factors so far: by the closed form, and all */
} hemi_curve_point;

typedef struct hemi_statistics {
    uint32_t surfaces; /* planar faces that are drawn */
    uint32_t materials, lights /* patches that emit */, patches, elements, samples, vertices_out, triangles_out;
    uint32_t degenerate_triangles; /* dropped: without area */
    uint32_t clamped_materials;    /* reflectance above HEMI_REFLECTANCE_MAX */
    double mesh_s, factors_s, solve_s, reconstruct_s, total_s;
    uint32_t threads, shots, hemicubes;
    double unshot_fraction;
    bool converged;                                    /* the target was met; false: the time limit came first */
    double emitted_w, absorbed_w, escaped_w, unshot_w; /* sums over rgb; emitted = absorbed + escaped + unshot */
    double energy_residual;                            /* |emitted - absorbed - escaped - unshot| / emitted */
    double closure_min, closure_mean,
        closure_max;             /* of sum_e A_e F_ei / A_i over the front fraction of the hemi-cube */
    double analytic_fraction;    /* of factor evaluations by the closed form */
    uint32_t subdivided_patches; /* shooters that were split */
    uint32_t clipped;            /* columns whose excess was normalised away [Baum89, eq. 11] */
    double error_estimate;
    double error_unshot, error_factors, error_discretisation; /* its parts */
    uint64_t column_bytes;                                    /* kept at the end */
    bool rows_closed; /* the factors at every sample of a closed room were brought to sum to 1 */
} hemi_statistics;

/* Writes min(struct_size, sizeof(hemi_statistics)) bytes. */
HEMI_API hemi_result hemi_solution_statistics(const hemi_solution *solution, hemi_statistics *out, size_t struct_size);

/* What was decided about one shooter: a patch, or one of the quarters (of quarters) that it was cut into. */
typedef struct hemi_shooter {
    uint32_t patch;
    uint32_t depth; /* 0: the whole patch */
    uint32_t shots;
    uint32_t hemicubes;
    uint64_t analytic;  /* factors by the closed form */
    uint64_t estimated; /* factors by the hemi-cube: point estimates, or pixels counted */
    bool split;         /* drawn from quarters, by what they see or by an excess of [Baum89, eq. 10] */
} hemi_shooter;

/* All that have shot or were about to, in patch order; shooters stays valid as long as the solution. */
HEMI_API hemi_result hemi_solution_shooters(const hemi_solution *solution, const hemi_shooter **shooters,
                                            size_t *count);

/* points stays valid as long as the solution. */
HEMI_API hemi_result hemi_solution_curve(const hemi_solution *solution, const hemi_curve_point **points, size_t *count);

/* ---- pictures -------------------------------------------------------------------------------------------------- */

typedef struct hemi_picture_mesh {
    const float *positions;  /* world, positions[3*v+k] */
    const float *colors;     /* colors[3*v+c], any linear scale */
    const uint32_t *indices; /* indices[3*t+k] */
    uint32_t vertex_count, triangle_count;
} hemi_picture_mesh;

typedef struct hemi_picture_desc {
    uint32_t struct_size; /* sizeof(hemi_picture_desc) */
    const hemi_picture_mesh *meshes;
    size_t mesh_count;
    double eye[3], target[3], up[3]; /* all 0: a view of the whole, from outside and above */
    double vertical_fov;             /* radians; 0: 40 degrees */
    uint32_t width, height;          /* pixels, 1..8192 */
    uint32_t supersample;            /* rays a pixel and axis; 0: 3 */
    bool flat;                       /* one colour a triangle, the mean of its corners */
    bool draw_backs;                 /* default: backs are culled, as web viewers do with single-sided materials */
    float background[3];
} hemi_picture_desc;

/* Draws triangles through the item buffer. pixels[4*(y*width+x)+c]: linear rgb and coverage, row 0 on top. */
HEMI_API hemi_result hemi_picture(hemi_context *context, const hemi_picture_desc *desc, float *pixels);

/* ---- form factors ---------------------------------------------------------------------------------------------- */

/* Planar polygons of three or four corners, counter-clockwise seen from their fronts; each is one row and column. A
 * quad that is not planar, or concave, is taken as two triangles; a crossing one (a bow-tie), one without area and one
 * whose corners are not finite is left out: its row is 0 and it blocks nothing. All are counted in the result. */
typedef struct hemi_factors_desc {
    uint32_t struct_size;    /* sizeof(hemi_factors_desc) */
    const double *positions; /* positions[3*v+k] */
    uint32_t vertex_count;
    const uint32_t *corners;   /* corners[4*i+c] < vertex_count; corners[4*i+3] == UINT32_MAX in a triangle */
    const bool *obstructions;  /* obstructions[i]: blocks light, but has neither row nor column values; NULL: none */
    uint32_t polygon_count;    /* at most HEMI_FACTORS_MAX */
    double tolerance;          /* absolute, of every factor; 0: 1e-5 */
    uint64_t evaluation_limit; /* of a pair; 0: 200,000 */
} hemi_factors_desc;

#define HEMI_FACTORS_MAX 8192u

/* F[i*n+j]: the fraction leaving i that reaches j, n = polygon_count; A_i F_ij = A_j F_ji holds exactly. */
typedef struct hemi_factors {
    uint32_t polygon_count;
    double *areas;   /* areas[i], m2; both triangles of a quad that was cut */
    double *factors; /* factors[i*n+j] */
    double *errors;  /* errors[i*n+j]: estimated absolute error of factors[i*n+j] */
    uint32_t not_planar, concave, crossing, no_area, not_finite; /* polygons */
    uint64_t unconverged_pairs; /* whose error stayed above the tolerance within the evaluation limit */
    uint64_t evaluations;       /* closed forms with their visible parts */
} hemi_factors;

/* Unoccluded and partly occluded factors of all pairs, by adaptive integration of the closed form over the visible part
 * of each polygon. n^2 doubles twice are allocated; hemi_factors_free releases them. */
HEMI_API hemi_result hemi_factors_compute(hemi_context *context, const hemi_factors_desc *desc, hemi_factors *out);
HEMI_API void hemi_factors_free(hemi_factors *factors); /* leaves it empty */

#ifdef __cplusplus
}
#endif
#endif
