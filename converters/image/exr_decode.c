/* SPDX-License-Identifier: MIT */
#include "exr_decode.h"

#include "exr_channels.h"
#include "openexr_shim.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE_MAX = 65536, HEADER_MAX = 65536 };

/* Bytes that a chunk unpacks to, and all chunks together, at most: a tile of 8192 x 8192 with four floats a pixel, and
 * sixteen times as much. A small file can ask for more. */
static const uint64_t CHUNK_MAX = UINT64_C(1) << 30, CHANNELS_MAX = UINT64_C(1) << 34;

typedef struct memory_file {
    const uint8_t *bytes;
    size_t size;
} memory_file;

typedef struct reading {
    const memory_file *from;
    exr_context_t file;
    exr_channels set;
    const exr_attr_chlist_t *channels;
    exr_attr_box2i_t data, display;
    int32_t left, top; /* of the chunk */
    exr_result_t (*decompress)(exr_decode_pipeline_t *);
    hdr_image image;
    uint64_t replaced; /* values that were negative or not finite */
    char *message;
} reading;

bool exr_is_it(const uint8_t *bytes, size_t size) {
    return size >= 4 && memcmp(bytes, "\x76\x2f\x31\x01", 4) == 0;
}

/* ---- what OpenEXRCore calls -------------------------------------------------------------------------------------- */

static int64_t read_bytes(exr_const_context_t file, void *user, void *to, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t fail) {
    (void)file, (void)fail;
    const memory_file *from = user;
    if (offset > from->size) return -1;
    if (size > from->size - offset) size = from->size - offset;
    if (size > 0) memcpy(to, from->bytes + offset, (size_t)size);
    return (int64_t)size;
}

static int64_t say_size(exr_const_context_t file, void *user) {
    (void)file;
    return (int64_t)((const memory_file *)user)->size;
}

/* Its own would print; and its texts quote the file. */
static void keep_silent(exr_const_context_t file, exr_result_t code, const char *text) {
    (void)file, (void)code, (void)text;
}

/* What malformed chunks leave as it was is 0, and not what another picture left there. */
static void *allocate_zeros(size_t size) {
    return calloc(1, size);
}

static hemi_result fail_by(exr_result_t code, const char *what, char *message) {
    if (code == EXR_ERR_OUT_OF_MEMORY) return image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
    snprintf(message, IMAGE_MESSAGE_SIZE, "%s (OpenEXR: %s)", what, exr_get_default_error_message(code));
    return HEMI_ERROR_DATA;
}

/* ---- windows ----------------------------------------------------------------------------------------------------- */

static bool is_small(const exr_attr_box2i_t *window) {
    int64_t width = (int64_t)window->max.x - window->min.x + 1, height = (int64_t)window->max.y - window->min.y + 1;
    return width <= SIDE_MAX && height <= SIDE_MAX && (uint64_t)(width * height) <= HDR_PIXELS_MAX;
}

static uint64_t bytes_of(const exr_attr_box2i_t *window, const exr_attr_chlist_t *channels) {
    uint64_t pixel = 0;
    for (int i = 0; i < channels->num_channels; i++) pixel += channels->entries[i].pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    return pixel * (uint64_t)(window->max.x - window->min.x + 1) * (uint64_t)(window->max.y - window->min.y + 1);
}

static hemi_result prepare(reading *r) {
    exr_envmap_t kind = EXR_ENVMAP_LATLONG;
    const exr_attr_box2i_t *data = &r->data, *display = &r->display;
    exr_result_t code = exr_get_channels(r->file, r->set.part, &r->channels);
    if (code == EXR_ERR_SUCCESS) code = exr_get_data_window(r->file, r->set.part, &r->data);
    if (code == EXR_ERR_SUCCESS) code = exr_get_display_window(r->file, r->set.part, &r->display);
    if (code != EXR_ERR_SUCCESS) return fail_by(code, "its header is malformed", r->message);
    if (exr_attr_get_envmap(r->file, r->set.part, "envmap", &kind) == EXR_ERR_SUCCESS && kind == EXR_ENVMAP_CUBE)
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is a cube map; write it by longitude and latitude", r->message);
    if (!is_small(data) || !is_small(display))
        return image_fail(HEMI_ERROR_LIMIT, "it has more than 2^27 pixels, or a side above 65536", r->message);
    if (bytes_of(data, r->channels) > CHANNELS_MAX)
        return image_fail(HEMI_ERROR_LIMIT, "its channels have more than 2^34 bytes", r->message);
    if (data->min.x > display->max.x || data->max.x < display->min.x || data->min.y > display->max.y ||
        data->max.y < display->min.y)
        return image_fail(HEMI_ERROR_DATA, "its data window is outside of its display window", r->message);
    r->image.width = (uint32_t)(display->max.x - display->min.x + 1);
    r->image.height = (uint32_t)(display->max.y - display->min.y + 1);
    r->image.rgb = calloc(3 * (size_t)r->image.width * r->image.height, sizeof *r->image.rgb);
    return r->image.rgb ? HEMI_OK : image_fail(HEMI_ERROR_MEMORY, "out of memory", r->message);
}

/* ---- pixels ------------------------------------------------------------------------------------------------------ */

/* The exponent of a half is 112 less than that of a float, and its bits, moved, are a float's: exact, small ones too.
 */
static float float_of_half(uint16_t half) {
    uint32_t bits = (uint32_t)(half & 0x7fff) << 13;
    float value;
    memcpy(&value, &bits, sizeof value);
    value = (half & 0x7c00) == 0x7c00 ? INFINITY : value * 0x1p112f;
    return half & 0x8000 ? -value : value;
}

static float value_at(const uint8_t *from, uint16_t type) {
    uint16_t half;
    uint32_t whole;
    float value;
    if (type == EXR_PIXEL_HALF) return memcpy(&half, from, sizeof half), float_of_half(half);
    if (type == EXR_PIXEL_UINT) return memcpy(&whole, from, sizeof whole), (float)whole;
    return memcpy(&value, from, sizeof value), value;
}

/* A row of a channel into what of it the display window has. */
static void copy_row(reading *r, const uint8_t *from, const exr_coding_channel_info_t *channel, int32_t y, int to) {
    if (y < r->display.min.y || y > r->display.max.y) return;
    float *row = r->image.rgb + 3 * (size_t)r->image.width * (size_t)(y - r->display.min.y) + to;
    for (int32_t i = 0; i < channel->width; i++) {
        int32_t x = r->left + i;
        if (x < r->display.min.x || x > r->display.max.x) continue;
        float value = value_at(from + (size_t)i * (size_t)channel->bytes_per_element, channel->data_type);
        bool is_light = isfinite(value) && value >= 0.0f;
        r->replaced += !is_light;
        row[3 * (size_t)(x - r->display.min.x)] = is_light ? value : 0.0f;
    }
}

/* A chunk, unpacked, is row by row, in it channel by channel. OpenEXRCore's own way from there writes, up to 3.1 at
 * least, to channels that nobody asked for, where there are three or four and all are half. */
static exr_result_t take_rows(exr_decode_pipeline_t *chunk) {
    reading *r = chunk->decoding_user_data;
    const uint8_t *bytes = chunk->unpacked_buffer;
    uint64_t at = 0;
    for (int32_t row = 0; row < chunk->chunk.height; row++)
        for (int c = 0; c < chunk->channel_count; c++) {
            const exr_coding_channel_info_t *channel = &chunk->channels[c];
            if (channel->y_samples > 1 && (r->top + row) % channel->y_samples != 0) continue;
            uint64_t size = (uint64_t)channel->width * (uint64_t)channel->bytes_per_element;
            if (size > chunk->chunk.unpacked_size - at) return EXR_ERR_CORRUPT_CHUNK;
            for (int k = 0; k < 3; k++)
                if (r->set.channel[k] == c) copy_row(r, bytes + at, channel, r->top + row, k);
            at += size;
        }
    return EXR_ERR_SUCCESS;
}

static exr_result_t start_chunks(reading *r, exr_decode_pipeline_t *pipeline, const exr_chunk_info_t *chunk) {
    exr_result_t code = exr_decoding_initialize(r->file, r->set.part, chunk, pipeline);
    if (code == EXR_ERR_SUCCESS) code = exr_decoding_choose_default_routines(r->file, r->set.part, pipeline);
    r->decompress = pipeline->decompress_fn;
    pipeline->decoding_user_data = r;
    pipeline->unpack_and_convert_fn = take_rows;
    return code;
}

static exr_result_t read_chunk(reading *r, exr_decode_pipeline_t *pipeline, const exr_chunk_info_t *chunk) {
    if (chunk->unpacked_size > CHUNK_MAX) return EXR_ERR_ARGUMENT_OUT_OF_RANGE;
    if (chunk->packed_size == 0 ||
        (chunk->compression == EXR_COMPRESSION_NONE && chunk->packed_size != chunk->unpacked_size))
        return EXR_ERR_CORRUPT_CHUNK;
    exr_result_t code = pipeline->context ? exr_decoding_update(r->file, r->set.part, chunk, pipeline)
                                          : start_chunks(r, pipeline, chunk);
    /* What would not get smaller is stored as it is, which 3.1 does not know of B44. */
    pipeline->decompress_fn = chunk->packed_size == chunk->unpacked_size ? NULL : r->decompress;
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(r->file, r->set.part, pipeline) : code;
}

static exr_result_t read_scanlines(reading *r, exr_decode_pipeline_t *pipeline) {
    int32_t lines = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(r->file, r->set.part, &lines);
    for (int64_t y = r->data.min.y; code == EXR_ERR_SUCCESS && y <= r->data.max.y; y += lines) {
        exr_chunk_info_t chunk = { 0 };
        code = lines > 0 ? exr_read_scanline_chunk_info(r->file, r->set.part, (int)y, &chunk) : EXR_ERR_INVALID_ATTR;
        r->left = r->data.min.x, r->top = (int32_t)y;
        if (code == EXR_ERR_SUCCESS) code = read_chunk(r, pipeline, &chunk);
    }
    return code;
}

static exr_result_t read_tiles(reading *r, exr_decode_pipeline_t *pipeline) {
    int32_t width = 0, height = 0;
    exr_result_t code = exr_get_tile_sizes(r->file, r->set.part, 0, 0, &width, &height);
    if (code == EXR_ERR_SUCCESS && (width <= 0 || height <= 0)) code = EXR_ERR_INVALID_ATTR;
    for (int64_t y = r->data.min.y; code == EXR_ERR_SUCCESS && y <= r->data.max.y; y += height)
        for (int64_t x = r->data.min.x; code == EXR_ERR_SUCCESS && x <= r->data.max.x; x += width) {
            exr_chunk_info_t chunk = { 0 };
            r->left = (int32_t)x, r->top = (int32_t)y;
            code = exr_read_tile_chunk_info(r->file, r->set.part, (int)((x - r->data.min.x) / width),
                                            (int)((y - r->data.min.y) / height), 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) code = read_chunk(r, pipeline, &chunk);
        }
    return code;
}

static hemi_result refuse_compression(exr_compression_t by, char *message) {
    static const char *const names[] = { "none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB" };
    const char *name = (unsigned)by < sizeof names / sizeof *names ? names[by] : "what is newer than it";
    snprintf(message, IMAGE_MESSAGE_SIZE, "this OpenEXR does not decode its compression, %s; write it as ZIP or PIZ",
             name);
    return HEMI_ERROR_UNSUPPORTED;
}

/* OpenEXRCore takes for ZIP what it does not know, and then for malformed. */
static bool is_compressed_by_newer(const memory_file *file) {
    static const char attribute[] = "compression\0compression\0\1\0\0"; /* its name, type and length */
    for (size_t i = 0; i + sizeof attribute < file->size && i < HEADER_MAX; i++)
        if (memcmp(file->bytes + i, attribute, sizeof attribute) == 0)
            return file->bytes[i + sizeof attribute] >= EXR_COMPRESSION_LAST_TYPE;
    return false;
}

static void take_row(void *user, int32_t y, const float *values) {
    reading *r = user;
    const exr_coding_channel_info_t each = { .width = r->data.max.x - r->data.min.x + 1,
                                             .bytes_per_element = 3 * sizeof *values,
                                             .data_type = EXR_PIXEL_FLOAT };
    r->left = r->data.min.x;
    for (int k = 0; k < 3; k++) copy_row(r, (const uint8_t *)(values + k), &each, y, k);
}

static hemi_result fail_too_wide(char *message) {
    return image_fail(HEMI_ERROR_LIMIT, "a chunk of it has more than 2^30 bytes", message);
}

/* What OpenEXRCore does not decompress before 3.4. */
static hemi_result read_by_shim(reading *r, bool is_tiled) {
    const char *names[3];
    exr_attr_box2i_t chunk = r->data;
    int32_t lines = 0, width = chunk.max.x - chunk.min.x + 1, height = 0;
    exr_result_t code = is_tiled ? exr_get_tile_sizes(r->file, r->set.part, 0, 0, &width, &height)
                                 : exr_get_scanlines_per_chunk(r->file, r->set.part, &lines);
    if (code != EXR_ERR_SUCCESS) return fail_by(code, "its header is malformed", r->message);
    if (width <= 0 || height < 0 || lines < 0)
        return fail_by(EXR_ERR_INVALID_ATTR, "its header is malformed", r->message);
    chunk.min.x = chunk.min.y = 0, chunk.max.x = width - 1, chunk.max.y = (is_tiled ? height : lines) - 1;
    if (!is_small(&chunk) || bytes_of(&chunk, r->channels) > CHUNK_MAX) return fail_too_wide(r->message);
    for (int k = 0; k < 3; k++) names[k] = r->channels->entries[r->set.channel[k]].name.str;
    const memory_file *from = r->from;
    openexr_status status = openexr_read_part(from->bytes, from->size, r->set.part, names, take_row, r);
    if (status == OPENEXR_NO_MEMORY) return image_fail(HEMI_ERROR_MEMORY, "out of memory", r->message);
    return status == OPENEXR_READ ? HEMI_OK
                                  : image_fail(HEMI_ERROR_DATA, "its pixels are malformed or cut short", r->message);
}

static hemi_result read_pixels(reading *r) {
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_compression_t by = EXR_COMPRESSION_NONE;
    exr_get_storage(r->file, r->set.part, &storage);
    exr_get_compression(r->file, r->set.part, &by);
    if (by == EXR_COMPRESSION_DWAA || by == EXR_COMPRESSION_DWAB) return read_by_shim(r, storage == EXR_STORAGE_TILED);
    exr_result_t code = storage == EXR_STORAGE_TILED ? read_tiles(r, &pipeline) : read_scanlines(r, &pipeline);
    exr_decoding_destroy(r->file, &pipeline);
    if (code == EXR_ERR_SUCCESS) return HEMI_OK;
    if (code == EXR_ERR_FEATURE_NOT_IMPLEMENTED) return refuse_compression(by, r->message);
    if (code == EXR_ERR_ARGUMENT_OUT_OF_RANGE) return fail_too_wide(r->message);
    return fail_by(code, "its pixels are malformed or cut short", r->message);
}

/* ---- what is said of it ------------------------------------------------------------------------------------------ */

static void add_note(char *note, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add_note(char *note, const char *format, ...) {
    size_t length = strlen(note);
    va_list arguments;
    if (length > 0) length += (size_t)snprintf(note + length, EXR_NOTE_SIZE - length, "; ");
    va_start(arguments, format);
    if (length < EXR_NOTE_SIZE) vsnprintf(note + length, EXR_NOTE_SIZE - length, format, arguments);
    va_end(arguments);
}

/* Rec. 709's, which a file means that says nothing. */
static bool has_other_primaries(const reading *r) {
    static const float rec709[8] = { 0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f };
    exr_attr_chromaticities_t own;
    float difference = 0.0f;
    if (exr_attr_get_chromaticities(r->file, r->set.part, "chromaticities", &own) != EXR_ERR_SUCCESS) return false;
    const float found[8] = { own.red_x,  own.red_y,  own.green_x, own.green_y,
                             own.blue_x, own.blue_y, own.white_x, own.white_y };
    for (int i = 0; i < 8; i++) difference = fmaxf(difference, fabsf(found[i] - rec709[i]));
    return difference > 2e-3f;
}

static void describe(const reading *r, char *note) {
    const exr_channels *set = &r->set;
    const char *layer = r->channels->entries[set->channel[0]].name.str, *part = NULL;
    int length = set->layer_length > 60 ? 60 : (int)set->layer_length - 1;
    if (exr_get_name(r->file, set->part, &part) != EXR_ERR_SUCCESS) part = NULL;
    if (set->choices > 1) add_note(note, "it has %d sets of colours", set->choices);
    if (set->choices > 1 && part) add_note(note, "part \"%.60s\" is read", part);
    if (set->layer_length > 0) add_note(note, "layer \"%.*s\" is read", length, layer);
    if (set->choices > 1 && !part && set->layer_length == 0) add_note(note, "the one without a name is read");
    if (r->replaced > 0)
        add_note(note, "%llu of its values are negative or not finite, and taken as 0",
                 (unsigned long long)r->replaced);
    if (has_other_primaries(r))
        add_note(note, "its primaries are not those of Rec. 709, and its numbers are not converted");
}

hemi_result exr_decode(const uint8_t *bytes, size_t size, hdr_image *out, char note[EXR_NOTE_SIZE],
                       char message[IMAGE_MESSAGE_SIZE]) {
    memory_file from = { bytes, size };
    reading r = { .from = &from, .message = message };
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = keep_silent, how.alloc_fn = allocate_zeros, how.free_fn = free;
    how.user_data = &from, how.read_fn = read_bytes, how.size_fn = say_size;
    how.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    *out = (hdr_image){ 0 };
    note[0] = message[0] = 0;
    if (!exr_is_it(bytes, size)) return image_fail(HEMI_ERROR_DATA, "it is no OpenEXR picture", message);
    exr_result_t code = exr_start_read(&r.file, "picture", &how);
    if (code != EXR_ERR_SUCCESS) return fail_by(code, "its header is malformed or cut short", message);
    hemi_result result =
        is_compressed_by_newer(&from) ? refuse_compression(EXR_COMPRESSION_LAST_TYPE, message) : HEMI_OK;
    if (result == HEMI_OK) result = exr_channels_choose(r.file, &r.set, message);
    if (result == HEMI_OK) result = prepare(&r);
    if (result == HEMI_OK) result = read_pixels(&r);
    if (result == HEMI_OK) describe(&r, note);
    exr_finish(&r.file);
    if (result == HEMI_OK)
        *out = r.image;
    else
        free(r.image.rgb);
    return result;
}
