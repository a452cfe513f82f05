/* SPDX-License-Identifier: MIT
 * How far is a baked mesh from the truth, and where?
 *
 * Every probe is matched to the nearest triangle that it lies on, seen from the same side; the baked radiance there is
 * the barycentric mix of the corners. The relative error [Baum89, eq. 12, 13] over the matched probes and the bands is
 *
 *     error = sqrt( sum |bake - truth|^2 / sum |truth|^2 )
 *
 * Probes are uniform by area, so the sums are the equation's integrals over area. It is ruled by what is brightest; so
 * beside it stand the middle and the 95th percentile of a probe's own relative error, |bake - truth| / |truth|, where
 * the truth counts as no darker than MATCH_DIM_SHARE of its mean.
 */
#ifndef HEMIBAKE_PROBES_MATCH_H
#define HEMIBAKE_PROBES_MATCH_H

#include "probes.h"

/* A probe lies on a triangle that is nearer than this, in diagonals of the box around all vertices: 30 times what
 * 14-bit position quantisation moves a vertex (half a step of 1/16383 on three axes), and 5 mm in a room of 5 m, less
 * than anything is thick that has another colour on its other face. */
#define MATCH_DISTANCE 1e-3

/* Distances below this, in the same unit, are float32 rounding of positions (2^-24 of a coordinate, a few times) and
 * count as none: of two triangles that share the probe's edge neither is nearer. */
#define MATCH_DISTANCE_NOISE 1e-6

/* Same side: dot(probe normal, triangle normal) above this. Facets of a coarse sphere stay within it (60 degrees);
 * the other side of a sheet, and the wall beside a floor, do not. */
#define MATCH_FACING_MIN 0.5

/* Of the mean of |truth|: errors in what is darker are not seen beside the rest. */
#define MATCH_DIM_SHARE 0.02

#define MATCH_NONE SIZE_MAX

typedef struct match_mesh {
    const char *name;           /* of the node, for messages; may be NULL */
    const hemi_mesh_desc *mesh; /* positions, indices, transform are read, by the rules of hemi_mesh_desc */
    const float *radiance;      /* radiance[3*v+c], W/m2/sr */
} match_mesh;

/* Sums over the probes that matched; they can be added up over meshes before the division. */
typedef struct match_figure {
    size_t matched;
    double difference_squared; /* sum |bake - truth|^2 over probes and bands */
    double truth_squared;      /* sum |truth|^2 */
    double noise_squared;      /* sum 3 s^2, s the standard error of a band */
    double difference, truth;  /* sum (bake - truth), sum truth */
} match_figure;

/* Where a probe lies, and what is baked there. */
typedef struct match_place {
    size_t mesh; /* MATCH_NONE: on none */
    uint32_t triangle;
    double weights[3]; /* of its corners */
    double radiance[3];
} match_place;

typedef struct match_result {
    match_figure total;
    match_place *places;  /* places[i] of probe i; owned */
    match_figure *meshes; /* meshes[i] of the i-th mesh that went in; owned, match_result_destroy */
    size_t mesh_count;
    size_t unmatched;            /* probes that lie on no triangle */
    size_t degenerate_triangles; /* passed over: without area */
    double distance;             /* MATCH_DISTANCE in metres */
    size_t worst_probe;          /* of largest |bake - truth|; MATCH_NONE if nothing matched */
    size_t worst_mesh;           /* the mesh it lies on */
    float worst_radiance[3];     /* what was baked there */
    double worst_difference;     /* |bake - truth|, W/m2/sr */
    double median, percentile95; /* of a probe's relative error */
} match_result;

/* The same input always gives the same bits: of triangles equally near the one facing the probe better wins, then the
 * first. HEMI_ERROR_DATA: an index out of range, a position, transform or matched radiance that is not finite, or no
 * probe that lies on a triangle; HEMI_ERROR_ARGUMENT: null pointers or no probes; HEMI_ERROR_MEMORY. message gets one
 * line then and out is empty. Time: a streaming pass over the triangles, half a second for a million. */
hemi_result probes_match(const match_mesh *meshes, size_t mesh_count, const probe_set *set, match_result *out,
                         char message[PROBES_MESSAGE_SIZE]);

void match_result_destroy(match_result *result); /* NULL and empty are fine */

/* Of one probe that lies somewhere: |bake - truth| / |truth|, where the truth counts as no darker than dim, which
 * match_dim_level gives. */
double match_place_error(const probe *p, const match_place *at, double dim);
double match_dim_level(const probe_set *set);

/* Relative error of the bake; 0 without matched probes, HUGE_VAL where the truth is black and the bake is not. */
double match_error(const match_figure *figure);

/* Relative error that the truth itself has: an error of the bake below it means nothing. */
double match_noise(const match_figure *figure);

/* sum(bake - truth) / sum(truth): above 0 the bake is too bright. */
double match_bias(const match_figure *figure);

#endif
