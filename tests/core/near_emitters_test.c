/* SPDX-License-Identifier: MIT
 * Are elements small where a lamp is close and its light uneven, only there, and the same ones whatever else it gives
 * where rows are kept?
 */
#include "check.h"
#include "geometry/vec3.h"
#include "mesh/near_emitters.h"
#include "tessellate.h"

#include <math.h>
#include <stdlib.h>

enum { FLOOR, LAMP, MESHES };
static const double EDGE = 0.25, HALF = 0.2;

/* A floor of 4 m, and a square lamp over its middle that shines down. */
typedef struct setting {
    hemi_mesh_desc meshes[MESHES];
    float lamp[12];
    source_mesh sources[MESHES];
    mesh_vertices vertices;
    scene scene;
    material materials[MESHES];
    mesh mesh;
    deadline latest;
    arena memory;
} setting;

static const float FLOOR_CORNERS[] = { -2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2 };
static const uint32_t TWO_TRIANGLES[] = { 0, 1, 2, 0, 2, 3 };

static void set_lamp(setting *s, double height) {
    const double half[4][2] = { { -HALF, -HALF }, { HALF, -HALF }, { HALF, HALF }, { -HALF, HALF } };
    for (int i = 0; i < 4; i++) {
        s->lamp[3 * i] = (float)half[i][0], s->lamp[3 * i + 2] = (float)half[i][1];
        s->lamp[3 * i + 1] = (float)height;
    }
}

static setting *make_with(double height, double emission, double reflectance, bool is_sheet) {
    setting *s = calloc(1, sizeof *s);
    if (!s) abort();
    const bool double_sided[MESHES] = { is_sheet, false };
    set_lamp(s, height);
    for (int i = 0; i < MESHES; i++) {
        s->meshes[i] = (hemi_mesh_desc){ .positions = i == LAMP ? s->lamp : FLOOR_CORNERS,
                                         .indices = TWO_TRIANGLES,
                                         .vertex_count = 4,
                                         .triangle_count = 2,
                                         .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
        s->sources[i] = (source_mesh){ .positions = s->meshes[i].positions, .indices = TWO_TRIANGLES };
    }
    const tessellate_desc desc = { .meshes = s->meshes,
                                   .double_sided = double_sided,
                                   .mesh_count = MESHES,
                                   .element_size = EDGE,
                                   .patch_size = 2.0,
                                   .max_elements = 100000 };
    tessellation made = { .vertices = &s->vertices, .scene = &s->scene, .mesh = &s->mesh };
    CHECK_EQUAL(tessellate(&desc, &made), HEMI_OK);
    for (int c = 0; c < 3; c++) s->materials[FLOOR].rho[c] = reflectance, s->materials[LAMP].M[c] = emission;
    s->scene.materials = s->materials, s->scene.material_count = MESHES;
    for (size_t i = 0; i < s->scene.surface_count; i++) {
        surface *f = &s->scene.surfaces[i];
        f->material = f->mesh;
        CHECK(surface_measure(f, s->scene.vertices));
    }
    scene_measure(&s->scene);
    CHECK(mesh_measure_in_scene(&s->mesh, &s->scene, NULL, &s->memory));
    return s;
}

static setting *make(double height, double emission, double reflectance) {
    return make_with(height, emission, reflectance, false);
}

static void split(setting *s, bool alike, uint32_t elements_max) {
    const refinement_setup setup = { &s->scene, &s->mesh, &s->vertices, s->sources, NULL };
    CHECK(near_emitters_split(&setup, alike, elements_max, &s->latest, &s->memory));
}

static void clean(setting *s) {
    tessellation_free(&(tessellation){ .vertices = &s->vertices, .scene = &s->scene, .mesh = &s->mesh });
    arena_free(&s->memory);
    free(s);
}

static bool is_floor(const setting *s, const element *e) {
    return s->scene.surfaces[s->mesh.patches[e->patch].surface].mesh == FLOOR;
}

/* Of the elements of the floor with a middle that is so far from the middle of the floor, along the longer axis: the
 * largest area. */
static double largest(const setting *s, double from, double to) {
    double most = 0.0;
    for (size_t i = 0; i < s->mesh.element_count; i++) {
        const element *e = &s->mesh.elements[i];
        double middle[3] = { 0 };
        int corners = element_corner_count(e);
        for (int k = 0; k < corners; k++)
            for (int c = 0; c < 3; c++) middle[c] += s->mesh.vertices[3 * (size_t)e->corner[k] + (size_t)c] / corners;
        double away = fmax(fabs(middle[0]), fabs(middle[2]));
        if (is_floor(s, e) && away >= from && away < to) most = fmax(most, e->area);
    }
    return most;
}

static double floor_area(const setting *s) {
    double sum = 0.0;
    for (size_t i = 0; i < s->mesh.element_count; i++)
        if (is_floor(s, &s->mesh.elements[i])) sum += s->mesh.elements[i].area;
    return sum;
}

/* 3 cm under a lamp light ends within a few centimetres of its edge. */
static void elements_are_as_small_as_the_light_is_uneven(void) {
    setting *s = make(0.03, 10.0, 0.8);
    double before = largest(s, 1.0, 2.0);
    split(s, false, 100000);
    CHECK(largest(s, HALF - 0.02, HALF + 0.02) <= 0.03 * 0.03);
    CHECK_NEAR(largest(s, 1.0, 2.0), before, 1e-12);
    CHECK_NEAR(floor_area(s), 16.0, 1e-9);
    clean(s);
}

static double late(void) {
    return 2.0;
}

static void no_element_is_split_that_there_is_no_time_for(void) {
    setting *s = make(0.03, 10.0, 0.8);
    size_t before = s->mesh.element_count;
    s->latest = (deadline){ late, 1.0 };
    split(s, false, 100000);
    CHECK_EQUAL(s->mesh.element_count, before);
    clean(s);
}

static size_t count_after(double height, double emission, double reflectance, bool alike, uint32_t elements_max) {
    setting *s = make(height, emission, reflectance);
    split(s, alike, elements_max);
    size_t count = s->mesh.element_count;
    clean(s);
    return count;
}

static void nothing_is_split_without_need(void) {
    setting *s = make(0.03, 10.0, 0.8);
    size_t before = s->mesh.element_count;
    clean(s);
    CHECK_EQUAL(count_after(0.03, 0.0, 0.8, false, 100000), before);                /* no lamp */
    CHECK_EQUAL(count_after(0.03, 10.0, 0.0, false, 100000), before);               /* nothing reflects */
    CHECK_EQUAL(count_after(2.0, 10.0, 0.8, false, 100000), before);                /* it is far */
    CHECK_EQUAL(count_after(0.03, 10.0, 0.8, false, (uint32_t)before + 2), before); /* no more are allowed */
    CHECK(count_after(0.03, 10.0, 0.8, false, 100000) > before);
}

/* A share of all light is the same share of other light, and another colour of it finds the same elements if asked. */
static void other_light_finds_the_same_elements(void) {
    CHECK_EQUAL(count_after(0.03, 10.0, 0.8, false, 100000), count_after(0.03, 1e-3, 0.8, false, 100000));
    setting *red = make(0.03, 10.0, 0.8), *white = make(0.03, 10.0, 0.8);
    for (int c = 0; c < 3; c++) red->materials[FLOOR].rho[c] = white->materials[FLOOR].rho[c] = 0.1 + 0.3 * c;
    red->materials[LAMP].M[1] = red->materials[LAMP].M[2] = 0.0;
    split(red, true, 100000);
    split(white, true, 100000);
    CHECK_EQUAL(red->mesh.element_count, white->mesh.element_count);
    clean(red);
    clean(white);
}

/* What is seen of a sheet from behind is the twin of what would be seen from before. */
static void two_sides_of_a_sheet_are_split_alike(void) {
    setting *s = make_with(0.03, 10.0, 0.8, true);
    uint32_t *first = calloc(s->scene.surface_count, sizeof *first);
    if (!first) abort();
    split(s, false, 100000);
    size_t pairs = 0, small = 0;
    for (size_t i = s->mesh.element_count; i-- > 0;)
        first[s->mesh.patches[s->mesh.elements[i].patch].surface] = (uint32_t)i;
    for (size_t i = 0; i < s->mesh.element_count; i++) {
        const element *e = &s->mesh.elements[i];
        uint32_t own = s->mesh.patches[e->patch].surface, twin = s->scene.surfaces[own].twin;
        if (twin == NO_INDEX || surface_sheet(&s->scene, own) != own) continue;
        const element *other = &s->mesh.elements[first[twin] + i - first[own]];
        int corners = element_corner_count(e);
        CHECK_EQUAL(element_corner_count(other), corners);
        for (int k = 0; k < corners; k++)
            CHECK(vec3_distance(s->mesh.vertices + 3 * (size_t)e->corner[k],
                                s->mesh.vertices + 3 * (size_t)other->corner[corners - 1 - k]) < 1e-12);
        pairs++, small += e->area < 0.03 * 0.03;
    }
    CHECK(pairs > 16 * 16 && small > 0);
    free(first);
    clean(s);
}

static bool has_corner_at(const mesh *m, const double place[3]) {
    for (size_t i = 0; i < m->element_count; i++)
        for (int c = 0; c < element_corner_count(&m->elements[i]); c++)
            if (vec3_distance(m->vertices + 3 * (size_t)m->elements[i].corner[c], place) < 1e-9) return true;
    return false;
}

/* Edges of the floor with a vertex in the middle that the element does not know of. */
static size_t count_unknown(const setting *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->mesh.element_count; i++) {
        const element *e = &s->mesh.elements[i];
        int corners = element_corner_count(e);
        for (int k = 0; is_floor(s, e) && k < corners; k++) {
            double middle[3];
            vec3_mid(middle, s->mesh.vertices + 3 * (size_t)e->corner[k],
                     s->mesh.vertices + 3 * (size_t)e->corner[(k + 1) % corners]);
            count += !(e->hanging & 1 << k) && has_corner_at(&s->mesh, middle);
        }
    }
    return count;
}

/* Refined elements have vertices that hang; who refines them further must know. */
static void what_was_split_can_be_split_on(void) {
    setting *s = make(0.03, 10.0, 0.8);
    split(s, false, 100000);
    const refinement_setup setup = { &s->scene, &s->mesh, &s->vertices, s->sources, NULL };
    refinement *tree = refinement_create(&setup);
    bool *marks = calloc(s->mesh.element_count, sizeof *marks);
    if (!tree || !marks) abort();
    size_t hanging = 0, smallest = 0;
    for (size_t i = 0; i < s->mesh.element_count; i++) {
        hanging += s->mesh.elements[i].hanging != 0;
        if (s->mesh.elements[i].area < s->mesh.elements[smallest].area) smallest = i;
    }
    CHECK(hanging > 0);
    CHECK_EQUAL(count_unknown(s), 0);
    marks[smallest] = true;
    CHECK_EQUAL(refinement_split(tree, marks, 100000), REFINEMENT_OK);
    CHECK(refinement_finish(tree, &s->memory));
    CHECK_NEAR(floor_area(s), 16.0, 1e-9);
    CHECK_EQUAL(count_unknown(s), 0);
    free(marks);
    refinement_free(tree);
    clean(s);
}

int main(void) {
    RUN(elements_are_as_small_as_the_light_is_uneven);
    RUN(no_element_is_split_that_there_is_no_time_for);
    RUN(nothing_is_split_without_need);
    RUN(other_light_finds_the_same_elements);
    RUN(two_sides_of_a_sheet_are_split_alike);
    RUN(what_was_split_can_be_split_on);
    return check_end();
}
