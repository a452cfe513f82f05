/* SPDX-License-Identifier: MIT */
#include "desc_size.h"

#include "solution.h"

#include <math.h>
#include <string.h>

bool desc_take(const hemi_context *context, const char *name, const void *desc, size_t least, void *known,
               size_t known_size) {
    uint32_t size;
    memset(known, 0, known_size);
    if (!desc) {
        context_log(context, HEMI_LOG_ERROR, "%s: the desc is NULL", name);
        return false;
    }
    memcpy(&size, desc, sizeof size);
    if (size < least || size > known_size || size % sizeof size != 0) {
        context_log(context, HEMI_LOG_ERROR,
                    "%s: struct_size is %u, and hemibake %s takes %zu to %zu; set it to the sizeof of the desc, and "
                    "build host and library with the same header",
                    name, size, hemi_version(), least, known_size);
        return false;
    }
    memcpy(known, desc, size);
    return true;
}

/* No view is so large; what is not set is hardly ever below. */
enum { VIEW_SIZE_MAX = 4096 };

bool view_give(void *out, size_t least, const void *known, size_t known_size) {
    uint32_t size;
    if (!out) return false;
    memcpy(&size, out, sizeof size);
    if (size < least || size > VIEW_SIZE_MAX || size % sizeof size != 0) return false;
    memset(out, 0, size);
    memcpy(out, known, size < known_size ? size : known_size);
    memcpy(out, &size, sizeof size);
    return true;
}

enum { HEMICUBE_MIN = 16, HEMICUBE_MAX = 4096, ADAPT_LEVELS_MAX = 8, LIGHT_GROUPS_MAX = 64 };

_Static_assert((int)HEMI_QUALITY_REFERENCE == (int)QUALITY_REFERENCE, "qualities have the same numbers");
_Static_assert((int)HEMI_METHOD_AUTO == (int)SOLVER_AUTO + 1, "methods follow each other alike");

static const char *desc_fault(const hemi_bake_desc *d) {
    const double sizes[] = { d->element_size, d->patch_size, d->unshot_target, d->open_distance };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (!(sizes[i] >= 0.0) || isinf(sizes[i])) return "a size or target is negative or not a number";
    if (!isfinite(d->error_target) || !isfinite(d->time_limit_s)) return "a target or limit is not a number";
    const uint32_t cubes[] = { d->hemicube, d->hemicube_light };
    for (int i = 0; i < 2; i++)
        if (cubes[i] && (cubes[i] < HEMICUBE_MIN || cubes[i] > HEMICUBE_MAX))
            return "a hemi-cube has 16 to 4096 pixels across";
    if (d->unshot_target >= 1.0) return "the unshot target is a fraction below 1";
    if (!(d->light_tolerance >= 0.0 && d->light_tolerance <= 1.0)) return "the light tolerance is a fraction";
    if (d->adapt_levels > ADAPT_LEVELS_MAX) return "elements are adapted by 8 levels at most";
    if (!(d->adapt_error >= 0.0) || isinf(d->adapt_error)) return "the error to adapt to is negative or not a number";
    if ((unsigned)d->method > HEMI_METHOD_AUTO) return "the method is unknown";
    if ((unsigned)d->normals > HEMI_NORMALS_FACES) return "the kind of normals is unknown";
    if (d->visibility > HEMI_VISIBILITY_AUTO || !item_backend_is_there(d->visibility % HEMI_VISIBILITY_AUTO))
        return "the visibility is unknown, or this build is without it";
    if ((d->keep_rows || d->rows_read || d->rows_write) && (d->error_target > 0.0 || d->time_limit_s > 0.0))
        return "rows are kept of one bake: without goals of error or time";
    if (d->ranks && (d->ranks->rank >= d->ranks->count || d->stop || d->checkpoint || d->time_limit_s > 0.0))
        return "a rank is below their count, and processes that share a bake have no stop, time limit or checkpoint";
    if (d->light_groups > LIGHT_GROUPS_MAX) return "there are 64 groups of lights at most";
    if (!(d->decimate_error <= 1.0)) return "what decimation may change is not a share";
    if (!(fabs(d->proxy_error) < INFINITY)) return "the deviation of proxies is not a number";
    return (unsigned)d->quality > HEMI_QUALITY_REFERENCE ? "the quality is unknown" : NULL;
}

/* Methods of the core count from 0, those of hosts after their default. */
hemi_method bake_desc_method(solver_method method) {
    return (hemi_method)(method + 1);
}

bake_options bake_desc_options(const hemi_bake_desc *d) {
    return (bake_options){ .method = d->method ? (solver_method)(d->method - 1) : SOLVER_AUTO,
                           .quality = (bake_quality)d->quality,
                           .element_size = d->element_size,
                           .patch_size = d->patch_size,
                           .hemicube = d->hemicube,
                           .hemicube_light = d->hemicube_light,
                           .unshot_target = d->unshot_target,
                           .error_target = d->error_target,
                           .time_limit_s = d->time_limit_s,
                           .process_limit = d->memory_limit > 0 ? (uint64_t)d->memory_limit : 0,
                           .memory_limit = d->memory_limit < 0 ? UINT64_MAX : (uint64_t)d->memory_limit,
                           .light_tolerance = d->light_tolerance,
                           .seed = d->seed,
                           .max_elements = d->max_elements,
                           .adapt_levels = d->adapt_levels,
                           .adapt_error = d->adapt_error,
                           .proxy_error = d->proxy_error,
                           .flat = d->flat,
                           .cluster_angle = d->cluster_angle,
                           .decimate_error = d->decimate_error,
                           .facets = d->normals == HEMI_NORMALS_FACES,
                           .bounces = d->bounces,
                           .open_distance = d->open_distance,
                           .light_groups = d->light_groups,
                           .vertex_errors = d->vertex_errors,
                           .keeps_rows = d->light_groups > 0 || d->keep_rows || d->rows_read || d->rows_write,
                           .visibility = d->visibility % HEMI_VISIBILITY_AUTO };
}

hemi_result bake_desc_take(const hemi_context *context, const hemi_bake_desc *given, hemi_bake_desc *out) {
    *out = (hemi_bake_desc){ .struct_size = sizeof *out };
    if (given && !desc_take(context, "bake", given, DESC_THROUGH(hemi_bake_desc, quality), out, sizeof *out))
        return HEMI_ERROR_ARGUMENT;
    const char *fault = desc_fault(out);
    return fault ? context_fail(context, HEMI_ERROR_ARGUMENT, "bake: %s", fault) : HEMI_OK;
}
