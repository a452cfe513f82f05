/* SPDX-License-Identifier: MIT
 * What is the radiance at the probes of a file, how far is that from what they say, and how long does it take?
 *
 *     pathtrace SCENE.glb PROBES.hprb [--samples N] [--seconds S] [--seed N] [--threads N] [--limit N]
 *               [--environment R,G,B|FILE.hdr|.exr] [--sun AZIMUTH,ELEVATION,LUX[,ANGLE]] [--normals file|faces]
 *               [-o OUT.hprb] [--json]
 *
 * A line for 1, 2, 4 ... paths a probe, up to --samples or until --seconds are over (64 without either): seconds since
 * the start, reading and building included. -o writes the probes with what was found, as a truth of its own.
 */
#include "input.h"
#include "probe_radiance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_DEFAULT = 64, SAMPLES_MAX = 1 << 24 };

static void print_line(const probe_radiance *r, const probe_figures *f, double seconds, bool json) {
    const char *format = json ? "{\"samples\": %u, \"seconds\": %.4f, \"error\": %.6f, \"bias\": %.6f, "
                                "\"reference_noise\": %.6f, \"matched\": %zu, \"unmatched\": %zu}\n"
                              : "%7u samples %9.3f s   error %.5f   bias %+.5f   noise of the truth %.5f   "
                                "%zu probes, %zu on no surface\n";
    printf(format, r->samples, seconds, f->error, f->bias, f->truth_noise, r->count, r->lost);
    fflush(stdout);
}

/* Doubles the paths until it is enough; what judging costs is not counted. */
static bool climb(const input *in, const input_options *o, const probe_set *set, probe_radiance *r, double begin) {
    uint32_t most = o->samples ? o->samples : o->seconds > 0 ? SAMPLES_MAX : SAMPLES_DEFAULT;
    double judging = 0, seconds = 0;
    while (r->samples < most) {
        uint32_t more = r->samples ? r->samples : 1;
        if (more > most - r->samples) more = most - r->samples;
        if (!probe_radiance_add(r, &in->tracer, more, o->threads)) return false;
        double now = input_clock();
        seconds = now - begin - judging;
        probe_figures f = probe_radiance_compare(r, &in->scene, set);
        print_line(r, &f, seconds, o->json);
        judging += input_clock() - now;
        if (o->seconds > 0 && 2 * seconds > o->seconds) break;
    }
    return true;
}

static bool write_probes(const char *path, const input *in, const probe_set *set, const probe_radiance *r) {
    FILE *file = fopen(path, "wb");
    uint32_t count = (uint32_t)r->count;
    bool ok = file && fwrite("HPRB", 4, 1, file) == 1 && fwrite(&count, sizeof count, 1, file) == 1;
    for (size_t i = 0; ok && i < r->count; i++) {
        probe p = set->probes[r->probe[i]];
        double radiance[3], error;
        probe_radiance_get(r, &in->scene, i, radiance, &error);
        for (int c = 0; c < 3; c++) p.radiance[c] = (float)radiance[c];
        p.standard_error = (float)error;
        ok = fwrite(&p, sizeof p, 1, file) == 1;
    }
    if (file && fclose(file) != 0) ok = false;
    if (!ok) fprintf(stderr, "%s cannot be written\n", path);
    return ok;
}

int main(int argc, char **argv) {
    input_options o;
    char message[PROBES_MESSAGE_SIZE];
    double begin = input_clock();
    if (!input_parse(argc, argv, &o) || o.file_count != 2) {
        fprintf(stderr, "usage: pathtrace SCENE.glb PROBES.hprb [options]; pathtrace.c lists them\n");
        return 2;
    }
    input in;
    probe_set set = { 0 };
    probe_radiance r = { 0 };
    bool ok = input_read(o.files[0], &o, &in);
    if (ok && probe_set_read(o.files[1], NULL, &set, message) != HEMI_OK) {
        fprintf(stderr, "%s: %s\n", o.files[1], message);
        ok = false;
    }
    ok = ok && probe_radiance_create(&in.scene, &set, o.limit, &r) && climb(&in, &o, &set, &r, begin);
    if (ok && o.output) ok = write_probes(o.output, &in, &set, &r);
    probe_radiance_destroy(&r);
    probe_set_destroy(&set);
    input_destroy(&in);
    return ok ? 0 : 1;
}
