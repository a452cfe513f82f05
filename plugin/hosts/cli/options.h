/* SPDX-License-Identifier: MIT
 * What may stand on the command line? One table of flags, from which parsing and --help are made.
 */
#ifndef HEMIBAKE_CLI_OPTIONS_H
#define HEMIBAKE_CLI_OPTIONS_H

#include <hemibake/hemibake.h>

/* Exit statuses, a contract with build systems. */
enum {
    EXIT_DONE = 0,
    EXIT_BAD_INPUT = 1,
    EXIT_USAGE = 2,
    EXIT_OUTPUT = 3,
    EXIT_NOT_CONVERGED = 4,
    EXIT_INTERRUPTED = 130,
    EXIT_TERMINATED = 143
};

typedef enum command { COMMAND_BAKE = 1, COMMAND_COMPARE = 2, COMMAND_RENDER = 4, COMMAND_FACTORS = 8 } command;

typedef enum progress_style { PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_JSON } progress_style;

enum { OPTION_COUNT_MAX = 128 };

typedef struct options {
    command command;
    const char *inputs[2];
    int input_count;
    const char *output, *report, *preview, *reference, *camera, *depfile;
    int method, quality, progress, subdivision; /* subdivision: a hemi_subdivision */
    double tolerance, error, time, element_size, patch_size, unshot, light_tolerance, refine_error, merge_error,
        stand_in, cluster_angle;
    long hemicube, hemicube_light, threads, seed, memory_mib, max_elements, refine_levels, subdivide;
    bool scene_linear, no_draco, keep_pbr, keep_instances, quiet, flat, json, subdivide_adaptive, uniform;
    bool exposure_auto;
    double exposure_ev;
    const char *ocio, *display, *view, *look, *input_space, *working_space;
    const char *environment; /* R,G,B or a file */
    bool has_sun;
    double sun[4]; /* azimuth, elevation, angular diameter in degrees at [0], [1], [3]; lux at [2] */
    long draco_level;
    int draco_bits[4]; /* position, normal, color, texcoord */
    long width, height;
    const char
        *given[OPTION_COUNT_MAX]; /* by the table's order: the value on the line, "" of a flag, NULL: not given */
} options;

/* "hybrid", "analytic", "pr" or "fm". */
const char *options_method(const options *o);

/* EXIT_DONE: go on; -1: help or the version was asked for and printed; else an exit status, its line printed. */
int options_parse(int argc, char **argv, options *out);

/* The options on the line that what a bake writes depends on, one after the other: name without dashes, value ("" of a
 * flag). False when index is past the last. */
bool options_recorded(const options *o, int index, const char **name, const char **value);

#endif
