/* SPDX-License-Identifier: MIT
 * What does an option say, and what do its values mean? option_list.h is the list; hosts in C set options by it, each
 * from a text.
 */
#ifndef HEMIBAKE_HOSTS_OPTION_TABLE_H
#define HEMIBAKE_HOSTS_OPTION_TABLE_H

#include <hemibake/hemibake.h>

typedef struct option_exposure {
    bool is_fixed; /* false: auto */
    double ev;
} option_exposure;

typedef struct option_sun {
    bool is_given;
    double values[4]; /* azimuth, elevation, angular diameter in degrees at [0], [1], [3]; lux at [2] */
} option_sun;

typedef struct option_point {
    bool is_given;
    double values[3];
} option_point;

enum { MOVING_REST = 1, MOVING_LEAVE = 2 }; /* the words of --moving, in order */

typedef enum command {
    COMMAND_BAKE = 1,
    COMMAND_COMPARE = 2,
    COMMAND_RENDER = 4,
    COMMAND_FACTORS = 8,
    COMMAND_INSPECT = 16,
    COMMAND_VIEW = 32
} command;

/* Marks of an option: see option_list.h. */
enum { MARK_FILES = 1, MARK_SCENES = 2, MARK_DOCUMENTS = 4, MARK_STAMPED = 8, MARK_ZERO_IS_OFF = 16 };

enum {
    OPTION_COUNT = 0
#define OPTION(...) +1
#include "option_list.h"
#undef OPTION
};

/* What options say. Zero is what is not given, but for what options_clear sets. */
typedef struct options {
    hemi_bake_desc bake; /* without its callbacks */
    uint32_t threads;
    double tolerance; /* of form factors */
    double emissive_scale; /* 0: 1 */
    const char *output, *report, *preview, *reference, *camera, *depfile;
    const char *checkpoint, *resume;
    const char *ocio, *display, *view, *look, *input_space, *working_space;
    const char *environment;            /* R,G,B or a file */
    const char *root;                   /* folder that nothing outside of is read */
    uint64_t max_pixels;                /* of an image; 0: the default */
    const char *scene;                  /* of glTF: a name, a number, or all; NULL: the default one */
    const char *continues;              /* what is read in the place of the input: it with other scenes baked */
    const char *variant;                /* of glTF a look, of USD choices */
    const char *layer;                  /* of USD */
    uint32_t moving;                    /* 0: not given, 1: at rest, 2: left as it is */
    double time_code;                   /* of USD; not a number: the stage's own */
    uint32_t subdivision;               /* a hemi_subdivision_scheme */
    uint32_t metals;                    /* 0: not given, then a gltf_metals from 1 */
    int32_t subdivide;                  /* levels; 0: as meshes ask for; below 0: none */
    uint32_t progress;                  /* 0: not given, then from 1 */
    int32_t draco_level, draco_bits[4]; /* bits: position, normal, color, texcoord */
    uint32_t size[2];                   /* of the picture */
    uint32_t turntable, worst;          /* 0: none */
    const char *heatmap, *before, *rows, *lights_from;
    uint32_t port; /* 0: any that is free */
    option_exposure exposure;
    option_sun sun;
    option_point look_from, look_at;
    bool scene_linear, no_draco, keep_pbr, keep_instances, keep_lamps, quiet, force, json, strict, all_cameras,
        subdivide_adaptive, ao, light_groups;
    const char *given[OPTION_COUNT]; /* in the table's order: the value as text, "" of a flag, NULL: not given */
    command command;                 /* of a command line, as its inputs */
    const char *const *inputs;
    int input_count;
    uint32_t jobs;                       /* 0: one */
    bool is_one_of_many, hides_progress; /* of a bake that a bake of many began */
} options;

typedef enum option_kind {
    KIND_FLAG, /* stands alone and is true */
    KIND_OFF,  /* stands alone and turns off what its field is about */
    KIND_TEXT,
    KIND_NUMBER,  /* a share, whose largest is 1, also as 5% */
    KIND_SECONDS, /* a number, also as 10s, 5m or 1h */
    KIND_COUNT,
    KIND_LEVEL,     /* a count, or auto, which is the default */
    KIND_MEBIBYTES, /* a count; the field holds bytes */
    KIND_CHOICE,    /* the field counts words from 1, as enumerations do after their defaults */
    KIND_EXPOSURE,
    KIND_BITS,
    KIND_SUN,
    KIND_SKY, /* a text */
    KIND_SIZE,
    KIND_POINT
} option_kind;

/* How the field of an option holds its number. */
typedef enum option_store {
    STORE_BOOL,
    STORE_INT32,
    STORE_UINT32,
    STORE_INT64,
    STORE_UINT64,
    STORE_DOUBLE,
    STORE_OTHER
} option_store;

typedef struct option {
    const char *name, *argument; /* argument: NULL of what stands alone */
    option_kind kind;
    size_t offset; /* of its field */
    option_store store;
    double low, high;
    int commands, marks;
    const char *help;
} option;

extern const option OPTIONS[OPTION_COUNT];

/* As help --json calls them. */
const char *option_kind_name(option_kind kind);

static inline bool option_stands_alone(const option *o) {
    return o->kind == KIND_FLAG || o->kind == KIND_OFF;
}

/* What is not given; the defaults of a bake are the library's. */
void options_clear(options *out);

/* Reads text (any, of what stands alone) into the option's field. False if it is not what the option takes. out keeps
 * the text of KIND_TEXT and KIND_SKY. Of two options for one field the later in the table is to be set last. */
bool option_set(const option *o, const char *text, options *out);

/* "--size: '5' is not what it takes (WxH, 1 to 8192)" */
void option_fault(const option *o, const char *text, char *message, size_t message_size);

#endif
