/* SPDX-License-Identifier: MIT */
#include "picture/blended.h"

#include "geometry/vec3.h"

/* Surfaces that one ray is followed through; what is behind that many is seen past them all. */
enum { LAYERS_MAX = 32 };

/* Of what is behind, so little is seen that nothing of it shows. */
static const double NOTHING = 1.0 / 1024;

static size_t count_triangles(const picture *p) {
    size_t count = 0;
    for (size_t m = 0; m < p->mesh_count; m++) count += picture_blends(p, m) ? p->first[m + 1] - p->first[m] : 0;
    return count;
}

static void add_mesh(blended *b, uint32_t mesh, size_t *at) {
    const picture *p = b->picture;
    for (uint32_t t = p->first[mesh]; t < p->first[mesh + 1]; t++, (*at)++) {
        b->triangles[*at] = t, b->meshes[*at] = mesh;
        for (int i = 0; i < 3; i++)
            vec3_copy(b->tree.corners[*at][i], p->positions + 3 * (size_t)p->indices[3 * (size_t)t + (size_t)i]);
    }
}

bool blended_create(const picture *p, blended *out) {
    size_t count = count_triangles(p), at = 0;
    *out = (blended){ .picture = p };
    if (count == 0) return true;
    out->triangles = block_new(p->memory, count * sizeof *out->triangles);
    out->meshes = block_new(p->memory, count * sizeof *out->meshes);
    out->passed = block_zeroed(p->memory, count, sizeof *out->passed);
    if (!triangle_bvh_allocate(p->memory, count, &out->tree) || !out->triangles || !out->meshes || !out->passed)
        return false;
    for (uint32_t m = 0; m < p->mesh_count; m++)
        if (picture_blends(p, m)) add_mesh(out, m, &at);
    return triangle_bvh_build(p->memory, NULL, &out->tree);
}

void blended_free(blended *b) {
    triangle_bvh_free(&b->tree);
    block_free_all(b->triangles, b->meshes, b->passed);
}

static double alpha_at(const blended *b, size_t i, const double weights[3]) {
    const picture *p = b->picture;
    double uvw[3] = { 0, 0, 0 };
    for (size_t k = 0; k < 3; k++) {
        const float *own = p->coordinates + 3 * (size_t)p->indices[3 * (size_t)b->triangles[i] + k];
        for (int c = 0; c < 3; c++) uvw[c] += weights[k] * (double)own[c];
    }
    return fmin(fmax(alpha_mask_map_alpha(&p->maps[b->meshes[i]], uvw), 0.0), 1.0);
}

double blended_add(blended *b, const double ray[3], double end, blended_color color, void *user, float rgb[3]) {
    size_t met[LAYERS_MAX], count = 0;
    double left = 1.0, to[3];
    triangle_meeting at;
    if (b->tree.count == 0) return 1.0;
    const double *eye = b->picture->eye;
    end = fmin(end, 2.1 * (b->tree.radius + vec3_distance(eye, b->tree.center)));
    vec3_add_scaled(to, eye, end, ray);
    while (count < LAYERS_MAX && left > NOTHING &&
           triangle_bvh_meet(&b->tree, eye, to, !b->picture->draw_backs, b->passed, &at)) {
        float own[3] = { 0, 0, 0 };
        double alpha = alpha_at(b, at.triangle, at.weights);
        color(user, b->triangles[at.triangle], at.weights, own);
        for (int k = 0; k < 3; k++) rgb[k] += (float)(left * alpha) * own[k];
        left *= 1.0 - alpha;
        met[count++] = at.triangle;
        b->passed[at.triangle] = true;
    }
    for (size_t i = 0; i < count; i++) b->passed[met[i]] = false;
    return left;
}
