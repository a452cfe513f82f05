/* SPDX-License-Identifier: MIT
 * How is a baked primitive stored, plain or through Draco, and what does that cost in bytes and accuracy?
 *
 * Plain COLOR_0 is normalised UNSIGNED_SHORT VEC4, as Blender writes it: eight bytes keep the alignment, and eight bits
 * would band in linear light. Draco's COLOR_0 is a FLOAT VEC3 accessor with 12 bits inside: normalised integers inside
 * Draco were misread by Cesium until 2025-01, three.js until 2023, PlayCanvas until 2023-01.
 */
#include "gltf_model.h"

#include "draco_codec.h"
#include "gltf_parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>

static std::vector<unsigned char> bytes_of(const void *data, size_t size) {
    std::vector<unsigned char> bytes(size);
    std::memcpy(bytes.data(), data, size);
    return bytes;
}

/* An accessor to be; members are written in the order of their names. */
struct accessor_desc {
    int view; /* -1: none, its values are in Draco's bytes */
    int component_type, components;
    size_t count;
    const float *lower = nullptr, *upper = nullptr; /* three numbers each, of positions */
    bool normalized = false;
};

static void set_bound(cJSON *accessor, const char *name, const float *bound) {
    if (!bound) return;
    const double numbers[3] = { double(bound[0]), double(bound[1]), double(bound[2]) };
    gltf_set_numbers(accessor, name, numbers, 3);
}

static int add_accessor(gltf_draft &draft, const accessor_desc &desc) {
    static const char *const types[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };
    gltf_json accessor(cJSON_CreateObject());
    if (desc.view >= 0) gltf_set_number(accessor.get(), "bufferView", desc.view);
    gltf_set_number(accessor.get(), "componentType", desc.component_type);
    gltf_set_number(accessor.get(), "count", double(desc.count));
    set_bound(accessor.get(), "max", desc.upper);
    set_bound(accessor.get(), "min", desc.lower);
    if (desc.normalized) gltf_set(accessor.get(), "normalized", gltf_json(cJSON_CreateTrue()));
    gltf_set_text(accessor.get(), "type", types[desc.components - 1]);
    return gltf_add_element(draft, gltf_accessors, std::move(accessor));
}

/* ---- plain ---------------------------------------------------------------------------------------------------- */

static int add_floats(gltf_draft &draft, const float *values, size_t count, int components,
                      const float *lower = nullptr, const float *upper = nullptr) {
    int view = gltf_add_view(draft, bytes_of(values, count * size_t(components) * sizeof *values),
                             TINYGLTF_TARGET_ARRAY_BUFFER);
    return add_accessor(draft, { view, TINYGLTF_COMPONENT_TYPE_FLOAT, components, count, lower, upper });
}

static int add_positions(gltf_draft &draft, const hemi_mesh_view &view) {
    float lower[3], upper[3];
    for (size_t k = 0; k < 3; k++) lower[k] = upper[k] = view.positions[k];
    for (size_t i = 0; i < size_t(view.vertex_count) * 3; i++) {
        lower[i % 3] = std::min(lower[i % 3], view.positions[i]);
        upper[i % 3] = std::max(upper[i % 3], view.positions[i]);
    }
    return add_floats(draft, view.positions, view.vertex_count, 3, lower, upper);
}

static int add_colors(gltf_draft &draft, const float *colors, size_t count, size_t width) {
    std::vector<uint16_t> stored(count * 4, 65535);
    double &worst = draft.stats.max_color_error;
    for (size_t v = 0; v < count; v++)
        for (size_t c = 0; c < width; c++) {
            double color = colors[width * v + c];
            stored[4 * v + c] = uint16_t(std::lround(color * 65535));
            worst = std::fmax(worst, std::fabs(stored[4 * v + c] / 65535.0 - color));
        }
    int view = gltf_add_view(draft, bytes_of(stored.data(), stored.size() * 2), TINYGLTF_TARGET_ARRAY_BUFFER);
    return add_accessor(draft, { view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 4, count, nullptr, nullptr, true });
}

int gltf_add_colors(gltf_draft &draft, const gltf_baked_primitive &baked, size_t first, size_t count) {
    const float *colors = baked.colors.data() + first * size_t(baked.color_width);
    return baked.float_colors ? add_floats(draft, colors, count, baked.color_width)
                              : add_colors(draft, colors, count, size_t(baked.color_width));
}

int gltf_add_floats(gltf_draft &draft, const float *values, size_t count, int components) {
    return add_floats(draft, values, count, components);
}

/* 65535 would restart a strip, so the largest short index is 65534. */
static bool fits_short(uint32_t vertex_count) {
    return vertex_count <= 65535;
}

static int index_type(uint32_t vertex_count) {
    return fits_short(vertex_count) ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

int gltf_add_triangles(gltf_draft &draft, const uint32_t *indices, size_t count, uint32_t vertex_count) {
    std::vector<unsigned char> bytes;
    if (fits_short(vertex_count)) {
        std::vector<uint16_t> shorts(indices, indices + count);
        bytes = bytes_of(shorts.data(), count * 2);
    } else {
        bytes = bytes_of(indices, count * 4);
    }
    int stored = gltf_add_view(draft, std::move(bytes), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    return add_accessor(draft, { stored, index_type(vertex_count), 1, count });
}

uint64_t gltf_plain_bytes(const gltf_baked_primitive &baked) {
    uint64_t vertex = 12 +
                      (baked.colors.empty() ? 0
                       : baked.float_colors ? 4 * uint64_t(baked.color_width)
                                            : 8) +
                      (baked.radiosity ? 12 : 0) + (baked.errors ? 4 : 0);
    for (const gltf_attribute &attribute : baked.transferred) vertex += 4 * uint64_t(attribute.components);
    vertex += 12 * uint64_t(baked.lights.size());
    uint64_t index = fits_short(baked.view->vertex_count) ? 2 : 4;
    return vertex * baked.view->vertex_count + index * 3 * baked.view->triangle_count;
}

void gltf_count_geometry(gltf_output &stats, const gltf_baked_primitive &baked, uint64_t vertices, uint64_t bytes) {
    stats.triangles += baked.view->triangle_count;
    stats.vertices += vertices;
    stats.geometry_bytes_before += gltf_plain_bytes(baked);
    stats.geometry_bytes_after += bytes;
}

static gltf_encoded_primitive encode_plain(gltf_draft &draft, const gltf_baked_primitive &baked) {
    const hemi_mesh_view &view = *baked.view;
    gltf_encoded_primitive out;
    out.indices = gltf_add_triangles(draft, view.indices, size_t(view.triangle_count) * 3, view.vertex_count);
    out.attributes["POSITION"] = add_positions(draft, view);
    if (!baked.colors.empty()) out.attributes["COLOR_0"] = gltf_add_colors(draft, baked, 0, view.vertex_count);
    for (const gltf_attribute &attribute : baked.transferred)
        out.attributes[attribute.name] =
            add_floats(draft, attribute.values.data(), view.vertex_count, attribute.components);
    for (const gltf_attribute &light : baked.lights)
        out.attributes[light.name] = add_floats(draft, light.values.data(), view.vertex_count, 3);
    if (baked.radiosity) out.attributes["_RADIOSITY"] = add_floats(draft, baked.radiosity, view.vertex_count, 3);
    if (baked.errors) out.attributes["_ERROR"] = add_floats(draft, baked.errors, view.vertex_count, 1);
    gltf_count_geometry(draft.stats, baked, view.vertex_count, gltf_plain_bytes(baked));
    return out;
}

/* ---- Draco ---------------------------------------------------------------------------------------------------- */

/* The origin and the largest extent of values, joined to what the grid spans already. */
static void span(gltf_grids &grids, const std::string &name, const float *values, size_t count, size_t width,
                 std::map<std::string, std::array<float, 4>> &upper) {
    auto [at, fresh] = grids.insert({ name, {} });
    std::array<float, 4> &high = upper[name];
    for (size_t v = 0; v < count; v++)
        for (size_t k = 0; k < width; k++) {
            float value = values[width * v + k];
            bool first = fresh && v == 0;
            at->second.origin[k] = first ? value : std::min(at->second.origin[k], value);
            high[k] = first ? value : std::max(high[k], value);
        }
    for (size_t k = 0; k < width; k++) at->second.range = std::max(at->second.range, high[k] - at->second.origin[k]);
}

static int bits_or(int bits, int fallback) {
    return bits > 0 ? bits : fallback;
}

int gltf_position_bits(const int *bits) {
    return bits_or(bits[0], 14);
}

/* So many bits more the largest mesh has, so that meshes down to a quarter of its size have its step, too. */
enum { shared_bits = 2, float_bits = 24 };

/* The largest power of two that is no more than a step of so many bits. */
static double step_below(double extent, int bits) {
    return std::ldexp(1.0, std::ilogb(extent / std::ldexp(1.0, bits)));
}

double gltf_shared_step(const std::vector<double> &extents, int bits) {
    double largest = 0;
    for (double extent : extents) largest = std::fmax(largest, extent);
    bool fits = bits + shared_bits + 1 < float_bits && largest > 0 && std::isfinite(largest);
    return fits && extents.size() > 1 ? step_below(largest, bits + shared_bits) : 0;
}

/* A mesh that is far from its own origin has floats of no more bits than they have. */
static void snap(gltf_grid &grid, double shared_step, int bits) {
    double step = std::fmin(step_below(grid.range, bits), shared_step), reach = grid.range;
    float origin[3];
    for (size_t k = 0; k < 3; k++) {
        origin[k] = float(std::floor(grid.origin[k] / step) * step);
        reach = std::fmax(reach, grid.origin[k] + double(grid.range) - origin[k]);
    }
    int needed = std::ilogb(reach / step + 1) + 1;
    if (needed >= float_bits) return;
    std::copy(origin, origin + 3, grid.origin);
    grid.range = float(step * (std::ldexp(1.0, needed) - 1));
    grid.bits = needed;
}

gltf_grids gltf_shared_grids(const std::vector<gltf_baked_primitive> &primitives, double shared_step, int bits) {
    gltf_grids grids;
    std::map<std::string, std::array<float, 4>> upper;
    for (const gltf_baked_primitive &baked : primitives) {
        size_t count = baked.view->vertex_count;
        span(grids, "POSITION", baked.view->positions, count, 3, upper);
        if (!baked.colors.empty()) span(grids, "COLOR_0", baked.colors.data(), count, size_t(baked.color_width), upper);
        for (const gltf_attribute &attribute : baked.transferred)
            span(grids, attribute.name, attribute.values.data(), count, size_t(attribute.components), upper);
    }
    auto positions = grids.find("POSITION");
    if (shared_step > 0 && positions != grids.end() && positions->second.range > 0)
        snap(positions->second, shared_step, bits);
    return grids;
}

struct draco_attributes {
    const gltf_grids &grids;
    std::vector<std::string> names{};
    std::vector<draco_codec_attribute> list{};

    void add(const std::string &name, draco_codec_semantic semantic, int components, int bits, const float *values) {
        auto grid = grids.find(name);
        bool shared = grid != grids.end() && semantic != DRACO_CODEC_NORMAL && grid->second.range > 0;
        names.push_back(name);
        if (shared && grid->second.bits > 0) bits = grid->second.bits;
        list.push_back({ semantic, uint32_t(components), bits, values, shared ? grid->second.origin : nullptr,
                         shared ? grid->second.range : 0 });
    }
};

/* What is not known to bear quantisation is kept as it is. */
static void add_transferred(draco_attributes &attributes, const gltf_attribute &attribute, const int *bits) {
    bool normal = attribute.name == "NORMAL", color = attribute.name.compare(0, 6, "COLOR_") == 0;
    bool texcoord = attribute.name.compare(0, 9, "TEXCOORD_") == 0;
    draco_codec_semantic semantic = normal     ? DRACO_CODEC_NORMAL
                                    : color    ? DRACO_CODEC_COLOR
                                    : texcoord ? DRACO_CODEC_TEXCOORD
                                               : DRACO_CODEC_GENERIC;
    int used = normal || attribute.name == "TANGENT" ? bits_or(bits[1], 10)
               : color                               ? bits_or(bits[2], 12)
               : texcoord                            ? bits_or(bits[3], 12)
                                                     : 0;
    attributes.add(attribute.name, semantic, attribute.components, used, attribute.values.data());
}

static draco_attributes list_attributes(const gltf_baked_primitive &baked, const gltf_grids &grids, const int *bits) {
    draco_attributes attributes = { grids };
    attributes.add("POSITION", DRACO_CODEC_POSITION, 3, gltf_position_bits(bits), baked.view->positions);
    if (!baked.colors.empty())
        attributes.add("COLOR_0", DRACO_CODEC_COLOR, baked.color_width, bits_or(bits[2], 12), baked.colors.data());
    for (const gltf_attribute &attribute : baked.transferred) add_transferred(attributes, attribute, bits);
    for (const gltf_attribute &light : baked.lights) add_transferred(attributes, light, bits);
    if (baked.radiosity) attributes.add("_RADIOSITY", DRACO_CODEC_GENERIC, 3, 0, baked.radiosity);
    if (baked.errors) attributes.add("_ERROR", DRACO_CODEC_GENERIC, 1, 0, baked.errors);
    return attributes;
}

/* From so many triangles on a thread of its own is worth starting. */
enum { shared_triangles = 20000 };

static void encode_bytes(const gltf_baked_primitive &baked, const draco_attributes &attributes,
                         const gltf_write_desc &how, draco_codec_encoded *encoded) {
    draco_codec_encode_desc desc = {};
    desc.attributes = attributes.list.data();
    desc.attribute_count = uint32_t(attributes.list.size());
    desc.vertex_count = baked.view->vertex_count;
    desc.indices = baked.view->indices;
    desc.triangle_count = baked.view->triangle_count;
    desc.level = how.draco_level;
    desc.shares = how.threads != 1 && desc.triangle_count >= shared_triangles;
    hemi_result result = draco_codec_encode(&desc, encoded);
    if (result == HEMI_ERROR_MEMORY) throw std::bad_alloc();
    if (result != HEMI_OK) gltf_fail(result, "%s: Draco cannot encode it; write it without Draco", baked.where.c_str());
}

/* Accessors without a buffer view: how many and which bounds a reader will find in the Draco bytes. */
static void describe(gltf_draft &draft, const draco_attributes &attributes, const draco_codec_encoded &encoded,
                     gltf_encoded_primitive &out) {
    for (size_t a = 0; a < attributes.list.size(); a++) {
        accessor_desc desc = { -1, TINYGLTF_COMPONENT_TYPE_FLOAT, int(attributes.list[a].components),
                               encoded.point_count };
        if (a == 0) desc.lower = encoded.lower[a], desc.upper = encoded.upper[a];
        out.attributes[attributes.names[a]] = add_accessor(draft, desc);
        out.draco_ids[attributes.names[a]] = int(encoded.unique_ids[a]);
    }
    out.indices = add_accessor(draft, { -1, index_type(encoded.point_count), 1, size_t(encoded.face_count) * 3 });
}

static void note_errors(gltf_output &stats, const gltf_baked_primitive &baked, const draco_attributes &attributes,
                        const draco_codec_encoded &encoded) {
    stats.max_position_error = std::fmax(stats.max_position_error, encoded.max_error[0] * baked.scale);
    for (size_t a = 1; a < attributes.list.size(); a++) {
        double *worst = attributes.names[a] == "COLOR_0"                      ? &stats.max_color_error
                        : attributes.names[a] == "NORMAL"                     ? &stats.max_normal_error
                        : attributes.list[a].semantic == DRACO_CODEC_TEXCOORD ? &stats.max_texcoord_error
                                                                              : nullptr;
        if (worst) *worst = std::fmax(*worst, encoded.max_error[a]);
    }
}

/* What Draco makes of a primitive; what it cannot is told where the primitive's turn comes. */
struct packed_primitive {
    draco_attributes attributes;
    draco_codec_encoded encoded{};
    std::exception_ptr failure{};

    packed_primitive(const gltf_to_encode &from, const int *bits)
        : attributes(list_attributes(*from.baked, *from.grids, bits)) {}
    packed_primitive(const packed_primitive &) = delete;
    ~packed_primitive() { draco_codec_encoded_free(&encoded); }
};

struct packing {
    const std::vector<gltf_to_encode> &list;
    const gltf_write_desc &desc;
    std::vector<size_t> order; /* what takes longest first */
    std::vector<std::unique_ptr<packed_primitive>> packed;
};

/* Nothing is thrown through the threads' own code. */
static void pack_one(packing &p, size_t i) {
    packed_primitive &out = *p.packed[p.order[i]];
    try {
        encode_bytes(*p.list[p.order[i]].baked, out.attributes, p.desc, &out.encoded);
    } catch (...) {
        out.failure = std::current_exception();
    }
}

static void pack_all(packing &p) {
    for (const gltf_to_encode &one : p.list) {
        p.order.push_back(p.packed.size());
        p.packed.push_back(std::make_unique<packed_primitive>(one, p.desc.draco_bits));
    }
    auto triangles = [&p](size_t i) { return p.list[i].baked->view->triangle_count; };
    std::stable_sort(p.order.begin(), p.order.end(),
                     [&triangles](size_t a, size_t b) { return triangles(a) > triangles(b); });
    gltf_parallel(p.desc.threads, p.list.size(), [&p](size_t i) { pack_one(p, i); });
}

static gltf_encoded_primitive take_packed(gltf_draft &draft, const gltf_baked_primitive &baked,
                                          const packed_primitive &from) {
    if (from.failure) std::rethrow_exception(from.failure);
    gltf_encoded_primitive out;
    out.draco_view = gltf_add_view(draft, bytes_of(from.encoded.bytes, from.encoded.byte_count), 0);
    describe(draft, from.attributes, from.encoded, out);
    gltf_count_geometry(draft.stats, baked, from.encoded.point_count, from.encoded.byte_count);
    note_errors(draft.stats, baked, from.attributes, from.encoded);
    return out;
}

std::vector<gltf_encoded_primitive> gltf_encode(gltf_draft &draft, const std::vector<gltf_to_encode> &list,
                                                const gltf_write_desc &desc) {
    std::vector<gltf_encoded_primitive> out;
    packing p = { list, desc, {}, {} };
    if (desc.draco) pack_all(p);
    for (size_t i = 0; i < list.size(); i++)
        out.push_back(desc.draco ? take_packed(draft, *list[i].baked, *p.packed[i])
                                 : encode_plain(draft, *list[i].baked));
    return out;
}
