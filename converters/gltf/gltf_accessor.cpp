/* SPDX-License-Identifier: MIT
 * Which numbers does an accessor hold? Any component type, byte stride, normalisation and sparse substitution; the
 * ranges have been checked (gltf_check.cpp).
 */
#include "gltf_model.h"

#include <cmath>
#include <cstring>

/* Accessors without a buffer view hold zeros that cost a file nothing: what is read of them is bounded by this. */
static const size_t zero_count_max = size_t(1) << 24;

/* Columns of small matrices begin at multiples of four bytes. [glTF 2.0, 3.6.2.4] */
size_t gltf_element_size(const tinygltf::Accessor &accessor) {
    size_t component = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)));
    size_t rows = accessor.type == TINYGLTF_TYPE_MAT2   ? 2
                  : accessor.type == TINYGLTF_TYPE_MAT3 ? 3
                  : accessor.type == TINYGLTF_TYPE_MAT4 ? 4
                                                        : 0;
    if (rows) return rows * ((rows * component + 3) / 4 * 4);
    return component * size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
}

template <typename T> static T load(const unsigned char *at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

static double component_value(const unsigned char *at, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return load<int8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load<uint8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return load<int16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load<uint32_t>(at);
    default:
        return load<float>(at);
    }
}

/* The integer that stands for 1; 0: not normalised. [glTF 2.0, 3.6.2.2] */
static double normal_range(const tinygltf::Accessor &accessor) {
    static const double of_type[] = { 127, 255, 32767, 65535, 0, 4294967295.0, 0 }; /* from BYTE to FLOAT */
    return accessor.normalized ? of_type[accessor.componentType - TINYGLTF_COMPONENT_TYPE_BYTE] : 0;
}

void gltf_normalize(const tinygltf::Accessor &accessor, std::vector<float> &values) {
    double range = normal_range(accessor);
    if (range == 0) return;
    for (float &value : values) value = float(std::fmax(value / range, -1.0));
}

static const unsigned char *view_bytes(const gltf_asset &asset, int view, size_t offset) {
    const tinygltf::BufferView &range = asset.model.bufferViews[size_t(view)];
    return asset.buffers[size_t(range.buffer)].data() + range.byteOffset + offset;
}

/* What one substitution or one plain run of elements is. */
struct run {
    const unsigned char *data; /* null: zeros */
    size_t stride;
    int type, components;
    double range;
};

static run run_of(const gltf_asset &asset, const tinygltf::Accessor &accessor, int components) {
    run out = { nullptr, gltf_element_size(accessor), accessor.componentType, components, normal_range(accessor) };
    if (accessor.bufferView < 0) return out;
    size_t stride = asset.model.bufferViews[size_t(accessor.bufferView)].byteStride;
    out.data = view_bytes(asset, accessor.bufferView, accessor.byteOffset);
    if (stride) out.stride = stride;
    return out;
}

static void decode_element(const run &from, size_t i, float *to) {
    size_t size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(from.type)));
    for (int k = 0; k < from.components; k++) {
        double value = component_value(from.data + i * from.stride + size_t(k) * size, from.type);
        to[k] = float(from.range > 0 ? std::fmax(value / from.range, -1.0) : value);
    }
}

/* All elements; floats, which most files hold, without a look at each component. */
static void decode_elements(const run &from, size_t count, float *to) {
    size_t width = size_t(from.components);
    if (from.type != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        for (size_t i = 0; i < count; i++) decode_element(from, i, to + i * width);
    } else if (from.stride == width * sizeof *to) {
        std::memcpy(to, from.data, count * from.stride);
    } else {
        for (size_t i = 0; i < count; i++) std::memcpy(to + i * width, from.data + i * from.stride, width * sizeof *to);
    }
}

static void substitute_sparse(const gltf_asset &asset, const tinygltf::Accessor &accessor, run from,
                              std::vector<float> &out, const std::string &where) {
    const auto &sparse = accessor.sparse;
    const unsigned char *indices = view_bytes(asset, sparse.indices.bufferView, size_t(sparse.indices.byteOffset));
    size_t size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType)));
    from.data = view_bytes(asset, sparse.values.bufferView, size_t(sparse.values.byteOffset));
    from.stride = gltf_element_size(accessor);
    for (size_t i = 0; i < size_t(sparse.count); i++) {
        double index = component_value(indices + i * size, sparse.indices.componentType);
        if (index >= double(accessor.count))
            gltf_fail(HEMI_ERROR_DATA, "%s: sparse index %.0f of %zu elements", where.c_str(), index, accessor.count);
        decode_element(from, i, &out[size_t(index) * size_t(from.components)]);
    }
}

static void settle_values(std::vector<float> &values, gltf_broken rule, const std::string &where) {
    for (float &value : values) {
        if (rule == gltf_keep_broken) return;
        if (std::isfinite(value)) continue;
        if (rule == gltf_refuse_broken)
            gltf_fail(HEMI_ERROR_DATA, "%s holds a number that is not finite", where.c_str());
        value = 0;
    }
}

static void check_zeros(const tinygltf::Accessor &accessor, const std::string &where) {
    if (accessor.bufferView < 0 && accessor.count > zero_count_max)
        gltf_fail(HEMI_ERROR_LIMIT, "%s has %zu elements without a bufferView; at most %zu are read", where.c_str(),
                  accessor.count, zero_count_max);
}

std::vector<float> gltf_read_floats(const gltf_asset &asset, int index, int components, gltf_broken rule,
                                    const std::string &where) {
    const tinygltf::Accessor &accessor = asset.model.accessors[size_t(index)];
    std::string at = gltf_text("%s (accessors[%d])", where.c_str(), index);
    int present = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
    bool vector = accessor.type == TINYGLTF_TYPE_VEC2 || accessor.type == TINYGLTF_TYPE_VEC3 ||
                  accessor.type == TINYGLTF_TYPE_VEC4 || accessor.type == TINYGLTF_TYPE_SCALAR;
    if (!vector || (present != components && present != components + 1))
        gltf_fail(HEMI_ERROR_DATA, "%s has the wrong type; it needs %d components", at.c_str(), components);
    check_zeros(accessor, at);
    std::vector<float> out(accessor.count * size_t(components), 0.0f);
    run from = run_of(asset, accessor, components);
    if (from.data) decode_elements(from, accessor.count, out.data());
    if (accessor.sparse.isSparse) substitute_sparse(asset, accessor, from, out, at);
    settle_values(out, rule, at);
    return out;
}

std::vector<uint32_t> gltf_read_indices(const gltf_asset &asset, int index, const std::string &where) {
    const tinygltf::Accessor &accessor = asset.model.accessors[size_t(index)];
    int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_SCALAR ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) ||
        accessor.sparse.isSparse)
        gltf_fail(HEMI_ERROR_DATA, "%s (accessors[%d]) is not a plain accessor of unsigned scalars", where.c_str(),
                  index);
    check_zeros(accessor, where);
    std::vector<uint32_t> out(accessor.count, 0);
    run from = run_of(asset, accessor, 1);
    for (size_t i = 0; from.data && i < out.size(); i++)
        out[i] = uint32_t(component_value(from.data + i * from.stride, type));
    return out;
}

std::vector<float> gltf_read_matrices(const gltf_asset &asset, int index, const std::string &where) {
    const tinygltf::Accessor &accessor = asset.model.accessors[size_t(index)];
    if (accessor.type != TINYGLTF_TYPE_MAT4 || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT ||
        accessor.sparse.isSparse)
        gltf_fail(HEMI_ERROR_DATA, "%s (accessors[%d]) is not a plain accessor of MAT4 of floats", where.c_str(),
                  index);
    check_zeros(accessor, where);
    std::vector<float> out(accessor.count * 16, 0.0f);
    run from = run_of(asset, accessor, 16);
    if (!from.data) return out;
    decode_elements(from, accessor.count, out.data());
    settle_values(out, gltf_zero_broken, where);
    return out;
}
