/* SPDX-License-Identifier: MIT
 * Does the path tracer tell the truth? Closed forms first, then the order of convergence, then another program's
 * probes.
 */
#include "check.h"
#include "input.h"
#include "probe_radiance.h"

#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* ---- small scenes ------------------------------------------------------------------------------------------------ */

typedef struct stage {
    traced_scene scene;
    traced_lights lights;
    radiance_tracer tracer;
} stage;

static uint32_t add_material(stage *s, double rho, double emission, bool double_sided) {
    hemi_material_desc m = { .reflectance = { rho, rho, rho },
                             .emission = { emission, emission, emission },
                             .double_sided = double_sided };
    CHECK(traced_scene_add_material(&s->scene, &m));
    return s->scene.material_count - 1;
}

static void add_mesh(stage *s, const float *positions, uint32_t vertices, const uint32_t *indices, uint32_t triangles,
                     uint32_t material) {
    hemi_mesh_desc mesh = { .positions = positions,
                            .vertex_count = vertices,
                            .indices = indices,
                            .triangle_count = triangles,
                            .material = material };
    CHECK(traced_scene_add_mesh(&s->scene, &mesh));
}

static void commit(stage *s) {
    CHECK(traced_scene_commit(&s->scene));
    CHECK(traced_lights_create(&s->scene, &s->lights));
    s->tracer = (radiance_tracer){ &s->scene, &s->lights, sobol_create(), 1 };
}

static void strike(stage *s) {
    traced_lights_destroy(&s->lights);
    traced_scene_destroy(&s->scene);
}

/* Mean X of one band at a place of a scene. */
static double mean_at(const stage *s, const double place[3], const double normal[3], uint32_t samples) {
    traced_point at;
    double sums[3] = { 0 };
    CHECK(traced_scene_locate(&s->scene, place, normal, 1e-3, &at));
    CHECK(radiance_add(&s->tracer, &at, 1, 0, samples, 1, sums, NULL));
    return sums[0] / samples;
}

/* A sheet of 4 m in the plane y = 0, front up. */
static const float SHEET[] = { -2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2 };
static const uint32_t FRONT_UP[] = { 0, 1, 2, 0, 2, 3 }, FRONT_DOWN[] = { 0, 2, 1, 0, 3, 2 };
static const double ORIGIN[3] = { 0.1, 0, 0.3 }, UP[3] = { 0, 1, 0 };

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

/* Everything emits 1 and reflects rho: it is everywhere 1 / (1 - rho) bright, so X is that too. */
static void a_furnace_is_evenly_bright(void) {
    static const float box[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
    static const uint32_t inward[] = { 0, 1, 2, 0, 2, 3, 5, 4, 7, 5, 7, 6, 4, 0, 3, 4, 3, 7,
                                       1, 5, 6, 1, 6, 2, 3, 2, 6, 3, 6, 7, 4, 5, 1, 4, 1, 0 };
    static const double places[3][3] = { { 0.5, 0, 0.5 }, { 0.01, 0, 0.02 }, { 0.9, 0, 0.4 } };
    const double albedos[] = { 0.0, 0.5, 0.8 };
    for (int a = 0; a < 3; a++) {
        stage s = { 0 };
        add_mesh(&s, box, 8, inward, 12, add_material(&s, albedos[a], 1, false));
        commit(&s);
        /* Half a path's X is noise at rho = 0.8: four standard errors of 8192. */
        for (int p = 0; p < 3; p++)
            CHECK_NEAR(mean_at(&s, places[p], UP, 8192) * (1 - albedos[a]), 1, 4 * 0.5 / sqrt(8192.0));
        strike(&s);
    }
}

enum { DISC_SIDES = 512 };

/* E = pi L R^2 / (R^2 + h^2) under the middle of a disc [Howell82]. The polygon lacks 3e-5 of the disc's area. */
static void a_point_under_a_disc_sees_its_solid_angle(void) {
    static float positions[3 * (DISC_SIDES + 1)];
    static uint32_t indices[3 * DISC_SIDES];
    const double radius = 0.5, heights[] = { 0.05, 0.5, 3 }, emission = 7;
    for (int k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < DISC_SIDES; i++) {
            positions[3 * i] = (float)(radius * cos(2 * PI * i / DISC_SIDES));
            positions[3 * i + 1] = (float)heights[k];
            positions[3 * i + 2] = (float)(radius * sin(2 * PI * i / DISC_SIDES));
            indices[3 * i] = DISC_SIDES;
            indices[3 * i + 1] = i;
            indices[3 * i + 2] = (i + 1) % DISC_SIDES;
        }
        positions[3 * DISC_SIDES + 1] = (float)heights[k];
        stage s = { 0 };
        add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
        add_mesh(&s, positions, DISC_SIDES + 1, indices, DISC_SIDES, add_material(&s, 0, emission, false));
        commit(&s);
        double expected = emission * radius * radius / (radius * radius + heights[k] * heights[k]);
        /* Sobol's points are off by some 1 / N; a thousandth is ten times what they show. */
        CHECK_NEAR(mean_at(&s, (const double[3]){ 0, 0, 0 }, UP, 1 << 14) / expected, 1, 1e-3);
        strike(&s);
    }
}

/* A convex sheet sees a sky of one radiance, whichever way a ray goes: no noise at all. */
static void an_even_sky_over_a_plane_is_exact(void) {
    stage s = { 0 };
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
    s.scene.sky = (hemi_sky_desc){ .radiance = { 2, 2, 2 } };
    commit(&s);
    CHECK_NEAR(mean_at(&s, ORIGIN, UP, 3), 2, 1e-12);
    strike(&s);
}

enum { SKY_ROWS = 8, SKY_COLUMNS = 16 };

/* Rows of a panorama give E = pi sum L_r (sin^2 top - sin^2 bottom) over those above the horizon. */
static void rows_of_a_panorama_add_up(void) {
    static float image[3 * SKY_ROWS * SKY_COLUMNS];
    double expected = 0;
    for (int r = 0; r < SKY_ROWS; r++) {
        double L = r == 2 ? 100 : 1 + r, top = PI / 2 - PI * r / SKY_ROWS, bottom = PI / 2 - PI * (r + 1) / SKY_ROWS;
        if (r < SKY_ROWS / 2) expected += L * (pow(sin(top), 2) - pow(sin(bottom), 2));
        for (int i = 0; i < 3 * SKY_COLUMNS; i++) image[3 * SKY_COLUMNS * r + i] = (float)L;
    }
    stage s = { 0 };
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
    s.scene.sky = (hemi_sky_desc){ .radiance = { 1, 1, 1 }, .image = image, .width = SKY_COLUMNS, .height = SKY_ROWS };
    commit(&s);
    CHECK_NEAR(mean_at(&s, ORIGIN, UP, 1 << 14) / expected, 1, 2e-3); /* as above; half the directions are below */
    strike(&s);
}

/* The standard error of a point under a sky that is brighter to one side, whose light has these shares of the bands. */
static double error_under(const double shares[3]) {
    float image[3 * 2] = { 0 };
    for (int c = 0; c < 3; c++) image[c] = (float)shares[c];
    stage s = { 0 };
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
    s.scene.sky = (hemi_sky_desc){ .radiance = { 1, 1, 1 }, .image = image, .width = 2, .height = 1 };
    commit(&s);
    probe one = { .position = { 0.1f, 0, 0.2f }, .normal = { 0, 1, 0 } };
    const probe_set set = { .probes = &one, .count = 1 };
    probe_radiance r;
    double radiance[3], error = 0;
    CHECK(probe_radiance_create(&s.scene, &set, 0, &r));
    CHECK(probe_radiance_add(&r, &s.tracer, 64, 1));
    CHECK_EQUAL(r.count, 1);
    probe_radiance_get(&r, &s.scene, 0, radiance, &error);
    probe_radiance_destroy(&r);
    strike(&s);
    return error;
}

/* The same paths have the same noise in each band that has light: of one band alone a third of the square. */
static void one_band_alone_is_as_noisy_as_it_is(void) {
    double all = error_under((const double[]){ 1, 1, 1 }), red = error_under((const double[]){ 1, 0, 0 });
    CHECK(all > 0.01);
    CHECK_NEAR(red / all, sqrt(1.0 / 3), 1e-9); /* roundings */
}

/* A sun of E W/m2 at 30 degrees above the horizon, through its whole disc: X = E sin 30 / pi. */
static void a_sun_lights_by_its_height(void) {
    stage s = { 0 };
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
    hemi_light_desc sun = { .kind = HEMI_LIGHT_DIRECTIONAL,
                            .intensity = { 10, 10, 10 },
                            .direction = { 0, -0.5, sqrt(0.75) },
                            .angular_diameter = 0.0093 };
    hemi_light_desc bulb = { .kind = HEMI_LIGHT_POINT, .intensity = { 3, 3, 3 }, .position = { 0.1, 2, 0.3 } };
    CHECK(traced_scene_add_light(&s.scene, &sun));
    CHECK(traced_scene_add_light(&s.scene, &bulb));
    commit(&s);
    CHECK_NEAR(mean_at(&s, ORIGIN, UP, 1 << 12), (10 * 0.5 + 3 / 4.0) / PI, 2e-3);
    strike(&s);
}

/* Under a sun overhead a level sheet whose normals lean by 30 degrees gets that much less, unless it is seen by its
 * faces; of what leaves it and would come back from below nothing is counted. */
static void light_is_received_by_the_normals_of_a_mesh(void) {
    const float lean = (float)sin(PI / 6), up = (float)cos(PI / 6);
    const float normals[] = { lean, up, 0, lean, up, 0, lean, up, 0, lean, up, 0 };
    for (int faces = 0; faces < 2; faces++) {
        stage s = { .scene.faces = faces };
        hemi_mesh_desc mesh = { .positions = SHEET,
                                .normals = normals,
                                .vertex_count = 4,
                                .indices = FRONT_UP,
                                .triangle_count = 2,
                                .material = add_material(&s, 0.5, 0, false) };
        const hemi_light_desc sun = { .kind = HEMI_LIGHT_DIRECTIONAL,
                                      .intensity = { 3, 3, 3 },
                                      .direction = { 0, -1, 0 } };
        CHECK(traced_scene_add_mesh(&s.scene, &mesh));
        CHECK(traced_scene_add_light(&s.scene, &sun));
        commit(&s);
        double X = mean_at(&s, ORIGIN, UP, 16);
        CHECK_NEAR(PI * X, faces ? 3.0 : 3.0 * (double)up, 1e-6);
        strike(&s);
    }
}

/* ---- sides ------------------------------------------------------------------------------------------------------- */

static traced_what look_up(const stage *s, double x, traced_point *met) {
    const double place[3] = { x, 0, 0.3 };
    traced_point at;
    CHECK(traced_scene_locate(&s->scene, place, UP, 1e-3, &at));
    return traced_scene_hit(&s->scene, &at, UP, met);
}

/* What is met above a floor: nothing, the back or the front of a skin, the nearer front of two in one plane. */
static void backs_absorb_and_two_skins_show_their_fronts(void) {
    static const float plate[] = { -2, 1, -2, -2, 1, 2, 2, 1, 2, 2, 1, -2 };
    const traced_what expected[4] = { TRACED_SKY, TRACED_BLACK, TRACED_SURFACE, TRACED_SURFACE };
    for (int skins = 0; skins < 4; skins++) {
        stage s = { 0 };
        traced_point met;
        uint32_t grey = add_material(&s, 0.5, 0, false);
        add_mesh(&s, SHEET, 4, FRONT_UP, 2, grey);
        if (skins & 1) add_mesh(&s, plate, 4, FRONT_UP, 2, grey);
        if (skins & 2) add_mesh(&s, plate, 4, FRONT_DOWN, 2, grey);
        commit(&s);
        CHECK_EQUAL(look_up(&s, 0.1, &met), expected[skins]);
        if (skins & 2) CHECK_NEAR(met.normal[1], -1, 1e-12);
        strike(&s);
    }
}

static void rays_pass_through_holes_of_a_mask(void) {
    static const float plate[] = { -2, 1, -2, -2, 1, 2, 2, 1, 2, 2, 1, -2 };
    static const float uvw[] = { 0, 0, 1, 0, 1, 1, 1, 1, 1, 1, 0, 1 }; /* u from the left to the right */
    static const uint8_t alpha[] = { 0, 255 };
    hemi_alpha_mask mask = { .alpha = alpha, .width = 2, .height = 1, .cutoff = 0.5 };
    stage s = { 0 };
    traced_point met;
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0.5, 0, false));
    hemi_mesh_desc mesh = { .positions = plate,
                            .attributes = uvw,
                            .attribute_count = 3,
                            .vertex_count = 4,
                            .indices = FRONT_DOWN,
                            .triangle_count = 2,
                            .alpha_mask = &mask };
    CHECK(traced_scene_add_mesh(&s.scene, &mesh));
    commit(&s);
    CHECK_EQUAL(look_up(&s, -1, &met), TRACED_SKY);
    CHECK_EQUAL(look_up(&s, 1, &met), TRACED_SURFACE);
    strike(&s);
}

/* ---- what lets light through ------------------------------------------------------------------------------------- */

/* A box of walls from 0 to its size, around the sheet; they look in unless they have two fronts. */
static void add_walls(stage *s, float size, const double straight[3], double diffuse, float positions[24]) {
    static const uint32_t inward[] = { 0, 1, 2, 0, 2, 3, 5, 4, 7, 5, 7, 6, 4, 0, 3, 4, 3, 7,
                                       1, 5, 6, 1, 6, 2, 3, 2, 6, 3, 6, 7, 4, 5, 1, 4, 1, 0 };
    for (int i = 0; i < 8; i++) {
        positions[3 * i] = (i & 3) == 1 || (i & 3) == 2 ? size : -size;
        positions[3 * i + 1] = (i & 3) > 1 ? size : -size;
        positions[3 * i + 2] = i > 3 ? size : -size;
    }
    hemi_material_desc m = { .double_sided = diffuse > 0, .diffuse_transmission = { diffuse, diffuse, diffuse } };
    for (int c = 0; c < 3; c++) m.transmission[c] = straight[c];
    CHECK(traced_scene_add_material(&s->scene, &m));
    add_mesh(s, positions, 8, inward, 12, s->scene.material_count - 1);
}

/* Under a sky of radiance 2, and under a lamp: two panes, whose backs the light comes from, leave the product. */
static void panes_multiply(void) {
    static const double tint[2][3] = { { 0.5, 0.25, 1 }, { 0.4, 0.8, 0 } };
    float walls[2][24];
    for (int lamp = 0; lamp < 2; lamp++) {
        stage s = { 0 };
        traced_point at;
        double sums[3] = { 0 };
        const uint32_t samples = 1 << 14;
        add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0, 0, false));
        for (int k = 0; k < 2; k++) add_walls(&s, (float)(3 + k), tint[k], 0, walls[k]);
        hemi_light_desc bulb = { .kind = HEMI_LIGHT_POINT,
                                 .intensity = { 200, 200, 200 },
                                 .position = { 0.1, 10, 0.3 } };
        if (lamp)
            CHECK(traced_scene_add_light(&s.scene, &bulb));
        else
            s.scene.sky = (hemi_sky_desc){ .radiance = { 2, 2, 2 } };
        commit(&s);
        CHECK(traced_scene_locate(&s.scene, ORIGIN, UP, 1e-3, &at));
        CHECK(radiance_add(&s.tracer, &at, 1, 0, samples, 1, sums, NULL));
        double free = lamp ? 200 / (10.0 * 10 * PI) : 2;
        /* Paths end on panes by chance: X is then 0 or some twice its mean, and this is four standard errors. A lamp is
         * asked through both. */
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(sums[c] / samples, free * tint[0][c] * tint[1][c], lamp ? 1e-9 : free * 4 / sqrt(samples));
        strike(&s);
    }
}

/* A tent that transmits 0.4 diffusely and reflects nothing glows by 0.4 of the sky around it, inside. */
static void a_tent_glows_by_the_sky_around_it(void) {
    static const double none[3] = { 0, 0, 0 };
    float walls[24];
    stage s = { 0 };
    add_mesh(&s, SHEET, 4, FRONT_UP, 2, add_material(&s, 0, 0, false));
    add_walls(&s, 3, none, 0.4, walls);
    s.scene.sky = (hemi_sky_desc){ .radiance = { 2, 2, 2 } };
    commit(&s);
    CHECK_NEAR(mean_at(&s, ORIGIN, UP, 64), 0.4 * 2, 1e-9);
    probe one = { .position = { 3, 0.2f, 0.1f }, .normal = { -1, 0, 0 } };
    const probe_set set = { .probes = &one, .count = 1 };
    probe_radiance r;
    double radiance[3], error;
    CHECK(probe_radiance_create(&s.scene, &set, 0, &r));
    CHECK(probe_radiance_add(&r, &s.tracer, 64, 1));
    probe_radiance_get(&r, &s.scene, 0, radiance, &error);
    CHECK_NEAR(radiance[1], 0.4 * 2, 1e-6);
    probe_radiance_destroy(&r);
    strike(&s);
}

/* ---- truth ------------------------------------------------------------------------------------------------------- */

typedef struct truth {
    input in;
    probe_set set;
    probe_radiance radiance;
} truth;

static void open_truth(truth *t, const char *scene, uint32_t limit) {
    char path[128], message[PROBES_MESSAGE_SIZE];
    input_options o = { .seed = 1 };
    snprintf(path, sizeof path, "tests/accuracy/truth/%s.glb", scene);
    CHECK(input_read(path, &o, &t->in));
    snprintf(path, sizeof path, "tests/accuracy/truth/%s.hprb", scene);
    CHECK_EQUAL(probe_set_read(path, NULL, &t->set, message), HEMI_OK);
    CHECK(probe_radiance_create(&t->in.scene, &t->set, limit, &t->radiance));
    CHECK_EQUAL(t->radiance.lost, 0);
}

static void close_truth(truth *t) {
    probe_radiance_destroy(&t->radiance);
    probe_set_destroy(&t->set);
    input_destroy(&t->in);
}

/* Differences from the other tracer's probes are as large as both noises together say, and have no side. */
static void agrees_with_probes(const char *scene) {
    truth t;
    open_truth(&t, scene, 1500);
    CHECK(probe_radiance_add(&t.radiance, &t.in.tracer, 128, 0));
    double own = 0, all = 0;
    for (size_t i = 0; i < t.radiance.count; i++) {
        const probe *p = &t.set.probes[t.radiance.probe[i]];
        double radiance[3], error;
        probe_radiance_get(&t.radiance, &t.in.scene, i, radiance, &error);
        own += 3 * error * error;
        for (int c = 0; c < 3; c++) all += (double)p->radiance[c] * (double)p->radiance[c];
    }
    probe_figures f = probe_radiance_compare(&t.radiance, &t.in.scene, &t.set);
    /* The own error is that of independent paths, which Sobol's points undercut; bands differ by what walls reflect. */
    double both = sqrt(own / all + f.truth_noise * f.truth_noise);
    printf("%s: error %.4f, of which noise says %.4f; bias %+.5f\n", scene, f.error, both, f.bias);
    CHECK(f.error < 1.1 * both);
    CHECK(f.error > 0.4 * both);
    CHECK_NEAR(f.bias, 0, 4 * both / sqrt((double)t.radiance.count));
    close_truth(&t);
}

static void agrees_with_the_probes_of_the_pillar_room(void) {
    agrees_with_probes("pillar-room");
}

static void agrees_with_the_probes_of_the_cornell_box(void) {
    agrees_with_probes("cornell-box");
}

/* Sixteen times the paths: a quarter of the error at least, where the truth's own 0.15 % is far below. */
static void error_falls_as_the_root_of_the_paths_or_faster(void) {
    truth t;
    open_truth(&t, "pillar-room", 1500);
    CHECK(probe_radiance_add(&t.radiance, &t.in.tracer, 8, 0));
    double before = probe_radiance_compare(&t.radiance, &t.in.scene, &t.set).error;
    CHECK(probe_radiance_add(&t.radiance, &t.in.tracer, 120, 0));
    double after = probe_radiance_compare(&t.radiance, &t.in.scene, &t.set).error;
    printf("8 paths: error %.4f, 128: %.4f, order %.3f\n", before, after, log(before / after) / log(16));
    CHECK(after < before / 4 * 1.05); /* both are means over 1500 probes, good to some hundredths */
    close_truth(&t);
}

static void the_same_seed_gives_the_same_bits_for_any_threads(void) {
    double sums[3][3 * 200];
    truth t;
    open_truth(&t, "cornell-box", 200);
    memset(sums, 0, sizeof sums);
    for (unsigned k = 0; k < 3; k++) {
        t.in.tracer.seed = k < 2 ? 5 : 6;
        CHECK(t.radiance.count <= 200);
        CHECK(radiance_add(&t.in.tracer, t.radiance.points, t.radiance.count, 0, 8, k + 1, sums[k], NULL));
    }
    CHECK(memcmp(sums[0], sums[1], sizeof sums[0]) == 0);
    CHECK(memcmp(sums[0], sums[2], sizeof sums[0]) != 0);
    close_truth(&t);
}

int main(void) {
    RUN(a_furnace_is_evenly_bright);
    RUN(a_point_under_a_disc_sees_its_solid_angle);
    RUN(an_even_sky_over_a_plane_is_exact);
    RUN(rows_of_a_panorama_add_up);
    RUN(one_band_alone_is_as_noisy_as_it_is);
    RUN(a_sun_lights_by_its_height);
    RUN(light_is_received_by_the_normals_of_a_mesh);
    RUN(backs_absorb_and_two_skins_show_their_fronts);
    RUN(rays_pass_through_holes_of_a_mask);
    RUN(panes_multiply);
    RUN(a_tent_glows_by_the_sky_around_it);
    RUN(agrees_with_the_probes_of_the_pillar_room);
    RUN(agrees_with_the_probes_of_the_cornell_box);
    RUN(error_falls_as_the_root_of_the_paths_or_faster);
    RUN(the_same_seed_gives_the_same_bits_for_any_threads);
    return check_end();
}
