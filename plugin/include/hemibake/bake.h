/* SPDX-License-Identifier: MIT
 * How is a scene baked, how finely, and until when? Part of hemibake.h.
 */
#ifndef HEMIBAKE_BAKE_H
#define HEMIBAKE_BAKE_H

#include <hemibake/scene.h>

HEMI_C_BEGIN

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
    double unshot_fraction; /* power still to be shot / power emitted; by rows what more iterations would change */
    double error_estimate;  /* the relative error by what is known so far; 1 before anything is */
    double elapsed_s;       /* since hemi_bake was called */
    double left_s;          /* until it returns, if work goes on as so far; below 0: too early to say */
} hemi_progress;

/* Called on the thread that called hemi_bake, about every 50 ms in every stage. Return false to stop: hemi_bake then
 * returns HEMI_CANCELLED. */
typedef bool (*hemi_progress_fn)(void *user, const hemi_progress *progress);

/* How radiosity is solved. The others are what [Baum89] compares the hybrid with. */
typedef enum hemi_method {
    HEMI_METHOD_DEFAULT,  /* auto */
    HEMI_METHOD_HYBRID,   /* hemi-cubes decide visibility; closed forms for emitters and near the shooter */
    HEMI_METHOD_ANALYTIC, /* closed forms everywhere */
    HEMI_METHOD_PR,       /* the original progressive refinement: pixels are counted */
    HEMI_METHOD_FM,       /* full matrix: hemi-cubes on all elements; memory as elements times patches */
    HEMI_METHOD_ROWS,     /* all light is gathered by rows of rays; elements of one size. Needs a build
                             with Embree */
    HEMI_METHOD_AUTO /* rows for many triangles, and under a sky that was set; else hybrid. The statistics say which */
} hemi_method;

typedef enum hemi_normals {
    HEMI_NORMALS_DEFAULT, /* FILE */
    HEMI_NORMALS_FILE,    /* those of the meshes, as renderers shade; a mesh without any is flat. PR and FM: FACES */
    HEMI_NORMALS_FACES    /* those of the triangles */
} hemi_normals;

/* What draws item buffers, which say what is seen of a scene. They show the same but for pixels on edges. */
typedef enum hemi_visibility {
    HEMI_VISIBILITY_DEFAULT, /* AUTO */
    HEMI_VISIBILITY_OSMESA,  /* OpenGL by Mesa's off-screen library */
    HEMI_VISIBILITY_EGL,     /* OpenGL without a window */
    HEMI_VISIBILITY_RAYS,    /* Embree */
    HEMI_VISIBILITY_AUTO /* the first of these that the build has; rays where they are predicted to be faster, and where
                            OpenGL gives no context */
} hemi_visibility;

/* Whoever keeps results that took long, so that another bake of the same scene with the same desc by the same version
 * goes on where one was ended, to the same bytes: it finds them instead of working them out. Both are called from any
 * thread, also at the same time. What is found is looked at before it is used; that it is of the same scene and desc
 * is for the host to know. A bake that goes by the clock (time_limit_s) is not to be gone on with. */
typedef struct hemi_checkpoint {
    uint32_t struct_size; /* sizeof(hemi_checkpoint) */
    void *user;
    /* How many bytes are kept by the key, 0: none; and copies them, if there is room for all. */
    uint64_t (*find)(void *user, const uint64_t key[2], void *bytes, uint64_t room);
    void (*add)(void *user, const uint64_t key[2], const void *bytes, uint64_t size);
} hemi_checkpoint;

/* Several processes that share one bake, on one machine or on many: each calls hemi_bake with the same scene and desc,
 * but for its rank and user, and gets the same solution, to the byte, as one process alone. By rows each casts those of
 * its own elements, keeps them, and gives the others what they gather; the rest is done by each. A desc with ranks has
 * no stop, time_limit_s or checkpoint, and its progress returns true. */
typedef struct hemi_ranks {
    uint32_t struct_size; /* sizeof(hemi_ranks) */
    uint32_t rank, count; /* of this process, from 0, and of them all */
    /* Brings begin[r] to begin[r+1] of the bytes from process r to all others. Called from the thread that bakes, by
     * all as often, of as many bytes; begin has count + 1 numbers. False: they cannot be reached; the bake fails. */
    bool (*exchange)(void *user, void *bytes, const uint64_t *begin);
    void *user;
} hemi_ranks;

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
    double time_limit_s;     /* return after about this many seconds with what is there; the solution says it did not
                                converge. With the default quality, no sizes and no error_target: as fine as fits into them.
                                0 and below:     none */
    int64_t memory_limit;   /* bytes of the process at its peak, as predicted: where more would be taken, fewer rays are
                               cast, fewer columns kept and fewer elements added; what is more at the least is refused
                               (HEMI_ERROR_LIMIT). 0: any, but 4 GiB for kept columns; below 0: any */
    double light_tolerance; /* share of an emitter's power in penumbra that quarters it further; 0: 0.005 */
    uint64_t seed;          /* of the hemi-cubes' turns about their normals */
    uint32_t max_elements;  /* refuse to start with more than this, and refine to no more; 0: 4,000,000 */
    hemi_progress_fn progress;
    void *progress_user;
    const volatile int *stop; /* NULL, or a flag that a signal handler or another thread sets: within a second
                                   shoot no further and return what is there, which has not converged; before anything
                                   was shot there is nothing, and that is HEMI_CANCELLED */
    int32_t adapt_levels;     /* how often an element may be quartered where light is not linear, 1..8. 0: by quality,
                                 or never if element_size is given; below 0: never. The methods PR and FM never do */
    double adapt_error;       /* relative error by the size of elements that is aimed at; 0: by quality */
    double proxy_error;       /* how far a simplified mesh that is solved in the place of a dense one may be from it, in
                                 elements; 0: 0.1, or 0.02 by rows; below 0: every mesh is solved as it is */
    bool flat;                /* one colour a triangle, the mean of its corners, and three vertices of its own */
    double cluster_angle;     /* degrees: patches much smaller than patch_size shoot as one with those beside them whose
                                 normals are no further from the mean; 0: 20; below 0: each shoots alone */
    double decimate_error;    /* triangles of flat faces are decimated where that changes no colour by more than this
                                 share of it, 1e-9..1. 0: by quality, or none where elements are of one size; below 0,
                                 or with flat: none */
    hemi_normals normals;     /* by which what is received is weighted */
    int32_t bounces;          /* reflections that light is followed through before the last, which is seen; 0: until it
                                 has settled; below 0: none, so that only direct light shows. By rows, which AUTO takes
                                 then */
    double open_distance; /* m; what is farther away than this neither blocks nor lights, and the sky is seen past it,
                             as ambient occlusion wants it; 0: nothing is. By rows too */
    hemi_visibility visibility; /* of columns, and of the error estimate that goes with them */
    bool keep_rows; /* the solution keeps its rows, which hemi_solution_relight lights anew. By rows, which AUTO takes
                       then, as for the next two. Not with error_target or time_limit_s */
    size_t (*rows_read)(void *user, void *bytes, size_t size); /* returns how many there were, fewer at the end: what
                  rows_write of a bake of the same geometry got. It is lit anew: the rows, and which elements were
                  split, are of then. Another geometry, other options of sizes and rays, and what is damaged are
                  HEMI_ERROR_BACKEND, with a line that says so. NULL: none */
    bool (*rows_write)(void *user, const void *bytes, size_t size); /* false: no more can be written, and the bake
                                                                       fails. NULL: none */
    void *rows_user;                                                /* of both */
    const char *rows_name;                                          /* for messages; may be NULL */
    uint32_t
        light_groups;   /* so many groups of lights, up to 64, are told apart: hemi_mesh_view.light_groups. Whose number
                           is not below this is HEMI_ERROR_ARGUMENT. 0: they are not. By rows, which AUTO takes then */
    bool vertex_errors; /* hemi_mesh_view.errors are found */
    const hemi_checkpoint *checkpoint; /* NULL, or without either function: nothing is kept */
    const hemi_ranks *ranks;           /* NULL: this process alone */
} hemi_bake_desc;

typedef struct hemi_solution hemi_solution;

/* Solves the radiosity of the scene. desc may be NULL (all defaults). The scene can be baked again. */
HEMI_API hemi_result hemi_bake(hemi_scene *scene, const hemi_bake_desc *desc, hemi_solution **out);
HEMI_API void hemi_solution_destroy(hemi_solution *solution); /* NULL is fine */

/* Bakes a scene of the same meshes, options and reflectances or others, with other emission, lights or sky, on the rows
 * of a solution that kept them (keep_rows): what costs a bake its time is not done again. desc: as of that bake, or
 * NULL; its rows_read and rows_write are not looked at. HEMI_ERROR_ARGUMENT where the solution kept none. */
HEMI_API hemi_result hemi_solution_relight(const hemi_solution *solution, hemi_scene *scene, const hemi_bake_desc *desc,
                                           hemi_solution **out);

/* What a bake would be, and cost. */
typedef struct hemi_forecast {
    uint32_t struct_size; /* sizeof(hemi_forecast) */
    hemi_method method;   /* that AUTO takes */
    uint32_t surfaces;    /* planar faces */
    uint32_t patches;
    uint32_t elements;     /* without those that adapting to the light adds */
    uint32_t samples;      /* points that receive */
    double processor_s;    /* of all threads together; within a factor 2 or so on one kind of processor */
    uint64_t memory_bytes; /* of the process at its peak */
} hemi_forecast;

/* Cuts the scene to patches and elements, as hemi_bake with this desc begins, and says what the rest would cost. Goals
 * of error and time are passed over. desc may be NULL. */
HEMI_API hemi_result hemi_scene_forecast(hemi_scene *scene, const hemi_bake_desc *desc, hemi_forecast *out);

HEMI_C_END
#endif
