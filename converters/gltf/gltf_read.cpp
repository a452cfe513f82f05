/* SPDX-License-Identifier: MIT
 * How does a file become a tinygltf model, without decoding an image or trusting a length?
 */
#include "gltf_model.h"

#include "gltf_container.h"
#include "gltf_json.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sys/stat.h>

static std::string format_text(const char *format, va_list arguments) {
    char text[GLTF_MESSAGE_SIZE];
    vsnprintf(text, sizeof text, format, arguments);
    return text;
}

void gltf_fail(hemi_result code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    std::string text = format_text(format, arguments);
    va_end(arguments);
    throw gltf_failure{ code, text };
}

std::string gltf_text(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    std::string text = format_text(format, arguments);
    va_end(arguments);
    return text;
}

/* ---- files ---------------------------------------------------------------------------------------------------- */

struct file_reader {
    uint64_t budget = gltf_bytes_max;
    std::string directory; /* external files are looked for nowhere else */
    std::string missing;   /* the last file that was asked for and is not there */
};

static bool is_regular(const std::string &path, uint64_t *size) {
    struct stat status;
    if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
    *size = uint64_t(status.st_size);
    return true;
}

static bool read_bytes(const std::string &path, uint64_t size, std::vector<unsigned char> &out) {
    FILE *file = fopen(path.c_str(), "rb");
    if (!file) return false;
    out.resize(size_t(size));
    bool whole = fread(out.data(), 1, out.size(), file) == out.size();
    fclose(file);
    return whole;
}

static bool file_exists(const std::string &path, void *user) {
    file_reader &reader = *static_cast<file_reader *>(user);
    uint64_t size;
    if (path.compare(0, reader.directory.size(), reader.directory) == 0 && is_regular(path, &size)) return true;
    if (reader.missing.empty()) reader.missing = path.substr(path.find_last_of('/') + 1);
    return false;
}

static bool read_file(std::vector<unsigned char> *out, std::string *error, const std::string &path, void *user) {
    file_reader &reader = *static_cast<file_reader *>(user);
    uint64_t size;
    if (!is_regular(path, &size) || size > reader.budget || !read_bytes(path, size, *out)) {
        if (error) *error = "cannot be read";
        return false;
    }
    reader.budget -= size;
    return true;
}

static bool write_nothing(std::string *, const std::string &, const std::vector<unsigned char> &, void *) {
    return false;
}

static std::string same_path(const std::string &path, void *) {
    return path;
}

/* Keeps the encoded bytes of images that came by uri; those in buffer views stay where they are. */
static bool keep_image(tinygltf::Image *image, const int index, std::string *, std::string *, int, int,
                       const unsigned char *bytes, int size, void *user) {
    auto &images = *static_cast<std::vector<std::vector<unsigned char>> *>(user);
    if (image->bufferView >= 0) return true;
    if (images.size() <= size_t(index)) images.resize(size_t(index) + 1);
    images[size_t(index)].assign(bytes, bytes + size);
    return true;
}

/* ---- the model ------------------------------------------------------------------------------------------------ */

static std::string first_line(const std::string &text) {
    std::string line = text.substr(0, text.find('\n'));
    for (char &c : line)
        if (static_cast<unsigned char>(c) < ' ') c = '?';
    return line;
}

static void parse_model(gltf_asset &asset, const std::string &json, const gltf_chunks &chunks, file_reader &reader) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(keep_image, &asset.images);
    parser.SetFsCallbacks({ file_exists, same_path, read_file, write_nothing, &reader });
    std::string error, warning;
    bool parsed;
    if (chunks.binary) {
        uint8_t *glb = nullptr;
        size_t size = 0;
        hemi_result result = gltf_container_join(json.data(), json.size(), chunks.bin, chunks.bin_size, &glb, &size);
        if (result != HEMI_OK) gltf_fail(result, "%s", "the GLB does not fit into memory");
        std::unique_ptr<uint8_t, decltype(&free)> owner(glb, free);
        parsed = parser.LoadBinaryFromMemory(&asset.model, &error, &warning, glb, unsigned(size), reader.directory);
    } else {
        parsed = parser.LoadASCIIFromString(&asset.model, &error, &warning, json.data(), unsigned(json.size()),
                                            reader.directory);
    }
    if (parsed) return;
    if (error.find("File not found") != std::string::npos)
        gltf_fail(HEMI_ERROR_FILE, "buffers: the external file \"%s\" is missing; put it beside the asset",
                  first_line(reader.missing).c_str());
    if (error.find("File read error") != std::string::npos)
        gltf_fail(HEMI_ERROR_FILE, "buffers: an external file cannot be read, or all files exceed 2 GiB");
    gltf_fail(HEMI_ERROR_DATA, "%s", first_line(error.empty() ? "the file is not valid glTF" : error).c_str());
}

/* The bytes leave the model, so that a copy of it is cheap. */
static void take_buffers(gltf_asset &asset) {
    for (tinygltf::Buffer &buffer : asset.model.buffers) {
        asset.buffers.push_back(std::move(buffer.data));
        buffer.data.clear();
        buffer.uri.clear();
    }
}

/* Undoes what gltf_json_before_read did to the indices of Draco primitives. */
static void restore_draco_indices(tinygltf::Model &model) {
    for (tinygltf::Mesh &mesh : model.meshes)
        for (tinygltf::Primitive &primitive : mesh.primitives) {
            auto found = primitive.extensions.find("KHR_draco_mesh_compression");
            if (found == primitive.extensions.end() || !found->second.IsObject()) continue;
            auto &members = found->second.Get<tinygltf::Value::Object>();
            auto indices = members.find(GLTF_DRACO_INDICES);
            if (indices == members.end()) continue;
            primitive.indices = indices->second.IsNumber() ? indices->second.GetNumberAsInt() : -1;
            members.erase(indices);
        }
}

static void note_missing_images(gltf_asset &asset) {
    asset.images.resize(asset.model.images.size());
    for (size_t i = 0; i < asset.images.size(); i++)
        if (asset.model.images[i].bufferView < 0 && asset.images[i].empty())
            asset.skipped.push_back(gltf_text("image %zu: its file \"%s\" is missing; the reference is kept", i,
                                              first_line(asset.model.images[i].uri).c_str()));
}

static std::vector<unsigned char> read_asset_file(const char *path, file_reader &reader) {
    std::string name = path;
    size_t slash = name.find_last_of('/');
    reader.directory = slash == std::string::npos ? "." : name.substr(0, slash + 1);
    uint64_t size;
    std::vector<unsigned char> bytes;
    if (!is_regular(name, &size)) gltf_fail(HEMI_ERROR_FILE, "cannot be opened; check the path");
    if (size > reader.budget) gltf_fail(HEMI_ERROR_LIMIT, "the file is larger than 2 GiB");
    if (!read_bytes(name, size, bytes)) gltf_fail(HEMI_ERROR_FILE, "cannot be read; check its permissions");
    reader.budget -= size;
    return bytes;
}

void gltf_load(gltf_asset &asset, const char *path) {
    file_reader reader;
    std::vector<unsigned char> bytes = read_asset_file(path, reader);
    char message[GLTF_MESSAGE_SIZE] = "";
    gltf_chunks chunks;
    hemi_result result = gltf_container_split(bytes.data(), bytes.size(), &chunks, message);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    char *json = nullptr;
    result = gltf_json_before_read(reinterpret_cast<const char *>(chunks.json), chunks.json_size, chunks.binary, &json,
                                   message);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    std::unique_ptr<char, decltype(&free)> owner(json, free);
    asset.json.assign(reinterpret_cast<const char *>(chunks.json), chunks.json_size);
    parse_model(asset, json, chunks, reader);
    take_buffers(asset);
    restore_draco_indices(asset.model);
    gltf_decode_meshopt(asset);
    note_missing_images(asset);
}
