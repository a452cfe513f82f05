/* SPDX-License-Identifier: MIT
 * What is behind the opaque handles of hemibake.h?
 */
#ifndef HEMIBAKE_API_INTERNAL_H
#define HEMIBAKE_API_INTERNAL_H

#include <hemibake/hemibake.h>

#include "base/chunk_file.h"
#include "base/jobs.h"
#include "visibility/item_buffer.h"

#include <pthread.h>

enum { CONTEXT_LINE_SIZE = 512 };

/* What a worker had to say. */
typedef struct pending_line {
    struct pending_line *next;
    hemi_log_level level;
    char text[CONTEXT_LINE_SIZE];
} pending_line;

struct hemi_context {
    allocator memory;
    hemi_allocator blocks; /* the same for converters, whose arrays may then be freed as blocks */
    hemi_log_fn log;
    void *log_user;
    uint32_t threads;
    pthread_t caller; /* of the call under way, where is_working */
    bool is_working;
    pthread_mutex_t pending_mutex;
    pending_line *pending; /* oldest first */
    jobs *jobs;
    item_pool *pool; /* from the first scene on; its contexts of OpenGL are made while what they draw is */
};

/* A mesh desc with its own copies of everything it points to. */
typedef struct mesh_copy {
    hemi_mesh_desc desc;
    char *name;
    float *positions, *normals, *attributes;
    uint32_t *indices;
    hemi_subdivision_desc *subdivision;
    uint32_t *face_sizes, *crease_edges, *corner_vertices, *holes;
    float *crease_sharpness, *corner_sharpness;
    hemi_alpha_mask *alpha_mask; /* its alpha is the host's */
} mesh_copy;

struct hemi_scene {
    hemi_context *context;
    hemi_material_desc *materials; /* name: our own copy of those whose reflectance was clamped, otherwise NULL */
    mesh_copy *meshes;
    size_t material_count, material_capacity, mesh_count, mesh_capacity;
    bool clamped_said;       /* say_clamped */
    bool method_said;        /* what of the choice of the method the user should know */
    bool hurry_said;         /* that there is no time for a better mesh */
    hemi_light_desc *lights; /* names are not kept */
    size_t light_count, light_capacity;
    hemi_sky_desc sky; /* struct_size 0: none */
    float *sky_image;
};

/* What hemi_solution_mesh points into. */
typedef struct solved_mesh {
    uint32_t vertex_count, triangle_count;
    uint32_t *indices, *source_triangles;
    float *positions, *normals, *radiance, *demodulated, *source_weights, *attributes, *errors;
    float *light_groups;                                     /* as in hemi_mesh_view */
    uint32_t attribute_count, light_group_count, has_errors; /* the last is read by solved_mesh_allocate */
} solved_mesh;

struct hemi_solution {
    solved_mesh *meshes;
    size_t mesh_count;
    hemi_statistics statistics;
    hemi_curve_point *curve;
    hemi_shooter *shooters;
    size_t curve_count, shooter_count;
    chunk_memory rows; /* what hemi_solution_relight reads */
};

/* Formats one line for the context's log callback. */
void context_log(const hemi_context *c, hemi_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Hands on what workers had to say meanwhile; on the thread that called. */
void context_say_pending(hemi_context *c);

/* Logs an error and returns the code. */
#define context_fail(context, code, ...) (context_log((context), HEMI_LOG_ERROR, __VA_ARGS__), (code))

/* Begins a call that may run out of memory anywhere; the other ends it: HEMI_ERROR_MEMORY, with its line in the log, if
 * it did, whatever else went wrong for it, and the result as it is if not. */
void context_begin(hemi_context *c);
hemi_result context_end(hemi_context *c, hemi_result result);

/* The end of a call that takes memory once. */
#define context_out_of_memory(context) context_end((context), HEMI_ERROR_MEMORY)

/* Logs why the core failed and returns the code; memory is left to context_end. */
hemi_result context_core_failure(const hemi_context *c, const char *failure);

/* Seconds from an arbitrary start; never goes back. */
double monotonic_seconds(void);

/* Is the mesh a control cage? */
bool mesh_is_subdivided(const hemi_mesh_desc *m);

void mesh_copy_free(mesh_copy *m);
/* Makes the arrays of a mesh whose counts are set. False when out of memory; what there is is to be freed then too. */
bool solved_mesh_allocate(allocator *memory, solved_mesh *m, bool has_source, bool has_demodulated);
void solved_mesh_free(solved_mesh *m);

#endif
