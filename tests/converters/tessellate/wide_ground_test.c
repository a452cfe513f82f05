/* SPDX-License-Identifier: MIT
 * Are elements by the things as small on a ground of kilometres as on one of metres, and larger further out?
 */
#include "check.h"
#include "tessellate.h"

#include "base/pair_map.h"

#include <stdlib.h>
#include <string.h>

enum { GROUND_VERTICES = 64, BOX_VERTICES = 8, BOX_TRIANGLES = 12 };

static const hemi_material_desc MATERIALS[2] = { { .reflectance = { 0.5, 0.5, 0.5 } }, { .emission = { 1, 1, 1 } } };

/* A box of 2 m on a ground of a radius, which is a parallelogram or a fan of triangles. */
typedef struct place {
    float ground[3 * GROUND_VERTICES], box[3 * BOX_VERTICES];
    uint32_t fan[3 * GROUND_VERTICES];
    hemi_mesh_desc meshes[2];
} place;

static hemi_mesh_desc mesh_of(const float *positions, uint32_t vertices, const uint32_t *indices, uint32_t triangles) {
    return (hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                             .positions = positions,
                             .vertex_count = vertices,
                             .indices = indices,
                             .triangle_count = triangles,
                             .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
}

static void set_place(place *p, double radius, uint32_t corners) {
    static const uint32_t sides[3 * BOX_TRIANGLES] = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
    memset(p, 0, sizeof *p);
    for (uint32_t i = 0; i < corners; i++) {
        double angle = 2.0 * PI * (i + 0.5) / corners;
        p->ground[3 * i] = (float)(radius * cos(angle)), p->ground[3 * i + 1] = (float)(radius * sin(angle));
        if (i >= 2) p->fan[3 * (i - 2) + 1] = i - 1, p->fan[3 * (i - 2) + 2] = i;
    }
    for (uint32_t i = 0; i < BOX_VERTICES; i++)
        for (uint32_t k = 0; k < 3; k++) p->box[3 * i + k] = (i >> k & 1 ? 1.0f : -1.0f) + (k == 2 ? 1.0f : 0.0f);
    p->meshes[0] = mesh_of(p->ground, corners, p->fan, corners - 2);
    p->meshes[1] = mesh_of(p->box, BOX_VERTICES, sides, BOX_TRIANGLES);
}

static double find(const hemi_mesh_desc *meshes, size_t count, wide_ground *out) {
    return wide_ground_find(&(wide_ground_scene){ meshes, count, MATERIALS, NULL, 0 }, out);
}

typedef struct pieces {
    mesh_vertices vertices;
    scene scene;
    mesh mesh;
    wide_ground ground;
    double area; /* that elements are shared out over */
} pieces;

/* As many elements as are meant for the area are asked for. */
static bool cut(const place *p, double count, pieces *out) {
    static const bool single[2] = { false };
    memset(out, 0, sizeof *out);
    out->area = find(p->meshes, 2, &out->ground);
    const double size = sqrt(out->area / count);
    const tessellate_desc how = { .meshes = p->meshes,
                                  .double_sided = single,
                                  .mesh_count = 2,
                                  .element_size = size,
                                  .patch_size = 3.0 * size,
                                  .ground = &out->ground,
                                  .max_elements = 1000000 };
    tessellation made = { .vertices = &out->vertices, .scene = &out->scene, .mesh = &out->mesh };
    hemi_result result = tessellate(&how, &made);
    CHECK_EQUAL(result, HEMI_OK);
    return result == HEMI_OK;
}

static void pieces_free(pieces *t) {
    tessellation_free(&(tessellation){ .vertices = &t->vertices, .scene = &t->scene, .mesh = &t->mesh });
}

static int corner_count(const element *e) {
    return e->corner[3] == NO_INDEX ? 3 : 4;
}

static const double *corner(const pieces *t, const element *e, int i) {
    return t->vertices.positions + 3 * (size_t)e->corner[i % corner_count(e)];
}

static double longest(const pieces *t, const element *e) {
    double most = 0.0;
    for (int i = 0; i < corner_count(e); i++) most = fmax(most, vec3_distance(corner(t, e, i), corner(t, e, i + 1)));
    return most;
}

/* How far from the middle of the ground the nearest corner is. */
static double nearest(const pieces *t, const element *e) {
    double least = INFINITY;
    for (int i = 0; i < corner_count(e); i++) least = fmin(least, hypot(corner(t, e, i)[0], corner(t, e, i)[1]));
    return least;
}

static double area_of(const pieces *t, const element *e) {
    double sum = 0.0;
    for (int i = 1; i + 1 < corner_count(e); i++) {
        double u[3], v[3], cross[3];
        vec3_sub(u, corner(t, e, i), corner(t, e, 0));
        vec3_sub(v, corner(t, e, i + 1), corner(t, e, 0));
        vec3_cross(cross, u, v);
        sum += 0.5 * sqrt(vec3_dot(cross, cross));
    }
    return sum;
}

/* The longest edge of an element of the ground under the box or by it. */
static double longest_near(const pieces *t) {
    double most = 0.0;
    for (size_t i = 0; i < t->mesh.element_count; i++) {
        const element *e = &t->mesh.elements[i];
        if (nearest(t, e) < 2.0) most = fmax(most, longest(t, e));
    }
    return most;
}

static void near_things_a_wide_ground_is_as_fine_as_a_small_one(void) {
    for (uint32_t corners = 4; corners <= 7; corners += 3) {
        double near_small = 0.0;
        for (double radius = 4.0; radius < 1e5; radius *= 100.0) {
            place p;
            pieces t;
            set_place(&p, radius, corners);
            if (!cut(&p, 2000.0, &t)) return;
            double near = longest_near(&t);
            printf("%u corners, radius %6g m: %6zu elements, edges by the box up to %.3f m\n", corners, radius,
                   t.mesh.element_count, near);
            CHECK_EQUAL(t.ground.is_there, radius > 10.0);
            if (radius < 10.0) near_small = near;
            /* Halving gives sizes by factors of 2. */
            CHECK(near <= 2.0 * near_small);
            /* Rings of equal ratio take as many each: their number goes by the logarithm of the radius. */
            CHECK(t.mesh.element_count < 20000);
            pieces_free(&t);
        }
    }
}

/* Edges of the ground that an element has alone are those of its outline, which is as long as that of the input; a
 * T-junction would have some more. */
static void a_wide_ground_has_no_cracks(void) {
    for (uint32_t corners = 4; corners <= 7; corners += 3) {
        place p;
        pieces t;
        bool ok = true;
        set_place(&p, 1000.0, corners);
        if (!cut(&p, 500.0, &t)) return;
        double area = 0.0, alone = 0.0, outline = 2000.0 * corners * sin(PI / corners);
        pair_map edges = { 0 };
        for (int pass = 0; pass < 2; pass++)
            for (size_t n = 0; n < t.mesh.patch_count; n++) {
                const patch *owner = &t.mesh.patches[n];
                if (t.scene.surfaces[owner->surface].mesh != 0) continue;
                for (uint32_t i = 0; ok && i < owner->element_count; i++) {
                    const element *e = &t.mesh.elements[owner->first_element + i];
                    if (pass == 0) area += area_of(&t, e);
                    for (int k = 0; k < corner_count(e); k++) {
                        uint64_t high, low = pair_order(e->corner[k], e->corner[(k + 1) % corner_count(e)], &high);
                        uint32_t *sides = pair_map_at(&edges, low, high, 0);
                        if (!(ok = sides)) break;
                        if (pass == 0) ++*sides;
                        if (pass == 1 && *sides == 1) alone += vec3_distance(corner(&t, e, k), corner(&t, e, k + 1));
                    }
                }
            }
        CHECK(ok);
        /* Floats at 1000 m are off by 3e-5 m. */
        CHECK_NEAR(area / (5e5 * corners * sin(2.0 * PI / corners)), 1.0, 1e-6);
        CHECK_NEAR(alone / outline, 1.0, 1e-6);
        pair_map_free(&edges);
        pieces_free(&t);
    }
}

/* Elements that are halved to the size of their place are no smaller than half of it, about, and no larger. */
static void out_there_elements_grow_with_the_distance(void) {
    place p;
    pieces t;
    set_place(&p, 1000.0, 4);
    if (!cut(&p, 2000.0, &t)) return;
    double widest = 0.0;
    for (size_t i = 0; i < t.mesh.element_count; i++) {
        const element *e = &t.mesh.elements[i];
        double away = nearest(&t, e);
        if (away > 10.0) widest = fmax(widest, longest(&t, e) / away);
    }
    CHECK(widest > 0.1 && widest < 1.0);
    pieces_free(&t);
}

/* Nothing of a box is a ground beside the rest. */
static void walls_are_no_ground(void) {
    place p;
    wide_ground g;
    set_place(&p, 1000.0, 4);
    double area = find(&p.meshes[1], 1, &g);
    CHECK(!g.is_there);
    /* Six sides of 4 m2: exact in floats. */
    CHECK_NEAR(area, 24.0, 0);
    CHECK_EQUAL(wide_ground_size(&g, (double[]){ 0, 0, 0 }, (double[]){ 1000, 0, 0 }), 0.0);
    /* Nor of a hall of 200 m around it. */
    hemi_mesh_desc hall[2] = { p.meshes[1], p.meshes[1] };
    for (int k = 0; k < 3; k++) hall[0].transform[5 * k] = 100.0;
    CHECK_NEAR(find(hall, 2, &g), 240024.0, 1e-9);
    CHECK(!g.is_there);
    /* A panel that glows over the box is none, though as wide. */
    hemi_mesh_desc panel[3] = { p.meshes[0], p.meshes[1], p.meshes[1] };
    panel[2].material = 1, panel[2].transform[0] = panel[2].transform[5] = 20.0, panel[2].transform[14] = 5.0;
    find(panel, 3, &g);
    CHECK(g.is_there && g.radius > 20.0);
    /* And a light is one of the things, with what it lights: 6 m to either side of where it is. */
    const hemi_light_desc bulb = { .kind = HEMI_LIGHT_POINT, .position = { 100, 0, 3 } };
    wide_ground_find(&(wide_ground_scene){ p.meshes, 2, MATERIALS, &bulb, 1 }, &g);
    CHECK_NEAR(g.radius, 0.5 * sqrt(107.0 * 107.0 + 144.0 + 144.0), 1e-9);
    /* Lights alone make no ground wide. */
    const hemi_light_desc bulbs[2] = { bulb, { .kind = HEMI_LIGHT_POINT, .position = { 101, 0, 3 } } };
    double bare = wide_ground_find(&(wide_ground_scene){ p.meshes, 1, MATERIALS, bulbs, 2 }, &g);
    CHECK(!g.is_there && bare > 1e6);
    /* If the hall glows it is a dome, which is in the way of what is outside. */
    hall[0].material = 1;
    double beside = 2.0 + sqrt(12.0); /* half a diameter of the box on either side of it, on the floor of the dome */
    CHECK_NEAR(find(hall, 2, &g), 24.0 + beside * beside, 1e-9);
    CHECK(g.is_there && !g.is_plane);
    /* What glows and is as small as the box is a lamp: one of the things. */
    hemi_mesh_desc lit[3] = { p.meshes[0], p.meshes[1], p.meshes[1] };
    lit[2].material = 1, lit[2].transform[12] = 50.0;
    find(lit, 3, &g);
    CHECK(g.is_there && g.is_plane);
    CHECK_NEAR(g.radius, 0.5 * sqrt(52.0 * 52.0 + 8.0), 1e-9);
    /* And a ground with nothing on it is all that there is. */
    find(p.meshes, 1, &g);
    CHECK(!g.is_there);
}

int main(void) {
    RUN(near_things_a_wide_ground_is_as_fine_as_a_small_one);
    RUN(a_wide_ground_has_no_cracks);
    RUN(out_there_elements_grow_with_the_distance);
    RUN(walls_are_no_ground);
    return check_end();
}
