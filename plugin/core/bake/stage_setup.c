/* SPDX-License-Identifier: MIT */
#include "bake/stage_setup.h"

#include "bake/interpolation_error.h"

#include <math.h>

/* Light that arrives, or that a picture emits, is unshot on many patches alike: what may be left of it in all is less
 * than what one patch has, or some would never shoot. Measured: with the whole of draft's 1 % a strip of floor stayed
 * dark to the wall beside it. */
static const double UNSHOT_DIRECT = 0.1;

/* Beyond so many surfaces it costs less to quarter emitters than to look for what hides which part of one. */
enum { SURFACES_OF_EXACT_EMITTERS = 300 };

/* The pictures of hemi-cubes are small while few surfaces are in them. */
enum { SURFACES_OF_KEPT_CUBES = 20000 };

/* By rows a part costs as much as an element: there are at most so many times as many as elements. Where the goal is
 * far off there may be more, but not of what has very many anyway: a town of 40,000 houses would take minutes. */
static const double PARTS_BY_ROWS = 1.25, PARTS_FAR_OFF = 2.5, ADDED_FAR_OFF = 3e5;

/* By columns parts receive from every shooter. Rooms have up to six times as many as elements at any quality; one
 * behind a blind in the sun, whose slats have no end of edges of shadows, had 45 times as many at medium, and took 150
 * s. */
static const double PARTS_BY_COLUMNS = 10.0;

static double *new_weights(allocator *memory, uint32_t resolution) {
    double *weights = block_new(memory, 3 * (size_t)resolution * resolution * sizeof *weights);
    if (weights) hemicube_weights((int)resolution, weights);
    return weights;
}

bool shooting_open(const bake_setup *setup, shooting *out) {
    const bake_options *o = setup->options;
    size_t surfaces = setup->scene.scene->surface_count;
    allocator *memory = jobs_memory(setup->jobs);
    out->weights = new_weights(memory, o->hemicube);
    out->weights_light = new_weights(memory, o->hemicube_light);
    out->columns =
        (column_setup){ .method = o->method == SOLVER_ANALYTIC ? COLUMN_ANALYTIC : COLUMN_HYBRID,
                        .elements = setup->elements,
                        .scene = setup->scene.scene,
                        .mesh = setup->scene.mesh,
                        .items = *setup->items,
                        .triangle_surface = setup->triangle_surface,
                        .resolution = (int)o->hemicube,
                        .resolution_light = (int)o->hemicube_light,
                        .weights = out->weights,
                        .weights_light = out->weights_light,
                        .seed = o->seed,
                        .light_depth = o->light_depth,
                        .patch_depth = o->patch_depth,
                        .keep_cubes = (o->adapt_levels > 0 || o->even_levels > 0) && surfaces <= SURFACES_OF_KEPT_CUBES,
                        .exact_emitters = !o->light_tolerance_is_given && surfaces <= SURFACES_OF_EXACT_EMITTERS,
                        .light_tolerance = o->light_tolerance };
    return out->weights && out->weights_light;
}

void shooting_free(shooting *s) {
    block_free_all(s->weights, s->weights_light);
}

const char *shooting_solve(const bake_setup *setup, const shooting *s, const direct_light *direct,
                           bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction),
                           void *user, progressive_result *out, char *message, size_t message_size) {
    const bake_options *o = setup->options;
    bool is_spread = (direct->irradiance || setup->emitters_are_split) && !o->unshot_is_given;
    const progressive_setup solver = { .method = o->method,
                                       .patches = setup->patches,
                                       .columns = s->columns,
                                       .jobs = setup->jobs,
                                       .arrived = direct->irradiance,
                                       .open_rows = direct->sky_w > 0.0,
                                       .unshot_target = o->unshot_target * (is_spread ? UNSHOT_DIRECT : 1.0),
                                       .unshot_is_of_emitted = o->unshot_is_given,
                                       .error_target = o->error_target,
                                       .time_limit_s = s->time_limit_s,
                                       .start_s = setup->span.start_s,
                                       .memory_limit = o->memory_limit,
                                       .clock = setup->watch.clock,
                                       .progress = progress,
                                       .progress_user = user,
                                       .stop = setup->watch.stop };
    return progressive_solve(&solver, out, message, message_size);
}

direct_light_setup direct_light_setup_of(const bake_setup *setup, bool (*progress)(void *user, double fraction),
                                         void *user) {
    const bake_options *o = setup->options;
    return (direct_light_setup){ .scene = setup->scene.scene,
                                 .mesh = setup->scene.mesh,
                                 .items = setup->items,
                                 .triangle_surface = setup->triangle_surface,
                                 .resolution = o->direct_light.resolution,
                                 .resolution_sky = o->direct_light.resolution_sky,
                                 .sun_directions = o->direct_light.sun_directions,
                                 .jobs = setup->jobs,
                                 .clock = setup->watch.clock,
                                 .progress = progress,
                                 .progress_user = user };
}

static uint32_t most_elements(const bake_setup *setup, bool is_far) {
    const bake_options *o = setup->options;
    double count = (double)setup->scene.mesh->element_count, parts = PARTS_BY_ROWS * count, most = o->max_elements;
    if (is_far && !o->is_packed) parts = fmax(parts, fmin(PARTS_FAR_OFF * count, count + ADDED_FAR_OFF));
    if (o->method != SOLVER_ROWS) parts = o->even_levels || o->adapting_is_given ? most : PARTS_BY_COLUMNS * count;
    return (uint32_t)fmin(parts, most);
}

adapt_setup adapt_setup_of(const bake_setup *setup) {
    const bake_options *o = setup->options;
    adapt_setup out = { .refinement = setup->scene,
                        .memory = setup->memory,
                        .levels = o->adapt_levels,
                        .error = o->adapt_error,
                        .max_elements = most_elements(setup, false),
                        .max_elements_far = most_elements(setup, true),
                        .even_levels = o->even_levels,
                        .lights = setup->lights,
                        .arriving = direct_light_setup_of(setup, NULL, NULL),
                        .indicate = interpolation_error_indicate,
                        .demodulated = setup->demodulated,
                        .shade = setup->shade,
                        .shade_user = setup->user };
    return out;
}

vertex_colors_setup vertex_colors_setup_of(const bake_setup *setup, const direct_light *direct,
                                           const progressive_result *solution) {
    const bake_options *o = setup->options;
    vertex_colors_setup out = { .samples = { .mesh = setup->scene.mesh,
                                             .vertex_nodes = setup->scene.mesh->nodes,
                                             .irradiance = solution->irradiance,
                                             .row_sum = solution->row_sum,
                                             .direct_row_sum = direct->row_sum,
                                             .uneven = direct->uneven,
                                             .crossed = solution->crossed },
                                .residual = { .scene = setup->scene.scene,
                                              .patches = setup->patches,
                                              .jobs = setup->jobs,
                                              .resolution = o->check_hemicube,
                                              .seed = o->seed,
                                              .point_count = o->check_points,
                                              .arrived = direct->irradiance,
                                              .lights = setup->lights,
                                              .sun_directions = o->direct_light.sun_directions },
                                .triangles = setup->triangles,
                                .demodulated = *setup->demodulated,
                                .fits_irradiance = setup->fits_irradiance };
    out.triangles.scene = setup->scene.scene;
    out.triangles.nodes = setup->scene.mesh->nodes;
    out.triangles.node_count = setup->scene.mesh->node_count;
    out.triangles.jobs = setup->jobs;
    out.triangles.record = setup->rows.write || setup->rows.read ? setup->rows.record : NULL;
    out.triangles.decimate_error = o->decimate_error;
    return out;
}
