/* SPDX-License-Identifier: MIT
 * Do shadow rays find the little of a large lamp that is close, and what a slot lets through of it, does light come
 * once from where two lamps lie in one place, do more rays go to where a lamp is seen in part, and is each of very many
 * punctual lights given its share?
 */
#include "base/sobol.h"
#include "check.h"
#include "geometry/polygon.h"
#include "room.h"
#include "solver/row_allocation.h"
#include "solver/row_emitters.h"
#include "visibility/mesh_items.h"
#include "visibility/rays.h"

#include <math.h>

/* Irradiance of all samples, of rays rays each, and of lights what arrives; to be freed. */
static double *gather_with(const room *r, int ray_count, const lights *crowd, double *lights_w) {
    char message[160] = "";
    arena memory = { .memory = NULL };
    mesh_items items;
    jobs *j = jobs_create(2);
    double *irradiance = calloc(3 * r->mesh.sample_count + 1, sizeof *irradiance);
    double *difference = calloc(3 * r->mesh.sample_count + 1, sizeof *difference);
    CHECK(mesh_items_create(&r->scene, &r->mesh, MESH_ELEMENTS, &memory, &items));
    rays *cast = rays_create(&r->scene, &items, message, sizeof message);
    CHECK(cast);
    const row_emitters_setup setup = { .scene = &r->scene,
                                       .mesh = &r->mesh,
                                       .rays = cast,
                                       .lights = crowd,
                                       .jobs = j,
                                       .seed = 1,
                                       .ray_count = ray_count,
                                       .irradiance = irradiance,
                                       .half_difference = difference,
                                       .lights_w = lights_w };
    CHECK(cast && row_emitters_gather(&setup));
    rays_destroy(cast);
    jobs_destroy(j);
    arena_free(&memory);
    free(difference);
    return irradiance;
}

static double *gather(const room *r, int ray_count) {
    return gather_with(r, ray_count, NULL, NULL);
}

/* A pool of 40 m by 40 m that glows, 10 cm over it a lid with a hole, and 10 cm over that a square that looks down. */
static void what_is_close_to_a_large_lamp_is_lit_by_what_is_near_of_it(void) {
    const double around[4][2][2] = { { { -20, -20 }, { 20, -0.5 } },
                                     { { -20, 0.5 }, { 20, 20 } },
                                     { { -20, -0.5 }, { -0.5, 0.5 } },
                                     { { 0.5, -0.5 }, { 20, 0.5 } } };
    room r;
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), pool = room_material(&r, 0, 1), black = room_material(&r, 0, 0);
    room_quad(&r, (double[]){ -0.2, 0.2, 0.2 }, (double[]){ 0.4, 0, 0 }, (double[]){ 0, -0.4, 0 }, white, 1, 4);
    room_quad(&r, (double[]){ -20, -20, 0 }, (double[]){ 40, 0, 0 }, (double[]){ 0, 40, 0 }, pool, 1, 1);
    for (int i = 0; i < 4; i++) {
        const double *low = around[i][0], *high = around[i][1];
        room_sheet(&r, (double[]){ low[0], low[1], 0.1 }, (double[]){ high[0] - low[0], 0, 0 },
                   (double[]){ 0, high[1] - low[1], 0 }, black, 1, 1);
    }
    room_finish(&r);
    double *irradiance = gather(&r, 16), worst = 0.0, sum = 0.0, exact_sum = 0.0;
    const polygon hole = { .corner = { { -0.5, -0.5, 0.1 }, { 0.5, -0.5, 0.1 }, { 0.5, 0.5, 0.1 }, { -0.5, 0.5, 0.1 } },
                           .count = 4 };
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        const double at[3] = { r.mesh.x[s], r.mesh.y[s], r.mesh.z[s] };
        double exact = fabs(polygon_factor(&hole, at, (double[]){ 0, 0, -1 }));
        worst = fmax(worst, fabs(irradiance[3 * s] / exact - 1));
        sum += irradiance[3 * s], exact_sum += exact;
    }
    printf("close to a pool: off by %.2f %% at worst, all of it by %.2f %%\n", 100 * worst,
           100 * (sum / exact_sum - 1));
    CHECK_NEAR(sum, exact_sum, 0.01 * exact_sum);
    CHECK(worst < 0.1);
    free(irradiance);
    room_free(&r);
}

/* A lid with a slot of 1 cm half a metre before a square: one ray in 120 gets through. */
static void what_a_slot_lets_through_of_a_lamp_is_no_luck_of_a_few_rays(void) {
    room r;
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1), black = room_material(&r, 0, 0);
    room_quad(&r, (double[]){ -0.2, 0.2, 0.6 }, (double[]){ 0.4, 0, 0 }, (double[]){ 0, -0.4, 0 }, white, 1, 8);
    room_quad(&r, (double[]){ -20, -20, 0 }, (double[]){ 40, 0, 0 }, (double[]){ 0, 40, 0 }, lamp, 1, 1);
    for (int i = 0; i < 2; i++)
        room_sheet(&r, (double[]){ i ? 0.005 : -20, -20, 0.1 }, (double[]){ 19.995, 0, 0 }, (double[]){ 0, 40, 0 },
                   black, 1, 1);
    room_finish(&r);
    double *irradiance = gather(&r, 8), off = 0.0, level = 0.0;
    const polygon slot = {
        .corner = { { -0.005, -20, 0.1 }, { 0.005, -20, 0.1 }, { 0.005, 20, 0.1 }, { -0.005, 20, 0.1 } }, .count = 4
    };
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        const double at[3] = { r.mesh.x[s], r.mesh.y[s], r.mesh.z[s] };
        double exact = fabs(polygon_factor(&slot, at, (double[]){ 0, 0, -1 })), d = irradiance[3 * s] - exact;
        off += d * d, level += exact * exact;
    }
    printf("behind a slot: samples are off by %.0f %%\n", 100 * sqrt(off / level));
    CHECK(sqrt(off / level) < 1.0); /* eight rays of each sample are off by six times that */
    free(irradiance);
    room_free(&r);
}

static void lamps_in_one_place_shine_once(void) {
    room r;
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, white, 1, 4);
    for (int i = 0; i < 2; i++)
        room_quad(&r, (double[]){ 0, 1, 0.5 }, (double[]){ 1, 0, 0 }, (double[]){ 0, -1, 0 }, lamp, 1, 1);
    room_finish(&r);
    double *irradiance = gather(&r, 16), sum = 0.0;
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++)
        sum += r.mesh.sample_area[s] * irradiance[3 * s];
    /* Unit squares half a metre apart [Hamilton52]. */
    CHECK_NEAR(sum, 0.41525302, 0.01 * 0.41525302);
    free(irradiance);
    room_free(&r);
}

/* 256 elements: the first half is sure of its light; of the rest the noise is four times as much in the last quarter.
 */
static void rays_are_shared_out_by_noise(void) {
    enum { N = 16, ALL = N * N };
    room r;
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), black = room_material(&r, 0, 0);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, white, 1, N);
    room_quad(&r, (double[]){ 0, 0, 1 }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 }, black, 1, N);
    room_finish(&r);
    double *half = calloc(3 * r.mesh.sample_count, sizeof *half), samples = 0.0, further = 0.0;
    uint16_t times[2 * ALL];
    for (uint32_t e = 0; e < r.mesh.element_count; e++)
        for (uint32_t i = 0; i < 3 * (uint32_t)element_corner_count(&r.mesh.elements[e]); i++)
            half[3 * r.mesh.elements[e].first_sample + i] = e % ALL < ALL / 2       ? 0.0
                                                            : e % ALL < ALL * 3 / 4 ? 0.01
                                                                                    : 0.04;
    CHECK(row_allocation_repeat(&r.mesh, half, 1.0, times));
    for (uint32_t e = 0; e < r.mesh.element_count; e++) {
        int corners = element_corner_count(&r.mesh.elements[e]);
        samples += corners, further += corners * times[e];
        CHECK(e < ALL || times[e] == 0); /* what is black shows no noise */
    }
    /* 512 elements' worth goes to 64 and to 64, of four times the noise: 1.6 and 6.4 times. */
    printf("further rays: %g times as many; %d, %d, %d times\n", further / samples, times[ALL / 4], times[ALL * 5 / 8],
           times[ALL * 7 / 8]);
    CHECK_NEAR(further, samples, 0.1 * samples);
    CHECK_EQUAL(times[ALL / 4], 0);
    CHECK_EQUAL(times[ALL * 5 / 8], 2);
    CHECK_EQUAL(times[ALL * 7 / 8], 6);
    free(half);
    room_free(&r);
}

/* Half a metre over a floor of 4 m a shade hangs below a lamp: one part in ten of the floor is in the shade's edge. */
static void edges_of_shadows_have_little_noise(void) {
    room r;
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), lamp = room_material(&r, 0, 1);
    room_quad(&r, (double[]){ -2, -2, 0 }, (double[]){ 4, 0, 0 }, (double[]){ 0, 4, 0 }, white, 1, 32);
    room_quad(&r, (double[]){ -0.1, 0.1, 1 }, (double[]){ 0.2, 0, 0 }, (double[]){ 0, -0.2, 0 }, lamp, 1, 1);
    room_sheet(&r, (double[]){ -0.2, -0.2, 0.5 }, (double[]){ 0.4, 0, 0 }, (double[]){ 0, 0.4, 0 },
               room_material(&r, 0, 0), 1, 1);
    room_finish(&r);
    double *few = gather(&r, 8), *many = gather(&r, 1024), sum = 0.0, square = 0.0;
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        double d = few[3 * s] - many[3 * s];
        sum += d * d, square += many[3 * s] * many[3 * s];
    }
    printf("a shade below a lamp: noise of 8 rays %.2f %%\n", 100 * sqrt(sum / square));
    /* As many further rays for all leave 2.4 % of the 4.9 that there were. */
    CHECK(sqrt(sum / square) < 0.02);
    free(few), free(many);
    room_free(&r);
}

/* Over a square on the floor, all round and in cones, near and far, of which some end before they get there; half of
 * them are behind a sheet a metre over it. */
enum { LIGHTS = 300 };

static void hang_lights(punctual all[LIGHTS]) {
    for (uint32_t i = 0; i < LIGHTS; i++) {
        double place[2];
        sobol_2d(i, 7, place);
        all[i] = (punctual){ .kind = i % 3 == 0 ? PUNCTUAL_SPOT : PUNCTUAL_POINT,
                             .intensity = { 1, i % 2, 2 },
                             .position = { 8 * place[0] - 4, 8 * place[1] - 4, 1.2 + 0.01 * i },
                             .direction = { 0, 0, -1 },
                             .cos_inner = 0.9,
                             .cos_outer = 0.6,
                             .range = i % 5 == 0 ? 2.0 : 0.0 };
    }
}

static void light_exactly(const room *r, const punctual all[LIGHTS], uint32_t s, double E[3]) {
    const double at[3] = { r->mesh.x[s], r->mesh.y[s], r->mesh.z[s] }, up[3] = { 0, 0, 1 };
    double width = sqrt(r->mesh.sample_area[s]), one[3];
    E[0] = E[1] = E[2] = 0.0;
    for (int i = 0; i < LIGHTS; i++) {
        const double *p = all[i].position;
        bool is_hidden = at[0] + (p[0] - at[0]) / p[2] > 0.0;
        if (is_hidden || !punctual_irradiance(&all[i], up, at, width, up, one)) continue;
        for (int c = 0; c < 3; c++) E[c] += one[c];
    }
}

static void each_of_a_crowd_of_lights_gives_its_share(void) {
    room r;
    punctual all[LIGHTS];
    const lights crowd = { .punctual = all, .punctual_count = LIGHTS, .is_crowd = true };
    room_start(&r);
    uint32_t white = room_material(&r, 0.5, 0), black = room_material(&r, 0, 0);
    room_quad(&r, (double[]){ -1, -1, 0 }, (double[]){ 2, 0, 0 }, (double[]){ 0, 2, 0 }, white, 1, 16);
    room_sheet(&r, (double[]){ 0, -9, 1 }, (double[]){ 9, 0, 0 }, (double[]){ 0, 18, 0 }, black, 1, 1);
    room_finish(&r);
    hang_lights(all);
    double arrived_w = 0.0, off = 0.0, level = 0.0, sum[3] = { 0 }, exact_sum[3] = { 0 }, all_w = 0.0;
    double *irradiance = gather_with(&r, 16, &crowd, &arrived_w);
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        double exact[3];
        light_exactly(&r, all, s, exact);
        for (uint32_t c = 0; c < 3; c++) {
            double d = irradiance[3 * s + c] - exact[c];
            off += d * d, level += exact[c] * exact[c];
            sum[c] += irradiance[3 * s + c], exact_sum[c] += exact[c];
            all_w += r.mesh.sample_area[s] * irradiance[3 * s + c];
        }
    }
    printf("under %d lights: samples are off by %.1f %%\n", LIGHTS, 100 * sqrt(off / level));
    CHECK(sqrt(off / level) < 0.15);
    for (int c = 0; c < 3; c++) CHECK_NEAR(sum[c], exact_sum[c], 0.01 * exact_sum[c]);
    CHECK(arrived_w >= all_w * (1 - 1e-9)); /* the sheet has some, too */
    free(irradiance);
    room_free(&r);
}

int main(void) {
    RUN(what_is_close_to_a_large_lamp_is_lit_by_what_is_near_of_it);
    RUN(what_a_slot_lets_through_of_a_lamp_is_no_luck_of_a_few_rays);
    RUN(lamps_in_one_place_shine_once);
    RUN(rays_are_shared_out_by_noise);
    RUN(edges_of_shadows_have_little_noise);
    RUN(each_of_a_crowd_of_lights_gives_its_share);
    return check_end();
}
