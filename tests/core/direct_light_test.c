/* SPDX-License-Identifier: MIT
 * Does light that no surface emits arrive as the closed forms say, and nowhere else?
 */
#include "base/sobol.h"
#include "base/splitmix.h"
#include "check.h"
#include "light/direct_light.h"
#include "light/point_light.h"
#include "room.h"
#include "solver/progressive.h"

#include <time.h>

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- scenes: y is up, floors face up ---- */

static const double WHITE[3] = { 1, 1, 1 };

static void make_floor(room *r, double half, int elements) {
    room_start(r);
    room_quad(r, (double[]){ -half, 0, -half }, (double[]){ 0, 0, 2 * half }, (double[]){ 2 * half, 0, 0 },
              room_material(r, 0.5, 0), 1, elements);
}

static direct_light arrive(room *r, const punctual *lights, size_t count, const sky *s, unsigned threads,
                           int resolution) {
    direct_light out;
    char message[160] = "";
    jobs *j = jobs_create(threads);
    direct_light_setup setup = { .scene = &r->scene,
                                 .mesh = &r->mesh,
                                 .items = &r->items,
                                 .triangle_surface = r->triangle_surface,
                                 .lights = lights,
                                 .light_count = count,
                                 .sky = s,
                                 .resolution = resolution,
                                 .resolution_sky = resolution,
                                 .sun_directions = 64,
                                 .jobs = j };
    const char *failure = direct_light_compute(&setup, &out, message, sizeof message);
    if (failure) fprintf(stderr, "direct_light: %s\n", failure);
    CHECK(failure == NULL);
    jobs_destroy(j);
    return out;
}

static sky even_sky(double radiance, int fineness) {
    sky s;
    CHECK(sky_create(NULL, (double[]){ radiance, radiance, radiance }, NULL, fineness, &s));
    return s;
}

static punctual point_light(double x, double y, double z, double intensity) {
    return (punctual){ .kind = PUNCTUAL_POINT, .intensity = { intensity, 2 * intensity, 0 }, .position = { x, y, z } };
}

static punctual sun_light(double x, double y, double z, double lux, double diameter) {
    punctual sun = { .kind = PUNCTUAL_DIRECTIONAL,
                     .intensity = { lux, lux, lux },
                     .direction = { x, y, z },
                     .angular_diameter = diameter };
    vec3_normalize(sun.direction);
    return sun;
}

/* ---- lights ---- */

static void a_point_light_gives_I_cos_by_r_squared(void) {
    room r;
    make_floor(&r, 3, 12);
    room_finish(&r);
    punctual light = point_light(0.3, 1.7, -0.4, 50);
    direct_light a = arrive(&r, &light, 1, NULL, 2, 64);
    for (size_t s = 0; s < r.mesh.sample_count; s++) {
        double dx = r.mesh.x[s] - 0.3, dz = r.mesh.z[s] + 0.4, rr = dx * dx + 1.7 * 1.7 + dz * dz;
        double E = 50 * 1.7 / sqrt(rr) / rr;
        /* The same formula in another order: a few roundings. */
        CHECK_NEAR(a.irradiance[3 * s], E, 1e-13 * E);
        CHECK_NEAR(a.irradiance[3 * s + 1], 2 * E, 2e-13 * E);
        CHECK_NEAR(a.irradiance[3 * s + 2], 0, 0);
    }
    direct_light_free(&a);
    room_free(&r);
}

/* A block on a floor under a point light, a spot and a sun, asked of surfaces and drawn. A sample that the edge of a
 * shadow crosses has the mean of what it stands for: its place may lie in the light where half of that does not, but
 * all of them together have as much. */
static void a_point_gets_what_a_sample_there_got(size_t count, double diameter) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -2, 0, -2 }, (double[]){ 0, 0, 4 }, (double[]){ 4, 0, 0 }, grey, 1, 16);
    room_box(&r, (double[]){ -0.3, 0, -0.2 }, (double[]){ 0.4, 0.6, 0.5 }, false, grey, 1, 4);
    room_finish(&r);
    punctual lights[] = { point_light(1.1, 1.3, 0.2, 40), point_light(-1, 1.5, -0.7, 30),
                          sun_light(1, -2, 0.7, 20, diameter) };
    lights[1].kind = PUNCTUAL_SPOT, lights[1].cos_inner = cos(0.5), lights[1].cos_outer = cos(0.7);
    vec3_copy(lights[1].direction, (double[]){ 0.6, -0.8, 0 });
    direct_light a = arrive(&r, lights, count, NULL, 2, 256);
    surface_bvh *opaque = surface_bvh_create(&r.scene);
    const point_lights how = { &r.scene, &r.mesh, opaque, lights, count, 64 };
    size_t lit = 0, shaded = 0, crossed = 0;
    double of_points = 0.0, of_samples = 0.0;
    CHECK(opaque && point_lights_paths(&how) == (diameter > 0.0 ? 66 : count));
    for (uint32_t p = 0; p < r.mesh.patch_count; p++)
        for (uint32_t s = r.mesh.patches[p].first_sample;
             s < r.mesh.patches[p].first_sample + r.mesh.patches[p].sample_count; s++) {
            const double at[3] = { r.mesh.x[s], r.mesh.y[s], r.mesh.z[s] };
            const surface *f = &r.scene.surfaces[r.mesh.patches[p].surface];
            const lit_point one = { p, at, f->normal, sqrt(r.mesh.sample_area[s]) };
            double E[3];
            CHECK(point_lights_irradiance(&how, &one, NULL, E));
            crossed += fabs(E[0] - a.irradiance[3 * (size_t)s]) > 1e-6 * (1 + E[0]);
            of_points += r.mesh.sample_area[s] * E[0],
                of_samples += r.mesh.sample_area[s] * a.irradiance[3 * (size_t)s];
            lit += E[0] > 20, shaded += E[0] == 0;
        }
    CHECK(lit > 0 && shaded > 0 && crossed > 0 && (diameter > 0.0 || 7 * crossed < r.mesh.sample_count));
    CHECK_NEAR(of_samples, of_points, 0.01 * of_points);
    surface_bvh_destroy(opaque);
    direct_light_free(&a);
    room_free(&r);
}

static void a_point_gets_what_a_sample_there_got_of_sharp_lights(void) {
    a_point_gets_what_a_sample_there_got(2, 0.0);
}

static void all_points_get_what_all_samples_got_of_a_sun(void) {
    a_point_gets_what_a_sample_there_got(3, 0.0);
    a_point_gets_what_a_sample_there_got(3, 0.1);
}

/* A slat of one element, 1 m across, under a sun overhead: a sheet above it hides so much of it. Samples in the middles
 * of its quarters would be lit as by 0, a half or 1. */
static void of_an_element_that_a_shadow_runs_across_as_much_is_lit_as_is(void) {
    for (double hidden = 0.1; hidden < 1.0; hidden += 0.2)
        for (int corners = 3; corners <= 4; corners++) {
            room r;
            double sum = 0.0, area = 0.0;
            room_start(&r);
            uint32_t grey = room_material(&r, 0.5, 0);
            room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, (double[]){ 1, 0, 0 }, grey, 1,
                      corners == 3 ? 2 : 1);
            room_quad(&r, (double[]){ -1, 1, -1 }, (double[]){ 0, 0, 3 }, (double[]){ 1 + hidden, 0, 0 }, grey, 1, 1);
            room_finish(&r);
            const punctual sun = sun_light(0, -1, 0, 10, 0.001);
            direct_light a = arrive(&r, &sun, 1, NULL, 1, 256);
            for (size_t s = 0; s < r.mesh.sample_count; s++)
                if (r.mesh.y[s] < 0.5)
                    sum += r.mesh.sample_area[s] * a.irradiance[3 * s], area += r.mesh.sample_area[s];
            /* 64 directions, a net: off by a sixty-fourth or two. */
            CHECK_NEAR(sum / area, 10 * (1 - hidden), 10 * 0.03);
            direct_light_free(&a);
            room_free(&r);
        }
}

/* Places of what the samples of a triangle and a quad stand for lie evenly: their means are those of the parts, which
 * are a third and a quarter of the area, and all together that of the element. */
static void places_of_what_a_sample_stands_for_lie_evenly(void) {
    static double vertices[] = { 0, 0, 0, 2, 0, 0, 2, 3, 0, 0, 3, 0 };
    const mesh m = { .vertices = vertices };
    for (int corners = 3; corners <= 4; corners++) {
        const element e = { .corner = { 0, 1, 2, corners == 3 ? NO_INDEX : 3 } };
        double all[2] = { 0, 0 };
        for (int k = 0; k < corners; k++) {
            double mean[3] = { 0, 0, 0 }, part[3] = { 0, 0, 0 }, at[3];
            for (int i = 0; i < 64; i++)
                for (int j = 0; j < 64; j++) {
                    mesh_sample_part(&m, &e, k, (double[]){ (i + 0.5) / 64, (j + 0.5) / 64 }, at);
                    vec3_add_scaled(mean, mean, 1.0 / 4096, at);
                }
            /* The quarter's middle; of a triangle the part's centroid has 22, 7 and 7 thirty-sixths of the corners. */
            for (int i = 0; i < corners; i++) {
                const double w = corners == 3 ? (i == 0 ? 22.0 : 7.0) / 36 : (double[]){ 9, 3, 1, 3 }[i] / 16;
                vec3_add_scaled(part, part, w, vertices + 3 * ((k + i) % corners));
            }
            for (int c = 0; c < 2; c++) {
                CHECK_NEAR(mean[c], part[c], 2e-3);
                all[c] += mean[c] / corners;
            }
        }
        CHECK_NEAR(all[0], corners == 3 ? 4.0 / 3 : 1.0, 1e-3);
        CHECK_NEAR(all[1], corners == 3 ? 1.0 : 1.5, 1e-3);
    }
}

/* ---- what is hidden in samples ---- */

static void make_shaded_floor(room *r, int elements);

/* Whatever scrambles them. */
static void two_places_to_a_box_are_found(void) {
    for (uint32_t count = 2, halvings = 0; count <= 256; count *= 2, halvings++) {
        const double wide = 1u << (halvings + 1) / 2, high = 1u << halvings / 2;
        const uint32_t beside = sobol_neighbour(count);
        CHECK(beside >= count / 2 && beside < count);
        for (uint32_t i = 0; i < count; i++)
            for (uint64_t seed = 0; seed < 3; seed++) {
                double a[2], b[2];
                sobol_2d(i, splitmix(seed), a), sobol_2d(i ^ beside, splitmix(seed), b);
                CHECK(floor(a[0] * wide) == floor(b[0] * wide) && floor(a[1] * high) == floor(b[1] * high));
            }
    }
}

/* Sums over samples. */
typedef struct variances {
    double said;     /* of what differs within what each stands for */
    double is;       /* the same of a sharp edge at 0.1 across parts that are 9/10 as wide as those */
    double if_sharp; /* if all that is half lit were so by a sharp edge */
} variances;

static variances sum_variances(int elements, double diameter) {
    room r;
    make_shaded_floor(&r, elements);
    punctual sun = sun_light(0, -1, 0, 1, diameter);
    direct_light a = arrive(&r, &sun, 1, NULL, 2, 256);
    const double half = 0.9 / elements; /* the floor is 4 m wide, and samples half as wide as elements */
    variances out = { 0 };
    for (uint32_t s = 0; a.uneven && s < r.mesh.patches[0].sample_count; s++) {
        if (r.mesh.z[s] < 0.2 + half + diameter) continue;
        const double seen = fmin(fmax(0.5 + (0.1 - r.mesh.x[s]) / (2 * half), 0.0), 1.0), E = a.irradiance[3 * s];
        out.said += (double)a.uneven[s], out.is += seen * (1.0 - seen), out.if_sharp += E * (1.0 - E);
        /* Cosines over the disc differ a little. */
        if (fabs(r.mesh.x[s] - 0.1) > half + diameter) CHECK_NEAR((double)a.uneven[s], 0.0, 2e-3);
    }
    CHECK(a.uneven);
    direct_light_free(&a);
    room_free(&r);
    return out;
}

/* Though the directions of its disc give a third more and less. */
static void a_floor_that_the_sun_grazes_is_even(void) {
    room r;
    make_floor(&r, 2, 6);
    room_finish(&r);
    punctual sun = sun_light(-1, -0.3, 0.2, 10, 0.15);
    direct_light a = arrive(&r, &sun, 1, NULL, 2, 256);
    CHECK(a.uneven && a.irradiance[0] > 1.0);
    for (uint32_t s = 0; a.uneven && s < r.mesh.sample_count; s++) CHECK_NEAR((double)a.uneven[s], 0.0, 0);
    direct_light_free(&a);
    room_free(&r);
}

/* Of a sharp edge all of it is said, and of one that is blurred over eight samples hardly any. */
static void what_differs_within_a_sample_is_known_from_what_is_half_in_the_sun(void) {
    for (int has_disc = 0; has_disc < 2; has_disc++) {
        variances sharp = sum_variances(10, has_disc ? 1e-4 : 0.0);
        CHECK(sharp.is > 1.0);
        CHECK_NEAR(sharp.said / sharp.is, 1.0, 0.15);
    }
    variances blurred = sum_variances(40, 0.4);
    CHECK(blurred.if_sharp > 10.0);
    CHECK_NEAR(blurred.said / blurred.if_sharp, 0.0, 0.1);
}

static void a_light_below_the_floor_gives_its_front_nothing(void) {
    room r;
    make_floor(&r, 1, 4);
    room_finish(&r);
    punctual lights[] = { point_light(0, -1, 0, 50), sun_light(0, 1, 0, 5, 0) };
    direct_light a = arrive(&r, lights, 2, NULL, 1, 64);
    for (size_t s = 0; s < 3 * r.mesh.sample_count; s++) CHECK_NEAR(a.irradiance[s], 0, 0);
    direct_light_free(&a);
    room_free(&r);
}

static void a_spot_fades_between_its_cones(void) {
    room r;
    make_floor(&r, 3, 24);
    room_finish(&r);
    punctual light = point_light(0, 2, 0, 10);
    light.kind = PUNCTUAL_SPOT;
    vec3_copy(light.direction, (double[]){ 0, -1, 0 });
    light.cos_inner = cos(0.3);
    light.cos_outer = cos(0.6);
    direct_light a = arrive(&r, &light, 1, NULL, 1, 64);
    int zones[3] = { 0, 0, 0 };
    for (size_t s = 0; s < r.mesh.sample_count; s++) {
        double rr = r.mesh.x[s] * r.mesh.x[s] + 4 + r.mesh.z[s] * r.mesh.z[s], cosine = 2 / sqrt(rr);
        /* KHR_lights_punctual, "Inner and Outer Cone Angles" */
        double t = fmin(fmax((cosine - cos(0.6)) / (cos(0.3) - cos(0.6)), 0), 1);
        CHECK_NEAR(a.irradiance[3 * s], 10 * cosine / rr * t * t, 1e-12);
        zones[t == 0 ? 0 : t < 1 ? 1 : 2]++;
    }
    CHECK(zones[0] > 0 && zones[1] > 0 && zones[2] > 0);
    direct_light_free(&a);
    room_free(&r);
}

/* A circle of 12 cm on elements of 50: wherever it falls the floor gets what goes into the cone. */
static void a_spot_narrower_than_elements_gives_all_its_light(void) {
    const double at[][2] = { { 0.0, 0.0 }, { 0.1, 0.2 }, { -0.33, 0.41 }, { 0.25, 0.25 } };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        room r;
        double flux = 0.0;
        make_floor(&r, 2, 8);
        room_finish(&r);
        punctual light = point_light(at[i][0], 2, at[i][1], 10);
        light.kind = PUNCTUAL_SPOT;
        vec3_copy(light.direction, (double[]){ 0, -1, 0 });
        light.cos_inner = light.cos_outer = cos(0.06);
        direct_light a = arrive(&r, &light, 1, NULL, 1, 64);
        for (size_t s = 0; s < r.mesh.sample_count; s++) flux += a.irradiance[3 * s] * r.mesh.sample_area[s];
        /* Squares around samples tile a floor only about: they are turned another way. */
        CHECK_NEAR(flux, 10 * 2 * PI * (1 - cos(0.06)), 0.15 * 10 * 2 * PI * (1 - cos(0.06)));
        direct_light_free(&a);
        room_free(&r);
    }
}

/* Two rows to the sides of the aim and four columns about it: what lies between them is their mean by angles. */
static void a_profile_is_read_between_its_directions(void) {
    const float profile[] = { 6, 6, 6, 6, 2, 4, 8, 10, 0, 0, 0, 0 };
    punctual light = point_light(0, 0, 0, 1);
    light.profile = profile, light.profile_rows = 3, light.profile_columns = 4;
    vec3_copy(light.direction, (double[]){ 0, -1, 0 });
    punctual_set_aside(&light, (double[]){ 1, -5, 0 });
    CHECK_NEAR(light.aside[0][0], 1, 1e-15); /* square to the aim */
    const struct {
        double away[3], expected;
    } to[] = { { { 0, -1, 0 }, 6 }, { { 0, 1, 0 }, 0 },  { { 1, 0, 0 }, 2 },  { { -1, 0, 0 }, 8 }, { { 1, -1, 0 }, 4 },
               { { -1, 1, 0 }, 4 }, { { 0, 0, -1 }, 4 }, { { 0, 0, 1 }, 10 }, /* a quarter turn on, as columns run */
               { { 1, 0, -1 }, 3 }, { { 1, 0, 1 }, 6 } };
    for (size_t i = 0; i < sizeof to / sizeof *to; i++) {
        double E[3], away[3], facing[3];
        vec3_copy(away, to[i].away);
        vec3_normalize(away);
        for (int k = 0; k < 3; k++) facing[k] = -away[k];
        punctual_irradiance(&light, facing, away, 0.0, facing, E); /* at one metre */
        CHECK_NEAR(E[0], to[i].expected, 1e-12);
    }
}

static void a_range_ends_the_light(void) {
    room r;
    make_floor(&r, 3, 12);
    room_finish(&r);
    punctual light = point_light(0, 1, 0, 10);
    light.range = 2;
    direct_light a = arrive(&r, &light, 1, NULL, 1, 64);
    for (size_t s = 0; s < r.mesh.sample_count; s++) {
        double rr = r.mesh.x[s] * r.mesh.x[s] + 1 + r.mesh.z[s] * r.mesh.z[s];
        CHECK_NEAR(a.irradiance[3 * s], 10 / sqrt(rr) / rr * fmax(1 - rr * rr / 16, 0), 1e-12);
    }
    direct_light_free(&a);
    room_free(&r);
}

static void a_directional_light_gives_lux_times_cosine_on_a_tilted_plane(void) {
    room r;
    room_start(&r);
    /* Its normal leans by 30 degrees. */
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 1 }, (double[]){ cos(PI / 6), -sin(PI / 6), 0 },
              room_material(&r, 0.5, 0), 1, 3);
    room_finish(&r);
    punctual sun = sun_light(0, -1, 0, 7, 0);
    direct_light a = arrive(&r, &sun, 1, NULL, 1, 64);
    for (size_t s = 0; s < 3 * r.mesh.sample_count; s++) CHECK_NEAR(a.irradiance[s], 7 * cos(PI / 6), 1e-13);
    CHECK_NEAR(a.punctual_w, 3 * 7 * cos(PI / 6), 1e-12);
    direct_light_free(&a);
    room_free(&r);
}

/* ---- shadows ---- */

/* Two surfaces back to back in one plane, as a sign or leaves have, each of its own patches, before a sun and a lamp.
 */
static void neither_of_two_skins_is_in_the_shade_of_the_other(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -1, 0, 0 }, (double[]){ 2, 0, 0 }, (double[]){ 0, 2, 0 }, grey, 2, 4);
    room_quad(&r, (double[]){ -1, 0, 0 }, (double[]){ 0, 2, 0 }, (double[]){ 2, 0, 0 }, grey, 1, 4);
    room_finish(&r);
    const punctual lights[] = { sun_light(0, -1, -1, 8, 0), point_light(0.3, 1.2, 2, 50) };
    for (size_t k = 0; k < 2; k++) {
        direct_light a = arrive(&r, &lights[k], 1, NULL, 1, 64);
        size_t lit = 0;
        for (uint32_t p = 0; p < r.mesh.patch_count; p++)
            for (uint32_t i = 0; i < r.mesh.patches[p].sample_count; i++) {
                double E = a.irradiance[3 * ((size_t)r.mesh.patches[p].first_sample + i)];
                bool is_front = r.mesh.patches[p].surface == 0;
                CHECK(is_front == (E > 0.0));
                if (k == 0) CHECK_NEAR(E, is_front ? 8 * sqrt(0.5) : 0.0, 1e-9);
                lit += is_front;
            }
        CHECK(lit > 0);
        direct_light_free(&a);
    }
    room_free(&r);
}

/* A sheet at y = 1 over the quarter x > 0.1, z > 0.2 of a floor. */
static void make_shaded_floor(room *r, int elements) {
    make_floor(r, 2, elements);
    room_sheet(r, (double[]){ 0.1, 1, 0.2 }, (double[]){ 0, 0, 10 }, (double[]){ 10, 0, 0 }, 0, 1, 1);
    room_finish(r);
}

/* Of the part that a sample of a floor 4 m wide stands for, 9/10 of it across: how much lies beyond two edges? */
static double hidden_share(const mesh *m, uint32_t s, int elements, double edge_x, double edge_z) {
    const double width = 2 * 0.9 / elements;
    return fmin(fmax(0.5 + (m->x[s] - edge_x) / width, 0.0), 1.0) *
           fmin(fmax(0.5 + (m->z[s] - edge_z) / width, 0.0), 1.0);
}

static void the_shadow_of_a_point_light_ends_where_geometry_says(void) {
    room r;
    make_shaded_floor(&r, 48);
    punctual light = point_light(0, 3, 0, 10);
    direct_light a = arrive(&r, &light, 1, NULL, 2, 96);
    int dark = 0, crossed = 0;
    uint32_t floor_samples = r.mesh.patches[0].sample_count;
    for (uint32_t s = 0; s < floor_samples; s++) {
        /* From height 3 through height 1 to 0: 3/2 times as far. */
        const double hidden = hidden_share(&r.mesh, s, 48, 0.15, 0.3);
        const double full = 10 * 3 / pow(r.mesh.x[s] * r.mesh.x[s] + r.mesh.z[s] * r.mesh.z[s] + 9, 1.5);
        bool is_crossed = hidden > 0.0 && hidden < 1.0;
        /* 8 places, a net. */
        CHECK_NEAR(a.irradiance[3 * s] / full, 1.0 - hidden, is_crossed ? 2.0 / 8 : 1e-12);
        dark += hidden == 1.0, crossed += is_crossed;
    }
    CHECK(dark > 1000 && dark < (int)floor_samples / 2 && crossed > 20);
    direct_light_free(&a);
    room_free(&r);
}

static void the_shadow_of_a_directional_light_ends_where_geometry_says(void) {
    room r;
    make_shaded_floor(&r, 48);
    punctual sun = sun_light(-1, -2, -0.5, 10, 0);
    direct_light a = arrive(&r, &sun, 1, NULL, 2, 96);
    const double full = 10 * 2 / sqrt(1 + 4 + 0.25);
    int dark = 0, crossed = 0;
    for (uint32_t s = 0; s < r.mesh.patches[0].sample_count; s++) {
        const double hidden = hidden_share(&r.mesh, s, 48, 0.1 - 0.5, 0.2 - 0.25);
        bool is_crossed = hidden > 0.0 && hidden < 1.0;
        /* 32 places, a net. */
        CHECK_NEAR(a.irradiance[3 * s] / full, 1.0 - hidden, is_crossed ? 3.0 / 32 : 1e-12);
        dark += hidden == 1.0, crossed += is_crossed;
    }
    CHECK(dark > 1000 && crossed > 100);
    direct_light_free(&a);
    room_free(&r);
}

/* One light, and more patches than one thread looks at: they share them, and what is in the sun stays so. */
static void threads_that_look_from_one_light_together_see_what_one_does(void) {
    static const unsigned threads[] = { 1, 2, 5 };
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ -2, 0, -2 }, (double[]){ 0, 0, 4 }, (double[]){ 4, 0, 0 }, grey, 48, 1);
    room_sheet(&r, (double[]){ 0.1, 1, 0.2 }, (double[]){ 0, 0, 10 }, (double[]){ 10, 0, 0 }, 0, 1, 1);
    room_finish(&r);
    CHECK(r.mesh.patch_count > 2000);
    punctual sun = sun_light(-1, -2, -0.5, 10, 0);
    direct_light of[3];
    for (int i = 0; i < 3; i++) of[i] = arrive(&r, &sun, 1, NULL, threads[i], 96);
    int lit = 0, dark = 0;
    for (size_t s = 0; s < r.mesh.sample_count; s++)
        lit += of[0].irradiance[3 * s] > 0.0, dark += !(of[0].irradiance[3 * s] > 0.0);
    CHECK(lit > 1000 && dark > 1000);
    for (int i = 1; i < 3; i++)
        CHECK(memcmp(of[i].irradiance, of[0].irradiance, 3 * r.mesh.sample_count * sizeof *of[0].irradiance) == 0);
    for (int i = 0; i < 3; i++) direct_light_free(&of[i]);
    room_free(&r);
}

static void the_sun_casts_a_penumbra_as_wide_as_its_disc(void) {
    room r;
    make_shaded_floor(&r, 96);
    const double diameter = 0.2;
    punctual sun = sun_light(0, -1, 0, 10, diameter);
    direct_light a = arrive(&r, &sun, 1, NULL, 2, 256);
    double half = tan(0.5 * diameter);
    for (uint32_t s = 0; s < r.mesh.patches[0].sample_count; s++) {
        double x = (0.1 - r.mesh.x[s]) / half, E = a.irradiance[3 * s];
        if (r.mesh.z[s] < 0.2 + half) continue;
        /* The part of a disc on one side of a chord. */
        double seen = x <= -1 ? 0 : x >= 1 ? 1 : 0.5 + (x * sqrt(1 - x * x) + asin(x)) / PI;
        /* 64 directions on a spiral of golden angles count the area of a segment to within three of them; cosines over
         * the disc are within 0.5 % of 1. */
        CHECK_NEAR(E / 10, seen, 3.0 / 64 + 0.005);
    }
    direct_light_free(&a);
    room_free(&r);
}

static void nothing_arrives_in_a_closed_room(void) {
    for (int kind = 0; kind < 2; kind++) {
        room r;
        room_start(&r);
        uint32_t grey = room_material(&r, 0.5, 0);
        if (kind == 0)
            room_box(&r, (double[]){ -1, 0, -2 }, (double[]){ 3, 2.5, 2 }, true, grey, 2, 4);
        else
            room_sphere(&r, (double[]){ 1, 2, 3 }, 2, true, grey, 16, 12, 3);
        room_finish(&r);
        sky s = even_sky(1, 2);
        punctual sun = sun_light(-1, -2, -0.5, 10, 0.01);
        direct_light a = arrive(&r, &sun, 1, &s, 2, 256);
        /* Along the silhouette of a sphere several facets share a pixel, whose id is that of one; where light grazes
         * them a facet may miss what hides it. Of pi and of the sun's 10: */
        double leak = kind == 0 ? 0.0 : 1e-3 * PI;
        for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) CHECK_NEAR(a.irradiance[i], 0, leak);
        direct_light_free(&a);
        sky_free(&s);
        room_free(&r);
    }
}

/* ---- sky ---- */

static void the_sky_has_as_many_patches_as_tregenza_and_reinhart_say(void) {
    CHECK_EQUAL(sky_patch_count(1), 2 * 145);
    CHECK_EQUAL(sky_patch_count(2), 2 * 577);
    CHECK_EQUAL(sky_patch_count(4), 2 * 2305);
}

static void the_patches_of_an_even_sky_fill_the_sphere(void) {
    for (int fineness = 1; fineness <= 4; fineness++) {
        sky s = even_sky(1, fineness);
        double flux = 0, moment[3] = { 0, 0, 0 };
        for (size_t i = 0; i < s.patch_count; i++) {
            flux += s.patches[i].flux[0];
            vec3_add_scaled(moment, moment, s.patches[i].flux[0], s.patches[i].mean[0]);
            /* Looked at inside itself: nearer to its mean than its corners are, about 0.71 of its width; the cap of
             * the finer skies is wider than the rest. */
            CHECK(vec3_distance(s.patches[i].toward, s.patches[i].mean[0]) < 2.0 * s.patches[i].half + 0.01);
        }
        /* Sums of 290 to 4610 doubles. */
        CHECK_NEAR(flux, 4 * PI, 1e-12);
        CHECK_NEAR(vec3_length(moment), 0, 1e-12);
        sky_free(&s);
    }
}

static void an_open_floor_under_an_even_sky_gets_pi_L(void) {
    for (int fineness = 1; fineness <= 2; fineness++) {
        room r;
        make_floor(&r, 3, 6);
        room_finish(&r);
        sky s = even_sky(2, fineness);
        direct_light a = arrive(&r, NULL, 0, &s, 2, 64);
        for (size_t i = 0; i < r.mesh.sample_count; i++) {
            /* Integrals are exact patch by patch; the lowest row counts by the rule for patches that a horizon cuts,
             * half of whose width is a mean of its sides. Measured: 5e-4. */
            CHECK_NEAR(a.irradiance[3 * i], 2 * PI, 1e-3 * 2 * PI);
            CHECK_NEAR(a.row_sum[i], 1, 0.05);
        }
        CHECK_NEAR(a.sky_w, 3 * 36 * 2 * PI, 1e-3 * 3 * 36 * 2 * PI);
        direct_light_free(&a);
        sky_free(&s);
        room_free(&r);
    }
}

static void a_tilted_plane_under_an_even_sky_gets_pi_L_as_well(void) {
    for (int k = 0; k < 7; k++) {
        room r;
        room_start(&r);
        double tilt = PI * k / 7, turn = 1.1 * k;
        room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ -sin(turn), 0, cos(turn) },
                  (double[]){ cos(turn) * cos(tilt), -sin(tilt), sin(turn) * cos(tilt) }, room_material(&r, 0.5, 0), 1,
                  1);
        room_finish(&r);
        sky s = even_sky(1, 2);
        direct_light a = arrive(&r, NULL, 0, &s, 1, 64);
        /* The horizon cuts some 60 patches; each is seen or not where it looks, which is right in the mean and off by
         * E/flux 0.025 x 0.011 sr x sqrt(60 / 12) = 0.06 % of pi at one sigma. */
        CHECK_NEAR(a.irradiance[0], PI, 0.004 * PI);
        direct_light_free(&a);
        sky_free(&s);
        room_free(&r);
    }
}

static void a_wall_without_end_takes_half_of_the_sky(void) {
    /* A wall along a meridian cuts about 15, 30 and 60 patches, each of which gives all or nothing: one sigma is
     * sqrt(n) / 2 times flux times cosine, 3 %, 1.1 % and 0.4 % of the half sky. */
    const double tolerance[] = { 0.04, 0.015, 0.005 };
    for (int i = 0; i < 3; i++) {
        room r;
        make_floor(&r, 0.01, 1);
        room_quad(&r, (double[]){ -0.02, -50, -50 }, (double[]){ 0, 100, 0 }, (double[]){ 0, 0, 100 },
                  room_material(&r, 0, 0), 1, 1);
        room_finish(&r);
        sky s = even_sky(1, i == 0 ? 1 : 2 * i);
        direct_light a = arrive(&r, NULL, 0, &s, 2, 256);
        for (uint32_t k = 0; k < 4; k++) CHECK_NEAR(a.irradiance[3 * k], PI / 2, tolerance[i] * PI / 2);
        direct_light_free(&a);
        sky_free(&s);
        room_free(&r);
    }
}

static void a_panorama_of_one_colour_is_an_even_sky(void) {
    float image[16 * 8 * 3];
    for (int i = 0; i < 16 * 8 * 3; i++) image[i] = (float)(1 + i % 3);
    const sky_image panorama = { .radiance = image, .width = 16, .height = 8 };
    sky s, even = even_sky(1, 1);
    CHECK(sky_create(NULL, WHITE, &panorama, 1, &s));
    CHECK_EQUAL(s.patch_count, even.patch_count);
    double flux[3] = { 0, 0, 0 };
    for (size_t i = 0; i < s.patch_count; i++)
        for (int c = 0; c < 3; c++) {
            flux[c] += s.patches[i].flux[c];
            /* Texels are put into patches in eighths of their height: off by a fraction of that at the borders. */
            CHECK_NEAR(s.patches[i].flux[c], (1 + c) * even.patches[i].flux[0],
                       0.15 * (1 + c) * even.patches[i].flux[0]);
        }
    for (int c = 0; c < 3; c++) CHECK_NEAR(flux[c], 4 * PI * (1 + c), 1e-5);
    sky_free(&s);
    sky_free(&even);
}

static void a_bright_texel_shines_from_where_it_is(void) {
    enum { W = 256, H = 128 };
    float *image = calloc((size_t)W * H * 3, sizeof *image);
    /* Column 3/4: towards +z. Row: altitude 60 degrees. */
    size_t row = H / 6, texel = 3 * W / 4;
    for (int c = 0; c < 3; c++) image[3 * (row * W + texel) + (size_t)c] = 1000;
    const sky_image panorama = { .radiance = image, .width = W, .height = H };
    sky s;
    CHECK(sky_create(NULL, WHITE, &panorama, 1, &s));
    CHECK(s.patch_count >= 1 && s.patch_count <= 4);
    double high = PI * (0.5 - (double)row / H), low = high - PI / H,
           azimuth = 2 * PI * (((double)texel + 0.5) / W - 0.5);
    double flux = 1000 * 2 * PI / W * (sin(high) - sin(low)), altitude = 0.5 * (high + low);
    double toward[3] = { cos(altitude) * cos(azimuth), sin(altitude), cos(altitude) * sin(azimuth) }, sum = 0;
    CHECK(toward[2] > 0.4 && fabs(toward[0]) < 0.02);
    for (size_t i = 0; i < s.patch_count; i++) {
        sum += s.patches[i].flux[0];
        /* The texel is 1.4 degrees wide. */
        CHECK(vec3_distance(s.patches[i].toward, toward) < 0.025);
    }
    CHECK_NEAR(sum, flux, 1e-6 * flux);
    sky_free(&s);
    free(image);
}

/* ---- with the solver ---- */

static void a_box_under_an_even_sky_reflects_rho_pi_L(void) {
    room r;
    progressive_result out;
    char message[160];
    room_start(&r);
    room_box(&r, (double[]){ -1, -1, -1 }, (double[]){ 1, 1, 1 }, false, room_material(&r, 0.6, 0), 2, 2);
    room_finish(&r);
    sky s = even_sky(3, 2);
    direct_light a = arrive(&r, NULL, 0, &s, 2, 128);
    jobs *j = jobs_create(2);
    progressive_setup setup = { .columns = room_columns(&r, 64, 2),
                                .jobs = j,
                                .arrived = a.irradiance,
                                .unshot_target = 1e-6,
                                .memory_limit = UINT64_C(1) << 30,
                                .clock = seconds };
    CHECK(progressive_solve(&setup, &out, message, sizeof message) == NULL);
    for (size_t i = 0; i < r.mesh.sample_count; i++)
        /* B = rho E: nothing comes back from a sky. Tolerance as for open planes; walls have cut patches. */
        CHECK_NEAR(0.6 * out.irradiance[3 * i], 0.6 * PI * 3, 0.004 * 0.6 * PI * 3);
    CHECK_NEAR(energy_residual(&out.books), 0, 1e-6);
    CHECK_NEAR(out.books.emitted, a.sky_w, 1e-9 * a.sky_w);
    CHECK_NEAR(out.books.absorbed, 0.4 * a.sky_w, 1e-9 * a.sky_w);
    progressive_result_free(&out);
    jobs_destroy(j);
    direct_light_free(&a);
    sky_free(&s);
    room_free(&r);
}

static void a_white_furnace_with_a_bulb_is_even_brighter_than_the_bulb(void) {
    room r;
    progressive_result out;
    char message[160];
    room_start(&r);
    room_box(&r, (double[]){ -1, 0, -1 }, (double[]){ 1, 2, 1 }, true, room_material(&r, 0.5, 0), 3, 3);
    room_finish(&r);
    punctual light = point_light(0.1, 1, 0, 4);
    direct_light a = arrive(&r, &light, 1, NULL, 2, 128);
    /* int I dw over all walls of a closed room: 4 pi I; the midpoint rule on 36 x 4 samples a wall. */
    CHECK_NEAR(a.punctual_w, 4 * PI * (4 + 8), 0.01 * 4 * PI * 12);
    jobs *j = jobs_create(2);
    progressive_setup setup = { .columns = room_columns(&r, 64, 2),
                                .jobs = j,
                                .arrived = a.irradiance,
                                .even_shooters = true, /* whose gradients add light that M / (1 - rho) has not */
                                .unshot_target = 1e-6,
                                .memory_limit = UINT64_C(1) << 30,
                                .clock = seconds };
    CHECK(progressive_solve(&setup, &out, message, sizeof message) == NULL);
    double received = 0;
    for (size_t i = 0; i < r.mesh.sample_count; i++) received += out.irradiance[3 * i] * r.mesh.sample_area[i];
    /* Phi / (1 - rho), since rows are closed; 1e-6 is unshot and columns are floats. */
    CHECK_NEAR(received, a.punctual_w / 3 * 2, 1e-5 * a.punctual_w);
    CHECK(out.rows_closed);
    CHECK_NEAR(energy_residual(&out.books), 0, 1e-6);
    CHECK_NEAR(out.books.emitted, a.punctual_w, 1e-9 * a.punctual_w);
    progressive_result_free(&out);
    jobs_destroy(j);
    direct_light_free(&a);
    room_free(&r);
}

static void any_number_of_threads_gives_the_same_bits(void) {
    direct_light a[2];
    room r;
    make_shaded_floor(&r, 12);
    sky s = even_sky(1, 1);
    punctual lights[] = { point_light(0, 3, 0, 10), sun_light(-1, -2, -0.5, 10, 0.1) };
    for (unsigned t = 0; t < 2; t++) a[t] = arrive(&r, lights, 2, &s, 1 + 3 * t, 128);
    CHECK(memcmp(a[0].irradiance, a[1].irradiance, 3 * r.mesh.sample_count * sizeof(double)) == 0);
    CHECK(memcmp(a[0].row_sum, a[1].row_sum, r.mesh.sample_count * sizeof(float)) == 0);
    for (int t = 0; t < 2; t++) direct_light_free(&a[t]);
    sky_free(&s);
    room_free(&r);
}

int main(void) {
    RUN(a_point_light_gives_I_cos_by_r_squared);
    RUN(a_point_gets_what_a_sample_there_got_of_sharp_lights);
    RUN(all_points_get_what_all_samples_got_of_a_sun);
    RUN(of_an_element_that_a_shadow_runs_across_as_much_is_lit_as_is);
    RUN(places_of_what_a_sample_stands_for_lie_evenly);
    RUN(two_places_to_a_box_are_found);
    RUN(a_floor_that_the_sun_grazes_is_even);
    RUN(what_differs_within_a_sample_is_known_from_what_is_half_in_the_sun);
    RUN(a_light_below_the_floor_gives_its_front_nothing);
    RUN(a_spot_fades_between_its_cones);
    RUN(a_spot_narrower_than_elements_gives_all_its_light);
    RUN(a_profile_is_read_between_its_directions);
    RUN(a_range_ends_the_light);
    RUN(a_directional_light_gives_lux_times_cosine_on_a_tilted_plane);
    RUN(neither_of_two_skins_is_in_the_shade_of_the_other);
    RUN(the_shadow_of_a_point_light_ends_where_geometry_says);
    RUN(the_shadow_of_a_directional_light_ends_where_geometry_says);
    RUN(threads_that_look_from_one_light_together_see_what_one_does);
    RUN(the_sun_casts_a_penumbra_as_wide_as_its_disc);
    RUN(nothing_arrives_in_a_closed_room);
    RUN(the_sky_has_as_many_patches_as_tregenza_and_reinhart_say);
    RUN(the_patches_of_an_even_sky_fill_the_sphere);
    RUN(an_open_floor_under_an_even_sky_gets_pi_L);
    RUN(a_tilted_plane_under_an_even_sky_gets_pi_L_as_well);
    RUN(a_wall_without_end_takes_half_of_the_sky);
    RUN(a_panorama_of_one_colour_is_an_even_sky);
    RUN(a_bright_texel_shines_from_where_it_is);
    RUN(a_box_under_an_even_sky_reflects_rho_pi_L);
    RUN(a_white_furnace_with_a_bulb_is_even_brighter_than_the_bulb);
    RUN(any_number_of_threads_gives_the_same_bits);
    return check_end();
}
