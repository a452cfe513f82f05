/* SPDX-License-Identifier: MIT */
#include "light_names.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

int light_names_ask(light_names *n, const options *o, bool for_usd, console *c) {
    n->is_asked = o->light_groups;
    if (!o->light_groups || !(for_usd || o->keep_instances)) return EXIT_DONE;
    console_error(c, "--light-groups is for glTF, whose instances each have their own light");
    return EXIT_USAGE;
}

uint32_t light_names_group(light_names *n, const char *name, const char *kind, uint32_t index) {
    char unnamed[LIGHT_NAME_SIZE], made[LIGHT_NAME_SIZE];
    if (!n->is_asked) return 0;
    snprintf(unnamed, sizeof unnamed, "%s_%u", kind, index);
    snprintf(made, sizeof made, "_LIGHT_%.50s", name && *name ? name : unnamed);
    for (char *at = made + 1; *at; at++) *at = isalnum((unsigned char)*at) ? (char)toupper((unsigned char)*at) : '_';
    for (uint32_t g = 0; g < n->count; g++)
        if (strcmp(n->all[g], made) == 0) return g;
    if (n->count == LIGHT_NAMES_MAX) return n->is_too_many = true, 0;
    strcpy(n->all[n->count], made);
    return n->count++;
}

int light_names_end(light_names *n, console *c) {
    if (!n->is_asked) return EXIT_DONE;
    if (n->count == 0) light_names_group(n, "sky", "", 0);
    if (!n->is_too_many) return EXIT_DONE;
    console_error(c,
                  "--light-groups: more than %d groups of lights; put some together by extras.hemibake.group of their "
                  "materials",
                  LIGHT_NAMES_MAX);
    return EXIT_BAD_INPUT;
}
