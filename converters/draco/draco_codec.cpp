/* SPDX-License-Identifier: MIT
 * The shim around Draco. Two questions need more than a call:
 *
 * How far did quantisation move a value? Edge-breaker reorders everything, so decoded values cannot be matched with
 * their originals. But quantisation happens before any reordering and everything after it is lossless, so the same mesh
 * is encoded a second time with the sequential method, which keeps the order, and compared point by point. (A
 * lossless id as one more attribute would keep Draco from merging points, and so measure another mesh.)
 *
 * How large may a hostile mesh claim to be? Draco allocates what its header says; peek_counts reads the same numbers
 * first. [Draco bitstream 2.2, sections 4 and 5]
 */
#include "draco_codec.h"

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <future>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <vector>

struct draco_codec_mesh {
    std::unique_ptr<draco::Mesh> mesh;
};

/* ---- encoding ------------------------------------------------------------------------------------------------- */

/* Of a draco_codec_semantic. */
static const draco::GeometryAttribute::Type draco_types[] = {
    draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL, draco::GeometryAttribute::COLOR,
    draco::GeometryAttribute::TEX_COORD, draco::GeometryAttribute::GENERIC
};

static bool attribute_is_valid(const draco_codec_attribute &attribute, uint32_t vertex_count) {
    if (!attribute.values || attribute.components < 1 || attribute.components > 4 || attribute.bits < 0 ||
        attribute.bits > DRACO_CODEC_MAX_BITS || (attribute.origin && !(attribute.range > 0)))
        return false;
    for (size_t i = 0; i < size_t(attribute.components) * vertex_count; i++)
        if (!std::isfinite(attribute.values[i])) return false;
    return true;
}

static bool desc_is_valid(const draco_codec_encode_desc &desc) {
    if (!desc.attributes || !desc.indices || desc.attribute_count < 1 ||
        desc.attribute_count > DRACO_CODEC_MAX_ATTRIBUTES || desc.vertex_count < 1 || desc.triangle_count < 1 ||
        desc.triangle_count > UINT32_MAX / 3 || desc.level < 0 || desc.level > 10)
        return false;
    if (desc.attributes[0].semantic != DRACO_CODEC_POSITION || desc.attributes[0].components != 3) return false;
    for (uint32_t a = 0; a < desc.attribute_count; a++)
        if (!attribute_is_valid(desc.attributes[a], desc.vertex_count)) return false;
    for (size_t i = 0; i < size_t(desc.triangle_count) * 3; i++)
        if (desc.indices[i] >= desc.vertex_count) return false;
    return true;
}

/* Which of `count` rows of `width` words are equal? ids[i]: the number of row i's value; first[id]: a row that has it,
 * in order of appearance. Draco's own DeduplicateAttributeValues does the same, but its hash collides on the round
 * numbers of a grid: encoding two million triangles took 14 s with it and takes 2 s with this. */
struct unique_rows {
    std::vector<uint32_t> ids, first;

    unique_rows(const uint32_t *rows, size_t width, uint32_t count) : ids(count) {
        size_t slots = 16;
        while (slots < size_t(count) * 2) slots *= 2;
        std::vector<uint32_t> table(slots, UINT32_MAX);
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t *row = rows + width * i;
            size_t slot = hash(row, width) & (slots - 1);
            while (table[slot] != UINT32_MAX && std::memcmp(rows + width * first[table[slot]], row, 4 * width) != 0)
                slot = (slot + 1) & (slots - 1);
            if (table[slot] == UINT32_MAX) {
                table[slot] = uint32_t(first.size());
                first.push_back(i);
            }
            ids[i] = table[slot];
        }
    }

    static uint64_t hash(const uint32_t *row, size_t width) { /* splitmix64 over the words */
        uint64_t h = 0;
        for (size_t k = 0; k < width; k++) {
            h = (h ^ row[k]) + 0x9E3779B97F4A7C15u;
            h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
            h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
            h ^= h >> 31;
        }
        return h;
    }
};

/* The bits of an attribute; -0 is 0, so that what is at the same place is equal. */
static std::vector<uint32_t> bits_of(const draco_codec_attribute &attribute, uint32_t vertex_count) {
    std::vector<uint32_t> bits(size_t(attribute.components) * vertex_count);
    for (size_t i = 0; i < bits.size(); i++) {
        float value = attribute.values[i] + 0.0f;
        std::memcpy(&bits[i], &value, sizeof value);
    }
    return bits;
}

/* points.first[p] is a vertex of point p; values.ids[v] the number of its value. */
static void add_attribute(draco::Mesh &mesh, const draco_codec_attribute &attribute, const unique_rows &values,
                          const unique_rows &points) {
    draco::GeometryAttribute description;
    size_t size = sizeof(float) * attribute.components;
    description.Init(draco_types[attribute.semantic], nullptr, int8_t(attribute.components), draco::DT_FLOAT32, false,
                     int64_t(size), 0);
    int id = mesh.AddAttribute(description, false, uint32_t(values.first.size()));
    draco::PointAttribute *target = mesh.attribute(id);
    for (uint32_t i = 0; i < values.first.size(); i++)
        target->SetAttributeValue(draco::AttributeValueIndex(i),
                                  attribute.values + size_t(attribute.components) * values.first[i]);
    for (uint32_t p = 0; p < points.first.size(); p++)
        target->SetPointMapEntry(draco::PointIndex(p), draco::AttributeValueIndex(values.ids[points.first[p]]));
}

/* Equal values become one, which joins triangles that meet at a place: the edge-breaker needs that. Vertices that are
 * equal in all become one point. */
static void build_mesh(const draco_codec_encode_desc &desc, draco::Mesh &mesh) {
    std::vector<unique_rows> values;
    std::vector<uint32_t> keys(size_t(desc.attribute_count) * desc.vertex_count);
    for (uint32_t a = 0; a < desc.attribute_count; a++) {
        values.emplace_back(bits_of(desc.attributes[a], desc.vertex_count).data(), desc.attributes[a].components,
                            desc.vertex_count);
        for (uint32_t v = 0; v < desc.vertex_count; v++) keys[size_t(desc.attribute_count) * v + a] = values[a].ids[v];
    }
    unique_rows points(keys.data(), desc.attribute_count, desc.vertex_count);
    mesh.set_num_points(uint32_t(points.first.size()));
    mesh.SetNumFaces(desc.triangle_count);
    for (uint32_t t = 0; t < desc.triangle_count; t++) {
        draco::Mesh::Face face;
        for (size_t k = 0; k < 3; k++) face[k] = draco::PointIndex(points.ids[desc.indices[size_t(t) * 3 + k]]);
        mesh.SetFace(draco::FaceIndex(t), face);
    }
    for (uint32_t a = 0; a < desc.attribute_count; a++) add_attribute(mesh, desc.attributes[a], values[a], points);
}

/* The digits that a float is read back from. */
static std::string text_of(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", double(value));
    return text;
}

/* Draco keeps options as text, of numbers six digits after the point, which move what is a millionth of a unit long. */
static void set_grid(const draco_codec_attribute &attribute, int index, draco::ExpertEncoder &encoder) {
    draco::Options grid;
    std::string origin;
    for (size_t k = 0; k < attribute.components; k++) origin += (k ? " " : "") + text_of(attribute.origin[k]);
    grid.SetInt("quantization_bits", attribute.bits);
    grid.SetString("quantization_origin", origin);
    grid.SetString("quantization_range", text_of(attribute.range));
    encoder.options().SetAttributeOptions(index, grid);
}

static void set_quantization(const draco_codec_attribute &attribute, int index, draco::ExpertEncoder &encoder) {
    if (attribute.bits == 0) return;
    if (attribute.origin)
        set_grid(attribute, index, encoder);
    else
        encoder.SetAttributeQuantization(index, attribute.bits);
}

static bool encode_with(const draco_codec_encode_desc &desc, const draco::Mesh &mesh, int method, int speed,
                        draco::EncoderBuffer &buffer) {
    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetEncodingMethod(method);
    for (uint32_t a = 0; a < desc.attribute_count; a++) set_quantization(desc.attributes[a], int(a), encoder);
    return encoder.EncodeToBuffer(&buffer).ok();
}

static std::unique_ptr<draco::Mesh> decode_buffer(const char *bytes, size_t size) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes, size);
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    return result.ok() ? std::move(result).value() : nullptr;
}

/* ---- measuring what came out ---------------------------------------------------------------------------------- */

static void point_value(const draco::PointAttribute &attribute, uint32_t point, float *value) {
    attribute.GetValue(attribute.mapped_index(draco::PointIndex(point)), value);
}

static double difference(const draco_codec_attribute &attribute, const float *a, const float *b) {
    double square = 0, largest = 0;
    for (uint32_t k = 0; k < attribute.components; k++) {
        double d = std::fabs(double(a[k]) - double(b[k]));
        square += d * d;
        largest = std::fmax(largest, d);
    }
    bool vector = attribute.semantic == DRACO_CODEC_POSITION || attribute.semantic == DRACO_CODEC_NORMAL;
    return vector ? std::sqrt(square) : largest;
}

/* decoded comes from the sequential method: point i is point i of mesh. */
static bool measure_errors(const draco_codec_encode_desc &desc, const draco::Mesh &mesh, draco_codec_encoded &out) {
    draco::EncoderBuffer buffer;
    if (!encode_with(desc, mesh, draco::MESH_SEQUENTIAL_ENCODING, 10, buffer)) return false;
    std::unique_ptr<draco::Mesh> decoded = decode_buffer(buffer.data(), buffer.size());
    if (!decoded || decoded->num_points() != mesh.num_points()) return false;
    for (uint32_t a = 0; a < desc.attribute_count; a++) {
        const draco::PointAttribute *after = decoded->GetAttributeByUniqueId(mesh.attribute(int(a))->unique_id());
        if (!after) return false;
        double worst = 0;
        for (uint32_t p = 0; p < mesh.num_points(); p++) {
            float x[4], y[4];
            point_value(*mesh.attribute(int(a)), p, x);
            point_value(*after, p, y);
            worst = std::fmax(worst, difference(desc.attributes[a], x, y));
        }
        out.max_error[a] = worst;
    }
    return true;
}

static bool measure_bounds(const draco_codec_encode_desc &desc, const draco::Mesh &mesh, const draco::Mesh &decoded,
                           draco_codec_encoded &out) {
    for (uint32_t a = 0; a < desc.attribute_count; a++) {
        out.unique_ids[a] = mesh.attribute(int(a))->unique_id();
        const draco::PointAttribute *after = decoded.GetAttributeByUniqueId(out.unique_ids[a]);
        if (!after || after->num_components() != int(desc.attributes[a].components)) return false;
        std::fill_n(out.lower[a], 4, std::numeric_limits<float>::infinity());
        std::fill_n(out.upper[a], 4, -std::numeric_limits<float>::infinity());
        for (uint32_t p = 0; p < decoded.num_points(); p++) {
            float value[4];
            point_value(*after, p, value);
            for (uint32_t k = 0; k < desc.attributes[a].components; k++) {
                out.lower[a][k] = std::min(out.lower[a][k], value[k]);
                out.upper[a][k] = std::max(out.upper[a][k], value[k]);
            }
        }
    }
    out.point_count = decoded.num_points();
    out.face_count = decoded.num_faces();
    return true;
}

/* Encodes into buffer with the best method that keeps every triangle; the mesh as decoded, or null. */
static std::unique_ptr<draco::Mesh> encode_whole(const draco_codec_encode_desc &desc, const draco::Mesh &mesh,
                                                 draco::EncoderBuffer &buffer, bool *sequential) {
    static const int methods[] = { draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING };
    for (int method : methods) {
        buffer.Clear();
        if (!encode_with(desc, mesh, method, 10 - desc.level, buffer)) continue;
        std::unique_ptr<draco::Mesh> decoded = decode_buffer(buffer.data(), buffer.size());
        if (!decoded || decoded->num_faces() != desc.triangle_count) continue;
        *sequential = method == draco::MESH_SEQUENTIAL_ENCODING;
        return decoded;
    }
    return nullptr;
}

/* Runs work, which may throw. */
template <typename work_t> static hemi_result guarded(const work_t &work) {
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return HEMI_ERROR_MEMORY;
    } catch (...) {
        return HEMI_ERROR_DATA;
    }
}

static hemi_result encode(const draco_codec_encode_desc &desc, draco_codec_encoded &out) {
    draco::Mesh mesh;
    build_mesh(desc, mesh);
    draco::EncoderBuffer buffer;
    auto errors = std::async(desc.shares ? std::launch::async | std::launch::deferred : std::launch::deferred,
                             [&] { return measure_errors(desc, mesh, out); });
    std::unique_ptr<draco::Mesh> decoded = encode_whole(desc, mesh, buffer, &out.sequential);
    if (!decoded || !measure_bounds(desc, mesh, *decoded, out) || !errors.get()) return HEMI_ERROR_DATA;
    out.bytes = static_cast<uint8_t *>(std::malloc(buffer.size()));
    if (!out.bytes) return HEMI_ERROR_MEMORY;
    std::memcpy(out.bytes, buffer.data(), buffer.size());
    out.byte_count = buffer.size();
    return HEMI_OK;
}

hemi_result draco_codec_encode(const draco_codec_encode_desc *desc, draco_codec_encoded *out) {
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = draco_codec_encoded{};
    if (!desc || !desc_is_valid(*desc)) return HEMI_ERROR_ARGUMENT;
    return guarded([&] { return encode(*desc, *out); });
}

void draco_codec_encoded_free(draco_codec_encoded *encoded) {
    if (!encoded) return;
    std::free(encoded->bytes);
    *encoded = draco_codec_encoded{};
}

/* ---- decoding ------------------------------------------------------------------------------------------------- */

/* What the header says; older bitstreams than 2.2, and ones with metadata, which glTF does not use, are refused. */
static hemi_result peek_counts(const uint8_t *bytes, size_t size, uint32_t *points, uint32_t *faces) {
    draco::DecoderBuffer buffer;
    draco::DracoHeader header;
    uint8_t traversal;
    buffer.Init(reinterpret_cast<const char *>(bytes), size);
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return HEMI_ERROR_DATA;
    if (header.encoder_type != draco::TRIANGULAR_MESH) return HEMI_ERROR_DATA;
    if (header.version_major != 2 || header.version_minor != 2 || (header.flags & METADATA_FLAG_MASK))
        return HEMI_ERROR_UNSUPPORTED;
    bool sequential = header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING;
    bool whole = sequential || buffer.Decode(&traversal);
    whole = whole && draco::DecodeVarint(sequential ? faces : points, &buffer);
    return whole && draco::DecodeVarint(sequential ? points : faces, &buffer) ? HEMI_OK : HEMI_ERROR_DATA;
}

/* Faces only point at points that exist; attributes map every point to a value that exists. */
static bool mesh_is_sound(const draco::Mesh &mesh) {
    for (uint32_t f = 0; f < mesh.num_faces(); f++)
        for (int k = 0; k < 3; k++)
            if (mesh.face(draco::FaceIndex(f))[size_t(k)].value() >= mesh.num_points()) return false;
    for (int a = 0; a < mesh.num_attributes(); a++) {
        const draco::PointAttribute &attribute = *mesh.attribute(a);
        if (!attribute.is_mapping_identity() && attribute.indices_map_size() < mesh.num_points()) return false;
        for (uint32_t p = 0; p < mesh.num_points(); p++)
            if (attribute.mapped_index(draco::PointIndex(p)).value() >= attribute.size()) return false;
    }
    return true;
}

/* Past a few million a mesh must also be of a plausible size: a flat, evenly lit grid of two million triangles, which
 * is what Draco packs best, took one byte for 270 faces. */
static bool is_plausible(uint64_t count, size_t size) {
    return count <= (1u << 22) || (count <= (1u << 25) && count / 4096 <= size);
}

static hemi_result decode(const uint8_t *bytes, size_t size, uint32_t point_limit, uint32_t face_limit,
                          draco_codec_mesh **out) {
    uint32_t points, faces;
    hemi_result result = peek_counts(bytes, size, &points, &faces);
    if (result != HEMI_OK) return result;
    if (points > point_limit || faces > face_limit || !is_plausible(points, size) || !is_plausible(faces, size))
        return HEMI_ERROR_LIMIT;
    std::unique_ptr<draco::Mesh> mesh = decode_buffer(reinterpret_cast<const char *>(bytes), size);
    if (!mesh || !mesh_is_sound(*mesh)) return HEMI_ERROR_DATA;
    if (mesh->num_points() > point_limit || mesh->num_faces() > face_limit) return HEMI_ERROR_LIMIT;
    for (int a = 0; a < mesh->num_attributes(); a++) mesh->attribute(a)->set_normalized(false); /* as they are stored */
    *out = new draco_codec_mesh{ std::move(mesh) };
    return HEMI_OK;
}

hemi_result draco_codec_decode(const uint8_t *bytes, size_t byte_count, uint32_t point_limit, uint32_t face_limit,
                               draco_codec_mesh **out) {
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = nullptr;
    if (!bytes) return HEMI_ERROR_ARGUMENT;
    return guarded([&] { return decode(bytes, byte_count, point_limit, face_limit, out); });
}

void draco_codec_mesh_destroy(draco_codec_mesh *mesh) {
    delete mesh;
}

uint32_t draco_codec_mesh_point_count(const draco_codec_mesh *mesh) {
    return mesh->mesh->num_points();
}

uint32_t draco_codec_mesh_face_count(const draco_codec_mesh *mesh) {
    return mesh->mesh->num_faces();
}

void draco_codec_mesh_indices(const draco_codec_mesh *mesh, uint32_t *indices) {
    for (uint32_t f = 0; f < mesh->mesh->num_faces(); f++)
        for (int k = 0; k < 3; k++)
            indices[size_t(f) * 3 + size_t(k)] = mesh->mesh->face(draco::FaceIndex(f))[size_t(k)].value();
}

uint32_t draco_codec_mesh_components(const draco_codec_mesh *mesh, uint32_t unique_id) {
    const draco::PointAttribute *attribute = mesh->mesh->GetAttributeByUniqueId(unique_id);
    return attribute ? uint32_t(attribute->num_components()) : 0;
}

bool draco_codec_mesh_values(const draco_codec_mesh *mesh, uint32_t unique_id, uint32_t components, float *values) {
    const draco::PointAttribute *attribute = mesh->mesh->GetAttributeByUniqueId(unique_id);
    if (!attribute || attribute->num_components() != int(components) || components > 4) return false;
    draco::DataType type = attribute->data_type();
    if (type != draco::DT_FLOAT32 && (type < draco::DT_INT8 || type > draco::DT_UINT32)) return false;
    for (uint32_t p = 0; p < mesh->mesh->num_points(); p++)
        if (!attribute->ConvertValue(attribute->mapped_index(draco::PointIndex(p)), int8_t(components),
                                     values + size_t(components) * p))
            return false;
    return true;
}
