/* SPDX-License-Identifier: MIT */
#include "blackness.h"

#include "triangle_area.h"

#include <math.h>
#include <stdio.h>

/* Worth a line: more of the vertices are dark, less of the area reflects, or more of it is on meshes without light. */
static const double DARK_SHARE = 0.9, REFLECTING_SHARE = 0.02, UNLIT_SHARE = 1e-4;

/* And more of the area is closed in and dark: a thing that is hollow and two-sided has half of its own there. */
static const double INSIDE_SHARE = 0.52;

/* Linear: below it an sRGB code value rounds to less than 1 of 255. */
static const double DARK = 1.0 / 255 / 12.92;

/* Of that, what is nothing: so little leaks into closed things. */
static const double UNLIT = 0.01;

/* A material that reflects less is black to the eye: less than carbon black paint. */
static const double BLACK_REFLECTANCE = 0.005;

/* Of what covers less the rest is seen through it, and not black: clear glass shows nothing of its own. */
static const double OPAQUE = 0.999;

typedef enum cause { CAUSE_NONE, CAUSE_MATERIAL, CAUSE_COLORS, CAUSE_UNLIT, CAUSES } cause;

static double largest(const double rgb[3]) {
    return fmax(rgb[0], fmax(rgb[1], rgb[2]));
}

static bool is_black(const float *rgb, size_t count, double most) {
    for (size_t i = 0; i < 3 * count; i++)
        if ((double)rgb[i] > most) return false;
    return true;
}

double blackness_unlit(double ev) {
    return UNLIT * DARK / exp2(ev);
}

static cause cause_of(const gltf_asset *asset, uint32_t mesh, const hemi_mesh_desc *desc,
                      const hemi_material_desc *material, const hemi_mesh_view *view, double ev) {
    const float *colors = gltf_asset_mesh_color(asset, mesh);
    if (!is_black(view->radiance, view->vertex_count, blackness_unlit(ev))) return CAUSE_NONE;
    if (largest(material->reflectance) < BLACK_REFLECTANCE) return CAUSE_MATERIAL;
    return colors && is_black(colors, desc->vertex_count, 0.0) ? CAUSE_COLORS : CAUSE_UNLIT;
}

/* Of the causes the one that has made most black; else what gets no light at all. */
static void write_line(const name_list causes[CAUSES], double area, const char *camera, const shut_in *shut,
                       blackness *out) {
    char names[NAMES_TEXT_SIZE];
    cause worst = CAUSE_MATERIAL;
    for (int k = CAUSE_MATERIAL; k < CAUSES; k++)
        if (causes[k].area > causes[worst].area) worst = (cause)k;
    name_list_write(&causes[worst], names);
    bool reflects = out->reflecting_fraction >= REFLECTING_SHARE;
    if (!reflects && worst == CAUSE_MATERIAL)
        snprintf(out->line, sizeof out->line,
                 "%.0f %% of what is baked reflects nothing: material %s is black; give it a base colour, and what is "
                 "metal some roughness",
                 100 * (1 - out->reflecting_fraction), names);
    else if (!reflects && worst == CAUSE_COLORS)
        snprintf(out->line, sizeof out->line,
                 "%.0f %% of what is baked reflects nothing: COLOR_0 of mesh %s is black, and multiplies its base "
                 "colour; paint it, or take the attribute away",
                 100 * (1 - out->reflecting_fraction), names);
    else if (camera)
        snprintf(out->line, sizeof out->line,
                 "no light gets in where the camera \"%.*s\" is: all that it sees is black; put a light in there, or "
                 "open the room to one",
                 NAME_LENGTH, camera);
    else if (reflects && shut->dark_fraction > INSIDE_SHARE) {
        name_list_write(&shut->dark, names);
        snprintf(out->line, sizeof out->line,
                 "nothing lights the inside: %.0f %% of what is baked is closed in and black, on mesh %s; put a light "
                 "in there, or open it to one",
                 100 * shut->dark_fraction, names);
    } else if (!reflects || out->dark_fraction > DARK_SHARE)
        snprintf(out->line, sizeof out->line,
                 "%.0f %% of the vertices are black%s%s; look whether textures there are black, whether lights are too "
                 "weak or shut in, and whether fronts face the light",
                 100 * out->dark_fraction, causes[CAUSE_UNLIT].count ? ", all of mesh " : "",
                 causes[CAUSE_UNLIT].count && worst == CAUSE_UNLIT ? names : "");
    else if (causes[CAUSE_UNLIT].area > UNLIT_SHARE * area) {
        name_list_write(&causes[CAUSE_UNLIT], names);
        snprintf(
            out->line, sizeof out->line,
            "mesh %s is black, %.2g %% of what is baked: no light was found there; look whether something shuts it "
            "in, and whether its fronts face the light",
            names, 100 * causes[CAUSE_UNLIT].area / area);
    }
}

void blackness_find(const lights_from *from, const hemi_mesh_view *views, double ev, bool cameras_are_dark,
                    const shut_in *shut, blackness *out) {
    name_list causes[CAUSES] = { 0 };
    double vertices = 0.0, dark = 0.0, area = 0.0, scale = exp2(ev);
    gltf_camera camera = { 0 };
    const gltf_asset *asset = from->input;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        const hemi_mesh_view *v = &views[i];
        hemi_mesh_desc desc;
        hemi_material_desc material;
        if (gltf_asset_mesh_is_unlit(asset, i) || gltf_asset_mesh_opacity(asset, i) < OPAQUE) continue;
        gltf_asset_mesh(asset, i, &desc);
        gltf_asset_material(asset, desc.material, &material);
        lights_from_emission(from, i, material.emission);
        cause why = cause_of(asset, i, &desc, &material, v, ev);
        if (largest(material.emission) > 0.0 && why != CAUSE_UNLIT) continue;
        double own = mesh_area(v->positions, desc.transform, v->indices, v->triangle_count);
        name_list_add(&causes[why], why == CAUSE_MATERIAL ? material.name : desc.name, own);
        area += own, vertices += v->vertex_count;
        for (size_t k = 0; k < v->vertex_count; k++) {
            const float *rgb = v->radiance + 3 * k;
            dark += scale * fmax(rgb[0], fmax(rgb[1], rgb[2])) < DARK;
        }
    }
    *out = (blackness){ .dark_fraction = vertices > 0.0 ? dark / vertices : 0.0,
                        .reflecting_fraction = area > 0.0 ? causes[CAUSE_NONE].area / area : 1.0 };
    bool has_camera = cameras_are_dark && gltf_asset_camera(asset, 0, &camera);
    write_line(causes, area, has_camera ? camera.name ? camera.name : "" : NULL, shut, out);
}
