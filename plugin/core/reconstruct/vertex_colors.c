/* SPDX-License-Identifier: MIT */
#include "reconstruct/vertex_colors.h"

#include "formfactor/hemicube_weights.h"

#include <string.h>

/* How quads were cut by an earlier bake, whose triangles are merged again; NULL: as the light asks for. */
static const uint8_t *kept_diagonals(const vertex_colors_setup *setup) {
    const output_record *r = setup->triangles.record;
    bool is_kept = r && r->collapses.is_given && r->diagonal_count == setup->samples.mesh->element_count;
    return is_kept ? r->diagonal : NULL;
}

static bool fit_as(const fit_samples_input *in, const material *materials, const vertex_fit_input *fitted,
                   fit_samples *samples, vertex_fit_result *out) {
    fit_samples_set_radiance(in, materials, samples);
    bool ok = vertex_fit(fitted, out);
    fit_samples_set_radiance(in, NULL, samples);
    return ok;
}

bool vertex_colors_open(const vertex_colors_setup *setup, vertex_colors *out) {
    memset(out, 0, sizeof *out);
    return fit_samples_create(&setup->samples, &out->samples);
}

static const char *fit_all(const vertex_colors_setup *setup, vertex_colors *out) {
    const fit_samples_input *in = &setup->samples;
    vertex_fit_input fitted = { .mesh = in->mesh,
                                .node = out->samples.nodes,
                                .node_count = setup->triangles.node_count,
                                .radiance = out->samples.radiance,
                                .emits = out->samples.emits,
                                .weight = out->samples.weight,
                                .jobs = setup->triangles.jobs,
                                .watch = &setup->watch };
    if (!setup->demodulated) fitted.diagonal = kept_diagonals(setup);
    bool ok = vertex_fit(&fitted, &out->radiance);
    fitted.diagonal = NULL;
    if (ok && setup->fits_irradiance) { /* what a white surface that does not emit would show */
        size_t count = in->mesh->element_count;
        material *white = block_zeroed(in->mesh->memory, count + 1, sizeof *white);
        for (size_t e = 0; white && e < count; e++) white[e].rho[0] = white[e].rho[1] = white[e].rho[2] = 1.0;
        ok = white && fit_as(in, white, &fitted, &out->samples, &out->irradiance);
        block_free(white);
    }
    fitted.diagonal = kept_diagonals(setup);
    if (ok && setup->demodulated) ok = fit_as(in, setup->demodulated, &fitted, &out->samples, &out->demodulated);
    return ok ? NULL : "out of memory";
}

/* A thread of its own fits, since every colour depends on all others; who waits is told so meanwhile. */
typedef struct fitting {
    const vertex_colors_setup *setup;
    vertex_colors *out;
    const char *failure;
} fitting;

static void fit_alone(void *user) {
    fitting *f = user;
    f->failure = fit_all(f->setup, f->out);
}

static bool wait(void *user) {
    const watcher *w = &((const fitting *)user)->setup->watch;
    return !w->wait || w->wait(w->user);
}

const char *vertex_colors_fit(const vertex_colors_setup *setup, vertex_colors *out) {
    fitting f = { setup, out, NULL };
    jobs_run_alone(fit_alone, wait, &f);
    return f.failure;
}

static const vertex_fit_result *shown(const vertex_colors_setup *setup, const vertex_colors *v) {
    return setup->demodulated ? &v->demodulated : &v->radiance;
}

const char *vertex_colors_measure(const vertex_colors_setup *setup, vertex_colors *out, char *message,
                                  size_t message_size) {
    residual_setup residual = setup->residual;
    size_t pixels = (size_t)residual.resolution * (size_t)residual.resolution;
    double *weights = block_new(setup->samples.mesh->memory, 3 * pixels * sizeof *weights);
    residual_result found = { 0 };
    if (!weights) return "out of memory";
    hemicube_weights(residual.resolution, weights);
    residual.mesh = setup->samples.mesh;
    residual.watch = setup->watch;
    residual.weights = weights;
    residual.samples = out->samples.radiance;
    residual.trust = out->samples.weight;
    residual.node = out->samples.nodes;
    residual.colors = shown(setup, out)->radiance;
    residual.untextured = setup->demodulated;
    residual.diagonal = shown(setup, out)->diagonal;
    const char *failure = residual_measure(&residual, &found, message, message_size);
    block_free(weights);
    out->residual = shown(setup, out)->residual;
    /* What the fit leaves over is known at all samples, also where no point fell. */
    out->error = fmax(found.error, out->residual);
    out->bias = found.bias;
    out->points = found.points;
    return failure;
}

void vertex_colors_estimate(const vertex_colors_setup *setup, double noise, double uneven, vertex_colors *out) {
    double share = fmin((double)setup->triangles.node_count / ((double)setup->samples.mesh->sample_count + 1.0), 1.0);
    out->residual = shown(setup, out)->residual;
    double kept = noise * noise * share, left = out->residual * out->residual - noise * noise * (1.0 - share);
    out->uneven = sqrt(fmax(left, uneven * uneven));
    out->error = hypot(sqrt(kept), out->uneven);
    out->points = setup->samples.mesh->sample_count;
}

/* What decimation changes is not in the estimate so far, which looks at the elements. */
const char *vertex_colors_decimate(const vertex_colors_setup *setup, vertex_colors *out) {
    output_triangles_input in = setup->triangles;
    in.mesh = setup->samples.mesh;
    in.watch = setup->watch;
    in.samples = &out->samples;
    in.fit = &out->radiance;
    in.demodulated = setup->demodulated ? &out->demodulated : NULL;
    if (!output_triangles_make(&in, &out->triangles, &out->decimation)) return "out of memory";
    out->error = hypot(out->error, out->decimation.rms);
    return NULL;
}

void vertex_colors_free(vertex_colors *v) {
    fit_samples_free(&v->samples);
    vertex_fit_free(&v->radiance);
    vertex_fit_free(&v->demodulated);
    vertex_fit_free(&v->irradiance);
    output_triangles_free(&v->triangles);
    memset(v, 0, sizeof *v);
}
