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
 *     hemi_mesh_view view = { .struct_size = sizeof view };
 *     hemi_solution_mesh(solution, 0, &view);          // vertices, triangles, radiance
 *     hemi_solution_destroy(solution); hemi_scene_destroy(scene); hemi_context_destroy(context);
 *
 * Memory: what goes in is copied before the call returns. Views point into the solution and live as long as it. All
 * that the library takes for a context comes from the context's allocator, if the host gives one.
 * Threads: calls on one context must not overlap; different contexts are independent.
 * Errors: whatever can fail returns a hemi_result; the text goes to the context's log callback, on the calling
 * thread. The library never prints, exits, aborts or reads the environment. The item buffers are drawn by Mesa's
 * llvmpipe, which reads LP_NUM_THREADS when its first context is made: a host that sets it to 0 before the first
 * bake is served best, since hemibake brings its own threads.
 *
 * Defaults: the zero of a field of a desc is its default, which only the library knows; hosts pass zero for what their
 * users did not say. Where something can be off, a negative number is off, and counts that can be off are signed.
 *
 * Versions: a major version is one ABI. Within it functions and result codes are only added, and fields only at the end
 * of structs that begin with struct_size; all other structs stay as they are, the groups of hemi_statistics too. Who
 * owns the memory of a struct sets its struct_size:
 *
 *     a desc, that the host fills            sizeof the desc. From an older host it is shorter, and what it lacks is
 *                                            the default; from a newer one it is longer: HEMI_ERROR_ARGUMENT, and a
 *                                            line that says so.
 *     a view, that the library fills         sizeof the view, before the call. The library writes what both know, and
 *                                            zeroes what only the host knows. A size that no version has had is
 *                                            HEMI_ERROR_ARGUMENT.
 *     what the library passes by pointer     The library sets it (hemi_progress). A host with a newer header reads a
 *                                            field only if it is within the size.
 *
 * Lists that may grow so are counted and read one by one into a view, never as arrays, since a host would step through
 * an array by the size that it knows. plugin_table.h serves hosts that use dlopen.
 */
#ifndef HEMIBAKE_H
#define HEMIBAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HEMI_VERSION_MAJOR  1
#define HEMI_VERSION_MINOR  0
#define HEMI_VERSION_PATCH  0
#define HEMI_VERSION_STRING "1.0.0" /* everything that says a version takes it from here */

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
    X(HEMI_ERROR_NO_LIGHT, "no light reaches the front of a surface")                                                  \
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

/* Where memory comes from: as malloc, realloc and free of C11, aligned for any type. They are called from the context's
 * threads too, several at a time, and must not call back into the library. What alloc or realloc refuse (NULL) becomes
 * HEMI_ERROR_MEMORY of the call under way, and the handles stay usable. Not through it go what the libraries below take
 * for themselves (OSMesa or EGL, OpenSubdiv, the C++ runtime) and what the C library takes for threads and sorting. */
typedef struct hemi_allocator {
    void *(*alloc)(void *user, size_t bytes); /* bytes > 0 */
    void *(*realloc)(void *user, void *block, size_t bytes);
    void (*free)(void *user, void *block);
    void *user;
} hemi_allocator;

typedef struct hemi_context_desc {
    uint32_t struct_size; /* sizeof(hemi_context_desc) */
    uint32_t threads;     /* worker threads; 0: one for each online core */
    hemi_log_fn log;      /* NULL: silence */
    void *log_user;
    hemi_allocator allocator; /* all three functions, or none: the C library's */
} hemi_context_desc;

/* desc may be NULL (all defaults). */
HEMI_API hemi_result hemi_context_create(const hemi_context_desc *desc, hemi_context **out);
/* NULL is fine. Scenes and solutions come first; so do factors, if the context has an allocator. */
HEMI_API void hemi_context_destroy(hemi_context *context);

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

/* What textures make of a piece of a surface, as means over its area. */
typedef struct hemi_texture_mean {
    double reflectance[3];                                      /* rho, 0..1; clamped as a material's */
    double emission[3];                                         /* emitted radiance, W/m2/sr */
    double demodulated_reflectance[3], demodulated_emission[3]; /* the same divided by the texture that the host goes on
                                                       showing on the surface; see hemi_mesh_view.demodulated */
} hemi_texture_mean;

/* Means over a planar convex polygon of 3 or 4 corners, attributes[attribute_count*i+k] of corner i. *out holds what
 * the material says. Called by hemi_bake, on its own thread. */
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
        *alpha_mask; /* NULL: nothing is cut out. Needs attributes; on a subdivision surface, of its cage */
} hemi_mesh_desc;

HEMI_API hemi_result hemi_scene_create(hemi_context *context, hemi_scene **out);
HEMI_API void hemi_scene_destroy(hemi_scene *scene); /* NULL is fine */

/* out_index may be NULL. Indices count up from 0. */
HEMI_API hemi_result hemi_scene_add_material(hemi_scene *scene, const hemi_material_desc *desc, uint32_t *out_index);

/* Triangles without area are counted and dropped; indices out of range and positions that are not finite are
 * HEMI_ERROR_DATA. A transform that mirrors turns the triangles round, so that fronts stay fronts. */
HEMI_API hemi_result hemi_scene_add_mesh(hemi_scene *scene, const hemi_mesh_desc *desc, uint32_t *out_index);

/* ---- light that no surface emits ------------------------------------------------------------------------------- */

typedef enum hemi_light_kind { HEMI_LIGHT_POINT, HEMI_LIGHT_SPOT, HEMI_LIGHT_DIRECTIONAL } hemi_light_kind;

/* Lights without a surface, as in KHR_lights_punctual. Photometric numbers fit as well, if all are: a light in candela
 * and lux beside emission in nits gives radiance in nits. A point light of intensity I gives a surface at distance r
 * the irradiance I cos / r^2, which then leaves as radiance rho / pi times that. */
typedef struct hemi_light_desc {
    uint32_t struct_size; /* sizeof(hemi_light_desc) */
    hemi_light_kind kind;
    const char *name;        /* for messages; may be NULL */
    double intensity[3];     /* W/sr; directional: irradiance of a surface that faces it, W/m2; 0..1e30 */
    double position[3];      /* world, m; not read of a directional light */
    double direction[3];     /* the way its light travels, of any length; not read of a point light */
    double inner_cone;       /* radians from the direction to where a spot begins to fade ... */
    double outer_cone;       /* ... and to where it ends: 0 <= inner < outer <= pi / 2; 0: pi / 4 */
    double range;            /* m, where point and spot have faded out: times max(0, 1 - (r / range)^4); 0: none */
    double angular_diameter; /* radians, below pi / 2, of a directional light that has a disc; 0: sharp shadows */
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
} hemi_sky_desc;

/* Replaces the sky there was. A scene in which nothing emits and that has neither lights nor a sky is baked under a
 * sky of radiance 1, and the log says so. */
HEMI_API hemi_result hemi_scene_set_sky(hemi_scene *scene, const hemi_sky_desc *desc);

/* ---- bake ------------------------------------------------------------------------------------------------------ */

typedef enum hemi_quality {
    HEMI_QUALITY_DEFAULT, /* medium */
    HEMI_QUALITY_DRAFT,
    HEMI_QUALITY_MEDIUM,
    HEMI_QUALITY_HIGH,
    HEMI_QUALITY_REFERENCE
} hemi_quality;

typedef struct hemi_progress {
    uint32_t struct_size;   /* sizeof(hemi_progress) of the library */
    double fraction;        /* 0..1 of the whole bake, never falls */
    const char *stage;      /* "mesh", "light", "factors", "refine", "reconstruct" */
    uint32_t shots;         /* patches shot so far */
    double unshot_fraction; /* power still to be shot / power emitted */
} hemi_progress;

/* Called on the thread that called hemi_bake. Return false to stop: hemi_bake then returns HEMI_CANCELLED. */
typedef bool (*hemi_progress_fn)(void *user, const hemi_progress *progress);

/* How radiosity is solved. The others are what [Baum89] compares the hybrid with. */
typedef enum hemi_method {
    HEMI_METHOD_DEFAULT,  /* hybrid */
    HEMI_METHOD_HYBRID,   /* hemi-cubes decide visibility; closed forms for emitters and near the shooter */
    HEMI_METHOD_ANALYTIC, /* closed forms everywhere */
    HEMI_METHOD_PR,       /* the original progressive refinement: pixels are counted */
    HEMI_METHOD_FM        /* full matrix: hemi-cubes on all elements; memory as elements times patches */
} hemi_method;

typedef struct hemi_bake_desc {
    uint32_t struct_size; /* sizeof(hemi_bake_desc) */
    hemi_method method;
    hemi_quality quality;    /* presets of every field below that is 0 */
    double element_size;     /* target edge of an element before it is refined, m */
    double patch_size;       /* target edge of a patch, m */
    uint32_t hemicube;       /* pixels across the top of a hemi-cube; 16..4096 */
    uint32_t hemicube_light; /* the same on emitters */
    double unshot_target;    /* stop when this fraction of the emitted power is unshot */
    double error_target;     /* stop when the estimated relative error is below this: with neither quality nor sizes
                                given, qualities are climbed from draft until it is. 0 and below: none */
    double time_limit_s;     /* stop shooting after this many seconds; the solution says it did not converge. With the
                                default quality, no sizes and no error_target: as fine as fits into them. 0 and below:
                                none */
    int64_t memory_limit;    /* bytes for kept form-factor columns; past it columns are computed again, and a full
                                matrix is refused (HEMI_ERROR_LIMIT). 0: 4 GiB; below 0: none */
    double light_tolerance;  /* share of an emitter's power in penumbra that quarters it further; 0: 0.005 */
    uint64_t seed;           /* of the hemi-cubes' turns about their normals */
    uint32_t max_elements;   /* refuse to start with more than this, and refine to no more; 0: 4,000,000 */
    hemi_progress_fn progress;
    void *progress_user;
    const volatile int *stop; /* NULL, or a flag that a signal handler or another thread sets: stop shooting soon and
                                   return what is there, as at the time limit */
    int32_t adapt_levels;     /* how often an element may be quartered where light is not linear, 1..8. 0: by quality,
                                 or never if element_size is given; below 0: never. The methods PR and FM never do */
    double adapt_error;       /* relative error by the size of elements that is aimed at; 0: by quality */
    double proxy_error;       /* how far a simplified mesh that is solved in the place of a dense one may be from it, in
                                 elements; 0: 0.1; below 0: every mesh is solved as it is */
    bool flat;                /* one colour a triangle, the mean of its corners, and three vertices of its own */
    double cluster_angle;     /* degrees: patches much smaller than patch_size shoot as one with those beside them whose
                                 normals are no further from the mean; 0: 20; below 0: each shoots alone */
    double decimate_error;    /* triangles of flat faces are decimated where that changes no colour by more than this
                                 share of it, 1e-9..1. 0: by quality, or none where elements are of one size; below 0,
                                 or with flat: none */
} hemi_bake_desc;

typedef struct hemi_solution hemi_solution;

/* Solves the radiosity of the scene. desc may be NULL (all defaults). The scene can be baked again. */
HEMI_API hemi_result hemi_bake(hemi_scene *scene, const hemi_bake_desc *desc, hemi_solution **out);
HEMI_API void hemi_solution_destroy(hemi_solution *solution); /* NULL is fine */

/* ---- what a bake gives ----------------------------------------------------------------------------------------- */

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
    const float *attributes;  /* attributes[attribute_count*v+k] of the limit surface; NULL unless subdivided */
    uint32_t attribute_count; /* as in the mesh desc */
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

/* ---- statistics: the groups of the command's JSON report ----------------------------------------------------------
 */

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
} hemi_time_statistics;

typedef struct hemi_memory_statistics {
    uint64_t column_bytes; /* of form factors, kept at the end */
} hemi_memory_statistics;

typedef struct hemi_solver_statistics {
    uint32_t threads, shots, hemicubes;
    double unshot_fraction; /* of the emitted power */
    bool converged;         /* the target was met; false: the time limit came first */
    bool rows_closed;       /* the factors at every sample of a closed room were brought to sum to 1 */
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
    double punctual_w, sky_w; /* sums over rgb that arrived at fronts */
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

typedef struct hemi_error_statistics {
    double estimate; /* relative error [Baum89, eq. 12], by the residual of the radiosity equation at points */
    double unshot, factors, discretisation; /* where it may come from, each by itself */
    double bias;               /* mean of what is shown against the radiosity equation; positive: shown too bright */
    uint32_t points;           /* at which the estimate was taken */
    double decimation;         /* by decimation, over all, as a relative error; estimate has it */
    double decimation_largest; /* the largest change of radiance by it, as a share of it, or of a tenth of its mean
                                  where it is darker */
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
    const int32_t *corners;    /* 0 <= corners[4*i+c] < vertex_count; corners[4*i+3] is below 0 in a triangle */
    const bool *obstructions;  /* obstructions[i]: blocks light, but has neither row nor column values; NULL: none */
    uint32_t polygon_count;    /* at most HEMI_FACTORS_MAX */
    double tolerance;          /* absolute, of every factor; 0: 1e-5 */
    uint64_t evaluation_limit; /* of a pair; 0: 200,000 */
} hemi_factors_desc;

#define HEMI_FACTORS_MAX 8192u

/* F[i*n+j]: the fraction leaving i that reaches j, n = polygon_count; A_i F_ij = A_j F_ji holds exactly. */
typedef struct hemi_factors {
    uint32_t struct_size; /* sizeof(hemi_factors), set before the call */
    uint32_t polygon_count;
    double *areas;   /* areas[i], m2; both triangles of a quad that was taken as two */
    double *factors; /* factors[i*n+j] */
    double *errors;  /* errors[i*n+j]: estimated absolute error of factors[i*n+j] */
    uint32_t not_planar, concave, crossing, no_area, not_finite; /* polygons */
    uint64_t unconverged_pairs; /* whose error stayed above the tolerance within the evaluation limit */
    uint64_t evaluations;       /* closed forms with their visible parts */
} hemi_factors;

/* Unoccluded and partly occluded factors of all pairs, by adaptive integration of the closed form over the visible part
 * of each polygon. n^2 doubles twice are allocated; hemi_factors_free releases them. */
HEMI_API hemi_result hemi_factors_compute(hemi_context *context, const hemi_factors_desc *desc, hemi_factors *out);
/* Leaves nothing but struct_size. NULL is fine. */
HEMI_API void hemi_factors_free(hemi_factors *factors);

#ifdef __cplusplus
}
#endif
#endif
