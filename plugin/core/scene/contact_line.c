/* SPDX-License-Identifier: MIT */
#include "scene/contact_line.h"

#include "geometry/vec3.h"

#include <math.h>

/* Of a large evenly bright half-space beside a gap, what is so many gaps inside sees 15 and 3 %. */
static const double FADE[CONTACT_FADES] = { 1.0, 3.0 };

bool contact_line_clip(const contact_line *line, const double (*corner)[3], int count, const double normal[3],
                       double *low, double *high) {
    double along[3];
    vec3_sub(along, line->to, line->from);
    *low = 0.0, *high = 1.0;
    for (int k = 0; k < count; k++) {
        double edge[3], inward[3], offset[3];
        vec3_sub(edge, corner[(k + 1) % count], corner[k]);
        vec3_cross(inward, normal, edge);
        vec3_sub(offset, line->from, corner[k]);
        double at = vec3_dot(inward, offset), slope = vec3_dot(inward, along);
        if (at < 0.0 && at + slope < 0.0) return false;
        if (at < 0.0) *low = fmax(*low, -at / slope);
        if (at + slope < 0.0) *high = fmin(*high, -at / slope);
    }
    return *high > *low;
}

static bool clip_to(const contact_outline *o, contact_line *line) {
    double low, high, along[3];
    if (!contact_line_clip(line, o->corner, o->count, o->normal, &low, &high)) return false;
    vec3_sub(along, line->to, line->from);
    vec3_add_scaled(line->to, line->from, high, along);
    vec3_add_scaled(line->from, line->from, low, along);
    return true;
}

int contact_line_fades(const contact_outline *of, const contact_outline *other, double gap,
                       contact_line out[CONTACT_FADES_MAX]) {
    int count = 0;
    for (int k = 0; k < of->count; k++) {
        double edge[3], inward[3];
        if (!of->ends[k]) continue;
        vec3_sub(edge, of->corner[(k + 1) % of->count], of->corner[k]);
        vec3_cross(inward, of->normal, edge);
        if (!(vec3_normalize(inward) > 0.0)) continue;
        for (int i = 0; i < CONTACT_FADES; i++) {
            contact_line line = { .gap = INFINITY };
            vec3_add_scaled(line.from, of->corner[k], FADE[i] * gap, inward);
            vec3_add_scaled(line.to, line.from, 1.0, edge);
            if (clip_to(of, &line) && clip_to(other, &line)) out[count++] = line;
        }
    }
    return count;
}
