/* SPDX-License-Identifier: MIT
 * Where is the limit surface of a cage? Each face of the cage is tessellated by the rates of its edges and evaluated in
 * double by OpenSubdiv's Bfr (base face representation), which refines as deep as creases and extraordinary vertices
 * ask for. Points on vertices and edges are found by topology, so neighbours share them to the bit.
 *
 * Tried and left: uniform refinement with limit masks (Far::PrimvarRefiner) gives the same points, but takes an edge
 * whose sharpness has not yet run out as smooth: 0.03 of the edge away at sharpness 3 and level 1
 * (tests/converters/subdivide/evaluator_test.cpp). */
#include "osd_shim.h"

#include "geometry/vec3.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/tessellation.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using limit_surface = Bfr::Surface<double>;

namespace {

/* Isolation of what is sharp, which runs out after as many levels as its sharpness says, and of extraordinary vertices:
 * below the points that are evaluated. */
const int sharp_levels = 10, smooth_levels_below = 2;

/* ---- the cage as OpenSubdiv sees it ---------------------------------------------------------------------------- */

Sdc::SchemeType scheme_of(hemi_subdivision_scheme s) {
    return s == HEMI_SUBDIVISION_LOOP       ? Sdc::SCHEME_LOOP
           : s == HEMI_SUBDIVISION_BILINEAR ? Sdc::SCHEME_BILINEAR
                                            : Sdc::SCHEME_CATMARK;
}

Sdc::Options rules_of(const hemi_subdivision_desc &how) {
    using rule = Sdc::Options;
    static const rule::FVarLinearInterpolation linear[] = { rule::FVAR_LINEAR_CORNERS_PLUS1,
                                                            rule::FVAR_LINEAR_NONE,
                                                            rule::FVAR_LINEAR_CORNERS_ONLY,
                                                            rule::FVAR_LINEAR_CORNERS_PLUS1,
                                                            rule::FVAR_LINEAR_CORNERS_PLUS2,
                                                            rule::FVAR_LINEAR_BOUNDARIES,
                                                            rule::FVAR_LINEAR_ALL };
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(how.boundary == HEMI_BOUNDARY_NONE        ? rule::VTX_BOUNDARY_NONE
                                        : how.boundary == HEMI_BOUNDARY_EDGE_ONLY ? rule::VTX_BOUNDARY_EDGE_ONLY
                                                                                  : rule::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetFVarLinearInterpolation(linear[how.face_varying]);
    return options;
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(const cage &c, const hemi_subdivision_desc &how) {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Far::TopologyDescriptor d;
    Far::TopologyDescriptor::FVarChannel channel;
    d.numVertices = static_cast<int>(c.vertex_count);
    d.numFaces = static_cast<int>(c.face_count);
    d.numVertsPerFace = c.sizes;
    d.vertIndicesPerFace = c.corners;
    d.numCreases = static_cast<int>(c.crease_count);
    d.creaseVertexIndexPairs = c.creases;
    d.creaseWeights = c.crease_sharpness;
    d.numCorners = static_cast<int>(c.point_count);
    d.cornerVertexIndices = c.points;
    d.cornerWeights = c.point_sharpness;
    d.numHoles = static_cast<int>(c.hole_count);
    d.holeIndices = c.holes;
    channel.numValues = static_cast<int>(c.value_count);
    channel.valueIndices = c.value_corners;
    d.numFVarChannels = c.value_width ? 1 : 0;
    d.fvarChannels = &channel;
    return std::unique_ptr<Far::TopologyRefiner>(
        Factory::Create(d, Factory::Options(scheme_of(how.scheme), rules_of(how))));
}

/* ---- one face -------------------------------------------------------------------------------------------------- */

/* The limit surface of a face, ready to be evaluated. */
struct face_limit {
    limit_surface surface, values;
    std::vector<double> points, value_points;
    double span = 0.0; /* of its control points */
};

/* The angle between two directions; 0 if one of them is none. */
double angle_between(const double *a, const double *b) {
    double normal[3];
    vec3_cross(normal, a, b);
    return std::atan2(vec3_length(normal), vec3_dot(a, b));
}

/* What evaluation gives at the coordinates of a tessellation. */
struct face_samples {
    std::vector<double> coordinates, positions, normals, values;

    void evaluate(const face_limit &face, const Bfr::Tessellation &pattern, size_t value_width);
};

void face_samples::evaluate(const face_limit &face, const Bfr::Tessellation &pattern, size_t value_width) {
    size_t count = size_t(pattern.GetNumCoords());
    int width = int(value_width);
    coordinates.resize(2 * count);
    positions.resize(3 * count);
    normals.resize(3 * count);
    values.resize(value_width * count);
    pattern.GetCoords(coordinates.data());
    for (size_t i = 0; i < count; i++) {
        double along[3], across[3];
        face.surface.Evaluate(&coordinates[2 * i], face.points.data(), 3, &positions[3 * i], along, across);
        vec3_cross(&normals[3 * i], along, across);
        if (!(vec3_length(&normals[3 * i]) > OSD_NO_TANGENT * face.span * face.span))
            std::fill_n(&normals[3 * i], 3, 0.0);
        if (width) face.values.Evaluate(&coordinates[2 * i], face.value_points.data(), width, &values[value_width * i]);
    }
}

Bfr::Tessellation::Options pattern_options() {
    return Bfr::Tessellation::Options().SetFacetSize(4).PreserveQuads(true);
}

std::vector<int> facets_of(const Bfr::Tessellation &pattern) {
    std::vector<int> facets(4 * size_t(pattern.GetNumFacets()));
    pattern.GetFacets(facets.data());
    return facets;
}

/* ---- rates ----------------------------------------------------------------------------------------------------- */

/* By how much the normals of neighbours in the pattern differ at most. */
double largest_turn(const Bfr::Tessellation &pattern, const face_samples &samples) {
    std::vector<int> facets = facets_of(pattern);
    double largest = 0.0;
    for (size_t f = 0; f < facets.size(); f += 4) {
        size_t corners = facets[f + 3] < 0 ? 3 : 4;
        for (size_t k = 0; k < corners; k++)
            largest = std::max(largest, angle_between(&samples.normals[3 * size_t(facets[f + k])],
                                                      &samples.normals[3 * size_t(facets[f + (k + 1) % corners])]));
    }
    return largest;
}

/* The same of the border's chords, which may curve in a plane. Every edge is cut into `rate` chords. */
double largest_bend(const Bfr::Tessellation &pattern, const face_samples &samples, size_t rate) {
    size_t count = size_t(pattern.GetNumBoundaryCoords());
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) {
        if (i % rate == 0) continue; /* a corner of the face may be one */
        const double *before = &samples.positions[3 * (i - 1)], *here = before + 3;
        const double *after = &samples.positions[3 * ((i + 1) % count)];
        double in[3], out[3];
        for (int k = 0; k < 3; k++) in[k] = here[k] - before[k], out[k] = after[k] - here[k];
        largest = std::max(largest, angle_between(in, out));
    }
    return largest;
}

/* The smallest power of two by which halved once more no facet turns by more than half of what is allowed: looking one
 * level deeper sees the bump whose corners look alike. */
int adaptive_rate(const face_limit &face, int level) {
    face_samples samples;
    for (int k = 0; k < level; k++) {
        Bfr::Tessellation pattern(face.surface.GetParameterization(), 2 << k, pattern_options());
        samples.evaluate(face, pattern, 0);
        double turn = std::max(largest_turn(pattern, samples), largest_bend(pattern, samples, size_t(2) << k));
        if (turn <= 0.5 * SUBDIVIDE_TURN) return 1 << k;
    }
    return 1 << level;
}

/* ---- the whole ------------------------------------------------------------------------------------------------- */

class limit_builder {
  public:
    limit_builder(const cage &c, const hemi_subdivision_desc &how, const Far::TopologyRefiner &refiner);
    void build();
    void store(osd_points *out) const;

  private:
    bool open_face(int face, face_limit &out) const;
    void set_rates();
    void number_slots();
    void add_face(int face, const face_limit &limit);
    std::vector<int> border_slots(int face) const;
    int find_vertex(int slot, const double *position, const double *normal, const double *value);
    int add_vertex(const double *position, const double *normal, const double *value);
    bool same_side(int vertex, const double *normal, const double *value) const;

    const cage &c;
    const hemi_subdivision_desc &how;
    const Far::TopologyLevel &base;
    Bfr::RefinerSurfaceFactory<> factory;
    double value_size = 0.0;
    std::vector<int> face_rates, edge_rates;    /* face_rates[f]: 0 if it has no surface */
    std::vector<int> edge_slots;                /* the first slot inside edge e; vertex v has slot v */
    std::vector<int> first_vertex, next_vertex; /* of a slot, and after a vertex of the same slot; -1: none */
    std::vector<double> positions, normals, values;
    std::vector<int> facets;
};

/* Extraordinary vertices must be isolated until sharpness has run out around them too. */
Bfr::SurfaceFactory::Options factory_options(const cage &c, const hemi_subdivision_desc &how) {
    float deepest = float(how.level);
    for (uint32_t i = 0; i < c.crease_count; i++)
        if (c.crease_sharpness[i] < SUBDIVIDE_SHARPNESS_MAX) deepest = std::max(deepest, c.crease_sharpness[i]);
    for (uint32_t i = 0; i < c.point_count; i++)
        if (c.point_sharpness[i] < SUBDIVIDE_SHARPNESS_MAX) deepest = std::max(deepest, c.point_sharpness[i]);
    int smooth = std::min(int(std::ceil(deepest)) + smooth_levels_below, sharp_levels);
    return Bfr::SurfaceFactory::Options().SetApproxLevelSharp(sharp_levels).SetApproxLevelSmooth(smooth);
}

limit_builder::limit_builder(const cage &the_cage, const hemi_subdivision_desc &the_how,
                             const Far::TopologyRefiner &refiner)
    : c(the_cage), how(the_how), base(refiner.GetLevel(0)), factory(refiner, factory_options(the_cage, the_how)) {
    for (size_t i = 0; i < size_t(c.value_count) * c.value_width; i++)
        value_size = std::max(value_size, std::fabs(c.values[i]));
}

/* False: a hole, or a border that is not drawn. */
bool limit_builder::open_face(int face, face_limit &out) const {
    if (!factory.InitVertexSurface(face, &out.surface)) return false;
    out.points.resize(3 * size_t(out.surface.GetNumPatchPoints()));
    out.surface.PreparePatchPoints(c.positions, 3, out.points.data(), 3);
    for (size_t i = 3; i < out.points.size(); i++)
        out.span = std::max(out.span, std::fabs(out.points[i] - out.points[i % 3]));
    if (c.value_width == 0) return true;
    int width = int(c.value_width);
    if (!factory.InitFaceVaryingSurface(face, &out.values, 0)) return false;
    out.value_points.resize(c.value_width * size_t(out.values.GetNumPatchPoints()));
    out.values.PreparePatchPoints(c.values, width, out.value_points.data(), width);
    return true;
}

void limit_builder::set_rates() {
    int level = int(how.level);
    bool adaptive = how.tessellation == HEMI_TESSELLATION_ADAPTIVE;
    face_rates.assign(size_t(base.GetNumFaces()), 1 << level);
    edge_rates.assign(size_t(base.GetNumEdges()), 1);
    for (int f = 0; f < base.GetNumFaces(); f++) {
        face_limit limit;
        if (adaptive && open_face(f, limit)) face_rates[size_t(f)] = adaptive_rate(limit, level);
        Far::ConstIndexArray edges = base.GetFaceEdges(f);
        for (int e = 0; e < edges.size(); e++)
            edge_rates[size_t(edges[e])] = std::max(edge_rates[size_t(edges[e])], face_rates[size_t(f)]);
    }
}

void limit_builder::number_slots() {
    int slots = base.GetNumVertices();
    for (int rate : edge_rates) {
        edge_slots.push_back(slots);
        slots += rate - 1;
    }
    first_vertex.assign(size_t(slots), -1);
}

/* The slots around a face, from its first vertex along its first edge, as Bfr numbers the border of a pattern. */
std::vector<int> limit_builder::border_slots(int face) const {
    Far::ConstIndexArray vertices = base.GetFaceVertices(face), edges = base.GetFaceEdges(face);
    std::vector<int> slots;
    for (int k = 0; k < vertices.size(); k++) {
        int first = edge_slots[size_t(edges[k])], inside = edge_rates[size_t(edges[k])] - 1;
        bool forward = base.GetEdgeVertices(edges[k])[0] == vertices[k];
        slots.push_back(vertices[k]);
        for (int i = 0; i < inside; i++) slots.push_back(first + (forward ? i : inside - 1 - i));
    }
    return slots;
}

int limit_builder::add_vertex(const double *position, const double *normal, const double *value) {
    positions.insert(positions.end(), position, position + 3);
    normals.insert(normals.end(), normal, normal + 3);
    values.insert(values.end(), value, value + c.value_width);
    next_vertex.push_back(-1);
    return int(next_vertex.size()) - 1;
}

bool limit_builder::same_side(int vertex, const double *normal, const double *value) const {
    const double *other = &normals[3 * size_t(vertex)];
    bool directed = vec3_dot(normal, normal) > 0.0, other_directed = vec3_dot(other, other) > 0.0;
    if (directed != other_directed || (directed && angle_between(normal, other) > OSD_SMOOTH)) return false;
    for (size_t k = 0; k < c.value_width; k++)
        if (std::fabs(value[k] - values[c.value_width * size_t(vertex) + k]) > OSD_SAME_VALUE * value_size)
            return false;
    return true;
}

/* The vertex of a slot that has this normal and value; its position is that of the first one there. */
int limit_builder::find_vertex(int slot, const double *position, const double *normal, const double *value) {
    int last = -1, first = first_vertex[size_t(slot)];
    for (int v = first; v >= 0; v = next_vertex[size_t(v)]) {
        if (same_side(v, normal, value)) return v;
        last = v;
    }
    double shared[3];
    std::memcpy(shared, first < 0 ? position : &positions[3 * size_t(first)], sizeof shared);
    int added = add_vertex(shared, normal, value);
    (last < 0 ? first_vertex[size_t(slot)] : next_vertex[size_t(last)]) = added;
    return added;
}

Bfr::Tessellation pattern_of(const face_limit &limit, const std::vector<int> &rates) {
    return Bfr::Tessellation(limit.surface.GetParameterization(), int(rates.size()), rates.data(), pattern_options());
}

void limit_builder::add_face(int face, const face_limit &limit) {
    Far::ConstIndexArray edges = base.GetFaceEdges(face);
    std::vector<int> rates, numbers;
    for (int k = 0; k < edges.size(); k++) rates.push_back(edge_rates[size_t(edges[k])]);
    rates.resize(rates.size() + (edges.size() == 4 ? 2 : 1), face_rates[size_t(face)]); /* inside */
    Bfr::Tessellation pattern = pattern_of(limit, rates);
    face_samples samples;
    samples.evaluate(limit, pattern, c.value_width);
    std::vector<int> slots = border_slots(face);
    for (size_t i = 0; i < size_t(pattern.GetNumCoords()); i++) {
        const double *position = &samples.positions[3 * i], *normal = &samples.normals[3 * i];
        const double *value = samples.values.data() + c.value_width * i;
        numbers.push_back(i < slots.size() ? find_vertex(slots[i], position, normal, value)
                                           : add_vertex(position, normal, value));
    }
    for (int corner : facets_of(pattern)) facets.push_back(corner < 0 ? -1 : numbers[size_t(corner)]);
}

void limit_builder::build() {
    set_rates();
    number_slots();
    for (int f = 0; f < base.GetNumFaces(); f++) {
        face_limit limit;
        if (open_face(f, limit)) add_face(f, limit);
    }
}

template <typename T> T *copy_out(const hemi_allocator *memory, const std::vector<T> &from) {
    T *array = static_cast<T *>(hemi_allocate(memory, from.size() * sizeof(T) + 1));
    if (!array) throw std::bad_alloc();
    std::copy(from.begin(), from.end(), array);
    return array;
}

void limit_builder::store(osd_points *out) const {
    out->vertex_count = static_cast<uint32_t>(next_vertex.size());
    out->facet_count = static_cast<uint32_t>(facets.size() / 4);
    out->positions = copy_out(c.memory, positions);
    out->normals = copy_out(c.memory, normals);
    out->facets = copy_out(c.memory, facets);
    out->values = c.value_width ? copy_out(c.memory, values) : nullptr;
}

} // namespace

hemi_result osd_limit(const cage *c, const hemi_subdivision_desc *how, osd_points *out,
                      char message[SUBDIVIDE_MESSAGE_SIZE]) {
    *out = osd_points{};
    out->memory = c->memory;
    hemi_result result = HEMI_ERROR_UNSUPPORTED;
    const char *text = "OpenSubdiv refuses the control cage";
    try {
        std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(*c, *how);
        if (refiner) {
            limit_builder builder(*c, *how, *refiner);
            builder.build();
            builder.store(out);
            if (out->facet_count) return HEMI_OK;
            result = HEMI_ERROR_DATA;
            text = "every face of the control cage is a hole or an undrawn border";
        }
    } catch (const std::bad_alloc &) {
        result = HEMI_ERROR_MEMORY;
        text = "out of memory for the subdivision surface";
    } catch (...) {
        text = "OpenSubdiv failed on the control cage";
    }
    osd_points_destroy(out);
    return subdivide_fail(result, message, "%s", text);
}

void osd_points_destroy(osd_points *surface) {
    hemi_deallocate(surface->memory, surface->positions);
    hemi_deallocate(surface->memory, surface->normals);
    hemi_deallocate(surface->memory, surface->values);
    hemi_deallocate(surface->memory, surface->facets);
    *surface = osd_points{};
}
