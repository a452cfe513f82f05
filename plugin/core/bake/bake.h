/* SPDX-License-Identifier: MIT
 * How does a scene of patches and elements become vertex colours? The whole pipeline, from the light that arrives to
 * the triangles that show it.
 */
#ifndef HEMIBAKE_CORE_BAKE_BAKE_H
#define HEMIBAKE_CORE_BAKE_BAKE_H

#include "adapt/adapt.h"
#include "bake/goal.h"
#include "bake/light_groups.h"
#include "bake/worst_part.h"
#include "base/chunk_file.h"
#include "reconstruct/vertex_colors.h"

/* How far a bake is, and when it is to end. */
typedef struct bake_watch {
    double (*clock)(void);
    /* stage: "mesh", "light", "factors", "refine", "reconstruct"; fraction of the whole; error: what is known of it,
     * 1 before anything is. False cancels. May be NULL. */
    bool (*progress)(void *user, const char *stage, double fraction, uint32_t shots, double unshot_fraction,
                     double error);
    void *user;
    const volatile int *stop; /* not 0: shoot and adapt no further; may be NULL */
} bake_watch;

/* Where rows of an earlier bake come from, and where those of this one go; NULL: nowhere. */
typedef struct rows_store {
    chunk_read_fn read;
    chunk_write_fn write;
    void *user;
    const char *name;     /* for messages; may be NULL */
    chunk_writer *writer; /* relight_stage_begin's, as these: */
    chunk_reader *reader;
    output_record *record; /* by which triangles are merged, where rows are read or written */
} rows_store;

typedef struct bake_setup {
    const bake_options *options; /* resolved */
    bake_span span;
    bake_watch watch;
    jobs *jobs;
    lights *lights;            /* whose first fields are set */
    rows_store rows;           /* needs options->keeps_rows */
    light_groups_input groups; /* of options->light_groups */
    refinement_setup scene;    /* what is solved on, and how its mesh is refined */
    arena *memory;             /* of the mesh that it becomes */
    const item_geometry *items;
    const uint32_t *triangle_surface;
    const mesh_items *patches, *elements; /* elements: for SOLVER_PR only */
    bool emitters_are_split;              /* because a picture glows on them */
    bool fits_irradiance;                 /* as in vertex_colors_setup */
    material *const *demodulated;         /* as in vertex_colors_setup, of the elements that there are at the end */
    output_triangles_input triangles;     /* inputs and faces */
    const char *(*shade)(void *user);     /* as in adapt_setup */
    /* Called once it is known that a sky of radiance 1 lights what would be dark. */
    void (*say_default_sky)(void *user);
    /* Called where memory leaves so much of the rays that the quality means. */
    void (*say_fewer_rays)(void *user, double share);
    void *user;
} bake_setup;

typedef struct bake_result {
    direct_light direct; /* what arrives before anything is shot; empty without lights and a sky */
    progressive_result solution;
    adapt_result adapted;
    double adapt_s, reconstruct_s;
    uint32_t coarse_elements; /* that were solved with */
    vertex_colors colors;
    part_error worst;    /* of rows */
    light_groups groups; /* as many as the options say */
    bool no_light;       /* why it failed: none reaches the front of a surface */
    bool cancelled;
} bake_result;

/* What a bake says to whoever looks for a goal. */
static inline bake_outcome bake_outcome_of(const bake_result *r, const bake_options *o) {
    const progressive_result *s = &r->solution;
    return (bake_outcome){ r->colors.error,  s->by_rows,       s->ray_noise,
                           s->emitter_noise, r->colors.uneven, o->fineness.elements };
}

/* NULL on success, else why it failed; cancelled is a success without a result. */
const char *bake(const bake_setup *setup, bake_result *out, char *message, size_t message_size);
void bake_result_free(bake_result *r);

#endif
