/* SPDX-License-Identifier: MIT
 * What do draft, medium, high and reference mean? Sizes follow the area of the scene, so that a preset costs about the
 * same on a doll's house and on a hangar.
 */
#include "internal.h"

#include <math.h>

typedef struct preset {
    double elements,
        patches; /* how many, if the scene were cut to squares of one size; elements before they are refined */
    double unshot_target;
    uint32_t hemicube, hemicube_light;
    int light_depth, patch_depth; /* how often a shooter may be quartered */
    int check_points, check_hemicube;
    uint32_t levels;                  /* how often an element may be quartered */
    double refine_error, merge_error; /* as in hemi_bake_desc */
} preset;

/* Indexed by hemi_quality; measured on the scenes of tests/accuracy (see the table in README.md). */
static const preset PRESETS[] = {
    [HEMI_QUALITY_DEFAULT] = { 4000, 500, 1e-3, 128, 192, 3, 1, 240, 64, 4, 0.008, 0.0045 },
    [HEMI_QUALITY_DRAFT] = { 1600, 200, 2e-3, 80, 128, 2, 1, 160, 64, 2, 0.015, 0.006 },
    [HEMI_QUALITY_MEDIUM] = { 4000, 500, 1e-3, 128, 192, 3, 1, 240, 64, 4, 0.008, 0.0045 },
    [HEMI_QUALITY_HIGH] = { 8000, 1000, 3e-4, 160, 256, 4, 1, 480, 96, 4, 0.005, 0.004 },
    [HEMI_QUALITY_REFERENCE] = { 30000, 2500, 1e-4, 192, 256, 4, 2, 800, 128, 4, 0.0025, 0.0025 },
};

/* An emitter is quartered while more of its power than this falls on points that only some of its quarters see. The
 * effect is measured by tests/bench/light_tolerance. */
static const double LIGHT_TOLERANCE = 0.005;

/* Degrees. On the sphere of tests/accuracy/truth_test.py errors fall a little up to 20 and rise again from 30 on. */
static const double CLUSTER_ANGLE = 20.0;

/* In elements: what it costs in error is measured by tests/bench/dense.py. */
static const double PROXY_DEVIATION = 0.1;

static const preset *preset_of(hemi_quality quality) {
    return &PRESETS[(unsigned)quality <= HEMI_QUALITY_REFERENCE ? quality : HEMI_QUALITY_DEFAULT];
}

/* Elements of a size that was asked for are of that size, unless levels are asked for too; methods that are there to
 * compare with have elements of one size. */
static void resolve_levels(hemi_bake_desc *desc, const preset *p) {
    bool compares = desc->method == HEMI_METHOD_PR || desc->method == HEMI_METHOD_FM;
    if (desc->refine_levels == 0) desc->refine_levels = desc->element_size > 0.0 ? HEMI_REFINE_NEVER : p->levels;
    if (desc->refine_levels == HEMI_REFINE_NEVER || compares) desc->refine_levels = 0;
    if (desc->refine_error <= 0.0) desc->refine_error = p->refine_error;
}

/* Elements of one size are asked for to be seen, and a flat face is a face of its own. */
static void resolve_merging(hemi_bake_desc *desc, const preset *p) {
    if (desc->merge_error == 0.0 && desc->refine_levels > 0) desc->merge_error = p->merge_error;
    if (desc->merge_error < 0.0 || desc->flat) desc->merge_error = 0.0;
}

hemi_quality quality_of_size(double size, double *scale) {
    double elements = size * PRESETS[HEMI_QUALITY_DRAFT].elements;
    hemi_quality finest = HEMI_QUALITY_DRAFT;
    for (int q = HEMI_QUALITY_DRAFT; q <= HEMI_QUALITY_REFERENCE; q++)
        if (PRESETS[q].elements <= elements) finest = (hemi_quality)q;
    *scale = elements / PRESETS[finest].elements;
    return finest;
}

void quality_resolve(hemi_bake_desc *desc, double scene_area, double scale) {
    const preset *p = preset_of(desc->quality);
    if (scale <= 0.0) scale = 1.0;
    resolve_levels(desc, p);
    resolve_merging(desc, p);
    if (desc->element_size <= 0.0) desc->element_size = sqrt(scene_area / (scale * p->elements));
    if (desc->patch_size <= 0.0) desc->patch_size = sqrt(scene_area / (scale * p->patches));
    if (desc->patch_size < desc->element_size) desc->patch_size = desc->element_size;
    if (desc->hemicube == 0) desc->hemicube = p->hemicube;
    if (desc->hemicube_light == 0) desc->hemicube_light = p->hemicube_light;
    if (desc->unshot_target <= 0.0) desc->unshot_target = p->unshot_target;
    if (desc->memory_limit == 0) desc->memory_limit = UINT64_C(4) << 30;
    if (desc->proxy_error == 0.0) desc->proxy_error = PROXY_DEVIATION;
    if (desc->cluster_angle == 0.0) desc->cluster_angle = CLUSTER_ANGLE;
    if (desc->light_tolerance <= 0.0) desc->light_tolerance = LIGHT_TOLERANCE;
    if (desc->max_elements == 0) desc->max_elements = 4000000;
}

/* So many small elements would know nothing of far shooters that larger ones do not: the light settles on elements of
 * at least this share of a patch's edge. */
static const double ELEMENTS_OF_AN_EDGE = 4.0;

uint32_t quality_even_levels(hemi_bake_desc *desc) {
    bool compares = desc->method == HEMI_METHOD_PR || desc->method == HEMI_METHOD_FM;
    uint32_t levels = 0;
    while (!compares && desc->refine_levels == 0 && 2 * desc->element_size * ELEMENTS_OF_AN_EDGE <= desc->patch_size)
        desc->element_size *= 2, levels++;
    return levels;
}

int quality_light_depth(hemi_quality quality) {
    return preset_of(quality)->light_depth;
}

int quality_patch_depth(hemi_quality quality) {
    return preset_of(quality)->patch_depth;
}

size_t quality_check_points(hemi_quality quality) {
    return (size_t)preset_of(quality)->check_points;
}

int quality_check_hemicube(hemi_quality quality) {
    return preset_of(quality)->check_hemicube;
}

/* Directions to look for light in. The sky's are 290, 1154 and 4610; tests/accuracy says what that is good for. */
direct_light_quality quality_direct_light(hemi_quality quality) {
    static const direct_light_quality all[] = {
        [HEMI_QUALITY_DEFAULT] = { 2, 1024, 384, 16 },   [HEMI_QUALITY_DRAFT] = { 1, 512, 256, 8 },
        [HEMI_QUALITY_MEDIUM] = { 2, 1024, 384, 16 },    [HEMI_QUALITY_HIGH] = { 4, 2048, 512, 32 },
        [HEMI_QUALITY_REFERENCE] = { 4, 2048, 768, 64 },
    };
    return all[(unsigned)quality <= HEMI_QUALITY_REFERENCE ? quality : HEMI_QUALITY_DEFAULT];
}
