/* SPDX-License-Identifier: MIT
 * What becomes of extensions: those that pack or place geometry, and those that nobody here knows?
 */
#include "gltf_fixture.h"

#include <cjson/cJSON.h>
#include <meshoptimizer.h>

/* A square of two triangles in shorts, and whatever a test puts behind it. */
typedef struct square_bin {
    float positions[12];
    uint16_t indices[6], pad[2];
    uint8_t more[512];
} square_bin;

static square_bin make_square(void) {
    return (square_bin){ .positions = { 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0 }, .indices = { 0, 1, 2, 0, 2, 3 } };
}

#define SQUARE_VIEWS "{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}"
#define SQUARE_ACCESSORS                                                                                               \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]},"         \
    "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}"
#define SQUARE_PRIMITIVE "\"attributes\":{\"POSITION\":0},\"indices\":1"

static gltf_asset *open_text(const char *text, const square_bin *bin) {
    return fixture_open(text, bin, sizeof *bin);
}

/* Bakes every mesh as it is, grey, and gives the JSON of the output. */
static cJSON *bake_grey(const gltf_asset *asset, gltf_write_desc desc, gltf_output *kept) {
    uint32_t count = gltf_asset_mesh_count(asset);
    gltf_baked_mesh *meshes = calloc(count + 1, sizeof *meshes);
    hemi_mesh_view *views = calloc(count + 1, sizeof *views);
    float colors[64], weights[64];
    uint32_t triangles[64] = { 0 };
    for (int i = 0; i < 64; i++) colors[i] = 0.5f;
    for (int i = 0; i < 64; i++) weights[i] = i % 3 == 0;
    for (uint32_t i = 0; i < count; i++) {
        hemi_mesh_desc mesh;
        gltf_asset_mesh(asset, i, &mesh);
        views[i] = (hemi_mesh_view){ sizeof views[i],
                                     mesh.vertex_count,
                                     mesh.triangle_count,
                                     mesh.indices,
                                     mesh.positions,
                                     NULL,
                                     colors,
                                     triangles,
                                     weights,
                                     NULL,
                                     NULL,
                                     0,
                                     NULL,
                                     0,
                                     NULL };
        meshes[i] = (gltf_baked_mesh){ &views[i], colors, NULL, NULL };
    }
    char message[GLTF_MESSAGE_SIZE];
    gltf_output out;
    gltf_chunks chunks;
    desc.binary = true;
    desc.meshes = meshes;
    desc.mesh_count = count;
    hemi_result result = gltf_asset_write(asset, &desc, &out, message);
    if (result != HEMI_OK) fprintf(stderr, "%s\n", message);
    CHECK_EQUAL(result, HEMI_OK);
    if (result != HEMI_OK) exit(2);
    gltf_container_split(out.main, out.main_size, &chunks, message);
    cJSON *json = cJSON_ParseWithLength((const char *)chunks.json, chunks.json_size);
    if (kept)
        *kept = out;
    else
        gltf_output_free(&out);
    free(meshes);
    free(views);
    return json;
}

static const cJSON *item(const cJSON *list, int index) {
    return cJSON_GetArrayItem(list, index);
}

static const cJSON *get(const cJSON *object, const char *name) {
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* ---- EXT_meshopt_compression ------------------------------------------------------------------------------------- */

static const char meshopt_json[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
    "\"extensionsUsed\":[\"EXT_meshopt_compression\"],\"extensionsRequired\":[\"EXT_meshopt_compression\"],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,"
    "0,1]},"
    "{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
    "\"bufferViews\":[{\"buffer\":1,\"byteLength\":48,\"byteStride\":12,\"extensions\":{\"EXT_meshopt_compression\":"
    "{\"buffer\":0,\"byteLength\":%d,\"byteStride\":12,\"count\":4,\"mode\":\"ATTRIBUTES\",\"filter\":\"%s\"}}},"
    "{\"buffer\":1,\"byteOffset\":48,\"byteLength\":12,\"extensions\":{\"EXT_meshopt_compression\":"
    "{\"buffer\":0,\"byteOffset\":256,\"byteLength\":%d,\"byteStride\":2,\"count\":6,\"mode\":\"%s\"}}}],"
    "\"buffers\":[{\"byteLength\":512},{\"byteLength\":60,\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":"
    "true}}}]}";

/* Bytes and text of the packed square; text is malloc'ed. */
static char *pack(const char *filter, const char *mode, uint8_t bytes[512]) {
    square_bin square = make_square();
    unsigned indices[6];
    float stored[12];
    memset(bytes, 0, 512);
    memcpy(stored, square.positions, sizeof stored);
    for (int i = 0; i < 6; i++) indices[i] = square.indices[i];
    if (strcmp(filter, "EXPONENTIAL") == 0) meshopt_encodeFilterExp(stored, 4, 12, 15, square.positions);
    size_t vertices = meshopt_encodeVertexBuffer(bytes, 256, stored, 4, 12);
    size_t corners = strcmp(mode, "TRIANGLES") == 0 ? meshopt_encodeIndexBuffer(bytes + 256, 256, indices, 6)
                                                    : meshopt_encodeIndexSequence(bytes + 256, 256, indices, 6);
    char *text = malloc(sizeof meshopt_json + 64);
    sprintf(text, meshopt_json, (int)vertices, filter, (int)corners, mode);
    return text;
}

static void meshopt_views_read_as_what_was_packed(void) {
    static const char *const filters[] = { "NONE", "EXPONENTIAL" }, *const modes[] = { "TRIANGLES", "INDICES" };
    square_bin square = make_square();
    for (int i = 0; i < 4; i++) {
        uint8_t bytes[512];
        char *text = pack(filters[i % 2], modes[i / 2], bytes);
        gltf_asset *asset = fixture_open(text, bytes, sizeof bytes);
        hemi_mesh_desc mesh;
        bool read = asset && gltf_asset_mesh(asset, 0, &mesh);
        CHECK(read);
        if (read) {
            CHECK_EQUAL(mesh.vertex_count, 4);
            CHECK_EQUAL(mesh.triangle_count, 2);
            CHECK_EQUAL(memcmp(mesh.positions, square.positions, sizeof square.positions), 0);
            double area = 0; /* the index codec may turn the corners of a triangle, not its face */
            for (int t = 0; t < 2; t++) {
                const float *a = mesh.positions + 3 * mesh.indices[3 * t],
                            *b = mesh.positions + 3 * mesh.indices[3 * t + 1],
                            *c = mesh.positions + 3 * mesh.indices[3 * t + 2];
                area += 0.5 * ((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]));
            }
            CHECK_NEAR(area, 1, 1e-6); /* in floats */
        }
        cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
        CHECK(get(json, "extensionsRequired") == NULL);
        char *printed = cJSON_PrintUnformatted(json);
        CHECK(strstr(printed, "meshopt") == NULL);
        cJSON_free(printed);
        cJSON_Delete(json);
        gltf_asset_destroy(asset);
        free(text);
    }
}

static void octahedral_normals_are_unpacked(void) {
    const float normals[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0 };
    uint8_t filtered[16], bytes[512];
    char *text = pack("NONE", "TRIANGLES", bytes), with[4096], view[512];
    meshopt_encodeFilterOct(filtered, 4, 4, 8, normals);
    size_t size = meshopt_encodeVertexBuffer(bytes + 384, 128, filtered, 4, 4);
    char *a = fixture_replace(text, "\"POSITION\":0", "\"POSITION\":0,\"NORMAL\":2");
    char *b =
        fixture_replace(a, "\"type\":\"SCALAR\"}",
                        "\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5120,\"normalized\":true,\"count\":4,"
                        "\"type\":\"VEC3\"}");
    snprintf(view, sizeof view, "}}],\"buffers\"");
    snprintf(
        with, sizeof with,
        "}},{\"buffer\":1,\"byteLength\":16,\"byteStride\":4,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,"
        "\"byteOffset\":384,\"byteLength\":%d,\"byteStride\":4,\"count\":4,\"mode\":\"ATTRIBUTES\",\"filter\":"
        "\"OCTAHEDRAL\"}}}],\"buffers\"",
        (int)size);
    char *c = fixture_replace(b, view, with);
    gltf_asset *asset = c ? fixture_open(c, bytes, sizeof bytes) : NULL;
    hemi_mesh_desc mesh;
    CHECK(asset != NULL);
    if (asset && gltf_asset_mesh(asset, 0, &mesh) && mesh.normals)
        for (int v = 0; v < 4; v++)
            for (int k = 0; k < 3; k++) CHECK_NEAR(mesh.normals[3 * v + k], normals[4 * v + k], 1.0 / 127); /* a step */
    gltf_asset_destroy(asset);
    free(text), free(a), free(b), free(c);
}

/* find, replacement, and what the message must hold */
static const char *const broken_meshopt[][3] = {
    { "\"mode\":\"ATTRIBUTES\"", "\"mode\":\"POINTS\"", "bufferViews[0].extensions.EXT_meshopt_compression.mode" },
    { "\"filter\":\"NONE\"", "\"filter\":\"BLUR\"", "EXT_meshopt_compression.filter" },
    { "\"count\":4,\"mode\"", "\"count\":2000000000,\"mode\"", "EXT_meshopt_compression.count is 2000000000" },
    { "\"count\":4,\"mode\"", "\"count\":0,\"mode\"", "bufferViews[0].extensions.EXT_meshopt_compression" },
    { "\"count\":4,\"mode\"", "\"count\":4294967296,\"mode\"", "EXT_meshopt_compression.count" },
    { "\"count\":6,\"mode\"", "\"count\":7,\"mode\"", "bufferViews[1].extensions.EXT_meshopt_compression" },
    { "\"byteStride\":12,\"count\"", "\"byteStride\":13,\"count\"", "bufferViews[0].extensions" },
    { "\"byteStride\":12,\"count\"", "\"byteStride\":0,\"count\"", "bufferViews[0].extensions" },
    { "{\"buffer\":0,\"byteLength\"", "{\"buffer\":9,\"byteLength\"", "EXT_meshopt_compression.buffer is 9" },
    { "{\"buffer\":0,\"byteLength\"", "{\"buffer\":0,\"byteOffset\":500,\"byteLength\"",
      "EXT_meshopt_compression covers bytes" },
    { "{\"buffer\":0,\"byteLength\"", "{\"buffer\":0,\"byteOffset\":8,\"byteLength\"", "cannot be decoded" },
    { "{\"buffer\":0,\"byteLength\"", "{\"buffer\":-1,\"byteLength\"", "EXT_meshopt_compression.buffer" },
    { "\"EXT_meshopt_compression\":{\"buffer\"", "\"EXT_meshopt_compression\":7,\"x\":{\"buffer\"", "bufferViews[0]" },
};

static void broken_meshopt_views_are_refused_by_their_place(void) {
    uint8_t bytes[512];
    char *text = pack("NONE", "TRIANGLES", bytes), message[GLTF_MESSAGE_SIZE];
    for (size_t i = 0; i < sizeof broken_meshopt / sizeof *broken_meshopt; i++) {
        char *bad = fixture_replace(text, broken_meshopt[i][0], broken_meshopt[i][1]);
        gltf_asset *asset = NULL;
        CHECK(bad != NULL);
        if (!bad) continue;
        CHECK_EQUAL(fixture_read(bad, bytes, sizeof bytes, &asset, message), HEMI_ERROR_DATA);
        CHECK(strstr(message, broken_meshopt[i][2]) != NULL);
        if (!strstr(message, broken_meshopt[i][2])) fprintf(stderr, "  %s: \"%s\"\n", broken_meshopt[i][1], message);
        gltf_asset_destroy(asset);
        free(bad);
    }
    free(text);
}

/* One byte changed at a time; under the sanitizers the proof that nothing is read out of bounds. */
static void mutate(const char *text, const void *bin, size_t bin_size, int rounds) {
    char message[GLTF_MESSAGE_SIZE];
    size_t size;
    uint32_t state = 1989;
    int read = 0;
    uint8_t *glb = fixture_glb(text, bin, bin_size, &size);
    for (int i = 0; i < rounds; i++) {
        gltf_asset *asset = NULL;
        state = state * 1664525u + 1013904223u;
        size_t at = (state >> 8) % size;
        uint8_t before = glb[at];
        glb[at] = (uint8_t)(state >> 3);
        fixture_write("mutant.glb", glb, size);
        hemi_result result = gltf_asset_read(fixture_path("mutant.glb"), &asset, message);
        CHECK(result == HEMI_OK ? message[0] == 0 : message[0] != 0 && !strchr(message, '\n'));
        if (result == HEMI_OK) {
            gltf_baked_mesh none[16] = { { NULL, NULL, NULL, NULL } };
            gltf_write_desc desc = { .meshes = none, .mesh_count = gltf_asset_mesh_count(asset) };
            gltf_output out = { .main = NULL };
            if (desc.mesh_count <= 16) CHECK(gltf_asset_write(asset, &desc, &out, message) == HEMI_OK || message[0]);
            gltf_output_free(&out);
            read++;
        }
        gltf_asset_destroy(asset);
        glb[at] = before;
    }
    CHECK(read > 0 && read < rounds); /* some changes harm and some do not, or this tests nothing */
    fixture_remove("mutant.glb");
    free(glb);
}

static void mutated_packed_scenes_do_no_harm(void) {
    uint8_t bytes[512];
    char *text = pack("EXPONENTIAL", "TRIANGLES", bytes);
    mutate(text, bytes, sizeof bytes, 3000);
    free(text);
}

/* ---- EXT_mesh_gpu_instancing ------------------------------------------------------------------------------------- */

static const char instanced_json[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0,1]}],"
    "\"nodes\":[{\"name\":\"trees\",\"mesh\":0,\"translation\":[10,0,0],\"extensions\":{\"EXT_mesh_gpu_instancing\":"
    "{\"attributes\":{\"TRANSLATION\":2,\"SCALE\":3}}}},{\"name\":\"tree\",\"mesh\":0}],"
    "\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"],\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],"
    "\"meshes\":[{\"name\":\"leaf\",\"primitives\":[{" SQUARE_PRIMITIVE "}]}],"
    "\"accessors\":[" SQUARE_ACCESSORS ",{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
    "{\"bufferView\":3,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
    "\"bufferViews\":[" SQUARE_VIEWS ",{\"buffer\":0,\"byteOffset\":64,\"byteLength\":36},"
    "{\"buffer\":0,\"byteOffset\":100,\"byteLength\":36}],\"buffers\":[{\"byteLength\":576}]}";

static square_bin make_copies(void) {
    const float moves[9] = { 1, 0, 0, 2, 0, 0, 3, 0, 0 }, scales[9] = { 1, 1, 1, 2, 2, 2, 0.5f, 0.5f, 0.5f };
    square_bin bin = make_square();
    memcpy(bin.more, moves, sizeof moves);
    memcpy(bin.more + 36, scales, sizeof scales);
    return bin;
}

static void every_gpu_instance_is_a_mesh(void) {
    square_bin bin = make_copies();
    gltf_asset *asset = open_text(instanced_json, &bin);
    hemi_mesh_desc mesh;
    CHECK_EQUAL(gltf_asset_mesh_count(asset), 4);
    const double x[4] = { 11, 12, 13, 0 }, scale[4] = { 1, 2, 0.5, 1 };
    for (uint32_t i = 0; i < 4; i++) {
        CHECK(gltf_asset_mesh(asset, i, &mesh));
        CHECK_NEAR(mesh.transform[12], x[i], 0);
        CHECK_NEAR(mesh.transform[0], scale[i], 0);
        CHECK_EQUAL(gltf_asset_mesh_original(asset, i), 0);
    }
    CHECK_EQUAL(gltf_asset_mesh_copies(asset), 3);
    CHECK_EQUAL(gltf_asset_skipped_count(asset), 0);
    gltf_asset_destroy(asset);
}

/* By a right angle about y, which takes x to -z. */
static void gpu_instances_turn_by_their_quaternions(void) {
    static const char json[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"ROTATION\":2}}}}],"
        "\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"],\"meshes\":[{\"primitives\":[{" SQUARE_PRIMITIVE "}]}],"
        "\"accessors\":[" SQUARE_ACCESSORS ",{\"bufferView\":2,\"componentType\":5126,\"count\":2,\"type\":\"VEC4\"}],"
        "\"bufferViews\":[" SQUARE_VIEWS ",{\"buffer\":0,\"byteOffset\":64,\"byteLength\":32}],"
        "\"buffers\":[{\"byteLength\":576}]}";
    static const double x_axis[2][3] = { { 1, 0, 0 }, { 0, 0, -1 } }, z_axis[2][3] = { { 0, 0, 1 }, { 1, 0, 0 } };
    const float half = sqrtf(0.5f), turns[8] = { 0, 0, 0, 1, 0, half, 0, half };
    square_bin bin = make_square();
    memcpy(bin.more, turns, sizeof turns);
    gltf_asset *asset = open_text(json, &bin);
    CHECK_EQUAL(gltf_asset_mesh_count(asset), 2);
    for (uint32_t i = 0; i < 2; i++) {
        hemi_mesh_desc mesh;
        CHECK(gltf_asset_mesh(asset, i, &mesh));
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(mesh.transform[k], x_axis[i][k], 1e-7);
            CHECK_NEAR(mesh.transform[8 + k], z_axis[i][k], 1e-7); /* of floats */
        }
    }
    gltf_asset_destroy(asset);
}

static void lit_gpu_instances_become_nodes(void) {
    square_bin bin = make_copies();
    gltf_asset *asset = open_text(instanced_json, &bin);
    cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
    const cJSON *nodes = get(json, "nodes"), *parent = item(nodes, 0), *child;
    CHECK_EQUAL(cJSON_GetArraySize(nodes), 5);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "meshes")), 4);
    CHECK(get(parent, "mesh") == NULL);
    CHECK(get(parent, "extensions") == NULL);
    CHECK(get(json, "extensionsRequired") == NULL);
    CHECK_EQUAL(cJSON_GetArraySize(get(parent, "children")), 3);
    int i = 0;
    cJSON_ArrayForEach(child, get(parent, "children")) {
        const cJSON *node = item(nodes, child->valueint);
        CHECK_NEAR(item(get(node, "matrix"), 12)->valuedouble, ++i, 0);
        CHECK(cJSON_IsNumber(get(node, "mesh")));
        CHECK(get(node, "extras") == NULL);
    }
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
}

static void kept_instances_share_one_mesh(void) {
    square_bin bin = make_copies();
    gltf_asset *asset = open_text(instanced_json, &bin);
    cJSON *json = bake_grey(asset, (gltf_write_desc){ .keep_instances = true, .draco = true, .draco_level = 5 }, NULL);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "nodes")), 2);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "meshes")), 1);
    CHECK_EQUAL(get(item(get(json, "nodes"), 0), "mesh")->valueint, 0);
    CHECK_EQUAL(get(item(get(json, "nodes"), 1), "mesh")->valueint, 0);
    const cJSON *extension = get(get(item(get(json, "nodes"), 0), "extensions"), "EXT_mesh_gpu_instancing");
    int translation = get(get(extension, "attributes"), "TRANSLATION")->valueint;
    CHECK_EQUAL(get(item(get(json, "accessors"), translation), "count")->valueint, 3);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "extensionsRequired")), 2);
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
}

static void other_scenes_pass_through_and_are_named(void) {
    square_bin bin = make_copies();
    char *text =
        fixture_replace(instanced_json, "\"scenes\":[{\"nodes\":[0,1]}]",
                        "\"scene\":1,\"scenes\":[{\"nodes\":[0],\"name\":\"\xC3\xA9t\xC3\xA9\"},{\"nodes\":[1]}]");
    gltf_asset *asset = open_text(text, &bin);
    CHECK_EQUAL(gltf_asset_mesh_count(asset), 1);
    CHECK_EQUAL(gltf_asset_skipped_count(asset), 1);
    CHECK_TEXT(gltf_asset_skipped(asset, 0),
               "scene 0 \"\xC3\xA9t\xC3\xA9\": not baked, another scene is; --scene bakes one by its "
               "name or number, or all");
    cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
    const cJSON *node = item(get(json, "nodes"), 0);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "meshes")), 2);
    CHECK_EQUAL(get(node, "mesh")->valueint, 0);
    CHECK(get(get(node, "extensions"), "EXT_mesh_gpu_instancing") != NULL);
    const cJSON *primitive = item(get(item(get(json, "meshes"), 0), "primitives"), 0);
    CHECK(get(get(primitive, "attributes"), "COLOR_0") == NULL);
    CHECK_TEXT(get(item(get(json, "scenes"), 0), "name")->valuestring, "\xC3\xA9t\xC3\xA9");
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
    free(text);
}

static void mutated_instanced_scenes_do_no_harm(void) {
    square_bin bin = make_copies();
    mutate(instanced_json, &bin, sizeof bin, 3000);
}

static void broken_instancing_is_refused_by_its_place(void) {
    static const char *const bad[][2] = { { "\"TRANSLATION\":2", "\"TRANSLATION\":9" },
                                          { "\"TRANSLATION\":2", "\"TRANSLATION\":1" },
                                          { "\"TRANSLATION\":2", "\"TRANSLATION\":\"x\"" },
                                          { "{\"attributes\":{\"TRANSLATION\":2,\"SCALE\":3}}", "{}" },
                                          { "\"SCALE\":3", "\"SCALE\":0" } };
    square_bin bin = make_copies();
    char message[GLTF_MESSAGE_SIZE];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char *text = fixture_replace(instanced_json, bad[i][0], bad[i][1]);
        gltf_asset *asset = NULL;
        CHECK_EQUAL(fixture_read(text, &bin, sizeof bin, &asset, message), HEMI_ERROR_DATA);
        CHECK(strstr(message, "nodes[0].extensions.EXT_mesh_gpu_instancing") != NULL);
        gltf_asset_destroy(asset);
        free(text);
    }
    bin.more[3] = 0x7F, bin.more[2] = 0x80; /* infinity */
    gltf_asset *asset = NULL;
    CHECK_EQUAL(fixture_read(instanced_json, &bin, sizeof bin, &asset, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "TRANSLATION") != NULL);
}

/* ---- what nobody here knows -------------------------------------------------------------------------------------- */

static const char unknown_text[] = "{\"HEMI_made_up\":{\"exact\":0.10,\"large\":12345678901234567890,\"tiny\":1e-3,"
                                   "\"one\":1.0,\"escaped\":\"\\u00e9\\/\",\"list\":[1,2.50,null,{}]}}";

static void unknown_extensions_and_extras_survive_byte_for_byte(void) {
    static const char *const places[][2] = {
        { "\"scenes\":[{", "\"scenes\":[{\"%s\":%s," },
        { "{\"name\":\"tree\"", "{\"%s\":%s,\"name\":\"tree\"" },
        { "\"meshes\":[{", "\"meshes\":[{\"%s\":%s," },
        { "\"primitives\":[{", "\"primitives\":[{\"%s\":%s," },
        { "\"asset\":{", "\"%s\":%s,\"asset\":{" },
        { "\"accessors\":[{\"bufferView\":0",
          "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.10},"
          "\"%s\":%s}],\"accessors\":[{\"bufferView\":0" },
        { "\"accessors\":[{\"bufferView\":0", "\"materials\":[{\"%s\":%s}],\"accessors\":[{\"bufferView\":0" },
        { "\"accessors\":[{\"bufferView\":0", "\"samplers\":[{\"%s\":%s}],\"accessors\":[{\"bufferView\":0" },
    };
    static const char *const names[] = { "extensions", "extras" };
    square_bin bin = make_copies();
    for (size_t i = 0; i < 2 * sizeof places / sizeof *places; i++) {
        char replacement[2048];
        sprintf(replacement, places[i / 2][1], names[i % 2], unknown_text);
        char *text = fixture_replace(instanced_json, places[i / 2][0], replacement);
        gltf_asset *asset = open_text(text, &bin);
        gltf_output out;
        gltf_chunks chunks;
        char message[GLTF_MESSAGE_SIZE], *found = NULL;
        cJSON_Delete(bake_grey(asset, (gltf_write_desc){ 0 }, &out));
        gltf_container_split(out.main, out.main_size, &chunks, message);
        char *written = malloc(chunks.json_size + 1);
        memcpy(written, chunks.json, chunks.json_size);
        written[chunks.json_size] = 0;
        found = strstr(written, unknown_text);
        CHECK(found != NULL);
        if (!found) fprintf(stderr, "  lost: %s %s\n", names[i % 2], places[i / 2][0]);
        free(written);
        free(text);
        gltf_output_free(&out);
        gltf_asset_destroy(asset);
    }
}

static void numbers_stay_where_an_unknown_extension_may_know_them(void) {
    square_bin bin = make_copies();
    char *text = fixture_replace(instanced_json, "\"extensionsUsed\":[", "\"extensionsUsed\":[\"HEMI_made_up\",");
    gltf_asset *asset = open_text(text, &bin);
    cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
    const int counts[] = { 4, 6, 3, 3 };
    for (int i = 0; i < 4; i++) CHECK_EQUAL(get(item(get(json, "accessors"), i), "count")->valueint, counts[i]);
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
    free(text);
}

/* ---- textures ---------------------------------------------------------------------------------------------------- */

/* Texture 0 glows, 1 colours, 2 was never used; the square has texture coordinates in its positions' bytes. */
static const char textured_json[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
    "\"extensionsUsed\":[\"KHR_texture_transform\"],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_1\":2},\"indices\":1,\"material\":0}]}],"
    "\"materials\":[{\"emissiveTexture\":{\"index\":0},\"emissiveFactor\":[1,1,1],\"pbrMetallicRoughness\":{"
    "\"baseColorTexture\":{\"index\":1,\"texCoord\":1,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2.50,1.0]}}"
    "}}}],"
    "\"textures\":[{\"source\":0},{\"source\":1,\"name\":\"paint\"},{\"source\":0,\"name\":\"spare\"}],"
    "\"images\":[{\"bufferView\":2,\"mimeType\":\"image/png\"},{\"bufferView\":2,\"mimeType\":\"image/png\"}],"
    "\"accessors\":[" SQUARE_ACCESSORS ",{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}],"
    "\"bufferViews\":[" SQUARE_VIEWS ",{\"buffer\":0,\"byteOffset\":64,\"byteLength\":8}],"
    "\"buffers\":[{\"byteLength\":576}]}";

static void textures_that_only_the_old_material_used_go(void) {
    square_bin bin = make_square();
    memcpy(bin.more, "\x89PNG\r\n\x1a\n", 8);
    gltf_asset *asset = open_text(textured_json, &bin);
    cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
    const cJSON *pbr = get(item(get(json, "materials"), 0), "pbrMetallicRoughness"),
                *info = get(pbr, "baseColorTexture");
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "textures")), 2);
    CHECK_TEXT(get(item(get(json, "textures"), 0), "name")->valuestring, "paint");
    CHECK_EQUAL(get(info, "index")->valueint, 0);
    CHECK_EQUAL(get(info, "texCoord")->valueint, 1);
    CHECK_NEAR(item(get(get(get(info, "extensions"), "KHR_texture_transform"), "scale"), 0)->valuedouble, 2.5, 0);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "images")),
                2); /* the spare texture, which nothing used before, needs both */
    cJSON_Delete(json);
    json = bake_grey(asset, (gltf_write_desc){ .keep_materials = true }, NULL);
    CHECK_EQUAL(cJSON_GetArraySize(get(json, "textures")), 3);
    CHECK(get(item(get(json, "materials"), 0), "emissiveTexture") != NULL);
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
}

static void an_image_of_another_type_than_it_says_passes_with_a_word(void) {
    square_bin bin = make_square();
    memcpy(bin.more, "\xFF\xD8\xFF\xE0JFIF", 8);
    gltf_asset *asset = open_text(textured_json, &bin);
    CHECK_EQUAL(gltf_asset_skipped_count(asset), 2);
    CHECK(strstr(gltf_asset_skipped(asset, 0), "images[0].mimeType is \"image/png\", but its bytes are image/jpeg") !=
          NULL);
    cJSON *json = bake_grey(asset, (gltf_write_desc){ 0 }, NULL);
    CHECK_TEXT(get(item(get(json, "images"), 0), "mimeType")->valuestring, "image/png");
    cJSON_Delete(json);
    gltf_asset_destroy(asset);
}

/* ---- Draco ---- */

/* Of what Draco is told of the grid on which positions lie digits are lost that a millionth of a unit has. */
static const float WALL[12] = { -7.77f, 0.3f, 1.1f, -3.64f, 0.3f, 1.1f, -3.64f, 3.01f, 1.1f, -7.77f, 3.01f, 1.1f };
static const float CEILING[12] = {
    -7.77f, 3.01f, 1.1f, -3.64f, 3.01f, 1.1f, -3.64f, 3.01f, -1.7f, -7.77f, 3.01f, -1.7f
};

static bool is_vertex_of(const hemi_mesh_desc *m, const float at[3]) {
    for (uint32_t v = 0; v < m->vertex_count; v++)
        if (memcmp(m->positions + 3 * (size_t)v, at, 3 * sizeof *at) == 0) return true;
    return false;
}

static void meshes_that_meet_do_so_after_draco(void) {
    const float sizes[] = { 1.0f, 3e-7f };
    for (int s = 0; s < 2; s++) {
        square_bin bin = make_square();
        for (int i = 0; i < 12; i++) {
            float place = sizes[s] * CEILING[i];
            bin.positions[i] = sizes[s] * WALL[i];
            memcpy(bin.more + 4 * i, &place, sizeof place);
        }
        gltf_asset *asset =
            open_text("{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"
                      "\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"meshes\":[{\"primitives\":[{" SQUARE_PRIMITIVE
                      "}]},{\"primitives\":[{\"attributes\":{\"POSITION\":2},\"indices\":1}]}],"
                      "\"accessors\":[" SQUARE_ACCESSORS
                      ",{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
                      "\"max\":[1,1,1]}],\"bufferViews\":[" SQUARE_VIEWS
                      ",{\"buffer\":0,\"byteOffset\":64,\"byteLength\":48}],\"buffers\":[{\"byteLength\":576}]}",
                      &bin);
        gltf_output out;
        cJSON_Delete(bake_grey(asset, (gltf_write_desc){ .draco = true, .draco_level = 7 }, &out));
        fixture_write("out.glb", out.main, out.main_size);
        gltf_asset *again = NULL;
        CHECK_EQUAL(gltf_asset_read(fixture_path("out.glb"), &again, NULL), HEMI_OK);
        fixture_remove("out.glb");
        hemi_mesh_desc wall, ceiling;
        CHECK(gltf_asset_mesh(again, 0, &wall) && gltf_asset_mesh(again, 1, &ceiling));
        uint32_t met = 0;
        for (uint32_t v = 0; v < wall.vertex_count; v++) met += is_vertex_of(&ceiling, wall.positions + 3 * (size_t)v);
        CHECK_EQUAL(met, 2);
        CHECK(out.max_position_error <= (double)sizes[s] * sqrt(3) * 0.5 * 4.13 / 16383);
        gltf_output_free(&out);
        gltf_asset_destroy(again);
        gltf_asset_destroy(asset);
    }
}

int main(void) {
    RUN(meshopt_views_read_as_what_was_packed);
    RUN(octahedral_normals_are_unpacked);
    RUN(broken_meshopt_views_are_refused_by_their_place);
    RUN(mutated_packed_scenes_do_no_harm);
    RUN(mutated_instanced_scenes_do_no_harm);
    RUN(every_gpu_instance_is_a_mesh);
    RUN(gpu_instances_turn_by_their_quaternions);
    RUN(lit_gpu_instances_become_nodes);
    RUN(kept_instances_share_one_mesh);
    RUN(other_scenes_pass_through_and_are_named);
    RUN(broken_instancing_is_refused_by_its_place);
    RUN(unknown_extensions_and_extras_survive_byte_for_byte);
    RUN(numbers_stay_where_an_unknown_extension_may_know_them);
    RUN(textures_that_only_the_old_material_used_go);
    RUN(an_image_of_another_type_than_it_says_passes_with_a_word);
    RUN(meshes_that_meet_do_so_after_draco);
    fixture_clean();
    return check_end();
}
