/* SPDX-License-Identifier: MIT
 * Is every desc of an older header taken, and every one of a newer refused with a line that says why? Does every view
 * hold what its host knows of it? All in the same way.
 */
#include "check.h"

#include <hemibake/hemibake.h>

typedef struct host {
    hemi_context *context;
    hemi_scene *scene;
    int errors;
    char text[512];
} host;

static void listen(void *user, hemi_log_level level, const char *text) {
    host *h = user;
    h->errors += level == HEMI_LOG_ERROR;
    snprintf(h->text, sizeof h->text, "%s", text);
}

static void open_host(host *h) {
    memset(h, 0, sizeof *h);
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 1, .log = listen, .log_user = h };
    CHECK_EQUAL(hemi_context_create(&desc, &h->context), HEMI_OK);
    CHECK_EQUAL(hemi_scene_create(h->context, &h->scene), HEMI_OK);
    hemi_material_desc grey = { .struct_size = sizeof grey, .reflectance = { 0.5, 0.5, 0.5 } };
    CHECK_EQUAL(hemi_scene_add_material(h->scene, &grey, NULL), HEMI_OK);
}

static void close_host(host *h) {
    hemi_scene_destroy(h->scene);
    hemi_context_destroy(h->context);
}

/* ---- every desc as its function takes it ------------------------------------------------------------------------ */

typedef union any_desc {
    uint32_t struct_size;
    hemi_material_desc material;
    hemi_mesh_desc mesh;
    hemi_light_desc light;
    hemi_sky_desc sky;
    hemi_bake_desc bake;
    hemi_picture_desc picture;
    hemi_factors_desc factors;
    hemi_subdivision_desc subdivision;
    hemi_alpha_mask alpha_mask;
    unsigned char bytes[1024];
} any_desc;

static hemi_result give_material(host *h, const any_desc *d) {
    return hemi_scene_add_material(h->scene, &d->material, NULL);
}

static hemi_result give_mesh(host *h, const any_desc *d) {
    return hemi_scene_add_mesh(h->scene, &d->mesh, NULL);
}

static hemi_result give_light(host *h, const any_desc *d) {
    return hemi_scene_add_light(h->scene, &d->light, NULL);
}

static hemi_result give_sky(host *h, const any_desc *d) {
    return hemi_scene_set_sky(h->scene, &d->sky);
}

/* The scene is empty, so a bake that was understood finds no surfaces. */
static hemi_result give_bake(host *h, const any_desc *d) {
    hemi_solution *none = NULL;
    hemi_result result = hemi_bake(h->scene, &d->bake, &none);
    return result == HEMI_ERROR_NO_SURFACES ? HEMI_OK : result;
}

static hemi_result give_picture(host *h, const any_desc *d) {
    float pixel[4];
    hemi_result result = hemi_picture(h->context, &d->picture, pixel);
    return result == HEMI_ERROR_NO_SURFACES ? HEMI_OK : result;
}

static hemi_result give_factors(host *h, const any_desc *d) {
    hemi_factors factors = { .struct_size = sizeof factors };
    hemi_result result = hemi_factors_compute(h->context, &d->factors, &factors);
    if (result == HEMI_OK) hemi_factors_free(&factors);
    return result;
}

static hemi_result give_subdivision(host *h, const any_desc *d) {
    hemi_mesh_desc mesh = { .struct_size = sizeof mesh, .subdivision = &d->subdivision };
    return hemi_scene_add_mesh(h->scene, &mesh, NULL);
}

static hemi_result give_alpha_mask(host *h, const any_desc *d) {
    const float attributes[3] = { 0 };
    hemi_mesh_desc mesh = {
        .struct_size = sizeof mesh, .attributes = attributes, .attribute_count = 3, .alpha_mask = &d->alpha_mask
    };
    return hemi_scene_add_mesh(h->scene, &mesh, NULL);
}

#define THROUGH(type, field) (offsetof(type, field) + sizeof(((type *)0)->field))

/* least: through the last field that any header had; what is behind it is younger than the first release, or optional.
 */
static const struct kind {
    const char *name;
    hemi_result (*give)(host *h, const any_desc *d);
    size_t least, size;
} KINDS[] = {
    { "material", give_material, THROUGH(hemi_material_desc, emission), sizeof(hemi_material_desc) },
    { "mesh", give_mesh, THROUGH(hemi_mesh_desc, transform), sizeof(hemi_mesh_desc) },
    { "light", give_light, THROUGH(hemi_light_desc, direction), sizeof(hemi_light_desc) },
    { "sky", give_sky, THROUGH(hemi_sky_desc, radiance), sizeof(hemi_sky_desc) },
    { "bake", give_bake, THROUGH(hemi_bake_desc, quality), sizeof(hemi_bake_desc) },
    { "picture", give_picture, THROUGH(hemi_picture_desc, height), sizeof(hemi_picture_desc) },
    { "factors", give_factors, THROUGH(hemi_factors_desc, polygon_count), sizeof(hemi_factors_desc) },
    { "subdivision", give_subdivision, THROUGH(hemi_subdivision_desc, level), sizeof(hemi_subdivision_desc) },
    { "alpha mask", give_alpha_mask, THROUGH(hemi_alpha_mask, cutoff), sizeof(hemi_alpha_mask) },
};

enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

/* What its function accepts, of the size that is told, with rubbish behind it. */
static any_desc filled(const struct kind *k, size_t size) {
    static const double corners[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    static const int32_t triangle[4] = { 0, 1, 2, -1 };
    static const uint8_t alpha = 255;
    any_desc d = { .bytes = { 0 } };
    if (k->give == give_alpha_mask) d.alpha_mask.alpha = &alpha, d.alpha_mask.width = d.alpha_mask.height = 1;
    if (k->give == give_light) d.light.intensity[0] = 1;
    if (k->give == give_picture) d.picture.width = d.picture.height = 1;
    if (k->give == give_factors) {
        d.factors.positions = corners, d.factors.corners = triangle;
        d.factors.vertex_count = 3, d.factors.polygon_count = 1;
    }
    if (size < sizeof d.bytes) memset(d.bytes + size, 0xa5, sizeof d.bytes - size);
    d.struct_size = (uint32_t)size;
    return d;
}

static void an_older_desc_is_taken_and_nothing_behind_it_is_read(void) {
    host h;
    open_host(&h);
    for (int i = 0; i < KIND_COUNT; i++)
        for (size_t size = (KINDS[i].least + 3) / 4 * 4; size <= KINDS[i].size; size += 4) {
            any_desc d = filled(&KINDS[i], size);
            int errors = h.errors;
            hemi_result result = KINDS[i].give(&h, &d);
            if (result != HEMI_OK) fprintf(stderr, "%s of %zu bytes: %s\n", KINDS[i].name, size, h.text);
            CHECK_EQUAL(result, HEMI_OK);
            CHECK(h.errors <= errors + 1); /* "nothing to bake" */
        }
    close_host(&h);
}

static void other_sizes_are_refused_with_one_line(void) {
    host h;
    open_host(&h);
    for (int i = 0; i < KIND_COUNT; i++) {
        const size_t sizes[] = { 0, 4, KINDS[i].least - 4, KINDS[i].size + 4, KINDS[i].size - 1, UINT32_MAX };
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            any_desc d = filled(&KINDS[i], sizes[k]);
            int errors = h.errors;
            CHECK_EQUAL(KINDS[i].give(&h, &d), HEMI_ERROR_ARGUMENT);
            CHECK_EQUAL(h.errors, errors + 1);
            CHECK(strncmp(h.text, KINDS[i].name, strlen(KINDS[i].name)) == 0 && strstr(h.text, "struct_size") != NULL);
        }
    }
    close_host(&h);
}

/* ---- views ----------------------------------------------------------------------------------------------------- */

enum { VIEW_ROOM = 1024 };

typedef union any_view {
    uint32_t struct_size;
    hemi_mesh_view mesh;
    hemi_statistics statistics;
    hemi_curve_point point;
    hemi_shooter shooter;
    unsigned char bytes[VIEW_ROOM];
} any_view;

static hemi_result see_mesh(const hemi_solution *s, any_view *v) {
    return hemi_solution_mesh(s, 0, &v->mesh);
}

static hemi_result see_statistics(const hemi_solution *s, any_view *v) {
    return hemi_solution_statistics(s, &v->statistics);
}

static hemi_result see_point(const hemi_solution *s, any_view *v) {
    return hemi_solution_curve_point(s, 0, &v->point);
}

static hemi_result see_shooter(const hemi_solution *s, any_view *v) {
    return hemi_solution_shooter(s, 0, &v->shooter);
}

static const struct sight {
    hemi_result (*see)(const hemi_solution *s, any_view *v);
    size_t size; /* the first release has every field */
} SIGHTS[] = {
    { see_mesh, sizeof(hemi_mesh_view) },
    { see_statistics, sizeof(hemi_statistics) },
    { see_point, sizeof(hemi_curve_point) },
    { see_shooter, sizeof(hemi_shooter) },
};

/* One emitting triangle that lights itself. */
static hemi_solution *bake_triangle(host *h) {
    static const float positions[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    static const uint32_t indices[3] = { 0, 1, 2 };
    hemi_material_desc light = { .struct_size = sizeof light, .emission = { 1, 1, 1 } };
    hemi_mesh_desc mesh = {
        .struct_size = sizeof mesh, .positions = positions, .vertex_count = 3, .indices = indices, .triangle_count = 1
    };
    hemi_bake_desc desc = { .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT, .element_size = 1 };
    hemi_solution *out = NULL;
    CHECK_EQUAL(hemi_scene_add_material(h->scene, &light, &mesh.material), HEMI_OK);
    CHECK_EQUAL(hemi_scene_add_mesh(h->scene, &mesh, NULL), HEMI_OK);
    CHECK_EQUAL(hemi_bake(h->scene, &desc, &out), HEMI_OK);
    return out;
}

static any_view rubbish_of_size(size_t size) {
    any_view v;
    memset(v.bytes, 0xa5, sizeof v.bytes);
    v.struct_size = (uint32_t)size;
    return v;
}

/* A host with a newer header has a longer view: what the library does not know is 0, and behind it nothing is written.
 */
static void a_view_is_filled_as_far_as_host_and_library_know_it(void) {
    host h;
    open_host(&h);
    hemi_solution *s = bake_triangle(&h);
    for (size_t i = 0; s && i < sizeof SIGHTS / sizeof *SIGHTS; i++) {
        any_view own = rubbish_of_size(SIGHTS[i].size), longer = rubbish_of_size(SIGHTS[i].size + 8);
        CHECK_EQUAL(SIGHTS[i].see(s, &own), HEMI_OK);
        CHECK_EQUAL(SIGHTS[i].see(s, &longer), HEMI_OK);
        CHECK_EQUAL(own.struct_size, SIGHTS[i].size);
        CHECK_EQUAL(longer.struct_size, SIGHTS[i].size + 8);
        for (size_t k = sizeof own.struct_size; k < VIEW_ROOM; k++) {
            CHECK_EQUAL(longer.bytes[k], k < SIGHTS[i].size ? own.bytes[k] : k < SIGHTS[i].size + 8 ? 0 : 0xa5);
            if (k >= SIGHTS[i].size) CHECK_EQUAL(own.bytes[k], 0xa5);
        }
    }
    hemi_solution_destroy(s);
    close_host(&h);
}

static void a_view_whose_size_was_not_set_is_refused_and_left_alone(void) {
    host h;
    open_host(&h);
    hemi_solution *s = bake_triangle(&h);
    for (size_t i = 0; s && i < sizeof SIGHTS / sizeof *SIGHTS; i++) {
        const size_t sizes[] = { 0, 4, 8, SIGHTS[i].size + 1, UINT32_MAX, 0xa5a5a5a4 };
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            any_view v = rubbish_of_size(sizes[k]), before = v;
            CHECK_EQUAL(SIGHTS[i].see(s, &v), HEMI_ERROR_ARGUMENT);
            CHECK(memcmp(&v, &before, sizeof v) == 0);
        }
    }
    hemi_solution_destroy(s);
    close_host(&h);
}

static void numbers_and_text_of_the_version_agree(void) {
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", HEMI_VERSION_MAJOR, HEMI_VERSION_MINOR, HEMI_VERSION_PATCH);
    CHECK_TEXT(HEMI_VERSION_STRING, text);
    CHECK_TEXT(hemi_version(), text);
}

int main(void) {
    RUN(an_older_desc_is_taken_and_nothing_behind_it_is_read);
    RUN(other_sizes_are_refused_with_one_line);
    RUN(a_view_is_filled_as_far_as_host_and_library_know_it);
    RUN(a_view_whose_size_was_not_set_is_refused_and_left_alone);
    RUN(numbers_and_text_of_the_version_agree);
    return check_end();
}
