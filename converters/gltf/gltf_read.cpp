/* SPDX-License-Identifier: MIT
 * How does a file become a tinygltf model, without decoding an image or trusting a length?
 */
#include "gltf_model.h"

#include "file_read.h"
#include "gltf_container.h"
#include "image_decode.h"

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

std::string gltf_printable(const std::string &text, size_t most) {
    std::string out = text.substr(0, most);
    for (char &c : out)
        if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
    return out;
}

/* ---- files ---------------------------------------------------------------------------------------------------- */

struct file_reader {
    uint64_t budget = gltf_bytes_max;
    std::string directory;            /* external files are looked for nowhere else */
    const char *root = nullptr;       /* nor outside of this folder */
    std::vector<unsigned char> chunk; /* the binary chunk of a .glb */
};

static bool is_there(const std::string &path) {
    struct stat status;
    return stat(path.c_str(), &status) == 0 && (S_ISREG(status.st_mode) || S_ISFIFO(status.st_mode));
}

static uint8_t *make_room(void *user, size_t size) {
    auto &bytes = *static_cast<std::vector<unsigned char> *>(user);
    try {
        bytes.resize(size ? size : 1);
    } catch (const std::exception &) {
        return nullptr;
    }
    return bytes.data();
}

static std::vector<unsigned char> read_bytes(file_reader &reader, const std::string &path, const std::string &where) {
    std::vector<unsigned char> bytes;
    char message[FILE_MESSAGE_SIZE];
    size_t size = 0;
    hemi_result result = file_read(path.c_str(), reader.root, reader.budget, make_room, &bytes, &size, message);
    if (result == HEMI_ERROR_LIMIT)
        gltf_fail(result,
                  where.empty() ? "%sthe file is larger than 2 GiB" : "%sall files of the asset together exceed 2 GiB",
                  where.c_str());
    if (result != HEMI_OK) gltf_fail(result, "%s%s", where.c_str(), message);
    bytes.resize(size);
    reader.budget -= size;
    return bytes;
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
static std::string path_of(const file_reader &reader, const std::string &uri) {
    for (const std::string &name : { percent_decoded(uri), uri }) {
        std::string path = reader.directory + "/" + name;
        if (!uri.empty() && name.find('\0') == std::string::npos && is_there(path)) return path;
    }
    return "";
}

/* The file or the data that a uri means; where names the uri in messages. */
static std::vector<unsigned char> read_uri(file_reader &reader, const std::string &uri, const std::string &where) {
    std::vector<unsigned char> bytes;
    if (gltf_is_base64(uri.c_str())) {
        std::string type, known = "data:application/octet-stream;base64," + uri.substr(uri.find(',') + 1);
        if (!tinygltf::DecodeDataURI(&bytes, type, known, 0, false))
            gltf_fail(HEMI_ERROR_DATA, "%s is not base64 data", where.c_str());
        return bytes;
    }
    std::string path = path_of(reader, uri);
    if (path.empty())
        gltf_fail(HEMI_ERROR_FILE, "%s: the external file \"%s\" is missing; put it beside the asset", where.c_str(),
                  gltf_printable(percent_decoded(uri)).c_str());
    return read_bytes(reader, path, where + ": \"" + gltf_printable(percent_decoded(uri)) + "\": ");
}

/* ---- the model ------------------------------------------------------------------------------------------------ */

static void parse_model(gltf_asset &asset, const std::string &text) {
    tinygltf::TinyGLTF parser;
    std::string error, warning;
    if (text.size() > UINT32_MAX) gltf_fail(HEMI_ERROR_LIMIT, "the JSON exceeds 4 GiB");
    if (parser.LoadASCIIFromString(&asset.model, &error, &warning, text.c_str(), unsigned(text.size()), "")) return;
    if (error.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    if (error.empty()) error = "the file is not valid glTF";
    gltf_fail(HEMI_ERROR_DATA, "%s", gltf_printable(error.substr(0, error.find('\n')), GLTF_MESSAGE_SIZE).c_str());
}

static void read_buffers(gltf_asset &asset, file_reader &reader, const std::vector<gltf_source> &sources) {
    for (size_t i = 0; i < sources.size(); i++) {
        const gltf_source &source = sources[i];
        std::vector<unsigned char> bytes;
        if (!source.uri.empty())
            bytes = read_uri(reader, source.uri, gltf_text("buffers[%zu].uri", i));
        else if (!source.fallback)
            bytes = std::move(reader.chunk);
        if (!source.fallback && bytes.size() < source.length)
            gltf_fail(HEMI_ERROR_DATA, "buffers[%zu].byteLength is %zu, but there are only %zu bytes", i, source.length,
                      bytes.size());
        bytes.resize(source.fallback ? 1 : source.length);
        asset.buffers.push_back(std::move(bytes));
    }
}

/* What came from a file goes into the output only if it is a picture: a name may lead to anything that can be read. */
static std::vector<unsigned char> read_image(file_reader &reader, const std::string &uri, const std::string &where) {
    std::vector<unsigned char> bytes = read_uri(reader, uri, where);
    if (!gltf_is_base64(uri.c_str()) && !bytes.empty() && gltf_media_type(bytes.data(), bytes.size(), "none") == "none")
        gltf_fail(HEMI_ERROR_DATA, "its file \"%s\" is no picture", gltf_printable(uri).c_str());
    return bytes;
}

/* An image whose file cannot be read is only noted. */
static void read_images(gltf_asset &asset, file_reader &reader, const std::vector<gltf_source> &sources) {
    for (size_t i = 0; i < sources.size(); i++) {
        const gltf_source &source = sources[i];
        const bool data = gltf_is_base64(source.uri.c_str());
        std::string reason = gltf_text("its file \"%s\" is missing", gltf_printable(source.uri).c_str());
        tinygltf::Image image;
        image.bufferView = source.view;
        image.mimeType = source.media_type;
        image.uri = data ? "" : source.uri;
        asset.images.emplace_back();
        asset.model.images.push_back(image);
        try {
            if (!source.uri.empty()) asset.images[i] = read_image(reader, source.uri, gltf_text("images[%zu].uri", i));
        } catch (const gltf_failure &failure) {
            if (data) throw;
            if (failure.text.find("missing") == std::string::npos) reason = failure.text;
        }
        if (source.uri.empty() && source.view < 0 && !data)
            gltf_note(asset, gltf_text("image %zu", i), "it has neither a uri nor a bufferView, and counts as missing");
        if (!source.uri.empty() && asset.images[i].empty())
            asset.skipped.push_back(gltf_text("image %zu: %s; the reference is kept", i, reason.c_str()));
    }
}

/* tinygltf refuses strides that glTF does not allow, but others read (gltf_document.cpp). */
static void restore_strides(gltf_asset &asset) {
    size_t i = 0;
    for (const cJSON *view : gltf_elements(gltf_member(asset.document.get(), "bufferViews"))) {
        int stride = gltf_index(view, "byteStride");
        tinygltf::BufferView &out = asset.model.bufferViews[i++];
        if (stride <= 0 || out.byteStride == size_t(stride)) continue;
        out.byteStride = size_t(stride);
        gltf_note(asset, gltf_text("bufferView %zu", i - 1), "its byteStride is not a multiple of 4 up to 252");
    }
}

/* Of EXT_lights_ies; one that cannot be read is named where it would shine. */
static void read_profiles(gltf_asset &asset, file_reader &reader) {
    const cJSON *profiles = gltf_extension(asset.document.get(), "EXT_lights_ies");
    for (const cJSON *light : gltf_elements(gltf_member(profiles, "lights"))) {
        const cJSON *uri = gltf_member(light, "uri");
        asset.profile_files.emplace_back();
        try {
            if (cJSON_IsString(uri)) asset.profile_files.back() = read_uri(reader, uri->valuestring, "EXT_lights_ies");
        } catch (const gltf_failure &failure) {
            if (failure.code == HEMI_ERROR_LIMIT || failure.code == HEMI_ERROR_MEMORY) throw;
        }
    }
}

/* The text for tinygltf hid them (gltf_document.cpp). */
static void restore_draco_indices(gltf_asset &asset) {
    std::vector<cJSON *> meshes = gltf_elements(gltf_member(asset.document.get(), "meshes"));
    for (size_t m = 0; m < asset.model.meshes.size(); m++) {
        std::vector<tinygltf::Primitive> &primitives = asset.model.meshes[m].primitives;
        const cJSON *source = gltf_member(meshes[m], "primitives")->child;
        for (size_t p = 0; source && p < primitives.size(); p++, source = source->next)
            if (primitives[p].indices < 0) primitives[p].indices = gltf_index(source, "indices");
    }
}

/* By their first bytes; what is not known keeps the type the asset gave. */
std::string gltf_media_type(const unsigned char *bytes, size_t length, const std::string &given) {
    auto begins = [bytes, length](const char *magic, size_t size, size_t at) {
        return length >= at + size && std::memcmp(bytes + at, magic, size) == 0;
    };
    if (begins("\x89PNG\r\n\x1A\n", 8, 0)) return "image/png";
    if (begins("\xFF\xD8\xFF", 3, 0)) return "image/jpeg";
    if (begins("RIFF", 4, 0) && begins("WEBP", 4, 8)) return "image/webp";
    if (begins("\xABKTX 20\xBB", 8, 0)) return "image/ktx2";
    if (begins("DDS ", 4, 0)) return "image/vnd-ms.dds";
    if (begins("ftypavif", 8, 4)) return "image/avif";
    if (begins("\xABKTX 11\xBB", 8, 0)) return "image/ktx";
    if (begins("GIF87a", 6, 0) || begins("GIF89a", 6, 0)) return "image/gif";
    return given.empty() ? "application/octet-stream" : given;
}

/* An image that says it is of another type than it is passes through all the same, with a word about it. */
static void note_media_types(gltf_asset &asset) {
    for (size_t i = 0; i < asset.model.images.size(); i++) {
        const tinygltf::Image &image = asset.model.images[i];
        if (image.mimeType.empty() || image.bufferView < 0) continue;
        const tinygltf::BufferView &view = asset.model.bufferViews[size_t(image.bufferView)];
        const unsigned char *bytes = asset.buffers[size_t(view.buffer)].data() + view.byteOffset;
        std::string found = gltf_media_type(bytes, view.byteLength, image.mimeType);
        if (found != image.mimeType)
            asset.skipped.push_back(gltf_text("images[%zu].mimeType is \"%s\", but its bytes are %s; both are kept", i,
                                              gltf_printable(image.mimeType, 80).c_str(), found.c_str()));
    }
}

static std::vector<unsigned char> read_asset_file(const char *path, const gltf_limits &limits, file_reader &reader) {
    std::string name = path;
    size_t slash = name.find_last_of('/');
    reader.directory = slash == std::string::npos ? "." : name.substr(0, slash + 1);
    reader.root = limits.root;
    return limits.bytes ? std::vector<unsigned char>(limits.bytes, limits.bytes + limits.byte_count)
                        : read_bytes(reader, name, "");
}

void gltf_load(gltf_asset &asset, const char *path, const gltf_limits &limits) {
    file_reader reader;
    std::vector<unsigned char> bytes = read_asset_file(path, limits, reader);
    asset.memory_left = limits.memory_left;
    asset.memory_user = limits.memory_user;
    asset.image_pixels = limits.image_pixels ? limits.image_pixels : IMAGE_PIXELS_DEFAULT;
    char message[GLTF_MESSAGE_SIZE] = "";
    gltf_chunks chunks;
    hemi_result result = gltf_container_split(bytes.data(), bytes.size(), &chunks, message);
    if (result != HEMI_OK) gltf_fail(result, "%s", message);
    const char *text = reinterpret_cast<const char *>(chunks.json);
    asset.document = gltf_parse_document(text, chunks.json_size, chunks.binary);
    gltf_reading reading = gltf_read_document(asset.document.get(), text, chunks.json_size);
    if (chunks.bin) { /* moved to the front: a copy would cost as much as parsing */
        bytes.erase(bytes.begin(), bytes.begin() + (chunks.bin - bytes.data()));
        bytes.resize(chunks.bin_size);
        reader.chunk = std::move(bytes);
    } else {
        std::vector<unsigned char>().swap(bytes);
    }
    read_buffers(asset, reader, reading.buffers);
    parse_model(asset, reading.text);
    restore_draco_indices(asset);
    restore_strides(asset);
    gltf_decode_meshopt(asset);
    read_images(asset, reader, reading.images);
    read_profiles(asset, reader);
    gltf_check(asset);
    note_media_types(asset);
}
