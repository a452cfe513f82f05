/* SPDX-License-Identifier: MIT */
#include "mesh/contact_kinds.h"

#include "geometry/vec3.h"

enum { PATCHES_A_JOB = 256 };

typedef struct setting {
    const scene *scene;
    const contact_lines *lines;
    mesh *mesh;
} setting;

/* By the middle of a patch or an element. */
static contact_kind kind_at(const setting *k, uint32_t surface_index, const uint32_t corner[4]) {
    double middle[3] = { 0, 0, 0 };
    int count = corner[3] == NO_INDEX ? 3 : 4;
    for (int i = 0; i < count; i++)
        vec3_add_scaled(middle, middle, 1.0 / count, k->mesh->vertices + 3 * (size_t)corner[i]);
    return contact_lines_kind(k->scene, k->lines, surface_index, middle);
}

/* A patch is cut by long lines alone, its elements by all: it lies in another surface, or is what a thing stands on, if
 * all of it does. Of two bars of a window that cross in one plane, one has only its middle in the other; and a wall
 * that stands on the end of a floor goes on beyond it. */
static contact_kind set_elements(const setting *k, const patch *p) {
    const size_t *covers = k->lines->first_cover + surface_sheet(k->scene, p->surface);
    contact_kind kind = kind_at(k, p->surface, p->corner);
    bool is_all = true;
    if (covers[0] == covers[1]) return kind;
    for (uint32_t i = 0; i < p->element_count; i++) {
        element *e = &k->mesh->elements[p->first_element + i];
        contact_kind own = kind_at(k, p->surface, e->corner);
        e->is_foot = own == CONTACT_FOOT;
        is_all &= own == kind;
    }
    return is_all || kind == CONTACT_HIDDEN ? kind : CONTACT_OPEN;
}

static void kinds_job(void *user, size_t job, unsigned worker) {
    const setting *k = user;
    patch *all = k->mesh->patches;
    (void)worker;
    for (size_t i = job * PATCHES_A_JOB; i < (job + 1) * PATCHES_A_JOB && i < k->mesh->patch_count; i++)
        all[i].contact = (uint8_t)set_elements(k, &all[i]);
}

void contact_kinds_set(const scene *s, const contact_lines *lines, mesh *m, jobs *j) {
    setting k = { s, lines, m };
    jobs_run(j, (m->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB, kinds_job, NULL, &k);
}
