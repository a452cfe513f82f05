/* SPDX-License-Identifier: MIT
 * How do the arrays of surfaces, patches and elements grow? By doubling; what is new is all zero.
 */
#include "internal.h"

#include <string.h>

surface *builder_add_surface(builder *b) {
    scene *s = b->out->scene;
    if (!block_grow(s->memory, (void **)&s->surfaces, &b->surface_capacity, s->surface_count, sizeof *s->surfaces))
        return NULL;
    return memset(&s->surfaces[s->surface_count++], 0, sizeof *s->surfaces);
}

patch *builder_add_patch(builder *b) {
    mesh *m = b->out->mesh;
    if (!block_grow(m->memory, (void **)&m->patches, &b->patch_capacity, m->patch_count, sizeof *m->patches))
        return NULL;
    return memset(&m->patches[m->patch_count++], 0, sizeof *m->patches);
}

hemi_result builder_add_element(builder *b, const uint32_t corner[4]) {
    mesh *m = b->out->mesh;
    if (m->element_count >= b->desc->max_elements) return HEMI_ERROR_LIMIT;
    if (!block_grow(m->memory, (void **)&m->elements, &b->element_capacity, m->element_count, sizeof *m->elements))
        return HEMI_ERROR_MEMORY;
    element *e = memset(&m->elements[m->element_count++], 0, sizeof *e);
    memcpy(e->corner, corner, sizeof e->corner);
    return HEMI_OK;
}
