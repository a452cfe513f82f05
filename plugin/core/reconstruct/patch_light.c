/* SPDX-License-Identifier: MIT */
#include "reconstruct/patch_light.h"

#include <string.h>

/* Solves the 2 x 2 normal equations of a plane over the patch: slopes along two axes of the surface. */
static void fit_slopes(const mesh *m, const double *samples, const double *trust, const patch *p, const double u[3],
                       const double v[3], patch_light *out) {
    double uu = 0, uv = 0, vv = 0, uL[PATCH_LIGHT_BANDS] = { 0 }, vL[PATCH_LIGHT_BANDS] = { 0 };
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        const double d[3] = { m->x[s] - out->center[0], m->y[s] - out->center[1], m->z[s] - out->center[2] };
        double a = vec3_dot(d, u), b = vec3_dot(d, v), w = trust[s];
        uu += w * a * a, uv += w * a * b, vv += w * b * b;
        for (int c = 0; c < PATCH_LIGHT_BANDS; c++) {
            double L = samples[3 * (size_t)s + (size_t)c] - out->L[c];
            uL[c] += w * a * L, vL[c] += w * b * L;
        }
    }
    double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-9 * uu * vv)) return;
    for (int c = 0; c < PATCH_LIGHT_BANDS; c++) {
        double su = (vv * uL[c] - uv * vL[c]) / determinant, sv = (uu * vL[c] - uv * uL[c]) / determinant;
        for (int k = 0; k < 3; k++) out->slope[c][k] = su * u[k] + sv * v[k];
    }
}

void patch_light_fit(const scene *s, const mesh *m, const double *samples, const double *trust, uint32_t index,
                     patch_light *out) {
    const patch *p = &m->patches[index];
    const double *normal = s->surfaces[p->surface].normal;
    double weight = 0.0, u[3], v[3], axis[3] = { 0, 0, 0 };
    memset(out, 0, sizeof *out);
    for (uint32_t i = p->first_sample; i < p->first_sample + p->sample_count; i++) {
        double w = trust[i];
        weight += w;
        out->center[0] += w * m->x[i], out->center[1] += w * m->y[i], out->center[2] += w * m->z[i];
        for (int c = 0; c < PATCH_LIGHT_BANDS; c++) out->L[c] += w * samples[3 * (size_t)i + (size_t)c];
    }
    if (!(weight > 0.0)) return;
    for (int k = 0; k < 3; k++) out->center[k] /= weight, out->L[k] /= weight;
    axis[fabs(normal[0]) < 0.6 ? 0 : 1] = 1.0;
    vec3_cross(u, axis, normal);
    vec3_normalize(u);
    vec3_cross(v, normal, u);
    fit_slopes(m, samples, trust, p, u, v, out);
}
