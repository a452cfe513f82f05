/* SPDX-License-Identifier: MIT
 * Does a proxy keep shape, hard edges, seams and shared borders, and are faults of the input counted?
 */
#include "check.h"

#include "closest_point.h"
#include "simplify.h"

#include "geometry/triangle.h"

#include <stdlib.h>

/* A mesh that a test builds. */
typedef struct dense {
    float *positions, *normals;
    uint32_t *indices;
    uint32_t vertex_count, triangle_count;
} dense;

static dense allocate(uint32_t vertices, uint32_t triangles) {
    return (dense){ .positions = calloc(3 * (size_t)vertices, sizeof(float)),
                    .normals = calloc(3 * (size_t)vertices, sizeof(float)),
                    .indices = calloc(3 * (size_t)triangles, sizeof(uint32_t)) };
}

static void release(dense *d) {
    free(d->positions);
    free(d->normals);
    free(d->indices);
}

static void add_triangle(dense *d, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *at = d->indices + 3 * (size_t)d->triangle_count++;
    at[0] = a, at[1] = b, at[2] = c;
}

/* n around, n / 2 + 1 rows, the meridian twice. */
static dense unit_sphere(uint32_t n) {
    uint32_t rows = n / 2 + 1;
    dense d = allocate((rows + 1) * (n + 1), 2 * n * rows);
    for (uint32_t r = 0; r <= rows; r++)
        for (uint32_t s = 0; s <= n; s++) {
            double polar = PI * r / rows, around = 2 * PI * (s % n) / n;
            const double p[3] = { sin(polar) * cos(around), cos(polar), -sin(polar) * sin(around) };
            /* Rounded to a grid, so that a pole is one place. */
            for (int k = 0; k < 3; k++)
                d.positions[3 * d.vertex_count + (size_t)k] = d.normals[3 * d.vertex_count + (size_t)k] =
                    (float)(round(p[k] * 1e6) / 1e6);
            d.vertex_count++;
        }
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t s = 0; s < n; s++) {
            uint32_t a = r * (n + 1) + s, b = a + n + 1;
            if (r < rows - 1) add_triangle(&d, a, b, b + 1);
            if (r > 0) add_triangle(&d, a, b + 1, a + 1);
        }
    return d;
}

/* A grid of n x n squares of 1 / n over x0 + (0..1) x (0..1) at height z(x, y). */
static dense unit_grid(uint32_t n, double x0, double (*z)(double x, double y)) {
    dense d = allocate((n + 1) * (n + 1), 2 * n * n);
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t j = 0; j <= n; j++) {
            float *p = d.positions + 3 * (size_t)d.vertex_count++;
            p[0] = (float)(x0 + (double)i / n), p[1] = (float)j / (float)n, p[2] = (float)z(p[0], p[1]);
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            uint32_t a = i * (n + 1) + j, b = a + n + 1;
            add_triangle(&d, a, b, b + 1);
            add_triangle(&d, a, b + 1, a + 1);
        }
    return d;
}

static hemi_mesh_desc desc_of(const dense *d, bool normals) {
    return (hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                             .positions = d->positions,
                             .normals = normals ? d->normals : NULL,
                             .vertex_count = d->vertex_count,
                             .indices = d->indices,
                             .triangle_count = d->triangle_count };
}

static simplify_mesh simplified(const hemi_mesh_desc *m, double edge, double deviation, simplify_check *census) {
    static const bool sided = false;
    const simplify_desc desc = {
        .meshes = &m, .double_sided = &sided, .mesh_count = 1, .edge = edge, .deviation = deviation
    };
    simplify_mesh out;
    CHECK_EQUAL(simplify_meshes(&desc, &out, census), HEMI_OK);
    return out;
}

/* Edges, by position, that do not have one triangle on each side. */
static uint32_t open_edges(const simplify_mesh *m) {
    uint32_t open = 0;
    for (uint32_t i = 0; i < 3 * m->triangle_count; i++) {
        int twins = 0;
        const float *a = m->positions + 3 * (size_t)m->indices[i];
        const float *b = m->positions + 3 * (size_t)m->indices[i % 3 == 2 ? i - 2 : i + 1];
        for (uint32_t j = 0; j < 3 * m->triangle_count; j++) {
            const float *c = m->positions + 3 * (size_t)m->indices[j];
            const float *d = m->positions + 3 * (size_t)m->indices[j % 3 == 2 ? j - 2 : j + 1];
            twins += memcmp(a, d, 3 * sizeof *a) == 0 && memcmp(b, c, 3 * sizeof *b) == 0;
        }
        open += twins != 1;
    }
    return open;
}

/* The largest distance of a dense vertex from the proxy. */
static double deviation_of(const dense *d, const simplify_mesh *m) {
    static const float any[3] = { 0, 0, 0 };
    closest_point *tree = closest_point_create(NULL, NULL, m->positions, m->indices, m->triangle_count);
    double largest = 0.0;
    for (size_t v = 0; v < d->vertex_count; v++)
        largest = fmax(largest, closest_point_find(tree, d->positions + 3 * v, any, 0.0, 0).distance);
    closest_point_destroy(tree);
    return largest;
}

static void a_sphere_stays_closed_and_near(void) {
    dense d = unit_sphere(120);
    hemi_mesh_desc m = desc_of(&d, true);
    simplify_check census;
    const double edge = 0.2;
    simplify_mesh s = simplified(&m, edge, 0.05, &census);
    double wanted = simplify_triangle_count(4 * PI, edge);
    /* meshoptimizer stops at the last collapse before the count. */
    CHECK(s.triangle_count > 0.9 * wanted && s.triangle_count < 1.02 * wanted);
    CHECK_EQUAL(open_edges(&s), 0);
    /* Equilateral facets would lie 0.0067 deep (edge^2 / 6); those of a greedy simplifier up to three times that. */
    CHECK(deviation_of(&d, &s) < 3 * edge * edge / 6);
    CHECK_EQUAL(census.degenerate_count + census.duplicate_count + census.nonmanifold_count, 0);
    /* Normals look outwards, on the proxy and on what it stands for: means of facets a tenth of a radian apart. */
    for (size_t v = 0; v < s.vertex_count; v++) {
        double along = 0.0;
        for (size_t k = 0; k < 3; k++) along += (double)s.normals[3 * v + k] * s.positions[3 * v + k];
        CHECK(along > 0.99);
    }
    CHECK_EQUAL(s.dense_vertex_count, d.vertex_count - 2); /* the meridian's second poles are in no triangle */
    simplify_mesh_free(&s);
    release(&d);
}

static void the_deviation_limits_how_coarse_it_gets(void) {
    dense d = unit_sphere(120);
    hemi_mesh_desc m = desc_of(&d, true);
    simplify_check census;
    uint32_t before = UINT32_MAX;
    for (double deviation = 0.001; deviation < 0.1; deviation *= 4) {
        simplify_mesh s = simplified(&m, 2.0, deviation, &census);
        /* meshoptimizer's measure is a mean over the planes that met in a vertex: the largest distance is more. */
        CHECK(deviation_of(&d, &s) < 3 * deviation);
        CHECK(s.triangle_count < before);
        before = s.triangle_count;
        simplify_mesh_free(&s);
    }
    release(&d);
}

static double fold(double x, double y) {
    (void)y;
    return x < 0.5 ? 0.0 : x - 0.5;
}

static void a_hard_edge_stays(void) {
    dense d = unit_grid(40, 0.0, fold);
    hemi_mesh_desc m = desc_of(&d, false);
    simplify_check census;
    simplify_mesh s = simplified(&m, 10.0, 0.005, &census);
    /* Four would do; a greedy simplifier leaves a few on borders and seams. */
    CHECK(s.triangle_count >= 4 && s.triangle_count <= 16);
    uint32_t on_fold = 0;
    for (size_t v = 0; v < s.vertex_count; v++) on_fold += s.positions[3 * v] == 0.5f;
    CHECK(on_fold >= 4 && on_fold % 2 == 0); /* a wedge for each side */
    /* In the dense mesh the vertices on the fold become two. */
    CHECK_EQUAL(s.dense_vertex_count, d.vertex_count + 41);
    for (size_t v = 0; v < s.vertex_count; v++) {
        double x = s.normals[3 * v], z = s.normals[3 * v + 2];
        /* A mean of equal float vectors: a rounding of each component. */
        CHECK(fabs(x) < 1e-6 || fabs(x + z) < 1e-6);
    }
    simplify_mesh_free(&s);
    release(&d);
}

/* Every other row of squares goes: strips are left, each with one edge of the fold, from border to border. */
static void leave_strips(dense *d, uint32_t n) {
    uint32_t kept = 0;
    for (uint32_t t = 0; t < d->triangle_count; t++)
        if (t / 2 % n % 2 == 0)
            memmove(d->indices + 3 * (size_t)kept++, d->indices + 3 * (size_t)t, 3 * sizeof(uint32_t));
    d->triangle_count = kept;
}

/* The rims of boards, of which each side is a sheet. */
static void hard_edges_end_at_borders(void) {
    enum { N = 40, STRIPS = N / 2 };
    dense d = unit_grid(N, 0.0, fold);
    leave_strips(&d, N);
    const hemi_mesh_desc m = desc_of(&d, false), *meshes[] = { &m };
    const bool sided[] = { false };
    const simplify_desc desc = {
        .meshes = meshes, .double_sided = sided, .mesh_count = 1, .edge = 10.0, .deviation = 0.005, .roughest = 0.5
    };
    simplify_check census;
    simplify_mesh s;
    CHECK_EQUAL(simplify_meshes(&desc, &s, &census), HEMI_OK);
    CHECK_EQUAL(s.dense_vertex_count, STRIPS * (2 * (N + 1) + 2));
    uint32_t on_fold = 0;
    for (size_t v = 0; v < s.vertex_count; v++) on_fold += s.positions[3 * v] == 0.5f;
    CHECK_EQUAL(on_fold, 4 * STRIPS);
    simplify_mesh_free(&s);
    release(&d);
}

static double rough(double x, double y) {
    double n = sin(12.9898 * x * 1000 + 78.233 * y * 1000) * 43758.5453;
    return 0.002 * (n - floor(n));
}

/* A scan: height noise of a tenth of a triangle turns many edges by more than 20 degrees, here and there. */
static void noise_is_no_hard_edge(void) {
    dense d = unit_grid(100, 0.0, rough);
    hemi_mesh_desc m = desc_of(&d, false);
    simplify_check census;
    simplify_mesh s = simplified(&m, 0.2, 0.01, &census);
    CHECK_EQUAL(s.dense_vertex_count, d.vertex_count);
    CHECK(s.triangle_count < 200);
    simplify_mesh_free(&s);
    release(&d);
}

static double area_of(const simplify_mesh *m) {
    double area = 0.0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++) vec3_from_floats(p[k], m->positions + 3 * (size_t)m->indices[3 * t + k]);
        area += triangle_area(p[0], p[1], p[2]);
    }
    return area;
}

/* N x N boxes side by side, of uneven heights. */
static dense boxes(uint32_t n) {
    static const uint8_t quads[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
                                         { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
    dense d = allocate(8 * n * n, 12 * n * n);
    for (uint32_t i = 0; i < n * n; i++) {
        uint32_t first = d.vertex_count;
        for (uint32_t corner = 0; corner < 8; corner++) {
            float *p = d.positions + 3 * (size_t)d.vertex_count++;
            p[0] = (float)(i % n) * 3.0f + (float)(corner & 1);
            p[1] = (float)(i / n) * 3.0f + (float)(corner >> 1 & 1);
            p[2] = (float)(corner >> 2) * (0.5f + (float)(i * 7 % 5) * 0.2f);
        }
        for (int q = 0; q < 6; q++) {
            add_triangle(&d, first + quads[q][0], first + quads[q][1], first + quads[q][2]);
            add_triangle(&d, first + quads[q][0], first + quads[q][2], first + quads[q][3]);
        }
    }
    return d;
}

/* Of small things that a rough mesh may be off by most stay: it may be off by less then. */
static void a_crowd_of_boxes_is_no_roughness(void) {
    enum { N = 60 };
    dense d = boxes(N);
    const hemi_mesh_desc m = desc_of(&d, false), *meshes[] = { &m };
    const bool sided[] = { false };
    const simplify_desc desc = {
        .meshes = meshes, .double_sided = sided, .mesh_count = 1, .edge = 12.0, .deviation = 0.3, .roughest = 3.0
    };
    simplify_check census;
    simplify_mesh s;
    CHECK_EQUAL(simplify_meshes(&desc, &s, &census), HEMI_OK);
    double area = 0.0;
    for (uint32_t i = 0; i < N * N; i++) area += 2.0 + 4.0 * (0.5 + (i * 7 % 5) * 0.2);
    printf("boxes: %u of %u triangles, %.2f of the area\n", (unsigned)s.triangle_count, (unsigned)d.triangle_count,
           area_of(&s) / area);
    CHECK(area_of(&s) >= 0.5 * area);
    simplify_mesh_free(&s);
    release(&d);
}

/* A ball that may be off by half of its radius, as a tube of neon by all of it. */
static void what_glows_keeps_its_area(void) {
    dense d = unit_sphere(60);
    const hemi_mesh_desc m = desc_of(&d, true), *meshes[] = { &m };
    const bool sided[] = { false };
    simplify_desc desc = { .meshes = meshes, .double_sided = sided, .mesh_count = 1, .edge = 2.0, .deviation = 0.5 };
    simplify_check census;
    simplify_mesh any, kept;
    CHECK_EQUAL(simplify_meshes(&desc, &any, &census), HEMI_OK);
    desc.keeps_area = true;
    CHECK_EQUAL(simplify_meshes(&desc, &kept, &census), HEMI_OK);
    printf("a ball of area %.2f: %.2f, or %.2f where it is kept, of %u triangles\n", 4 * PI, area_of(&any),
           area_of(&kept), (unsigned)kept.triangle_count);
    CHECK(area_of(&any) < 0.8 * 4 * PI);
    CHECK(area_of(&kept) > 0.965 * 4 * PI && kept.triangle_count < d.triangle_count / 4);
    simplify_mesh_free(&any);
    simplify_mesh_free(&kept);
    release(&d);
}

static double bump(double x, double y) {
    return 0.1 * sin(3 * x) * cos(3 * y);
}

static void meshes_that_share_a_border_stay_joined(void) {
    dense a = unit_grid(40, 0.0, bump), b = unit_grid(40, 1.0, bump);
    /* The same floats on both sides. */
    for (uint32_t j = 0; j <= 40; j++)
        memcpy(b.positions + 3 * (size_t)j, a.positions + 3 * ((size_t)40 * 41 + j), 3 * sizeof(float));
    hemi_mesh_desc one = desc_of(&a, false), other = desc_of(&b, false);
    const hemi_mesh_desc *meshes[] = { &one, &other };
    const bool sided[] = { false, false };
    const simplify_desc desc = {
        .meshes = meshes, .double_sided = sided, .mesh_count = 2, .edge = 0.3, .deviation = 0.01
    };
    uint32_t group[2];
    simplify_check census;
    simplify_mesh out[2];
    CHECK_EQUAL(simplify_find_groups(NULL, meshes, 2, group), HEMI_OK);
    CHECK_EQUAL(group[1], 0);
    CHECK_EQUAL(simplify_meshes(&desc, out, &census), HEMI_OK);
    uint32_t on_border[2] = { 0, 0 }, shared = 0;
    for (int i = 0; i < 2; i++)
        for (size_t v = 0; v < out[i].vertex_count; v++) on_border[i] += out[i].positions[3 * v] == 1.0f;
    for (size_t v = 0; v < out[0].vertex_count; v++)
        for (size_t w = 0; w < out[1].vertex_count; w++)
            shared += out[0].positions[3 * v] == 1.0f &&
                      memcmp(out[0].positions + 3 * v, out[1].positions + 3 * w, 3 * sizeof(float)) == 0;
    CHECK(on_border[0] < 20);
    CHECK_EQUAL(on_border[0], shared);
    CHECK_EQUAL(on_border[1], shared);
    for (int i = 0; i < 2; i++) simplify_mesh_free(&out[i]);
    release(&a);
    release(&b);
}

static void faults_are_counted_and_left_out(void) {
    dense d = unit_grid(10, 0.0, fold);
    d.indices = realloc(d.indices, 3 * (size_t)(d.triangle_count + 3) * sizeof *d.indices);
    add_triangle(&d, d.indices[1], d.indices[2], d.indices[0]); /* the first once more, from another corner */
    add_triangle(&d, 0, 0, 5);
    add_triangle(&d, 12, 24, 62); /* a third on the diagonal of a square */
    hemi_mesh_desc m = desc_of(&d, false);
    simplify_check census;
    simplify_mesh s = simplified(&m, 10.0, 1e-4, &census);
    CHECK_EQUAL(census.duplicate_count, 1);
    CHECK_EQUAL(census.degenerate_count, 1);
    CHECK_EQUAL(census.nonmanifold_count, 1);
    simplify_mesh_free(&s);
    release(&d);
}

/* A book of 200,000 pages: all triangles share one edge, and all edges one vertex. */
static void a_book_of_many_pages_takes_no_time(void) {
    enum { PAGES = 200000 };
    dense d = allocate(PAGES + 2, PAGES);
    d.positions[5] = 1.0f;
    d.vertex_count = 2;
    for (uint32_t i = 0; i < PAGES; i++) {
        d.positions[3 * (size_t)d.vertex_count] = (float)cos(2 * PI * i / PAGES);
        d.positions[3 * (size_t)d.vertex_count + 1] = (float)sin(2 * PI * i / PAGES);
        add_triangle(&d, 0, 1, d.vertex_count++);
    }
    hemi_mesh_desc m = desc_of(&d, false);
    simplify_check census;
    simplify_mesh s = simplified(&m, 10.0, 1e-4, &census);
    CHECK(census.nonmanifold_count >= 1);
    simplify_mesh_free(&s);
    release(&d);
}

int main(void) {
    RUN(a_sphere_stays_closed_and_near);
    RUN(the_deviation_limits_how_coarse_it_gets);
    RUN(a_hard_edge_stays);
    RUN(hard_edges_end_at_borders);
    RUN(noise_is_no_hard_edge);
    RUN(a_crowd_of_boxes_is_no_roughness);
    RUN(what_glows_keeps_its_area);
    RUN(meshes_that_share_a_border_stay_joined);
    RUN(faults_are_counted_and_left_out);
    RUN(a_book_of_many_pages_takes_no_time);
    return check_end();
}
