/* SPDX-License-Identifier: MIT */
#include "bake/quality.h"

#include "visibility/rays.h"

#include <math.h>
#include <stdio.h>

enum { QUALITIES = QUALITY_REFERENCE + 1 };

typedef struct presets {
    double elements[QUALITIES], patches[QUALITIES]; /* how many, if the scene were cut to squares of one size, before
                                                       elements are adapted */
    double unshot_target[QUALITIES];
    double hemicube[QUALITIES], hemicube_light[QUALITIES];
    int light_depth[QUALITIES], patch_depth[QUALITIES];
    double check_points[QUALITIES], check_hemicube[QUALITIES];
    int levels[QUALITIES];
    double adapt_error[QUALITIES], decimate_error[QUALITIES];
    /* Directions to look for light in: the sky's are 290, 1154 and 4610; tests/accuracy says what that is good for. */
    direct_light_quality direct_light[QUALITIES];
    double rows_elements[QUALITIES]; /* where rows are gathered; elements are then of one size */
    int rows_initial[QUALITIES];     /* rays of each sample ... */
    int rows_emitter[QUALITIES];     /* to emitters */
    double rows_adaptive[QUALITIES]; /* ... and adaptive ones of all, at most ... */
    double rows_noise[QUALITIES];    /* ... since fewer will do where they leave no more than this; 0: all are cast */
} presets;

/* By bake_quality: of the default, which is medium, nothing; of draft, medium, high and reference. Measured on the
 * scenes of tests/accuracy (see the table in tests/bench/README.md). */
static const presets PRESETS = {
    .elements = { 0, 1600, 4000, 8000, 30000 },
    .patches = { 0, 200, 500, 1000, 2500 },
    .unshot_target = { 0, 2e-3, 1e-3, 3e-4, 1e-4 },
    .hemicube = { 0, 80, 128, 160, 192 },
    .hemicube_light = { 0, 128, 192, 256, 256 },
    .light_depth = { 0, 2, 3, 4, 4 },
    .patch_depth = { 0, 1, 1, 1, 2 },
    .check_points = { 0, 160, 240, 480, 800 },
    .check_hemicube = { 0, 64, 64, 96, 128 },
    .levels = { 0, 2, 4, 4, 4 },
    .adapt_error = { 0, 0.015, 0.008, 0.005, 0.0025 },
    .decimate_error = { 0, 0.0085, 0.0045, 0.004, 0.0025 },
    .direct_light = { { 0 }, { 1, 512, 256, 8 }, { 2, 1024, 384, 16 }, { 4, 2048, 512, 32 }, { 4, 2048, 768, 64 } },
    .rows_elements = { 0, 20000, 60000, 100000, 300000 },
    .rows_initial = { 0, 16, 32, 32, 128 },
    .rows_emitter = { 0, 8, 16, 32, 64 },
    .rows_adaptive = { 0, 3e6, 10e6, 32e6, 300e6 },
    .rows_noise = { 0, 0, 0, 0.005, 0.0025 },
};

/* An emitter is quartered while more of its power than this falls on points that only some of its quarters see. The
 * effect is measured by tests/bench/light_tolerance. */
static const double LIGHT_TOLERANCE = 0.005;

/* Degrees. On the sphere of tests/accuracy/truth_test.py errors fall a little up to 20 and rise again from 30 on. */
static const double CLUSTER_ANGLE = 20.0;

/* In elements: what it costs in error is measured by tests/bench/dense.py. By 0.1 and 0.05 the facets of a sphere show
 * as blotches where light ends on it; by this none do, for a fifth more time. */
static const double PROXY_ERROR = 0.035;

/* To rows more triangles cost little: an apartment of 178,000 is off by 11 % at draft with the former and by 8 % with
 * this, in the same time. */
static const double PROXY_ERROR_OF_ROWS = 0.02;

static const uint64_t MEMORY_LIMIT = UINT64_C(4) << 30;
static const uint32_t MAX_ELEMENTS = 4000000;

/* So many small elements would know nothing of far shooters that larger ones do not: the light settles on elements of
 * at least this share of a patch's edge. */
static const double ELEMENTS_OF_AN_EDGE = 4.0;

/* From so many shooters on rows cost less than columns, or are much nearer: every triangle is a surface that each
 * hemi-cube draws, and a shooter, but for small ones that go together. Measured at draft: rooms of 800 to 1,000
 * triangles of furniture, 360 to 490 shooters, take rows 2.5 s of processor time instead of 10 to 23, and are off
 * by 2.5 to 5 instead of 5 to 9 %; one of 272 takes 2.6 instead of 2.1 s and is off by 1.1 instead of 8 %. Rooms of a
 * few dozen faces, and one with a sphere of 960 facets, 152 shooters, take columns a third of the time. A sky takes
 * rows whatever is under it: columns look at each of its patches in one direction, and are off by a factor where it is
 * seen through a window that is smaller than a patch. A sun beside lamps takes rows, too: columns stop when little of
 * all light is unshot, and what the sun gives to walls outside may be a thousand times what lamps give inside, whose
 * rooms were off by up to 57 %; and a patch of which a part is in the sun shoots as if all were. */
enum { SHOOTERS_OF_ROWS = 250 };

/* And from so many that emit: each is shot by itself, from forty hemi-cubes or so. 35,000 take columns 20 s even after
 * meshes have had simpler ones stand in for them, and rows 4 s. */
enum { EMITTERS_OF_ROWS = 300 };

/* By rows elements are small before any is split, and what is split is where light changes within millimetres: once
 * more, and until less is left, which costs little of the whole (a bedroom at draft: 6.7 to 5.2 % for a fifth more
 * time). */
enum { LEVELS_OF_ROWS = 1 };
static const double SHARE_OF_ROWS = 0.4;

/* Of rows that a goal asks for: elements are split, and triangles merged, until these shares of the error that is asked
 * for are left, where a quality's are not less. */
static const double SPLIT_TO = 0.6, MERGE_TO = 0.85;

/* Of a goal's rays to emitters, the most in those of reference. */
static const double EMITTER_RAYS_MOST = 4.0;

/* Of one bake. */
typedef struct preset {
    bake_quality quality;
    double elements, patches, unshot_target, hemicube, hemicube_light, check_points, check_hemicube;
    double adapt_error, decimate_error, rays, noise;
    int emitter_rays;
} preset;

/* The finest that is no finer; draft for what is coarser than all. */
static bake_quality quality_at(double level) {
    return level < QUALITY_DRAFT ? QUALITY_DRAFT : (bake_quality)level;
}

/* Between two qualities all that makes them fine lies between theirs, and below draft as far from it as above. */
static double between(const double of[QUALITIES], double level) {
    int q = (int)quality_at(level);
    double share = level - q;
    return share == 0.0 ? of[q] : of[q] * pow(of[q + 1] / of[q], share);
}

static preset preset_between(double level) {
    bake_quality q = quality_at(level);
    return (preset){ .quality = q,
                     .elements = between(PRESETS.elements, level),
                     .patches = between(PRESETS.patches, level),
                     .unshot_target = between(PRESETS.unshot_target, level),
                     .hemicube = between(PRESETS.hemicube, level),
                     .hemicube_light = between(PRESETS.hemicube_light, level),
                     .check_points = between(PRESETS.check_points, level),
                     .check_hemicube = between(PRESETS.check_hemicube, level),
                     .adapt_error = between(PRESETS.adapt_error, level),
                     .decimate_error = between(PRESETS.decimate_error, level),
                     .rays = PRESETS.rows_adaptive[q],
                     .noise = PRESETS.rows_noise[q],
                     .emitter_rays = PRESETS.rows_emitter[q] };
}

/* The quality of rows that are to be off by so much is the coarsest whose elements are fine enough for that. */
static bake_quality quality_of_error(double error) {
    bake_quality q = QUALITY_DRAFT;
    while (q < QUALITY_REFERENCE && SHARE_OF_ROWS * PRESETS.adapt_error[q] > SPLIT_TO * error) q++;
    return q;
}

static preset preset_of_rows(const bake_options *o) {
    const bake_fineness *f = &o->fineness;
    preset out = preset_between(f->elements > 0.0 ? quality_of_error(o->error_target) : o->quality);
    out.elements = PRESETS.rows_elements[out.quality];
    out.adapt_error *= SHARE_OF_ROWS;
    if (!(f->elements > 0.0)) return out;
    out.elements = f->elements * PRESETS.rows_elements[QUALITY_DRAFT];
    out.patches = f->elements * PRESETS.patches[QUALITY_DRAFT];
    out.rays = f->rays * PRESETS.rows_adaptive[QUALITY_DRAFT];
    out.emitter_rays = (int)ceil(f->emitter_rays * PRESETS.rows_emitter[QUALITY_DRAFT]);
    out.adapt_error = fmin(SPLIT_TO * o->error_target, out.adapt_error);
    out.decimate_error = fmin(MERGE_TO * o->error_target, out.decimate_error);
    out.noise = 0.0;
    return out;
}

bake_fineness quality_finest(void) {
    const bake_quality q = QUALITY_REFERENCE;
    return (bake_fineness){ .elements = PRESETS.rows_elements[q] / PRESETS.rows_elements[QUALITY_DRAFT],
                            .rays = PRESETS.rows_adaptive[q] / PRESETS.rows_adaptive[QUALITY_DRAFT],
                            .emitter_rays =
                                EMITTER_RAYS_MOST * PRESETS.rows_emitter[q] / PRESETS.rows_emitter[QUALITY_DRAFT],
                            .level = q };
}

/* Elements of a size that was asked for are of that size, unless levels are asked for too; methods that are there to
 * compare with have elements of one size. */
static void resolve_levels(bake_options *o, const preset *p) {
    if (o->adapt_levels == 0)
        o->adapt_levels =
            o->element_size > 0.0 ? -1 : PRESETS.levels[p->quality] + (o->method == SOLVER_ROWS ? LEVELS_OF_ROWS : 0);
    if (o->adapt_levels < 0 || quality_compares(o)) o->adapt_levels = 0;
    if (o->adapt_error <= 0.0) o->adapt_error = p->adapt_error;
}

/* Elements of one size are asked for to be seen, and with one colour a triangle every triangle is. */
static void resolve_decimation(bake_options *o, const preset *p) {
    if (o->decimate_error == 0.0 && (o->adapt_levels > 0 || o->method == SOLVER_ROWS))
        o->decimate_error = p->decimate_error;
    if (o->decimate_error < 0.0 || o->flat) o->decimate_error = 0.0;
}

static void resolve_sizes(bake_options *o, const preset *p, double scene_area, double scale) {
    const double usual = sqrt(scene_area / (scale * p->elements));
    if (o->element_size <= 0.0) o->element_size = usual;
    /* Elements that are asked to be finer have as many rays each. */
    o->rows_adaptive = scale * p->rays * fmax(pow(usual / o->element_size, 2.0), 1.0);
    if (o->patch_size <= 0.0) o->patch_size = sqrt(scene_area / (scale * p->patches));
    if (o->patch_size < o->element_size) o->patch_size = o->element_size;
}

/* A hemi-cube's number of pixels is even, so that a side face has half the rows of its top. */
static uint32_t even(uint32_t asked, double usual) {
    uint32_t resolution = asked ? asked : (uint32_t)lround(usual);
    return resolution + (resolution & 1);
}

bake_quality quality_of_size(double size, double *scale) {
    double elements = size * PRESETS.elements[QUALITY_DRAFT];
    bake_quality finest = QUALITY_DRAFT;
    for (bake_quality q = QUALITY_DRAFT; q <= QUALITY_REFERENCE; q++)
        if (PRESETS.elements[q] <= elements) finest = q;
    *scale = elements / PRESETS.elements[finest];
    return finest;
}

/* Seconds of one processor: what OpenGL takes a triangle of a frame, and rays a pixel, beside which what OpenGL takes a
 * pixel and rays a triangle is little. Of 100,000 triangles OSMesa drew 27 hemi-cubes a second of any size, and rays
 * 200 of 64 pixels across, 80 of 128, 15 of 256 (tests/bench/kernels). */
static const double GL_TRIANGLE_S = 3e-7, RAY_PIXEL_S = 4e-7;

item_backend quality_choose_backend(const bake_options *o, size_t triangles) {
    double pixels = 3.0 * o->hemicube * o->hemicube;
    bool rays_win = GL_TRIANGLE_S * (double)triangles > RAY_PIXEL_S * pixels;
    if (o->visibility != ITEM_BACKEND_DEFAULT) return o->visibility;
    return rays_win && item_backend_is_there(ITEM_BACKEND_RAYS) ? ITEM_BACKEND_RAYS : ITEM_BACKEND_DEFAULT;
}

bool quality_needs_rows(const bake_options *o) {
    return o->keeps_rows || o->bounces != 0 || o->open_distance > 0.0;
}

/* The option by which sizes of columns are asked for, the first of them as the command calls it; NULL: none is. */
static const char *asked_size(const bake_options *o) {
    return o->element_size > 0.0      ? "--element-size"
           : o->patch_size > 0.0      ? "--patch-size"
           : o->adapt_levels < 0      ? "--uniform"
           : o->adapt_levels > 0      ? "--refine-levels"
           : o->hemicube > 0          ? "--hemicube"
           : o->hemicube_light > 0    ? "--hemicube-light"
           : o->unshot_target > 0.0   ? "--unshot"
           : o->light_tolerance > 0.0 ? "--light-tolerance"
                                      : NULL;
}

static const char PANES[] =
    "surfaces let light through, which rows solve%s: here elements are not adapted to the light, the error estimate "
    "does not know of it, and what is transmitted diffusely is left out";

solver_method quality_choose_method(const bake_options *o, size_t shooter_count, size_t emitting, bool far_lights,
                                    bool transmits, char said[QUALITY_LINE_SIZE]) {
    const char *asked = asked_size(o);
    const bool is_open = o->method == SOLVER_AUTO, has_rays = rays_are_there();
    const bool suits_rows = far_lights || shooter_count > SHOOTERS_OF_ROWS || emitting > EMITTERS_OF_ROWS;
    solver_method method = !is_open ? o->method : SOLVER_HYBRID;
    if (is_open && has_rays && (transmits || quality_needs_rows(o) || (suits_rows && !asked))) method = SOLVER_ROWS;
    *said = '\0';
    if (transmits && method != SOLVER_ROWS)
        snprintf(said, QUALITY_LINE_SIZE, PANES,
                 has_rays ? " (--method auto or rows)" : ", and this build is without Embree");
    else if (is_open && method == SOLVER_ROWS && o->keeps_rows && !transmits && (!suits_rows || asked))
        snprintf(
            said, QUALITY_LINE_SIZE,
            "groups of lights and kept rows are of rows, so --method auto takes those where it would take columns");
    else if (is_open && has_rays && suits_rows && method != SOLVER_ROWS)
        snprintf(said, QUALITY_LINE_SIZE,
                 "%s is for columns, so --method auto takes them where it would take rows: leave it out or ask for "
                 "--method rows, or for --method hybrid if columns are meant",
                 asked);
    return method;
}

void quality_resolve(bake_options *o, double scene_area, double scale) {
    if (o->quality == QUALITY_DEFAULT) o->quality = QUALITY_MEDIUM;
    const double level = o->fineness.level > 0.0 ? o->fineness.level : o->quality;
    const preset p = o->method == SOLVER_ROWS ? preset_of_rows(o) : preset_between(level);
    if (!(scale > 0.0)) scale = 1.0;
    o->adapting_is_given = o->adapt_levels != 0 || o->adapt_error > 0.0;
    resolve_levels(o, &p);
    resolve_decimation(o, &p);
    resolve_sizes(o, &p, scene_area, scale);
    o->unshot_is_given = o->unshot_target > 0.0;
    o->light_tolerance_is_given = o->light_tolerance > 0.0;
    o->hemicube = even(o->hemicube, p.hemicube);
    o->hemicube_light = even(o->hemicube_light, p.hemicube_light);
    if (!o->unshot_is_given) o->unshot_target = p.unshot_target;
    if (!o->light_tolerance_is_given) o->light_tolerance = LIGHT_TOLERANCE;
    if (o->memory_limit == 0) o->memory_limit = MEMORY_LIMIT;
    if (o->proxy_error == 0.0) o->proxy_error = o->method == SOLVER_ROWS ? PROXY_ERROR_OF_ROWS : PROXY_ERROR;
    if (o->cluster_angle == 0.0) o->cluster_angle = CLUSTER_ANGLE;
    if (o->max_elements == 0) o->max_elements = MAX_ELEMENTS;
    o->light_depth = PRESETS.light_depth[p.quality];
    o->patch_depth = PRESETS.patch_depth[p.quality];
    o->rows_initial = PRESETS.rows_initial[p.quality];
    o->rows_emitter = p.emitter_rays;
    o->rows_noise = p.noise / sqrt(scale);
    o->check_points = (size_t)lround(p.check_points);
    o->check_hemicube = (int)even(0, p.check_hemicube);
    o->direct_light = PRESETS.direct_light[p.quality];
}

double quality_stand_in_size(const bake_options *o) {
    double elements = o->method == SOLVER_ROWS ? o->fineness.elements : 0.0;
    return o->element_size * (elements > 0.0 ? fmin(sqrt(elements), 1.0) : 1.0);
}

/* An apartment of 72,000 faces has 290,000 elements at draft where 20,000 are meant, and 192,000 of 1.4 times the size,
 * at the same error; of twice the size the error is a fifth more. */
static const double CROWDED = 2.5, COARSENING_MOST = 1.41421356237309505;

/* Where a goal has fewer elements than draft: past so many times as many as are meant, an apartment of 72,000 faces has
 * 131,000 where 1,000 are meant, is off by 12 %, and takes two thirds of draft's time. */
static const double CROWDED_OF_GOAL = 10.0;

/* Elements of the ground under 10,000 houses were 27 m wide, and each had parts of four houses and their streets: 17 %
 * off by the sky, and 12 of the size of the houses, for a third more time. No smaller than half of what they were, and
 * not past so much of a crowd: 40,000 houses would take three times as long. */
static const double LARGER_THAN_COMMON = 1.5, FINER_MOST = 0.5, CROWDED_MOST = 10.0;

static bool is_coarser_than_draft(const bake_options *o) {
    return o->fineness.elements > 0.0 && o->fineness.elements < 1.0;
}

static double coarsening(double crowding) {
    return fmin(fmax(sqrt(crowding / CROWDED), 1.0), COARSENING_MOST);
}

/* Most elements are a triangle each, so that there are as many at any size. */
void quality_fit_crowd(bake_options *o, double crowding) {
    double *meant = &o->fineness.elements;
    o->is_crowded = crowding > CROWDED;
    o->is_packed = crowding > CROWDED_MOST;
    if (is_coarser_than_draft(o)) {
        double more = fmin(fmax(crowding / CROWDED_OF_GOAL, 1.0), 1.0 / *meant);
        *meant *= more, crowding /= more;
        o->element_size /= sqrt(more);
    }
    if (!is_coarser_than_draft(o)) o->element_size *= coarsening(crowding);
}

void quality_fit_common(bake_options *o, double common_size) {
    double least = fmax(LARGER_THAN_COMMON * common_size, FINER_MOST * o->element_size);
    if (!is_coarser_than_draft(o) && !o->is_packed) o->element_size = fmin(o->element_size, least);
}

void quality_resolve_even(bake_options *o) {
    o->even_levels = 0;
    while (!quality_compares(o) && o->method != SOLVER_ROWS && o->adapt_levels == 0 &&
           2 * o->element_size * ELEMENTS_OF_AN_EDGE <= o->patch_size)
        o->element_size *= 2, o->even_levels++;
}
