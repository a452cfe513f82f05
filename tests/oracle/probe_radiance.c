/* SPDX-License-Identifier: MIT */
#include "probe_radiance.h"

#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Probes are floats, those of a large scene some centimetres of rounding away: as converters/probes/match.h. */
static const double REACH = 1e-3;

bool probe_radiance_create(const traced_scene *s, const probe_set *set, uint32_t limit, probe_radiance *out) {
    size_t step = limit && limit < set->count ? (set->count + limit - 1) / limit : 1;
    memset(out, 0, sizeof *out);
    out->sides = 1;
    out->points = malloc((2 * set->count + 1) * sizeof *out->points);
    out->probe = malloc((set->count + 1) * sizeof *out->probe);
    if (!out->points || !out->probe) return false;
    for (size_t i = 0; i < set->count; i += step) {
        double place[3], normal[3];
        vec3_from_floats(place, set->probes[i].position);
        vec3_from_floats(normal, set->probes[i].normal);
        out->probe[out->count] = i;
        if (traced_scene_locate(s, place, normal, REACH * s->radius, &out->points[out->count]))
            out->count++;
        else
            out->lost++;
    }
    for (size_t i = 0; i < out->count; i++) {
        double straight[3], diffuse[3];
        traced_point *other = &out->points[out->count + i];
        traced_scene_transmittance(s, out->points[i].triangle, out->points[i].weights, straight, diffuse);
        if (!vec3_is_zero(diffuse)) out->sides = 2;
        *other = out->points[i];
        traced_point_turn(other);
    }
    out->sums = calloc(6 * out->count + 1, sizeof *out->sums);
    out->squares = calloc(6 * out->count + 1, sizeof *out->squares);
    return out->sums && out->squares;
}

void probe_radiance_destroy(probe_radiance *r) {
    free(r->points);
    free(r->probe);
    free(r->sums);
    free(r->squares);
    memset(r, 0, sizeof *r);
}

bool probe_radiance_add(probe_radiance *r, const radiance_tracer *tracer, uint32_t samples, unsigned threads) {
    bool ok = radiance_add(tracer, r->points, r->sides * r->count, r->samples, samples, threads, r->sums, r->squares);
    r->samples += samples;
    return ok;
}

void probe_radiance_get(const probe_radiance *r, const traced_scene *s, size_t i, double radiance[3], double *error) {
    const traced_point *at = &r->points[i];
    double emission[3], straight[3], shares[2][3], n = r->samples, variance = 0;
    traced_scene_shade(s, at->triangle, at->weights, shares[0], emission);
    traced_scene_transmittance(s, at->triangle, at->weights, straight, shares[1]);
    vec3_copy(radiance, emission);
    for (size_t side = 0; side < r->sides; side++) {
        size_t p = side * r->count + i;
        for (size_t c = 0; c < 3; c++) {
            double mean = r->sums[3 * p + c] / n, share = shares[side][c];
            radiance[c] += share * mean;
            variance += share * share * fmax(r->squares[3 * p + c] / n - mean * mean, 0) / (n - 1) / 3;
        }
    }
    *error = n > 1 ? sqrt(variance) : INFINITY;
}

probe_figures probe_radiance_compare(const probe_radiance *r, const traced_scene *s, const probe_set *set) {
    double off = 0, all = 0, noise = 0, more = 0, sum = 0;
    for (size_t i = 0; i < r->count; i++) {
        const probe *p = &set->probes[r->probe[i]];
        double radiance[3], error;
        probe_radiance_get(r, s, i, radiance, &error);
        for (int c = 0; c < 3; c++) {
            double truth = (double)p->radiance[c];
            off += (radiance[c] - truth) * (radiance[c] - truth);
            all += truth * truth;
            more += radiance[c] - truth;
            sum += truth;
        }
        noise += 3 * (double)p->standard_error * (double)p->standard_error;
    }
    return (probe_figures){ sqrt(off / all), sqrt(noise / all), more / sum };
}
