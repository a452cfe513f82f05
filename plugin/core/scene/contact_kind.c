/* SPDX-License-Identifier: MIT
 * See contact_lines.h.
 */
#include "scene/contact_lines.h"

#include "base/tolerance.h"

#include <math.h>

/* Is a point over the surface, or under it? */
static bool is_within(const scene *s, const surface *f, const double point[3], double margin) {
    int count = surface_corner_count(f);
    for (int k = 0; k < count; k++) {
        const double *a = scene_vertex(s, f->corner[k]), *b = scene_vertex(s, f->corner[(k + 1) % count]);
        double edge[3], inward[3], offset[3];
        vec3_sub(edge, b, a);
        vec3_cross(inward, f->normal, edge);
        vec3_normalize(inward);
        vec3_sub(offset, point, a);
        if (vec3_dot(inward, offset) < -margin) return false;
    }
    return true;
}

/* Light comes through it to what lies under it. */
static bool lets_light_through(const scene *s, const surface *f) {
    const material *m = &s->materials[f->material];
    bool through = false;
    for (int c = 0; c < 3; c++) through |= m->transmittance[c] > 0.0 || m->diffuse_transmittance[c] > 0.0;
    return through || f->holes;
}

/* What a thing stands on is larger than its foot by at least this. Where two are about as large, as the skins of a wall
 * are that face apart, each is in the light of its own side. */
static const double STANDS_ON = 2.0;

/* Is the surface, on this side of its sheet, of the foot of a thing that stands on the other, on whichever side? Things
 * stand on what is below them, along -y: a door that ends in the plane of a wall's one skin is seen from outside. */
static bool stands_on(const scene *s, const contact_lines *l, uint32_t sheet, double side, const contact_cover *c) {
    const surface *own = &s->surfaces[sheet], *other = &s->surfaces[c->surface];
    bool faces_apart = other->twin != NO_INDEX || side * vec3_dot(own->normal, other->normal) < 0.0;
    bool looks_down = side * own->normal[1] <= -FLAT_SIDES_PARALLEL;
    return looks_down && faces_apart && fabs((double)c->height) <= TOLERANCE_EYE_LIFT * s->radius &&
           flat_sides_is_foot(&l->sides, sheet, side > 0.0) &&
           flat_sides_area(&l->sides, c->surface) > STANDS_ON * flat_sides_area(&l->sides, sheet);
}

contact_kind contact_lines_kind(const scene *s, const contact_lines *l, uint32_t surface_index, const double point[3]) {
    const uint32_t sheet = surface_sheet(s, surface_index);
    const surface *own = &s->surfaces[surface_index];
    const double side = sheet == surface_index ? 1.0 : -1.0;
    contact_kind kind = CONTACT_OPEN;
    for (size_t i = l->first_cover[sheet]; i < l->first_cover[sheet + 1]; i++) {
        const contact_cover *c = &l->covers[i];
        const surface *other = &s->surfaces[c->surface];
        bool faces_alike = other->twin != NO_INDEX || vec3_dot(own->normal, other->normal) > 0.0;
        if (side * (double)c->height < 0.0 || !is_within(s, other, point, TOLERANCE_IN_PLANE * s->radius)) continue;
        if (lets_light_through(s, other)) continue;
        if (stands_on(s, l, sheet, side, c)) return CONTACT_FOOT;
        if (c->height != 0.0f && fabs((double)c->height) < l->hidden) return CONTACT_HIDDEN;
        if (c->height != 0.0f) continue;
        if (faces_alike && scene_shows_before(s, c->surface, sheet)) kind = CONTACT_COPY;
    }
    return kind;
}
