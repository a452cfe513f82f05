/* SPDX-License-Identifier: MIT */
#include "help.h"
#include "output_folder.h"
#include "printable.h"
#include "processes.h"
#include "suggestion.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static int usage(const char *format, const char *a, const char *b) {
    char text[1024];
    snprintf(text, sizeof text, format, a, b);
    fputs("hemibake: ", stderr);
    print_printable(stderr, text);
    fputs("; see 'hemibake --help'\n", stderr);
    return EXIT_USAGE;
}

const char *options_method(hemi_method method) {
    static const char *const names[] = { "hybrid", "hybrid", "analytic", "pr", "fm", "rows", "auto" };
    return names[method];
}

/* What else an option is called, as elsewhere. */
static const char *common_name(const char *name) {
    if (strcmp(name, "-q") == 0) return "--quiet";
    return strcmp(name, "--output") == 0 ? "-o" : name;
}

static const option *find_option(const char *text, const command_text *c, size_t *length) {
    char name[64];
    *length = strcspn(text, "=");
    snprintf(name, sizeof name, "%.*s", (int)(*length < sizeof name ? *length : 0), text);
    for (int i = 0; i < OPTION_COUNT; i++)
        if (strcmp(OPTIONS[i].name, common_name(name)) == 0 && (OPTIONS[i].commands & (int)c->command))
            return &OPTIONS[i];
    return NULL;
}

static int unknown_option(const char *text, const command_text *c) {
    char name[64], line[160];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    suggestion near = { .word = name };
    for (int i = 0; i < OPTION_COUNT; i++)
        if (OPTIONS[i].commands & (int)c->command) suggestion_consider(&near, OPTIONS[i].name);
    snprintf(line, sizeof line, "'%%s' is not an option of '%%s'%s%s%s", near.found ? " (did you mean '" : "",
             near.found ? near.found : "", near.found ? "'?)" : "");
    return usage(line, text, c->name);
}

/* What is taken in the place of a command. */
static const char *const NO_COMMANDS[] = { "help", "--help", "--version" };

static int unknown_command(const char *text) {
    suggestion near = { .word = text };
    for (const command_text *c = first_command(); c->name; c++) suggestion_consider(&near, c->name);
    for (size_t i = 0; i < sizeof NO_COMMANDS / sizeof *NO_COMMANDS; i++) suggestion_consider(&near, NO_COMMANDS[i]);
    if (near.found) return usage("'%s' is not a command (did you mean '%s'?)", text, near.found);
    struct stat status;
    if (stat(text, &status) == 0)
        return usage("'%s' is not a command; 'hemibake bake %s -o OUT' bakes a file", text, text);
    return usage("'%s' is not a command%s", text, "");
}

/* Takes one option and its value from the line; *i moves past them. */
static int take_option(int argc, char **argv, int *i, const command_text *c, options *out) {
    size_t length;
    const char *text = argv[*i];
    const option *o = find_option(text, c, &length);
    if (!o) return unknown_option(text, c);
    const char *value = text[length] == '=' ? text + length + 1 : NULL;
    if (option_stands_alone(o) && value) return usage("'%s' takes no value%s", o->name, "");
    if (!option_stands_alone(o) && !value) {
        if (*i + 1 >= argc) return usage("'%s' needs a value: %s", o->name, o->argument);
        value = argv[++*i];
    }
    out->given[o - OPTIONS] = value ? value : "";
    if (!option_set(o, value ? value : "", out)) {
        char message[512];
        option_fault(o, value, message, sizeof message);
        fprintf(stderr, "hemibake: %s; see 'hemibake %s --help'\n", printable(message), c->name);
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

static int check(const command_text *c, const options *o) {
    if (o->input_count < c->inputs)
        return usage("'%s' needs %s", c->name, c->inputs == 2 ? "BAKED and REFERENCE" : "an input file");
    if ((c->command & (COMMAND_BAKE | COMMAND_RENDER)) && !o->output && !o->layer)
        return usage("'%s' needs -o OUT%s", c->name, "");
    bool many = output_folder_is_asked(o) || (o->scene && strcmp(o->scene, "all") == 0);
    if ((o->checkpoint || o->resume) && many)
        return usage("a checkpoint is of one bake; bake '%s' alone%s", o->inputs[0], "");
    if ((o->checkpoint || o->resume) && o->bake.time_limit_s > 0.0)
        return usage(
            "what --time decides by the clock cannot be gone on with to the same bytes; leave out '--time' or '%s'%s",
            o->resume ? "--resume" : "--checkpoint", "");
    if (processes_ranks() && (many || o->checkpoint || o->resume || o->bake.time_limit_s > 0.0))
        return usage("processes that share a bake do one, '%s', without '--time', '--checkpoint' and '--resume'%s",
                     o->inputs[0], "");
    const char *view = o->turntable            ? "--turntable"
                       : o->camera             ? "--camera"
                       : o->look_from.is_given ? "--look-from"
                                               : NULL;
    if (o->all_cameras && view)
        return usage("'--all-cameras' looks from those of the asset; leave it out, or '%s'%s", view, "");
    if (o->command == COMMAND_BAKE && o->output && !o->force && output_folder_is_same_file(o->inputs[0], o->output))
        return usage("'%s' is the input itself, which would be lost; give it another name, or say --force%s", o->output,
                     "");
    return EXIT_DONE;
}

/* 'help WORD': of a command, or of an option, with or without its dashes. */
static int answer_about(const char *word) {
    const command_text *c = find_command(word);
    suggestion near = { .word = word };
    if (c) {
        print_help(c);
        return -1;
    }
    for (int i = 0; i < OPTION_COUNT; i++) {
        const char *name = OPTIONS[i].name + strspn(OPTIONS[i].name, "-");
        if (strcmp(OPTIONS[i].name, word) == 0 || strcmp(name, word) == 0) {
            print_option(&OPTIONS[i]);
            return -1;
        }
        suggestion_consider(&near, name);
    }
    for (c = first_command(); c->name; c++) suggestion_consider(&near, c->name);
    if (near.found) return usage("there is no help about '%s' (did you mean '%s'?)", word, near.found);
    return usage("there is no help about '%s'%s", word, "");
}

/* What asks for no command; -1, or the exit status when it is over, else EXIT_DONE. */
static int answer(int argc, char **argv) {
    if (argc == 3 && strcmp(argv[1], "help") == 0 && strcmp(argv[2], "--json") == 0) {
        print_json();
        return -1;
    }
    if (argc == 3 && strcmp(argv[1], "help") == 0) return answer_about(argv[2]);
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_overview(argc < 2 ? stderr : stdout);
        return argc < 2 ? EXIT_USAGE : -1;
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("hemibake %s\n", hemi_version());
        return -1;
    }
    return EXIT_DONE;
}

/* All are in order: what the line says last of each is set again, so that --uniform wins wherever it stands. */
static void set_in_order(options *out) {
    for (int i = 0; i < OPTION_COUNT; i++)
        if (out->given[i]) option_set(&OPTIONS[i], out->given[i], out);
}

int options_parse(int argc, char **argv, options *out) {
    int status = answer(argc, argv);
    options_clear(out);
    if (status != EXIT_DONE) return status;
    const command_text *c = find_command(argv[1]);
    if (!c) return unknown_command(argv[1]);
    out->command = c->command;
    out->inputs = (const char *const *)argv + 2;
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            print_help(c);
            return -1;
        }
        if (argv[i][0] == '-' && argv[i][1]) {
            status = take_option(argc, argv, &i, c, out);
        } else if (out->input_count == c->inputs && !c->takes_many) {
            status = usage("'%s' is one input too many for '%s'", argv[i], c->name);
        } else {
            argv[2 + out->input_count++] = argv[i]; /* a place whose word is read already */
        }
        if (status != EXIT_DONE) return status;
    }
    set_in_order(out);
    return check(c, out);
}

bool options_recorded(const options *o, int index, const char **name, const char **value) {
    for (int i = 0; i < OPTION_COUNT; i++) {
        if (!o->given[i] || !(OPTIONS[i].marks & MARK_STAMPED) || index-- > 0) continue;
        *name = OPTIONS[i].name + 2;
        *value = o->given[i];
        return true;
    }
    return false;
}
