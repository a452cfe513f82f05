/* SPDX-License-Identifier: MIT
 * Are contact lines found, and are elements cut along them so that each is on one side, nothing is lost, no edge has a
 * T-junction, and colours do not run across?
 */
#include "check.h"
#include "geometry/triangle.h"
#include "mesh/contact_cut.h"
#include "tessellate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A floor, and on it whatever a test puts there; at most so many meshes, each of these corners and triangles. */
enum { MESHES_MAX = 4, FLOATS_MAX = 147456, INDICES_MAX = 49152 };

typedef struct setting {
    float positions[MESHES_MAX][FLOATS_MAX];
    uint32_t indices[MESHES_MAX][INDICES_MAX];
    hemi_mesh_desc meshes[MESHES_MAX];
    bool double_sided[MESHES_MAX];
    source_mesh sources[MESHES_MAX];
    uint32_t count;
    mesh_vertices vertices;
    scene scene;
    material white;
    mesh mesh;
    contact_lines lines;
    deadline latest;
    arena memory;
} setting;

static uint32_t add_mesh(setting *s, const float *positions, uint32_t vertices, const uint32_t *indices,
                         uint32_t triangles) {
    uint32_t i = s->count++;
    memcpy(s->positions[i], positions, 3 * vertices * sizeof *positions);
    memcpy(s->indices[i], indices, 3 * triangles * sizeof *indices);
    s->meshes[i] = (hemi_mesh_desc){ .positions = s->positions[i],
                                     .indices = s->indices[i],
                                     .vertex_count = vertices,
                                     .triangle_count = triangles,
                                     .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
    return i;
}

/* A horizontal rectangle at height y, seen from above. */
static uint32_t add_sheet(setting *s, float x0, float z0, float x1, float z1, float y) {
    const float p[] = { x0, y, z0, x0, y, z1, x1, y, z1, x1, y, z0 };
    const uint32_t t[] = { 0, 1, 2, 0, 2, 3 };
    return add_mesh(s, p, 4, t, 2);
}

/* A box without a bottom, turned about the vertical. */
static uint32_t add_box(setting *s, double x, double z, double half, double turn, double low, double high) {
    static const uint32_t t[] = { 0, 4, 1, 1, 4, 5, 1, 5, 2, 2, 5, 6, 2, 6, 3,
                                  3, 6, 7, 3, 7, 0, 0, 7, 4, 4, 7, 6, 4, 6, 5 };
    float p[24];
    for (int i = 0; i < 8; i++) {
        double angle = turn + acos(-1.0) / 2 * i;
        p[3 * i] = (float)(x + half * cos(angle)), p[3 * i + 2] = (float)(z + half * sin(angle));
        p[3 * i + 1] = (float)(i < 4 ? low : high);
    }
    return add_mesh(s, p, 8, t, 10);
}

/* With lines along which light fades under what hangs as high as gaps say. */
static void make_with(setting *s, double element_size, contact_gaps gaps) {
    const tessellate_desc desc = { .meshes = s->meshes,
                                   .double_sided = s->double_sided,
                                   .mesh_count = s->count,
                                   .element_size = element_size,
                                   .patch_size = 2.0,
                                   .max_elements = 100000 };
    tessellation made = { .vertices = &s->vertices, .scene = &s->scene, .mesh = &s->mesh };
    CHECK_EQUAL(tessellate(&desc, &made), HEMI_OK);
    for (uint32_t i = 0; i < s->count; i++)
        s->sources[i] = (source_mesh){ .positions = s->positions[i], .indices = s->indices[i] };
    s->white = (material){ .rho = { 0.5, 0.5, 0.5 } };
    s->scene.materials = &s->white, s->scene.material_count = 1;
    for (size_t i = 0; i < s->scene.surface_count; i++)
        CHECK(surface_measure(&s->scene.surfaces[i], s->scene.vertices));
    scene_measure(&s->scene);
    CHECK(contact_lines_find(&s->scene, &gaps, &s->latest, NULL, &s->lines));
}

static void make(setting *s, double element_size) {
    make_with(s, element_size, (contact_gaps){ .least = INFINITY });
}

static void cut_with(setting *s, double wide_gap) {
    const refinement_setup setup = { &s->scene, &s->mesh, &s->vertices, s->sources, NULL };
    CHECK(contact_cut(&setup, &s->lines, 0.5, wide_gap, 100000, &s->latest));
    CHECK(mesh_measure(&s->mesh, &s->memory));
}

static void cut(setting *s) {
    cut_with(s, INFINITY);
}

static void clean(setting *s) {
    tessellation_free(&(tessellation){ .vertices = &s->vertices, .scene = &s->scene, .mesh = &s->mesh });
    contact_lines_free(&s->lines);
    arena_free(&s->memory);
    free(s);
}

static setting *new_setting(void) {
    setting *s = calloc(1, sizeof *s);
    if (!s) abort();
    return s;
}

static double length_of_lines(const setting *s, uint32_t mesh_index) {
    double sum = 0.0;
    for (size_t i = 0; i < s->scene.surface_count; i++)
        for (size_t k = s->lines.first[i]; s->scene.surfaces[i].mesh == mesh_index && k < s->lines.first[i + 1]; k++)
            sum += vec3_distance(s->lines.lines[k].from, s->lines.lines[k].to);
    return sum;
}

static uint32_t mesh_of_element(const setting *s, size_t e) {
    return s->scene.surfaces[s->mesh.patches[s->mesh.elements[e].patch].surface].mesh;
}

static double area_of(const setting *s, uint32_t mesh_index) {
    double sum = 0.0;
    for (size_t e = 0; e < s->mesh.element_count; e++)
        if (mesh_of_element(s, e) == mesh_index) sum += s->mesh.elements[e].area;
    return sum;
}

static size_t count_of(const setting *s, uint32_t mesh_index) {
    size_t count = 0;
    for (size_t e = 0; e < s->mesh.element_count; e++) count += mesh_of_element(s, e) == mesh_index;
    return count;
}

/* ---- lines ---- */

static void a_wall_has_a_line_where_it_stands(void) {
    const double feet[] = { 0.0, -0.5, 0.001, -0.001 }; /* on the floor, through it, a little over and in it */
    for (int i = 0; i < 4; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        add_box(s, 0.1, 0.2, 0.5, 0.3, feet[i], 1.0);
        make(s, 0.5);
        CHECK_NEAR(length_of_lines(s, 0), 4 * 0.5 * sqrt(2.0), 1e-4);
        clean(s);
    }
}

static void a_wall_over_the_floor_has_none(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, 0.3, 0.05, 1.0);
    make(s, 0.5);
    CHECK_NEAR(length_of_lines(s, 0), 0.0, 0.0);
    clean(s);
}

static void a_rug_has_its_outline_and_not_its_seams(void) {
    const double heights[] = { 0.0, 1e-4, 0.003 };
    for (int i = 0; i < 3; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        const float y = (float)heights[i], p[] = { -1, y, -1, -1, y, 1, 0, y, 1, 0, y, -1, 1, y, 1, 1, y, -1 };
        const uint32_t t[] = { 0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5 };
        add_mesh(s, p, 6, t, 4);
        make(s, 0.5);
        CHECK_NEAR(length_of_lines(s, 0), 8.0, 1e-4);
        CHECK_NEAR(length_of_lines(s, 1), 0.0, 0.0);
        clean(s);
    }
}

/* Both sheets have lines one and three gaps inside the edges of the smaller one; the outline is the larger one's. */
static void light_fades_along_lines_under_what_hangs_over(void) {
    const contact_gaps gaps[] = { { .least = 0.001, .most = 0.25 },
                                  { .least = 0.004, .most = 0.25 },
                                  { .least = 0.001, .most = 0.002 } };
    const double fades[] = { 16.0, 0.0, 0.0 };
    for (int i = 0; i < 3; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        add_sheet(s, -1, -1, 1, 1, 0.003f);
        make_with(s, 0.5, gaps[i]);
        CHECK_NEAR(length_of_lines(s, 0), 8.0 + fades[i], 1e-4);
        CHECK_NEAR(length_of_lines(s, 1), fades[i], 1e-4);
        for (size_t k = s->lines.first[0]; k < s->lines.first[1]; k++) {
            const contact_line *l = &s->lines.lines[k];
            int across = fabs(l->from[0] - l->to[0]) < 1e-6 ? 0 : 2; /* the axis that the line does not run along */
            double inside = 1.0 - fabs(l->from[across]);
            CHECK_NEAR(fabs(l->from[2 - across]), 1.0, 1e-6); /* it begins at an edge */
            CHECK_NEAR(isinf(l->gap) ? fmin(fabs(inside - 0.003), fabs(inside - 0.009)) : inside, 0.0, 1e-6);
        }
        clean(s);
    }
}

static void what_goes_on_past_an_edge_is_no_contact(void) {
    setting *s = new_setting();
    add_box(s, 0.0, 0.0, 0.5, 0.3, 0.0, 1.0);
    make(s, 0.2);
    CHECK_EQUAL(s->lines.count, 0);
    clean(s);
}

static void what_lies_in_or_under_another_is_known(void) {
    const double heights[] = { 0.0, 1e-4, 0.05 };
    const contact_kind floor[] = { CONTACT_OPEN, CONTACT_HIDDEN, CONTACT_OPEN },
                       rug[] = { CONTACT_COPY, CONTACT_OPEN, CONTACT_OPEN };
    const double under[3] = { 0.3, 0.0, 0.2 }, beside[3] = { 1.5, 0.0, 0.2 };
    for (int i = 0; i < 3; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        add_sheet(s, -1, -1, 1, 1, (float)heights[i]);
        make(s, 0.5);
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, 0, under), floor[i]);
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, 0, beside), CONTACT_OPEN);
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, 1, under), rug[i]);
        s->white.transmittance[1] = 0.5; /* of glass */
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, 0, under), CONTACT_OPEN);
        clean(s);
    }
}

static size_t count_patches(const setting *s, uint32_t mesh_index, contact_kind kind) {
    size_t count = 0;
    for (size_t p = 0; p < s->mesh.patch_count; p++)
        count += s->scene.surfaces[s->mesh.patches[p].surface].mesh == mesh_index && s->mesh.patches[p].contact == kind;
    return count;
}

/* Two bars of a window in one plane: where they cross one lies in the other, and that is the middle of its one patch.
 */
static void a_bar_that_crosses_another_is_seen(void) {
    setting *s = new_setting();
    add_sheet(s, -1, -0.05f, 1, 0.05f, 0);
    add_sheet(s, -0.05f, -0.9f, 0.05f, 0.9f, 0);
    add_sheet(s, -0.9f, -0.04f, -0.5f, 0.04f, 0);
    make(s, 0.5);
    cut(s);
    for (uint32_t bar = 0; bar < 2; bar++) {
        CHECK(count_patches(s, bar, CONTACT_OPEN) > 0);
        CHECK_EQUAL(count_patches(s, bar, CONTACT_COPY), 0);
    }
    CHECK(count_patches(s, 2, CONTACT_COPY) > 0); /* all of it lies in the first */
    CHECK_EQUAL(count_patches(s, 2, CONTACT_OPEN), 0);
    clean(s);
}

/* Where light fades under what hangs it goes to and fro between the two, and both reflect. */
static void what_light_fades_under_is_open(void) {
    const double heights[] = { 0.0005, 0.002, 0.008 };
    const contact_kind floor[] = { CONTACT_HIDDEN, CONTACT_OPEN, CONTACT_OPEN };
    const double under[3] = { 0.3, 0.0, 0.2 };
    for (int i = 0; i < 3; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        add_sheet(s, -1, -1, 1, 1, (float)heights[i]);
        make_with(s, 0.3, (contact_gaps){ .least = 0.001, .most = 0.15 });
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, 0, under), floor[i]);
        clean(s);
    }
}

/* A box with a bottom. */
static uint32_t add_closed_box(setting *s, double x, double z, double half, double low, double high) {
    uint32_t i = add_box(s, x, z, half, 0.3, low, high);
    memcpy(s->indices[i] + 30, (uint32_t[]){ 0, 1, 2, 0, 2, 3 }, 6 * sizeof(uint32_t));
    s->meshes[i].triangle_count = 12;
    return i;
}

/* A door over its floor: on either side of it is another light. What is behind a front, or shows its back, is in
 * nobody's way; what is wide or short is no door. The box is 0.99 m wide, so twice its area is 0.49 m times the 3.96 m
 * around it. */
static void what_hangs_low_parts_what_is_beside_it(void) {
    const struct {
        double low, parts, width, outline;
        bool is_box, is_parted;
    } cases[] = { { 0.05, 0.1, INFINITY, 0.0, true, true },    { 0.05, 0.0, INFINITY, 0.0, true, false },
                  { 0.15, 0.1, INFINITY, 0.0, true, false },   { 0.05, 0.1, INFINITY, 0.0, false, false },
                  { -0.05, 0.1, INFINITY, 0.0, false, false }, { 0.05, 0.1, 0.5, 3.9, true, true },
                  { 0.05, 0.1, 0.48, 3.9, true, false },       { 0.05, 0.1, 0.5, 4.0, true, false } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        setting *s = new_setting();
        add_sheet(s, -2, -2, 2, 2, 0);
        if (cases[i].is_box)
            add_closed_box(s, 0.1, 0.2, 0.7, cases[i].low, cases[i].low + 0.5);
        else
            add_sheet(s, -0.5f, -0.5f, 0.5f, 0.5f, (float)cases[i].low);
        make_with(s, 0.3, (contact_gaps){ 0.001, 0.01, cases[i].parts, cases[i].width, cases[i].outline });
        CHECK_NEAR(length_of_lines(s, 0), cases[i].is_parted ? 4 * 0.7 * sqrt(2.0) : 0.0, 1e-5);
        clean(s);
    }
}

/* The kind around the middle of the surface of a mesh that looks down, or of the back of one that looks up. */
static contact_kind kind_below(const setting *s, uint32_t mesh_index, double x, double y, double z) {
    const double at[3] = { x, y, z };
    for (uint32_t i = 0; i < s->scene.surface_count; i++)
        if (s->scene.surfaces[i].mesh == mesh_index && s->scene.surfaces[i].normal[1] < -0.99)
            return contact_lines_kind(&s->scene, &s->lines, i, at);
    return CONTACT_OPEN;
}

static void what_a_thing_stands_on_is_known(void) {
    const struct {
        double half, foot; /* of the floor and of the box above it */
        bool double_sided; /* the floor */
        contact_kind kind;
    } cases[] = {
        { 2.0, 0.0, false, CONTACT_FOOT }, { 2.0, 1e-6, false, CONTACT_FOOT },
        { 2.0, 0.0, true, CONTACT_FOOT },  { 2.0, 0.05, false, CONTACT_OPEN }, /* it hangs */
        { 0.4, 0.0, false, CONTACT_OPEN }, /* the two skins of one plane, as large as each other */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        setting *s = new_setting();
        float half = (float)cases[i].half;
        add_sheet(s, -half, -half, half, half, 0);
        add_closed_box(s, 0.0, 0.0, 0.5, cases[i].foot, 1.0);
        s->double_sided[0] = cases[i].double_sided;
        make(s, 0.5);
        CHECK_EQUAL(kind_below(s, 1, 0.05, cases[i].foot, 0.1), cases[i].kind);
        clean(s);
    }
}

/* The same box on a wall: the end of a door in the plane of a wall of one skin is seen from outside. */
static void what_a_wall_holds_is_in_the_light(void) {
    setting *s = new_setting();
    size_t checked = 0;
    add_sheet(s, -2, -2, 2, 2, 0);
    add_closed_box(s, 0.0, 0.0, 0.5, 0.0, 1.0);
    for (int i = 0; i < 2; i++) { /* on their sides: y to x, x to -y */
        s->meshes[i].transform[0] = s->meshes[i].transform[5] = 0;
        s->meshes[i].transform[1] = -1, s->meshes[i].transform[4] = 1;
    }
    make(s, 0.5);
    const double at[3] = { 0.0, -0.05, 0.1 };
    for (uint32_t i = 0; i < s->scene.surface_count; i++) {
        if (s->scene.surfaces[i].mesh != 1 || s->scene.surfaces[i].normal[0] > -0.99) continue;
        CHECK_EQUAL(contact_lines_kind(&s->scene, &s->lines, i, at), CONTACT_OPEN);
        checked++;
    }
    CHECK_EQUAL(checked, 1);
    clean(s);
}

/* A picture on the outside of a wall of one skin is in the light, though it looks away from the skin. */
static void what_nothing_stands_behind_is_no_foot(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    const float p[] = { -1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1 };
    const uint32_t t[] = { 0, 2, 1, 0, 3, 2 };
    add_mesh(s, p, 4, t, 2);
    make(s, 0.5);
    CHECK_EQUAL(kind_below(s, 1, 0.1, 0.0, 0.2), CONTACT_OPEN);
    clean(s);
}

/* A wall stands on the end of a floor, in the same plane, and goes on beyond it. The line where the floor ends is too
 * short to cut the wall's patches, one of which has its middle over the floor. */
static void what_a_thing_stands_on_may_end_under_it(void) {
    setting *s = new_setting();
    size_t feet = 0, seen = 0;
    add_sheet(s, -2, -2, 0.05f, 2, 0);
    add_closed_box(s, 0.0, 0.0, 0.3, 0.0, 1.0);
    make(s, 0.1);
    cut(s);
    for (size_t i = 0; i < s->mesh.element_count; i++) {
        const element *e = &s->mesh.elements[i];
        const surface *f = &s->scene.surfaces[s->mesh.patches[e->patch].surface];
        double x = 0.0;
        if (f->mesh != 1 || f->normal[1] > -0.99) continue;
        for (int k = 0; k < element_corner_count(e); k++)
            x += s->mesh.vertices[3 * (size_t)e->corner[k]] / element_corner_count(e);
        CHECK_EQUAL(e->is_foot, x < 0.05);
        if (!e->is_foot) CHECK_EQUAL(s->mesh.patches[e->patch].contact, CONTACT_OPEN);
        feet += e->is_foot, seen += !e->is_foot;
    }
    CHECK(feet > 0 && seen > 0);
    clean(s);
}

/* ---- cuts ---- */

/* How far to the inside of the outline of add_box is a point of the floor? */
static double inside_box(const double at[3], double x, double z, double half, double turn) {
    double u = cos(turn + acos(-1.0) / 4) * (at[0] - x) + sin(turn + acos(-1.0) / 4) * (at[2] - z),
           v = -sin(turn + acos(-1.0) / 4) * (at[0] - x) + cos(turn + acos(-1.0) / 4) * (at[2] - z);
    return half / sqrt(2.0) - fmax(fabs(u), fabs(v));
}

static bool is_floor(const setting *s, const element *e) {
    return s->scene.surfaces[s->mesh.patches[e->patch].surface].mesh == 0;
}

static setting *floor_with_box(double turn, double element_size, bool double_sided) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, turn, 0.0, 1.0);
    s->double_sided[0] = double_sided;
    make(s, element_size);
    cut(s);
    return s;
}

static void every_element_is_on_one_side(void) {
    for (int i = 0; i < 8; i++) {
        setting *s = floor_with_box(0.2 * i, 0.3, false);
        size_t inside = 0;
        for (size_t e = 0; e < s->mesh.element_count; e++) {
            const element *one = &s->mesh.elements[e];
            double low = INFINITY, high = -INFINITY;
            for (int k = 0; is_floor(s, one) && k < element_corner_count(one); k++) {
                double depth = inside_box(s->mesh.vertices + 3 * (size_t)one->corner[k], 0.1, 0.2, 0.5, 0.2 * i);
                low = fmin(low, depth), high = fmax(high, depth);
            }
            if (!is_floor(s, one)) continue;
            /* What reaches over by less than a tenth of an element's edge is let be. */
            CHECK(high < 0.03 || low > -0.03);
            inside += low > -0.03;
        }
        CHECK(inside > 0);
        clean(s);
    }
}

static void areas_add_up(void) {
    for (int i = 0; i < 8; i++) {
        setting *s = floor_with_box(0.2 * i, 0.3, true);
        double patches = 0.0;
        CHECK_NEAR(area_of(s, 0), 32.0, 1e-9);
        for (size_t e = 0; e < s->mesh.element_count; e++) CHECK(s->mesh.elements[e].area > 1e-7);
        for (size_t p = 0; p < s->mesh.patch_count; p++) patches += s->mesh.patches[p].element_count;
        CHECK_NEAR(patches, (double)s->mesh.element_count, 0.0);
        clean(s);
    }
}

/* So that each is as large as its elements together, and on one side. */
static void patches_are_cut_where_elements_are(void) {
    for (int i = 0; i < 8; i++) {
        setting *s = floor_with_box(0.2 * i, 0.3, true);
        const mesh *m = &s->mesh;
        size_t inside = 0;
        for (size_t p = 0; p < m->patch_count; p++) {
            double sum = 0.0;
            for (uint32_t e = 0; e < m->patches[p].element_count; e++)
                sum += m->elements[m->patches[p].first_element + e].area;
            CHECK_NEAR(sum, m->patches[p].area, 0.01 * m->patches[p].area + 1e-4);
            inside += s->scene.surfaces[m->patches[p].surface].mesh == 0 &&
                      inside_box(m->patches[p].center, 0.1, 0.2, 0.5, 0.2 * i) > 0.0;
        }
        CHECK(inside >= 2);
        clean(s);
    }
}

/* Of the vertices that elements of the floor have. */
static void no_edge_has_a_t_junction(void) {
    for (int i = 0; i < 4; i++) {
        setting *s = floor_with_box(0.35 * i, 0.4, true);
        const mesh *m = &s->mesh;
        bool *used = calloc(m->vertex_count + 1, sizeof *used);
        for (size_t e = 0; e < m->element_count; e++)
            for (int k = 0; is_floor(s, &m->elements[e]) && k < element_corner_count(&m->elements[e]); k++)
                used[m->elements[e].corner[k]] = true;
        for (size_t e = 0; e < m->element_count; e++) {
            const element *one = &m->elements[e];
            int n = element_corner_count(one), hanging = 0;
            for (int k = 0; is_floor(s, one) && k < n; k++) {
                const double *a = m->vertices + 3 * (size_t)one->corner[k],
                             *b = m->vertices + 3 * (size_t)one->corner[(k + 1) % n];
                for (size_t v = 0; v < m->vertex_count; v++) {
                    const double *x = m->vertices + 3 * v;
                    hanging +=
                        used[v] && !vec3_equal(x, a) && !vec3_equal(x, b) && vec3_distance_to_segment(x, a, b) < 1e-7;
                }
            }
            CHECK_EQUAL(hanging, 0);
        }
        free(used);
        clean(s);
    }
}

static void vertices_lie_where_their_sources_say(void) {
    setting *s = floor_with_box(0.3, 0.3, true);
    for (size_t e = 0; e < s->mesh.element_count; e++) {
        const element *one = &s->mesh.elements[e];
        uint32_t owner = s->scene.surfaces[s->mesh.patches[one->patch].surface].mesh;
        for (int k = 0; k < element_corner_count(one); k++) {
            double at[3];
            mesh_vertices_interpolate(&s->vertices, one->corner[k], s->indices[owner], s->positions[owner], 3, at);
            CHECK_NEAR(vec3_distance(at, s->mesh.vertices + 3 * (size_t)one->corner[k]), 0.0, 1e-6);
        }
    }
    clean(s);
}

/* How many colours of a floor are of elements inside a box alone, and how many of these and others; inside: how far. */
static void count_colours(const setting *s, double (*inside)(double x, double z), size_t *own, size_t *shared) {
    const mesh *m = &s->mesh;
    char *sides = calloc(m->node_count + 1, 1);
    *own = *shared = 0;
    for (size_t e = 0; e < m->element_count; e++) {
        const element *one = &m->elements[e];
        double middle[3] = { 0, 0, 0 };
        int n = element_corner_count(one);
        if (!is_floor(s, one)) continue;
        for (int k = 0; k < n; k++) vec3_add_scaled(middle, middle, 1.0 / n, m->vertices + 3 * (size_t)one->corner[k]);
        for (int k = 0; k < n; k++) sides[m->nodes[one->corner[k]]] |= inside(middle[0], middle[2]) > 0.0 ? 1 : 2;
    }
    for (size_t i = 0; i < m->node_count; i++) *own += sides[i] == 1, *shared += sides[i] == 3;
    free(sides);
}

static double inside_the_box(double x, double z) {
    return inside_box((const double[3]){ x, 0.0, z }, 0.1, 0.2, 0.5, 0.3);
}

static double inside_the_sheet(double x, double z) {
    return 1.0 - fmax(fabs(x), fabs(z));
}

static void colours_part_where_a_wall_stands_and_nowhere_else(void) {
    setting *s = floor_with_box(0.3, 0.3, true);
    size_t own, shared;
    count_colours(s, inside_the_box, &own, &shared);
    CHECK(own > 0);
    CHECK_EQUAL(shared, 0);
    clean(s);
}

/* A sheet 3 mm over the floor parts colours of elements that do not show how light fades under it, and of no others. */
static void colours_are_shared_under_what_hangs_high(void) {
    for (int high = 0; high < 2; high++) {
        setting *s = new_setting();
        size_t own, shared;
        add_sheet(s, -2, -2, 2, 2, 0);
        add_sheet(s, -1, -1, 1, 1, 0.003f);
        make_with(s, 0.3, (contact_gaps){ .least = high ? 0.002 : 0.004, .most = 0.25 });
        cut_with(s, high ? 0.002 : 0.004);
        count_colours(s, inside_the_sheet, &own, &shared);
        CHECK(own > 0);
        CHECK(high ? shared >= 24 : shared == 0);
        CHECK_NEAR(area_of(s, 0), 16.0, 1e-6);
        clean(s);
    }
}

static void two_sides_of_a_sheet_are_cut_alike(void) {
    setting *s = floor_with_box(0.3, 0.3, true);
    const mesh *m = &s->mesh;
    uint32_t front = 0, back = s->scene.surfaces[0].twin;
    size_t first[2] = { SIZE_MAX, SIZE_MAX }, count[2] = { 0, 0 };
    for (size_t e = 0; e < m->element_count; e++)
        for (int k = 0; k < 2; k++) {
            if (m->patches[m->elements[e].patch].surface != (k ? back : front)) continue;
            if (first[k] == SIZE_MAX) first[k] = e;
            count[k]++;
        }
    CHECK(back != NO_INDEX && count[0] > 16);
    CHECK_EQUAL(count[0], count[1]);
    for (size_t i = 0; i < count[0]; i++) {
        const element *a = &m->elements[first[0] + i], *b = &m->elements[first[1] + i];
        int n = element_corner_count(a);
        CHECK_EQUAL(n, element_corner_count(b));
        for (int k = 0; k < n; k++) {
            CHECK(vec3_equal(m->vertices + 3 * (size_t)a->corner[k], m->vertices + 3 * (size_t)b->corner[n - 1 - k]));
            CHECK(m->nodes[a->corner[k]] != m->nodes[b->corner[n - 1 - k]]);
        }
    }
    clean(s);
}

/* So many upright triangles through one element of the floor and each other, all ways, and one alone beside it. */
static setting *spikes_through_the_floor(uint32_t spikes) {
    static const float alone[] = { 0.7f, -0.1f, 0.1f, 0.8f, -0.1f, 0.4f, 0.75f, 0.5f, 0.2f };
    float p[FLOATS_MAX];
    uint32_t t[INDICES_MAX];
    for (uint32_t i = 0; i < spikes; i++) {
        double angle = 3.0 * i / spikes + 0.1, x = 0.2 * cos(angle), z = 0.2 * sin(angle);
        const double corners[3][3] = { { 0.25 - x, -0.1, 0.25 - z },
                                       { 0.25 + x, -0.1, 0.25 + z },
                                       { 0.26, 0.5, 0.25 } };
        for (uint32_t k = 0; k < 3; k++) {
            t[3 * i + k] = 3 * i + k;
            for (uint32_t c = 0; c < 3; c++) p[9 * i + 3 * k + c] = (float)corners[k][c];
        }
    }
    setting *s = new_setting();
    add_sheet(s, 0, 0, 1, 0.5, 0);
    add_mesh(s, p, 3 * spikes, t, spikes);
    add_mesh(s, alone, 3, (const uint32_t[]){ 0, 1, 2 }, 1);
    make(s, 0.5);
    return s;
}

/* Of the half of the floor with x above or below 0.5. */
static size_t elements_under_spikes(uint32_t spikes, uint32_t elements_max, bool alone) {
    setting *s = spikes_through_the_floor(spikes);
    const refinement_setup setup = { &s->scene, &s->mesh, &s->vertices, s->sources, NULL };
    CHECK(contact_cut(&setup, &s->lines, 0.5, INFINITY, elements_max, &s->latest));
    CHECK(mesh_measure(&s->mesh, &s->memory));
    size_t count = 0;
    for (size_t e = 0; e < s->mesh.element_count; e++) {
        const element *one = &s->mesh.elements[e];
        double x = 0.0;
        int n = element_corner_count(one);
        for (int k = 0; k < n; k++) x += s->mesh.vertices[3 * (size_t)one->corner[k]] / n;
        count += s->scene.surfaces[s->mesh.patches[one->patch].surface].mesh == 0 && (x > 0.5) == alone;
    }
    clean(s);
    return count;
}

static void a_tangle_is_not_cut(void) {
    CHECK(elements_under_spikes(6, 100000, false) > 6);
    CHECK_EQUAL(elements_under_spikes(20, 100000, false), 1);
    CHECK(elements_under_spikes(20, 100000, true) > 1);
}

/* What one line runs through is cut all the same. */
static void what_is_too_much_begins_to_be_a_tangle_sooner(void) {
    CHECK(elements_under_spikes(12, 100000, false) > 30);
    CHECK_EQUAL(elements_under_spikes(12, 60, false), 1);
    CHECK(elements_under_spikes(12, 60, true) > 1);
}

/* Each of these has as many lines as there are others: of a hundred thousand it would be ten milliards. */
static void lines_of_a_tangle_have_a_bound(void) {
    enum { SPIKES = 1600, LINES = 1 << 21 };
    setting *s = spikes_through_the_floor(SPIKES);
    CHECK(s->lines.first[1] - s->lines.first[0] >= SPIKES);
    CHECK(s->lines.count > LINES / 2 && s->lines.count <= LINES);
    clean(s);
}

/* Blades side by side, none of which meets another: the ground has most of the area, and may have most of the lines. */
static void the_ground_has_the_lines_of_all_that_stands_on_it(void) {
    enum { COLUMNS = 160, ROWS = 100, BLADES = COLUMNS * ROWS };
    static float p[9 * BLADES];
    static uint32_t t[3 * BLADES];
    for (uint32_t i = 0; i < BLADES; i++) {
        const float x = (0.5f + (float)(i % COLUMNS)) / COLUMNS, z = (0.5f + (float)(i / COLUMNS)) / (2 * ROWS);
        const float blade[9] = { x - 1e-3f, -1e-3f, z, x + 1e-3f, -1e-3f, z, x, 5e-3f, z };
        memcpy(p + 9 * i, blade, sizeof blade);
        for (uint32_t k = 0; k < 3; k++) t[3 * i + k] = 3 * i + k;
    }
    setting *s = new_setting();
    add_sheet(s, 0, 0, 1, 0.5, 0);
    add_mesh(s, p, 3 * BLADES, t, BLADES);
    make(s, 0.5);
    CHECK_EQUAL(s->lines.first[1] - s->lines.first[0], BLADES);
    clean(s);
}

static size_t elements_of_floor_under_a_box(double reflectance) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, 0.3, 0.0, 1.0);
    make(s, 0.5);
    for (int c = 0; c < 3; c++) s->white.rho[c] = reflectance;
    cut(s);
    size_t count = count_of(s, 0);
    clean(s);
    return count;
}

static void what_is_black_is_not_cut(void) {
    CHECK(elements_of_floor_under_a_box(0.02) > elements_of_floor_under_a_box(0.0));
    CHECK_EQUAL(elements_of_floor_under_a_box(0.005), elements_of_floor_under_a_box(0.0));
}

static void more_elements_than_allowed_are_not_made(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, 0.3, 0.0, 1.0);
    make(s, 0.3);
    const refinement_setup setup = { &s->scene, &s->mesh, &s->vertices, s->sources, NULL };
    size_t before = s->mesh.element_count;
    CHECK(contact_cut(&setup, &s->lines, 0.5, INFINITY, (uint32_t)before, &s->latest));
    CHECK_EQUAL(s->mesh.element_count, before);
    CHECK(mesh_measure(&s->mesh, &s->memory));
    CHECK_NEAR(area_of(s, 0), 16.0, 1e-9);
    clean(s);
}

static double late(void) {
    return 2.0;
}

static const deadline OVER = { late, 1.0 };

/* There is light on elements as they are, and none without. */
static void nothing_is_cut_that_there_is_no_time_for(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, 0.3, 0.0, 1.0);
    make(s, 0.3);
    size_t before = s->mesh.element_count;
    s->latest = OVER;
    cut(s);
    CHECK_EQUAL(s->mesh.element_count, before);
    CHECK_NEAR(area_of(s, 0), 16.0, 1e-9);
    clean(s);
}

static void no_line_is_looked_for_that_there_is_no_time_for(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.1, 0.2, 0.5, 0.3, 0.0, 1.0);
    s->latest = OVER;
    make(s, 0.3);
    CHECK_EQUAL(s->lines.count + s->lines.cover_count, 0);
    CHECK_EQUAL(s->lines.first[s->scene.surface_count], 0);
    size_t before = s->mesh.element_count;
    cut(s);
    CHECK_EQUAL(s->mesh.element_count, before);
    clean(s);
}

/* A box of 2 m on a patch of 2 m leaves an L, whose faces meet in diagonals of elements of half a metre: such a cut
 * adds no point to the element, which is two all the same. */
static void elements_cut_from_corner_to_corner_are_there_once(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    add_box(s, 0.0, 0.0, sqrt(2.0), acos(-1.0) / 4, 0.0, 1.0);
    make(s, 0.5);
    cut(s);
    CHECK_NEAR(area_of(s, 0), 16.0, 1e-6);
    clean(s);
}

/* Weights that do not add up to one are a place far away: what lies beside its surface is put on it. */
static void sources_lie_on_their_surface(void) {
    setting *s = new_setting();
    add_sheet(s, -2, -2, 2, 2, 0);
    make(s, 0.5);
    mesh_vertices *v = &s->vertices;
    const surface *floor = &s->scene.surfaces[0];
    uint32_t count = v->count, added = mesh_vertices_copy(v, 0, v->nodes[0]);
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = 0; b < count; b++) {
            if (v->source_triangles[a] == v->source_triangles[b]) continue;
            mesh_vertices_set_source(v, s->sources, floor, (uint32_t[]){ a, b }, (double[]){ 1.5, -0.5 }, 2, added);
            const float *w = v->source_weights + 3 * (size_t)added;
            CHECK_NEAR((double)w[0] + (double)w[1] + (double)w[2], 1.0, 1e-6);
            for (int k = 0; k < 3; k++) CHECK(w[k] >= 0.0f && w[k] <= 1.0f);
        }
    clean(s);
}

int main(void) {
    RUN(a_wall_has_a_line_where_it_stands);
    RUN(a_wall_over_the_floor_has_none);
    RUN(a_rug_has_its_outline_and_not_its_seams);
    RUN(light_fades_along_lines_under_what_hangs_over);
    RUN(what_goes_on_past_an_edge_is_no_contact);
    RUN(what_lies_in_or_under_another_is_known);
    RUN(a_bar_that_crosses_another_is_seen);
    RUN(what_light_fades_under_is_open);
    RUN(what_hangs_low_parts_what_is_beside_it);
    RUN(what_a_thing_stands_on_is_known);
    RUN(what_a_wall_holds_is_in_the_light);
    RUN(what_nothing_stands_behind_is_no_foot);
    RUN(what_a_thing_stands_on_may_end_under_it);
    RUN(every_element_is_on_one_side);
    RUN(patches_are_cut_where_elements_are);
    RUN(areas_add_up);
    RUN(sources_lie_on_their_surface);
    RUN(elements_cut_from_corner_to_corner_are_there_once);
    RUN(no_edge_has_a_t_junction);
    RUN(vertices_lie_where_their_sources_say);
    RUN(colours_part_where_a_wall_stands_and_nowhere_else);
    RUN(colours_are_shared_under_what_hangs_high);
    RUN(two_sides_of_a_sheet_are_cut_alike);
    RUN(a_tangle_is_not_cut);
    RUN(what_is_too_much_begins_to_be_a_tangle_sooner);
    RUN(lines_of_a_tangle_have_a_bound);
    RUN(the_ground_has_the_lines_of_all_that_stands_on_it);
    RUN(what_is_black_is_not_cut);
    RUN(more_elements_than_allowed_are_not_made);
    RUN(nothing_is_cut_that_there_is_no_time_for);
    RUN(no_line_is_looked_for_that_there_is_no_time_for);
    return check_end();
}
