/* SPDX-License-Identifier: MIT */
#include "formfactor/hemicube.h"

void hemicube_place(hemicube *h, const double eye[3], const double normal[3], double angle) {
    double u[3], v[3], c = cos(angle), s = sin(angle);
    vec3_tangents(normal, u, v);
    for (int k = 0; k < 3; k++) {
        h->tangent[k] = c * u[k] + s * v[k];
        h->bitangent[k] = c * v[k] - s * u[k];
    }
    vec3_copy(h->eye, eye);
    vec3_copy(h->normal, normal);
}

static void set_axis(float out[3], const double a[3], double sign) {
    for (int k = 0; k < 3; k++) out[k] = (float)(sign * a[k]);
}

static item_view view_of_face(const hemicube *h, int face, const double center[3]) {
    int n = h->resolution, half = n / 2;
    item_view v = { .s_low = -1, .s_high = 1, .t_low = face ? 0 : -1, .t_high = 1, .width = n };
    v.y = face ? n + (face - 1) * half : 0;
    v.height = face ? half : n;
    for (int k = 0; k < 3; k++) v.eye[k] = (float)(h->eye[k] - center[k]);
    const double *sideways = face == 1 || face == 2 ? h->bitangent : h->tangent;
    const double *forward = face == 0 ? h->normal : face == 1 || face == 2 ? h->tangent : h->bitangent;
    set_axis(v.right, sideways, 1);
    set_axis(v.up, face ? h->normal : h->bitangent, 1);
    set_axis(v.forward, forward, face == 2 || face == 4 ? -1 : 1);
    return v;
}

bool hemicube_draw(hemicube *h, item_buffer *items, const double center[3]) {
    item_view views[5];
    for (int face = 0; face < 5; face++) views[face] = view_of_face(h, face, center);
    return item_buffer_draw(items, views, 5, h->resolution, 3 * h->resolution, false, h->ids);
}

size_t hemicube_pack(const hemicube *h, uint32_t *runs) {
    size_t pixel_count = 3 * (size_t)h->resolution * (size_t)h->resolution, count = 0;
    for (size_t q = 0, end; q < pixel_count; q = end, count++) {
        end = hemicube_run_end(h->ids, q, pixel_count);
        if (runs) runs[2 * count] = h->ids[q], runs[2 * count + 1] = (uint32_t)(end - q);
    }
    return count;
}

void hemicube_unpack(hemicube *h, const uint32_t *runs, size_t count) {
    uint32_t *at = h->ids;
    for (size_t i = 0; i < count; i++) {
        const uint32_t id = runs[2 * i], length = runs[2 * i + 1];
        for (uint32_t k = 0; k < length; k++) at[k] = id;
        at += length;
    }
}
