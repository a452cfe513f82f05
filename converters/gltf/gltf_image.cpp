/* SPDX-License-Identifier: MIT
 * What do the pixels of an image become? Pyramids of linear rgb, a few rows at a time: a picture as floats is four
 * times as large as it is as bytes.
 */
#include "gltf_texture.h"

#include "image_decode.h"

#include <cmath>
#include <cstring>
#include <memory>

static double srgb_to_linear(double v) { /* IEC 61966-2-1 */
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

static std::pair<const unsigned char *, size_t> image_bytes(const gltf_asset &asset, int image) {
    const tinygltf::Image &source = asset.model.images[size_t(image)];
    if (source.bufferView < 0) return { asset.images[size_t(image)].data(), asset.images[size_t(image)].size() };
    const tinygltf::BufferView &view = asset.model.bufferViews[size_t(source.bufferView)];
    return { asset.buffers[size_t(view.buffer)].data() + view.byteOffset, view.byteLength };
}

/* A picture on its way to a mips of one kind. */
struct texels {
    const gltf_asset &asset;
    const image_pixels &pixels;
    int image, kind;
    bool raw; /* its numbers are linear Rec.709, as factors are */
    double curve[256];
};

/* Texels of less alpha than the mask needs are black; the rest is white if only coverage counts. */
static void mask_texels(const texels &from, uint32_t row, std::vector<float> &rgb) {
    const uint8_t *rgba = from.pixels.rgba + 4 * size_t(row) * from.pixels.width;
    int least = from.kind / texel_kinds;
    bool whiten = from.kind % texel_kinds == texel_coverage;
    for (size_t i = 0; i < rgb.size() / 3; i++)
        for (size_t c = 0; c < 3; c++) {
            if (whiten) rgb[3 * i + c] = 1;
            if (rgba[4 * i + 3] < least) rgb[3 * i + c] = 0;
        }
}

/* What a picture of linear numbers says of itself, since glTF's colours are sRGB: extras.hemibake_color_space "raw". */
static bool is_raw(const gltf_asset &asset, int image) {
    const cJSON *source = cJSON_GetArrayItem(gltf_member(asset.document.get(), "images"), image);
    const char *space = cJSON_GetStringValue(gltf_member(gltf_member(source, "extras"), "hemibake_color_space"));
    return space && std::strcmp(space, "raw") == 0;
}

/* One row as linear numbers, colours through the host's conversion. */
static void read_row(const texels &from, uint32_t row, std::vector<float> &rgb) {
    const gltf_shadings &all = *from.asset.shadings;
    const uint8_t *rgba = from.pixels.rgba + 4 * size_t(row) * from.pixels.width;
    const char *file = from.asset.model.images[size_t(from.image)].uri.c_str();
    for (size_t i = 0; i < rgb.size() / 3; i++)
        for (size_t c = 0; c < 3; c++) rgb[3 * i + c] = float(from.curve[rgba[4 * i + c]]);
    if (from.kind == texel_alpha)
        for (size_t i = 0; i < rgb.size(); i++) rgb[i] = float(rgba[i / 3 * 4 + 3] / 255.0);
    else if (from.kind == texel_metal)
        for (size_t i = 0; i < rgb.size(); i += 3) rgb[i] = rgb[i + 2] * rgb[i + 1] * rgb[i + 1];
    else if (from.kind != texel_data && all.convert &&
             all.convert(all.convert_user, !from.raw, *file ? file : nullptr, rgb.data(), rgb.size() / 3) != HEMI_OK)
        gltf_fail(HEMI_ERROR_BACKEND, "images[%d]: its colours cannot be converted", from.image);
    for (size_t i = 0; from.kind == texel_premultiplied_color && i < rgb.size(); i++)
        rgb[i] *= float(rgba[i / 3 * 4 + 3] / 255.0);
    mask_texels(from, row, rgb);
}

/* Its name or uri in quotes after a space; "" without. */
static std::string name_of(const gltf_asset &asset, int image) {
    const tinygltf::Image &source = asset.model.images[size_t(image)];
    const std::string &name = source.name.empty() && source.uri.compare(0, 5, "data:") != 0 ? source.uri : source.name;
    return name.empty() ? "" : " \"" + gltf_printable(name) + "\"";
}

/* What all images may have together, in the largest that one may have. */
static const uint64_t images_at_most = 8;

/* Of a pixel while its picture is decoded: four bands of a byte, and three floats of every fourth. */
static const uint64_t bytes_of_a_pixel = 8;

/* How many pixels a picture may have: as it is asked for, or fewer where memory leaves room for fewer. */
static uint64_t pixels_at_most(const gltf_asset &asset) {
    uint64_t left = asset.memory_left ? asset.memory_left(asset.memory_user) / bytes_of_a_pixel : UINT64_MAX;
    return std::min(asset.image_pixels, left);
}

const char gltf_unread_picture[] = "of its materials only the factors count, as no metal";

/* Its file has been named when it was not found; now there is what comes of that. */
static void note_missing(gltf_asset &asset, int image, const char *instead) {
    const std::string start = gltf_text("image %d: ", image);
    for (std::string &note : asset.skipped)
        if (note.compare(0, start.size(), start) == 0) note += std::string("; ") + instead;
}

static bool decode(gltf_asset &asset, int image, const char *instead, image_pixels *out) {
    gltf_shadings &all = *asset.shadings;
    auto bytes = image_bytes(asset, image);
    bool again = all.readable.count(image) > 0;
    if (again && !all.readable[image]) return false;
    all.readable[image] = false;
    if (bytes.second == 0) {
        note_missing(asset, image, instead);
        return false;
    }
    char message[IMAGE_MESSAGE_SIZE];
    const uint64_t most = pixels_at_most(asset);
    hemi_result result = image_decode(bytes.first, bytes.second, most, out, message);
    if (result == HEMI_ERROR_LIMIT && most < asset.image_pixels)
        gltf_fail(
            result,
            "images[%d]: its pixels take more than the %.0f MiB that --memory leaves; allow more, or make it smaller",
            image, double(most * bytes_of_a_pixel) / (1 << 20));
    if (result == HEMI_ERROR_UNSUPPORTED || result == HEMI_ERROR_DATA) {
        std::string name = name_of(asset, image);
        asset.skipped.push_back(gltf_text("images[%d]%s cannot be read, %s: %s; write it as PNG, JPEG or WebP", image,
                                          name.c_str(), message, instead));
        return false;
    }
    if (result != HEMI_OK) gltf_fail(result, "images[%d]: %s; write it again or leave it out", image, message);
    all.readable[image] = true;
    if (!again) all.texels += uint64_t(out->width) * out->height;
    if (all.texels > images_at_most * asset.image_pixels) {
        image_pixels_free(out);
        gltf_fail(HEMI_ERROR_LIMIT,
                  "images[%d]: all images together have more than %llu pixels, 8 times what --max-pixels allows each",
                  image, static_cast<unsigned long long>(images_at_most * asset.image_pixels));
    }
    return true;
}

bool gltf_decode_image(gltf_asset &asset, int image, image_pixels *out) {
    return decode(asset, image, gltf_unread_picture, out);
}

bool gltf_image_is_readable(gltf_asset &asset, int image) {
    auto known = asset.shadings->readable.find(image);
    if (known != asset.shadings->readable.end()) return known->second;
    image_pixels pixels;
    if (!decode(asset, image, "its texture's other picture counts", &pixels)) return false;
    image_pixels_free(&pixels);
    return true;
}

uint64_t gltf_asset_picture_bytes(const gltf_asset *asset) {
    uint64_t sum = 0;
    if (!asset->shadings) return 0;
    for (const auto &one : asset->shadings->mip_chains)
        for (size_t i = 0; one.second && i < one.second->levels.size(); i++)
            sum += one.second->levels[i].rgb.size() * sizeof(float);
    return sum;
}

const gltf_mip_chain *gltf_find_mip_chain(gltf_asset &asset, int image, int kind) {
    gltf_shadings &all = *asset.shadings;
    auto key = std::make_pair(image, kind);
    auto found = all.mip_chains.find(key);
    if (found != all.mip_chains.end()) return found->second.get();
    auto &mips = all.mip_chains[key];
    image_pixels pixels;
    if (!gltf_decode_image(asset, image, &pixels)) return nullptr;
    std::unique_ptr<uint8_t, decltype(&free)> owner(pixels.rgba, free);
    texels from = { asset, pixels, image, kind, is_raw(asset, image), {} };
    for (int i = 0; i < 256; i++)
        from.curve[i] = kind >= texel_color && !all.convert && !from.raw ? srgb_to_linear(i / 255.0) : i / 255.0;
    auto rows = [&](uint32_t row, std::vector<float> &rgb) { read_row(from, row, rgb); };
    mips = std::make_unique<gltf_mip_chain>(gltf_make_mip_chain(rows, pixels.width, pixels.height));
    return mips.get();
}
