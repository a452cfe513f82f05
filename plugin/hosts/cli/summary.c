/* SPDX-License-Identifier: MIT */
#include "summary.h"

#include "printable.h"

#include <stdio.h>

/* A part by itself is told of from so many times the error of the whole on. */
static const double FAR_WORSE = 3.0;

static void print_color(const report_facts *f) {
    const color_transform *t = f->spaces->transform;
    if (f->o->scene_linear) {
        printf("colour  scene-linear Rec.709");
    } else {
        printf("colour  ");
        print_printable(stdout, color_transform_name(t, COLOR_PART_VIEW));
        printf(" on ");
        print_printable(stdout, color_transform_name(t, COLOR_PART_DISPLAY));
        printf(", exposure %+.2f EV", f->colors->exposure_ev);
    }
    printf("; %.1f %% of vertices clipped\n", 100 * f->colors->clipped_fraction);
}

/* What is darker than this, of the whole, is black on a display: on a roof at night nobody sees what it is off by. */
static const double SEEN_LEAST = 5e-4;

/* Where it is far worse than in all. */
static void print_worst(const report_facts *f) {
    const hemi_error_statistics *e = &f->statistics->error;
    bool is_seen = report_knows_worst(f) && e->worst.light >= SEEN_LEAST;
    if (!is_seen || e->worst.estimate < FAR_WORSE * e->estimate) return;
    printf("worst   node '");
    print_printable(stdout, report_worst_node(f));
    printf("', about %.0f %% of its own light, which is %.2g %% as bright as the whole; %.2g %% of the area\n",
           100 * e->worst.estimate, 100 * e->worst.light, 100 * e->worst.area);
}

/* Seconds below which nothing is worth a word. */
static const double ANY_TIME = 0.005;

/* All of the total; what else there is, is the rest. */
static void print_times(const report_facts *f) {
    const hemi_statistics *s = f->statistics;
    const hemi_time_statistics *t = &s->time;
    const struct {
        const char *name;
        double s;
    } parts[] = { { "reading", f->read_s },
                  { "mesh", t->mesh_s },
                  { "light", s->arrived.direct_light_s },
                  { "form factors", t->factors_s },
                  { "solving", t->solve_s - s->arrived.direct_light_s },
                  { "refining", t->adapt_s },
                  { "fitting", t->reconstruct_s },
                  { "colour", f->color_s },
                  { "writing", f->write_s },
                  { "pictures", f->picture_s },
                  { "coarser bakes before it", t->total_s - t->own_s } };
    const size_t count = sizeof parts / sizeof *parts - (t->total_s - t->own_s < ANY_TIME ? 1 : 0);
    double rest = f->total_s;
    printf("time    %.2f s:", f->total_s);
    for (size_t i = 0; i < count; i++) {
        printf(" %s %.2f,", parts[i].name, parts[i].s);
        rest -= parts[i].s;
    }
    printf(" the rest %.2f; %u shots, %u hemi-cubes, %u threads\n", rest > 0.0 ? rest : 0.0, s->solver.shots,
           s->solver.hemicubes, s->solver.threads);
}

/* Of one asset among many, in one piece: others print too. */
static void print_line(const report_facts *f) {
    char line[1024], error[64] = "nothing is lit";
    if (!report_is_unlit(f)) snprintf(error, sizeof error, "error about %.1f %%", 100 * f->statistics->error.estimate);
    const char *end = f->is_interrupted                 ? ", interrupted before it converged"
                      : f->statistics->solver.converged ? ""
                                                        : ", stopped before it converged";
    snprintf(line, sizeof line, "baked     %s -> %s: %s, %.1f kB, %.2f s%s", f->o->inputs[0], f->o->output, error,
             (double)(f->written->main_size + f->written->bin_size) / 1e3, f->total_s, end);
    print_printable(stdout, line);
    printf("\n");
}

void summary_print(const report_facts *f, const char *const *more, size_t more_count) {
    const hemi_statistics *s = f->statistics;
    const gltf_output *w = f->written;
    if (f->o->is_one_of_many) {
        print_line(f);
        return;
    }
    printf("baked   %u surfaces as %u patches and %u elements, lit by %u light patch%s\n", s->scene.surfaces,
           s->scene.patches, s->scene.elements, s->scene.emitting_patches, s->scene.emitting_patches == 1 ? "" : "es");
    if (report_is_unlit(f))
        printf("error   no estimate: nothing is lit");
    else
        printf("error   about %.1f %% (estimate)", 100 * s->error.estimate);
    if (f->error_reference.whole >= 0.0)
        printf("; %.2f %% against the reference, half of its probes within %.2f %%, 95 %% within %.2f %%",
               100 * f->error_reference.whole, 100 * f->error_reference.median, 100 * f->error_reference.percentile95);
    if (!s->solver.converged)
        printf("; %s before it converged, %.3g %% unshot", f->is_interrupted ? "interrupted" : "stopped",
               100 * s->solver.unshot_fraction);
    printf("\n");
    print_worst(f);
    print_color(f);
    print_times(f);
    printf("size    %.1f kB, %llu triangles, %llu vertices", (double)(w->main_size + w->bin_size) / 1e3,
           (unsigned long long)w->triangles, (unsigned long long)w->vertices);
    if (!f->o->no_draco) printf("; geometry %.1f kB before Draco", (double)w->geometry_bytes_before / 1e3);
    printf("\nfiles   ");
    print_printable(stdout, f->o->output);
    for (size_t i = 0; i < more_count; i++)
        if (more[i]) printf(", "), print_printable(stdout, more[i]);
    printf("\n");
}
