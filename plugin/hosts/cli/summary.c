/* SPDX-License-Identifier: MIT
 * See summary.h.
 */
#include "summary.h"

#include "printable.h"

#include <stdio.h>

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

void summary_print(const report_facts *f, const char *const *more, size_t more_count) {
    const hemi_statistics *s = f->statistics;
    const gltf_output *w = f->written;
    printf("baked   %u surfaces as %u patches and %u elements, lit by %u light patch%s\n", s->scene.surfaces,
           s->scene.patches, s->scene.elements, s->scene.emitting_patches, s->scene.emitting_patches == 1 ? "" : "es");
    printf("error   about %.1f %% (estimate)", 100 * s->error.estimate);
    if (f->error_reference >= 0.0) printf("; %.2f %% against the reference", 100 * f->error_reference);
    if (!s->solver.converged)
        printf("; %s before it converged, %.2g %% unshot", f->is_interrupted ? "interrupted" : "stopped",
               100 * s->solver.unshot_fraction);
    printf("\n");
    print_color(f);
    printf("time    %.2f s: form factors %.2f, solving %.2f, writing %.2f; %u shots, %u hemi-cubes, %u threads\n",
           f->total_s, s->time.factors_s, s->time.solve_s, f->write_s, s->solver.shots, s->solver.hemicubes,
           s->solver.threads);
    printf("size    %.1f kB, %llu triangles, %llu vertices", (double)(w->main_size + w->bin_size) / 1e3,
           (unsigned long long)w->triangles, (unsigned long long)w->vertices);
    if (!f->o->no_draco) printf("; geometry %.1f kB before Draco", (double)w->geometry_bytes_before / 1e3);
    printf("\nfiles   ");
    print_printable(stdout, f->o->output);
    for (size_t i = 0; i < more_count; i++)
        if (more[i]) printf(", "), print_printable(stdout, more[i]);
    printf("\n");
}
