/* SPDX-License-Identifier: MIT
 * Does a baked asset read back as what was written, and does everything that was not baked survive?
 */
#include "gltf_fixture.h"

#include <cjson/cJSON.h>

/* ---- a bake that changes nothing: the mesh as it is, every vertex lit by its own colour ---- */

typedef struct fake_bake {
    hemi_mesh_view view;
    float *colors, *radiosity, *weights;
    uint32_t *triangles;
} fake_bake;

static fake_bake make_bake(const gltf_asset *asset, uint32_t index, bool subdivided) {
    hemi_mesh_desc mesh;
    fake_bake bake = { .view.vertex_count = 0 };
    if (!gltf_asset_mesh(asset, index, &mesh)) exit(2);
    bake.colors = calloc(mesh.vertex_count, 12);
    bake.radiosity = calloc(mesh.vertex_count, 12);
    bake.weights = calloc(mesh.vertex_count, 12);
    bake.triangles = calloc(mesh.vertex_count, 4);
    for (uint32_t v = 0; v < mesh.vertex_count; v++)
        for (uint32_t c = 0; c < 3; c++) {
            bake.colors[3 * v + c] = (float)((v * 3 + c) % 11) / 10.0f;
            bake.radiosity[3 * v + c] = 100.0f * bake.colors[3 * v + c] + 0.125f;
        }
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++) {
        uint32_t v = mesh.indices[i];
        bake.triangles[v] = i / 3;
        memset(&bake.weights[3 * v], 0, 12);
        bake.weights[3 * v + i % 3] = 1;
    }
    bake.view = (hemi_mesh_view){ sizeof bake.view,
                                  mesh.vertex_count,
                                  mesh.triangle_count,
                                  mesh.indices,
                                  mesh.positions,
                                  mesh.normals,
                                  bake.radiosity,
                                  subdivided ? NULL : bake.triangles,
                                  bake.weights,
                                  NULL,
                                  NULL,
                                  0,
                                  NULL,
                                  0,
                                  NULL };
    return bake;
}

static void free_bake(fake_bake *bake) {
    free(bake->colors);
    free(bake->radiosity);
    free(bake->weights);
    free(bake->triangles);
}

typedef struct options {
    bool gltf, draco, radiosity, subdivided;
    uint32_t skip;  /* mesh that stays unbaked, plus one */
    uint32_t empty; /* mesh that becomes empty, plus one */
} options;

static hemi_result write_bakes(const gltf_asset *asset, options o, gltf_output *out, char *message) {
    uint32_t count = gltf_asset_mesh_count(asset);
    fake_bake *bakes = calloc(count + 1, sizeof *bakes);
    gltf_baked_mesh *meshes = calloc(count + 1, sizeof *meshes);
    for (uint32_t i = 0; i < count; i++) {
        bakes[i] = make_bake(asset, i, o.subdivided);
        meshes[i] = (gltf_baked_mesh){ &bakes[i].view, bakes[i].colors, o.radiosity ? bakes[i].radiosity : NULL, NULL };
        if (i + 1 == o.skip) meshes[i].view = NULL;
        if (i + 1 == o.empty) bakes[i].view.triangle_count = 0;
    }
    gltf_write_desc desc = { .binary = !o.gltf,
                             .bin_name = "out.bin",
                             .meshes = meshes,
                             .mesh_count = count,
                             .draco = o.draco,
                             .draco_level = 7,
                             .generator = "hemibake test",
                             .extras_json = "{\"version\":\"9.9.9\"}" };
    hemi_result result = gltf_asset_write(asset, &desc, out, message);
    for (uint32_t i = 0; i < count; i++) free_bake(&bakes[i]);
    free(bakes);
    free(meshes);
    return result;
}

/* Writes asset with fake bakes and reads the result back; *json is its text. */
static gltf_asset *round_trip(const gltf_asset *asset, options o, gltf_output *stats, cJSON **json) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_output out;
    gltf_asset *again = NULL;
    hemi_result result = write_bakes(asset, o, &out, message);
    if (result != HEMI_OK) fprintf(stderr, "write: %s\n", message);
    CHECK_EQUAL(result, HEMI_OK);
    if (result != HEMI_OK) return NULL;
    fixture_write("out.glb", out.main, out.main_size);
    if (out.bin) fixture_write("out.bin", out.bin, out.bin_size);
    result = gltf_asset_read_within(fixture_path("out.glb"), &(gltf_limits){ .leaves_moving = true }, &again, message);
    if (result != HEMI_OK) fprintf(stderr, "read back: %s\n", message);
    CHECK_EQUAL(result, HEMI_OK);
    gltf_chunks chunks;
    CHECK_EQUAL(gltf_container_split(out.main, out.main_size, &chunks, message), HEMI_OK);
    if (json) *json = cJSON_ParseWithLength((const char *)chunks.json, chunks.json_size);
    if (stats) *stats = out;
    gltf_output_free(&out);
    fixture_remove("out.glb");
    fixture_remove("out.bin");
    return again;
}

/* nodes[3].name and the like: a path of names and numbers. */
static const cJSON *at(const cJSON *json, const char *path) {
    char name[64];
    int length;
    while (json && *path) {
        if (sscanf(path, "[%63[0-9]]%n", name, &length) == 1)
            json = cJSON_GetArrayItem(json, atoi(name));
        else if (sscanf(path, "%*[.]%n", &length) == 0 && *path == '.')
            length = 1;
        else if (sscanf(path, "%63[^.[]%n", name, &length) == 1)
            json = cJSON_GetObjectItemCaseSensitive(json, name);
        else
            return NULL;
        path += length;
    }
    return json;
}

static const char *text_at(const cJSON *json, const char *path) {
    const cJSON *item = at(json, path);
    return cJSON_IsString(item) ? item->valuestring : "(none)";
}

static double number_at(const cJSON *json, const char *path) {
    const cJSON *item = at(json, path);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

/* ---- what is baked ---------------------------------------------------------------------------------------------- */

static void baked_meshes_read_back_with_their_light(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ .radiosity = true }, NULL, &json);
    hemi_mesh_desc before, after;
    if (!again) return;
    CHECK_EQUAL(gltf_asset_mesh_count(again), 2);
    for (uint32_t i = 0; i < 2; i++) {
        fake_bake bake = make_bake(asset, i, false);
        gltf_asset_mesh(asset, i, &before);
        gltf_asset_mesh(again, i, &after);
        CHECK_TEXT(after.name, before.name);
        CHECK_EQUAL(memcmp(after.transform, before.transform, sizeof before.transform), 0);
        CHECK_EQUAL(after.vertex_count, before.vertex_count);
        CHECK_EQUAL(after.triangle_count, before.triangle_count);
        CHECK_EQUAL(memcmp(after.indices, before.indices, 6 * sizeof *after.indices), 0);
        CHECK_EQUAL(memcmp(after.positions, before.positions, 12 * sizeof *after.positions), 0);
        for (int v = 0; v < 4; v++)
            CHECK_EQUAL(memcmp(after.attributes + 5 * v, before.attributes + 5 * v, 2 * sizeof *after.attributes), 0);
        CHECK(after.normals == NULL);
        CHECK_EQUAL(memcmp(gltf_asset_mesh_radiosity(again, i), bake.radiosity, 12 * sizeof(float)), 0);
        /* half a step of sixteen bits, and the rounding of a float */
        for (int k = 0; k < 12; k++) CHECK_NEAR(gltf_asset_mesh_color(again, i)[k], bake.colors[k], 0.5 / 65535 + 6e-8);
        free_bake(&bake);
    }
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

/* The scene with `mover` on another mesh, so that every user of mesh 0 and its material is baked. */
static gltf_asset *open_without_sharer(void) {
    fixture_bin bin = fixture_make_bin();
    char *base = fixture_make_json(), *json = fixture_replace(base, "\"mover\",\"mesh\":0", "\"mover\",\"mesh\":1");
    gltf_asset *asset = fixture_open(json, &bin, sizeof bin);
    free(json);
    free(base);
    return asset;
}

static void materials_of_baked_primitives_become_unlit_copies(void) {
    gltf_asset *asset = open_without_sharer();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ 0 }, NULL, &json);
    const cJSON *glow = at(json, "materials[0]"); /* nothing else used it, so it is replaced where it stood */
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "materials")), 3);
    CHECK_TEXT(text_at(glow, "name"), "glow");
    CHECK(cJSON_IsObject(at(glow, "extensions.KHR_materials_unlit")));
    CHECK(at(glow, "extensions.KHR_materials_emissive_strength") == NULL);
    CHECK(at(glow, "emissiveFactor") == NULL);
    CHECK(at(glow, "doubleSided") == NULL);
    CHECK(at(glow, "pbrMetallicRoughness.baseColorFactor") == NULL); /* white is the default */
    CHECK_NEAR(number_at(glow, "pbrMetallicRoughness.metallicFactor"), 0, 0);
    CHECK_NEAR(number_at(glow, "pbrMetallicRoughness.baseColorTexture.index"), 0, 0);
    CHECK_NEAR(number_at(glow, "extras.tag"), 7, 0);
    CHECK_TEXT(text_at(json, "extensionsUsed[0]"), "KHR_lights_punctual");
    CHECK_TEXT(text_at(json, "extensionsUsed[1]"), "KHR_materials_unlit");
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "extensionsUsed")), 2);
    CHECK(at(json, "extensionsRequired") == NULL);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void a_material_that_unbaked_primitives_use_stays_beside_its_copy(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ .skip = 2 }, NULL, &json);
    hemi_mesh_desc mesh;
    hemi_material_desc material;
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "materials")), 4);
    CHECK_NEAR(number_at(json, "materials[0].extensions.KHR_materials_emissive_strength.emissiveStrength"), 4, 0);
    CHECK(cJSON_IsObject(at(json, "materials[3].extensions.KHR_materials_unlit")));
    if (again && gltf_asset_mesh(again, 1, &mesh) && gltf_asset_material(again, mesh.material, &material))
        CHECK_NEAR(material.emission[0], 4, 0);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void subdivided_meshes_lose_texture_coordinates_and_textures(void) {
    gltf_asset *asset = open_without_sharer();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ .subdivided = true }, NULL, &json);
    hemi_mesh_desc mesh;
    if (again && gltf_asset_mesh(again, 0, &mesh)) CHECK_EQUAL(mesh.attribute_count, 3); /* COLOR_0 */
    CHECK(at(json, "materials[0].pbrMetallicRoughness.baseColorTexture") == NULL);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void a_shared_mesh_becomes_one_mesh_a_node(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ 0 }, NULL, &json);
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "meshes")), 5); /* mover keeps the original */
    CHECK(number_at(json, "nodes[1].mesh") != number_at(json, "nodes[2].mesh"));
    CHECK_NEAR(number_at(json, "nodes[3].mesh"), 0, 0);
    CHECK_TEXT(text_at(json, "meshes[3].name"), "square");
    CHECK_NEAR(number_at(json, "meshes[3].primitives[0].extras.first"), 1, 0);
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "meshes[3].primitives")), 2); /* its lines are still there */
    CHECK_NEAR(number_at(json, "meshes[3].primitives[1].mode"), 1, 0);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void the_first_of_the_baked_nodes_takes_the_mesh_over(void) {
    gltf_asset *asset = open_without_sharer();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ 0 }, NULL, &json);
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "meshes")), 4);
    CHECK_NEAR(number_at(json, "nodes[1].mesh"), 0, 0);
    CHECK_NEAR(number_at(json, "nodes[2].mesh"), 3, 0);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void a_primitive_without_triangles_goes(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ .empty = 1 }, NULL, &json);
    if (again) CHECK_EQUAL(gltf_asset_mesh_count(again), 1);
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "nodes")), 9);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

/* ---- what is not ------------------------------------------------------------------------------------------------ */

static void everything_else_survives(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ 0 }, NULL, &json);
    CHECK_TEXT(text_at(json, "asset.generator"), "hemibake test");
    CHECK_TEXT(text_at(json, "asset.copyright"), "nobody");
    CHECK_TEXT(text_at(json, "asset.minVersion"), "2.0");
    CHECK_NEAR(number_at(json, "asset.extras.kept"), 1, 0);
    CHECK_TEXT(text_at(json, "asset.extras.hemibake.version"), "9.9.9");
    CHECK_TEXT(text_at(json, "scenes[0].name"), "room");
    CHECK_NEAR(number_at(json, "scenes[0].extras.big"), 12345678901.0, 0);
    CHECK(cJSON_IsNull(at(json, "nodes[0].extras.list[1]")));
    CHECK(cJSON_IsObject(at(json, "nodes[0].extras.nested.empty")));
    CHECK(cJSON_IsObject(at(json, "nodes[8]")));
    CHECK_NEAR(number_at(json, "nodes[7].extensions.KHR_lights_punctual.light"), 0, 0);
    CHECK_TEXT(text_at(json, "extensions.KHR_lights_punctual.lights[0].name"), "bulb");
    CHECK_EQUAL(cJSON_GetArraySize(at(json, "extensions.KHR_lights_punctual.lights")), 1);
    CHECK(at(json, "cameras[0].perspective.zfar") == NULL);
    CHECK_NEAR(number_at(json, "cameras[0].perspective.yfov"), 0.75, 0);
    CHECK_TEXT(text_at(json, "samplers[0].name"), "rough");
    CHECK_TEXT(text_at(json, "skins[0].name"), "bones");
    CHECK_NEAR(number_at(json, "skins[0].extras.skin"), 2, 0);
    CHECK_TEXT(text_at(json, "animations[0].name"), "rise");
    CHECK_NEAR(number_at(json, "animations[0].channels[0].target.node"), 3, 0);
    CHECK(at(json, "meshes[0].extras.mesh") != NULL);
    if (again) CHECK_EQUAL(gltf_asset_camera_count(again), 1);
    if (again) CHECK_EQUAL(gltf_asset_skipped_count(again), gltf_asset_skipped_count(asset));
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

/* The bytes behind buffer view `view` of a written .glb. */
static const uint8_t *view_bytes(const cJSON *json, const gltf_chunks *chunks, int view) {
    const cJSON *item = cJSON_GetArrayItem(at(json, "bufferViews"), view);
    const cJSON *offset = cJSON_GetObjectItem(item, "byteOffset");
    return chunks->bin + (offset ? offset->valueint : 0);
}

static void bytes_that_are_still_used_follow_their_numbers(void) {
    gltf_asset *asset = fixture_open_scene();
    fixture_bin bin = fixture_make_bin();
    char message[GLTF_MESSAGE_SIZE];
    gltf_output out;
    gltf_chunks chunks;
    CHECK_EQUAL(write_bakes(asset, (options){ .draco = true }, &out, message), HEMI_OK);
    CHECK_EQUAL(gltf_container_split(out.main, out.main_size, &chunks, message), HEMI_OK);
    cJSON *json = cJSON_ParseWithLength((const char *)chunks.json, chunks.json_size);
    int image = (int)number_at(json, "images[0].bufferView");
    int output = (int)number_at(json, "animations[0].samplers[0].output");
    int moves = (int)cJSON_GetObjectItem(cJSON_GetArrayItem(at(json, "accessors"), output), "bufferView")->valuedouble;
    int bind = (int)number_at(json, "skins[0].inverseBindMatrices");
    int matrix = (int)cJSON_GetObjectItem(cJSON_GetArrayItem(at(json, "accessors"), bind), "bufferView")->valuedouble;
    CHECK_TEXT(text_at(json, "images[0].mimeType"), "image/png");
    CHECK_EQUAL(memcmp(view_bytes(json, &chunks, image), bin.image, sizeof bin.image), 0);
    CHECK_EQUAL(memcmp(view_bytes(json, &chunks, moves), bin.moves, sizeof bin.moves), 0);
    CHECK_EQUAL(memcmp(view_bytes(json, &chunks, matrix), bin.bind, sizeof bin.bind), 0);
    cJSON_Delete(json);
    gltf_output_free(&out);
    gltf_asset_destroy(asset);
}

/* A .glb whose only primitive is baked must not carry the old positions, normals and colours along. */
static void replaced_geometry_leaves_the_file(void) {
    gltf_asset *asset = fixture_open_scene(), *once, *twice;
    cJSON *first = NULL, *second = NULL;
    once = round_trip(asset, (options){ 0 }, NULL, &first);
    twice = once ? round_trip(once, (options){ 0 }, NULL, &second) : NULL;
    CHECK_EQUAL(cJSON_GetArraySize(at(first, "accessors")), cJSON_GetArraySize(at(second, "accessors")));
    CHECK_EQUAL(cJSON_GetArraySize(at(first, "bufferViews")), cJSON_GetArraySize(at(second, "bufferViews")));
    CHECK_NEAR(number_at(first, "buffers[0].byteLength"), number_at(second, "buffers[0].byteLength"), 0);
    gltf_asset_destroy(asset);
    gltf_asset_destroy(once);
    gltf_asset_destroy(twice);
    cJSON_Delete(first);
    cJSON_Delete(second);
}

static void external_images_are_packed(void) {
    fixture_bin bin = fixture_make_bin();
    char message[GLTF_MESSAGE_SIZE], *base = fixture_make_json();
    char *json = fixture_replace(base, "\"bufferView\":7,\"mimeType\":\"image/png\"", "\"uri\":\"checker.png\"");
    gltf_output out;
    gltf_chunks chunks;
    for (int present = 0; present < 2; present++) {
        if (present) fixture_write("checker.png", bin.image, sizeof bin.image);
        gltf_asset *asset = fixture_open(json, &bin, sizeof bin);
        if (!asset) continue;
        CHECK_EQUAL(write_bakes(asset, (options){ 0 }, &out, message), HEMI_OK);
        CHECK_EQUAL(gltf_container_split(out.main, out.main_size, &chunks, message), HEMI_OK);
        cJSON *text = cJSON_ParseWithLength((const char *)chunks.json, chunks.json_size);
        CHECK_TEXT(text_at(text, present ? "images[0].mimeType" : "images[0].uri"),
                   present ? "image/png" : "checker.png");
        if (present)
            CHECK_EQUAL(memcmp(view_bytes(text, &chunks, (int)number_at(text, "images[0].bufferView")), bin.image, 12),
                        0);
        cJSON_Delete(text);
        gltf_output_free(&out);
        gltf_asset_destroy(asset);
    }
    fixture_remove("checker.png");
    free(json);
    free(base);
}

/* ---- forms ------------------------------------------------------------------------------------------------------ */

static void a_gltf_comes_with_its_bin(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_asset *again = round_trip(asset, (options){ .gltf = true }, NULL, &json);
    CHECK_TEXT(text_at(json, "buffers[0].uri"), "out.bin");
    if (again) CHECK_EQUAL(gltf_asset_mesh_count(again), 2);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void the_same_input_gives_the_same_bytes(void) {
    char message[GLTF_MESSAGE_SIZE];
    for (int draco = 0; draco < 2; draco++) {
        gltf_asset *asset = fixture_open_scene();
        gltf_output a, b;
        options o = { .draco = draco, .radiosity = true };
        CHECK_EQUAL(write_bakes(asset, o, &a, message), HEMI_OK);
        CHECK_EQUAL(write_bakes(asset, o, &b, message), HEMI_OK);
        CHECK(a.main_size == b.main_size && memcmp(a.main, b.main, a.main_size) == 0);
        gltf_output_free(&a);
        gltf_output_free(&b);
        gltf_asset_destroy(asset);
    }
}

static void draco_files_read_back_with_the_same_triangles(void) {
    gltf_asset *asset = fixture_open_scene();
    cJSON *json = NULL;
    gltf_output stats = { 0 };
    gltf_asset *again = round_trip(asset, (options){ .draco = true, .radiosity = true }, &stats, &json);
    if (!again) return;
    CHECK_TEXT(text_at(json, "extensionsRequired[0]"), "KHR_draco_mesh_compression");
    CHECK_EQUAL(stats.triangles, 4);
    CHECK_EQUAL(stats.vertices, 8);
    CHECK(stats.max_position_error <= 2 * sqrt(3) * 0.5 / 16383 + 1e-7); /* half a step an axis, the node doubles it */
    CHECK(stats.max_color_error > 0 && stats.max_color_error <= 0.5 / 4095 + 1e-7);
    for (uint32_t i = 0; i < 2; i++) {
        hemi_mesh_desc mesh;
        fake_bake bake = make_bake(asset, i, false);
        gltf_asset_mesh(again, i, &mesh);
        CHECK_EQUAL(mesh.vertex_count, 4);
        CHECK_EQUAL(mesh.triangle_count, 2);
        for (uint32_t v = 0; v < 4; v++) { /* the corner of the square tells which vertex this was */
            int x = mesh.positions[3 * v] > 0.5f, z = mesh.positions[3 * v + 2] > 0.5f;
            int was = x ? (z ? 2 : 3) : z;
            for (int c = 0; c < 3; c++) {
                CHECK_NEAR(gltf_asset_mesh_color(again, i)[3 * v + c], bake.colors[3 * was + c], 0.5 / 4095 + 1e-7);
                CHECK_NEAR(gltf_asset_mesh_radiosity(again, i)[3 * v + c], bake.radiosity[3 * was + c], 0);
            }
        }
        free_bake(&bake);
    }
    gltf_asset *third = round_trip(again, (options){ .skip = 2, .draco = false }, NULL, NULL);
    if (third) CHECK_EQUAL(gltf_asset_mesh_count(third), 2); /* the Draco bytes of an unbaked mesh pass through */
    gltf_asset_destroy(third);
    gltf_asset_destroy(again);
    gltf_asset_destroy(asset);
    cJSON_Delete(json);
}

static void broken_arguments_are_refused(void) {
    gltf_asset *asset = fixture_open_scene();
    char message[GLTF_MESSAGE_SIZE];
    gltf_output out;
    gltf_baked_mesh none[2] = { { NULL, NULL, NULL, NULL }, { NULL, NULL, NULL, NULL } };
    gltf_write_desc desc = { .binary = true, .meshes = none, .mesh_count = 1 };
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_ERROR_ARGUMENT);
    desc.mesh_count = 2;
    desc.extras_json = "{";
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_ERROR_ARGUMENT);
    desc.extras_json = NULL;
    desc.draco = true;
    desc.draco_level = 11;
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_ERROR_ARGUMENT);
    fake_bake bake = make_bake(asset, 0, false);
    bake.colors[4] = NAN;
    none[0] = (gltf_baked_mesh){ &bake.view, bake.colors, NULL, NULL };
    desc.draco_level = 7;
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_ERROR_ARGUMENT);
    CHECK(strstr(message, "baked mesh 0") != NULL);
    CHECK(out.main == NULL);
    bake.view.positions = NULL; /* which nothing reads before it is refused */
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_ERROR_ARGUMENT);
    free_bake(&bake);
    gltf_asset_destroy(asset);
}

static uint32_t read_u32(const uint8_t *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* [glTF 2.0, 4.4.3]: chunks begin and end at multiples of four bytes, JSON with spaces and BIN with zeros. */
static void chunks_are_padded_to_four_bytes(void) {
    for (size_t size = 2; size < 10; size++) {
        uint8_t *bytes, *bin;
        size_t total, json_size = (size + 3) / 4 * 4, bin_size = (size + 4) / 4 * 4;
        CHECK_EQUAL(gltf_container_join("{      }   ", size, size + 1, &bytes, &total, &bin), HEMI_OK);
        memset(bin, 7, size + 1);
        CHECK_EQUAL(total, 12 + 8 + json_size + 8 + bin_size);
        CHECK_EQUAL(read_u32(bytes + 8), total);
        CHECK_EQUAL(read_u32(bytes + 12), json_size);
        CHECK_EQUAL(read_u32(bytes + 20 + json_size), bin_size);
        for (size_t i = size; i < json_size; i++) CHECK_EQUAL(bytes[20 + i], ' ');
        for (size_t i = size + 1; i < bin_size; i++) CHECK_EQUAL(bytes[28 + json_size + i], 0);
        free(bytes);
    }
}

int main(void) {
    RUN(chunks_are_padded_to_four_bytes);
    RUN(baked_meshes_read_back_with_their_light);
    RUN(materials_of_baked_primitives_become_unlit_copies);
    RUN(a_material_that_unbaked_primitives_use_stays_beside_its_copy);
    RUN(subdivided_meshes_lose_texture_coordinates_and_textures);
    RUN(a_shared_mesh_becomes_one_mesh_a_node);
    RUN(the_first_of_the_baked_nodes_takes_the_mesh_over);
    RUN(a_primitive_without_triangles_goes);
    RUN(everything_else_survives);
    RUN(bytes_that_are_still_used_follow_their_numbers);
    RUN(replaced_geometry_leaves_the_file);
    RUN(external_images_are_packed);
    RUN(a_gltf_comes_with_its_bin);
    RUN(the_same_input_gives_the_same_bytes);
    RUN(draco_files_read_back_with_the_same_triangles);
    RUN(broken_arguments_are_refused);
    fixture_clean();
    return check_end();
}
