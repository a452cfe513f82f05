/* SPDX-License-Identifier: MIT */
#include "exr_channels.h"

#include <string.h>

static size_t layer_length(const exr_attr_string_t *name) {
    for (int32_t i = name->length; i > 0; i--)
        if (name->str[i - 1] == '.') return (size_t)i;
    return 0;
}

/* The channel of a layer that is called so, in capitals or not; -1: there is none. */
static int find_channel(const exr_attr_chlist_t *list, const char *layer, size_t length, const char *name) {
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_string_t *own = &list->entries[i].name;
        if ((size_t)own->length != length + strlen(name) || memcmp(own->str, layer, length) != 0) continue;
        size_t same = 0;
        while (name[same] && (own->str[length + same] & ~32) == name[same]) same++;
        if (!name[same]) return i;
    }
    return -1;
}

static bool is_at_every_pixel(const exr_attr_chlist_t *list, int channel) {
    return channel >= 0 && list->entries[channel].x_sampling == 1 && list->entries[channel].y_sampling == 1;
}

/* Has the layer of a channel R, G and B, or Y? */
static bool find_set(const exr_attr_chlist_t *list, const exr_attr_string_t *of, exr_channels *set) {
    static const char *const names[3] = { "R", "G", "B" };
    size_t length = layer_length(of);
    int found = 0, y = find_channel(list, of->str, length, "Y");
    for (int k = 0; k < 3; k++) {
        set->channel[k] = find_channel(list, of->str, length, names[k]);
        found += is_at_every_pixel(list, set->channel[k]);
    }
    set->layer_length = length;
    if (found == 3) return true;
    bool has_chroma = find_channel(list, of->str, length, "RY") >= 0 || find_channel(list, of->str, length, "BY") >= 0;
    if (set->channel[0] >= 0 && set->channel[1] >= 0 && set->channel[2] >= 0) has_chroma = true;
    if (y >= 0 && (has_chroma || !is_at_every_pixel(list, y))) has_chroma = true, y = -1;
    set->has_chroma |= has_chroma;
    for (int k = 0; k < 3; k++) set->channel[k] = y;
    return y >= 0;
}

/* The part's layer without a name, else its first; *set then has it, if there was none before. */
static void look_at_part(const exr_attr_chlist_t *list, int part, exr_channels *set) {
    exr_channels first = *set;
    bool is_first = set->choices == 0;
    for (int i = 0; i < list->num_channels; i++) {
        exr_channels one = first;
        bool is_there = find_set(list, &list->entries[i].name, &one);
        set->has_chroma |= one.has_chroma;
        if (!is_there || one.channel[0] != i) continue;
        one.part = part, one.choices = ++set->choices, one.has_chroma = set->has_chroma;
        if (is_first && (one.choices == 1 || one.layer_length == 0)) *set = one;
    }
}

static void look_at_parts(exr_const_context_t file, exr_channels *out) {
    int parts = 0;
    exr_get_count(file, &parts);
    for (int part = 0; part < parts; part++) {
        exr_storage_t storage;
        const exr_attr_chlist_t *list;
        if (exr_get_storage(file, part, &storage) != EXR_ERR_SUCCESS ||
            exr_get_channels(file, part, &list) != EXR_ERR_SUCCESS)
            continue;
        if (storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED)
            out->has_deep = true;
        else
            look_at_part(list, part, out);
    }
}

hemi_result exr_channels_choose(exr_const_context_t file, exr_channels *out, char message[IMAGE_MESSAGE_SIZE]) {
    look_at_parts(file, out);
    if (out->choices > 0) return HEMI_OK;
    if (out->has_deep)
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is deep, with any number of samples a pixel; flatten it",
                          message);
    if (out->has_chroma)
        return image_fail(HEMI_ERROR_UNSUPPORTED,
                          "it has luminance and chroma, or colours at a part of its pixels; write it as R, G and B",
                          message);
    return image_fail(HEMI_ERROR_DATA, "it has no channels R, G and B, and no Y", message);
}
