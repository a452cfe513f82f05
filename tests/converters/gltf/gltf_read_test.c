/* SPDX-License-Identifier: MIT
 * Does gltf_asset_read list what the scene holds: meshes, transforms, materials, cameras, and what is not baked?
 */
#include "gltf_fixture.h"

static void the_scene_is_listed(void) {
    gltf_asset *asset = fixture_open_scene();
    if (!asset) return;
    hemi_mesh_desc mesh;
    CHECK_EQUAL(gltf_asset_mesh_count(asset), 2);
    CHECK(gltf_asset_mesh(asset, 0, &mesh));
    CHECK_TEXT(mesh.name, "floor");
    CHECK_EQUAL(mesh.vertex_count, 4);
    CHECK_EQUAL(mesh.triangle_count, 2);
    CHECK_EQUAL(mesh.attribute_count, 5); /* TEXCOORD_0, then COLOR_0 */
    CHECK_EQUAL(mesh.material, 0);
    CHECK_NEAR(mesh.positions[3 * 2 + 0], 1, 0);
    CHECK_NEAR(mesh.normals[3 * 3 + 1], 1, 0);
    CHECK_NEAR(mesh.attributes[5 * 1 + 1], 1, 0);
    CHECK_NEAR(mesh.transform[0], 2, 0);
    CHECK_NEAR(mesh.transform[14], 3, 0);
    CHECK(gltf_asset_mesh(asset, 1, &mesh));
    CHECK_TEXT(mesh.name, "floor again");
    CHECK_NEAR(mesh.transform[0], 1, 0);
    CHECK(!gltf_asset_mesh(asset, 2, &mesh));
    CHECK(gltf_asset_mesh_radiosity(asset, 0) == NULL);
    CHECK_NEAR(gltf_asset_mesh_color(asset, 0)[2], 0.2, 1e-7); /* 51 of 255, in float */
    gltf_asset_destroy(asset);
}

static bool skips(const gltf_asset *asset, const char *line) {
    for (size_t i = 0; i < gltf_asset_skipped_count(asset); i++)
        if (strcmp(gltf_asset_skipped(asset, i), line) == 0) return true;
    return false;
}

static void what_is_not_baked_is_named_with_its_reason(void) {
    gltf_asset *asset = fixture_open_scene();
    if (!asset) return;
    CHECK_EQUAL(gltf_asset_skipped_count(asset), 3); /* one line a kind */
    CHECK(skips(asset, "node 1 \"floor\", primitive 1 and 2 more: not baked, not made of triangles"));
    CHECK(skips(asset, "node 3 \"mover\": not baked, animated"));
    CHECK(skips(asset, "node 6 \"puppet\": not baked, skinned"));
    CHECK(gltf_asset_skipped(asset, 3) == NULL);
    gltf_asset_destroy(asset);
}

static void children_of_animated_nodes_are_not_baked(void) {
    fixture_bin bin = fixture_make_bin();
    char *base = fixture_make_json();
    char *json = fixture_replace(base, "\"target\":{\"node\":3", "\"target\":{\"node\":0");
    gltf_asset *asset = fixture_open(json, &bin, sizeof bin);
    if (asset) CHECK_EQUAL(gltf_asset_mesh_count(asset), 0);
    gltf_asset_destroy(asset);
    free(json);
    free(base);
}

static void materials_reflect_and_emit_as_lambert_surfaces(void) {
    gltf_asset *asset = fixture_open_scene();
    if (!asset) return;
    hemi_material_desc material;
    CHECK_EQUAL(gltf_asset_material_count(asset), 4);
    CHECK(gltf_asset_material(asset, 0, &material));
    CHECK_TEXT(material.name, "glow");
    CHECK_NEAR(material.reflectance[0], 0.6, 1e-15); /* 0.8 (1 - 0.5 + 0.5 / 2), in double */
    CHECK_NEAR(material.emission[1], 2, 0);
    CHECK(material.double_sided);
    CHECK(gltf_asset_material(asset, 3, &material)); /* glTF's default: a white metal of roughness 1 */
    CHECK_NEAR(material.reflectance[0], 0.5, 0);
    gltf_asset_set_metals(asset, GLTF_METALS_BLACK);
    CHECK(gltf_asset_material(asset, 3, &material));
    CHECK_NEAR(material.reflectance[0], 0, 0);
    CHECK(gltf_asset_material(asset, 0, &material));
    CHECK_NEAR(material.reflectance[0], 0.4, 1e-15);
    CHECK(!gltf_asset_material(asset, 4, &material));
    gltf_asset_destroy(asset);
}

static void cameras_stand_in_the_world(void) {
    gltf_asset *asset = fixture_open_scene();
    if (!asset) return;
    gltf_camera camera;
    CHECK_EQUAL(gltf_asset_camera_count(asset), 1);
    CHECK(gltf_asset_camera(asset, 0, &camera));
    CHECK_TEXT(camera.name, "eye");
    CHECK_NEAR(camera.yfov, 0.75, 0);
    CHECK_NEAR(camera.eye[1], 2, 0);
    /* a quarter turn about y sends -z to -x; 1e-15 is the rounding of the quaternion */
    CHECK_NEAR(camera.target[0] - camera.eye[0], -1, 1e-15);
    CHECK_NEAR(camera.target[2] - camera.eye[2], 0, 1e-15);
    CHECK_NEAR(camera.up[1], 1, 1e-15);
    CHECK(!gltf_asset_camera(asset, 1, &camera));
    gltf_asset_destroy(asset);
}

/* ---- accessors ------------------------------------------------------------------------------------------------ */

/* One mesh at one node, with the members of its primitive, accessors and buffer views as given. */
static gltf_asset *open_primitive(const char *primitive, const char *accessors, const char *views, const void *bin,
                                  size_t size) {
    char json[4096];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_mesh_quantization\"],"
             "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"nodes\":[{\"mesh\":0}],"
             "\"meshes\":[{\"name\":\"shape\",\"primitives\":[{%s}]}],\"accessors\":[%s],\"bufferViews\":[%s],"
             "\"buffers\":[{\"byteLength\":%zu}]}",
             primitive, accessors, views, size);
    return fixture_open(json, bin, size);
}

/* Three vertices whose first component is 0, 1 and `one` in the given type. */
static void check_positions(int type, bool normalized, size_t component, const void *bin, size_t size,
                            double expected) {
    char accessors[256], views[256];
    snprintf(accessors, sizeof accessors,
             "{\"bufferView\":0,\"componentType\":%d,\"count\":3,\"type\":\"VEC3\",\"normalized\":%s}", type,
             normalized ? "true" : "false");
    snprintf(views, sizeof views, "{\"buffer\":0,\"byteLength\":%zu,\"byteStride\":%zu}", size, component * 4);
    gltf_asset *asset = open_primitive("\"attributes\":{\"POSITION\":0}", accessors, views, bin, size);
    hemi_mesh_desc mesh;
    bool read = asset && gltf_asset_mesh(asset, 0, &mesh);
    CHECK(read);
    if (!read) return;
    CHECK_TEXT(mesh.name, "shape");
    CHECK_NEAR(mesh.positions[3], expected, 1e-7); /* float */
    CHECK_NEAR(mesh.positions[4], 0, 0);
    CHECK_NEAR(mesh.positions[6 + 2], -expected, type == 5121 || type == 5123 ? 1e9 : 1e-7);
    gltf_asset_destroy(asset);
}

static void positions_are_read_from_every_component_type(void) {
    const int8_t bytes[12] = { 0, 0, 0, 9, 127, 0, 0, 9, 0, 0, -127, 9 };
    const uint8_t ubytes[12] = { 0, 0, 0, 9, 255, 0, 0, 9, 0, 0, 1, 9 };
    const int16_t shorts[12] = { 0, 0, 0, 9, 32767, 0, 0, 9, 0, 0, -32767, 9 };
    const uint16_t ushorts[12] = { 0, 0, 0, 9, 65535, 0, 0, 9, 0, 0, 1, 9 };
    const float floats[12] = { 0, 0, 0, 9, 0.25f, 0, 0, 9, 0, 0, -0.25f, 9 };
    check_positions(5120, true, 1, bytes, sizeof bytes, 1);
    check_positions(5120, false, 1, bytes, sizeof bytes, 127);
    check_positions(5121, true, 1, ubytes, sizeof ubytes, 1);
    check_positions(5121, false, 1, ubytes, sizeof ubytes, 255);
    check_positions(5122, true, 2, shorts, sizeof shorts, 1);
    check_positions(5122, false, 2, shorts, sizeof shorts, 32767);
    check_positions(5123, true, 2, ushorts, sizeof ushorts, 1);
    check_positions(5123, false, 2, ushorts, sizeof ushorts, 65535);
    check_positions(5126, false, 4, floats, sizeof floats, 0.25);
}

static void the_most_negative_normalised_integer_is_minus_one(void) {
    const int8_t bytes[12] = { -128, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0 };
    gltf_asset *asset =
        open_primitive("\"attributes\":{\"POSITION\":0}",
                       "{\"bufferView\":0,\"componentType\":5120,\"count\":3,\"type\":\"VEC3\",\"normalized\":true}",
                       "{\"buffer\":0,\"byteLength\":12,\"byteStride\":4}", bytes, sizeof bytes);
    hemi_mesh_desc mesh;
    bool read = asset && gltf_asset_mesh(asset, 0, &mesh);
    CHECK(read);
    if (read) CHECK_NEAR(mesh.positions[0], -1, 0);
    gltf_asset_destroy(asset);
}

typedef struct sparse_bin {
    float base[9];
    uint16_t index, padding;
    float value[3];
} sparse_bin;

static void sparse_accessors_replace_elements_of_their_base(void) {
    const sparse_bin bin = { { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, 2, 0, { 5, 6, 7 } };
    const char *views = "{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":2},"
                        "{\"buffer\":0,\"byteOffset\":40,\"byteLength\":12}";
    const char *sparse = "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":"
                         "{\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":2}}}";
    for (int based = 0; based < 2; based++) { /* without a base, the rest is zero */
        char accessor[512];
        snprintf(accessor, sizeof accessor, "{%s%s", based ? "\"bufferView\":0," : "", sparse);
        gltf_asset *asset = open_primitive("\"attributes\":{\"POSITION\":0}", accessor, views, &bin, sizeof bin);
        hemi_mesh_desc mesh;
        bool read = asset && gltf_asset_mesh(asset, 0, &mesh);
        CHECK(read);
        if (read) {
            CHECK_NEAR(mesh.positions[3], based, 0);
            CHECK_NEAR(mesh.positions[8], 7, 0);
        }
        gltf_asset_destroy(asset);
    }
}

/* ---- modes ---------------------------------------------------------------------------------------------------- */

static void check_mode(int mode, int component_type, const void *indices, size_t count, const char *expected) {
    static uint8_t bin[60 + 64];
    const float positions[15] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0 };
    size_t size = component_type == 5121 ? 1 : component_type == 5123 ? 2 : 4;
    memcpy(bin, positions, sizeof positions);
    memcpy(bin + 60, indices, count * size);
    char primitive[128], accessors[512];
    snprintf(primitive, sizeof primitive, "\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":%d", mode);
    snprintf(accessors, sizeof accessors,
             "{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"},"
             "{\"bufferView\":1,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\"}",
             component_type, count);
    gltf_asset *asset = open_primitive(
        primitive, accessors, "{\"buffer\":0,\"byteLength\":60},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":64}",
        bin, sizeof bin);
    hemi_mesh_desc mesh;
    if (!asset || !gltf_asset_mesh(asset, 0, &mesh)) return;
    char text[64] = "", *at = text;
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++) at += sprintf(at, "%u", mesh.indices[i]);
    CHECK_TEXT(text, expected);
    gltf_asset_destroy(asset);
}

static void strips_and_fans_become_triangles(void) {
    const uint8_t bytes[5] = { 0, 1, 2, 3, 4 };
    const uint16_t shorts[5] = { 0, 1, 2, 3, 4 };
    const uint32_t words[6] = { 0, 1, 2, 2, 1, 3 };
    check_mode(5, 5121, bytes, 5, "012132234"); /* odd triangles of a strip turn round */
    check_mode(6, 5123, shorts, 5, "012023034");
    check_mode(4, 5125, words, 6, "012213");
}

/* ---- containers ----------------------------------------------------------------------------------------------- */

static void a_gltf_with_an_external_bin_reads_as_the_glb_does(void) {
    fixture_bin bin = fixture_make_bin();
    char message[GLTF_MESSAGE_SIZE], *base = fixture_make_json();
    char *json = fixture_replace(base, "\"buffers\":[{", "\"buffers\":[{\"uri\":\"my%20da+ta%2.bin\",");
    gltf_asset *asset = NULL;
    fixture_write("scene.gltf", json, strlen(json));
    CHECK_EQUAL(gltf_asset_read(fixture_path("scene.gltf"), &asset, message), HEMI_ERROR_FILE);
    CHECK(strstr(message, "my da+ta%2.bin") != NULL);
    uint8_t longer[sizeof bin + 5]; /* a file may have more than byteLength bytes */
    memcpy(longer, &bin, sizeof bin);
    fixture_write("my da+ta%2.bin", longer, sizeof longer);
    CHECK_EQUAL(gltf_asset_read(fixture_path("scene.gltf"), &asset, message), HEMI_OK);
    CHECK_TEXT(message, "");
    if (asset) CHECK_EQUAL(gltf_asset_mesh_count(asset), 4); /* with what moves */
    gltf_asset_destroy(asset);
    fixture_remove("scene.gltf");
    fixture_remove("my da+ta%2.bin");
    free(json);
    free(base);
}

static void data_uris_of_any_media_type_are_read(void) {
    /* nine floats: 0 0 0, 1 0 0, 0 1 0 */
    static const char *const types[] = { "application/octet-stream", "application/gltf-buffer", "", "model/odd" };
    for (size_t i = 0; i < 4; i++) {
        char json[1024], message[GLTF_MESSAGE_SIZE];
        gltf_asset *asset = NULL;
        snprintf(json, sizeof json,
                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{"
                 "\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
                 "\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{"
                 "\"byteLength\":36,\"uri\":\"data:%s;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}",
                 types[i]);
        fixture_write("data.gltf", json, strlen(json));
        CHECK_EQUAL(gltf_asset_read(fixture_path("data.gltf"), &asset, message), HEMI_OK);
        hemi_mesh_desc mesh;
        if (asset && gltf_asset_mesh(asset, 0, &mesh)) CHECK_NEAR(mesh.positions[3 * 2 + 1], 1, 0);
        gltf_asset_destroy(asset);
        fixture_remove("data.gltf");
    }
}

int main(void) {
    RUN(the_scene_is_listed);
    RUN(what_is_not_baked_is_named_with_its_reason);
    RUN(children_of_animated_nodes_are_not_baked);
    RUN(materials_reflect_and_emit_as_lambert_surfaces);
    RUN(cameras_stand_in_the_world);
    RUN(positions_are_read_from_every_component_type);
    RUN(the_most_negative_normalised_integer_is_minus_one);
    RUN(sparse_accessors_replace_elements_of_their_base);
    RUN(strips_and_fans_become_triangles);
    RUN(a_gltf_with_an_external_bin_reads_as_the_glb_does);
    RUN(data_uris_of_any_media_type_are_read);
    fixture_clean();
    return check_end();
}
