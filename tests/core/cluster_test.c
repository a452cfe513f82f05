/* SPDX-License-Identifier: MIT
 * Do small patches that shoot as one give what they would give one by one? And does only that go together which should?
 */
#include "check.h"
#include "mesh/cluster.h"
#include "room.h"
#include "scene/scene.h"
#include "solver/progressive.h"

#include <time.h>

static const double ZERO[3] = { 0, 0, 0 };

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One at a time: the mesh points to it. */
static clustering found;

static clustering find_with(room *r, double size, double degrees, bool emitters) {
    const cluster_desc how = { size, degrees * PI / 180, emitters };
    CHECK(clusters_find(&r->scene, &how, &r->memory, &r->mesh, &found));
    return found;
}

static clustering find(room *r, double size, double degrees) {
    return find_with(r, size, degrees, false);
}

/* A floor of n x n squares of one patch each. */
static void floor_of_squares(room *r, int n, const uint32_t *material_of_column) {
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++)
            room_quad(r, (double[]){ x, y, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, material_of_column[x], 1,
                      1);
}

static size_t clustered_patches(const clustering *c) {
    size_t count = 0;
    for (size_t i = 0; i < c->count; i++) count += c->clusters[i].member_count;
    return count;
}

/* Of 64 squares of one material. */
static void make_grey_floor(room *r) {
    room_start(r);
    uint32_t grey = room_material(r, 0.5, 0), columns[8] = { grey, grey, grey, grey, grey, grey, grey, grey };
    floor_of_squares(r, 8, columns);
    room_finish(r);
}

static void squares_of_a_floor_go_together_up_to_the_size(void) {
    room r;
    make_grey_floor(&r);
    clustering c = find(&r, 3.0, 20);
    double area = 0.0;
    CHECK(clustered_patches(&c) > 56); /* one may be left over between others */
    CHECK(c.count >= 64 / 4 && c.count <= 64 / 2);
    for (size_t i = 0; i < c.count; i++) {
        const cluster *one = &c.clusters[i];
        area += one->area;
        CHECK(one->diameter <= 3.0);
        CHECK_NEAR(one->share, 1.0, 1e-12);
        CHECK_NEAR(one->normal[2], 1.0, 1e-12);
        CHECK_NEAR(one->eye[2], 0.0, 1e-12);
        CHECK_NEAR(one->spread, 0.0, 1e-7);
        for (uint32_t k = 0; k < one->member_count; k++)
            CHECK_EQUAL(mesh_lead(&r.mesh, one->members[k]), one->members[0]);
    }
    CHECK_NEAR(area, (double)clustered_patches(&c), 1e-12);
    CHECK_EQUAL(mesh_shooter_count(&r.mesh), 64 - clustered_patches(&c) + c.count);
    room_free(&r);
}

static void large_patches_shoot_alone(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0), columns[2] = { grey, grey };
    floor_of_squares(&r, 2, columns);
    room_finish(&r);
    clustering c = find(&r, 2.0, 20);
    CHECK_EQUAL(c.count, 0);
    CHECK(!r.mesh.clustering);
    CHECK_EQUAL(mesh_shooter_count(&r.mesh), 4);
    room_free(&r);
}

/* Numbers at the end of what a double holds make none of the distances a number; that is no reason to crash. */
static void without_distances_there_still_is_an_eye(void) {
    room r;
    make_grey_floor(&r);
    for (size_t p = 0; p < r.mesh.patch_count; p++) r.mesh.patches[p].center[0] = NAN;
    clustering c = find(&r, 3.0, 20);
    CHECK(c.count > 0);
    room_free(&r);
}

static void materials_do_not_mix_and_emitters_stay_alone_unless_asked_for(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0), white = room_material(&r, 0.8, 0), emitter = room_material(&r, 0.5, 10);
    uint32_t columns[6] = { grey, grey, white, white, emitter, emitter };
    floor_of_squares(&r, 6, columns);
    room_finish(&r);
    clustering c = find(&r, 4.5, 20);
    CHECK_EQUAL(clustered_patches(&c), 24);
    for (size_t i = 0; i < c.count; i++)
        for (uint32_t k = 0; k < c.clusters[i].member_count; k++) {
            uint32_t first = r.mesh.patches[c.clusters[i].members[0]].surface,
                     other = r.mesh.patches[c.clusters[i].members[k]].surface;
            CHECK_EQUAL(r.surfaces[other].material, r.surfaces[first].material);
            CHECK(r.surfaces[other].material != emitter);
        }
    c = find_with(&r, 4.5, 20, true);
    CHECK_EQUAL(clustered_patches(&c), 36);
    for (size_t i = 0; i < c.count; i++)
        for (uint32_t k = 1; k < c.clusters[i].member_count; k++)
            CHECK_EQUAL(r.surfaces[r.mesh.patches[c.clusters[i].members[k]].surface].material,
                        r.surfaces[r.mesh.patches[c.clusters[i].members[0]].surface].material);
    room_free(&r);
}

static void the_two_sides_of_a_sheet_do_not_mix(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    for (int x = 0; x < 4; x++)
        room_sheet(&r, (double[]){ x, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, grey, 1, 1);
    room_finish(&r);
    clustering c = find(&r, 10, 20);
    CHECK_EQUAL(c.count, 2);
    CHECK_EQUAL(clustered_patches(&c), 8);
    for (size_t i = 0; i < c.count; i++) CHECK_NEAR(fabs(c.clusters[i].normal[2]), 1.0, 1e-12);
    room_free(&r);
}

static void edges_of_a_box_are_not_bent_over(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    for (int k = 0; k < 4; k++) { /* two squares on the floor, two on the wall that stands on its edge */
        double a[3] = { k < 2 ? k : 2, 0, k < 2 ? 0 : k - 2 }, u[3] = { k < 2, 0, k >= 2 };
        room_quad(&r, a, u, (double[]){ 0, 1, 0 }, grey, 1, 1);
    }
    room_finish(&r);
    clustering c = find(&r, 10, 20);
    CHECK_EQUAL(c.count, 2);
    for (size_t i = 0; i < c.count; i++) CHECK_EQUAL(c.clusters[i].member_count, 2);
    room_free(&r);
}

/* Two squares that meet at 50 degrees are 25 from their mean, each. */
static void what_turns_further_than_is_asked_for_stays_apart(void) {
    static const double degrees[2] = { 24, 26 };
    for (int i = 0; i < 2; i++) {
        room r;
        room_start(&r);
        uint32_t grey = room_material(&r, 0.5, 0);
        const double bend = 50 * PI / 180;
        room_quad(&r, ZERO, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, grey, 1, 1);
        room_quad(&r, (double[]){ 1, 0, 0 }, (double[]){ cos(bend), 0, sin(bend) }, (double[]){ 0, 1, 0 }, grey, 1, 1);
        room_finish(&r);
        CHECK_EQUAL(find(&r, 10, degrees[i]).count, i);
        room_free(&r);
    }
}

static void a_hole_is_no_outline(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    for (int k = 0; k < 9; k++)
        if (k != 4)
            room_quad(&r, (double[]){ k % 3, k / 3, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, grey, 1, 1);
    room_finish(&r);
    clustering c = find(&r, 10, 20);
    CHECK_EQUAL(c.count, 0); /* all eight would go round it */
    room_free(&r);
}

/* A cluster's column against the sum of its members', at samples that see all of it. */
static void a_cap_of_a_sphere_gives_what_its_facets_give(void) {
    room r;
    room_start(&r);
    uint32_t grey = room_material(&r, 0.5, 0);
    room_sphere(&r, ZERO, 1.0, false, grey, 24, 12, 1);
    size_t facets = r.mesh.patch_count;
    room_quad(&r, (double[]){ -4, -4, 3 }, (double[]){ 0, 8, 0 }, (double[]){ 8, 0, 0 }, grey, 1, 8);
    room_finish(&r);
    uint32_t *neighbours = arena_alloc(&r.memory, 4 * r.surface_count, sizeof *neighbours);
    CHECK(scene_find_neighbours(&r.scene, neighbours));
    r.scene.neighbours = neighbours;
    clustering c = find(&r, 0.9, 20);
    CHECK(clustered_patches(&c) > facets / 2);
    CHECK(c.count < facets / 3);
    column_setup columns = room_columns(&r, 64, 0);
    char message[160];
    column_worker *w = column_worker_create(&columns, message, sizeof message);
    uint32_t receiver = (uint32_t)facets;
    double worst = 0.0, both = 0.0;
    for (size_t i = 0; i < c.count; i++) {
        const cluster *one = &c.clusters[i];
        if (one->normal[2] < 0.6) continue;
        column *whole = room_column(&columns, w, one->members[0]);
        const column_run *run = column_run_of_patch(whole, receiver);
        double members = 0.0;
        CHECK(run);
        for (uint32_t k = 0; run && k < one->member_count; k++) {
            subpatch piece = subpatch_of_single_patch(&r.scene, &r.mesh, one->members[k]);
            column *alone = column_compute(w, &piece);
            const column_run *part = column_run_of_patch(alone, receiver);
            members += part ? part->factor : 0.0;
            column_destroy(alone);
        }
        if (run) worst = fmax(worst, fabs(run->factor / members - 1.0)), both += members;
        column_destroy(whole);
    }
    printf("caps of a sphere: %zu clusters of %zu facets, factors off by %.2g at most\n", c.count, facets, worst);
    CHECK(both > 0.0);
    CHECK(worst < 0.02); /* twelve corners of the outline for some thirty */
    column_worker_destroy(w);
    room_free(&r);
}

/* ---- solved ---- */

/* A white furnace with a sphere in it: B = M / (1 - rho) everywhere, whoever shoots for whom. */
static void a_furnace_is_as_even_with_clusters(void) {
    room r;
    room_start(&r);
    uint32_t wall = room_material(&r, 0.5, 1.0), ball = room_material(&r, 0.5, 0.0);
    room_box(&r, (double[]){ -2, -2, -2 }, (double[]){ 2, 2, 2 }, true, wall, 2, 2);
    room_sphere(&r, ZERO, 1.0, false, ball, 16, 10, 1);
    room_finish(&r);
    uint32_t *neighbours = arena_alloc(&r.memory, 4 * r.surface_count, sizeof *neighbours);
    CHECK(scene_find_neighbours(&r.scene, neighbours));
    r.scene.neighbours = neighbours;
    clustering c = find(&r, 1.2, 20);
    CHECK(clustered_patches(&c) > 100);
    const progressive_setup setup = { .method = SOLVER_HYBRID,
                                      .columns = room_columns(&r, 64, 0),
                                      .jobs = jobs_create(2),
                                      .unshot_target = 1e-6,
                                      .memory_limit = UINT64_C(1) << 30,
                                      .clock = seconds };
    progressive_result solved;
    char message[160] = "";
    CHECK(!progressive_solve(&setup, &solved, message, sizeof message));
    CHECK(mesh_shooter_count(&r.mesh) < r.mesh.patch_count - 50);
    /* Walls have M 1 and rho 1/2, the ball rho 1/2 and no M: by energy, and by the walls being the brighter. */
    double power = 0.0, absorbed = 0.0;
    for (size_t p = 0; p < r.mesh.patch_count; p++) {
        const patch *one = &r.mesh.patches[p];
        power += one->material.M[0] * one->area;
        for (uint32_t s = one->first_sample; s < one->first_sample + one->sample_count; s++)
            absorbed += 0.5 * solved.irradiance[3 * (size_t)s] * r.mesh.sample_area[s];
    }
    CHECK_NEAR(absorbed / power, 1.0, 0.01);
    CHECK_NEAR(energy_residual(&solved.books), 0.0, 1e-9);
    progressive_result_free(&solved);
    jobs_destroy(setup.jobs);
    room_free(&r);
}

int main(void) {
    RUN(squares_of_a_floor_go_together_up_to_the_size);
    RUN(large_patches_shoot_alone);
    RUN(without_distances_there_still_is_an_eye);
    RUN(materials_do_not_mix_and_emitters_stay_alone_unless_asked_for);
    RUN(the_two_sides_of_a_sheet_do_not_mix);
    RUN(edges_of_a_box_are_not_bent_over);
    RUN(what_turns_further_than_is_asked_for_stays_apart);
    RUN(a_hole_is_no_outline);
    RUN(a_cap_of_a_sphere_gives_what_its_facets_give);
    RUN(a_furnace_is_as_even_with_clusters);
    return check_end();
}
