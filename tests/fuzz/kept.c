/* SPDX-License-Identifier: MIT
 * What does a bake make of results that were kept and then changed: those of a checkpoint, the rows of another bake,
 * the file of a checkpoint itself? Checksums are made right again, so that what is changed comes to be looked at. Bytes
 * are read as changes in order, and are zero at their end.
 */
#define _GNU_SOURCE 1 /* memfd_create */
#include "targets.h"

#include "base/chunk_file.h"
#include "checkpoint_file.h"

#include <hemibake/hemibake.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { RESULTS_MOST = 512, CHANGES_MOST = 16, HEAD_BYTES = 16, CHECKSUM_BYTES = 8, SIZE_MOST = 1 << 24 };

typedef struct change {
    uint8_t item, how;
    uint16_t at;
    uint32_t word;
} change;

/* ---- the scene: a floor, a lamp above it, and a pane between, whose rows are in no checkpoint ---- */

static void add_square(hemi_scene *scene, float side, float y, bool faces_down, uint32_t material) {
    static const uint32_t UP[] = { 0, 1, 2, 0, 2, 3 }, DOWN[] = { 0, 2, 1, 0, 3, 2 };
    const float positions[] = { -side, y, -side, -side, y, side, side, y, side, side, y, -side };
    const hemi_mesh_desc m = { .struct_size = sizeof m,
                               .name = "fuzz",
                               .positions = positions,
                               .vertex_count = 4,
                               .indices = faces_down ? DOWN : UP,
                               .triangle_count = 2,
                               .material = material };
    if (hemi_scene_add_mesh(scene, &m, NULL) != HEMI_OK) abort();
}

static hemi_scene *make_scene(hemi_context *context, bool has_pane) {
    const hemi_material_desc materials[] = {
        { .struct_size = sizeof *materials, .name = "grey", .reflectance = { 0.5, 0.4, 0.3 }, .double_sided = true },
        { .struct_size = sizeof *materials, .name = "lamp", .emission = { 5.0, 5.0, 5.0 } },
        { .struct_size = sizeof *materials,
          .name = "pane",
          .reflectance = { 0.1, 0.1, 0.1 },
          .transmission = { 0.8, 0.7, 0.6 },
          .double_sided = true }
    };
    hemi_scene *scene = NULL;
    if (hemi_scene_create(context, &scene) != HEMI_OK) abort();
    for (size_t i = 0; i < sizeof materials / sizeof *materials; i++)
        if (hemi_scene_add_material(scene, &materials[i], NULL) != HEMI_OK) abort();
    add_square(scene, 2.0f, 0.0f, false, 0);
    add_square(scene, 0.5f, 1.5f, true, 1);
    add_square(scene, 0.5f, 0.75f, false, has_pane ? 2 : 0);
    return scene;
}

/* Of few samples, since each casts up to thousands of rays. */
static hemi_bake_desc bake_of(hemi_method method) {
    return (hemi_bake_desc){ .struct_size = sizeof(hemi_bake_desc),
                             .method = method,
                             .quality = HEMI_QUALITY_DRAFT,
                             .element_size = 4.0,
                             .patch_size = 4.0,
                             .hemicube = 16,
                             .hemicube_light = 16,
                             .max_elements = 20000,
                             .memory_limit = FUZZ_MEMORY,
                             .visibility = HEMI_VISIBILITY_RAYS };
}

/* Whatever was found by rows, what comes out is light. Columns may be of any size, so that light grows beyond numbers.
 */
static bool bake(const hemi_bake_desc *desc, bool has_pane) {
    hemi_scene *scene = make_scene(fuzz_context(), has_pane);
    hemi_solution *solution = NULL;
    hemi_result result = hemi_bake(scene, desc, &solution);
    if ((result == HEMI_OK) != (solution != NULL)) abort();
    for (uint32_t i = 0; solution && desc->method == HEMI_METHOD_ROWS; i++) {
        hemi_mesh_view view = { .struct_size = sizeof view };
        if (hemi_solution_mesh(solution, i, &view) != HEMI_OK) break;
        for (size_t k = 0; k < 3 * (size_t)view.vertex_count; k++)
            if (!(view.radiance[k] >= 0.0f && isfinite(view.radiance[k]))) abort();
    }
    hemi_solution_destroy(solution);
    hemi_scene_destroy(scene);
    return result == HEMI_OK;
}

/* ---- changes ---- */

static size_t read_changes(const uint8_t *bytes, size_t size, change out[CHANGES_MOST]) {
    size_t count = 0;
    for (; count < CHANGES_MOST && size >= sizeof(change); count++, bytes += sizeof(change), size -= sizeof(change))
        memcpy(&out[count], bytes, sizeof(change));
    return count;
}

/* Numbers that readers are weak at, or any other. */
static uint32_t word_of(const change *c) {
    static const uint32_t ODD[] = { 0,          1,          UINT32_MAX, INT32_MAX,  0x80000000, 0x7fc00000,
                                    0x7f800000, 0xff800000, 0xbf800000, 0x7f7fffff, 0x3f800000, 0xfffffffe,
                                    0xffff,     0x10000,    2,          0x00000001 };
    return c->how & 16 ? c->word : ODD[c->how & 15];
}

/* Writes over the bytes, and may cut them short. Returns how many are left. */
static size_t apply(const change *c, uint8_t *bytes, size_t size) {
    uint32_t word = word_of(c);
    if (size == 0) return 0;
    if (c->how & 64) return c->word % (size + 1);
    size_t at = ((size_t)c->at * (c->how & 32 ? 4 : 1)) % size,
           length = size - at < sizeof word ? size - at : sizeof word;
    memcpy(bytes + at, &word, length);
    return size;
}

/* ---- results of a checkpoint ---- */

typedef struct result {
    uint64_t key[2], size;
    uint8_t *bytes;
} result;

typedef struct results {
    result all[RESULTS_MOST];
    size_t count, change_count;
    change changes[CHANGES_MOST];
} results;

static void keep(void *user, const uint64_t key[2], const void *bytes, uint64_t size) {
    results *r = user;
    if (r->count == RESULTS_MOST) return;
    uint8_t *copy = malloc((size_t)size + 1);
    if (!copy) abort();
    memcpy(copy, bytes, (size_t)size);
    r->all[r->count++] = (result){ { key[0], key[1] }, size, copy };
}

static void keep_no_more(void *user, const uint64_t key[2], const void *bytes, uint64_t size) {
    (void)user, (void)key, (void)bytes, (void)size;
}

static uint64_t find_nothing(void *user, const uint64_t key[2], void *bytes, uint64_t room) {
    (void)user, (void)key, (void)bytes, (void)room;
    return 0;
}

static uint64_t find_changed(void *user, const uint64_t key[2], void *bytes, uint64_t room) {
    const results *r = user;
    for (size_t i = 0; i < r->count; i++) {
        const result *one = &r->all[i];
        if (one->key[0] != key[0] || one->key[1] != key[1]) continue;
        if (one->size > room) return one->size;
        size_t left = (size_t)one->size;
        memcpy(bytes, one->bytes, left);
        for (size_t c = 0; c < r->change_count; c++)
            if (r->changes[c].item % r->count == i) left = apply(&r->changes[c], bytes, left);
        return left;
    }
    return 0;
}

void fuzz_kept(const uint8_t *bytes, size_t size) {
    static results found[2];
    bool by_rows = size > 0 && bytes[0] & 1;
    results *r = &found[by_rows];
    hemi_bake_desc desc = bake_of(by_rows ? HEMI_METHOD_ROWS : HEMI_METHOD_HYBRID);
    if (by_rows) desc.adapt_levels = 1;
    if (r->count == 0) {
        const hemi_checkpoint first = { sizeof first, r, find_nothing, keep };
        desc.checkpoint = &first;
        if (!bake(&desc, false) || r->count == 0) abort();
    }
    r->change_count = size > 0 ? read_changes(bytes + 1, size - 1, r->changes) : 0;
    const hemi_checkpoint again = { sizeof again, r, find_changed, keep_no_more };
    desc.checkpoint = &again;
    bake(&desc, false);
}

/* ---- rows of another bake ---- */

/* One after the other: chunks, each of which some changes are of, with checksums that are right. */
static void change_rows(const chunk_memory *whole, const change *changes, size_t count, chunk_memory *out) {
    chunk_writer w = { .write = chunk_memory_write, .user = out };
    static uint8_t copy[SIZE_MOST];
    uint32_t version;
    size_t at = HEAD_BYTES;
    memcpy(&version, whole->bytes + 8, sizeof version);
    chunk_write_begin(&w, (const char *)whole->bytes, version);
    for (unsigned i = 0; at + HEAD_BYTES <= whole->used; i++) {
        uint64_t size;
        const char *tag = (const char *)whole->bytes + at;
        memcpy(&size, whole->bytes + at + 8, sizeof size);
        if (size > sizeof copy) abort();
        memcpy(copy, whole->bytes + at + HEAD_BYTES, (size_t)size);
        size_t left = (size_t)size;
        /* Those of panes, which are many, are changed alike; how triangles were merged comes after them. */
        unsigned item = memcmp(tag, "merg", 4) == 0 ? 14 : memcmp(tag, "diag", 4) == 0 ? 13 : i < 13 ? i : 15;
        for (size_t c = 0; c < count; c++)
            if (changes[c].item % 16 == item) left = apply(&changes[c], copy, left);
        chunk_write(&w, tag, copy, left);
        at += HEAD_BYTES + (size_t)size + CHECKSUM_BYTES;
    }
}

void fuzz_rows(const uint8_t *bytes, size_t size) {
    static chunk_memory whole;
    hemi_bake_desc desc = bake_of(HEMI_METHOD_ROWS);
    change changes[CHANGES_MOST];
    desc.adapt_levels = 1, desc.decimate_error = 0.1;
    if (!whole.bytes) {
        desc.rows_write = chunk_memory_write, desc.rows_user = &whole;
        if (!bake(&desc, true) || !whole.bytes) abort();
    }
    size_t count = read_changes(bytes, size, changes);
    chunk_memory out = { 0 };
    change_rows(&whole, changes, count, &out);
    chunk_memory in = { .bytes = out.bytes, .size = out.used };
    desc.rows_write = NULL, desc.rows_read = chunk_memory_read, desc.rows_user = &in;
    if (!bake(&desc, true) && count == 0) abort();
    block_free(out.bytes);
}

/* ---- the file of a checkpoint ---- */

/* Two results are kept, by the checksums that they have; then bytes of the file are changed. */
static void write_file(int descriptor, const uint8_t *bytes, size_t size, const uint64_t keys[2][2]) {
    size_t text = size / 3;
    checkpoint_file *f = checkpoint_file_begin(dup(descriptor), (const char *)bytes, text);
    if (!f) abort();
    for (int i = 0; i < 2; i++) checkpoint_file_add(f, keys[i], bytes + text * (size_t)i, text);
    checkpoint_file_close(f);
    change changes[CHANGES_MOST];
    size_t count = read_changes(bytes, size % (3 * sizeof(change)), changes);
    off_t length = lseek(descriptor, 0, SEEK_END);
    for (size_t c = 0; c < count && length > 0; c++) {
        uint32_t word = word_of(&changes[c]);
        if (pwrite(descriptor, &word, sizeof word, changes[c].at % length) != sizeof word) abort();
    }
    if (count > 0 && changes[0].how & 64 && ftruncate(descriptor, changes[0].at % (length + 1)) != 0) abort();
}

void fuzz_checkpoint(const uint8_t *bytes, size_t size) {
    static const uint64_t KEYS[2][2] = { { 1, 2 }, { 3, 4 } };
    char reason[CHECKPOINT_REASON_SIZE] = "", *text = NULL;
    uint8_t found[64];
    size_t text_size = 0;
    int descriptor = memfd_create("fuzz.checkpoint", 0);
    if (descriptor < 0) abort();
    if (size > 0 && bytes[0] & 1) {
        if (write(descriptor, bytes + 1, size - 1) != (ssize_t)(size - 1)) abort();
    } else {
        write_file(descriptor, bytes, size, KEYS);
    }
    int its = dup(descriptor);
    checkpoint_file *f = checkpoint_file_read(its, &text, &text_size, reason);
    if (!f) close(its);
    if ((f != NULL) != (reason[0] == 0)) abort();
    for (int i = 0; f && i < 2; i++) checkpoint_file_find(f, KEYS[i], found, sizeof found);
    if (f) checkpoint_file_add(f, KEYS[0], bytes, size);
    checkpoint_file_close(f);
    free(text);
    close(descriptor);
}
