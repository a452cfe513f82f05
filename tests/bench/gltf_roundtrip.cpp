/* SPDX-License-Identifier: MIT
 * What does it cost to lose nothing? Seconds to read and write a .glb of a million triangles through converters/gltf,
 * nothing baked, against those that tinygltf alone takes to parse and write the same file.
 *
 *     gltf_roundtrip [TRIANGLES [RUNS]]      default: 1000000 5; exits with 1 if the ratio of the medians is above 2
 */
#include "gltf_asset.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

static int add_accessor(tinygltf::Model &model, const void *data, size_t size, int component, int type, size_t count) {
    std::vector<unsigned char> &bytes = model.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = size;
    bytes.resize(bytes.size() + size);
    std::memcpy(bytes.data() + view.byteOffset, data, size);
    model.bufferViews.push_back(view);
    tinygltf::Accessor accessor;
    accessor.bufferView = int(model.bufferViews.size()) - 1;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = count;
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

/* The values of corners, one after the other. */
static void spread(const std::vector<uint32_t> &indices, size_t width, std::vector<float> &values) {
    std::vector<float> out;
    out.reserve(width * indices.size());
    for (uint32_t i : indices)
        out.insert(out.end(), values.begin() + long(width * i), values.begin() + long(width * (i + 1)));
    values = std::move(out);
}

/* A wavy square of side x side quads; its triangles with indices, or each with corners of its own. */
static tinygltf::Model make_terrain(uint32_t side, bool indexed) {
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
    for (uint32_t y = 0; y <= side; y++)
        for (uint32_t x = 0; x <= side; x++) {
            float u = float(x) / float(side), v = float(y) / float(side);
            positions.insert(positions.end(), { u, 0.1f * std::sin(20 * u) * std::cos(20 * v), v });
            normals.insert(normals.end(), { 0, 1, 0 });
            uvs.insert(uvs.end(), { u, v });
        }
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            uint32_t a = y * (side + 1) + x, b = a + side + 1;
            indices.insert(indices.end(), { a, b, a + 1, a + 1, b, b + 1 });
        }
    tinygltf::Model model;
    if (!indexed) spread(indices, 3, positions), spread(indices, 3, normals), spread(indices, 2, uvs);
    size_t vertices = positions.size() / 3;
    model.asset.version = "2.0";
    model.buffers.emplace_back();
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = add_accessor(model, positions.data(), positions.size() * 4,
                                                    TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, vertices);
    model.accessors[0].minValues = { 0, -0.1, 0 };
    model.accessors[0].maxValues = { 1, 0.1, 1 };
    primitive.attributes["NORMAL"] = add_accessor(model, normals.data(), normals.size() * 4,
                                                  TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, vertices);
    primitive.attributes["TEXCOORD_0"] =
        add_accessor(model, uvs.data(), uvs.size() * 4, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, vertices);
    if (indexed)
        primitive.indices = add_accessor(model, indices.data(), indices.size() * 4,
                                         TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, indices.size());
    model.meshes.emplace_back();
    model.meshes[0].primitives.push_back(primitive);
    model.nodes.emplace_back();
    model.nodes[0].mesh = 0;
    model.scenes.emplace_back();
    model.scenes[0].nodes.push_back(0);
    model.defaultScene = 0;
    return model;
}

static bool through_tinygltf(const std::string &in, const std::string &out) {
    tinygltf::TinyGLTF gltf;
    tinygltf::Model model;
    std::string error, warning;
    return gltf.LoadBinaryFromFile(&model, &error, &warning, in) &&
           gltf.WriteGltfSceneToFile(&model, out, true, true, false, true);
}

static bool through_converter(const std::string &in, const std::string &out) {
    char message[GLTF_MESSAGE_SIZE] = "";
    gltf_asset *asset = nullptr;
    gltf_output written = {};
    bool ok = gltf_asset_read(in.c_str(), &asset, message) == HEMI_OK;
    if (ok) {
        std::vector<gltf_baked_mesh> meshes(gltf_asset_mesh_count(asset));
        gltf_write_desc desc = {};
        desc.binary = true;
        desc.meshes = meshes.data();
        desc.mesh_count = uint32_t(meshes.size());
        ok = gltf_asset_write(asset, &desc, &written, message) == HEMI_OK;
    }
    if (ok) {
        std::ofstream file(out, std::ios::binary);
        file.write(reinterpret_cast<const char *>(written.main), std::streamsize(written.main_size));
        ok = bool(file);
    }
    if (!ok) fprintf(stderr, "gltf_roundtrip: %s\n", message);
    gltf_output_free(&written);
    gltf_asset_destroy(asset);
    return ok;
}

static double seconds_of(const std::function<bool()> &work) {
    auto begin = std::chrono::steady_clock::now();
    if (!work()) exit(2);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

static double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/* Seconds of ours over those of tinygltf, for a file with indices or without. */
static double compare(double triangles, int runs, bool indexed, const std::string &folder) {
    uint32_t side = uint32_t(std::ceil(std::sqrt(triangles / 2)));
    std::string in = folder + "/in.glb", out = folder + "/out.glb";
    tinygltf::Model model = make_terrain(side, indexed);
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToFile(&model, in, true, true, false, true)) exit(2);
    std::vector<double> theirs, ours;
    for (int i = 0; i < runs; i++) { /* by turns, so that a busy machine disturbs both */
        theirs.push_back(seconds_of([&] { return through_tinygltf(in, out); }));
        ours.push_back(seconds_of([&] { return through_converter(in, out); }));
    }
    remove(in.c_str());
    remove(out.c_str());
    double ratio = median(ours) / median(theirs);
    printf("%u triangles %s indices: tinygltf %.3f s, converters/gltf %.3f s, ratio %.2f (median of %d runs)\n",
           2 * side * side, indexed ? "with" : "without", median(theirs), median(ours), ratio, runs);
    return ratio;
}

int main(int argc, char **argv) {
    double triangles = argc > 1 ? atof(argv[1]) : 1e6;
    int runs = argc > 2 ? atoi(argv[2]) : 5;
    char folder[] = "/tmp/hemibake-roundtrip-XXXXXX";
    if (!mkdtemp(folder) || runs < 1) return 2;
    double indexed = compare(triangles, runs, true, folder), soup = compare(triangles, runs, false, folder);
    remove(folder);
    return indexed > 2 || soup > 2;
}
