/* SPDX-License-Identifier: MIT
 * Is the limit of a cage with creases, corners, holes and n-gons the one that OpenSubdiv's other evaluators find, and
 * do areas converge? Two independent ways: limit masks after refining past every sharpness, and limit stencils of
 * feature-adaptive patches, on cages written here once more as OpenSubdiv takes them. */
extern "C" {
#include "subdivide.h"
}
#include "check.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <memory>
#include <vector>

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

/* ---- cages ------------------------------------------------------------------------------------------------------- */

struct polygons {
    std::vector<float> positions, attributes;
    std::vector<uint32_t> sizes, corners, creases, points, holes;
    std::vector<float> crease_sharpness, point_sharpness;
    hemi_subdivision_scheme scheme = HEMI_SUBDIVISION_CATMULL_CLARK;
    uint32_t attribute_count = 0;
};

/* Corner v at the signs of its bits. */
static polygons cube(float sharpness) {
    polygons p;
    for (int i = 0; i < 24; i++) p.positions.push_back((i / 3) >> (i % 3) & 1 ? 1.0f : -1.0f);
    p.sizes.assign(6, 4);
    p.corners = { 0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5 };
    p.creases = { 4, 5, 5, 7, 7, 6, 6, 4 }; /* around the top */
    p.crease_sharpness.assign(4, sharpness);
    return p;
}

static polygons cornered_cube() {
    polygons p = cube(2.5f);
    p.points = { 0, 3 };
    p.point_sharpness = { 10.0f, 1.75f };
    return p;
}

/* Six sides: hexagons above and below, squares around; one of them a hole. */
static polygons prism(bool with_hole) {
    polygons p;
    for (int i = 0; i < 12; i++) {
        double angle = std::acos(-1.0) * i / 3.0;
        p.positions.insert(p.positions.end(), { float(std::cos(angle)), float(std::sin(angle)), i < 6 ? -0.5f : 0.7f });
    }
    p.sizes = { 6, 6 };
    p.corners = { 5, 4, 3, 2, 1, 0, 6, 7, 8, 9, 10, 11 };
    for (uint32_t i = 0; i < 6; i++) {
        uint32_t next = (i + 1) % 6;
        p.sizes.push_back(4);
        p.corners.insert(p.corners.end(), { i, next, 6 + next, 6 + i });
        p.creases.insert(p.creases.end(), { 6 + i, 6 + next });
        p.crease_sharpness.push_back(1.0f + 0.4f * float(i));
    }
    if (with_hole) p.holes = { 3 };
    return p;
}

static polygons octahedron(float sharpness) {
    polygons p;
    p.scheme = HEMI_SUBDIVISION_LOOP;
    p.positions = { 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1.3f };
    p.sizes.assign(8, 3);
    p.corners = { 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5 };
    p.creases = { 0, 2, 2, 1, 1, 3, 3, 0 };
    p.crease_sharpness.assign(4, sharpness);
    return p;
}

static polygons bilinear_cube() {
    polygons p = cube(0.0f);
    p.positions[23] = 1.5f;
    p.scheme = HEMI_SUBDIVISION_BILINEAR;
    return p;
}

static polygons open_grid() {
    polygons p;
    for (int i = 0; i < 16; i++)
        p.positions.insert(p.positions.end(), { float(i % 4), float(i / 4), i == 5 || i == 11 ? 1.0f : 0.0f });
    for (uint32_t i = 0; i < 9; i++) {
        uint32_t v = i / 3 * 4 + i % 3;
        p.sizes.push_back(4);
        p.corners.insert(p.corners.end(), { v, v + 1, v + 5, v + 4 });
    }
    p.creases = { 5, 6, 6, 10 };
    p.crease_sharpness = { 3.0f, 10.0f };
    return p;
}

/* ---- ours -------------------------------------------------------------------------------------------------------- */

static std::vector<uint32_t> fans(const polygons &p) {
    std::vector<uint32_t> indices;
    size_t at = 0;
    for (uint32_t size : p.sizes) {
        for (uint32_t k = 2; k < size; k++)
            indices.insert(indices.end(), { p.corners[at], p.corners[at + k - 1], p.corners[at + k] });
        at += size;
    }
    return indices;
}

static subdivide_surface ours(const polygons &p, uint32_t level,
                              hemi_tessellation_rule tessellation = HEMI_TESSELLATION_UNIFORM,
                              hemi_boundary boundary = HEMI_BOUNDARY_DEFAULT) {
    std::vector<uint32_t> indices = fans(p);
    hemi_mesh_desc m = {};
    hemi_subdivision_desc how = {};
    char message[SUBDIVIDE_MESSAGE_SIZE];
    subdivide_surface out;
    m.struct_size = sizeof m;
    m.positions = p.positions.data();
    m.vertex_count = uint32_t(p.positions.size() / 3);
    m.attributes = p.attributes.empty() ? nullptr : p.attributes.data();
    m.attribute_count = p.attribute_count;
    m.indices = indices.data();
    m.triangle_count = uint32_t(indices.size() / 3);
    m.subdivision = &how;
    how.struct_size = sizeof how;
    how.scheme = p.scheme;
    how.level = level;
    how.tessellation = tessellation;
    how.boundary = boundary;
    how.face_sizes = p.sizes.data();
    how.face_count = uint32_t(p.sizes.size());
    how.crease_edges = p.creases.data();
    how.crease_sharpness = p.crease_sharpness.data();
    how.crease_count = uint32_t(p.crease_sharpness.size());
    how.corner_vertices = p.points.data();
    how.corner_sharpness = p.point_sharpness.data();
    how.corner_count = uint32_t(p.points.size());
    how.holes = p.holes.data();
    how.hole_count = uint32_t(p.holes.size());
    CHECK_EQUAL(subdivide_mesh(NULL, &m, 0, &out, message), HEMI_OK);
    CHECK_TEXT(message, "");
    return out;
}

/* ---- OpenSubdiv's ------------------------------------------------------------------------------------------------ */

struct point {
    double x[3];
    void Clear() { x[0] = x[1] = x[2] = 0.0; }
    void AddWithWeight(const point &other, double weight) {
        for (int k = 0; k < 3; k++) x[k] += weight * other.x[k];
    }
};

static std::unique_ptr<Far::TopologyRefiner> refiner_of(const polygons &p) {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::vector<int> sizes(p.sizes.begin(), p.sizes.end()), corners(p.corners.begin(), p.corners.end());
    std::vector<int> creases(p.creases.begin(), p.creases.end()), points(p.points.begin(), p.points.end());
    std::vector<int> holes(p.holes.begin(), p.holes.end());
    Far::TopologyDescriptor d;
    d.numVertices = int(p.positions.size() / 3);
    d.numFaces = int(sizes.size());
    d.numVertsPerFace = sizes.data();
    d.vertIndicesPerFace = corners.data();
    d.numCreases = int(p.crease_sharpness.size());
    d.creaseVertexIndexPairs = creases.data();
    d.creaseWeights = p.crease_sharpness.data();
    d.numCorners = int(points.size());
    d.cornerVertexIndices = points.data();
    d.cornerWeights = p.point_sharpness.data();
    d.numHoles = int(holes.size());
    d.holeIndices = holes.data();
    Sdc::SchemeType type = p.scheme == HEMI_SUBDIVISION_LOOP       ? Sdc::SCHEME_LOOP
                           : p.scheme == HEMI_SUBDIVISION_BILINEAR ? Sdc::SCHEME_BILINEAR
                                                                   : Sdc::SCHEME_CATMARK;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(d, Factory::Options(type, options)));
}

static std::vector<point> control_points(const polygons &p) {
    std::vector<point> out(p.positions.size() / 3);
    for (size_t i = 0; i < p.positions.size(); i++) out[i / 3].x[i % 3] = p.positions[i];
    return out;
}

/* Limits of the vertices of `level` by the masks of `deep`, where no sharpness is left. */
static std::vector<point> by_masks(const polygons &p, int level, int deep) {
    std::unique_ptr<Far::TopologyRefiner> refiner = refiner_of(p);
    Far::TopologyRefiner::UniformOptions options(deep);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    Far::PrimvarRefinerReal<double> primvars(*refiner);
    std::vector<point> coarse = control_points(p);
    for (int i = 1; i <= deep; i++) {
        std::vector<point> fine(size_t(refiner->GetLevel(i).GetNumVertices()));
        primvars.Interpolate(i, coarse, fine);
        coarse.swap(fine);
    }
    std::vector<point> limit(coarse.size()), out;
    primvars.Limit(coarse, limit);
    const Far::TopologyLevel &at = refiner->GetLevel(level);
    for (int v = 0; v < at.GetNumVertices(); v++) {
        int child = v, faces = 0;
        for (int f : std::vector<int>(at.GetVertexFaces(v).begin(), at.GetVertexFaces(v).end()))
            faces += !at.IsFaceHole(f);
        for (int i = level; i < deep; i++) child = refiner->GetLevel(i).GetVertexChildVertex(child);
        if (faces) out.push_back(limit[size_t(child)]);
    }
    return out;
}

/* Limits on a grid of every patch face by feature-adaptive limit stencils; quads and triangles only. */
static std::vector<point> by_stencils(const polygons &p, int rate) {
    using Factory = Far::LimitStencilTableFactoryReal<double>;
    std::unique_ptr<Far::TopologyRefiner> refiner = refiner_of(p);
    Far::PatchTableFactory::Options patches(10);
    patches.useInfSharpPatch = true;
    patches.endCapType = Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS;
    refiner->RefineAdaptive(patches.GetRefineAdaptiveOptions());
    std::vector<double> s, t;
    for (int i = 0; i <= rate; i++)
        for (int k = 0; k <= rate - (p.scheme == HEMI_SUBDIVISION_LOOP ? i : 0); k++)
            s.push_back(double(i) / rate), t.push_back(double(k) / rate);
    Factory::LocationArrayVec locations;
    for (int f = 0; f < int(p.sizes.size()); f++) {
        Factory::LocationArray one;
        one.ptexIdx = f;
        one.numLocations = int(s.size());
        one.s = s.data();
        one.t = t.data();
        locations.push_back(one);
    }
    Factory::Options options;
    std::unique_ptr<const Far::LimitStencilTableReal<double>> table(
        Factory::Create(*refiner, locations, nullptr, nullptr, options));
    std::vector<point> controls = control_points(p), out(size_t(table->GetNumStencils()));
    table->UpdateValues(controls, out);
    return out;
}

/* ---- comparing --------------------------------------------------------------------------------------------------- */

/* The distance from each point to the nearest vertex, at most. */
static double farthest(const std::vector<point> &points, const subdivide_surface &s) {
    double most = 0.0;
    for (const point &p : points) {
        double nearest = HUGE_VAL;
        for (size_t v = 0; v < s.vertex_count; v++) {
            double square = 0.0;
            for (size_t k = 0; k < 3; k++)
                square += (p.x[k] - double(s.positions[3 * v + k])) * (p.x[k] - double(s.positions[3 * v + k]));
            nearest = std::fmin(nearest, square);
        }
        most = std::fmax(most, std::sqrt(nearest));
    }
    return most;
}

static double area(const subdivide_surface &s) {
    double sum = 0.0;
    for (size_t t = 0; t < s.triangle_count; t++) {
        double u[3], v[3], square = 0.0;
        const uint32_t *c = s.indices + 3 * t;
        for (size_t k = 0; k < 3; k++) {
            u[k] = double(s.positions[3 * c[1] + k]) - double(s.positions[3 * c[0] + k]);
            v[k] = double(s.positions[3 * c[2] + k]) - double(s.positions[3 * c[0] + k]);
        }
        for (int k = 0; k < 3; k++) {
            double n = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
            square += n * n;
        }
        sum += 0.5 * std::sqrt(square);
    }
    return sum;
}

struct named_cage {
    const char *name;
    polygons cage;
};

static const std::vector<named_cage> &cages() {
    static const std::vector<named_cage> all = {
        { "cube, creases 1.3", cube(1.3f) },
        { "cube, creases 3", cube(3.0f) },
        { "cube, creases 10", cube(10.0f) },
        { "cube, creases and corners", cornered_cube() },
        { "prism, creases 1 to 3", prism(false) },
        { "prism with a hole", prism(true) },
        { "octahedron, creases 2.2", octahedron(2.2f) },
        { "octahedron, creases 10", octahedron(10.0f) },
        { "open grid, creases", open_grid() },
        { "bilinear cube", bilinear_cube() },
    };
    return all;
}

/* ---- tests ------------------------------------------------------------------------------------------------------- */

/* Positions are floats of size 2 at most: half of 2^-23 on three axes is 1.1e-7. The figure asked for is 1e-6. */
static void limits_are_those_of_limit_masks(void) {
    for (const named_cage &one : cages())
        for (uint32_t level = 1; level <= 3; level++) {
            subdivide_surface s = ours(one.cage, level);
            double off = farthest(by_masks(one.cage, int(level), 5), s);
            printf("  %-28s level %u, limit masks: off by %.2g\n", one.name, level, off);
            CHECK_NEAR(off, 0.0, 1e-6);
            subdivide_surface_destroy(&s);
        }
}

static void limits_are_those_of_adaptive_patches(void) {
    for (const named_cage &one : cages()) {
        /* n-gons have other patch faces; where hard edges end inside the grid the patches of Far end in a Gregory patch
         * that is off by 4e-4 at that vertex however deep they go, which the masks above are not. */
        if (one.cage.sizes[0] > 4 || one.cage.holes.size() || one.cage.sizes.size() == 9) continue;
        subdivide_surface s = ours(one.cage, 3);
        double off = farthest(by_stencils(one.cage, 8), s);
        printf("  %-28s limit stencils: off by %.2g\n", one.name, off);
        CHECK_NEAR(off, 0.0, 1e-6);
        subdivide_surface_destroy(&s);
    }
}

/* Why masks alone do not do: at level 1 they take what is left of sharpness 3 for infinite. */
static void masks_before_sharpness_runs_out_are_wrong(void) {
    subdivide_surface s = ours(cube(3.0f), 1);
    double off = farthest(by_masks(cube(3.0f), 1, 1), s);
    printf("  masks at level 1 of sharpness 3: off by %.3f\n", off);
    CHECK(off > 1e-3);
    subdivide_surface_destroy(&s);
}

/* Chords of half the length leave a quarter of the error; across creases that end it is 2 to 8. */
static void areas_converge(void) {
    for (const named_cage &one : cages()) {
        double a[5];
        for (uint32_t level = 2; level <= 6; level++) {
            subdivide_surface s = ours(one.cage, level);
            a[level - 2] = area(s);
            subdivide_surface_destroy(&s);
        }
        double order = std::log2(std::fabs((a[3] - a[2]) / (a[4] - a[3])));
        printf("  %-28s area %.6f, last step %.1e, order %.2f\n", one.name, a[4], a[4] - a[3], order);
        CHECK(std::fabs(a[4] - a[3]) < 1e-3 * a[4]);
        CHECK(order > 1.5 && order < 3.0);
    }
}

/* Every vertex of an adaptive surface is one of the uniform surface of its level, its edges fit, and a flat or even
 * face has fewer of them. */
static void adaptive_surfaces_are_coarser_and_closed(void) {
    for (const named_cage &one : cages()) {
        subdivide_surface fine = ours(one.cage, 5), s = ours(one.cage, 5, HEMI_TESSELLATION_ADAPTIVE);
        printf("  %-28s %u triangles of %u, area off by %.1e\n", one.name, s.triangle_count, fine.triangle_count,
               std::fabs(area(s) / area(fine) - 1.0));
        CHECK(s.triangle_count <= fine.triangle_count);
        /* Chords of 10 degrees lose 0.13 % of an arc's length at most, twice that of an area. */
        CHECK_NEAR(area(s), area(fine), 3e-3 * area(fine));
        subdivide_surface_destroy(&fine);
        subdivide_surface_destroy(&s);
    }
}

static bool same_place(const subdivide_surface &s, uint32_t a, uint32_t b) {
    return memcmp(s.positions + 3 * size_t(a), s.positions + 3 * size_t(b), 3 * sizeof(float)) == 0;
}

/* Edges without a partner that runs the other way between the same places. */
static size_t open_edges(const subdivide_surface &s) {
    size_t open = 0, count = 3 * size_t(s.triangle_count);
    auto end = [&](size_t i) { return s.indices[i % 3 == 2 ? i - 2 : i + 1]; };
    for (size_t i = 0; i < count; i++) {
        size_t partners = 0;
        for (size_t k = 0; k < count; k++)
            partners += same_place(s, s.indices[i], end(k)) && same_place(s, end(i), s.indices[k]);
        open += partners != 1;
    }
    return open;
}

static void closed_cages_stay_closed_to_the_bit(void) {
    for (const named_cage &one : cages()) {
        if (one.cage.holes.size() || one.cage.sizes.size() == 9) continue;
        for (int refinement = 0; refinement < 2; refinement++) {
            subdivide_surface s = ours(one.cage, 3, hemi_tessellation_rule(refinement));
            CHECK_EQUAL(open_edges(s), 0);
            subdivide_surface_destroy(&s);
        }
    }
}

static void hard_edges_have_two_normals_and_soft_ones_one(void) {
    subdivide_surface hard = ours(cube(10.0f), 2), soft = ours(cube(3.0f), 2);
    /* Around the top, 4 edges of 4 pieces: 16 places. */
    CHECK_EQUAL(hard.vertex_count, 6 * 16 + 2 + 16);
    CHECK_EQUAL(soft.vertex_count, 6 * 16 + 2);
    subdivide_surface_destroy(&hard);
    subdivide_surface_destroy(&soft);
}

static void holes_are_left_out(void) {
    subdivide_surface whole = ours(prism(false), 2), holed = ours(prism(true), 2);
    CHECK_EQUAL(whole.triangle_count - holed.triangle_count, 2 * 16);
    CHECK_EQUAL(open_edges(holed), 4 * 4);
    subdivide_surface_destroy(&whole);
    subdivide_surface_destroy(&holed);
}

static void boundary_rules_differ(void) {
    polygons p = open_grid();
    subdivide_surface corners = ours(p, 2);
    subdivide_surface edges = ours(p, 2, HEMI_TESSELLATION_UNIFORM, HEMI_BOUNDARY_EDGE_ONLY);
    subdivide_surface none = ours(p, 2, HEMI_TESSELLATION_UNIFORM, HEMI_BOUNDARY_NONE);
    std::vector<point> corner = { { { 0, 0, 0 } } };
    CHECK_NEAR(farthest(corner, corners), 0.0, 0.0);
    /* A uniform cubic B-spline curve ends at (1 - 1/6) of its corner's edges: 1/6 on each axis, a bit less on a face.
     */
    CHECK(farthest(corner, edges) > 0.1);
    CHECK_EQUAL(none.triangle_count, 2 * 16); /* the face in the middle */
    subdivide_surface_destroy(&corners);
    subdivide_surface_destroy(&edges);
    subdivide_surface_destroy(&none);
}

/* A cube whose faces have a unit square of texture each: 24 vertices. */
static void seams_do_not_tear_the_surface_and_keep_their_coordinates(void) {
    polygons whole = cube(0.0f), p = whole;
    static const float square[8] = { 0, 0, 1, 0, 1, 1, 0, 1 };
    p.positions.clear();
    p.creases.clear();
    p.crease_sharpness.clear();
    for (uint32_t c = 0; c < 24; c++) {
        const float *at = &whole.positions[3 * whole.corners[c]];
        p.positions.insert(p.positions.end(), at, at + 3);
        p.attributes.insert(p.attributes.end(), square + 2 * (c % 4), square + 2 * (c % 4) + 2);
        p.corners[c] = c;
    }
    for (size_t c = 0; c < 24; c++) p.attributes[2 * c] += float(c / 4); /* side by side */
    p.attribute_count = 2;
    subdivide_surface s = ours(p, 3), plain = ours(whole, 3);
    CHECK_EQUAL(open_edges(s), 0);
    CHECK_EQUAL(s.attribute_count, 2);
    CHECK_EQUAL(s.vertex_count, 6 * 81);
    std::vector<point> places(s.vertex_count);
    double low = 9.0, high = -9.0;
    for (size_t i = 0; i < 3 * size_t(s.vertex_count); i++) places[i / 3].x[i % 3] = s.positions[i];
    for (size_t i = 0; i < 2 * size_t(s.vertex_count); i++) {
        low = std::fmin(low, s.attributes[i]);
        high = std::fmax(high, s.attributes[i]);
    }
    CHECK_NEAR(farthest(places, plain), 0.0, 1e-6); /* the same evaluator, on a cage welded from other vertices */
    CHECK_NEAR(low, 0.0, 1e-7);
    CHECK_NEAR(high, 6.0, 1e-6);
    subdivide_surface_destroy(&s);
    subdivide_surface_destroy(&plain);
}

int main(void) {
    RUN(limits_are_those_of_limit_masks);
    RUN(limits_are_those_of_adaptive_patches);
    RUN(masks_before_sharpness_runs_out_are_wrong);
    RUN(areas_converge);
    RUN(adaptive_surfaces_are_coarser_and_closed);
    RUN(closed_cages_stay_closed_to_the_bit);
    RUN(hard_edges_have_two_normals_and_soft_ones_one);
    RUN(holes_are_left_out);
    RUN(boundary_rules_differ);
    RUN(seams_do_not_tear_the_surface_and_keep_their_coordinates);
    return check_end();
}
