/* SPDX-License-Identifier: MIT
 * See options.h.
 */
#include "options.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum kind {
    KIND_FLAG,
    KIND_TEXT,
    KIND_NUMBER,
    KIND_COUNT,
    KIND_CHOICE,
    KIND_EXPOSURE,
    KIND_BITS,
    KIND_SUN,
    KIND_SIZE
} kind;

typedef struct flag {
    const char *name, *argument; /* argument: as shown in help; of a choice the words, in order, between bars */
    kind kind;
    size_t offset; /* of the field of options */
    double low, high;
    int commands;
    const char *help;
} flag;

#define AT(field) offsetof(options, field)
#define BAKE      COMMAND_BAKE
#define RENDER    COMMAND_RENDER
#define COMPARE   COMMAND_COMPARE
#define FACTORS   COMMAND_FACTORS

static const flag FLAGS[] = {
    { "-o", "OUT", KIND_TEXT, AT(output), 0, 0, BAKE | RENDER | FACTORS,
      "where the result goes: .glb or .gltf (bake), .png (render), .csv (factors; default stdout)" },
    { "--tolerance", "T", KIND_NUMBER, AT(tolerance), 1e-12, 1, FACTORS,
      "absolute error that a form factor may have (default 1e-5)" },
    { "--quality", "draft|medium|high|reference", KIND_CHOICE, AT(quality), 0, 0, BAKE,
      "preset of sizes and targets below (default medium; with --error: the first that meets it)" },
    { "--method", "hybrid|analytic|pr|fm", KIND_CHOICE, AT(method), 0, 0, BAKE,
      "how radiosity is solved (default hybrid); the others are the paper's, to compare with" },
    { "--error", "E", KIND_NUMBER, AT(error), 1e-6, 1, BAKE,
      "stop when the estimated relative error is below E (e.g. 0.01)" },
    { "--time", "T", KIND_NUMBER, AT(time), 1e-3, 1e9, BAKE,
      "stop after T seconds with the best answer so far (exit status 4); where neither quality nor sizes are given, "
      "elements are as small as T allows" },
    { "--unshot", "U", KIND_NUMBER, AT(unshot), 1e-9, 0.999, BAKE,
      "stop when this fraction of the emitted power is unshot" },
    { "--element-size", "M", KIND_NUMBER, AT(element_size), 1e-9, 1e9, BAKE,
      "target edge of an element, metres (default: from quality and scene)" },
    { "--patch-size", "M", KIND_NUMBER, AT(patch_size), 1e-9, 1e9, BAKE, "target edge of a patch, metres" },
    { "--max-elements", "N", KIND_COUNT, AT(max_elements), 1, 4e9, BAKE,
      "refine to no more elements than this, and refuse to start with more (default 4000000)" },
    { "--refine-levels", "N", KIND_COUNT, AT(refine_levels), 1, 8, BAKE,
      "quarter elements up to N times where light is not linear (default: by quality; never with --element-size)" },
    { "--refine-error", "E", KIND_NUMBER, AT(refine_error), 1e-6, 1, BAKE,
      "refine until the size of elements costs less than this relative error (default: by quality)" },
    { "--uniform", NULL, KIND_FLAG, AT(uniform), 0, 0, BAKE, "elements of one size: do not refine" },
    { "--merge-error", "E", KIND_NUMBER, AT(merge_error), 0, 1, BAKE,
      "merge triangles where that changes no colour by more than this share of it (default: by quality; 0, or with "
      "--flat or kept instances: never)" },
    { "--stand-in", "D", KIND_NUMBER, AT(stand_in), 0, 1, BAKE,
      "a mesh that is too dense is solved on a simpler one, off by so many elements at most (default 0.1; 0: never)" },
    { "--cluster-angle", "DEG", KIND_NUMBER, AT(cluster_angle), 0, 60, BAKE,
      "small patches shoot as one with those beside them whose normals differ by less (default 20; 0: never)" },
    { "--hemicube", "N", KIND_COUNT, AT(hemicube), 16, 4096, BAKE, "hemi-cube resolution, pixels across" },
    { "--hemicube-light", "N", KIND_COUNT, AT(hemicube_light), 16, 4096, BAKE, "the same on emitters" },
    { "--light-tolerance", "F", KIND_NUMBER, AT(light_tolerance), 1e-9, 1, BAKE,
      "share of an emitter's power in penumbra that quarters it further (default 0.005)" },
    { "--subdivide", "LEVEL", KIND_COUNT, AT(subdivide), 0, 8, BAKE,
      "take every mesh as the cage of a subdivision surface, refined LEVEL times, unless its extras say how; 0: none" },
    { "--subdivide-scheme", "catmull-clark|loop|bilinear", KIND_CHOICE, AT(subdivision), 0, 0, BAKE,
      "which surface (default catmull-clark)" },
    { "--subdivide-adaptive", NULL, KIND_FLAG, AT(subdivide_adaptive), 0, 0, BAKE,
      "refine where the surface curves, at most LEVEL times" },
    { "--threads", "N", KIND_COUNT, AT(threads), 1, 256, BAKE | FACTORS,
      "worker threads (default: all cores); the result is the same for any number" },
    { "--seed", "N", KIND_COUNT, AT(seed), 0, 9e15, BAKE, "turns the hemi-cubes differently" },
    { "--memory", "MIB", KIND_COUNT, AT(memory_mib), 1, 1e9, BAKE,
      "for kept form factors (default 4096); past it they are computed again, fm is refused" },
    { "--sun", "AZIMUTH,ELEVATION,LUX[,ANGLE]", KIND_SUN, 0, 0, 0, BAKE,
      "a sun, in degrees: azimuth from north (-z) by east (+x), angular diameter 0.533 by default" },
    { "--environment", "R,G,B|FILE.hdr", KIND_TEXT, AT(environment), 0, 0, BAKE,
      "radiance of the sky all around: one colour, or a panorama (default: 1 if nothing else gives light)" },
    { "--scene-linear", NULL, KIND_FLAG, AT(scene_linear), 0, 0, BAKE,
      "no view transform: linear Rec.709 radiance as float in _RADIOSITY, clamped in COLOR_0" },
    { "--exposure", "EV|auto", KIND_EXPOSURE, AT(exposure_ev), -64, 64, BAKE,
      "stops to brighten by before the view transform (default auto: lit surfaces average to middle grey)" },
    { "--ocio", "CONFIG", KIND_TEXT, AT(ocio), 0, 0, BAKE,
      "OpenColorIO configuration (default: $OCIO, else one of our own)" },
    { "--input-space", "S|file-rules", KIND_TEXT, AT(input_space), 0, 0, BAKE,
      "space of the configuration that colour factors are in (default: linear Rec.709, as glTF says)" },
    { "--working-space", "S", KIND_TEXT, AT(working_space), 0, 0, BAKE,
      "linear space whose primaries light is added up in (default: the role scene_linear)" },
    { "--display", "D", KIND_TEXT, AT(display), 0, 0, BAKE, "display of the configuration" },
    { "--view", "V", KIND_TEXT, AT(view), 0, 0, BAKE, "view of the display" },
    { "--look", "L", KIND_TEXT, AT(look), 0, 0, BAKE, "look to apply" },
    { "--no-draco", NULL, KIND_FLAG, AT(no_draco), 0, 0, BAKE,
      "write plain accessors instead of KHR_draco_mesh_compression" },
    { "--keep-pbr", NULL, KIND_FLAG, AT(keep_pbr), 0, 0, BAKE,
      "leave materials and normals alone: light goes into the float attribute _RADIOSITY only" },
    { "--keep-instances", NULL, KIND_FLAG, AT(keep_instances), 0, 0, BAKE,
      "what shares a mesh goes on sharing it, lit by the mean of all (default: a lit copy each)" },
    { "--draco-level", "0..10", KIND_COUNT, AT(draco_level), 0, 10, BAKE, "0 fast, 10 small (default 7)" },
    { "--draco-bits", "K=N,...", KIND_BITS, AT(draco_bits), 1, 30, BAKE,
      "quantisation bits (default position=14,normal=10,color=12,texcoord=12)" },
    { "--report", "FILE.json", KIND_TEXT, AT(report), 0, 0, BAKE,
      "what was done, how long it took, how far off it is" },
    { "--preview", "FILE.png", KIND_TEXT, AT(preview), 0, 0, BAKE, "a picture of the result" },
    { "--depfile", "FILE.d", KIND_TEXT, AT(depfile), 0, 0, BAKE,
      "which files the result depends on, for Make, Ninja and CMake" },
    { "--reference", "PROBES.hprb", KIND_TEXT, AT(reference), 0, 0, BAKE,
      "path-traced probes to measure the error against" },
    { "--camera", "NAME|N", KIND_TEXT, AT(camera), 0, 0, BAKE | RENDER,
      "camera of the picture (default: the first; without one, from outside)" },
    { "--size", "WxH", KIND_SIZE, AT(width), 1, 8192, BAKE | RENDER, "size of the picture (default 960x720)" },
    { "--flat", NULL, KIND_FLAG, AT(flat), 0, 0, BAKE | RENDER,
      "one colour a triangle, in the picture and in what is written" },
    { "--json", NULL, KIND_FLAG, AT(json), 0, 0, COMPARE, "print the comparison as JSON" },
    { "--quiet", NULL, KIND_FLAG, AT(quiet), 0, 0, BAKE | RENDER | FACTORS, "print nothing but errors" },
    { "--progress", "auto|plain|json", KIND_CHOICE, AT(progress), 0, 0, BAKE,
      "how progress is shown on stderr (auto: on a terminal only)" },
};
enum { FLAG_COUNT = sizeof FLAGS / sizeof *FLAGS };
_Static_assert((int)FLAG_COUNT <= (int)OPTION_COUNT_MAX, "options.given is too short");

typedef struct command_text {
    const char *name;
    command command;
    int inputs;
    const char *synopsis, *help, *example;
} command_text;

static const command_text COMMANDS[] = {
    { "bake", COMMAND_BAKE, 1, "hemibake bake IN -o OUT [options]",
      "bake the light of a glTF asset into its vertex colours",
      "hemibake bake samples/pillar-room.glb -o pillar-room.baked.glb --report pillar-room.json" },
    { "compare", COMMAND_COMPARE, 2, "hemibake compare BAKED REFERENCE.hprb [--json]",
      "relative error of a bake made with --scene-linear against path-traced probes",
      "hemibake compare pillar-room.baked.glb pillar-room.hprb" },
    { "render", COMMAND_RENDER, 1, "hemibake render BAKED -o PNG [options]",
      "draw a baked asset as an unlit viewer shows it",
      "hemibake render pillar-room.baked.glb -o pillar-room.png --size 1280x960" },
    { "factors", COMMAND_FACTORS, 1, "hemibake factors IN [--tolerance T] [-o CSV]",
      "form-factor matrix of the input polygons (.glb, .gltf, .vs3) with error estimates",
      "hemibake factors samples/l-room.vs3 --tolerance 1e-5" },
};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof *COMMANDS };

/* ---- help ----------------------------------------------------------------------------------------------------------
 */

static void print_overview(FILE *to) {
    fprintf(to, "hemibake %s: bakes diffuse global illumination into glTF vertex colours\n\n", hemi_version());
    for (int i = 0; i < COMMAND_COUNT; i++) fprintf(to, "  %-52s %s\n", COMMANDS[i].synopsis, COMMANDS[i].help);
    fprintf(to,
            "\n'hemibake COMMAND --help' lists its options; 'hemibake --version' prints the version.\n"
            "Exit status: 0 done, 1 bad input, 2 wrong usage, 3 an output could not be written, 4 stopped before it\n"
            "converged (the output is written), 130 interrupted, 143 terminated (nothing is written).\n");
}

static void print_help(const command_text *c) {
    printf("%s\n  %s\n\n", c->synopsis, c->help);
    for (int i = 0; i < FLAG_COUNT; i++) {
        char left[64];
        if (!(FLAGS[i].commands & (int)c->command)) continue;
        snprintf(left, sizeof left, "%s %s", FLAGS[i].name, FLAGS[i].argument ? FLAGS[i].argument : "");
        printf("  %-42s %s\n", left, FLAGS[i].help);
    }
    printf("\nExample:\n  %s\n", c->example);
}

/* The same table for other programs: 'hemibake help --json'. plugin/hosts/options_table.py makes documents of it. */
static void print_json(void) {
    static const char *const kinds[] = {
        [KIND_FLAG] = "flag",   [KIND_TEXT] = "text",     [KIND_NUMBER] = "number",
        [KIND_COUNT] = "count", [KIND_CHOICE] = "choice", [KIND_EXPOSURE] = "exposure",
        [KIND_BITS] = "bits",   [KIND_SUN] = "sun",       [KIND_SIZE] = "size",
    };
    cJSON *root = cJSON_CreateObject(), *commands = cJSON_AddObjectToObject(root, "commands");
    cJSON_AddStringToObject(root, "version", hemi_version());
    for (int c = 0; c < COMMAND_COUNT; c++) {
        cJSON *entry = cJSON_AddObjectToObject(commands, COMMANDS[c].name);
        cJSON_AddStringToObject(entry, "synopsis", COMMANDS[c].synopsis);
        cJSON_AddStringToObject(entry, "help", COMMANDS[c].help);
        cJSON *list = cJSON_AddArrayToObject(entry, "options");
        for (int i = 0; i < FLAG_COUNT; i++) {
            if (!(FLAGS[i].commands & (int)COMMANDS[c].command)) continue;
            cJSON *option = cJSON_CreateObject();
            cJSON_AddItemToArray(list, option);
            cJSON_AddStringToObject(option, "name", FLAGS[i].name);
            cJSON_AddStringToObject(option, "kind", kinds[FLAGS[i].kind]);
            if (FLAGS[i].argument) cJSON_AddStringToObject(option, "argument", FLAGS[i].argument);
            if (FLAGS[i].high > FLAGS[i].low) cJSON_AddNumberToObject(option, "low", FLAGS[i].low);
            if (FLAGS[i].high > FLAGS[i].low) cJSON_AddNumberToObject(option, "high", FLAGS[i].high);
            cJSON_AddStringToObject(option, "help", FLAGS[i].help);
        }
    }
    char *text = cJSON_Print(root);
    if (text) puts(text);
    free(text);
    cJSON_Delete(root);
}

/* ---- values --------------------------------------------------------------------------------------------------------
 */

static int usage(const char *format, const char *a, const char *b) {
    fprintf(stderr, "hemibake: ");
    fprintf(stderr, format, a, b);
    fprintf(stderr, "; see 'hemibake --help'\n");
    return EXIT_USAGE;
}

static bool parse_number(const char *text, double low, double high, double *out) {
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end || errno || !(value >= low && value <= high)) return false;
    *out = value;
    return true;
}

static bool parse_count(const char *text, double low, double high, long *out) {
    double value;
    if (!parse_number(text, low, high, &value) || value != floor(value)) return false;
    *out = (long)value;
    return true;
}

/* The position of a word in "one|two|three", counted from 1. */
static bool parse_choice(const char *text, const char *words, int *out) {
    int position = 1;
    for (const char *word = words; word; position++) {
        const char *bar = strchr(word, '|');
        size_t length = bar ? (size_t)(bar - word) : strlen(word);
        if (strlen(text) == length && strncmp(text, word, length) == 0) {
            *out = position;
            return true;
        }
        word = bar ? bar + 1 : NULL;
    }
    return false;
}

/* "position=14,color=12" */
static bool parse_bits(const char *text, double low, double high, int bits[4]) {
    static const char *const keys[] = { "position", "normal", "color", "texcoord" };
    char copy[128];
    if (strlen(text) >= sizeof copy) return false;
    strcpy(copy, text);
    for (char *at = copy; at;) {
        char *comma = strchr(at, ','), *equals = strchr(at, '=');
        long value;
        int key = 0;
        if (comma) *comma = 0;
        if (!equals || (comma && equals > comma)) return false;
        *equals = 0;
        while (key < 4 && strcmp(at, keys[key]) != 0) key++;
        if (key == 4 || !parse_count(equals + 1, low, high, &value)) return false;
        bits[key] = (int)value;
        at = comma ? comma + 1 : NULL;
    }
    return true;
}

static bool parse_size(const char *text, double low, double high, long size[2]) {
    char copy[32], *cross;
    if (strlen(text) >= sizeof copy) return false;
    strcpy(copy, text);
    cross = strchr(copy, 'x');
    if (!cross) return false;
    *cross = 0;
    return parse_count(copy, low, high, &size[0]) && parse_count(cross + 1, low, high, &size[1]);
}

static bool parse_exposure(const char *text, double low, double high, options *o) {
    o->exposure_auto = strcmp(text, "auto") == 0;
    return o->exposure_auto || parse_number(text, low, high, &o->exposure_ev);
}

static bool parse_sun(const char *text, options *o) {
    double sun[4] = { 0, 0, 0, 0.533 };
    int count = 0;
    for (char *end; count < 4; text = end + 1) {
        sun[count] = strtod(text, &end);
        if (end == text || !isfinite(sun[count++])) return false;
        if (!*end) break;
        if (*end != ',' || count == 4) return false;
    }
    if (count < 3 || fabs(sun[1]) > 90.0 || sun[2] < 0.0 || sun[2] > 1e30 || sun[3] < 0.0 || sun[3] > 45.0)
        return false;
    memcpy(o->sun, sun, sizeof sun);
    o->has_sun = true;
    return true;
}

static bool set_value(const flag *f, const char *text, options *o) {
    char *field = (char *)o + f->offset;
    switch (f->kind) {
    case KIND_FLAG:
        *(bool *)field = true;
        return true;
    case KIND_TEXT:
        *(const char **)field = text;
        return *text != 0;
    case KIND_NUMBER:
        return parse_number(text, f->low, f->high, (double *)field);
    case KIND_COUNT:
        return parse_count(text, f->low, f->high, (long *)field);
    case KIND_CHOICE:
        return parse_choice(text, f->argument, (int *)field);
    case KIND_EXPOSURE:
        return parse_exposure(text, f->low, f->high, o);
    case KIND_BITS:
        return parse_bits(text, f->low, f->high, (int *)field);
    case KIND_SUN:
        return parse_sun(text, o);
    case KIND_SIZE:
        return parse_size(text, f->low, f->high, (long *)field);
    }
    return false;
}

/* ---- the line ------------------------------------------------------------------------------------------------------
 */

static const command_text *find_command(const char *name) {
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(COMMANDS[i].name, name) == 0) return &COMMANDS[i];
    return NULL;
}

const char *options_method(const options *o) {
    static const char *const names[] = { "hybrid", "hybrid", "analytic", "pr", "fm" };
    return names[o->method];
}

static const flag *find_flag(const char *text, const command_text *c, size_t *length) {
    *length = strcspn(text, "=");
    for (int i = 0; i < FLAG_COUNT; i++)
        if (strlen(FLAGS[i].name) == *length && strncmp(FLAGS[i].name, text, *length) == 0 &&
            (FLAGS[i].commands & (int)c->command))
            return &FLAGS[i];
    return NULL;
}

/* Takes one flag and its value from the line; *i moves past them. */
static int take_flag(int argc, char **argv, int *i, const command_text *c, options *out) {
    size_t length;
    const char *text = argv[*i];
    const flag *f = find_flag(text, c, &length);
    if (!f) return usage("'%s' is not an option of '%s'", text, c->name);
    const char *value = text[length] == '=' ? text + length + 1 : NULL;
    if (f->kind == KIND_FLAG && value) return usage("'%s' takes no value%s", f->name, "");
    if (f->kind != KIND_FLAG && !value) {
        if (*i + 1 >= argc) return usage("'%s' needs a value: %s", f->name, f->argument);
        value = argv[++*i];
    }
    out->given[f - FLAGS] = value ? value : "";
    if (!set_value(f, value ? value : "", out)) {
        fprintf(stderr, "hemibake: %s: '%s' is not what it takes (%s", f->name, value, f->argument);
        if (f->high > f->low) fprintf(stderr, ", %g to %g", f->low, f->high);
        fprintf(stderr, "); see 'hemibake %s --help'\n", c->name);
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

static int check(const command_text *c, const options *o) {
    if (o->input_count < c->inputs)
        return usage("'%s' needs %s", c->name, c->inputs == 2 ? "BAKED and REFERENCE" : "an input file");
    if ((c->command & (BAKE | RENDER)) && !o->output) return usage("'%s' needs -o OUT%s", c->name, "");
    return EXIT_DONE;
}

int options_parse(int argc, char **argv, options *out) {
    *out = (options){ .exposure_auto = true,
                      .draco_level = 7,
                      .draco_bits = { 14, 10, 12, 12 },
                      .width = 960,
                      .height = 720,
                      .subdivide = -1,
                      .merge_error = -1.0, /* by quality */
                      .stand_in = 0.1,
                      .cluster_angle = 20,
                      .subdivision = HEMI_SUBDIVISION_CATMULL_CLARK };
    if (argc == 3 && strcmp(argv[1], "help") == 0 && strcmp(argv[2], "--json") == 0) {
        print_json();
        return -1;
    }
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_overview(argc < 2 ? stderr : stdout);
        return argc < 2 ? EXIT_USAGE : -1;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("hemibake %s\n", hemi_version());
        return -1;
    }
    const command_text *c = find_command(argv[1]);
    if (!c) return usage("'%s' is not a command%s", argv[1], "");
    out->command = c->command;
    for (int i = 2; i < argc; i++) {
        int status = EXIT_DONE;
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            print_help(c);
            return -1;
        }
        if (argv[i][0] == '-' && argv[i][1]) {
            status = take_flag(argc, argv, &i, c, out);
        } else if (out->input_count == c->inputs) {
            status = usage("'%s' is one input too many for '%s'", argv[i], c->name);
        } else {
            out->inputs[out->input_count++] = argv[i];
        }
        if (status != EXIT_DONE) return status;
    }
    return check(c, out);
}

/* Where results go, and what changes neither them nor their error; a limit that was reached shows in the digest. */
static bool is_recorded(const flag *f) {
    static const char *const others[] = { "-o",       "--threads", "--memory", "--report", "--preview",  "--reference",
                                          "--camera", "--size",    "--time",   "--quiet",  "--progress", "--ocio" };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(f->name, others[i]) == 0) return false;
    return true;
}

bool options_recorded(const options *o, int index, const char **name, const char **value) {
    for (int i = 0; i < FLAG_COUNT; i++) {
        if (!o->given[i] || !is_recorded(&FLAGS[i]) || index-- > 0) continue;
        *name = FLAGS[i].name + 2;
        *value = o->given[i];
        return true;
    }
    return false;
}
