/* SPDX-License-Identifier: MIT
 * Does a malformed file end in one clear message, whatever is wrong with it? Under the sanitizers this is also the
 * proof that nothing is read out of bounds.
 */
#include "gltf_fixture.h"

/* ---- one thing wrong -------------------------------------------------------------------------------------------- */

/* The scene of the fixture with `find` replaced, which must fail with `code` and a message that holds `place`. */
typedef struct malformed {
    const char *find, *replacement;
    hemi_result code;
    const char *place;
} malformed;

#define SPARSE(count, view, type, values)                                                                              \
    "\"count\":4,\"sparse\":{\"count\":" count ",\"indices\":{\"bufferView\":" view ",\"componentType\":" type         \
    "},\"values\":{" values "}}"

static const malformed table[] = {
    { "\"count\":4", SPARSE("5", "11", "5123", "\"bufferView\":0"), HEMI_ERROR_DATA, "accessors[0].sparse.count" },
    { "\"count\":4", SPARSE("0", "11", "5123", "\"bufferView\":0"), HEMI_ERROR_DATA, "accessors[0].sparse.count" },
    { "\"count\":4", SPARSE("-1", "11", "5123", "\"bufferView\":0"), HEMI_ERROR_DATA, "accessors[0].sparse.count" },
    { "\"count\":4", SPARSE("1", "99", "5123", "\"bufferView\":0"), HEMI_ERROR_DATA,
      "accessors[0].sparse.indices.bufferView is 99" },
    { "\"count\":4", SPARSE("1", "11", "5126", "\"bufferView\":0"), HEMI_ERROR_DATA,
      "accessors[0].sparse.indices.componentType" },
    { "\"count\":4", SPARSE("4", "2", "5125", "\"bufferView\":0"), HEMI_ERROR_DATA, "sparse index" },
    { "\"count\":4", SPARSE("4", "11", "5125", "\"bufferView\":0"), HEMI_ERROR_DATA, "accessors[0].sparse.indices" },
    { "\"count\":4", SPARSE("1", "11", "5123", "\"bufferView\":99"), HEMI_ERROR_DATA,
      "accessors[0].sparse.values.bufferView is 99" },
    { "\"count\":4", SPARSE("1", "11", "5123", "\"bufferView\":0,\"byteOffset\":40"), HEMI_ERROR_DATA,
      "accessors[0].sparse.values" },
    { "\"count\":4", SPARSE("1", "11", "5123", "\"byteOffset\":0"), HEMI_ERROR_DATA, "accessors[0].sparse lacks" },
    { "\"count\":4", "\"count\":4,\"sparse\":{\"count\":1}", HEMI_ERROR_DATA, "accessors[0].sparse" },
    { "\"count\":4", "\"count\":4,\"sparse\":[]", HEMI_ERROR_DATA, "accessors[0].sparse" },
    { "\"count\":4", "\"byteOffset\":2147483647,\"count\":4", HEMI_ERROR_DATA, "accessors[0]: 4 elements at offset" },
    { "\"count\":4", "\"byteOffset\":2147483648,\"count\":4", HEMI_ERROR_DATA, "accessors[0].byteOffset" },
    { "\"count\":4", "\"count\":2147483648", HEMI_ERROR_DATA, "accessors[0].count" },
    { "\"count\":4", "\"count\":4,\"count\":5", HEMI_ERROR_DATA, "accessors[0].count is there twice" },
    { "\"byteLength\":48", "\"byteLength\":2147483648", HEMI_ERROR_DATA, "bufferViews[0].byteLength" },
    { "\"byteLength\":48", "\"byteLength\":2147483647", HEMI_ERROR_DATA, "bufferViews[0] covers" },
    { "\"byteLength\":48", "\"byteLength\":0", HEMI_ERROR_DATA, "bufferViews[0] covers" },
    { "\"byteLength\":48", "\"byteLength\":48,\"byteStride\":2147483648", HEMI_ERROR_DATA,
      "bufferViews[0].byteStride" },
    { "\"byteLength\":48", "\"byteLength\":48,\"byteStride\":256", HEMI_ERROR_DATA, "accessors[0]" },
    { "\"byteOffset\":0,", "\"byteOffset\":2147483647,", HEMI_ERROR_DATA, "bufferViews[0] covers" },
    { "\"buffers\":[{\"byteLength\"", "\"buffers\":[{\"byteLength\":2147483648,\"length\"", HEMI_ERROR_DATA,
      "buffers[0].byteLength" },
    { "\"buffers\":[{\"byteLength\"", "\"buffers\":[{\"byteLength\":2147483647,\"length\"", HEMI_ERROR_DATA,
      "buffers[0].byteLength" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"data:text/plain,hello\",", HEMI_ERROR_DATA, "buffers[0].uri" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"data:;base64,%%%%\",", HEMI_ERROR_DATA, "buffers[0].uri" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"\",", HEMI_ERROR_DATA, "buffers[0].uri" },
    { "\"buffers\":", "\"bufers\":", HEMI_ERROR_DATA, "bufferViews[0].buffer is 0" },
    { "\"translation\":[1,2,3]", "\"translation\":[1e999,2,3]", HEMI_ERROR_DATA,
      "nodes[0].translation[0] is not finite" },
    { "\"emissiveFactor\":[1,", "\"emissiveFactor\":[-1e999,", HEMI_ERROR_DATA,
      "materials[0].emissiveFactor[0] is not finite" },
    { "\"emissiveStrength\":4", "\"emissiveStrength\":1e400", HEMI_ERROR_DATA, "emissiveStrength is not finite" },
    { "\"metallicFactor\":0.5", "\"metallicFactor\":NaN", HEMI_ERROR_DATA, "JSON" },
    { "\"yfov\":0.75", "\"yfov\":1e999", HEMI_ERROR_DATA, "cameras[0].perspective.yfov is not finite" },
    { "\"version\":\"2.0\"", "\"version\":\"1.0\"", HEMI_ERROR_UNSUPPORTED, "asset.version" },
    { "\"asset\":{\"version\":\"2.0\"", "\"asset\":{\"versio\":\"2.0\"", HEMI_ERROR_DATA, "asset.version" },
    { "\"scene\":0", "\"extensionsRequired\":[\"VENDOR_odd\"],\"scene\":0", HEMI_ERROR_UNSUPPORTED, "VENDOR_odd" },
    { "\"scene\":0", "\"scene\":1", HEMI_ERROR_DATA, "scene is 1" },
    { "\"scene\":0", "\"scene\":-1", HEMI_ERROR_DATA, "scene is not" },
    { "\"nodes\":[0]", "\"nodes\":[9]", HEMI_ERROR_DATA, "scenes[0].nodes[0]" },
    { "\"nodes\":[0]", "\"nodes\":[0,0]", HEMI_ERROR_DATA, "scenes[0].nodes[1]" },
    { "\"nodes\":[0]", "\"nodes\":[1]", HEMI_ERROR_DATA, "scenes[0].nodes[0]" },
    { "\"children\":[1,2", "\"children\":[1,99", HEMI_ERROR_DATA, "nodes[0].children[1] is 99" },
    { "\"children\":[1,2", "\"children\":[1,1", HEMI_ERROR_DATA, "nodes[0].children[1]" },
    { "\"children\":[1,2", "\"children\":[1,0.5", HEMI_ERROR_DATA, "nodes[0].children[1]" },
    { "\"children\":[1,2", "\"children\":[1,\"2\"", HEMI_ERROR_DATA, "nodes[0].children[1]" },
    { "\"children\":[1,2", "\"children\":[1,4294967298", HEMI_ERROR_DATA, "nodes[0].children[1]" },
    { "\"children\":[1,2", "\"children\":[0,1,2", HEMI_ERROR_DATA, "its own ancestor" },
    { "\"camera\":0", "\"camera\":0,\"children\":[0]", HEMI_ERROR_DATA, "its own ancestor" },
    { "\"camera\":0", "\"camera\":1", HEMI_ERROR_DATA, "nodes[5].camera is 1" },
    { "\"skin\":0", "\"skin\":3", HEMI_ERROR_DATA, "nodes[6].skin" },
    { "\"floor\",\"mesh\":0", "\"floor\",\"mesh\":7", HEMI_ERROR_DATA, "nodes[1].mesh is 7" },
    { "\"floor\",\"mesh\":0", "\"floor\",\"mesh\":\"0\"", HEMI_ERROR_DATA, "nodes[1].mesh" },
    { "\"scale\":[2,2,2]", "\"scale\":[2,2]", HEMI_ERROR_DATA, "nodes[1].scale" },
    { "\"scale\":[2,2,2]", "\"matrix\":[1,0,0]", HEMI_ERROR_DATA, "nodes[1].matrix" },
    { "\"emissiveFactor\":[1,", "\"emissiveFactor\":[1e31,", HEMI_ERROR_DATA, "materials[0].emissiveFactor" },
    { "\"componentType\":5126", "\"componentType\":2147483647", HEMI_ERROR_DATA, "accessors[0].componentType is none" },
    { "\"scale\":[2,2,2]", "\"scale\":[1e200,1e200,1e200],\"children\":[8]", HEMI_ERROR_DATA, "nodes[" },
    { "\"POSITION\":0", "\"POSITION\":11", HEMI_ERROR_DATA, "meshes[0].primitives[0].attributes.POSITION is 11" },
    { "\"POSITION\":0", "\"POSITION\":2", HEMI_ERROR_DATA, "attributes.POSITION (accessors[2])" },
    { "\"POSITION\":0", "\"POSITION\":{}", HEMI_ERROR_DATA, "meshes[0].primitives[0].attributes.POSITION" },
    { "\"NORMAL\":1", "\"NORMAL\":6", HEMI_ERROR_DATA, "attributes.NORMAL has 2 elements" },
    { "\"COLOR_0\":4", "\"COLOR_0\":2", HEMI_ERROR_DATA, "attributes.COLOR_0" },
    { "\"indices\":3", "\"indices\":4", HEMI_ERROR_DATA, "meshes[0].primitives[0].indices" },
    { "\"indices\":3", "\"indices\":77", HEMI_ERROR_DATA, "meshes[0].primitives[0].indices" },
    { "\"indices\":3", "\"mode\":7,\"indices\":3", HEMI_ERROR_DATA, "meshes[0].primitives[0].mode" },
    { "\"attributes\":{\"POSITION\":0}", "\"attribute\":{}", HEMI_ERROR_DATA, "meshes[0].primitives[1].attributes" },
    { "\"material\":0", "\"material\":3", HEMI_ERROR_DATA, "meshes[0].primitives[0].material" },
    { "\"index\":0", "\"index\":5", HEMI_ERROR_DATA, "materials[0].pbrMetallicRoughness.baseColorTexture" },
    { "[0.8,0.4,0.2,1]", "[0.8,0.4,0.2]", HEMI_ERROR_DATA, "baseColorFactor" },
    { "\"emissiveFactor\":[1,", "\"emissiveFactor\":[1,1,", HEMI_ERROR_DATA,
      "materials[0].emissiveFactor is not three numbers" },
    { "\"source\":0", "\"source\":1", HEMI_ERROR_DATA, "textures[0].source" },
    { "\"sampler\":0}]", "\"sampler\":4}]", HEMI_ERROR_DATA, "textures[0].sampler" },
    { "\"bufferView\":7,", "\"bufferView\":70,", HEMI_ERROR_DATA, "images[0].bufferView is 70" },
    { "\"joints\":[8]", "\"joints\":[18]", HEMI_ERROR_DATA, "skins[0].joints" },
    { "\"inverseBindMatrices\":9", "\"inverseBindMatrices\":99", HEMI_ERROR_DATA, "skins[0].inverseBindMatrices" },
    { "\"node\":3", "\"node\":30", HEMI_ERROR_DATA, "animations[0].channels[0].target.node" },
    { "\"channels\":[{\"sampler\":0", "\"channels\":[{\"sampler\":2", HEMI_ERROR_DATA,
      "animations[0].channels[0].sampler" },
    { "\"input\":5", "\"input\":50", HEMI_ERROR_DATA, "animations[0].samplers[0].input" },
    { "\"output\":6", "\"output\":60", HEMI_ERROR_DATA, "animations[0].samplers[0].output" },
    { "\"bufferView\":0,", "\"bufferView\":12,", HEMI_ERROR_DATA, "accessors[0].bufferView is 12" },
    { "\"count\":4", "\"count\":5", HEMI_ERROR_DATA, "accessors[0]: 5 elements" },
    { "\"count\":4", "\"count\":2147483647", HEMI_ERROR_DATA, "accessors[0]" },
    { "\"count\":4", "\"count\":99999999999999", HEMI_ERROR_DATA, "accessors[0].count" },
    { "\"count\":4", "\"byteOffset\":4,\"count\":4", HEMI_ERROR_DATA, "accessors[0]" },
    { "\"componentType\":5126", "\"componentType\":5124", HEMI_ERROR_DATA, "accessors[0].componentType" },
    { "\"componentType\":5126", "\"componentType\":5130", HEMI_ERROR_DATA, "accessors[0].componentType" },
    { "\"componentType\":5126", "\"component\":1", HEMI_ERROR_DATA, "accessors[0].componentType" },
    { "\"type\":\"VEC3\"", "\"type\":\"VEC5\"", HEMI_ERROR_DATA, "accessors[0].type is none" },
    { "\"type\":\"VEC3\"", "\"type\":3", HEMI_ERROR_DATA, "accessors[0].type" },
    { "\"buffer\":0,", "\"buffer\":1,", HEMI_ERROR_DATA, "bufferViews[0].buffer is 1" },
    { "\"byteLength\":48", "\"byteLength\":4800", HEMI_ERROR_DATA, "bufferViews[0]" },
    { "\"byteLength\":48", "\"byteLength\":48,\"byteStride\":8", HEMI_ERROR_DATA, "byteStride" },
    { "\"byteLength\":48", "\"byteLength\":48,\"byteStride\":7", HEMI_ERROR_DATA, "byteStride" },
    { "\"buffers\":[{\"byteLength\"", "\"buffers\":[{\"length\"", HEMI_ERROR_DATA, "buffers[0].byteLength" },
    { "\"buffers\":[{\"byteLength\"", "\"buffers\":[{\"byteLength\":0,\"length\"", HEMI_ERROR_DATA,
      "buffers[0].byteLength" },
    { "\"buffers\":[{\"byteLength\"", "\"buffers\":[{\"byteLength\":99999,\"length\"", HEMI_ERROR_DATA, "byteLength" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"gone.bin\",", HEMI_ERROR_FILE, "gone.bin" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"/etc\",", HEMI_ERROR_FILE, "buffers" },
    { "\"buffers\":[{", "\"buffers\":[{\"uri\":\"data:;base64,AAAA\",", HEMI_ERROR_DATA, "uri" },
    { "\"meshes\":[{", "\"meshes\":[7,{", HEMI_ERROR_DATA, "meshes[0]" },
    { "\"meshes\":[", "\"meshes\":{\"a\":[", HEMI_ERROR_DATA, "" },
    { "\"skins\":[", "\"skins\":[[],", HEMI_ERROR_DATA, "skins[0]" },
    { "\"name\":\"room\"", "\"name\":\"\\ud800\"", HEMI_ERROR_DATA, "JSON" },
    { "}]}", "}]", HEMI_ERROR_DATA, "JSON" },
};

static void check_row(const malformed *row, const char *base, const fixture_bin *bin) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    char *json = fixture_replace(base, row->find, row->replacement);
    CHECK(json != NULL);
    if (!json) {
        fprintf(stderr, "  the scene does not hold %s\n", row->find);
        return;
    }
    hemi_result result = fixture_read(json, bin, sizeof *bin, &asset, message);
    CHECK_EQUAL(result, row->code);
    CHECK(asset == NULL);
    CHECK(strstr(message, row->place) != NULL);
    CHECK(message[0] && !strchr(message, '\n') && !strstr(message, "scene.glb"));
    if (result != row->code || !strstr(message, row->place))
        fprintf(stderr, "  %s -> %s: \"%s\"\n", row->find, row->replacement, message);
    gltf_asset_destroy(asset);
    free(json);
}

static void every_malformed_scene_fails_and_names_the_place(void) {
    fixture_bin bin = fixture_make_bin();
    char *base = fixture_make_json();
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) check_row(&table[i], base, &bin);
    free(base);
}

static void a_mesh_of_nothing_finite_is_refused(void) {
    const float bad[] = { NAN, INFINITY, -INFINITY };
    char *json = fixture_make_json(), message[GLTF_MESSAGE_SIZE];
    for (size_t i = 0; i < 3; i++) {
        fixture_bin bin = fixture_make_bin();
        gltf_asset *asset = NULL;
        for (size_t k = 0; k < 12; k++) bin.positions[k] = bad[i]; /* of one corner, only its triangles go */
        CHECK_EQUAL(fixture_read(json, &bin, sizeof bin, &asset, message), HEMI_ERROR_DATA);
        CHECK(strstr(message, "no whole triangle of finite corners") != NULL);
    }
    free(json);
}

static void indices_past_the_last_vertex_are_refused(void) {
    char *json = fixture_make_json(), message[GLTF_MESSAGE_SIZE];
    fixture_bin bin = fixture_make_bin();
    gltf_asset *asset = NULL;
    bin.quad[4] = 4;
    CHECK_EQUAL(fixture_read(json, &bin, sizeof bin, &asset, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "meshes[0].primitives[0].indices") != NULL);
    free(json);
}

/* ---- the file as a whole ---- */

static hemi_result read_bytes(const void *bytes, size_t size, char *message) {
    gltf_asset *asset = NULL;
    fixture_write("hostile.glb", bytes, size);
    hemi_result result = gltf_asset_read(fixture_path("hostile.glb"), &asset, message);
    gltf_asset_destroy(asset);
    fixture_remove("hostile.glb");
    return result;
}

static void files_that_are_not_gltf_say_so(void) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    CHECK_EQUAL(gltf_asset_read(fixture_path("no such file.glb"), &asset, message), HEMI_ERROR_FILE);
    CHECK_EQUAL(gltf_asset_read(fixture_folder(), &asset, message), HEMI_ERROR_FILE);
    CHECK_EQUAL(read_bytes("", 0, message), HEMI_ERROR_DATA);
    CHECK_EQUAL(read_bytes("# a picture", 11, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "not a glTF file") != NULL);
    CHECK_EQUAL(read_bytes("{}", 2, message), HEMI_ERROR_DATA);
    CHECK_EQUAL(read_bytes("glTF\1\0\0\0\14\0\0\0", 12, message), HEMI_ERROR_UNSUPPORTED);
}

static void deep_nesting_is_refused(void) {
    enum { DEPTH = 100000 };
    char *json = malloc(2 * DEPTH + 100), message[GLTF_MESSAGE_SIZE];
    int head = sprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"extras\":");
    for (int depth = 200; depth <= DEPTH; depth *= 500) {
        memset(json + head, '[', (size_t)depth);
        memset(json + head + depth, ']', (size_t)depth);
        json[head + 2 * depth] = '}';
        CHECK_EQUAL(read_bytes(json, (size_t)head + 2 * (size_t)depth + 1, message), HEMI_ERROR_DATA);
    }
    free(json);
}

static void a_truncated_glb_fails_at_every_length(void) {
    fixture_bin bin = fixture_make_bin();
    char *json = fixture_make_json(), message[GLTF_MESSAGE_SIZE];
    size_t size;
    uint8_t *glb = fixture_glb(json, &bin, sizeof bin, &size);
    int read_anyway = 0;
    for (size_t length = 0; length < size; length++) read_anyway += read_bytes(glb, length, message) == HEMI_OK;
    CHECK_EQUAL(read_anyway, 0);
    CHECK_EQUAL(read_bytes(glb, size, message), HEMI_OK);
    free(glb);
    free(json);
}

static uint32_t next_random(uint32_t *state) { /* xorshift32 */
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* Writes back whatever could be read, since writing trusts what reading let through. */
static void read_and_write(const uint8_t *bytes, size_t size, int *read, bool draco) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    gltf_output out;
    fixture_write("mutant.glb", bytes, size);
    hemi_result result = gltf_asset_read(fixture_path("mutant.glb"), &asset, message);
    CHECK(result == HEMI_OK ? message[0] == '\0' : message[0] != '\0');
    if (result != HEMI_OK) return;
    (*read)++;
    uint32_t count = gltf_asset_mesh_count(asset);
    gltf_baked_mesh *meshes = calloc(count + 1, sizeof *meshes);
    hemi_mesh_view *views = calloc(count + 1, sizeof *views);
    for (uint32_t i = 0; i < count; i += 2) { /* every other mesh stays as it is */
        hemi_mesh_desc mesh;
        gltf_asset_mesh(asset, i, &mesh);
        views[i] = (hemi_mesh_view){ sizeof views[i],
                                     mesh.vertex_count,
                                     mesh.triangle_count,
                                     mesh.indices,
                                     mesh.positions,
                                     NULL,
                                     NULL,
                                     NULL,
                                     NULL,
                                     NULL,
                                     NULL,
                                     0,
                                     NULL,
                                     0,
                                     NULL };
        meshes[i] = (gltf_baked_mesh){ &views[i], mesh.positions, NULL, NULL };
    }
    gltf_write_desc desc = { .binary = true, .meshes = meshes, .mesh_count = count, .draco = draco, .draco_level = 5 };
    result = gltf_asset_write(asset, &desc, &out, message);
    CHECK(result == HEMI_OK ? out.main != NULL : message[0] != '\0');
    gltf_output_free(&out);
    free(meshes);
    free(views);
    gltf_asset_destroy(asset);
}

static void mutate(const uint8_t *glb, size_t size, int rounds, bool draco) {
    uint8_t *mutant = malloc(size);
    uint32_t state = 1989;
    int read = 0;
    for (int i = 0; i < rounds; i++) {
        memcpy(mutant, glb, size);
        mutant[next_random(&state) % size] = (uint8_t)next_random(&state);
        read_and_write(mutant, size, &read, draco);
    }
    CHECK(read > 0 && read < rounds); /* some mutations harm and some do not, or this tests nothing */
    fixture_remove("mutant.glb");
    free(mutant);
}

static void mutated_scenes_do_no_harm(void) {
    fixture_bin bin = fixture_make_bin();
    char *json = fixture_make_json();
    size_t size;
    uint8_t *glb = fixture_glb(json, &bin, sizeof bin, &size);
    mutate(glb, size, 4000, false);
    free(glb);
    free(json);
}

static void mutated_draco_scenes_do_no_harm(void) {
    gltf_asset *asset = fixture_open_scene();
    char message[GLTF_MESSAGE_SIZE];
    gltf_output out;
    if (!asset) return;
    hemi_mesh_desc mesh;
    gltf_asset_mesh(asset, 0, &mesh);
    hemi_mesh_view view = { sizeof view,
                            mesh.vertex_count,
                            mesh.triangle_count,
                            mesh.indices,
                            mesh.positions,
                            NULL,
                            NULL,
                            NULL,
                            NULL,
                            NULL,
                            NULL,
                            0,
                            NULL,
                            0,
                            NULL };
    gltf_baked_mesh meshes[2] = { { &view, mesh.positions, mesh.positions, NULL },
                                  { &view, mesh.positions, NULL, NULL } };
    gltf_write_desc desc = { .binary = true, .meshes = meshes, .mesh_count = 2, .draco = true, .draco_level = 10 };
    CHECK_EQUAL(gltf_asset_write(asset, &desc, &out, message), HEMI_OK);
    mutate(out.main, out.main_size, 3000, true);
    gltf_output_free(&out);
    gltf_asset_destroy(asset);
}

int main(void) {
    RUN(every_malformed_scene_fails_and_names_the_place);
    RUN(a_mesh_of_nothing_finite_is_refused);
    RUN(indices_past_the_last_vertex_are_refused);
    RUN(files_that_are_not_gltf_say_so);
    RUN(deep_nesting_is_refused);
    RUN(a_truncated_glb_fails_at_every_length);
    RUN(mutated_scenes_do_no_harm);
    RUN(mutated_draco_scenes_do_no_harm);
    fixture_clean();
    return check_end();
}
