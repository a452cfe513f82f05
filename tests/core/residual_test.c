/* SPDX-License-Identifier: MIT
 * Does the residual at random points tell how wrong a solution is? One that is right, and the same made wrong by known
 * amounts in known ways.
 */
#include "check.h"
#include "reconstruct/arrived_light.h"
#include "reconstruct/residual.h"
#include "reconstruct/vertex_fit.h"
#include "room.h"
#include "solver/progressive.h"

#include <time.h>

enum { RESOLUTION = 64, POINTS = 300 };

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A room with a block in it, solved and fitted. */
typedef struct solved {
    room room;
    mesh_items patches;
    jobs *jobs;
    double *samples;
    uint32_t *node;
    vertex_fit_result fit;
} solved;

static bool emits(const solved *s, const patch *p) {
    return scene_emits(&s->room.scene, &s->room.surfaces[p->surface]);
}

static void fit_vertices(solved *s, const double *irradiance) {
    const mesh *m = &s->room.mesh;
    s->samples = malloc(3 * m->sample_count * sizeof *s->samples);
    s->node = malloc(ELEMENT_PLACES * m->element_count * sizeof *s->node);
    for (size_t p = 0; p < m->patch_count; p++) {
        const material *a = &s->room.materials[s->room.surfaces[m->patches[p].surface].material];
        for (uint32_t i = m->patches[p].first_sample; i < m->patches[p].first_sample + m->patches[p].sample_count; i++)
            for (size_t c = 0; c < 3; c++)
                s->samples[3 * (size_t)i + c] = (a->M[c] + a->rho[c] * irradiance[3 * (size_t)i + c]) / PI;
    }
    for (size_t e = 0; e < m->element_count; e++)
        memcpy(s->node + ELEMENT_PLACES * e, m->elements[e].corner, 4 * sizeof *s->node);
    const vertex_fit_input in = {
        .mesh = m, .node = s->node, .node_count = m->vertex_count, .radiance = s->samples, .weight = m->sample_area
    };
    CHECK(vertex_fit(&in, &s->fit));
}

/* The emitter is cut to emitters x emitters patches. */
static void solve(solved *s, unsigned threads, int emitters) {
    room *r = &s->room;
    char message[160] = "";
    progressive_result light;
    room_start(r);
    uint32_t walls = room_material(r, 0.6, 0), emitter = room_material(r, 0.0, 10);
    room_box(r, (double[]){ -2, -2, 0 }, (double[]){ 2, 2, 3 }, true, walls, 3, 4);
    room_box(r, (double[]){ -2. / 3, -2. / 3, 0 }, (double[]){ 2. / 3, 2. / 3, 1 }, false, walls, 1, 4);
    room_quad(r, (double[]){ -0.5, -0.5, 2.9 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, emitter, emitters,
              emitters > 1 ? 1 : 2);
    room_finish(r);
    s->jobs = jobs_create(threads);
    CHECK(mesh_items_create(&r->scene, &r->mesh, MESH_PATCHES, &r->memory, &s->patches));
    progressive_setup setup = { .columns = room_columns(r, RESOLUTION, 3),
                                .jobs = s->jobs,
                                .unshot_target = 1e-5,
                                .start_s = seconds(),
                                .memory_limit = UINT64_C(1) << 30,
                                .clock = seconds };
    CHECK(progressive_solve(&setup, &light, message, sizeof message) == NULL);
    fit_vertices(s, light.irradiance);
    progressive_result_free(&light);
}

static void release(solved *s) {
    free(s->samples);
    free(s->node);
    vertex_fit_free(&s->fit);
    jobs_destroy(s->jobs);
    room_free(&s->room);
}

static residual_result measure_lit(const solved *s, const double *arrived, const lights *from) {
    const residual_setup setup = { .scene = &s->room.scene,
                                   .mesh = &s->room.mesh,
                                   .patches = &s->patches,
                                   .jobs = s->jobs,
                                   .resolution = RESOLUTION,
                                   .weights = s->room.weights,
                                   .seed = 1,
                                   .point_count = POINTS,
                                   .samples = s->samples,
                                   .arrived = arrived,
                                   .lights = from,
                                   .trust = s->room.mesh.sample_area,
                                   .node = s->node,
                                   .colors = s->fit.radiance,
                                   .diagonal = s->fit.diagonal };
    residual_result found;
    char message[160] = "";
    CHECK(residual_measure(&setup, &found, message, sizeof message) == NULL);
    CHECK_TEXT(message, "");
    return found;
}

static residual_result measure(const solved *s) {
    return measure_lit(s, NULL, NULL);
}

/* Multiplies what is shown of each element that does not emit, and what was solved for on it. */
static void distort(solved *s, double even, double odd) {
    const mesh *m = &s->room.mesh;
    bool *done = calloc(m->vertex_count, sizeof *done);
    for (size_t e = 0; e < m->element_count; e++) {
        const element *one = &m->elements[e];
        if (emits(s, &m->patches[one->patch])) continue;
        for (int k = 0; k < element_corner_count(one); k++) {
            uint32_t v = one->corner[k];
            double factor = v & 1 ? odd : even;
            for (size_t c = 0; c < 3; c++) {
                if (!done[v]) s->fit.radiance[3 * (size_t)v + c] *= factor;
                s->samples[3 * ((size_t)one->first_sample + (size_t)k) + c] *= 0.5 * (even + odd);
            }
            done[v] = true;
        }
    }
    free(done);
}

static void a_solution_made_wrong_by_known_amounts_is_found_as_wrong(void) {
    static const struct {
        double even, odd, error;
        const char *what;
    } cases[] = {
        { 1.2, 1.2, 0.2, "a fifth too bright" },
        { 0.7, 0.7, 0.3, "three tenths too dark" },
        /* Neighbouring vertices alternate: linear in between, so a third of the squares. */
        { 1.3, 0.7, 0.3 / 1.7320508, "up and down by three tenths" },
    };
    solved s = { 0 };
    solve(&s, 2, 1);
    residual_result honest = measure(&s);
    printf("as solved: %.4f, bias %+.4f, %zu of %d points\n", honest.error, honest.bias, honest.points, POINTS);
    /* Elements of a third of a metre in a room of four: a few percent. */
    CHECK(honest.error > 0.0 && honest.error < 0.08);
    /* Points under the block do not count; they are a tenth of the floor. */
    CHECK(honest.points > POINTS / 2 && honest.points < POINTS);
    release(&s);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        memset(&s, 0, sizeof s);
        solve(&s, 2, 1);
        distort(&s, cases[i].even, cases[i].odd);
        residual_result found = measure(&s);
        printf("%s: %.4f for %.4f, bias %+.4f\n", cases[i].what, found.error, cases[i].error, found.bias);
        /* What an estimate is asked for: a factor of two. */
        CHECK(found.error < 2 * cases[i].error && found.error > 0.5 * cases[i].error);
        if (cases[i].even == cases[i].odd) CHECK((found.bias > 0.0) == (cases[i].even > 1.0));
        release(&s);
    }
}

static void one_thread_and_three_give_identical_bits(void) {
    residual_result found[2];
    for (int i = 0; i < 2; i++) {
        solved s = { 0 };
        solve(&s, i ? 3 : 1, 1);
        found[i] = measure(&s);
        release(&s);
    }
    CHECK(memcmp(&found[0].error, &found[1].error, sizeof found[0].error) == 0);
    CHECK(memcmp(&found[0].bias, &found[1].bias, sizeof found[0].bias) == 0);
}

/* 18 x 18 are more than are asked for one by one: most are read from the hemi-cubes. */
static void an_emitter_of_very_many_patches_is_estimated_as_one_is(void) {
    residual_result one, many, dark;
    solved s = { 0 };
    solve(&s, 2, 1);
    one = measure(&s);
    release(&s);
    memset(&s, 0, sizeof s);
    solve(&s, 2, 18);
    many = measure(&s);
    distort(&s, 0.7, 0.7);
    dark = measure(&s);
    release(&s);
    printf("one emitter: %.4f, bias %+.4f; 324: %.4f, bias %+.4f\n", one.error, one.bias, many.error, many.bias);
    /* Pixels of 64 x 64 hemi-cubes add their grain, a percent or two, to what an element of a third of a metre is off.
     */
    CHECK(many.error < one.error + 0.03 && many.error > 0.5 * one.error);
    CHECK_NEAR(many.bias, one.bias, 0.02);
    CHECK(dark.error > 0.15 && dark.error < 0.6);
}

/* A light close over a floor of wide elements, and 5 W/m2 of something else: between samples the light is asked for,
 * what else there is is theirs. Where lights are not known it lies between what samples have. */
static void between_samples_lights_are_asked_for(void) {
    room r;
    room_start(&r);
    room_quad(&r, (double[]){ -1, 0, -1 }, (double[]){ 0, 0, 2 }, (double[]){ 2, 0, 0 }, room_material(&r, 0.5, 0), 1,
              4);
    room_finish(&r);
    const punctual light = { .kind = PUNCTUAL_POINT, .intensity = { 3, 2, 1 }, .position = { 0.1, 0.2, 0.15 } };
    const lights all = { .punctual = &light, .punctual_count = 1 };
    const double up[3] = { 0, 1, 0 }, toward[3] = { 0 };
    double *arrived = calloc(3 * r.mesh.sample_count, sizeof *arrived);
    for (size_t s = 0; s < r.mesh.sample_count; s++) {
        const double at[3] = { r.mesh.x[s], r.mesh.y[s], r.mesh.z[s] };
        punctual_irradiance(&light, toward, at, 0.0, up, arrived + 3 * s);
        for (size_t c = 0; c < 3; c++) arrived[3 * s + c] += 5;
    }
    for (int knows = 0; knows < 2; knows++) {
        arrived_light a;
        double off = 0.0;
        CHECK(arrived_light_open(&r.scene, &r.mesh, arrived, knows ? &all : NULL, 1, &a));
        for (size_t e = 0; e < r.mesh.element_count; e++) {
            double middle[3] = { 0 }, exact[3], E[3] = { 0 };
            for (int k = 0; k < 4; k++)
                vec3_add_scaled(middle, middle, 0.25, r.mesh.vertices + 3 * (size_t)r.mesh.elements[e].corner[k]);
            punctual_irradiance(&light, toward, middle, 0.0, up, exact);
            CHECK(arrived_light_add(&a, &r.mesh.elements[e], middle, up, NULL, E));
            for (int c = 0; c < 3; c++) off = fmax(off, fabs(PI * E[c] - 5 - exact[c]) / exact[c]);
        }
        /* Roundings of a sum; between samples a quarter of a metre apart, a light at 0.2 m is off by more. */
        CHECK(knows ? off < 1e-12 : off > 0.1);
        arrived_light_close(&a);
    }
    free(arrived);
    room_free(&r);
}

/* A floor under an even sky of radiance 1, of which so many times as much arrived: what is shown is believed where the
 * sky is not known, and else off by what is too much, times 1 / (1 - rho). Pixels' weights sum to 1 up to rounding, and
 * so does what corners of the fit are off by. */
static void a_sky_is_what_points_see_of_it(void) {
    const lights all = { .sky_is_given = true, .sky_radiance = { 1, 1, 1 }, .has_sky = true };
    const double rho = 0.5;
    for (int times = 1; times <= 3; times++) {
        solved s = { .jobs = jobs_create(1) };
        room_start(&s.room);
        room_quad(&s.room, (double[]){ -1, 0, -1 }, (double[]){ 0, 0, 2 }, (double[]){ 2, 0, 0 },
                  room_material(&s.room, rho, 0), 1, 4);
        room_finish(&s.room);
        CHECK(mesh_items_create(&s.room.scene, &s.room.mesh, MESH_PATCHES, &s.room.memory, &s.patches));
        room_columns(&s.room, RESOLUTION, 3);
        double *arrived = malloc(3 * s.room.mesh.sample_count * sizeof *arrived);
        for (size_t i = 0; i < 3 * s.room.mesh.sample_count; i++) arrived[i] = times * PI;
        fit_vertices(&s, arrived);
        CHECK_NEAR(measure_lit(&s, arrived, NULL).error, 0.0, 1e-9);
        CHECK_NEAR(measure_lit(&s, arrived, &all).error, (times - 1) / (1 - rho), 1e-9);
        free(arrived);
        release(&s);
    }
}

int main(void) {
    RUN(a_sky_is_what_points_see_of_it);
    RUN(a_solution_made_wrong_by_known_amounts_is_found_as_wrong);
    RUN(an_emitter_of_very_many_patches_is_estimated_as_one_is);
    RUN(between_samples_lights_are_asked_for);
    RUN(one_thread_and_three_give_identical_bits);
    return check_end();
}
