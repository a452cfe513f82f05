/* SPDX-License-Identifier: MIT */
#include "inspection.h"

#include "triangle_area.h"

#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* A surface that reflects less shows as black in eight bits at middle exposure: 1/255 of what a white one does. */
static const double BLACK_REFLECTANCE = 0.004;

static double sum(const double rgb[3]) {
    return rgb[0] + rgb[1] + rgb[2];
}

double inspected_material_power(const inspected_material *m) {
    return sum(m->power_w);
}

bool inspected_material_is_black(const inspected_material *m) {
    return m->area_m2 > 0.0 && sum(m->reflectance) < 3.0 * BLACK_REFLECTANCE && sum(m->power_w) == 0.0;
}

/* What textures make of a triangle, if there are any. */
static void triangle_means(const hemi_mesh_desc *mesh, const uint32_t corner[3], double *attributes,
                           hemi_texture_mean *means) {
    const uint32_t count = mesh->attribute_count;
    if (!mesh->texture) return;
    for (int i = 0; i < 3; i++)
        for (uint32_t k = 0; k < count; k++)
            attributes[i * count + k] = (double)mesh->attributes[(size_t)count * corner[i] + k];
    mesh->texture(mesh->texture_user, attributes, 3, means);
}

/* Sums over the area; divided by it in the end. */
static void add_mesh(const hemi_mesh_desc *mesh, const hemi_material_desc *material, double *attributes,
                     inspected_material *m) {
    const double sides = material->double_sided ? 2.0 : 1.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->indices + 3 * (size_t)t;
        hemi_texture_mean means = { .reflectance = { 0 } };
        for (int k = 0; k < 3; k++)
            means.reflectance[k] = material->reflectance[k], means.emission[k] = material->emission[k];
        triangle_means(mesh, corner, attributes, &means);
        double normal[3], area = sides * triangle_area(mesh->positions, mesh->transform, corner, normal);
        m->area_m2 += area;
        for (int k = 0; k < 3; k++) {
            m->reflectance[k] += area * means.reflectance[k];
            m->power_w[k] += area * PI * means.emission[k];
        }
    }
}

static bool add_meshes(const gltf_asset *asset, const hemi_material_desc *materials, inspection *out) {
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        gltf_asset_mesh(asset, i, &mesh);
        gltf_asset_texture(asset, i, &mesh);
        if (gltf_asset_mesh_is_left(asset, i)) {
            out->left_count++;
            continue;
        }
        double *attributes = malloc((3 * (size_t)mesh.attribute_count + 1) * sizeof *attributes);
        if (!attributes) return false;
        add_mesh(&mesh, &materials[mesh.material], attributes, &out->materials[mesh.material]);
        free(attributes);
        out->mesh_count++;
        out->triangles += mesh.triangle_count;
    }
    return true;
}

static void finish(const gltf_asset *asset, const hemi_material_desc *materials, inspection *out) {
    for (uint32_t i = 0; i < out->material_count; i++) {
        inspected_material *m = &out->materials[i];
        double emission;
        gltf_asset_material_weights(asset, i, &m->share, &emission);
        m->name = materials[i].name;
        for (int k = 0; k < 3 && m->area_m2 > 0.0; k++) m->reflectance[k] /= m->area_m2;
        out->area_m2 += m->area_m2;
        out->power_w += inspected_material_power(m);
    }
}

int inspection_make(const gltf_asset *asset, const asset_colors *colors, const options *o, console *c,
                    inspection *out) {
    const uint32_t count = gltf_asset_material_count(asset);
    hemi_material_desc *materials = calloc(count + 1, sizeof *materials);
    hemi_light_desc light;
    hemi_sky_desc sky;
    *out = (inspection){ .materials = calloc(count + 1, sizeof *out->materials), .material_count = count };
    bool ok = materials && out->materials;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = asset_colors_material(colors, asset, i, c, &materials[i]) == HEMI_OK;
    ok = ok && add_meshes(asset, materials, out);
    if (ok) finish(asset, materials, out);
    while (gltf_asset_light(asset, out->light_count, &light)) out->light_count++;
    out->has_sky = o->environment || gltf_asset_sky(asset, &sky);
    free(materials);
    return ok ? EXIT_DONE : console_error(c, "out of memory while looking at it");
}

void inspection_free(inspection *i) {
    free(i->materials);
    *i = (inspection){ 0 };
}
