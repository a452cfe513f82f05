/* SPDX-License-Identifier: MIT */
#include "exr_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int64_t write_bytes(exr_const_context_t file, void *user, const void *from, uint64_t size, uint64_t offset,
                           exr_stream_error_func_ptr_t fail) {
    (void)file, (void)fail;
    exr_bytes *to = user;
    if (offset + size > to->size) {
        to->bytes = realloc(to->bytes, (size_t)(offset + size));
        to->size = (size_t)(offset + size);
    }
    memcpy(to->bytes + offset, from, (size_t)size);
    return (int64_t)size;
}

static void must(exr_result_t code) {
    if (code == EXR_ERR_SUCCESS) return;
    fprintf(stderr, "exr_file: %s\n", exr_get_default_error_message(code));
    exit(1);
}

static void write_header(exr_context_t to, const exr_file *f) {
    const exr_attr_v2f_t middle = { .x = 0.0f, .y = 0.0f };
    int part;
    must(exr_add_part(to, "", f->tile ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part));
    must(exr_initialize_required_attr(to, part, &f->display, &f->data, 1.0f, &middle, 1.0f, EXR_LINEORDER_INCREASING_Y,
                                      f->compression));
    for (int i = 0; i < EXR_FILE_CHANNELS && f->channels[i]; i++)
        must(exr_add_channel(to, part, f->channels[i], f->types[i], EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    if (f->tile)
        must(exr_set_tile_descriptor(to, part, (uint32_t)f->tile, (uint32_t)f->tile, EXR_TILE_ONE_LEVEL,
                                     EXR_TILE_ROUND_DOWN));
    if (f->primaries) must(exr_attr_set_chromaticities(to, part, "chromaticities", f->primaries));
    if (f->is_cube) must(exr_attr_set_envmap(to, part, "envmap", EXR_ENVMAP_CUBE));
    must(exr_write_header(to));
}

/* Floats, which OpenEXRCore turns into halves, or whole numbers as they are. */
static void write_chunk(exr_context_t to, const exr_file *f, const exr_chunk_info_t *chunk, int left, int top) {
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    size_t count = (size_t)chunk->width * (size_t)chunk->height;
    float *values = malloc(EXR_FILE_CHANNELS * count * sizeof *values);
    must(exr_encoding_initialize(to, 0, chunk, &pipeline));
    for (int c = 0; c < pipeline.channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline.channels[c];
        bool is_whole = f->types[c] == EXR_PIXEL_UINT;
        for (size_t i = 0; i < count; i++) {
            double value = f->value(c, left + (int)i % chunk->width, top + (int)i / chunk->width);
            uint32_t whole = is_whole ? (uint32_t)value : 0;
            values[(size_t)c * count + i] = (float)value;
            if (is_whole) memcpy(&values[(size_t)c * count + i], &whole, sizeof whole);
        }
        channel->encode_from_ptr = (const uint8_t *)(values + (size_t)c * count);
        channel->user_data_type = is_whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = channel->user_pixel_stride = 4;
        channel->user_line_stride = 4 * chunk->width;
    }
    must(exr_encoding_choose_default_routines(to, 0, &pipeline));
    must(exr_encoding_run(to, 0, &pipeline));
    must(exr_encoding_destroy(to, &pipeline));
    free(values);
}

static void write_tiles(exr_context_t to, const exr_file *f) {
    for (int y = f->data.min.y, row = 0; y <= f->data.max.y; y += f->tile, row++)
        for (int x = f->data.min.x, column = 0; x <= f->data.max.x; x += f->tile, column++) {
            exr_chunk_info_t chunk;
            must(exr_write_tile_chunk_info(to, 0, column, row, 0, 0, &chunk));
            write_chunk(to, f, &chunk, x, y);
        }
}

exr_bytes exr_file_write(const exr_file *f) {
    exr_bytes out = { NULL, 0 };
    exr_context_t to;
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.user_data = &out, how.write_fn = write_bytes;
    must(exr_start_write(&to, "picture", EXR_WRITE_FILE_DIRECTLY, &how));
    write_header(to, f);
    if (f->tile) write_tiles(to, f);
    int32_t lines = 1;
    if (!f->tile) must(exr_get_scanlines_per_chunk(to, 0, &lines));
    for (int y = f->data.min.y; !f->tile && y <= f->data.max.y; y += lines) {
        exr_chunk_info_t chunk;
        must(exr_write_scanline_chunk_info(to, 0, y, &chunk));
        write_chunk(to, f, &chunk, f->data.min.x, y);
    }
    must(exr_finish(&to));
    return out;
}
