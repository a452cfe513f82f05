/* SPDX-License-Identifier: MIT
 * What is the radiance at the probes of a file, and how far is it from what the file says? The relative error of
 * equation 12 [Baum89], as `hemibake compare` gives it.
 */
#ifndef HEMIBAKE_ORACLE_PROBE_RADIANCE_H
#define HEMIBAKE_ORACLE_PROBE_RADIANCE_H

#include "probes.h"
#include "radiance.h"

typedef struct probe_radiance {
    traced_point *points; /* of the probes that lie on a surface; after them their other sides, if sides is 2 */
    size_t *probe;        /* which of the set that is */
    size_t count, lost;   /* lost: they lie on none */
    size_t sides;         /* 2: some let light through diffusely */
    uint32_t samples;     /* paths a point so far */
    double *sums, *squares;
} probe_radiance;

/* Of every so manieth probe only, so that there are about limit of them; 0: all. False: out of memory. */
bool probe_radiance_create(const traced_scene *s, const probe_set *set, uint32_t limit, probe_radiance *out);
void probe_radiance_destroy(probe_radiance *r);

/* So many more paths a point. */
bool probe_radiance_add(probe_radiance *r, const radiance_tracer *tracer, uint32_t samples, unsigned threads);

/* Outgoing radiance of one of the points so far, and the standard error of a band: three times its square is what all
 * three are off by, squared. The error is that of independent samples; Sobol's are at least as good. */
void probe_radiance_get(const probe_radiance *r, const traced_scene *s, size_t i, double radiance[3], double *error);

typedef struct probe_figures {
    double error;       /* relative, of equation 12 */
    double truth_noise; /* what the truth itself is off by */
    double bias;        /* sum of differences / sum of the truth */
} probe_figures;

probe_figures probe_radiance_compare(const probe_radiance *r, const traced_scene *s, const probe_set *set);

#endif
