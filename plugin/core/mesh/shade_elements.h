/* SPDX-License-Identifier: MIT
 * On which thread is each element asked what it is made of? Whoever answers may answer on any, or on the caller's
 * alone.
 */
#ifndef HEMIBAKE_CORE_MESH_SHADE_ELEMENTS_H
#define HEMIBAKE_CORE_MESH_SHADE_ELEMENTS_H

#include "base/jobs.h"
#include "mesh/mesh.h"

typedef enum shading_thread { SHADED_NOWHERE, SHADED_HERE, SHADED_ANYWHERE } shading_thread;

typedef struct shade_elements_setup {
    const mesh *mesh;
    jobs *jobs;
    size_t scratch; /* doubles that shade may write to */
    shading_thread (*where)(void *user, const patch *of);
    bool (*shade)(void *user, size_t element_index, double *scratch); /* false: there is no such material */
    void *user;
} shade_elements_setup;

/* The first patch that has no such material; SHADED_ALL: all have one; SHADED_NO_MEMORY. */
#define SHADED_ALL       (SIZE_MAX - 1)
#define SHADED_NO_MEMORY SIZE_MAX
size_t shade_elements(const shade_elements_setup *setup);

#endif
