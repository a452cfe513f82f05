/* SPDX-License-Identifier: MIT */
#include "bake/prepared_scene.h"

#include "geometry/vec3.h"
#include "mesh/cluster.h"
#include "mesh/contact_cut.h"
#include "mesh/flat_faces.h"
#include "mesh/near_emitters.h"
#include "mesh/neighbour_nodes.h"
#include "mesh/shading_normals.h"
#include "scene/coplanar_overlap.h"

#include <string.h>

/* The longest diagonal of a cluster's box, in edges of a patch: about that of a square patch. */
static const double CLUSTER_SIZE = 1.5;

/* Up to so many emitters each shoots alone, with a shadow of its own. Among more no shadow is that of one. */
enum { EMITTERS_ALONE = 256 };

/* A contact line through less of a patch than this share of its size does not cut it: what it shoots is hardly other.
 */
static const double LINE_OF_PATCH = 0.25;

/* Shares of an element's edge. Where something hangs over a surface lower than the former, light ends at the line for
 * all that elements can show; higher than the latter, elements as they are show how it fades. A bar 3 mm over a
 * window's sill: what is 1 mm under its edge is a third too dark without. */
static const double GAP_LEAST = 1.0 / 32.0, GAP_MOST = 0.5;

/* What shoots is as bright all over, so by columns these are shares of a patch's edge: one that reaches under a door
 * 1 cm over the floor brings the dark room behind it 40 times the light that comes through the gap. */
static contact_gaps gaps_of_columns(double edge, double patch_size) {
    return (contact_gaps){ GAP_LEAST * edge, GAP_MOST * edge, GAP_MOST * patch_size, INFINITY, 0.0 };
}

/* By rows they are shares of an element's edge, and of what hangs low only long strips part what is beside them: an
 * element that reaches past both sides of a door 1 cm over its floor sees both rooms, and the dark one was off by 139 %
 * instead of 58. All that hangs so low would be half as many elements again in an apartment, which costs a fifth more
 * time for a fortieth of the error; there, where triangles are elements at any size, long strips alone are 8 % more,
 * and an error of 4.7 instead of 4.3 % over four seeds: they are left. */
static const double STRIP_WIDTH = 2.0, STRIP_OUTLINE = 32.0;

static contact_gaps gaps_of_rows(double edge, bool is_crowded) {
    return (contact_gaps){ GAP_LEAST * edge, GAP_MOST * edge, is_crowded ? 0.0 : GAP_MOST * edge, STRIP_WIDTH * edge,
                           STRIP_OUTLINE * edge };
}

static contact_gaps gaps_of(const bake_options *o) {
    double edge = ldexp(o->element_size, -(int)o->even_levels);
    return o->method == SOLVER_ROWS ? gaps_of_rows(edge, o->is_crowded) : gaps_of_columns(edge, o->patch_size);
}

/* Methods that are there to be compared with have their elements as the paper has them. */
static bool cut_at_contacts(const bake_options *options, const refinement_setup *of, jobs *j) {
    contact_lines lines;
    const contact_gaps gaps = gaps_of(options);
    if (quality_compares(options)) return true;
    bool ok = contact_lines_find(of->scene, &gaps, &options->cuts_latest, j, &lines) &&
              contact_cut(of, &lines, LINE_OF_PATCH * options->patch_size, gaps.least, options->max_elements,
                          &options->cuts_latest);
    contact_lines_free(&lines);
    return ok;
}

/* Tiles of a floor are one floor. */
static bool join_neighbours(const bake_options *options, const refinement_setup *of, const uint32_t *pictures) {
    const neighbour_nodes_setup how = { of->scene, of->mesh, of->vertices, of->sources, pictures };
    return quality_compares(options) || neighbour_nodes_join(&how);
}

bool prepared_scene_cut_elements(const bake_options *options, const refinement_setup *of, const uint32_t *pictures,
                                 jobs *j, arena *memory) {
    bool is_smooth = !options->facets && !quality_compares(options);
    return (options->hurries || (join_neighbours(options, of, pictures) && cut_at_contacts(options, of, j))) &&
           (!is_smooth || shading_normals_set_all(of->mesh, of->scene, of->sources, of->vertices)) &&
           mesh_measure_in_scene(of->mesh, of->scene, j, memory) &&
           (options->method != SOLVER_ROWS || options->hurries ||
            near_emitters_split(of, options->keeps_rows, options->max_elements, &options->cuts_latest, memory));
}

static bool find_panes(const refinement_setup *of, prepared_scene *out) {
    if (panes_mark(of->scene, of->mesh) == 0) return true;
    of->scene->panes = out->panes = panes_create(of->scene, of->mesh);
    return out->panes;
}

/* Methods that are there to be compared with shoot patch by patch, and by rows nothing shoots. */
static bool find_clusters(const bake_options *options, const refinement_setup *of, arena *memory, prepared_scene *out) {
    size_t emitters = 0;
    for (size_t p = 0; p < of->mesh->patch_count; p++) emitters += material_emits(&of->mesh->patches[p].material);
    const cluster_desc how = { .size = CLUSTER_SIZE * options->patch_size,
                               .angle = options->cluster_angle * PI / 180.0,
                               .emitters = emitters > EMITTERS_ALONE };
    return quality_compares(options) || options->method == SOLVER_ROWS || !(options->cluster_angle > 0.0) ||
           clusters_find(of->scene, &how, memory, of->mesh, &out->clusters);
}

static bool make_items(solver_method method, const refinement_setup *of, arena *memory, prepared_scene *out) {
    return mesh_items_create(of->scene, of->mesh, MESH_SURFACES, memory, &out->surfaces) &&
           mesh_items_create(of->scene, of->mesh, MESH_PATCHES, memory, &out->patches) &&
           (method != SOLVER_PR || mesh_items_create(of->scene, of->mesh, MESH_ELEMENTS, memory, &out->elements));
}

/* What is asked of all surfaces: questions that do not know of each other. */
enum { FLAT_FACES = 2, QUESTIONS };

typedef struct asking {
    const refinement_setup *of;
    allocator *memory;
    prepared_scene *out;
    uint8_t *layers;
    bool ok[QUESTIONS];
} asking;

/* What passes through what, what lies in what, and which surfaces are one face, where triangles are decimated. */
static void ask(void *user, size_t question, unsigned worker) {
    asking *a = user;
    const item_geometry *items = &a->out->surfaces.items;
    (void)worker;
    if (question == 0)
        a->ok[0] = intersections_count(a->of->scene, &a->out->crossing_count);
    else if (question == 1)
        a->ok[1] =
            coplanar_overlap_find_layers(a->memory, items->positions, items->indices, items->triangle_count, a->layers);
    else
        a->ok[2] =
            !a->out->flat_face || flat_faces_join(a->of->scene, a->of->vertices, a->of->sources, a->out->flat_face);
}

static bool check_surfaces(const bake_options *options, const refinement_setup *of, arena *memory,
                           prepared_scene *out) {
    size_t triangles = out->surfaces.items.triangle_count;
    bool joins = options->decimate_error > 0.0;
    asking a = { .of = of, .memory = memory->memory, .out = out, .layers = arena_alloc(memory, triangles + 1, 1) };
    if (joins) out->flat_face = arena_alloc(memory, of->scene->surface_count, sizeof *out->flat_face);
    if (!a.layers || (joins && !out->flat_face)) return false;
    out->surfaces.items.layers = a.layers; /* all 0 so far */
    if (options->hurries) {
        ask(&a, FLAT_FACES, 0);
        return a.ok[FLAT_FACES];
    }
    jobs_run(of->jobs, QUESTIONS, ask, NULL, &a);
    for (size_t t = 0; t < triangles; t++) out->overlapping_count += a.layers[t] > 0;
    return a.ok[0] && a.ok[1] && a.ok[2];
}

/* Where rows are kept: which meshes shine, unless an earlier bake has said so. Elements of what has a picture have
 * materials of their own. */
static bool keep_shining(const refinement_setup *of, arena *memory) {
    size_t count = 0;
    for (size_t i = 0; i < of->scene->surface_count; i++)
        if (of->scene->surfaces[i].mesh >= count) count = of->scene->surfaces[i].mesh + (size_t)1;
    uint8_t *shining = arena_alloc(memory, count + 1, sizeof *shining);
    if (!shining) return false;
    memset(shining, SHINING_NOT, count + 1);
    for (size_t i = 0; i < of->mesh->element_count; i++) {
        const element *e = &of->mesh->elements[i];
        const surface *f = &of->scene->surfaces[of->mesh->patches[e->patch].surface];
        if (!scene_emits(of->scene, f)) continue;
        shining[f->mesh] = e->material == &of->scene->materials[f->material] ? SHINING_EVENLY : SHINING_BY_PICTURE;
    }
    of->scene->shining = shining;
    return true;
}

bool prepared_scene_make(const bake_options *options, const refinement_setup *of, bool is_textured, arena *memory,
                         prepared_scene *out) {
    bool is_new = options->keeps_rows && !of->scene->shining;
    return (!is_new || keep_shining(of, memory)) && find_panes(of, out) &&
           (!(is_textured || of->scene->shining) ||
            uneven_emitters_split(of->mesh, of->scene, memory, &out->emitters_are_split)) &&
           find_clusters(options, of, memory, out) && make_items(options->method, of, memory, out) &&
           check_surfaces(options, of, memory, out);
}

void prepared_scene_free(prepared_scene *p) {
    panes_destroy(p->panes);
}

void prepared_scene_set_pool(prepared_scene *p, item_pool *pool, const bake_options *o) {
    p->surfaces.items.pool = p->patches.items.pool = p->elements.items.pool = pool;
    item_pool_set_backend(pool, quality_choose_backend(o, p->surfaces.items.triangle_count));
}
