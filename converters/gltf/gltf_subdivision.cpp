/* SPDX-License-Identifier: MIT
 * Which primitives are control cages, and of what faces? `extras.hemibake_subdivision` of a primitive, else of its
 * node, else of its mesh, asks for a subdivision surface; FB_ngon_encoding says which triangles were one polygon.
 *
 *     "extras": { "hemibake_subdivision": { "scheme": "catmull-clark", "level": 3, "adaptive": true,
 *         "boundary": "edge-and-corner", "faceVarying": "corners-plus-1",
 *         "creases": [[0, 1, 10], [1, 2, 2.5]], "corners": [[4, 10]], "holes": [5] } }
 *
 * "level": "auto" leaves it to the host, which goes by the size of elements.
 *
 * Creases are pairs of vertices of the primitive with a sharpness, corners vertices with one, holes faces: polygons
 * under FB_ngon_encoding, else triangles. An asset that a bake has written is not subdivided again.
 */
#include "gltf_model.h"

#include <cmath>

using tinygltf::Value;

static const char *const member = "hemibake_subdivision";

/* ---- n-gons ---------------------------------------------------------------------------------------------------- */

/* Consecutive triangles that share their first vertex and fan around it are one polygon. Draco may reorder triangles
 * and turn their corners round, so what it has packed says nothing about polygons. */
std::vector<uint32_t> gltf_polygon_sizes(const tinygltf::Primitive &primitive, const std::vector<uint32_t> &indices) {
    std::vector<uint32_t> sizes;
    if (primitive.extensions.count("FB_ngon_encoding") == 0 || primitive.mode != TINYGLTF_MODE_TRIANGLES ||
        primitive.extensions.count("KHR_draco_mesh_compression"))
        return sizes;
    for (size_t i = 0; i < indices.size(); i += 3) {
        bool goes_on = i > 0 && indices[i] == indices[i - 3] && indices[i + 1] == indices[i - 1];
        if (goes_on)
            sizes.back()++;
        else
            sizes.push_back(3);
    }
    return sizes;
}

/* ---- what extras ask for ---------------------------------------------------------------------------------------- */

struct extras_reader {
    const Value &request;
    std::string where;

    /* The position of a name in a list; what is not there is the first. */
    int choice(const char *key, const std::vector<const char *> &names) const;
    /* Rows of `width` numbers; 1: an array of plain numbers. */
    std::vector<std::vector<double>> rows(const char *key, size_t width) const;
};

int extras_reader::choice(const char *key, const std::vector<const char *> &names) const {
    if (!request.Has(key)) return 0;
    const Value &value = request.Get(key);
    std::string list;
    for (size_t i = 0; i < names.size(); i++) {
        if (value.IsString() && value.Get<std::string>() == names[i]) return int(i);
        list += (i ? ", " : "") + std::string(names[i]);
    }
    gltf_fail(HEMI_ERROR_DATA, "%s.%s is none of %s", where.c_str(), key, list.c_str());
}

std::vector<std::vector<double>> extras_reader::rows(const char *key, size_t width) const {
    std::vector<std::vector<double>> out;
    if (!request.Has(key)) return out;
    const Value &list = request.Get(key);
    bool valid = list.IsArray();
    for (size_t i = 0; valid && i < list.ArrayLen(); i++) {
        const Value &row = list.Get(int(i));
        valid = width == 1 ? row.IsNumber() : row.IsArray() && row.ArrayLen() == width;
        out.emplace_back();
        for (size_t k = 0; valid && k < width; k++) {
            const Value &number = width == 1 ? row : row.Get(int(k));
            valid = number.IsNumber() && number.GetNumberAsDouble() >= 0;
            if (valid) out.back().push_back(number.GetNumberAsDouble());
        }
    }
    if (!valid)
        gltf_fail(HEMI_ERROR_DATA, "%s.%s is no array of %s", where.c_str(), key,
                  width == 1   ? "face numbers"
                  : width == 2 ? "[vertex, sharpness]"
                               : "[vertex, vertex, sharpness]");
    return out;
}

static uint32_t to_index(const extras_reader &reader, const char *key, double number) {
    if (number != std::floor(number) || number > 4e9)
        gltf_fail(HEMI_ERROR_DATA, "%s.%s: %g is no index", reader.where.c_str(), key, number);
    return uint32_t(number);
}

static void read_features(const extras_reader &reader, gltf_cage &out) {
    for (const std::vector<double> &row : reader.rows("creases", 3)) {
        for (size_t k = 0; k < 2; k++) out.crease_edges.push_back(to_index(reader, "creases", row[k]));
        out.crease_sharpness.push_back(float(row[2]));
    }
    for (const std::vector<double> &row : reader.rows("corners", 2)) {
        out.corner_vertices.push_back(to_index(reader, "corners", row[0]));
        out.corner_sharpness.push_back(float(row[1]));
    }
    for (const std::vector<double> &row : reader.rows("holes", 1))
        out.holes.push_back(to_index(reader, "holes", row[0]));
    out.desc.crease_edges = out.crease_edges.data();
    out.desc.crease_sharpness = out.crease_sharpness.data();
    out.desc.crease_count = uint32_t(out.crease_sharpness.size());
    out.desc.corner_vertices = out.corner_vertices.data();
    out.desc.corner_sharpness = out.corner_sharpness.data();
    out.desc.corner_count = uint32_t(out.corner_vertices.size());
    out.desc.holes = out.holes.data();
    out.desc.hole_count = uint32_t(out.holes.size());
}

static std::shared_ptr<gltf_cage> read_cage(const Value &request, const std::string &where) {
    auto out = std::make_shared<gltf_cage>();
    if (!request.IsObject()) gltf_fail(HEMI_ERROR_DATA, "%s is no object", where.c_str());
    extras_reader reader = { request, where };
    static const hemi_subdivision_scheme schemes[] = { HEMI_SUBDIVISION_CATMULL_CLARK, HEMI_SUBDIVISION_LOOP,
                                                       HEMI_SUBDIVISION_BILINEAR };
    out->desc.scheme = schemes[reader.choice("scheme", { "catmull-clark", "loop", "bilinear" })];
    double level = 2;
    out->level_is_auto =
        request.Has("level") && request.Get("level").IsString() && request.Get("level").Get<std::string>() == "auto";
    if (request.Has("level") && !out->level_is_auto)
        level = request.Get("level").IsNumber() ? request.Get("level").GetNumberAsDouble() : -1;
    if (!(level >= 0 && level <= 8 && level == std::floor(level)))
        gltf_fail(HEMI_ERROR_DATA, "%s.level is neither \"auto\" nor a whole number from 0 to 8", where.c_str());
    out->desc.level = uint32_t(level);
    if (request.Has("adaptive")) {
        if (!request.Get("adaptive").IsBool())
            gltf_fail(HEMI_ERROR_DATA, "%s.adaptive is neither true nor false", where.c_str());
        out->desc.tessellation =
            request.Get("adaptive").Get<bool>() ? HEMI_TESSELLATION_ADAPTIVE : HEMI_TESSELLATION_UNIFORM;
    }
    static const hemi_face_varying linear[] = { HEMI_FACE_VARYING_CORNERS_PLUS_1, HEMI_FACE_VARYING_NONE,
                                                HEMI_FACE_VARYING_CORNERS_ONLY,   HEMI_FACE_VARYING_CORNERS_PLUS_2,
                                                HEMI_FACE_VARYING_BOUNDARIES,     HEMI_FACE_VARYING_ALL };
    out->desc.boundary = hemi_boundary(HEMI_BOUNDARY_EDGE_AND_CORNER +
                                       reader.choice("boundary", { "edge-and-corner", "edge-only", "none" }));
    out->desc.face_varying = linear[reader.choice(
        "faceVarying", { "corners-plus-1", "none", "corners-only", "corners-plus-2", "boundaries", "all" })];
    read_features(reader, *out);
    return out;
}

static bool asks(const Value &extras) {
    return extras.IsObject() && extras.Has(member);
}

std::shared_ptr<gltf_cage> gltf_read_cage(gltf_asset &asset, int node, int mesh, int primitive) {
    const tinygltf::Model &model = asset.model;
    if (model.asset.extras.IsObject() && model.asset.extras.Has("hemibake")) return nullptr;
    const tinygltf::Mesh &of_mesh = model.meshes[size_t(mesh)];
    const Value &inner = of_mesh.primitives[size_t(primitive)].extras, &middle = model.nodes[size_t(node)].extras;
    if (!asks(inner) && asks(middle))
        return read_cage(middle.Get(member), gltf_text("nodes[%d].extras.%s", node, member));
    if (!asks(inner) && !asks(of_mesh.extras)) return nullptr;
    auto &shared = asset.cages[{ mesh, primitive }]; /* nodes that show the mesh show the same surface */
    if (shared) return shared;
    return shared = asks(inner)
                        ? read_cage(inner.Get(member),
                                    gltf_text("meshes[%d].primitives[%d].extras.%s", mesh, primitive, member))
                        : read_cage(of_mesh.extras.Get(member), gltf_text("meshes[%d].extras.%s", mesh, member));
}

/* Polygons are told even where extras ask for nothing: the host may ask for a subdivision surface itself. */
hemi_subdivision_desc gltf_describe_cage(const gltf_instance &instance) {
    hemi_subdivision_desc out = {};
    const std::vector<uint32_t> &sizes = instance.geometry->face_sizes;
    const gltf_cage *cage = instance.cage.get();
    if (cage && cage->desc.level) out = cage->desc;
    if (sizes.empty() && !out.level) return out;
    out.struct_size = sizeof out;
    out.face_sizes = sizes.empty() ? nullptr : sizes.data();
    out.face_count = uint32_t(sizes.size());
    return out;
}
