/* SPDX-License-Identifier: MIT
 * Which values do the vertices of a bake have of an attribute that the source's vertices had? The barycentric mean of
 * the corners of the triangle a vertex lies in; of what cannot be blended, the value of the nearest corner.
 */
#include "gltf_model.h"

#include "geometry/vec3.h"

#include <cmath>

static const uint32_t *corners_of(const gltf_geometry &source, const hemi_mesh_view &view, size_t v) {
    return &source.indices[size_t(view.source_triangles[v]) * 3];
}

static size_t nearest_corner(const hemi_mesh_view &view, size_t v) {
    const float *weights = view.source_weights + 3 * v;
    size_t nearest = 0;
    for (size_t i = 1; i < 3; i++)
        if (weights[i] > weights[nearest]) nearest = i;
    return nearest;
}

static float blend(const gltf_geometry &source, const hemi_mesh_view &view, size_t v, const std::vector<float> &values,
                   size_t width, size_t k) {
    const uint32_t *corner = corners_of(source, view, v);
    double sum = 0;
    for (size_t i = 0; i < 3; i++)
        sum += double(view.source_weights[3 * v + i]) * double(values[width * corner[i] + k]);
    return float(sum);
}

static gltf_attribute transfer(const gltf_geometry &source, const hemi_mesh_view &view,
                               const gltf_attribute &attribute) {
    size_t width = size_t(attribute.components);
    gltf_attribute out = { attribute.name, attribute.components, attribute.discrete, {} };
    out.values.resize(width * view.vertex_count);
    for (size_t v = 0; v < view.vertex_count; v++)
        for (size_t k = 0; k < width; k++)
            out.values[width * v + k] =
                attribute.discrete ? attribute.values[width * corners_of(source, view, v)[nearest_corner(view, v)] + k]
                                   : blend(source, view, v, attribute.values, width, k);
    return out;
}

static void normalize(float *v, double sign) {
    double length = std::sqrt(vec3_dot_floats(v, v));
    for (int k = 0; k < 3; k++) v[k] = length > 0 ? float(sign * double(v[k]) / length) : (k == 2 ? 1.0f : 0.0f);
}

/* Shading normals, and where the file has none those of the bake; turned round on the backs that double-sided surfaces
 * have as triangles of their own. */
static gltf_attribute transfer_normals(const gltf_geometry &source, const hemi_mesh_view &view) {
    gltf_attribute out = transfer(source, view, { "NORMAL", 3, false, source.normals });
    for (size_t v = 0; v < view.vertex_count; v++) {
        if (vec3_dot_floats(&out.values[3 * v], &out.values[3 * v]) == 0)
            std::copy_n(view.normals + 3 * v, 3, &out.values[3 * v]);
        bool turned = vec3_dot_floats(&out.values[3 * v], view.normals + 3 * v) < 0;
        normalize(&out.values[3 * v], turned ? -1 : 1);
    }
    return out;
}

/* Its fourth component is a sign. */
static gltf_attribute transfer_tangents(const gltf_geometry &source, const hemi_mesh_view &view,
                                        const gltf_attribute &tangents) {
    gltf_attribute out = transfer(source, view, tangents);
    for (size_t v = 0; v < view.vertex_count; v++) {
        normalize(&out.values[4 * v], 1);
        out.values[4 * v + 3] = tangents.values[4 * corners_of(source, view, v)[nearest_corner(view, v)] + 3];
    }
    return out;
}

/* Of a limit surface, whose vertices bring their attributes; numbers that name something have none between cage
 * vertices, and go. */
static void transfer_limit(const gltf_geometry &source, const hemi_mesh_view &view, gltf_baked_primitive &out) {
    size_t at = 0, stride = view.attribute_count;
    if (!view.attributes || stride != source.attribute_count) return;
    for (const gltf_attribute &attribute : source.transferred) {
        size_t width = size_t(attribute.components);
        gltf_attribute limit = { attribute.name, attribute.components, false, {} };
        for (size_t v = 0; !attribute.discrete && v < view.vertex_count; v++)
            limit.values.insert(limit.values.end(), view.attributes + stride * v + at,
                                view.attributes + stride * v + at + width);
        if (!attribute.discrete) out.transferred.push_back(std::move(limit));
        at += width;
    }
}

/* A limit surface has it in w of the mask, which a factor does not change where it is 1. */
void gltf_transfer_alpha(const gltf_geometry &source, gltf_baked_primitive &out) {
    const hemi_mesh_view &view = *out.view;
    const gltf_attribute *colors = nullptr;
    for (const gltf_attribute &attribute : source.lit_only)
        if (attribute.name == "COLOR_0" && attribute.components == 4) colors = &attribute;
    if (!colors || out.colors.empty()) return;
    std::vector<float> wide;
    gltf_attribute transferred;
    if (view.source_triangles) transferred = transfer(source, view, *colors);
    for (size_t v = 0; v < view.vertex_count; v++) {
        float alpha = 1;
        if (view.source_triangles)
            alpha = transferred.values[4 * v + 3];
        else if (view.attributes && source.mask_at >= 0)
            alpha = view.attributes[size_t(view.attribute_count) * v + size_t(source.mask_at) + 2];
        wide.insert(wide.end(), &out.colors[3 * v], &out.colors[3 * v] + 3);
        wide.push_back(std::fmin(std::fmax(alpha, 0.0f), 1.0f));
    }
    out.colors = std::move(wide);
    out.color_width = 4;
}

void gltf_transfer_attributes(const gltf_geometry &source, bool lit, gltf_baked_primitive &out) {
    const hemi_mesh_view &view = *out.view;
    if (!view.source_triangles || !view.source_weights) {
        transfer_limit(source, view, out);
        if (lit)
            out.transferred.push_back(
                { "NORMAL", 3, false, { view.normals, view.normals + size_t(view.vertex_count) * 3 } });
        return;
    }
    for (size_t v = 0; v < view.vertex_count; v++)
        if (view.source_triangles[v] >= source.indices.size() / 3)
            gltf_fail(HEMI_ERROR_ARGUMENT, "%s: a source triangle is out of range", out.where.c_str());
    for (const gltf_attribute &attribute : source.transferred)
        out.transferred.push_back(transfer(source, view, attribute));
    if (!lit) return;
    if (!source.normals.empty() && view.normals) out.transferred.push_back(transfer_normals(source, view));
    for (const gltf_attribute &attribute : source.lit_only)
        out.transferred.push_back(attribute.name == "TANGENT" && attribute.components == 4
                                      ? transfer_tangents(source, view, attribute)
                                      : transfer(source, view, attribute));
}
