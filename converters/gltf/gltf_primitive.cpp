/* SPDX-License-Identifier: MIT
 * Which triangles does a primitive hold? Its attributes as floats, its strips and fans unrolled, its Draco bytes
 * decoded.
 */
#include "gltf_model.h"

#include "draco_codec.h"

#include <algorithm>
#include <cstring>

using draco_owner = std::unique_ptr<draco_codec_mesh, decltype(&draco_codec_mesh_destroy)>;

/* A primitive being read: where it is, and its Draco mesh if it has one. */
struct primitive_source {
    const gltf_asset &asset;
    const tinygltf::Primitive &primitive;
    std::string where;
    draco_owner draco{ nullptr, draco_codec_mesh_destroy };
    const tinygltf::Value *draco_ids = nullptr;
    bool draco_counts_differ = false; /* from the accessors': the decoder's hold, as in other loaders */
};

/* ---- Draco ---------------------------------------------------------------------------------------------------- */

/* How much more than the accessors say the bytes may hold: Blender's exporters counted a few points too few for years.
 * What is past that is hostile, and is refused before memory is spent on it. */
static uint32_t draco_limit(size_t count) {
    return uint32_t(std::min(2 * count + 65536, size_t(UINT32_MAX)));
}

static void open_draco(primitive_source &source) {
    auto found = source.primitive.extensions.find("KHR_draco_mesh_compression");
    if (found == source.primitive.extensions.end()) return;
    const gltf_asset &asset = source.asset;
    const tinygltf::Value none;
    const std::string where = source.where + ".extensions.KHR_draco_mesh_compression";
    const tinygltf::Value &view_index = found->second.Has("bufferView") ? found->second.Get("bufferView") : none;
    source.draco_ids = found->second.Has("attributes") ? &found->second.Get("attributes") : nullptr;
    if (!view_index.IsInt() || !source.draco_ids || !source.draco_ids->IsObject() || source.primitive.indices < 0)
        gltf_fail(HEMI_ERROR_DATA, "%s lacks its bufferView, attributes or indices", where.c_str());
    gltf_check_index(view_index.Get<int>(), asset.model.bufferViews.size(), "bufferViews", where + ".bufferView");
    const tinygltf::BufferView &view = asset.model.bufferViews[size_t(view_index.Get<int>())];
    const unsigned char *bytes = asset.buffers[size_t(view.buffer)].data() + view.byteOffset;

    auto position = source.primitive.attributes.find("POSITION");
    size_t points = asset.model.accessors[size_t(position->second)].count;
    size_t corners = asset.model.accessors[size_t(source.primitive.indices)].count;
    if (points > UINT32_MAX || corners / 3 > UINT32_MAX) gltf_fail(HEMI_ERROR_LIMIT, "%s is too large", where.c_str());
    draco_codec_mesh *mesh = nullptr;
    hemi_result result =
        draco_codec_decode(bytes, view.byteLength, draco_limit(points), draco_limit(corners / 3), &mesh);
    if (result == HEMI_ERROR_MEMORY) throw std::bad_alloc();
    if (result != HEMI_OK)
        gltf_fail(result, "%s cannot be decoded, or is far larger than its accessors say", where.c_str());
    source.draco.reset(mesh);
    source.draco_counts_differ =
        draco_codec_mesh_point_count(mesh) != points || draco_codec_mesh_face_count(mesh) != corners / 3;
}

/* ---- attributes ----------------------------------------------------------------------------------------------- */

static std::vector<float> read_draco_attribute(const primitive_source &source, const std::string &name, int accessor,
                                               uint32_t components, const std::string &where) {
    const tinygltf::Value &id = source.draco_ids->Get(name);
    uint32_t points = draco_codec_mesh_point_count(source.draco.get());
    uint32_t stored = id.IsInt() ? draco_codec_mesh_components(source.draco.get(), uint32_t(id.Get<int>())) : 0;
    std::vector<float> values(size_t(points) * std::max(stored, 1u));
    if ((stored != components && stored != components + 1) ||
        !draco_codec_mesh_values(source.draco.get(), uint32_t(id.Get<int>()), stored, values.data()))
        gltf_fail(HEMI_ERROR_DATA, "%s has no Draco attribute of %u components", where.c_str(), components);
    for (uint32_t p = 0; stored != components && p < points; p++) /* leave out alpha */
        std::memmove(&values[size_t(p) * components], &values[size_t(p) * stored], components * sizeof(float));
    values.resize(size_t(points) * components);
    gltf_normalize(source.asset.model.accessors[size_t(accessor)], values);
    return values;
}

/* An attribute as floats; empty if the primitive has none of that name. */
static std::vector<float> read_attribute(const primitive_source &source, const std::string &name, int components) {
    auto found = source.primitive.attributes.find(name);
    if (found == source.primitive.attributes.end()) return {};
    std::string where = source.where + ".attributes." + name;
    if (!source.draco || !source.draco_ids->Has(name))
        return gltf_read_floats(source.asset, found->second, components, gltf_zero_broken, where);
    std::vector<float> values = read_draco_attribute(source, name, found->second, uint32_t(components), where);
    for (float &value : values)
        if (!(value - value == 0)) value = 0; /* not finite */
    return values;
}

/* Positions or normals, with what is not finite in them; empty if there are none. */
static std::vector<float> read_keeping_broken(const primitive_source &source, const std::string &name) {
    auto found = source.primitive.attributes.find(name);
    if (found == source.primitive.attributes.end()) return {};
    std::string where = source.where + ".attributes." + name;
    if (source.draco && source.draco_ids->Has(name)) return read_draco_attribute(source, name, found->second, 3, where);
    return gltf_read_floats(source.asset, found->second, 3, gltf_keep_broken, where);
}

/* What is there beyond the vertices is left out, as other loaders do. */
static void check_count(const primitive_source &source, const char *name, std::vector<float> &values, size_t components,
                        uint32_t vertex_count) {
    if (values.size() > components * vertex_count) values.resize(components * vertex_count);
    if (values.empty() || values.size() == components * vertex_count) return;
    gltf_fail(HEMI_ERROR_DATA, "%s.attributes.%s has %zu elements, but POSITION has %u", source.where.c_str(), name,
              values.size() / components, vertex_count);
}

/* ---- what a bake passes on -------------------------------------------------------------------------------------- */

/* With position, normal, tangent, colour, radiosity, error and 64 groups of lights no more than Draco's shim takes. */
static const size_t transferred_max = 10;

static bool begins_with(const std::string &text, const char *start) {
    return text.compare(0, std::strlen(start), start) == 0;
}

/* TEXCOORDs by their number, then COLOR_1 and on, then the asset's own; -1: not passed on. */
static int transfer_rank(const std::string &name) {
    if (begins_with(name, "TEXCOORD_")) return std::atoi(name.c_str() + 9);
    if (begins_with(name, "COLOR_") && name != "COLOR_0") return 1000;
    bool is_light = name == "_RADIOSITY" || name == "_ERROR" || begins_with(name, "_LIGHT_");
    return name[0] == '_' && !is_light ? 2000 : -1;
}

static gltf_attribute read_named(const primitive_source &source, const std::string &name, uint32_t vertex_count) {
    const tinygltf::Accessor &accessor = source.asset.model.accessors[size_t(source.primitive.attributes.at(name))];
    int components = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
    gltf_attribute out = { name, components, false, {} };
    out.discrete = accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT && !accessor.normalized && name[0] == '_';
    out.values = read_attribute(source, name, components);
    check_count(source, name.c_str(), out.values, size_t(components), vertex_count);
    return out;
}

static void interleave(gltf_geometry &geometry, const std::vector<float> &mask) {
    std::vector<std::pair<size_t, const std::vector<float> *>> columns;
    for (const gltf_attribute &attribute : geometry.transferred)
        columns.push_back({ size_t(attribute.components), &attribute.values });
    for (const auto &column : columns) geometry.attribute_count += uint32_t(column.first);
    if (!geometry.colors.empty())
        geometry.color_at = int(geometry.attribute_count), columns.push_back({ 3, &geometry.colors });
    geometry.attribute_count += geometry.colors.empty() ? 0 : 3;
    if (!mask.empty()) geometry.mask_at = int(geometry.attribute_count), columns.push_back({ 3, &mask });
    geometry.attribute_count += mask.empty() ? 0 : 3;
    if (columns.size() == 1) {
        geometry.attributes = *columns[0].second;
        return;
    }
    geometry.attributes.resize(size_t(geometry.attribute_count) * geometry.vertex_count);
    size_t at = 0;
    for (const auto &[width, values] : columns) {
        for (size_t v = 0; v < geometry.vertex_count; v++)
            std::copy_n(&(*values)[width * v], width, &geometry.attributes[geometry.attribute_count * v + at]);
        at += width;
    }
}

static void read_transferred(const primitive_source &source, gltf_geometry &geometry) {
    std::vector<std::string> names;
    for (const auto &attribute : source.primitive.attributes) {
        int type = source.asset.model.accessors[size_t(attribute.second)].type;
        bool vector = type == TINYGLTF_TYPE_SCALAR || type == TINYGLTF_TYPE_VEC2 || type == TINYGLTF_TYPE_VEC3 ||
                      type == TINYGLTF_TYPE_VEC4;
        if (begins_with(attribute.first, "TEXCOORD_") && type != TINYGLTF_TYPE_VEC2)
            gltf_fail(HEMI_ERROR_DATA, "%s.attributes.%s is not of type VEC2", source.where.c_str(),
                      attribute.first.substr(0, 40).c_str());
        if (vector && transfer_rank(attribute.first) >= 0) names.push_back(attribute.first);
    }
    std::stable_sort(names.begin(), names.end(),
                     [](const auto &a, const auto &b) { return transfer_rank(a) < transfer_rank(b); });
    if (names.size() > transferred_max) names.resize(transferred_max);
    for (const std::string &name : names)
        geometry.transferred.push_back(read_named(source, name, geometry.vertex_count));
    for (const char *name : { "TANGENT", "COLOR_0" })
        if (source.primitive.attributes.count(name))
            geometry.lit_only.push_back(read_named(source, name, geometry.vertex_count));
    interleave(geometry, gltf_mask_coordinates(source.asset, source.primitive.material, geometry));
}

/* ---- indices -------------------------------------------------------------------------------------------------- */

/* Corner k of triangle t of a strip or fan of consecutive indices. [glTF 2.0, 3.7.2.1] */
static size_t unrolled_corner(int mode, size_t t, size_t k) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return k == 0 ? 0 : t + k; /* (0, t+1, t+2) */
    if (k == 0) return t;
    return t + ((t % 2 == 0) ? k : 3 - k); /* odd triangles of a strip turn round */
}

static std::vector<uint32_t> unroll(const std::vector<uint32_t> &strip, int mode) {
    std::vector<uint32_t> triangles;
    size_t count = strip.size() < 3 ? 0 : strip.size() - 2;
    triangles.reserve(count * 3);
    for (size_t t = 0; t < count; t++)
        for (size_t k = 0; k < 3; k++) triangles.push_back(strip[unrolled_corner(mode, t, k)]);
    return triangles;
}

static std::vector<uint32_t> read_corners(const primitive_source &source, uint32_t vertex_count) {
    std::vector<uint32_t> indices;
    if (source.draco) {
        indices.resize(size_t(draco_codec_mesh_face_count(source.draco.get())) * 3);
        draco_codec_mesh_indices(source.draco.get(), indices.data());
    } else if (source.primitive.indices >= 0) {
        indices = gltf_read_indices(source.asset, source.primitive.indices, source.where + ".indices");
    } else {
        for (uint32_t v = 0; v < vertex_count; v++) indices.push_back(v);
    }
    for (size_t i = 0; i < indices.size(); i++)
        if (indices[i] >= vertex_count)
            gltf_fail(HEMI_ERROR_DATA, "%s.indices: number %zu is %u, but there are %u vertices", source.where.c_str(),
                      i, indices[i], vertex_count);
    return indices;
}

/* Vertices that are nowhere go to the origin, without their triangles. */
static void drop_broken(gltf_geometry &geometry) {
    std::vector<char> broken(geometry.vertex_count, 0);
    bool any = false;
    for (size_t i = 0; i < geometry.positions.size(); i++)
        if (!(geometry.positions[i] - geometry.positions[i] == 0)) broken[i / 3] = any = true;
    if (!any) return;
    geometry.notes.push_back("triangles at vertices that are not finite are left out");
    for (size_t v = 0; v < broken.size(); v++)
        if (broken[v]) std::fill_n(&geometry.positions[3 * v], 3, 0.0f);
    std::vector<uint32_t> whole;
    for (size_t t = 0; t < geometry.indices.size(); t += 3)
        if (!broken[geometry.indices[t]] && !broken[geometry.indices[t + 1]] && !broken[geometry.indices[t + 2]])
            whole.insert(whole.end(), &geometry.indices[t], &geometry.indices[t] + 3);
    geometry.indices = std::move(whole);
}

static void read_triangles(const primitive_source &source, gltf_geometry &geometry) {
    int mode = source.primitive.mode;
    geometry.indices = read_corners(source, geometry.vertex_count);
    if (!source.draco && mode != TINYGLTF_MODE_TRIANGLES) geometry.indices = unroll(geometry.indices, mode);
    if (geometry.indices.size() % 3 != 0) {
        geometry.notes.push_back("its last corners make no whole triangle, and are left out");
        geometry.indices.resize(geometry.indices.size() / 3 * 3);
    }
    drop_broken(geometry);
    if (geometry.indices.empty())
        gltf_fail(HEMI_ERROR_DATA, "%s has no whole triangle of finite corners", source.where.c_str());
    if (geometry.indices.size() / 3 > UINT32_MAX / 3)
        gltf_fail(HEMI_ERROR_LIMIT, "%s has too many triangles; split it", source.where.c_str());
    geometry.face_sizes = gltf_polygon_sizes(source.primitive, geometry.indices);
}

/* A normal that has no length or is not finite says nothing: it becomes 0, for which the facet's is taken. */
static void drop_broken_normals(gltf_geometry &geometry) {
    std::vector<float> &n = geometry.normals;
    size_t broken = 0;
    if (n.empty()) return;
    for (size_t v = 0; v < geometry.vertex_count; v++)
        for (size_t k = 0; k < 3; k++)
            if (!(n[3 * v + k] - n[3 * v + k] == 0)) std::fill_n(&n[3 * v], 3, 0.0f);
    for (uint32_t v : geometry.indices)
        broken += n[3 * size_t(v)] == 0 && n[3 * size_t(v) + 1] == 0 && n[3 * size_t(v) + 2] == 0;
    if (broken == 0) return;
    bool all = broken == geometry.indices.size();
    geometry.notes.push_back(all ? "its normals are all 0 or not finite, and those of its facets are taken"
                                 : "where its normals are 0 or not finite those of its facets are taken");
    if (all) n.clear();
}

static primitive_source source_of(const gltf_asset &asset, int mesh, int primitive) {
    return { asset, asset.model.meshes[size_t(mesh)].primitives[size_t(primitive)],
             gltf_text("meshes[%d].primitives[%d]", mesh, primitive) };
}

std::vector<float> gltf_read_attribute(const gltf_asset &asset, int mesh, int primitive, const std::string &name,
                                       int components) {
    primitive_source source = source_of(asset, mesh, primitive);
    if (source.primitive.attributes.count(name) == 0) return {};
    open_draco(source);
    return read_attribute(source, name, components);
}

std::unique_ptr<gltf_geometry> gltf_read_primitive(const gltf_asset &asset, int mesh, int primitive,
                                                   bool keeps_vertices) {
    primitive_source source = source_of(asset, mesh, primitive);
    auto geometry = std::make_unique<gltf_geometry>();
    if (source.primitive.attributes.count("POSITION") == 0)
        gltf_fail(HEMI_ERROR_DATA, "%s.attributes.POSITION is missing", source.where.c_str());
    open_draco(source);
    if (source.draco_counts_differ)
        geometry->notes.push_back("its Draco bytes hold other counts than its accessors say; the bytes are believed");
    geometry->positions = read_keeping_broken(source, "POSITION");
    if (geometry->positions.size() / 3 > UINT32_MAX / 2)
        gltf_fail(HEMI_ERROR_LIMIT, "%s has too many vertices; split it", source.where.c_str());
    geometry->vertex_count = uint32_t(geometry->positions.size() / 3);
    geometry->normals = read_keeping_broken(source, "NORMAL");
    geometry->colors = read_attribute(source, "COLOR_0", 3);
    geometry->radiosity = read_attribute(source, "_RADIOSITY", 3);
    check_count(source, "NORMAL", geometry->normals, 3, geometry->vertex_count);
    check_count(source, "COLOR_0", geometry->colors, 3, geometry->vertex_count);
    check_count(source, "_RADIOSITY", geometry->radiosity, 3, geometry->vertex_count);
    read_transferred(source, *geometry);
    read_triangles(source, *geometry);
    drop_broken_normals(*geometry);
    if (!keeps_vertices) gltf_weld_corners(*geometry);
    return geometry;
}
