/* SPDX-License-Identifier: MIT
 * Does the public header stand alone in C++17, and can a C++ host bake with it?
 */
#include <hemibake/hemibake.h>

#include "check.h"

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace {

struct Release {
    void operator()(hemi_context *c) const { hemi_context_destroy(c); }
    void operator()(hemi_scene *s) const { hemi_scene_destroy(s); }
    void operator()(hemi_solution *s) const { hemi_solution_destroy(s); }
};

template <typename T> using handle = std::unique_ptr<T, Release>;

/* The descs are plain data: a host may zero them, copy them, and keep them in any container. */
static_assert(std::is_trivially_copyable<hemi_bake_desc>::value && std::is_standard_layout<hemi_bake_desc>::value, "");
static_assert(std::is_trivially_copyable<hemi_mesh_desc>::value && std::is_standard_layout<hemi_mesh_desc>::value, "");
static_assert(offsetof(hemi_mesh_desc, struct_size) == 0 && offsetof(hemi_material_desc, struct_size) == 0, "");
static_assert(offsetof(hemi_bake_desc, struct_size) == 0 && offsetof(hemi_context_desc, struct_size) == 0, "");

template <typename T> T sized() {
    T desc{};
    desc.struct_size = sizeof desc;
    return desc;
}

void a_cpp_host_bakes(void) {
    std::vector<float> corners{ 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
    std::vector<uint32_t> triangles{ 0, 1, 2, 0, 2, 3 };
    std::string log;
    auto context_desc = sized<hemi_context_desc>();
    context_desc.log = [](void *user, hemi_log_level, const char *text) { *static_cast<std::string *>(user) += text; };
    context_desc.log_user = &log;
    hemi_context *context = nullptr;
    CHECK_EQUAL(hemi_context_create(&context_desc, &context), HEMI_OK);
    handle<hemi_context> own_context(context);
    hemi_scene *scene = nullptr;
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    handle<hemi_scene> own_scene(scene);

    hemi_solution *solution = nullptr;
    CHECK_EQUAL(hemi_bake(scene, nullptr, &solution), HEMI_ERROR_NO_SURFACES);
    CHECK(!log.empty());

    auto material = sized<hemi_material_desc>();
    material.emission[0] = 4.0;
    uint32_t material_index = 9;
    CHECK_EQUAL(hemi_scene_add_material(scene, &material, &material_index), HEMI_OK);
    auto mesh = sized<hemi_mesh_desc>();
    mesh.positions = corners.data();
    mesh.vertex_count = 4;
    mesh.indices = triangles.data();
    mesh.triangle_count = 2;
    mesh.material = material_index;
    CHECK_EQUAL(hemi_scene_add_mesh(scene, &mesh, nullptr), HEMI_OK);
    /* What goes in has been copied. */
    corners.assign(12, 7.0f);
    triangles.assign(6, 99);

    auto bake = sized<hemi_bake_desc>();
    bake.quality = HEMI_QUALITY_DRAFT;
    int calls = 0;
    bake.progress = [](void *user, const hemi_progress *) { return ++*static_cast<int *>(user) > 0; };
    bake.progress_user = &calls;
    CHECK_EQUAL(hemi_bake(scene, &bake, &solution), HEMI_OK);
    handle<hemi_solution> own_solution(solution);
    CHECK(calls > 0);
    auto view = sized<hemi_mesh_view>();
    CHECK_EQUAL(hemi_solution_mesh(solution, 0, &view), HEMI_OK);
    /* Its own emission in red, nothing else; the solver's 1e-7 and floats. */
    for (uint32_t v = 0; v < view.vertex_count; v++) {
        CHECK_NEAR(view.radiance[3 * v], 4.0, 4e-5);
        CHECK_NEAR(view.radiance[3 * v + 1], 0.0, 0);
        CHECK(view.positions[3 * v] <= 1.0f);
    }
}

void results_are_an_enum_of_c(void) {
    hemi_result result = HEMI_CANCELLED;
    CHECK(std::string(hemi_result_text(result)).find("cancelled") == 0);
    CHECK_TEXT(hemi_version(), HEMI_VERSION_STRING);
}

} // namespace

int main() {
    RUN(a_cpp_host_bakes);
    RUN(results_are_an_enum_of_c);
    return check_end();
}
