/* SPDX-License-Identifier: MIT
 * Which triangles show the elements? Each element has its own (mesh/triangulation.h), and of those only the ones stay
 * that the picture needs (decimate.h).
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_OUTPUT_TRIANGLES_H
#define HEMIBAKE_CORE_RECONSTRUCT_OUTPUT_TRIANGLES_H

#include "reconstruct/decimate.h"
#include "reconstruct/fit_samples.h"
#include "reconstruct/vertex_fit.h"

typedef struct output_triangles {
    decimate_triangles all; /* corners are vertices of the mesh, faces surfaces of the scene */
    uint32_t *first;        /* first[i]: of input mesh i; and behind the last */
} output_triangles;

/* What an earlier bake made of the same elements, so that one by other lights begins from there; or what this one makes
 * of them. */
typedef struct output_record {
    uint8_t *diagonal;     /* of elements, by which triangles were listed */
    size_t diagonal_count; /* 0: none was */
    decimate_record collapses;
} output_record;

typedef struct output_triangles_input {
    const scene *scene;
    const mesh *mesh;
    const uint32_t *nodes; /* the colour node of vertex v */
    size_t node_count;
    uint32_t input_count;      /* of the input's meshes */
    const uint32_t *flat_face; /* flat_face[s]: the first surface of the flat face that surface s is a part of */
    const bool *kept;          /* kept[s]: the triangles of surface s stay */
    const fit_samples *samples;
    const vertex_fit_result *fit, *demodulated; /* demodulated: what colours carry where a texture stays, or NULL */
    jobs *jobs;
    watcher watch;         /* as in decimate_input */
    output_record *record; /* NULL: nobody asks */
    double decimate_error; /* share of the radiance at a vertex; 0: all triangles stay, and no faces are asked for */
} output_triangles_input;

/* What decimation did: how many triangles there were, and by what share of the radiance at a vertex it changed colours
 * at most, and over all, as a root of mean squares. */
typedef struct decimation_figures {
    uint32_t triangles_before;
    double error, rms;
} decimation_figures;

/* Marks vertices of backs in a list. */
#define OUTPUT_TRIANGLES_BACK (UINT32_C(1) << 31)

/* Lists the vertices of an input mesh in the order they were made: the input's first. local[v]: where vertex v is in
 * the list. Returns how many there are. A mesh may be listed again. */
uint32_t output_triangles_list(const output_triangles *t, const scene *s, size_t index, uint32_t *local,
                               uint32_t *order);

/* False when out of memory. */
bool output_triangles_make(const output_triangles_input *in, output_triangles *out, decimation_figures *figures);
void output_triangles_free(output_triangles *t);

#endif
