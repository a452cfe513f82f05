/* SPDX-License-Identifier: MIT */
#include "name_list.h"

#include <stdio.h>
#include <string.h>

void name_list_add(name_list *l, const char *name, double area) {
    l->area += area;
    if (!name || !*name) name = "(without a name)";
    for (size_t i = 0; i < l->count && i < NAMES_MAX; i++)
        if (strcmp(l->names[i], name) == 0) return;
    if (l->count < NAMES_MAX) l->names[l->count] = name;
    l->count++;
}

void name_list_write(const name_list *l, char text[NAMES_TEXT_SIZE]) {
    size_t used = 0, shown = l->count < NAMES_MAX ? l->count : NAMES_MAX;
    text[0] = 0;
    for (size_t i = 0; i < shown; i++)
        used += (size_t)sprintf(text + used, "%s\"%.*s\"", i ? ", " : "", NAME_LENGTH, l->names[i]);
    if (l->count > shown) sprintf(text + used, " and others");
}
