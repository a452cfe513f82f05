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
    const gltf_json_input *input = nullptr;
    std::vector<unsigned char> chunk; /* the binary chunk of a .glb */
    std::string failure;              /* of a buffer, with its place */
    hemi_result code = HEMI_ERROR_FILE;
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

static std::string first_line(const std::string &text) {
    std::string line = text.substr(0, text.find('\n'));
    for (char &c : line)
        if (static_cast<unsigned char>(c) < ' ') c = '?';
    return line;
}

static int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* %41 is A; a % that no two digits follow is itself. [RFC 3986, 2.1] */
static std::string percent_decoded(const std::string &uri) {
    std::string out;
    for (size_t i = 0; i < uri.size(); i++) {
        int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        out += low >= 0 ? char(16 * high + low) : uri[i];
        if (low >= 0) i += 2;
    }
    return out;
}

/* The file a uri means, beside the asset; some exporters forget to encode. Empty: there is none. */
static std::string path_of(const file_reader &reader, const char *uri) {
    uint64_t size;
    for (const std::string &name : { percent_decoded(uri), std::string(uri) }) {
        std::string path = reader.directory + "/" + name;
        if (name.find('\0') == std::string::npos && is_regular(path, &size)) return path;
    }
    return "";
}

/* Which buffer or image the text for tinygltf calls so; NULL: none. */
static const gltf_json_file *find_file(const file_reader &reader, const std::string &path, bool *is_buffer,
                                       int *index) {
    std::string name = path.substr(path.find_last_of('/') + 1);
    for (bool buffer : { true, false }) {
        const std::string start = buffer ? GLTF_BUFFER_NAME : GLTF_IMAGE_NAME;
        if (name.compare(0, start.size(), start) != 0) continue;
        *is_buffer = buffer;
        *index = std::atoi(name.c_str() + start.size());
        if (*index < (buffer ? reader.input->buffer_count : reader.input->image_count))
            return buffer ? &reader.input->buffers[*index] : &reader.input->images[*index];
    }
    return nullptr;
}

static bool file_exists(const std::string &path, void *user) {
    const file_reader &reader = *static_cast<file_reader *>(user);
    bool is_buffer;
    int index;
    const gltf_json_file *file = find_file(reader, path, &is_buffer, &index);
    return file && (is_buffer || !path_of(reader, file->uri).empty());
}

/* Keeps the first failure of a buffer; an image that cannot be read is only noted later. */
static bool refuse(file_reader &reader, bool is_buffer, hemi_result code, const std::string &text) {
    if (is_buffer && reader.failure.empty()) {
        reader.failure = text;
        reader.code = code;
    }
    return false;
}

static bool read_file(std::vector<unsigned char> *out, std::string *, const std::string &name, void *user) {
    file_reader &reader = *static_cast<file_reader *>(user);
    bool is_buffer = false;
    int index = 0;
    uint64_t size;
    const gltf_json_file *file = find_file(reader, name, &is_buffer, &index);
    if (!file) return false;
    if (!file->uri) {
        *out = std::move(reader.chunk);
    } else {
        std::string path = path_of(reader, file->uri);
        if (path.empty() || !is_regular(path, &size))
            return refuse(reader, is_buffer, HEMI_ERROR_FILE,
                          gltf_text("buffers[%d].uri: the external file \"%.120s\" is missing; put it beside the asset",
                                    index, first_line(percent_decoded(file->uri)).c_str()));
        if (size > reader.budget)
            return refuse(reader, is_buffer, HEMI_ERROR_LIMIT,
                          gltf_text("buffers[%d]: all files of the asset together exceed 2 GiB", index));
        if (!read_bytes(path, size, *out))
            return refuse(reader, is_buffer, HEMI_ERROR_FILE,
                          gltf_text("buffers[%d].uri: the file cannot be read", index));
        reader.budget -= size;
    }
    if (is_buffer && out->size() < file->length)
        return refuse(
            reader, true, HEMI_ERROR_DATA,
            gltf_text("buffers[%d].byteLength is %zu, but there are only %zu bytes", index, file->length, out->size()));
    if (is_buffer) out->resize(file->length);
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

static void parse_model(gltf_asset &asset, file_reader &reader) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(keep_image, &asset.images);
    parser.SetFsCallbacks({ file_exists, same_path, read_file, write_nothing, &reader });
    std::string error, warning;
    const char *text = reader.input->text;
    size_t length = std::strlen(text);
    if (length > UINT32_MAX) gltf_fail(HEMI_ERROR_LIMIT, "the JSON exceeds 4 GiB");
    if (parser.LoadASCIIFromString(&asset.model, &error, &warning, text, unsigned(length), reader.directory)) return;
    if (!reader.failure.empty()) gltf_fail(reader.code, "%s", reader.failure.c_str());
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

/* By their first bytes; what is not known keeps the type the asset gave. */
std::string gltf_media_type(const unsigned char *bytes, size_t length, const std::string &given) {
    auto begins = [bytes, length](const char *magic, size_t size, size_t at) {
        return length >= at + size && std::memcmp(bytes + at, magic, size) == 0;
    };
    if (begins("\x89PNG", 4, 0)) return "image/png";
    if (begins("\xFF\xD8\xFF", 3, 0)) return "image/jpeg";
    if (begins("RIFF", 4, 0) && begins("WEBP", 4, 8)) return "image/webp";
    if (begins("\xABKTX 20\xBB", 8, 0)) return "image/ktx2";
    if (begins("DDS ", 4, 0)) return "image/vnd-ms.dds";
    if (begins("ftypavif", 8, 4)) return "image/avif";
    return given.empty() ? "application/octet-stream" : given;
}

/* An image that says it is of another type than it is passes through all the same, with a word about it. */
static void note_media_types(gltf_asset &asset) {
    for (size_t i = 0; i < asset.model.images.size(); i++) {
        const tinygltf::Image &image = asset.model.images[i];
        if (image.mimeType.empty() || image.bufferView < 0 ||
            size_t(image.bufferView) >= asset.model.bufferViews.size())
            continue;
        const tinygltf::BufferView &view = asset.model.bufferViews[size_t(image.bufferView)];
        if (view.buffer < 0 || size_t(view.buffer) >= asset.buffers.size()) continue;
        const std::vector<unsigned char> &buffer = asset.buffers[size_t(view.buffer)];
        if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) continue;
        std::string found = gltf_media_type(buffer.data() + view.byteOffset, view.byteLength, image.mimeType);
        if (found != image.mimeType)
            asset.skipped.push_back(gltf_text("images[%zu].mimeType is \"%s\", but its bytes are %s; both are kept", i,
                                              first_line(image.mimeType).substr(0, 80).c_str(), found.c_str()));
    }
}

/* Images keep the uri that the asset gave them. */
static void restore_images(gltf_asset &asset, const gltf_json_input &input) {
    asset.images.resize(asset.model.images.size());
    for (size_t i = 0; i < asset.images.size() && i < size_t(input.image_count); i++) {
        if (!input.images[i].uri) continue;
        asset.model.images[i].uri = input.images[i].uri;
        if (asset.images[i].empty())
            asset.skipped.push_back(gltf_text("image %zu: its file \"%.120s\" is missing; the reference is kept", i,
                                              first_line(input.images[i].uri).c_str()));
    }
}

static void read_asset_file(const char *path, file_reader &reader, std::vector<unsigned char> &bytes) {
    std::string name = path;
    size_t slash = name.find_last_of('/');
    reader.directory = slash == std::string::npos ? "." : name.substr(0, slash + 1);
    uint64_t size;
    if (!is_regular(name, &size)) gltf_fail(HEMI_ERROR_FILE, "cannot be opened; check the path");
    if (size > reader.budget) gltf_fail(HEMI_ERROR_LIMIT, "the file is larger than 2 GiB");
    if (!read_bytes(name, size, bytes)) gltf_fail(HEMI_ERROR_FILE, "cannot be read; check its permissions");
    reader.budget -= size;
}

using input_owner = std::unique_ptr<gltf_json_input, decltype(&gltf_json_input_free)>;

void gltf_load(gltf_asset &asset, const char *path) {
    file_reader reader;
    std::vector<unsigned char> bytes;
    read_asset_file(path, reader, bytes);
    char message[GLTF_MESSAGE_SIZE] = "";
    gltf_chunks chunks;
    gltf_json_input input = {};
    hemi_result result = gltf_container_split(bytes.data(), bytes.size(), &chunks, message);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    result = gltf_json_before_read(reinterpret_cast<const char *>(chunks.json), chunks.json_size, chunks.binary, &input,
                                   message);
    input_owner owner(&input, gltf_json_input_free);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    asset.json.assign(reinterpret_cast<const char *>(chunks.json), chunks.json_size);
    if (chunks.bin) { /* moved to the front and cut: a copy would cost as much as parsing */
        bytes.erase(bytes.begin(), bytes.begin() + (chunks.bin - bytes.data()));
        bytes.resize(chunks.bin_size);
        reader.chunk = std::move(bytes);
    }
    reader.input = &input;
    parse_model(asset, reader);
    take_buffers(asset);
    restore_draco_indices(asset.model);
    gltf_decode_meshopt(asset);
    restore_images(asset, input);
    note_media_types(asset);
}
