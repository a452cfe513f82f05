/* SPDX-License-Identifier: MIT
 * Where does refinement put the vertices on the limit? Uniform refinement in double, so that a symmetric cage gives a
 * symmetric surface. */
#include "osd_shim.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

struct point {
    double x[3];

    void Clear() { x[0] = x[1] = x[2] = 0.0; }
    void AddWithWeight(const point &other, double weight) {
        for (int k = 0; k < 3; k++) x[k] += weight * other.x[k];
    }
};

using points = std::vector<point>;

std::unique_ptr<Far::TopologyRefiner> make_refiner(const cage &c, hemi_subdivision scheme) {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(c.vertex_count);
    descriptor.numFaces = static_cast<int>(c.face_count);
    descriptor.numVertsPerFace = c.sizes;
    descriptor.vertIndicesPerFace = c.corners;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    Sdc::SchemeType type = scheme == HEMI_SUBDIVISION_LOOP ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
    return std::unique_ptr<Far::TopologyRefiner>(Factory::Create(descriptor, Factory::Options(type, options)));
}

points refine(Far::TopologyRefiner &refiner, const cage &c, int level) {
    Far::TopologyRefiner::UniformOptions options(level);
    options.fullTopologyInLastLevel = true; /* the limit needs the neighbours of the last vertices */
    refiner.RefineUniform(options);
    Far::PrimvarRefinerReal<double> primvars(refiner);
    points coarse(c.vertex_count);
    std::memcpy(coarse.data(), c.positions, c.vertex_count * sizeof(point));
    for (int i = 1; i <= level; i++) {
        points fine(static_cast<size_t>(refiner.GetLevel(i).GetNumVertices()));
        primvars.Interpolate(i, coarse, fine);
        coarse.swap(fine);
    }
    return coarse;
}

template <typename T> T *allocate(size_t count) {
    T *array = static_cast<T *>(std::malloc(count * sizeof(T)));
    if (!array) throw std::bad_alloc();
    return array;
}

void store_limit(const Far::TopologyRefiner &refiner, const points &refined, osd_points *out) {
    points limit(refined.size()), along(refined.size()), across(refined.size());
    Far::PrimvarRefinerReal<double>(refiner).Limit(refined, limit, along, across);
    out->vertex_count = static_cast<uint32_t>(refined.size());
    out->positions = allocate<double>(3 * refined.size());
    out->normals = allocate<double>(3 * refined.size());
    std::memcpy(out->positions, limit.data(), refined.size() * sizeof(point));
    for (size_t v = 0; v < refined.size(); v++)
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            out->normals[3 * v + static_cast<size_t>(k)] =
                along[v].x[i] * across[v].x[j] - along[v].x[j] * across[v].x[i];
        }
}

void store_faces(const Far::TopologyLevel &level, osd_points *out) {
    out->face_count = static_cast<uint32_t>(level.GetNumFaces());
    out->corners = allocate<int>(static_cast<size_t>(out->face_size) * out->face_count);
    for (uint32_t f = 0; f < out->face_count; f++) {
        Far::ConstIndexArray corners = level.GetFaceVertices(static_cast<int>(f));
        for (uint32_t k = 0; k < out->face_size; k++)
            out->corners[static_cast<size_t>(out->face_size) * f + k] = corners[static_cast<int>(k)];
    }
}

hemi_result fail(hemi_result result, osd_points *out, char *message, const char *text) {
    osd_points_destroy(out);
    std::snprintf(message, SUBDIVIDE_MESSAGE_SIZE, "%s", text);
    return result;
}

} // namespace

hemi_result osd_refine(const cage *c, hemi_subdivision scheme, uint32_t level, osd_points *out,
                       char message[SUBDIVIDE_MESSAGE_SIZE]) {
    *out = osd_points{};
    try {
        std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(*c, scheme);
        if (!refiner) return fail(HEMI_ERROR_UNSUPPORTED, out, message, "OpenSubdiv refuses the control cage");
        points refined = refine(*refiner, *c, static_cast<int>(level));
        out->face_size = scheme == HEMI_SUBDIVISION_LOOP ? 3 : 4;
        store_limit(*refiner, refined, out);
        store_faces(refiner->GetLevel(static_cast<int>(level)), out);
        return HEMI_OK;
    } catch (const std::bad_alloc &) {
        return fail(HEMI_ERROR_MEMORY, out, message, "out of memory for the subdivision surface");
    } catch (...) {
        return fail(HEMI_ERROR_UNSUPPORTED, out, message, "OpenSubdiv failed on the control cage");
    }
}

void osd_points_destroy(osd_points *surface) {
    std::free(surface->positions);
    std::free(surface->normals);
    std::free(surface->corners);
    *surface = osd_points{};
}
