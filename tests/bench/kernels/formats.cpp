/* SPDX-License-Identifier: MIT
 * How many megabytes a second go through Draco and through the glTF reader and writer? Megabytes are of positions,
 * colours and indices as plain arrays. Beside Draco: quantising the same values in a loop, without packing them; beside
 * reading: tinygltf and nothing else, and copying the file's bytes.
 */
#include "kernels.h"

#include "draco_codec.h"
#include "gltf_asset.h"

#include <tiny_gltf.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

namespace {

const uint32_t SIDE = 300;

struct terrain {
    std::vector<float> positions, colors;
    std::vector<uint32_t> indices;
    double megabytes = 0;
};

terrain make_terrain() {
    terrain t;
    for (uint32_t y = 0; y <= SIDE; y++)
        for (uint32_t x = 0; x <= SIDE; x++) {
            float u = float(x) / SIDE, v = float(y) / SIDE, wave = std::sin(20 * u) * std::cos(20 * v);
            t.positions.insert(t.positions.end(), { u, 0.1f * wave, v });
            t.colors.insert(t.colors.end(), { 0.5f + 0.4f * wave, 0.5f, u });
        }
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            uint32_t a = y * (SIDE + 1) + x, b = a + SIDE + 1;
            t.indices.insert(t.indices.end(), { a, b, a + 1, a + 1, b, b + 1 });
        }
    t.megabytes = 1e-6 * double(4 * (t.positions.size() + t.colors.size() + t.indices.size()));
    return t;
}

void print_line(const char *name, double megabytes, double seconds, double simplest) {
    std::printf("  %-42s %9.1f", name, megabytes / seconds);
    if (simplest > 0)
        std::printf("  %7.3f x\n", simplest / seconds);
    else
        std::printf("\n");
}

/* ---- Draco -------------------------------------------------------------------------------------------------------*/

struct packing {
    const terrain *shape;
    int level;
    draco_codec_encoded encoded;
    std::vector<uint16_t> plain;
    bool ok;
};

void encode(void *user) {
    packing *p = static_cast<packing *>(user);
    draco_codec_attribute attributes[2] = {};
    attributes[0].semantic = DRACO_CODEC_POSITION;
    attributes[0].bits = 14;
    attributes[0].values = p->shape->positions.data();
    attributes[1].semantic = DRACO_CODEC_COLOR;
    attributes[1].bits = 12;
    attributes[1].values = p->shape->colors.data();
    attributes[0].components = attributes[1].components = 3;
    draco_codec_encode_desc desc = {};
    desc.attributes = attributes;
    desc.attribute_count = 2;
    desc.vertex_count = uint32_t(p->shape->positions.size() / 3);
    desc.indices = p->shape->indices.data();
    desc.triangle_count = uint32_t(p->shape->indices.size() / 3);
    desc.level = p->level;
    draco_codec_encoded_free(&p->encoded);
    p->ok = draco_codec_encode(&desc, &p->encoded) == HEMI_OK;
}

void decode(void *user) {
    packing *p = static_cast<packing *>(user);
    draco_codec_mesh *mesh = nullptr;
    uint32_t limit = 4 * (SIDE + 1) * (SIDE + 1);
    p->ok = draco_codec_decode(p->encoded.bytes, p->encoded.byte_count, limit, limit, &mesh) == HEMI_OK &&
            draco_codec_mesh_face_count(mesh) == 2 * SIDE * SIDE;
    draco_codec_mesh_destroy(mesh);
}

void quantise(packing *p, const std::vector<float> &values, int bits) {
    float low[3] = { 1e30f, 1e30f, 1e30f }, high[3] = { -1e30f, -1e30f, -1e30f };
    for (size_t i = 0; i < values.size(); i++) {
        low[i % 3] = std::fmin(low[i % 3], values[i]);
        high[i % 3] = std::fmax(high[i % 3], values[i]);
    }
    for (size_t i = 0; i < values.size(); i++) {
        float range = high[i % 3] - low[i % 3], scale = float((1 << bits) - 1);
        p->plain.push_back(uint16_t(range > 0 ? (values[i] - low[i % 3]) / range * scale + 0.5f : 0));
    }
}

void quantise_all(void *user) {
    packing *p = static_cast<packing *>(user);
    p->plain.clear();
    quantise(p, p->shape->positions, 14);
    quantise(p, p->shape->colors, 12);
    for (uint32_t index : p->shape->indices) {
        p->plain.push_back(uint16_t(index & 0xffff));
        p->plain.push_back(uint16_t(index >> 16));
    }
}

bool print_draco(const terrain &shape) {
    packing p = { &shape, 0, {}, {}, false };
    double simplest = kernel_best(quantise_all, &p, 3), plain_bytes = 2.0 * double(p.plain.size());
    bool ok = true;
    print_line("simplest: quantised in a loop", shape.megabytes, simplest, 0);
    for (int level : { 0, 7, 10 }) {
        char name[64];
        p.level = level;
        double seconds = kernel_best(encode, &p, 3);
        ok = ok && p.ok && !p.encoded.sequential;
        std::snprintf(name, sizeof name, "Draco encodes, level %d, %.1f times smaller", level,
                      plain_bytes / double(p.encoded.byte_count));
        print_line(name, shape.megabytes, seconds, simplest);
        seconds = kernel_best(decode, &p, 3);
        ok = ok && p.ok;
        std::snprintf(name, sizeof name, "Draco decodes, level %d", level);
        print_line(name, shape.megabytes, seconds, simplest);
    }
    draco_codec_encoded_free(&p.encoded);
    return ok;
}

/* ---- glTF --------------------------------------------------------------------------------------------------------*/

struct file_work {
    std::string path;
    std::vector<char> bytes;
    gltf_asset *asset;
    bool ok;
};

void add(tinygltf::Model &model, const void *data, size_t size, int component, int type, size_t count) {
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
}

bool write_file(const terrain &t, const std::string &path) {
    tinygltf::Model model;
    tinygltf::TinyGLTF writer;
    tinygltf::Primitive primitive;
    model.asset.version = "2.0";
    model.buffers.emplace_back();
    add(model, t.positions.data(), 4 * t.positions.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
        t.positions.size() / 3);
    model.accessors[0].minValues = { 0, -0.1, 0 };
    model.accessors[0].maxValues = { 1, 0.1, 1 };
    add(model, t.colors.data(), 4 * t.colors.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
        t.colors.size() / 3);
    add(model, t.indices.data(), 4 * t.indices.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
        t.indices.size());
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = 0;
    primitive.attributes["COLOR_0"] = 1;
    primitive.indices = 2;
    model.meshes.emplace_back();
    model.meshes[0].primitives.push_back(primitive);
    model.nodes.emplace_back();
    model.nodes[0].mesh = 0;
    model.scenes.emplace_back();
    model.scenes[0].nodes.push_back(0);
    model.defaultScene = 0;
    return writer.WriteGltfSceneToFile(&model, path, true, true, false, true);
}

void copy_file(void *user) {
    file_work *f = static_cast<file_work *>(user);
    std::ifstream in(f->path, std::ios::binary | std::ios::ate);
    f->bytes.resize(size_t(in.tellg()));
    in.seekg(0);
    f->ok = bool(in.read(f->bytes.data(), std::streamsize(f->bytes.size())));
}

void parse_alone(void *user) {
    file_work *f = static_cast<file_work *>(user);
    tinygltf::TinyGLTF reader;
    tinygltf::Model model;
    std::string error, warning;
    f->ok = reader.LoadBinaryFromFile(&model, &error, &warning, f->path);
}

void read_asset(void *user) {
    file_work *f = static_cast<file_work *>(user);
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset_destroy(f->asset);
    f->asset = nullptr;
    f->ok = gltf_asset_read(f->path.c_str(), &f->asset, message) == HEMI_OK && gltf_asset_mesh_count(f->asset) == 1;
}

void write_asset(void *user) {
    file_work *f = static_cast<file_work *>(user);
    char message[GLTF_MESSAGE_SIZE];
    gltf_output written = {};
    gltf_baked_mesh mesh = {};
    gltf_write_desc desc = {};
    desc.binary = true;
    desc.meshes = &mesh;
    desc.mesh_count = 1;
    f->ok = gltf_asset_write(f->asset, &desc, &written, message) == HEMI_OK;
    gltf_output_free(&written);
}

bool print_gltf(const terrain &shape) {
    char folder[] = "/tmp/hemibake-kernels-XXXXXX";
    if (!mkdtemp(folder)) return false;
    file_work f = { std::string(folder) + "/terrain.glb", {}, nullptr, false };
    bool ok = write_file(shape, f.path);
    double simplest = kernel_best(copy_file, &f, 3);
    ok = ok && f.ok;
    print_line("simplest: the file's bytes, read", shape.megabytes, simplest, 0);
    print_line("tinygltf alone parses", shape.megabytes, kernel_best(parse_alone, &f, 3), simplest);
    ok = ok && f.ok;
    print_line("converters/gltf reads", shape.megabytes, kernel_best(read_asset, &f, 3), simplest);
    ok = ok && f.ok;
    if (ok)
        print_line("converters/gltf writes, nothing baked", shape.megabytes, kernel_best(write_asset, &f, 3), simplest);
    gltf_asset_destroy(f.asset);
    unlink(f.path.c_str());
    rmdir(folder);
    return ok && f.ok;
}

} // namespace

extern "C" bool kernel_formats(void) {
    try {
        terrain shape = make_terrain();
        std::printf("formats: megabytes a second of %.1f MB of arrays, and times the simplest loop\n", shape.megabytes);
        return print_draco(shape) && print_gltf(shape);
    } catch (const std::exception &e) {
        std::printf("  formats failed: %s\n", e.what());
        return false;
    }
}
