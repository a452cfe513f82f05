/* SPDX-License-Identifier: MIT
 * See lights_from.h.
 */
#include "lights_from.h"

#include "asset_box.h"
#include "same_meshes.h"

#include <stdlib.h>
#include <string.h>

/* Of the diagonal of the input: positions of 14 bits are off by half of 6e-5 of that of their mesh. */
static const double APART = 1e-4;

/* What a surface reflects by one asset, and emits by another. */
typedef struct mixed_texture {
    hemi_texture_fn reflects, emits; /* NULL: its material says it */
    void *reflects_user, *emits_user;
    bool is_dark;
} mixed_texture;

/* A material of the scene: that of the input with the emission of the other asset's. */
typedef struct mixed_material {
    uint32_t of, index, next; /* of: of the other asset, NONE: it emits nothing; next: with the same of the input */
} mixed_material;

static const uint32_t NONE = UINT32_MAX;

/* ---- which meshes are which ---- */

static int name_strangers(const lights_from *l, const options *o, const same_meshes *found, console *c) {
    hemi_mesh_desc mesh;
    bool is_of_input = found->stranger_is_of_first;
    gltf_asset_mesh(is_of_input ? l->input : l->other, found->stranger, &mesh);
    const char *of = is_of_input ? o->inputs[0] : o->lights_from, *in = is_of_input ? o->lights_from : o->inputs[0];
    console_error(
        c,
        "--lights-from: mesh \"%.80s\" (%u triangles) of %.120s has no counterpart in the same place in %.120s; "
        "only lights may differ",
        mesh.name ? mesh.name : "", mesh.triangle_count, of, in);
    return EXIT_BAD_INPUT;
}

/* What a picture says of emission is asked with the coordinates of the input. */
static int check_coordinates(const lights_from *l, const options *o, console *c) {
    for (uint32_t i = 0; i < gltf_asset_mesh_count(l->input); i++) {
        hemi_mesh_desc mesh, other;
        uint32_t of;
        gltf_asset_mesh(l->input, i, &mesh);
        if (!lights_from_emits(l, i, &of)) continue;
        gltf_asset_mesh(l->other, of, &other);
        if (!gltf_asset_texture(l->other, of, &other) || same_attributes(&mesh, &other)) continue;
        console_error(c, "--lights-from: mesh \"%.80s\" has other texture coordinates than in %s, by which it emits",
                      mesh.name ? mesh.name : "", o->inputs[0]);
        return EXIT_BAD_INPUT;
    }
    return EXIT_DONE;
}

static int match(lights_from *l, const options *o, console *c) {
    double middle[3];
    same_meshes found;
    l->mesh_of = same_meshes_find(l->input, l->other, APART * asset_box(l->input, middle), &found);
    if (!l->mesh_of) return console_error(c, "out of memory");
    return found.has_stranger ? name_strangers(l, o, &found, c) : check_coordinates(l, o, c);
}

/* ---- reading ---- */

static int read_other(lights_from *l, const options *o, const asset_colors *colors, options *as_read, console *c) {
    options named = *o;
    named.inputs = &o->lights_from, named.input_count = 1;
    named.continues = named.variant = NULL;
    options read = named;
    int status = asset_input_read(&named, c, &l->usd, &read, &l->other);
    if (status == EXIT_DONE) status = asset_input_textures(o, colors, c, l->other);
    as_read->environment = read.environment, as_read->root = read.root;
    return status;
}

static bool allocate(lights_from *l) {
    size_t meshes = gltf_asset_mesh_count(l->input), count = gltf_asset_material_count(l->input);
    l->textures = calloc(meshes + 1, sizeof *l->textures);
    l->materials = malloc((meshes + 1) * sizeof *l->materials);
    l->first_material = malloc((count + 1) * sizeof *l->first_material);
    if (!l->textures || !l->materials || !l->first_material) return false;
    memset(l->first_material, 0xff, (count + 1) * sizeof *l->first_material);
    return true;
}

int lights_from_open(lights_from *l, const options *o, const gltf_asset *input, const asset_colors *colors,
                     options *as_read, console *c) {
    const char *file = c->file;
    *l = (lights_from){ .input = input, .asset = input };
    if (!o->lights_from) return EXIT_DONE;
    if (o->is_one_of_many || o->input_count > 1 || o->ao) {
        console_error(c, o->ao ? "--lights-from: --ao takes no lights"
                               : "--lights-from is for one input, whose geometry its asset has");
        return EXIT_USAGE;
    }
    if (!allocate(l)) return console_error(c, "out of memory");
    c->file = o->lights_from;
    int status = read_other(l, o, colors, as_read, c);
    if (status == EXIT_DONE) l->asset = l->other;
    if (status == EXIT_DONE) status = match(l, o, c);
    if (status == EXIT_DONE) c->file = file;
    return status;
}

void lights_from_close(lights_from *l) {
    gltf_asset_destroy(l->other);
    usd_files_close(&l->usd);
    free(l->mesh_of), free(l->textures), free(l->materials), free(l->first_material);
    *l = (lights_from){ 0 };
}

/* ---- what emits ---- */

static uint32_t mesh_of(const lights_from *l, uint32_t mesh) {
    return l->mesh_of ? l->mesh_of[mesh] : mesh;
}

void lights_from_emission(const lights_from *l, uint32_t mesh, double emission[3]) {
    hemi_mesh_desc desc;
    hemi_material_desc own = { 0 };
    uint32_t of = mesh_of(l, mesh);
    if (gltf_asset_mesh(l->asset, of, &desc) && !gltf_asset_mesh_is_left(l->asset, of))
        gltf_asset_material(l->asset, desc.material, &own);
    memcpy(emission, own.emission, sizeof own.emission);
}

bool lights_from_emits(const lights_from *l, uint32_t mesh, uint32_t *of) {
    double emission[3];
    lights_from_emission(l, mesh, emission);
    *of = mesh_of(l, mesh);
    return emission[0] > 0.0 || emission[1] > 0.0 || emission[2] > 0.0;
}

/* How much brighter a band is shown than it is, where a viewer multiplies it by a picture of the input. */
static double shown_by(const hemi_texture_mean *of_input, int c) {
    if (of_input->emission[c] > 0.0) return of_input->demodulated_emission[c] / of_input->emission[c];
    double passed = of_input->reflectance[c] + of_input->diffuse_transmission[c];
    return passed > 0.0 ? of_input->demodulated_reflectance[c] / passed : 1.0;
}

static void mix(void *user, const double *attributes, uint32_t corner_count, hemi_texture_mean *out) {
    const mixed_texture *t = user;
    hemi_texture_mean other = *out;
    if (t->emits) t->emits(t->emits_user, attributes, corner_count, &other);
    if (t->reflects) t->reflects(t->reflects_user, attributes, corner_count, out);
    for (int c = 0; c < 3; c++) {
        double shown = t->reflects ? shown_by(out, c) : 1.0;
        out->emission[c] = t->is_dark ? 0.0 : other.emission[c];
        out->demodulated_emission[c] = shown * out->emission[c];
    }
}

static hemi_result mix_materials(lights_from *l, const asset_colors *colors, uint32_t of, uint32_t of_other,
                                 hemi_scene *scene, console *c, uint32_t *index) {
    hemi_material_desc mixed, other = { 0 };
    hemi_result result = asset_colors_material(colors, l->input, of, c, &mixed);
    if (result == HEMI_OK && of_other != NONE) result = asset_colors_material(colors, l->other, of_other, c, &other);
    bool is_same = memcmp(mixed.emission, other.emission, sizeof other.emission) == 0;
    *index = of;
    memcpy(mixed.emission, other.emission, sizeof mixed.emission);
    if (result == HEMI_OK && !is_same) result = hemi_scene_add_material(scene, &mixed, index);
    if (result != HEMI_OK) return result;
    l->materials[l->material_count] = (mixed_material){ of_other, *index, l->first_material[of] };
    l->first_material[of] = l->material_count++;
    return HEMI_OK;
}

static bool is_mixed_alike(const mixed_texture *a, const mixed_texture *b) {
    return a->reflects == b->reflects && a->emits == b->emits && a->reflects_user == b->reflects_user &&
           a->emits_user == b->emits_user && a->is_dark == b->is_dark;
}

static void mix_textures(lights_from *l, uint32_t mesh, uint32_t of, bool emits, hemi_mesh_desc *desc) {
    hemi_mesh_desc other;
    gltf_asset_mesh(l->other, of, &other);
    bool is_pictured = emits && gltf_asset_texture(l->other, of, &other);
    mixed_texture mixed = { desc->texture, is_pictured ? other.texture : NULL, desc->texture_user,
                            is_pictured ? other.texture_user : NULL, !emits };
    if (!mixed.reflects && !mixed.emits) return;
    /* Copies of one geometry go by one, as those of the input do. */
    uint32_t original = gltf_asset_mesh_original(l->input, mesh);
    mixed_texture *own = &l->textures[original];
    if (!is_mixed_alike(own, &mixed)) own = &l->textures[mesh];
    *own = mixed;
    desc->texture = mix;
    desc->texture_user = own;
}

hemi_result lights_from_set(lights_from *l, const asset_colors *colors, uint32_t mesh, hemi_scene *scene, console *c,
                            hemi_mesh_desc *desc) {
    hemi_mesh_desc other;
    uint32_t of, own = desc->material;
    if (!l->other) return HEMI_OK;
    bool emits = lights_from_emits(l, mesh, &of);
    gltf_asset_mesh(l->other, of, &other);
    mix_textures(l, mesh, of, emits, desc);
    uint32_t of_other = emits ? other.material : NONE, at = l->first_material[own];
    while (at != NONE && l->materials[at].of != of_other) at = l->materials[at].next;
    if (at == NONE) return mix_materials(l, colors, own, of_other, scene, c, &desc->material);
    desc->material = l->materials[at].index;
    return HEMI_OK;
}
