/* SPDX-License-Identifier: MIT
 * Which bytes are behind a buffer view that EXT_meshopt_compression packed, and which corners are one vertex? Both are
 * meshoptimizer's work. A packed view gets a buffer of its own and is a plain view afterwards.
 * [EXT_meshopt_compression, modes and filters]
 */
#include "gltf_model.h"

#include <meshoptimizer.h>

static const char extension_name[] = "EXT_meshopt_compression";

/* What the extension of one view says; where names it in messages. */
struct packed_view {
    std::string where, mode, filter;
    size_t buffer, offset, length, stride, count;
};

static size_t size_member(const tinygltf::Value &object, const char *name, bool required, const std::string &where) {
    if (!object.Has(name) && !required) return 0;
    const tinygltf::Value &value = object.Has(name) ? object.Get(name) : tinygltf::Value();
    double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    if (!(number >= 0 && number <= INT32_MAX && number == double(size_t(number))))
        gltf_fail(HEMI_ERROR_DATA, "%s.%s is not a non-negative integer", where.c_str(), name);
    return size_t(number);
}

static std::string text_member(const tinygltf::Value &object, const char *name, const char *fallback) {
    if (!object.Has(name) || !object.Get(name).IsString()) return fallback;
    return object.Get(name).Get<std::string>();
}

static packed_view read_description(const tinygltf::Value &object, const std::string &where) {
    packed_view view;
    if (!object.IsObject()) gltf_fail(HEMI_ERROR_DATA, "%s is not an object", where.c_str());
    view.where = where;
    view.mode = text_member(object, "mode", "");
    view.filter = text_member(object, "filter", "NONE");
    view.buffer = size_member(object, "buffer", true, where);
    view.offset = size_member(object, "byteOffset", false, where);
    view.length = size_member(object, "byteLength", true, where);
    view.stride = size_member(object, "byteStride", true, where);
    view.count = size_member(object, "count", true, where);
    return view;
}

/* What the codecs and filters demand of a stride, and what their bytes can hold at most: a vertex block of 256 takes
 * four bytes for each byte of a vertex, a triangle one byte, an index one byte. So what is allocated is bounded by what
 * the file has. */
static void check_description(const gltf_asset &asset, const packed_view &view) {
    const char *where = view.where.c_str();
    gltf_check_index(int(view.buffer), asset.buffers.size(), "buffers", view.where + ".buffer");
    size_t size = asset.buffers[view.buffer].size(), largest = 0;
    if (view.length > size || view.offset > size - view.length)
        gltf_fail(HEMI_ERROR_DATA, "%s covers bytes %zu+%zu of a buffer of %zu", where, view.offset, view.length, size);
    bool indices = view.stride == 2 || view.stride == 4, suits = false;
    if (view.mode == "ATTRIBUTES") {
        suits = view.stride >= 4 && view.stride <= 256 && view.stride % 4 == 0;
        largest = view.length * 64;
    } else if (view.mode == "TRIANGLES") {
        suits = indices && view.count % 3 == 0;
        largest = view.length * 3 * view.stride;
    } else if (view.mode == "INDICES") {
        suits = indices;
        largest = view.length * view.stride;
    } else {
        gltf_fail(HEMI_ERROR_DATA, "%s.mode is none of ATTRIBUTES, TRIANGLES, INDICES", where);
    }
    if (view.filter == "OCTAHEDRAL") suits = suits && (view.stride == 4 || view.stride == 8);
    if (view.filter == "QUATERNION") suits = suits && view.stride == 8;
    if (!suits || view.count == 0)
        gltf_fail(HEMI_ERROR_DATA, "%s: %zu elements of byteStride %zu do not suit its mode and filter", where,
                  view.count, view.stride);
    if (view.count > largest / view.stride)
        gltf_fail(HEMI_ERROR_DATA, "%s.count is %zu, more than its %zu bytes can hold", where, view.count, view.length);
}

static void unfilter(const packed_view &view, unsigned char *bytes) {
    if (view.filter == "OCTAHEDRAL")
        meshopt_decodeFilterOct(bytes, view.count, view.stride);
    else if (view.filter == "QUATERNION")
        meshopt_decodeFilterQuat(bytes, view.count, view.stride);
    else if (view.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(bytes, view.count, view.stride);
    else if (view.filter != "NONE")
        gltf_fail(HEMI_ERROR_DATA, "%s.filter is none of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL",
                  view.where.c_str());
}

static std::vector<unsigned char> unpack(const gltf_asset &asset, const packed_view &view) {
    const unsigned char *from = asset.buffers[view.buffer].data() + view.offset;
    std::vector<unsigned char> bytes(view.count * view.stride);
    int result;
    if (view.mode == "ATTRIBUTES")
        result = meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, from, view.length);
    else if (view.mode == "TRIANGLES")
        result = meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, from, view.length);
    else
        result = meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, from, view.length);
    if (result != 0)
        gltf_fail(HEMI_ERROR_DATA, "%s: its bytes cannot be decoded (code %d)", view.where.c_str(), result);
    unfilter(view, bytes.data());
    return bytes;
}

void gltf_decode_meshopt(gltf_asset &asset) {
    size_t total = 0;
    for (size_t v = 0; v < asset.model.bufferViews.size(); v++) {
        tinygltf::BufferView &view = asset.model.bufferViews[v];
        auto found = view.extensions.find(extension_name);
        if (found == view.extensions.end()) continue;
        std::string where = gltf_text("bufferViews[%zu].extensions.%s", v, extension_name);
        packed_view packed = read_description(found->second, where);
        check_description(asset, packed);
        total += packed.count * packed.stride;
        if (total > gltf_bytes_max)
            gltf_fail(HEMI_ERROR_LIMIT, "%s: all decoded bytes together exceed 2 GiB", packed.where.c_str());
        std::vector<unsigned char> bytes = unpack(asset, packed);
        view.extensions.erase(found);
        view.buffer = int(asset.buffers.size());
        view.byteOffset = 0;
        view.byteLength = bytes.size();
        asset.buffers.push_back(std::move(bytes));
    }
}

/* ---- corners that are alike ------------------------------------------------------------------------------------- */

static void add_stream(const std::vector<float> &values, size_t components, std::vector<meshopt_Stream> &out) {
    if (!values.empty()) out.push_back({ values.data(), components * sizeof(float), components * sizeof(float) });
}

/* Triangles that share no corner, as files without indices have them, share those that are alike in everything: only
 * then are two of them one parallelogram, which is half as much to solve. Vertices keep their numbers. */
void gltf_weld_corners(gltf_geometry &geometry) {
    std::vector<uint32_t> &indices = geometry.indices;
    if (indices.size() > geometry.vertex_count) return;
    std::vector<meshopt_Stream> streams;
    add_stream(geometry.positions, 3, streams);
    add_stream(geometry.normals, 3, streams);
    add_stream(geometry.radiosity, 3, streams);
    add_stream(geometry.attributes, geometry.attribute_count, streams);
    for (const gltf_attribute &attribute : geometry.lit_only)
        add_stream(attribute.values, size_t(attribute.components), streams);
    std::vector<unsigned> remap(geometry.vertex_count), first(geometry.vertex_count, ~0u);
    meshopt_generateVertexRemapMulti(remap.data(), indices.data(), indices.size(), geometry.vertex_count,
                                     streams.data(), streams.size());
    for (uint32_t &index : indices) {
        unsigned &known = first[remap[index]];
        if (known == ~0u) known = index;
        index = known;
    }
}
