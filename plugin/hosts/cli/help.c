/* SPDX-License-Identifier: MIT */
#include "help.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

static const command_text COMMANDS[] = {
    { "bake", COMMAND_BAKE, 1, true, "hemibake bake IN... -o OUT [options]",
      "bake the light of glTF assets into their vertex colours; several go into the folder OUT, unless unchanged",
      "hemibake bake samples/pillar-room.glb -o pillar-room.baked.glb --report pillar-room.json" },
    { "inspect", COMMAND_INSPECT, 1, false, "hemibake inspect IN [--strict] [--json] [options]",
      "what would be baked, what gives light, what will not be as it looks elsewhere, and what a bake would cost",
      "hemibake inspect samples/pillar-room.glb" },
    { "compare", COMMAND_COMPARE, 2, false, "hemibake compare BAKED REFERENCE.hprb|OTHER.glb [options]",
      "relative error of a bake made with --scene-linear against path-traced probes or another bake, and where it sits",
      "hemibake compare pillar-room.baked.glb pillar-room.hprb" },
    { "render", COMMAND_RENDER, 1, false, "hemibake render BAKED -o PNG [options]",
      "draw a baked asset as an unlit viewer shows it",
      "hemibake render pillar-room.baked.glb -o pillar-room.png --size 1280x960" },
    { "view", COMMAND_VIEW, 1, false, "hemibake view OUT [--before IN] [options]",
      "a page on 127.0.0.1 that shows a bake: original, baked, wireframe, and where it is off",
      "hemibake view pillar-room.baked.glb --before samples/pillar-room.glb" },
    { "factors", COMMAND_FACTORS, 1, false, "hemibake factors IN [--tolerance T] [-o CSV]",
      "form-factor matrix of the input polygons (.glb, .gltf, .vs3) with error estimates",
      "hemibake factors samples/l-room.vs3 --tolerance 1e-5" },
    { .name = NULL },
};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof *COMMANDS - 1 };

const command_text *first_command(void) {
    return COMMANDS;
}

const command_text *find_command(const char *name) {
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(COMMANDS[i].name, name) == 0) return &COMMANDS[i];
    return NULL;
}

void print_overview(FILE *to) {
    fprintf(to, "hemibake %s: bakes diffuse global illumination into glTF vertex colours\n\n", hemi_version());
    for (int i = 0; i < COMMAND_COUNT; i++) fprintf(to, "  %-52s %s\n", COMMANDS[i].synopsis, COMMANDS[i].help);
    fprintf(
        to,
        "\n'hemibake help COMMAND' lists its options, 'hemibake help OPTION' tells one; 'hemibake --version' prints\n"
        "the version.\n"
        "Exit status: 0 done, 1 bad input, 2 wrong usage, 3 an output could not be written, 4 stopped before it\n"
        "converged (the output is written), 130 interrupted (the output is written if its error is below 25 %%);\n"
        "129, 131, 143, 152 stopped by SIGHUP, SIGQUIT, SIGTERM, SIGXCPU (nothing is written).\n");
}

void print_help(const command_text *c) {
    printf("%s\n  %s\n\n", c->synopsis, c->help);
    for (int i = 0; i < OPTION_COUNT; i++) {
        char left[64];
        if (!(OPTIONS[i].commands & (int)c->command)) continue;
        snprintf(left, sizeof left, "%s %s", OPTIONS[i].name, OPTIONS[i].argument ? OPTIONS[i].argument : "");
        printf("  %-42s %s\n", left, OPTIONS[i].help);
    }
    printf("\nExample:\n  %s\n", c->example);
}

typedef struct quality_figures {
    const char *scene, *quality;
    int surfaces, elements;
    double error, seconds, mib, kb; /* %, processor seconds, peak memory, output */
} quality_figures;

static const quality_figures QUALITIES[] = {
#define QUALITY_FIGURES(...) { __VA_ARGS__ },
#include "quality_figures.h"
#undef QUALITY_FIGURES
};

static void print_qualities(void) {
    printf("\n  draft shows whether all is right, medium is for nearly everything, high for sharp shadows and pictures that stay;\n"
           "  reference is for comparisons, with about four times the elements of high. Measured on three scenes, time summed up\n"
           "  over threads, output by Draco:\n\n"
           "    %-12s %-8s %9s %9s %9s %8s %7s\n",
           "scene", "quality", "elements", "error", "seconds", "memory", "output");
    for (size_t i = 0; i < sizeof QUALITIES / sizeof *QUALITIES; i++) {
        const quality_figures *q = &QUALITIES[i];
        printf("    %-12s %-8s %9d %7.2f %% %9.1f %4.0f MiB %4.0f kB\n", q->scene, q->quality, q->elements, q->error, q->seconds, q->mib, q->kb);
    }
}

void print_option(const option *o) {
    printf("%s%s%s\n  %s\n ", o->name, o->argument ? " " : "", o->argument ? o->argument : "", o->help);
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (o->commands & (int)COMMANDS[i].command) printf(" hemibake %s;", COMMANDS[i].name);
    if (o->high > o->low) printf(" %g to %g;", o->low, o->high);
    printf(" 'hemibake help COMMAND' lists all\n");
    if (strcmp(o->name, "--quality") == 0) print_qualities();
}

static cJSON *json_of(const option *o) {
    static const struct {
        const char *name;
        int mark;
    } marks[] = { { "files", MARK_FILES }, { "scenes", MARK_SCENES }, { "documents", MARK_DOCUMENTS } };
    cJSON *out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "name", o->name);
    cJSON_AddStringToObject(out, "kind", option_kind_name(o->kind));
    if (o->argument) cJSON_AddStringToObject(out, "argument", o->argument);
    if (o->high > o->low) cJSON_AddNumberToObject(out, "low", o->low);
    if (o->high > o->low) cJSON_AddNumberToObject(out, "high", o->high);
    cJSON_AddStringToObject(out, "help", o->help);
    cJSON *hosts = cJSON_AddArrayToObject(out, "hosts");
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
        if (o->marks & marks[i].mark) cJSON_AddItemToArray(hosts, cJSON_CreateString(marks[i].name));
    return out;
}

void print_json(void) {
    cJSON *root = cJSON_CreateObject(), *commands = cJSON_AddObjectToObject(root, "commands");
    cJSON_AddStringToObject(root, "version", hemi_version());
    for (int c = 0; c < COMMAND_COUNT; c++) {
        cJSON *entry = cJSON_AddObjectToObject(commands, COMMANDS[c].name);
        cJSON_AddStringToObject(entry, "synopsis", COMMANDS[c].synopsis);
        cJSON_AddStringToObject(entry, "help", COMMANDS[c].help);
        cJSON *list = cJSON_AddArrayToObject(entry, "options");
        for (int i = 0; i < OPTION_COUNT; i++)
            if (OPTIONS[i].commands & (int)COMMANDS[c].command) cJSON_AddItemToArray(list, json_of(&OPTIONS[i]));
    }
    char *text = cJSON_Print(root);
    if (text) puts(text);
    free(text);
    cJSON_Delete(root);
}
