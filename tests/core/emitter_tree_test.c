/* SPDX-License-Identifier: MIT
 * Are emitters picked by the light they may give, as often as is said, and is what is left of the number that picked
 * one as good as a new one?
 */
#include "base/sobol.h"
#include "geometry/triangle.h"
#include "geometry/vec3.h"
#include "solver/emitter_tree.h"

#include "../check.h"

#include <stdlib.h>

enum { POINTS = 1 << 12, PARTS = 8 };

static const double FROM[3] = { 0, 0, 0 }, UP[3] = { 0, 0, 1 };

/* Two panels over a point, on either side, of which the first emits three times as much. */
static emitter_tree two_panels(tree_emitter emitters[2], tree_node nodes[3]) {
    for (int i = 0; i < 2; i++) {
        const double power = i == 0 ? 3 : 1;
        emitters[i] = (tree_emitter){ .center = { 2 * i - 1, 0, 5 }, .normal = { 0, 0, -1 }, .luminance = power };
        nodes[1 + i] = (tree_node){
            .center = { 2 * i - 1, 0, 5 }, .axis = { 0, 0, -1 }, .radius = 0.1, .power = power, .reach = INFINITY
        };
    }
    return (emitter_tree){ .emitters = emitters, .count = 2, .nodes = nodes };
}

static void emitters_are_picked_by_their_light_and_the_rest_of_the_number_is_even(void) {
    tree_emitter emitters[2];
    tree_node nodes[3] = { { .power = 4, .reach = INFINITY } };
    const emitter_tree t = two_panels(emitters, nodes);
    int first = 0, parts[2][PARTS] = { { 0 } };
    emitter_cut cut;
    emitter_tree_cut(&t, FROM, UP, &cut);
    for (uint32_t i = 0; i < POINTS; i++) {
        double number = sobol_1d(i, 5), probability;
        const tree_emitter *one = emitter_cut_sample(&cut, &number, &probability);
        int which = one == &emitters[1];
        first += which == 0;
        CHECK_NEAR(probability, which == 0 ? 0.75 : 0.25, 1e-9);
        CHECK(number >= 0.0 && number <= 1.0);
        parts[which][(int)fmin(PARTS * number, PARTS - 1)]++;
    }
    CHECK_NEAR(first, 0.75 * POINTS, 2);
    for (int which = 0; which < 2; which++)
        for (int k = 0; k < PARTS; k++) CHECK_NEAR(parts[which][k], (which == 0 ? 0.75 : 0.25) * POINTS / PARTS, 2);
}

/* Triangles of 1 dm2 that look down from 3 m, all over a hall of 60 m, and one a metre over the point. */
enum { LAMPS = 600 };

typedef struct hall {
    surface down;
    scene scene;
    patch patches[LAMPS];
    double vertices[9 * LAMPS];
    mesh mesh;
    emitter_tree tree;
} hall;

static bool open_hall_with(hall *h, const double first[9]) {
    memset(h, 0, sizeof *h);
    h->down.normal[2] = -1;
    h->scene.surfaces = &h->down, h->scene.surface_count = 1, h->scene.radius = 60;
    h->mesh.patches = h->patches, h->mesh.patch_count = LAMPS, h->mesh.vertices = h->vertices;
    for (uint32_t i = 0; i < LAMPS; i++) {
        double place[2], *v = h->vertices + 9 * i, side = 0.447;
        sobol_2d(i, 3, place);
        double x = 60 * place[0] - 30, y = 60 * place[1] - 30;
        const double corners[9] = { x, y, 3, x, y + side, 3, x + side, y, 3 };
        memcpy(v, i == 0 ? first : corners, sizeof corners);
        h->patches[i] =
            (patch){ .corner = { 3 * i, 3 * i + 1, 3 * i + 2, NO_INDEX }, .area = triangle_area(v, v + 3, v + 6) };
        for (int k = 0; k < 3; k++) {
            h->patches[i].center[k] = (v[k] + v[3 + k] + v[6 + k]) / 3;
            h->patches[i].material.M[k] = 1;
        }
    }
    return emitter_tree_create(&h->mesh, &h->scene, &h->tree);
}

static bool open_hall(hall *h) {
    return open_hall_with(h, (const double[9]){ 0.2, -0.1, 1, 0.2, 0.347, 1, 0.647, -0.1, 1 });
}

/* Light of one if nothing stands between, as from its centre. */
static double light_of(const tree_emitter *e) {
    double square = vec3_dot(e->center, e->center);
    return e->area * e->luminance * e->center[2] * e->center[2] / (square * square);
}

static void what_hangs_close_is_picked_about_as_often_as_it_gives_light(void) {
    hall *h = malloc(sizeof *h);
    CHECK(h && open_hall(h));
    if (!h) return;
    double all = 0.0, close = 0.0;
    for (size_t i = 0; i < LAMPS; i++) {
        const tree_emitter *e = &h->tree.emitters[i];
        all += light_of(e);
        if (e->patch == 0) close = light_of(e);
    }
    emitter_cut cut;
    emitter_tree_cut(&h->tree, FROM, UP, &cut);
    CHECK(cut.count > 1 && cut.count <= EMITTER_CUT_MOST);
    double number = 0.0, probability = 0.0, picked = 0.0;
    for (uint32_t i = 0; i < POINTS; i++) {
        number = sobol_1d(i, 5);
        if (emitter_cut_sample(&cut, &number, &probability)->patch == 0) picked += 1.0 / POINTS;
    }
    CHECK(picked > 0.5 * close / all && picked < 2.0 * close / all);
    emitter_tree_free(&h->tree), free(h);
}

/* A strip of light, 12 m long and 10 cm wide, begins 10 cm over the point and 2 cm beside it: nearly all of its light
 * is from its nearest part, and more than as much again comes from nowhere. */
static void what_begins_beside_a_point_is_picked_as_often_as_it_gives_light(void) {
    hall *h = malloc(sizeof *h);
    const double strip[9] = { 0.02, -0.05, 0.1, 0.02, 0.05, 0.1, 12, 0, 0.1 };
    CHECK(h && open_hall_with(h, strip));
    if (!h) return;
    double all = 0.0, near = 0.0, probability = 0.0;
    for (uint32_t i = 0; i < LAMPS; i++) {
        const polygon shape = mesh_polygon(&h->mesh, h->patches[i].corner);
        double light = 3.0 * polygon_factor(&shape, FROM, UP);
        all += light;
        if (i == 0) near = light;
    }
    emitter_cut cut;
    emitter_tree_cut(&h->tree, FROM, UP, &cut);
    double said = 0.0;
    for (uint32_t i = 0; i < POINTS; i++) {
        double number = sobol_1d(i, 5);
        if (emitter_cut_sample(&cut, &number, &probability)->patch == 0) said = probability;
    }
    CHECK(said > 0.9 * near / all && said < 1.1 * near / all);
    emitter_tree_free(&h->tree), free(h);
}

static void what_is_picked_is_picked_as_often_as_it_says(void) {
    hall *h = malloc(sizeof *h);
    CHECK(h && open_hall(h));
    if (!h) return;
    double found[LAMPS] = { 0 }, said[LAMPS] = { 0 };
    emitter_cut cut;
    emitter_tree_cut(&h->tree, FROM, UP, &cut);
    for (uint32_t i = 0; i < POINTS; i++) {
        double number = sobol_1d(i, 5), probability;
        size_t one = (size_t)(emitter_cut_sample(&cut, &number, &probability) - h->tree.emitters);
        CHECK(said[one] == 0.0 || fabs(said[one] - probability) < 1e-12);
        found[one] += 1.0 / POINTS, said[one] = probability;
    }
    for (size_t i = 0; i < LAMPS; i++)
        if (found[i] > 0.0) CHECK_NEAR(found[i], said[i], 2.0 / POINTS);
    emitter_tree_free(&h->tree), free(h);
}

int main(void) {
    RUN(what_hangs_close_is_picked_about_as_often_as_it_gives_light);
    RUN(what_begins_beside_a_point_is_picked_as_often_as_it_gives_light);
    RUN(what_is_picked_is_picked_as_often_as_it_says);
    RUN(emitters_are_picked_by_their_light_and_the_rest_of_the_number_is_even);
    return check_end();
}
