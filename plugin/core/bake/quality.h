/* SPDX-License-Identifier: MIT
 * What do draft, medium, high and reference mean? Sizes follow the area of the scene, so that a preset costs about the
 * same on a doll's house and on a hangar.
 */
#ifndef HEMIBAKE_CORE_BAKE_QUALITY_H
#define HEMIBAKE_CORE_BAKE_QUALITY_H

#include "base/deadline.h"
#include "light/direct_light.h"
#include "solver/progressive.h"

typedef enum bake_quality {
    QUALITY_DEFAULT,
    QUALITY_DRAFT,
    QUALITY_MEDIUM,
    QUALITY_HIGH,
    QUALITY_REFERENCE
} bake_quality;

/* How fine is a bake that a goal asks for? Beyond what a quality says, which all of it being 0 leaves alone. */
typedef struct bake_fineness {
    double elements, rays, emitter_rays; /* of rows, in those of draft */
    double level;                        /* of columns: a quality, or what lies between two */
} bake_fineness;

/* How a scene is baked. Of what is asked for, 0 is the preset of the quality and a negative number is off;
 * quality_resolve leaves no field that means anything but itself. */
typedef struct bake_options {
    solver_method method;
    bake_quality quality;
    double element_size, patch_size;   /* m */
    uint32_t hemicube, hemicube_light; /* pixels across */
    double unshot_target, error_target, time_limit_s;
    bake_fineness fineness; /* goal.h's */
    deadline cuts_latest;   /* goal.h's: later no element is cut further before there is light */
    uint64_t process_limit; /* bytes of the process at its peak, which memory_fit.h keeps it to; 0: any */
    uint64_t memory_limit;  /* bytes of kept columns, or of rays */
    double light_tolerance;
    uint64_t seed;
    uint32_t max_elements;
    int adapt_levels; /* how often an element may be quartered by its light */
    double adapt_error;
    double proxy_error; /* in elements */
    bool flat;
    double cluster_angle; /* degrees */
    double decimate_error;
    bool facets;             /* every facet is shaded flat, whatever normals the meshes bring */
    int bounces;             /* reflections before the last; 0: all, below 0: none */
    double open_distance;    /* m, past which the sky is seen; 0: none */
    uint32_t light_groups;   /* that the light is told apart by; 0: it is not */
    bool vertex_errors;      /* where the error lies is found too */
    bool keeps_rows;         /* rows are kept, for groups of lights or other lights */
    item_backend visibility; /* what draws item buffers; DEFAULT: what is there and fastest */
    /* These follow from what is above. */
    bool is_crowded;              /* nearly every triangle is an element, at any size */
    bool is_packed;               /* far more than that */
    bool hurries;                 /* the mesh alone would take the time that there is: nothing makes it better */
    uint32_t even_levels;         /* how often elements of one size are quartered after the light has settled */
    int light_depth, patch_depth; /* how often a shooter may be quartered, emitters and others */
    bool unshot_is_given, light_tolerance_is_given;
    bool adapting_is_given; /* how often elements are quartered, or until what is left */
    int rows_initial;       /* of rows_setup: initial_rays ... */
    int rows_emitter;       /* rays of a sample to emitters */
    double rows_adaptive;   /* ... and adaptive_rays ... */
    double rows_noise;      /* ... and noise_target */
    size_t check_points;    /* that the error estimate looks at ... */
    int check_hemicube;     /* ... and the pixels across of the hemi-cubes on them */
    direct_light_quality direct_light;
} bake_options;

/* Methods that are there to be compared with are left as the paper has them. */
static inline bool quality_compares(const bake_options *o) {
    return o->method == SOLVER_PR || o->method == SOLVER_FM;
}

/* Does it ask for what rows alone do? Light is shot by columns in the order of its power, whatever its bounces are. */
bool quality_needs_rows(const bake_options *o);

/* Columns or rows, where that is left open: rows for many shooters, or many triangles that emit, and where far_lights,
 * a sky, or suns beside what is lit by lamps, if the build has rays and no size of columns is asked for; and wherever
 * surfaces let light through, or nothing else will do. Decided by the scene and the options alone. said: what the user
 * should know of the choice, one line, or "". */
enum { QUALITY_LINE_SIZE = 320 };
solver_method quality_choose_method(const bake_options *o, size_t shooter_count, size_t emitting, bool far_lights,
                                    bool transmits, char said[QUALITY_LINE_SIZE]);

/* What draws item buffers of so many triangles: what is asked for, else OpenGL, or rays where these are predicted to be
 * faster. Decided by the options and the scene alone, of what the build has. */
item_backend quality_choose_backend(const bake_options *o, size_t triangles);

/* Fills what was not asked for, from the quality and from the area of the scene, m2. scale: of the numbers of elements
 * and patches that the quality means; 0: as it means them. */
void quality_resolve(bake_options *o, double scene_area, double scale);

/* Elements of one size that are many to a patch are solved with coarser ones: makes element_size the size of those, and
 * sets even_levels. */
void quality_resolve_even(bake_options *o);

/* Elements that no size was asked for are larger where there are many times as many as the quality means, since most
 * triangles are smaller than one; those that a goal has coarser than draft are smaller, since there coarse ones save
 * little. crowding: how many times. */
void quality_fit_crowd(bake_options *o, double crowding);

/* Then: no elements are much larger than what much of the area is of, common_size, m, since light on the ground between
 * houses changes from one to the next. */
void quality_fit_common(bake_options *o, double common_size);

/* The most that a goal asks for of each kind: what reference has, and four times its rays to emitters, since elements
 * that are fewer have more of their noise left. */
bake_fineness quality_finest(void);

/* The finest quality of at most so many times the elements of draft, and the scale that makes it as many. */
bake_quality quality_of_size(double size, double *scale);

/* The elements by which meshes are dense, and stand-ins near enough: by rows no larger than those of draft, since no
 * estimate knows of what stand-ins are off by. Where 5 % were asked for a garage was off by 11. */
double quality_stand_in_size(const bake_options *o);

#endif
