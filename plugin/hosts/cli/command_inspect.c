/* SPDX-License-Identifier: MIT
 * hemibake inspect IN: what would be baked, what gives light, and what will not be as it looks elsewhere?
 */
#include "asset_input.h"
#include "asset_scene.h"
#include "commands.h"
#include "inspection.h"
#include "printable.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of a metal, since less than this of its colour is left; what is more is as good as all of it. */
static const double METAL_SHARE = 0.995;

enum { NAME_WIDTH = 32, PROBLEM_SIZE = 256 };

typedef struct inspecting {
    const options *o;
    console console;
    options as_read;
    usd_files usd;
    gltf_asset *asset;
    asset_colors spaces;
    inspection found;
    hemi_forecast forecast;
    double threads; /* that share its processor time */
    hemi_context *context;
    hemi_scene *scene;
} inspecting;

/* ---- what --strict is about -------------------------------------------------------------------------------------- */

static bool is_dark(const inspecting *s) {
    return s->found.power_w == 0.0 && s->found.light_count == 0 && !s->found.has_sky && !s->o->sun.is_given;
}

/* The problem of this number, beginning with what a bake says of the asset; false past the last. */
static bool problem(const inspecting *s, size_t index, char text[PROBLEM_SIZE]) {
    const inspection *f = &s->found;
    if (index < s->console.note_count) return snprintf(text, PROBLEM_SIZE, "%s", s->console.notes[index]) >= 0;
    index -= s->console.note_count;
    if (is_dark(s) && index-- == 0)
        return snprintf(text, PROBLEM_SIZE,
                        "nothing gives light: a sky of radiance 1 will, unless --sun or "
                        "--environment say otherwise") > 0;
    for (uint32_t i = 0; i < f->material_count; i++)
        if (inspected_material_is_black(&f->materials[i]) && index-- == 0)
            return snprintf(text, PROBLEM_SIZE, "material '%.64s' reflects nothing, and %.3g m2 of it stay black",
                            f->materials[i].name ? f->materials[i].name : "", f->materials[i].area_m2) > 0;
    return false;
}

/* ---- as text ----------------------------------------------------------------------------------------------------- */

static void print_name(const char *name) {
    printf("  ");
    print_padded(name && *name ? name : "-", NAME_WIDTH);
}

static void print_lamps(const inspecting *s) {
    const inspection *f = &s->found;
    static const char *const kinds[] = { "point", "spot", "directional" };
    hemi_light_desc light;
    printf("light\n");
    for (uint32_t i = 0; i < f->material_count; i++) {
        const inspected_material *m = &f->materials[i];
        if (inspected_material_power(m) == 0.0) continue;
        print_name(m->name);
        printf(" %9.4g W from %.3g m2\n", inspected_material_power(m), m->area_m2);
    }
    for (uint32_t i = 0; gltf_asset_light(s->asset, i, &light); i++) {
        print_name(light.name);
        printf(" %s, %.4g %.4g %.4g %s\n", kinds[light.kind], light.intensity[0], light.intensity[1],
               light.intensity[2], light.kind == HEMI_LIGHT_DIRECTIONAL ? "W/m2" : "W/sr");
    }
    if (s->o->sun.is_given) printf("  --sun\n");
    if (f->has_sky) printf("  a sky\n");
    if (is_dark(s)) printf("  nothing; a sky of radiance 1 will be lit\n");
}

static void print_materials(const inspection *f) {
    printf("%-34s %17s %12s\n", "materials", "reflectance", "m2");
    for (uint32_t i = 0; i < f->material_count; i++) {
        const inspected_material *m = &f->materials[i];
        if (m->area_m2 == 0.0) continue;
        print_name(m->name);
        printf(" %5.3f %5.3f %5.3f %12.4g", m->reflectance[0], m->reflectance[1], m->reflectance[2], m->area_m2);
        if (inspected_material_power(m) > 0.0) printf("  emits");
        if (m->share < METAL_SHARE) printf("  metal: %.0f %% of its colour", 100 * m->share);
        if (inspected_material_is_black(m)) printf("  black");
        printf("\n");
    }
}

static void print_forecast(const inspecting *s) {
    const hemi_forecast *f = &s->forecast;
    printf("forecast  method %s, %u patches, about %u elements and %.3g s on %.0f thread%s (processor time %.3g s), "
           "%.0f MiB\n",
           options_method(f->method), f->patches, f->elements, f->processor_s / s->threads, s->threads,
           s->threads == 1.0 ? "" : "s", f->processor_s, (double)f->memory_bytes / (1 << 20));
}

static void print_text(const inspecting *s) {
    const inspection *f = &s->found;
    char text[PROBLEM_SIZE];
    printf("baked   %u meshes of %.0f triangles, %.4g m2", f->mesh_count, f->triangles, f->area_m2);
    if (f->left_count) printf("; %u stay as they are", f->left_count);
    printf("\n");
    print_lamps(s);
    print_materials(f);
    print_forecast(s);
    for (size_t i = 0; problem(s, i, text); i++) {
        if (i == 0) printf("mind\n");
        printf("  ");
        print_printable(stdout, text);
        printf("\n");
    }
}

/* ---- as JSON ----------------------------------------------------------------------------------------------------- */

static cJSON *named(const char *name) {
    cJSON *out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "name", name ? name : "");
    return out;
}

static cJSON *json_of_materials(const inspection *f) {
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < f->material_count; i++) {
        const inspected_material *m = &f->materials[i];
        if (m->area_m2 == 0.0) continue;
        cJSON *one = named(m->name);
        cJSON_AddNumberToObject(one, "area_m2", m->area_m2);
        cJSON_AddItemToObject(one, "reflectance", cJSON_CreateDoubleArray(m->reflectance, 3));
        cJSON_AddItemToObject(one, "power_w", cJSON_CreateDoubleArray(m->power_w, 3));
        cJSON_AddBoolToObject(one, "black", inspected_material_is_black(m));
        cJSON_AddBoolToObject(one, "metal", m->share < METAL_SHARE);
        cJSON_AddItemToArray(list, one);
    }
    return list;
}

static cJSON *json_of_lights(const inspecting *s) {
    static const char *const kinds[] = { "point", "spot", "directional" };
    cJSON *list = cJSON_CreateArray();
    hemi_light_desc light;
    for (uint32_t i = 0; gltf_asset_light(s->asset, i, &light); i++) {
        cJSON *one = named(light.name);
        cJSON_AddStringToObject(one, "kind", kinds[light.kind]);
        cJSON_AddItemToObject(one, "intensity", cJSON_CreateDoubleArray(light.intensity, 3));
        cJSON_AddItemToArray(list, one);
    }
    return list;
}

static cJSON *json_of_forecast(const inspecting *s) {
    const hemi_forecast *f = &s->forecast;
    cJSON *out = cJSON_CreateObject();
    cJSON_AddStringToObject(out, "method", options_method(f->method));
    cJSON_AddNumberToObject(out, "surfaces", f->surfaces);
    cJSON_AddNumberToObject(out, "patches", f->patches);
    cJSON_AddNumberToObject(out, "elements", f->elements);
    cJSON_AddNumberToObject(out, "samples", f->samples);
    cJSON_AddNumberToObject(out, "threads", s->threads);
    cJSON_AddNumberToObject(out, "seconds", f->processor_s / s->threads);
    cJSON_AddNumberToObject(out, "processor_s", f->processor_s);
    cJSON_AddNumberToObject(out, "memory_bytes", (double)f->memory_bytes);
    return out;
}

static void print_json_text(const inspecting *s) {
    const inspection *f = &s->found;
    char text[PROBLEM_SIZE];
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "input", s->o->inputs[0]);
    cJSON_AddNumberToObject(root, "meshes", f->mesh_count);
    cJSON_AddNumberToObject(root, "meshes_left", f->left_count);
    cJSON_AddNumberToObject(root, "triangles", f->triangles);
    cJSON_AddNumberToObject(root, "area_m2", f->area_m2);
    cJSON_AddNumberToObject(root, "power_w", f->power_w);
    cJSON_AddBoolToObject(root, "sky", f->has_sky);
    cJSON_AddBoolToObject(root, "sky_by_default", is_dark(s));
    cJSON_AddItemToObject(root, "lights", json_of_lights(s));
    cJSON_AddItemToObject(root, "materials", json_of_materials(f));
    cJSON_AddItemToObject(root, "forecast", json_of_forecast(s));
    cJSON *problems = cJSON_AddArrayToObject(root, "problems");
    for (size_t i = 0; problem(s, i, text); i++) cJSON_AddItemToArray(problems, cJSON_CreateString(text));
    char *printed = cJSON_Print(root);
    if (printed) print_json_printable(stdout, printed);
    putchar('\n');
    cJSON_free(printed);
    cJSON_Delete(root);
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static int look_ahead(inspecting *s) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    s->threads = s->o->threads ? (double)s->o->threads : cores > 0 ? (double)cores : 1.0;
    s->forecast.struct_size = sizeof s->forecast;
    return hemi_scene_forecast(s->scene, &s->o->bake, &s->forecast) == HEMI_OK ? EXIT_DONE : EXIT_BAD_INPUT;
}

/* As far as a bake goes before it works, so that what that refuses is refused here. */
static int look(inspecting *s) {
    int status = asset_input_read(s->o, &s->console, &s->usd, &s->as_read, &s->asset);
    if (status == EXIT_DONE) status = asset_colors_load(s->o, &s->console, &s->spaces);
    if (status == EXIT_DONE) status = asset_input_textures(s->o, &s->spaces, &s->console, s->asset);
    if (status == EXIT_DONE) status = console_context(&s->console, 1, &s->context);
    if (status == EXIT_DONE)
        status = asset_scene_create(s->context, &(lights_from){ .input = s->asset, .asset = s->asset }, &s->spaces,
                                    &s->as_read, &(light_names){ 0 }, &s->console, &s->scene);
    if (status == EXIT_DONE) status = inspection_make(s->asset, &s->spaces, &s->as_read, &s->console, &s->found);
    return status == EXIT_DONE ? look_ahead(s) : status;
}

int command_inspect(const options *o) {
    inspecting s = { .o = o, .as_read = *o };
    char text[PROBLEM_SIZE];
    console_start(&s.console, o);
    int status = look(&s);
    if (status == EXIT_DONE) (o->json ? print_json_text : print_text)(&s);
    if (status == EXIT_DONE && o->strict && problem(&s, 0, text)) status = EXIT_BAD_INPUT;
    console_finish(&s.console, false);
    inspection_free(&s.found);
    hemi_scene_destroy(s.scene);
    hemi_context_destroy(s.context);
    asset_colors_free(&s.spaces);
    gltf_asset_destroy(s.asset);
    usd_files_close(&s.usd);
    return status;
}
