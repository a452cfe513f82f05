/* SPDX-License-Identifier: MIT
 * What is noise in what rows gathered, and what is light? The two halves of a row's rays are two estimates whose noise
 * is independent: what both say is light, what they differ in is noise. Around each element a plane is fitted to the
 * means of those beside it that are as bright as it, as far as noise can tell; what samples depart from it by is kept
 * in the share that both halves agree on,
 *
 *     E' = p + l (E - p),   l = S / (S + N),   S = mean of (A - p)(B - p),   N = mean of (A - B)^2 / 4,
 *
 * with A and B by either half: Wiener's filter, as of dual buffers [Rousselle12]. Edges of shadows stay where they
 * stand out of the noise. The halves differ afterwards by what is left of the noise, N (l + (1 - l)^2 q), q: what a
 * plane keeps of a sample's.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_NOISE_FILTER_H
#define HEMIBAKE_CORE_RECONSTRUCT_NOISE_FILTER_H

#include "base/jobs.h"
#include "mesh/mesh.h"

typedef struct noise_filter_input {
    const scene *scene;
    const mesh *mesh;
    jobs *jobs;
    const double *exact;     /* exact[3*s+c]: of the irradiance, what has no noise; NULL: nothing */
    const double *row_sum;   /* row_sum[s]: samples that see little are inside something, and asked of nobody */
    double *half_difference; /* half_difference[3*s+c]: (A - B) / 2 */
    double *irradiance;      /* irradiance[3*s+c], which is filtered */
} noise_filter_input;

/* False when out of memory. */
bool noise_filter(const noise_filter_input *in);

#endif
