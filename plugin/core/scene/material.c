/* SPDX-License-Identifier: MIT */
#include "scene/material.h"

#include "geometry/vec3.h"

/* Radiance leaves as float; a scene lit by more than this would not fit. */
static const double RADIANCE_MAX = 1e30;

bool material_set(material *out, const double rho[3], const double radiance[3]) {
    for (int c = 0; c < 3; c++) {
        if (!(rho[c] >= 0.0) || isinf(rho[c]) || !(radiance[c] >= 0.0 && radiance[c] <= RADIANCE_MAX)) return false;
        out->rho[c] = rho[c];
        out->M[c] = PI * radiance[c];
        out->transmittance[c] = out->diffuse_transmittance[c] = 0.0;
    }
    return true;
}

bool material_set_transmission(material *out, const double straight[3], const double diffuse[3], double rho_max,
                               bool solves_diffuse_transmission) {
    for (int c = 0; c < 3; c++) {
        if (!(straight[c] >= 0.0 && straight[c] <= 1.0) || !(diffuse[c] >= 0.0 && diffuse[c] <= 1.0)) return false;
        out->diffuse_transmittance[c] = solves_diffuse_transmission ? diffuse[c] : 0.0;
        out->rho[c] += out->diffuse_transmittance[c];
        double clamped = fmin(out->rho[c], rho_max);
        if (clamped < out->rho[c]) out->diffuse_transmittance[c] *= clamped / out->rho[c];
        out->transmittance[c] = fmin(straight[c], 1.0 - clamped);
    }
    return true;
}

bool material_tints(const double rho[3], const double straight[3], const double diffuse[3], bool varies) {
    bool passes = false, takes = varies;
    for (int c = 0; c < 3; c++) {
        passes = passes || straight[c] > 0.0 || diffuse[c] > 0.0;
        takes = takes || straight[c] < 1.0 || diffuse[c] > 0.0 || rho[c] > 0.0;
    }
    return passes && takes;
}

bool material_transmits_diffusely(const material *m) {
    return !vec3_is_zero(m->diffuse_transmittance);
}

bool material_clamp(material *out, material *demodulated, double rho_max) {
    bool any = false;
    for (int c = 0; c < 3; c++) {
        if (out->rho[c] <= rho_max) continue;
        if (demodulated) demodulated->rho[c] *= rho_max / out->rho[c];
        out->rho[c] = rho_max;
        any = true;
    }
    return any;
}
