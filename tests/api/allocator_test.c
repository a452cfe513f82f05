/* SPDX-License-Identifier: MIT
 * Does a context live on its host's allocator alone? Nothing of the library's own comes from the C library (the linker
 * counts), everything goes back, and whichever request is refused, the host gets HEMI_ERROR_MEMORY and one line.
 *
 *     allocator_test [EVERY]     refuses every EVERYth request of each scenario; without, a few hundred in all
 */
#include "check.h"

#include <hemibake/hemibake.h>

#include <pthread.h>
#include <stdlib.h>

/* ---- what the library takes from malloc and its like (ld --wrap) ----------------------------------------------- */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static volatile size_t strays, strays_before; /* volatile: the compiler knows what malloc does not change */
static volatile bool hosting;                 /* the host's own requests are not counted */

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t bytes);
void *__real_aligned_alloc(size_t alignment, size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t bytes);
void *__wrap_aligned_alloc(size_t alignment, size_t bytes);

static void count_stray(void) {
    pthread_mutex_lock(&lock);
    strays += hosting;
    pthread_mutex_unlock(&lock);
}

void *__wrap_malloc(size_t bytes) {
    count_stray();
    return __real_malloc(bytes);
}

void *__wrap_calloc(size_t count, size_t size) {
    count_stray();
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t bytes) {
    count_stray();
    return __real_realloc(block, bytes);
}

void *__wrap_aligned_alloc(size_t alignment, size_t bytes) {
    count_stray();
    return __real_aligned_alloc(alignment, bytes);
}

/* ---- a host that counts, and refuses ---------------------------------------------------------------------------- */

typedef struct counting {
    size_t requests, live; /* blocks that were asked for; that have not come back */
    size_t first, refused; /* the request from which on: */
    bool for_good;         /* all are refused, not that one alone */
    int errors;
    char text[256];
} counting;

static bool refuses(counting *c) {
    c->requests++;
    bool no = c->first && (c->for_good ? c->requests >= c->first : c->requests == c->first);
    c->refused += no;
    return no;
}

static void *count_alloc(void *user, size_t bytes) {
    counting *c = user;
    pthread_mutex_lock(&lock);
    void *block = refuses(c) ? NULL : __real_malloc(bytes);
    c->live += block != NULL;
    pthread_mutex_unlock(&lock);
    return block;
}

static void *count_realloc(void *user, void *block, size_t bytes) {
    counting *c = user;
    pthread_mutex_lock(&lock);
    void *out = refuses(c) ? NULL : __real_realloc(block, bytes);
    pthread_mutex_unlock(&lock);
    return out;
}

static void count_free(void *user, void *block) {
    counting *c = user;
    pthread_mutex_lock(&lock);
    c->live--;
    free(block);
    pthread_mutex_unlock(&lock);
}

static void listen(void *user, hemi_log_level level, const char *text) {
    counting *c = user;
    if (level != HEMI_LOG_ERROR) return;
    c->errors++;
    snprintf(c->text, sizeof c->text, "%s", text);
}

/* ---- scenarios -------------------------------------------------------------------------------------------------- */

static const uint32_t QUAD[6] = { 0, 1, 2, 0, 2, 3 };
static const float FLOOR[12] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
static const float EMITTER[12] = { 0, 0, 1, 0, 1, 1, 1, 1, 1, 1, 0, 1 };
static const float SHELF[12] = { 0, 0, 0.5f, 0.5f, 0, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0.5f, 0.5f };

static void halve(void *user, const double *attributes, uint32_t corner_count, hemi_texture_mean *out) {
    (void)user, (void)corner_count;
    for (int c = 0; c < 3; c++) out->reflectance[c] *= 0.5 + 0.5 * (attributes[0] > 0.5);
}

static hemi_result add_quad(hemi_scene *scene, const float *positions, double emission, const hemi_mesh_desc *like) {
    hemi_material_desc material = { .struct_size = sizeof material, .reflectance = { 0.6, 0.5, 0.4 } };
    hemi_mesh_desc mesh = like ? *like : (hemi_mesh_desc){ 0 };
    mesh.struct_size = sizeof mesh, mesh.name = "quad", mesh.positions = positions, mesh.indices = QUAD;
    mesh.vertex_count = 4, mesh.triangle_count = 2;
    material.emission[1] = emission;
    material.double_sided = true;
    hemi_result result = hemi_scene_add_material(scene, &material, &mesh.material);
    return result == HEMI_OK ? hemi_scene_add_mesh(scene, &mesh, NULL) : result;
}

static hemi_result add_lights(hemi_scene *scene) {
    const float texels[6] = { 1, 1, 1, 0.1f, 0.2f, 0.3f };
    const hemi_light_desc light = { .struct_size = sizeof light,
                                    .intensity = { 1, 1, 1 },
                                    .position = { 0.7, 0.4, 2 } };
    const hemi_sky_desc sky = {
        .struct_size = sizeof sky, .radiance = { 1, 1, 1 }, .image = texels, .width = 1, .height = 2
    };
    hemi_result result = hemi_scene_add_light(scene, &light, NULL);
    return result == HEMI_OK ? hemi_scene_set_sky(scene, &sky) : result;
}

/* A textured floor, an emitter, and a shelf that is subdivided; lights and a sky if wanted. */
static hemi_result add_scene(hemi_scene *scene, bool lights) {
    const float attributes[4] = { 0, 1, 0, 1 };
    const hemi_mesh_desc textured = { .attributes = attributes, .attribute_count = 1, .texture = halve };
    const hemi_subdivision_desc how = { .struct_size = sizeof how,
                                        .scheme = HEMI_SUBDIVISION_CATMULL_CLARK,
                                        .level = 1 };
    const hemi_mesh_desc cage = { .attributes = attributes, .attribute_count = 1, .subdivision = &how };
    hemi_result result = add_quad(scene, FLOOR, 0.0, &textured);
    if (result == HEMI_OK) result = add_quad(scene, EMITTER, 1.0, NULL);
    if (result == HEMI_OK) result = add_quad(scene, SHELF, 0.0, &cage);
    return result == HEMI_OK && lights ? add_lights(scene) : result;
}

/* The sum of the radiance that is shown, to compare bakes by. */
static double shown(const hemi_solution *solution) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 3; i++) {
        hemi_mesh_view view = { .struct_size = sizeof view };
        if (hemi_solution_mesh(solution, i, &view) != HEMI_OK) return NAN;
        for (size_t k = 0; k < 3 * (size_t)view.vertex_count; k++) sum += view.radiance[k];
    }
    return sum;
}

static hemi_result bake(hemi_context *context, hemi_method method, bool lights, double *out) {
    const hemi_bake_desc wish = { .struct_size = sizeof wish,
                                  .quality = HEMI_QUALITY_DRAFT,
                                  .method = method,
                                  .element_size = 0.5,
                                  .patch_size = 1.0,
                                  .hemicube = 16,
                                  .hemicube_light = 16 };
    hemi_scene *scene = NULL;
    hemi_solution *solution = NULL;
    hemi_result result = hemi_scene_create(context, &scene);
    if (result == HEMI_OK) result = add_scene(scene, lights);
    if (result == HEMI_OK) result = hemi_bake(scene, &wish, &solution);
    if (result == HEMI_OK) *out = shown(solution);
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    return result;
}

static hemi_result bake_hybrid(hemi_context *context, double *out) {
    return bake(context, HEMI_METHOD_HYBRID, true, out);
}

static hemi_result bake_pixels(hemi_context *context, double *out) {
    return bake(context, HEMI_METHOD_PR, false, out);
}

static hemi_result bake_rows(hemi_context *context, double *out) {
    return bake(context, HEMI_METHOD_ROWS, true, out);
}

static hemi_result bake_matrix(hemi_context *context, double *out) {
    return bake(context, HEMI_METHOD_FM, false, out);
}

static hemi_result draw(hemi_context *context, double *out) {
    const float colors[12] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1 };
    const hemi_picture_mesh mesh = { FLOOR, colors, QUAD, 4, 2 };
    const hemi_picture_desc desc = {
        .struct_size = sizeof desc, .meshes = &mesh, .mesh_count = 1, .width = 16, .height = 16, .draw_backs = true
    };
    float pixels[4 * 16 * 16] = { 0 };
    hemi_result result = hemi_picture(context, &desc, pixels);
    *out = 0.0;
    for (int i = 0; i < 4 * 16 * 16; i++) *out += pixels[i];
    return result;
}

/* The shelf stands between floor and emitter, so visible parts are cut too. */
static hemi_result find_factors(hemi_context *context, double *out) {
    double positions[36];
    for (int i = 0; i < 12; i++) positions[i] = FLOOR[i], positions[12 + i] = EMITTER[i], positions[24 + i] = SHELF[i];
    const int32_t corners[12] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 };
    const hemi_factors_desc desc = { .struct_size = sizeof desc,
                                     .positions = positions,
                                     .vertex_count = 12,
                                     .corners = corners,
                                     .polygon_count = 3,
                                     .tolerance = 1e-3 };
    hemi_factors factors = { .struct_size = sizeof factors };
    hemi_result result = hemi_factors_compute(context, &desc, &factors);
    *out = result == HEMI_OK ? factors.factors[1] : 0.0;
    if (result == HEMI_OK) hemi_factors_free(&factors);
    return result;
}

static const struct scenario {
    const char *name;
    hemi_result (*run)(hemi_context *context, double *out);
    size_t trials; /* about how many requests are refused, one in each trial: bakes are slow */
} SCENARIOS[] = {
    { "hybrid", bake_hybrid, 40 }, { "rows", bake_rows, 30 }, { "pr", bake_pixels, 15 },
    { "fm", bake_matrix, 15 },     { "picture", draw, 60 },   { "factors", find_factors, 60 },
};

enum { SCENARIO_COUNT = sizeof SCENARIOS / sizeof *SCENARIOS };

/* NULL counting: the C library's allocator. */
static hemi_result run(const struct scenario *s, counting *c, uint32_t threads, double *out) {
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = threads };
    hemi_context *context = NULL;
    if (c) {
        desc.log = listen;
        desc.log_user = c;
        desc.allocator = (hemi_allocator){ count_alloc, count_realloc, count_free, c };
    }
    strays_before = strays;
    hosting = c != NULL;
    hemi_result result = hemi_context_create(&desc, &context);
    if (result == HEMI_OK) result = s->run(context, out);
    hemi_context_destroy(context);
    hosting = false;
    return result;
}

/* ---- tests ------------------------------------------------------------------------------------------------------ */

static void everything_comes_from_the_host_and_goes_back(void) {
    for (int i = 0; i < SCENARIO_COUNT; i++) {
        counting c = { 0 };
        double with = 0.0, without = 0.0;
        CHECK_EQUAL(run(&SCENARIOS[i], &c, 2, &with), HEMI_OK);
        CHECK_EQUAL(strays - strays_before, 0);
        CHECK(c.requests > 5);
        CHECK_EQUAL(c.live, 0);
        CHECK_EQUAL(run(&SCENARIOS[i], NULL, 1, &without), HEMI_OK);
        CHECK(with != 0.0);
        CHECK_NEAR(with, without, 0.0); /* where memory lies changes no bit */
        printf("%s: %zu requests, %zu past the host\n", SCENARIOS[i].name, c.requests, strays - strays_before);
    }
}

/* That --wrap counts at all. */
static void the_counter_of_strays_counts(void) {
    size_t before = strays;
    hosting = true;
    void *volatile block = malloc(1);
    hosting = false;
    free(block);
    CHECK_EQUAL(strays, before + 1);
}

static size_t every;

/* Of the first requests of a context one is for devices that are warmed while the scene is described, and done without.
 */
enum { DISPENSABLE = 5 };

/* With one thread the same requests come in every run. With two, a worker that finds nothing left to do asks for less,
 * so a late request may never come. */
static void refuse_one(const struct scenario *s, size_t first, bool for_good, uint32_t threads, double whole) {
    counting c = { .first = first, .for_good = for_good };
    double out = 0.0;
    hemi_result result = run(s, &c, threads, &out);
    bool came = c.refused > 0 || threads == 1;
    if (result == HEMI_OK && came && first <= DISPENSABLE) {
        CHECK_NEAR(out, whole, 0.0);
        CHECK_EQUAL(c.live, 0);
        return;
    }
    if (result != (came ? HEMI_ERROR_MEMORY : HEMI_OK) || c.live > 0)
        fprintf(stderr, "%s, request %zu%s, %u threads:\n", s->name, first, for_good ? " and later" : "", threads);
    CHECK_EQUAL(result, came ? HEMI_ERROR_MEMORY : HEMI_OK);
    CHECK_EQUAL(c.live, 0);
    if (!came) return;
    CHECK(c.refused > 0);
    CHECK(c.errors == 1 || (c.errors == 0 && first <= 3)); /* a context that was never made has no log */
    if (c.errors) CHECK_TEXT(c.text, "out of memory");
}

static void a_request_that_is_refused_is_an_error_and_nothing_worse(void) {
    for (int i = 0; i < SCENARIO_COUNT; i++) {
        counting whole = { 0 };
        double out;
        CHECK_EQUAL(run(&SCENARIOS[i], &whole, 1, &out), HEMI_OK);
        size_t step = every ? every : whole.requests / SCENARIOS[i].trials + 1, trials = 0;
        for (size_t first = 1; first <= whole.requests; first += step, trials++) {
            refuse_one(&SCENARIOS[i], first, false, trials % 4 == 3 ? 2 : 1, out);
            if (trials % 4 == 0) refuse_one(&SCENARIOS[i], first, true, 2, out);
        }
        printf("%s: %zu of %zu requests refused\n", SCENARIOS[i].name, trials, whole.requests);
    }
}

static void half_an_allocator_is_refused(void) {
    counting c = { 0 };
    hemi_context *context = NULL;
    hemi_context_desc desc = { .struct_size = sizeof desc, .allocator = { .alloc = count_alloc, .user = &c } };
    CHECK_EQUAL(hemi_context_create(&desc, &context), HEMI_ERROR_ARGUMENT);
    desc.allocator = (hemi_allocator){ .realloc = count_realloc, .free = count_free };
    CHECK_EQUAL(hemi_context_create(&desc, &context), HEMI_ERROR_ARGUMENT);
    CHECK(context == NULL);
    CHECK_EQUAL(c.requests, 0);
}

static void a_context_goes_on_after_it_ran_out(void) {
    counting c = { .first = 12 };
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 1 };
    hemi_context *context = NULL;
    double out = 0.0;
    desc.allocator = (hemi_allocator){ count_alloc, count_realloc, count_free, &c };
    CHECK_EQUAL(hemi_context_create(&desc, &context), HEMI_OK);
    CHECK_EQUAL(draw(context, &out), HEMI_ERROR_MEMORY);
    CHECK_EQUAL(draw(context, &out), HEMI_OK);
    hemi_context_destroy(context);
    CHECK_EQUAL(c.live, 0);
}

int main(int argc, char **argv) {
    every = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 0;
    RUN(the_counter_of_strays_counts);
    RUN(everything_comes_from_the_host_and_goes_back);
    RUN(a_request_that_is_refused_is_an_error_and_nothing_worse);
    RUN(half_an_allocator_is_refused);
    RUN(a_context_goes_on_after_it_ran_out);
    return check_end();
}
