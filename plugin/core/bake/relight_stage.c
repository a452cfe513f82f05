/* SPDX-License-Identifier: MIT
 * See relight_stage.h.
 */
#include "bake/relight_stage.h"

#include "bake/rows_stage.h"
#include "solver/kept_rows_file.h"

#include <stdio.h>
#include <string.h>

static const char MAGIC[] = "hemirows";
enum { VERSION = 2, OPTIONS_MOST = 16 };

static const char NO_MEMORY[] = "out of memory";
static const char NO_TIME[] = "there was no time to keep rows; allow more, or ask for a lower quality";
static const char NOT_WRITTEN[] = "the rows cannot be written";

/* ---- what must not change ---- */

/* An option that makes other rows, as the command calls it. */
typedef struct row_option {
    const char *name;
    double value;
} row_option;

static size_t list_options(const bake_options *o, row_option out[OPTIONS_MOST]) {
    const row_option all[] = { { "--seed", (double)o->seed },
                               { "--element-size", o->element_size },
                               { "--patch-size", o->patch_size },
                               { "--quality (rays)", o->rows_initial },
                               { "--quality (more rays)", o->rows_adaptive },
                               { "--refine-levels", o->adapt_levels },
                               { "--refine-error", o->adapt_error },
                               { "--max-elements", o->max_elements },
                               { "--ao-distance", o->open_distance } };
    memcpy(out, all, sizeof all);
    return sizeof all / sizeof *all;
}

static uint64_t digest_words(const uint32_t *words, size_t count, uint64_t before) {
    return chunk_digest(words, count * sizeof *words, before);
}

uint64_t relight_digest(const scene *s, const mesh *m) {
    uint64_t d = chunk_digest(m->vertices, 3 * m->vertex_count * sizeof *m->vertices, m->element_count);
    for (size_t i = 0; i < s->surface_count; i++) {
        const surface *f = &s->surfaces[i];
        const uint32_t words[] = { f->corner[0], f->corner[1], f->corner[2],    f->corner[3],
                                   f->twin,      f->pane,      f->holes != NULL };
        d = digest_words(words, sizeof words / sizeof *words, d);
    }
    for (size_t i = 0; i < m->patch_count; i++) {
        const patch *p = &m->patches[i];
        const uint32_t words[] = { p->corner[0], p->corner[1], p->corner[2], p->corner[3], p->surface, p->contact };
        d = digest_words(words, sizeof words / sizeof *words, d);
        d = chunk_digest(p->material.transmittance, sizeof p->material.transmittance, d);
    }
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        const uint32_t words[] = { e->corner[0], e->corner[1], e->corner[2],
                                   e->corner[3], e->patch,     (uint32_t)e->hanging << 1 | e->is_foot };
        d = digest_words(words, sizeof words / sizeof *words, d);
    }
    d = chunk_digest(m->sample_area, m->sample_count * sizeof *m->sample_area, d);
    return m->shading ? chunk_digest(m->shading, 3 * m->sample_count * sizeof *m->shading, d) : d;
}

/* ---- writing ---- */

static bool write_rows(const bake_setup *setup, const kept_rows *k) {
    chunk_writer *w = setup->rows.writer;
    row_option options[OPTIONS_MOST];
    double values[OPTIONS_MOST];
    size_t count = list_options(setup->options, options);
    *w = (chunk_writer){ .write = setup->rows.write, .user = setup->rows.user };
    for (size_t i = 0; i < count; i++) values[i] = options[i].value;
    chunk_write_begin(w, MAGIC, VERSION);
    chunk_write(w, "lamp", setup->scene.scene->shining, setup->triangles.input_count);
    chunk_write(w, "optn", values, count * sizeof *values);
    chunk_write(w, "geom", &k->with->geometry, sizeof k->with->geometry);
    chunk_write(w, "pass", k->with->splits.counts, k->with->splits.pass_count * sizeof *k->with->splits.counts);
    chunk_write(w, "mark", k->with->splits.marks, k->with->splits.mark_count);
    kept_rows_write(k, w);
    return !w->failed;
}

/* ---- reading ---- */

typedef struct relighting {
    const bake_setup *setup;
    chunk_reader *reader;
    final_gather *with;
    bool (*go_on)(void *user);
    void *user;
    char *message;
    size_t message_size;
} relighting;

static const char *name_of(const rows_store *store) {
    return store->name ? store->name : "rows";
}

static const char *say_reader_fault(const rows_store *store, char *message, size_t message_size) {
    if (store->reader->fault == CHUNK_NO_MEMORY) return NO_MEMORY;
    snprintf(message, message_size, "%.80s: %s; remove it, and it is written anew", name_of(store),
             chunk_fault_text(store->reader->fault));
    return message;
}

static const char *say_other_geometry(const rows_store *store, char *message, size_t message_size) {
    snprintf(message, message_size, "%.60s: of other geometry than this scene's; name another file, or remove it",
             name_of(store));
    return message;
}

const char *relight_stage_begin(rows_store *store, arena *memory, size_t mesh_count, scene *s,
                                char message[RELIGHT_MESSAGE_SIZE]) {
    uint8_t *found = NULL, *shining = arena_alloc(memory, mesh_count + 1, sizeof *shining);
    size_t count;
    store->record = arena_alloc(memory, 1, sizeof *store->record);
    store->writer = arena_alloc(memory, 1, sizeof *store->writer);
    if (!store->record || !store->writer) return NO_MEMORY;
    *store->record = (output_record){ .collapses.memory = memory };
    *store->writer = (chunk_writer){ 0 };
    if (!store->read) return NULL;
    store->reader = arena_alloc(memory, 1, sizeof *store->reader);
    if (!shining || !store->reader) return NO_MEMORY;
    *store->reader = (chunk_reader){ .read = store->read, .user = store->user, .memory = memory->memory };
    if (!chunk_read_begin(store->reader, MAGIC, VERSION) ||
        !chunk_read_block(store->reader, "lamp", 1, (void **)&found, &count))
        return say_reader_fault(store, message, RELIGHT_MESSAGE_SIZE);
    for (size_t i = 0; i < count; i++)
        if (found[i] > SHINING_BY_PICTURE) store->reader->fault = CHUNK_UNEXPECTED;
    if (count == mesh_count) memcpy(shining, found, count);
    block_free(found);
    if (store->reader->fault != CHUNK_FINE) return say_reader_fault(store, message, RELIGHT_MESSAGE_SIZE);
    if (count != mesh_count) return say_other_geometry(store, message, RELIGHT_MESSAGE_SIZE);
    s->shining = shining;
    return NULL;
}

static const char *say_fault(const relighting *r) {
    return say_reader_fault(&r->setup->rows, r->message, r->message_size);
}

static const char *check_key(relighting *r) {
    row_option options[OPTIONS_MOST];
    double *found;
    size_t count, expected = list_options(r->setup->options, options);
    uint64_t geometry, now = relight_digest(r->setup->scene.scene, r->setup->scene.mesh);
    if (!chunk_read_block(r->reader, "optn", sizeof *found, (void **)&found, &count)) return say_fault(r);
    const char *failure = NULL;
    for (size_t i = 0; !failure && (i < count || i < expected); i++)
        if (i >= count || i >= expected || found[i] != options[i].value) {
            /* Where nobody asks for sizes they go by how large the scene is. */
            bool is_size = i < expected && strstr(options[i].name, "-size");
            snprintf(r->message, r->message_size,
                     "%.60s: of a bake with another %s (%.6g, now %.6g)%s; bake as then, or name another file",
                     name_of(&r->setup->rows), options[i < expected ? i : 0].name, i < count ? found[i] : 0.0,
                     i < expected ? options[i].value : 0.0, is_size ? ", as other geometry or quality has" : "");
            failure = r->message;
        }
    block_free(found);
    if (failure) return failure;
    if (!chunk_read_into(r->reader, "geom", &geometry, sizeof geometry)) return say_fault(r);
    if (geometry == now) return NULL;
    return say_other_geometry(&r->setup->rows, r->message, r->message_size);
}

static const char *split_again(relighting *r, refinement *tree, const uint32_t *counts, size_t passes, bool *marks) {
    for (size_t i = 0; i < passes; marks += counts[i], i++) {
        uint32_t count;
        refinement_leaves(tree, &count);
        if (count != counts[i]) return r->reader->fault = CHUNK_UNEXPECTED, say_fault(r);
        if (!final_gather_keep_split(r->with, marks, count)) return NO_MEMORY;
        refinement_result result = refinement_split(tree, marks, r->setup->options->max_elements);
        if (result == REFINEMENT_NO_MEMORY) return NO_MEMORY;
        if (result != REFINEMENT_OK) return r->reader->fault = CHUNK_UNEXPECTED, say_fault(r);
    }
    uint32_t count;
    const leaf *leaves = refinement_leaves(tree, &count);
    bool ok = final_gather_keep_roots(r->with, leaves, count) && refinement_finish(tree, r->setup->memory);
    return ok ? NULL : NO_MEMORY;
}

/* The marks are as many as the passes say, and each is one. */
static bool are_marks(const uint32_t *counts, size_t passes, const uint8_t *marks, size_t mark_count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < passes; i++) sum += counts[i];
    bool ok = sum == mark_count;
    for (size_t i = 0; ok && i < mark_count; i++) ok = marks[i] <= 1;
    return ok;
}

/* Splits the elements that the first bake split. */
static const char *refine_again(relighting *r) {
    uint32_t *counts = NULL;
    uint8_t *marks = NULL;
    size_t passes, mark_count;
    const char *failure = NULL;
    if (!chunk_read_block(r->reader, "pass", sizeof *counts, (void **)&counts, &passes) ||
        !chunk_read_block(r->reader, "mark", 1, (void **)&marks, &mark_count))
        failure = say_fault(r);
    if (!failure && !are_marks(counts, passes, marks, mark_count))
        r->reader->fault = CHUNK_UNEXPECTED, failure = say_fault(r);
    if (!failure && passes > 0) {
        refinement *tree = refinement_create(&r->setup->scene);
        failure = tree ? split_again(r, tree, counts, passes, (bool *)marks) : NO_MEMORY;
        refinement_free(tree);
        if (!failure) failure = r->setup->shade(r->setup->user);
    }
    block_free_all(counts, marks);
    return failure;
}

static bool go_on_arriving(void *user, double fraction) {
    const relighting *r = user;
    (void)fraction;
    return r->go_on(r->user);
}

/* Light that comes to the elements that there are now, past the sky, which rows see themselves. */
static const char *arrive(relighting *r, direct_light *direct) {
    const direct_light_setup how = direct_light_setup_of(r->setup, go_on_arriving, r);
    double begin = r->setup->watch.clock();
    if (!lights_any(r->setup->lights)) return NULL;
    const char *failure = lights_arrive(r->setup->lights, false, &how, direct, r->message, r->message_size);
    direct->seconds = r->setup->watch.clock() - begin;
    return failure;
}

/* A block of the file, in the arena of the record. False: there is none of that size, or no memory. */
static bool read_array(relighting *r, const char *tag, size_t unit, void **out, size_t *count) {
    void *found;
    if (!chunk_read_block(r->reader, tag, unit, &found, count)) return false;
    *out = arena_alloc(r->setup->memory, *count + 1, unit);
    if (*out) memcpy(*out, found, *count * unit);
    if (!*out) r->reader->fault = CHUNK_NO_MEMORY;
    block_free(found);
    return *out;
}

/* How the first bake merged triangles. Where a number leads is looked at where it is used. */
static bool read_record(relighting *r) {
    output_record *record = r->setup->rows.record;
    if (!read_array(r, "diag", 1, (void **)&record->diagonal, &record->diagonal_count) ||
        !read_array(r, "merg", 2 * sizeof(uint32_t), (void **)&record->collapses.pairs, &record->collapses.count))
        return false;
    for (size_t i = 0; i < record->diagonal_count; i++)
        if (record->diagonal[i] > 1) r->reader->fault = CHUNK_UNEXPECTED;
    if (record->diagonal_count != r->setup->scene.mesh->element_count) r->reader->fault = CHUNK_UNEXPECTED;
    record->collapses.is_given = true;
    return r->reader->fault == CHUNK_FINE;
}

static const char *read_rows(relighting *r, direct_light *direct, kept_rows **out) {
    const bake_setup *setup = r->setup;
    const char *failure = check_key(r);
    if (!failure) failure = refine_again(r);
    if (!failure) failure = arrive(r, direct);
    if (failure || direct->cancelled) return final_gather_free(r->with), failure;
    *out = kept_rows_read(r->reader, r->with, setup->scene.mesh, r->with->roots);
    if (*out && read_record(r) && chunk_read_end(r->reader)) return NULL;
    kept_rows_free(*out);
    *out = NULL;
    return say_fault(r);
}

static const char *settle_all(const bake_setup *setup, kept_rows *k, bool (*go_on)(void *user), void *user,
                              direct_light *direct, progressive_result *out) {
    rows_result found = { 0 };
    const kept_rows_setup how = { .lights = setup->lights,
                                  .direct = direct->irradiance,
                                  .bounces = setup->options->bounces,
                                  .go_on = go_on,
                                  .user = user };
    const char *failure = kept_rows_settle(k, &how, &found);
    out->cancelled = found.cancelled;
    if (!failure && !found.cancelled) rows_stage_take(setup, &found, direct, out);
    rows_result_free(&found);
    return failure;
}

const char *relight_stage_solve(const bake_setup *setup, direct_light *direct, bool (*go_on)(void *user), void *user,
                                progressive_result *out, char *message, size_t message_size) {
    const scene *s = setup->scene.scene;
    mesh *m = setup->scene.mesh;
    relighting r = { setup, setup->rows.reader, .go_on = go_on, .user = user };
    r.message = message, r.message_size = message_size;
    r.with = final_gather_open(s, m, setup->jobs, setup->options->open_distance, message, message_size);
    if (!r.with) return *message ? message : NO_MEMORY;
    r.with->lights = setup->lights, r.with->seed = setup->options->seed;
    r.with->emitter_rays = setup->options->rows_emitter;
    r.with->geometry = relight_digest(s, m);
    const char *failure = read_rows(&r, direct, &out->kept_rows);
    out->cancelled = direct->cancelled;
    if (failure || out->cancelled) return failure;
    if (!rows_stage_begin(setup, direct, out)) return NO_MEMORY;
    return settle_all(setup, out->kept_rows, go_on, user, direct, out);
}

const char *relight_stage_settle(const bake_setup *setup, watcher watch, bake_result *out, char *message,
                                 size_t message_size) {
    progressive_result *solution = &out->solution;
    final_gather *with = solution->final_gather;
    const char *failure = NULL;
    bool is_new = !solution->kept_rows;
    if (is_new && !with) return NO_TIME;
    if (is_new) {
        solution->final_gather = NULL;
        solution->kept_rows = kept_rows_cast(with, setup->scene.mesh, with->roots, watch.wait, watch.user);
        if (!solution->kept_rows) return out->cancelled ? NULL : NO_MEMORY;
    }
    out->coarse_elements = (uint32_t)solution->kept_rows->with->mesh->element_count;
    if (setup->options->light_groups > 0)
        failure = light_groups_settle(setup, watch, solution->kept_rows, out, message, message_size);
    else if (is_new)
        failure = settle_all(setup, solution->kept_rows, watch.wait, watch.user, &out->direct, solution);
    if (!failure && !out->cancelled && setup->rows.write && !write_rows(setup, solution->kept_rows))
        failure = NOT_WRITTEN;
    return failure;
}

const char *relight_stage_end(const bake_setup *setup) {
    const output_record *record = setup->rows.record;
    chunk_writer *w = setup->rows.writer;
    if (!w->write) return NULL;
    chunk_write(w, "diag", record->diagonal, record->diagonal_count);
    chunk_write(w, "merg", record->collapses.pairs, 2 * record->collapses.count * sizeof(uint32_t));
    return chunk_write_end(w) ? NULL : NOT_WRITTEN;
}
