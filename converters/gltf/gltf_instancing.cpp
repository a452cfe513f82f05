/* SPDX-License-Identifier: MIT
 * Where does EXT_mesh_gpu_instancing put the copies of a node's mesh? [EXT_mesh_gpu_instancing]
 */
#include "gltf_model.h"

#include <algorithm>
#include <cmath>

/* ---- transforms: column-major, m[4*c+r] ------------------------------------------------------------------------- */

void gltf_multiply(const double a[16], const double b[16], double out[16]) {
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += a[4 * k + r] * b[4 * c + k];
            out[4 * c + r] = sum;
        }
}

void gltf_compose(const double translation[3], const double quaternion[4], const double scale[3], double out[16]) {
    double q[4], length = 0;
    for (size_t i = 0; i < 4; i++) length += quaternion[i] * quaternion[i];
    for (size_t i = 0; i < 4; i++) q[i] = length > 0 ? quaternion[i] / std::sqrt(length) : 0;
    double x = q[0], y = q[1], z = q[2], w = length > 0 ? q[3] : 1;
    const double rotation[3][3] = {
        { 1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y) },
        { 2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x) },
        { 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y) },
    };
    for (size_t c = 0; c < 3; c++) {
        for (size_t r = 0; r < 3; r++) out[4 * c + r] = rotation[c][r] * scale[c];
        out[4 * c + 3] = 0;
        out[12 + c] = translation[c];
    }
    out[15] = 1;
}

/* ---- the extension ----------------------------------------------------------------------------------------------- */

/* One of its attributes; empty if it has none of that name. */
static std::vector<float> read_attribute(const gltf_asset &asset, const tinygltf::Value &attributes, const char *name,
                                         int components, const std::string &where) {
    if (!attributes.Has(name)) return {};
    std::string at = where + ".attributes." + name;
    const tinygltf::Value &index = attributes.Get(name);
    gltf_check_index(index.IsInt() ? index.Get<int>() : -1, asset.model.accessors.size(), "accessors", at);
    const tinygltf::Accessor &accessor = asset.model.accessors[size_t(index.Get<int>())];
    if (tinygltf::GetNumComponentsInType(uint32_t(accessor.type)) != components)
        gltf_fail(HEMI_ERROR_DATA, "%s has the wrong type; it needs %d components", at.c_str(), components);
    return gltf_read_floats(asset, index.Get<int>(), components, gltf_refuse_broken, at);
}

static void check_count(size_t values, size_t components, size_t *count, const std::string &where) {
    if (values == 0) return;
    if (*count != 0 && *count != values / components)
        gltf_fail(HEMI_ERROR_DATA, "%s.attributes have different counts, %zu and %zu", where.c_str(), *count,
                  values / components);
    *count = values / components;
}

std::vector<double> gltf_read_copies(const gltf_asset &asset, int node) {
    const tinygltf::Value &extension = asset.model.nodes[size_t(node)].extensions.at("EXT_mesh_gpu_instancing");
    std::string where = gltf_text("nodes[%d].extensions.EXT_mesh_gpu_instancing", node);
    if (!extension.Has("attributes") || !extension.Get("attributes").IsObject())
        gltf_fail(HEMI_ERROR_DATA, "%s.attributes is missing", where.c_str());
    const tinygltf::Value &attributes = extension.Get("attributes");
    static const struct {
        const char *name;
        int components;
    } parts[3] = { { "TRANSLATION", 3 }, { "ROTATION", 4 }, { "SCALE", 3 } };
    std::vector<float> values[3];
    size_t count = 0;
    for (int p = 0; p < 3; p++) {
        values[p] = read_attribute(asset, attributes, parts[p].name, parts[p].components, where);
        check_count(values[p].size(), size_t(parts[p].components), &count, where);
    }
    std::vector<double> copies(16 * count);
    for (size_t i = 0; i < count; i++) {
        double trs[3][4] = { { 0, 0, 0 }, { 0, 0, 0, 1 }, { 1, 1, 1 } };
        for (int p = 0; p < 3; p++)
            if (!values[p].empty())
                std::copy_n(&values[p][i * size_t(parts[p].components)], parts[p].components, trs[p]);
        gltf_compose(trs[0], trs[1], trs[2], &copies[16 * i]);
    }
    return copies;
}
