/* SPDX-License-Identifier: MIT
 * Do rows of rays give what closed forms and laws say, and say themselves how noisy they are?
 */
#include "check.h"
#include "room.h"
#include "solver/row_allocation.h"
#include "solver/row_gather.h"
#include "solver/rows.h"
#include "visibility/rays.h"

#include <math.h>

/* Irradiance of a room's samples by rows, further rays included, or fewer where they leave no more noise than meant;
 * direct[c] at every one of them. False: it failed. */
static bool solve_enough(const room *r, const lights *l, const double *direct, int first, double further, double noise,
                         uint64_t seed, unsigned threads, rows_result *out) {
    char message[160] = "";
    jobs *j = jobs_create(threads);
    const rows_setup setup = { .scene = &r->scene,
                               .mesh = &r->mesh,
                               .jobs = j,
                               .seed = seed,
                               .initial_rays = first,
                               .adaptive_rays = further,
                               .noise_target = noise,
                               .lights = l,
                               .direct = direct };
    const char *failure = rows_solve(&setup, out, message, sizeof message);
    CHECK(!failure);
    jobs_destroy(j);
    return !failure;
}

static bool solve_further(const room *r, const lights *l, const double *direct, int first, double further,
                          uint64_t seed, unsigned threads, rows_result *out) {
    return solve_enough(r, l, direct, first, further, 0.0, seed, threads, out);
}

static bool solve(const room *r, const lights *l, const double *direct, int first, uint64_t seed, unsigned threads,
                  rows_result *out) {
    return solve_further(r, l, direct, first, 0.0, seed, threads, out);
}

static double *all_samples(const room *r, double value) {
    double *out = malloc((3 * r->mesh.sample_count + 1) * sizeof *out);
    for (size_t i = 0; i < 3 * r->mesh.sample_count; i++) out[i] = value;
    return out;
}

static void a_closed_room_that_is_lit_evenly_settles_at_M_over_1_minus_rho(void) {
    static const double rhos[] = { 0.5, 0.9, 0.99 };
    for (int k = 0; k < 3; k++) {
        room r;
        rows_result out;
        const double M = 2.0, exact = M / (1 - rhos[k]);
        room_start(&r);
        room_box(&r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(&r, rhos[k], 0), 2, 3);
        room_finish(&r);
        double *direct = all_samples(&r, M), worst = 0.0;
        if (solve(&r, &(lights){ 0 }, direct, 16, 1, 2, &out)) {
            for (size_t i = 0; i < 3 * r.mesh.sample_count; i++)
                worst = fmax(worst, fabs(out.irradiance[i] / exact - 1));
            printf("furnace, rho %.2f: worst %.2g, %d iterations\n", rhos[k], worst, out.iterations);
            /* Every ray meets a wall, so there is no noise, and iterations end when 1e-4 is left. */
            CHECK(worst < 3e-4);
            CHECK(out.iterations < 60);
            for (size_t s = 0; s < r.mesh.sample_count; s++) CHECK_NEAR(out.row_sum[s], 1.0, 0.0);
            CHECK_NEAR(out.escaped_w, 0.0, 0.0);
        }
        rows_result_free(&out);
        free(direct);
        room_free(&r);
    }
}

/* After N bounces a furnace has the first terms of the series: M (1 + rho + ... + rho^N). */
static void bounces_are_the_terms_of_the_series(void) {
    static const int asked[] = { -1, 1, 3 }; /* below 0: none */
    for (int k = 0; k < 3; k++) {
        char message[160] = "";
        room r;
        rows_result out;
        const double M = 2.0, rho = 0.5;
        int further = asked[k] < 0 ? 0 : asked[k];
        double exact = M * (1 - pow(rho, further + 1)) / (1 - rho), absorbed = 0.0, area = 0.0, worst = 0.0;
        room_start(&r);
        room_box(&r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(&r, rho, 0), 2, 3);
        room_finish(&r);
        double *direct = all_samples(&r, M);
        jobs *j = jobs_create(2);
        const rows_setup setup = { .scene = &r.scene,
                                   .mesh = &r.mesh,
                                   .jobs = j,
                                   .seed = 1,
                                   .initial_rays = 16,
                                   .adaptive_rays = 1e4,
                                   .lights = &(lights){ 0 },
                                   .direct = direct,
                                   .bounces = asked[k] };
        CHECK(!rows_solve(&setup, &out, message, sizeof message));
        for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) {
            worst = fmax(worst, fabs(out.irradiance[i] / exact - 1));
            area += r.mesh.sample_area[i / 3];
            absorbed += (1 - rho) * exact * r.mesh.sample_area[i / 3];
        }
        /* Every ray meets a wall. */
        CHECK_NEAR(worst, 0.0, 1e-6);
        CHECK_NEAR(out.absorbed_w, absorbed, 1e-6 * absorbed);
        CHECK_NEAR(out.residual_w, M * area - absorbed, 1e-6 * absorbed);
        rows_result_free(&out);
        free(direct);
        jobs_destroy(j);
        room_free(&r);
    }
}

static void a_plane_under_an_even_sky_gets_pi_L(void) {
    room r;
    rows_result out;
    lights l = { .sky_is_given = true, .has_sky = true, .sky_radiance = { 1, 2, 3 } };
    room_start(&r);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, room_material(&r, 0.5, 0), 1, 3);
    room_finish(&r);
    double *direct = all_samples(&r, 0.0);
    if (solve(&r, &l, direct, 16, 1, 1, &out)) {
        for (size_t i = 0; i < 3 * r.mesh.sample_count; i++)
            CHECK_NEAR(out.irradiance[i], PI * (double)(1 + i % 3), 1e-12);
        CHECK_NEAR(out.sky_w, PI * 6, 1e-12);
        /* All that it reflects escapes. */
        CHECK_NEAR(out.escaped_w, 0.5 * PI * 6, 1e-12);
    }
    rows_result_free(&out);
    free(direct);
    room_free(&r);
}

/* Unit squares at a right angle with a common edge: F = 0.20004 [Hamilton52]. One is lit and reflects, one receives. */
/* What looks into the open, where no sky is, is not inside of anything; what looks at a back may be. */
static void rays_that_meet_nothing_count_as_seeing(void) {
    room r;
    rows_result out;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, grey, 1, 2);
    room_quad(&r, (double[]){ 9, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, grey, 1, 2);
    room_quad(&r, (double[]){ 8, -1, 0.01 }, (double[]){ 3, 0, 0 }, (double[]){ 0, 3, 0 }, grey, 1, 2);
    room_finish(&r);
    double *direct = all_samples(&r, 1.0);
    if (solve(&r, &(lights){ 0 }, direct, 64, 1, 2, &out)) {
        const patch *open = &r.mesh.patches[0], *covered = &r.mesh.patches[1];
        for (uint32_t k = 0; k < open->sample_count; k++) CHECK_NEAR(out.row_sum[open->first_sample + k], 1.0, 1e-6);
        for (uint32_t k = 0; k < covered->sample_count; k++) CHECK(out.row_sum[covered->first_sample + k] < 0.1);
        CHECK(out.escaped_w > 0.0);
    }
    rows_result_free(&out);
    free(direct);
    room_free(&r);
}

static void squares_at_a_right_angle_exchange_what_the_closed_form_says(void) {
    room r;
    rows_result coarse, fine;
    const double F = 0.20004377607540316, rho = 0.5;
    room_start(&r);
    uint32_t lit = room_material(&r, rho, 0), black = room_material(&r, 0.0, 0);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, lit, 1, 12);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 }, black, 1, 12);
    room_finish(&r);
    double *direct = all_samples(&r, 0.0), mean = 0.0, off = 0.0, level = 0.0;
    const patch *p = &r.mesh.patches[0], *q = &r.mesh.patches[1];
    for (size_t i = 3 * p->first_sample; i < 3 * (size_t)(p->first_sample + p->sample_count); i++) direct[i] = 1.0;
    if (solve(&r, &(lights){ 0 }, direct, 64, 1, 2, &coarse) && solve(&r, &(lights){ 0 }, direct, 1024, 2, 2, &fine)) {
        for (uint32_t s = q->first_sample; s < q->first_sample + q->sample_count; s++) {
            double d = coarse.irradiance[3 * (size_t)s] - fine.irradiance[3 * (size_t)s];
            mean += r.mesh.sample_area[s] * fine.irradiance[3 * (size_t)s];
            off += r.mesh.sample_area[s] * d * d;
            level += r.mesh.sample_area[s] * fine.irradiance[3 * (size_t)s] * fine.irradiance[3 * (size_t)s];
        }
        printf("right angle: mean %.5f instead of %.5f; 64 rays off by %.2f %%\n", mean / rho, F,
               100 * sqrt(off / level));
        /* 576 samples of 1,024 rays: the binomial error is 0.04 %; squares of a twelfth leave 0.3 % along the edge. */
        CHECK_NEAR(mean / rho, F, 0.005 * F);
        /* Strata halve the binomial error of 64 rays, sqrt(0.8 / 0.2 / 64) = 25 %. */
        CHECK(sqrt(off / level) < 0.15);
    }
    rows_result_free(&coarse);
    rows_result_free(&fine);
    free(direct);
    room_free(&r);
}

/* A box that is lit on its floor alone, so that the walls' light is noisy. */
static void make_lit_floor(room *r, double **direct) {
    room_start(r);
    room_box(r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(r, 0.6, 0), 2, 4);
    room_finish(r);
    *direct = all_samples(r, 0.0);
    for (size_t s = 0; s < r->mesh.sample_count; s++)
        for (size_t c = 0; c < 3 && r->mesh.z[s] < 1e-6; c++) (*direct)[3 * s + c] = 1.0;
}

static void the_halves_of_rows_say_how_noisy_they_are(void) {
    room r;
    double *direct, off = 0.0, level = 0.0;
    rows_result few, many;
    make_lit_floor(&r, &direct);
    if (solve(&r, &(lights){ 0 }, direct, 16, 1, 2, &few) && solve(&r, &(lights){ 0 }, direct, 1024, 2, 2, &many)) {
        for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) {
            double d = few.irradiance[i] - many.irradiance[i], A = r.mesh.sample_area[i / 3];
            off += A * d * d, level += A * many.irradiance[i] * many.irradiance[i];
        }
        printf("noise of 16 rays: %.2f %%, it says %.2f %%\n", 100 * sqrt(off / level), 100 * few.noise);
        /* Stratified halves are noisier than stratified wholes, so it errs on the safe side. */
        CHECK(few.noise > 0.8 * sqrt(off / level) && few.noise < 2.5 * sqrt(off / level));
        CHECK(many.noise < 0.3 * few.noise);
    }
    rows_result_free(&few);
    rows_result_free(&many);
    free(direct);
    room_free(&r);
}

static void threads_change_nothing_and_the_seed_does(void) {
    room r;
    double *direct;
    rows_result one, three, other;
    make_lit_floor(&r, &direct);
    size_t bytes = 3 * r.mesh.sample_count * sizeof *direct;
    if (solve(&r, &(lights){ 0 }, direct, 16, 1, 1, &one) && solve(&r, &(lights){ 0 }, direct, 16, 1, 3, &three) &&
        solve(&r, &(lights){ 0 }, direct, 16, 2, 1, &other)) {
        CHECK(memcmp(one.irradiance, three.irradiance, bytes) == 0);
        CHECK(memcmp(one.irradiance, other.irradiance, bytes) != 0);
    }
    rows_result_free(&one);
    rows_result_free(&three);
    rows_result_free(&other);
    free(direct);
    room_free(&r);
}

static void all_light_is_booked(void) {
    room r;
    double *direct, arrived = 0.0;
    rows_result out;
    make_lit_floor(&r, &direct);
    for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) arrived += r.mesh.sample_area[i / 3] * direct[i];
    if (solve(&r, &(lights){ 0 }, direct, 64, 1, 2, &out)) {
        double missing = arrived - out.absorbed_w - out.escaped_w;
        printf("books: %.2f %% of the light is not accounted for\n", 100 * missing / arrived);
        /* Rows are estimates, each its own: nothing makes what leaves an element arrive somewhere. */
        CHECK(fabs(missing) < 0.01 * arrived);
    }
    rows_result_free(&out);
    free(direct);
    room_free(&r);
}

/* All rays are noisy to a degree; where ten times that will do, a quarter of them are cast, and all where none will. */
static void no_more_rays_are_cast_than_noise_asks_for(void) {
    const double share_of_all[] = { 10.0, 1.4, 0.01 };
    const lights none = { 0 };
    room r;
    double *direct, noise[3];
    rows_result all;
    make_lit_floor(&r, &direct);
    double adaptive = 256.0 * (double)r.mesh.sample_count;
    bool ok = solve_further(&r, &none, direct, 16, adaptive, 1, 2, &all);
    for (int i = 0; ok && i < 3; i++) {
        rows_result some;
        ok = solve_enough(&r, &none, direct, 16, adaptive, share_of_all[i] * all.noise, 1, 2, &some);
        noise[i] = some.noise / all.noise;
        rows_result_free(&some);
    }
    CHECK(ok);
    if (ok) printf("noise where more will do: %.2f, a little more: %.2f, less: %.2f\n", noise[0], noise[1], noise[2]);
    /* By four times the rays noise is halved, or a little less than that where they leave no gaps. */
    CHECK(ok && noise[0] > 1.5 && noise[0] < 4.0);
    CHECK(ok && noise[1] < 1.5 && noise[1] < 0.8 * noise[0]);
    CHECK(ok && noise[2] > 0.8 && noise[2] < 1.2);
    rows_result_free(&all);
    free(direct);
    room_free(&r);
}

/* A black room with a window in its front wall, 20 cm square, under an even sky of radiance 1: the window fills a
 * thousandth of what a sample of the floor sees. */
static void make_window(room *r) {
    static const double low = 1.5, high = 1.7, half = 0.1, side = 3, top = 2.7, back = 4;
    room_start(r);
    uint32_t floor = room_material(r, 0.5, 0), black = room_material(r, 0.0, 0);
    room_quad(r, (double[]){ -side, 0, back }, (double[]){ 2 * side, 0, 0 }, (double[]){ 0, 0, -back }, floor, 1, 12);
    room_quad(r, (double[]){ -side, top, 0 }, (double[]){ 2 * side, 0, 0 }, (double[]){ 0, 0, back }, black, 1, 6);
    room_quad(r, (double[]){ side, 0, 0 }, (double[]){ 0, 0, back }, (double[]){ 0, top, 0 }, black, 1, 6);
    room_quad(r, (double[]){ -side, 0, back }, (double[]){ 0, 0, -back }, (double[]){ 0, top, 0 }, black, 1, 6);
    room_quad(r, (double[]){ side, 0, back }, (double[]){ -2 * side, 0, 0 }, (double[]){ 0, top, 0 }, black, 1, 6);
    room_quad(r, (double[]){ -side, 0, 0 }, (double[]){ 2 * side, 0, 0 }, (double[]){ 0, low, 0 }, black, 1, 4);
    room_quad(r, (double[]){ -side, high, 0 }, (double[]){ 2 * side, 0, 0 }, (double[]){ 0, top - high, 0 }, black, 1,
              4);
    room_quad(r, (double[]){ -side, low, 0 }, (double[]){ side - half, 0, 0 }, (double[]){ 0, high - low, 0 }, black, 1,
              4);
    room_quad(r, (double[]){ half, low, 0 }, (double[]){ side - half, 0, 0 }, (double[]){ 0, high - low, 0 }, black, 1,
              4);
    room_finish(r);
}

/* From a point of the floor to the rectangle in z = 0 from the corner of its foot to (a, b), which stands on the foot
 * of the normal from it: [Howell82], C-11 by parts. */
static double corner_factor(double a, double b, double z) {
    double A = 1 / sqrt(b * b + z * z);
    return (atan(a / z) - z * A * atan(a * A)) / (2 * PI);
}

static double window_factor(double x, double z) {
    return corner_factor(0.1 - x, 1.7, z) - corner_factor(-0.1 - x, 1.7, z) - corner_factor(0.1 - x, 1.5, z) +
           corner_factor(-0.1 - x, 1.5, z);
}

static void a_small_window_is_found_and_lights_the_floor_as_the_closed_form_says(void) {
    room r;
    rows_result out;
    const lights l = { .sky_is_given = true, .has_sky = true, .sky_radiance = { 1, 1, 1 } };
    make_window(&r);
    double *direct = all_samples(&r, 0.0), off = 0.0, level = 0.0, off_mean = 0.0;
    if (solve_further(&r, &l, direct, 16, 3e5, 1, 2, &out)) {
        const patch *p = &r.mesh.patches[0];
        for (uint32_t e = p->first_element; e < p->first_element + p->element_count; e++) {
            double sum = 0.0;
            int corners = element_corner_count(&r.mesh.elements[e]);
            for (int k = 0; k < corners; k++) {
                size_t s = r.mesh.elements[e].first_sample + (size_t)k;
                double F = window_factor(r.mesh.x[s], r.mesh.z[s]), d = out.irradiance[3 * s] / PI - F;
                off += d * d, level += F * F, sum += d;
            }
            off_mean += sum * sum / corners;
        }
        printf("window: samples are off by %.1f %%, it says %.1f %%\n", 100 * sqrt(off / level), 100 * out.noise);
        /* Rays by the cosine alone are off by sqrt(1000 / 500) = 140 %. */
        CHECK(sqrt(off / level) < 0.12);
        CHECK(out.noise > 0.5 * sqrt(off / level) && out.noise < 2.0 * sqrt(off / level));
        /* Samples of an element share one net of rays, which leaves no gaps: of four that know nothing of each other
         * the mean is off by half as much, and by more where all look at the same rings of the window. */
        printf("window: means of elements are off by %.2f of that\n", sqrt(off_mean / off));
        CHECK(off_mean < 0.25 * off);
    }
    rows_result_free(&out);
    free(direct);
    room_free(&r);
}

/* A grey cube, seen from inside. */
static void make_cube(room *r) {
    room_start(r);
    room_box(r, (double[]){ 0, 0, 0 }, (double[]){ 1, 1, 1 }, true, room_material(r, 0.5, 0), 1, 4);
    room_finish(r);
}

/* An element that sees more sky than not, in a group that sees little of it, and one that sees as little. */
static void what_sees_most_of_the_sky_is_not_guided_to_it(void) {
    room r;
    make_cube(&r);
    const size_t count = r.mesh.element_count;
    const double bright = 3.0 * PI, few = 0.05, most = 0.6;
    row_counts *counts = calloc(count, sizeof *counts);
    row_group group = { .target_count = ROW_LOBES_MAX,
                        .mean = few * bright,
                        .variance = few * (1 - few) * bright * bright };
    row_seen *seen = calloc(count, sizeof *seen);
    for (size_t e = 0; e < count; e++) seen[e] = (row_seen){ (float)group.mean, (float)group.variance };
    seen[0] = (row_seen){ (float)(most * bright), (float)(most * (1 - most) * bright * bright) };
    row_guiding guiding = { .of_element = calloc(count, sizeof *guiding.of_element),
                            .element_count = count,
                            .group_count = 1,
                            .groups = &group,
                            .seen = seen };
    const row_rays rows = { .mesh = &r.mesh, .counts = counts };
    row_counts *found = calloc(count, sizeof *found);
    CHECK(row_allocation_share(&rows, &guiding, 64.0 * (double)r.mesh.sample_count, found));
    CHECK(found[0].cosine > 0 && found[0].guided == 0);
    CHECK(found[1].guided > found[1].cosine);
    free(counts);
    free(seen);
    free(guiding.of_element);
    free(found);
    room_free(&r);
}

/* Half of the elements of a room see it evenly lit, half see a ten-thousandth as much, and that through a slot. */
/* What the floor's samples are off by, rms, of what a softbox above gives each of them; *mean: of what they get. */
static double off_under_a_softbox(const room *r, const lights *l, double exact, double *mean) {
    rows_result out;
    double *direct = all_samples(r, 0.0), squares = 0.0;
    *mean = 0.0;
    CHECK(solve_further(r, l, direct, 16, 16.0 * (double)r->mesh.sample_count, 7, 2, &out));
    for (size_t s = 0; s < r->mesh.sample_count; s++) {
        const double off = out.irradiance[3 * s] / exact - 1.0;
        *mean += out.irradiance[3 * s] / (double)r->mesh.sample_count;
        squares += off * off;
    }
    rows_result_free(&out);
    free(direct);
    return sqrt(squares / (double)r->mesh.sample_count);
}

/* A thousandth of the sphere, ten thousand times as bright as the rest. */
static void rays_are_drawn_from_what_is_bright_in_a_panorama(void) {
    enum { WIDTH = 128, HEIGHT = 64, FIRST = 20, LAST = 23 };
    float *texels = malloc(3 * (size_t)WIDTH * HEIGHT * sizeof *texels);
    for (size_t i = 0; i < 3 * (size_t)WIDTH * HEIGHT; i++) {
        const size_t v = i / 3 / WIDTH, u = i / 3 % WIDTH;
        texels[i] = v >= FIRST && v < LAST && u < 3 ? 1e4f : 1.0f;
    }
    lights l = { .sky_is_given = true,
                 .has_sky = true,
                 .sky_radiance = { 1, 1, 1 },
                 .sky_image = { .radiance = texels, .width = WIDTH, .height = HEIGHT } };
    room r;
    room_start(&r);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 0, 0, 3 }, (double[]){ 3, 0, 0 }, room_material(&r, 0.5, 0), 4, 6);
    room_finish(&r);
    /* int cos dw over rows of the box, by the square of the sine of the altitude. */
    const double low = cos(PI * LAST / HEIGHT), high = cos(PI * FIRST / HEIGHT);
    const double exact = PI + (1e4 - 1.0) * (3 * 2 * PI / WIDTH) * 0.5 * (high * high - low * low);
    double mean_by_cones, mean;
    const double by_cones = off_under_a_softbox(&r, &l, exact, &mean_by_cones);
    CHECK(sky_glow_find(NULL, &l.sky_image, &l.glow));
    const double off = off_under_a_softbox(&r, &l, exact, &mean);
    printf("softbox: off by %.2f %%, by cones of its own %.2f %%; the mean by %.2f %%\n", 100 * off, 100 * by_cones,
           100 * (mean / exact - 1.0));
    CHECK(off < 0.3 * by_cones);
    CHECK_NEAR(mean / exact, 1.0, 0.02);
    block_free(l.glow), free(texels);
    room_free(&r);
}

static void a_room_that_is_lit_through_a_slot_has_rays_of_its_own(void) {
    room r;
    make_cube(&r);
    const size_t count = r.mesh.element_count;
    const double each = 64.0, seen_by[2] = { 1.0, 1e-4 }, spread[2] = { 1.0, 1000.0 };
    row_counts *counts = calloc(count, sizeof *counts), *found = calloc(count, sizeof *found);
    row_group groups[2] = { { 0 } };
    row_seen *seen = calloc(count, sizeof *seen);
    uint32_t *of_element = calloc(count, sizeof *of_element);
    for (size_t e = 0; e < count; e++) {
        of_element[e] = e >= count / 2;
        row_group *g = &groups[of_element[e]];
        g->mean = seen_by[of_element[e]], g->variance = spread[of_element[e]] * g->mean * g->mean;
        seen[e] = (row_seen){ (float)g->mean, (float)g->variance };
        counts[e].initial = 32;
    }
    const row_guiding guiding = {
        .of_element = of_element, .element_count = count, .group_count = 2, .groups = groups, .seen = seen
    };
    const row_rays rows = { .mesh = &r.mesh, .counts = counts };
    CHECK(row_allocation_share(&rows, &guiding, each * (double)r.mesh.sample_count, found));
    /* A quarter of all for half of the samples; by the light of the whole the dim half had none. */
    CHECK_NEAR(found[count - 1].cosine, each / 2, 4);
    CHECK(found[0].cosine > 2 * found[count - 1].cosine);
    free(counts);
    free(found);
    free(seen);
    free(of_element);
    room_free(&r);
}

static void further_rays_are_the_same_for_any_number_of_threads(void) {
    room r;
    rows_result one, three;
    const lights l = { .sky_is_given = true, .has_sky = true, .sky_radiance = { 1, 1, 1 } };
    make_window(&r);
    double *direct = all_samples(&r, 0.0);
    if (solve_further(&r, &l, direct, 16, 1e5, 1, 1, &one) && solve_further(&r, &l, direct, 16, 1e5, 1, 3, &three))
        CHECK(memcmp(one.irradiance, three.irradiance, 3 * r.mesh.sample_count * sizeof *direct) == 0);
    rows_result_free(&one);
    rows_result_free(&three);
    free(direct);
    room_free(&r);
}

/* A floor of 1 m under a lamp as large, cut into n x n patches, half a metre above it; a screen as large hides half of
 * that from below, if there is one. What arrives on the floor, its noise, and how far that is from the closed form of
 * what is seen of the lamp, with a seen edge at x = 1/2 at the height of the screen. */
static void give_floor(int patches, bool screen, double *mean, double *noise) {
    room r;
    rows_result out;
    char message[160] = "";
    jobs *j = jobs_create(2);
    room_start(&r);
    uint32_t floor = room_material(&r, 0.5, 0), lamp = room_material(&r, 0.0, 1), black = room_material(&r, 0.0, 0);
    room_quad(&r, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, floor, 1, 8);
    room_quad(&r, (double[]){ 0, 1, 0.5 }, (double[]){ 1, 0, 0 }, (double[]){ 0, -1, 0 }, lamp, patches, 1);
    if (screen) {
        room_quad(&r, (double[]){ -9, -9, 0.499 }, (double[]){ 9.5, 0, 0 }, (double[]){ 0, 18, 0 }, black, 1, 1);
        room_quad(&r, (double[]){ -9, 9, 0.499 }, (double[]){ 9.5, 0, 0 }, (double[]){ 0, -18, 0 }, black, 1, 1);
    }
    room_finish(&r);
    double *direct = all_samples(&r, 0.0);
    const rows_setup setup = { .scene = &r.scene,
                               .mesh = &r.mesh,
                               .jobs = j,
                               .seed = 1,
                               .initial_rays = 16,
                               .lights = &(lights){ 0 },
                               .direct = direct,
                               .emitter_rays = 8 };
    *mean = *noise = 0.0;
    const char *failure = rows_solve(&setup, &out, message, sizeof message);
    CHECK(!failure);
    const patch *p = &r.mesh.patches[0];
    for (uint32_t s = p->first_sample; !failure && s < p->first_sample + p->sample_count; s++)
        *mean += r.mesh.sample_area[s] * out.irradiance[3 * (size_t)s];
    *noise = out.noise;
    rows_result_free(&out);
    free(direct);
    jobs_destroy(j);
    room_free(&r);
}

/* Unit squares half a metre apart: F = 0.41525 [Hamilton52]; half of the lamp: half of it, by symmetry. */
/* What the elements of a box with a lamp receive as parts of themselves; off: from what was solved, relative. */
static void receive_again(unsigned threads, final_gather_result *received, double *off, double *noise) {
    room r;
    rows_result out;
    char message[160] = "";
    jobs *j = jobs_create(threads);
    double difference = 0.0, level = 0.0;
    room_start(&r);
    room_box(&r, (double[]){ 0, 0, 0 }, (double[]){ 3, 2, 2.5 }, true, room_material(&r, 0.7, 0), 2, 4);
    room_quad(&r, (double[]){ 1, 1, 2.4 }, (double[]){ 0, 0.5, 0 }, (double[]){ 0.5, 0, 0 }, room_material(&r, 0.2, 9),
              1, 2);
    room_finish(&r);
    double *direct = all_samples(&r, 0.0);
    uint32_t *roots = malloc(r.mesh.element_count * sizeof *roots);
    for (uint32_t e = 0; e < r.mesh.element_count; e++) roots[e] = e;
    const rows_setup setup = { .scene = &r.scene,
                               .mesh = &r.mesh,
                               .jobs = j,
                               .seed = 4,
                               .initial_rays = 64,
                               .adaptive_rays = 64.0 * (double)r.mesh.sample_count,
                               .lights = &(lights){ 0 },
                               .direct = direct,
                               .emitter_rays = 16,
                               .keeps = true };
    CHECK(!rows_solve(&setup, &out, message, sizeof message) && out.final_gather);
    CHECK(final_gather_solve(out.final_gather, &r.mesh, roots, NULL, NULL, received) && !received->cut);
    for (size_t i = 0; i < 3 * r.mesh.sample_count; i++) {
        double d = received->irradiance[i] - out.irradiance[i];
        difference += d * d, level += out.irradiance[i] * out.irradiance[i];
    }
    *off = sqrt(difference / level);
    *noise = row_noise(&r.mesh, received->irradiance, received->half_difference);
    rows_result_free(&out);
    jobs_destroy(j);
    free(roots);
    free(direct);
    room_free(&r);
}

static void parts_receive_what_they_would_have_got_as_elements(void) {
    final_gather_result one, two;
    double off, off_again, noise;
    receive_again(1, &one, &off, &noise);
    receive_again(2, &two, &off_again, &noise);
    printf("parts: off by %.2f %%, which say %.2f %%\n", 100 * off, 100 * noise);
    /* Rays of their own: both are noisy, and halves say how much. */
    CHECK(off > 0.0 && off < 2.0 * noise && noise < 0.1);
    CHECK(off_again == off && one.irradiance[100] == two.irradiance[100]);
    final_gather_result_free(&one);
    final_gather_result_free(&two);
}

static void emitters_give_what_closed_forms_say(void) {
    const double F = 0.41525302;
    for (int many = 0; many < 2; many++)
        for (int screen = 0; screen < 2; screen++) {
            double mean, noise, exact = screen ? 0.5 * F : F;
            give_floor(many ? 16 : 1, screen, &mean, &noise);
            printf("%s%s: %.5f instead of %.5f; it says samples are off by %.1f %%\n", many ? "256 lamps" : "one lamp",
                   screen ? " behind a screen" : "", mean, exact, 100 * noise);
            /* 256 samples of 8 or 32 rays: a thousand rays or more, the closed form of one lamp but for 64 squares. */
            CHECK_NEAR(mean, exact, (many || screen ? 0.02 : 0.002) * exact);
            CHECK(many || screen || noise < 1e-9);
        }
}

/* The underside of a loft and the floor on it, each with triangles of its own, and nothing between them. */
static void two_skins_in_one_plane_are_each_seen_from_their_front(void) {
    room r;
    mesh_items items;
    char message[160] = "";
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_quad(&r, (double[]){ 0, 0, 0.7 }, (double[]){ 3, 0, 0.3 }, (double[]){ 0, 3, 0.1 }, grey, 1, 3);
    room_quad(&r, (double[]){ 0, 0, 0.7 }, (double[]){ 0, 3, 0.1 }, (double[]){ 3, 0, 0.3 }, grey, 1, 4);
    room_finish(&r);
    CHECK(mesh_items_create(&r.scene, &r.mesh, MESH_ELEMENTS, &r.memory, &items));
    rays *cast = rays_create(&r.scene, &items, message, sizeof message);
    CHECK(cast);
    int wrong[2] = { 0, 0 };
    for (int i = 0; cast && i < 2000; i++) {
        int below = i % 2;
        double to[3], from[3] = { 1.5, 1.4, below ? 0.1 : 1.7 };
        const double u = 0.1 + 2.8 * (i % 47) / 47.0, v = 0.1 + 2.8 * (i % 43) / 43.0;
        const double at[3] = { u, v, 0.7 + 0.1 * u + v / 30 };
        double distance;
        uint32_t piece = NO_INDEX;
        vec3_sub(to, at, from);
        vec3_normalize(to);
        wrong[below] += rays_measure(cast, from, to, &piece, &distance) != RAY_FRONT || (piece >= 9) != (below == 1);
    }
    CHECK_EQUAL(wrong[0], 0);
    CHECK_EQUAL(wrong[1], 0);
    rays_destroy(cast);
    room_free(&r);
}

int main(void) {
    if (!rays_are_there()) {
        printf("skipped: this build is without Embree\n");
        return 77;
    }
    RUN(two_skins_in_one_plane_are_each_seen_from_their_front);
    RUN(a_closed_room_that_is_lit_evenly_settles_at_M_over_1_minus_rho);
    RUN(bounces_are_the_terms_of_the_series);
    RUN(a_plane_under_an_even_sky_gets_pi_L);
    RUN(rays_that_meet_nothing_count_as_seeing);
    RUN(squares_at_a_right_angle_exchange_what_the_closed_form_says);
    RUN(the_halves_of_rows_say_how_noisy_they_are);
    RUN(no_more_rays_are_cast_than_noise_asks_for);
    RUN(threads_change_nothing_and_the_seed_does);
    RUN(all_light_is_booked);
    RUN(emitters_give_what_closed_forms_say);
    RUN(parts_receive_what_they_would_have_got_as_elements);
    RUN(a_small_window_is_found_and_lights_the_floor_as_the_closed_form_says);
    RUN(what_sees_most_of_the_sky_is_not_guided_to_it);
    RUN(rays_are_drawn_from_what_is_bright_in_a_panorama);
    RUN(a_room_that_is_lit_through_a_slot_has_rays_of_its_own);
    RUN(further_rays_are_the_same_for_any_number_of_threads);
    return check_end();
}
