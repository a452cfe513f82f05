/* SPDX-License-Identifier: MIT */
#include "light/light_samples.h"

#include "base/sobol.h"
#include "base/splitmix.h"
#include "base/spread.h"
#include "geometry/vec3.h"
#include "light/shadow_view.h"
#include "mesh/shading_normals.h"

/* Places are spread over this share of what a sample stands for, across: right at a wall the shade of the wall ends. */
static const double PART = 0.9;

static void list_placed(const punctual *light, light_samples *out) {
    for (int k = 0; k < SHADOW_VIEW_FACES; k++)
        out->all[out->count++] = (light_sample){ .light = light, .share = 1.0, .face = k, .direction = -1 };
}

/* Of points of the disc that follow each other every second is 85 degrees further around, and as far from its middle:
 * where half of the disc is hidden it is both of the two in a quarter of all cases, as if they knew nothing of each
 * other. The next would be 138 degrees further. */
static int nearly_square_to(int k) {
    return (k & ~3) | (k & 1) << 1 | (k >> 1 & 1);
}

static void list_disc(const direct_light_setup *setup, const punctual *light, light_samples *out) {
    const int count = setup->sun_directions;
    const uint32_t beside = sobol_neighbour((uint32_t)count);
    for (int k = 0; k < count; k++) {
        light_sample *b = &out->all[out->count++];
        *b = (light_sample){ .light = light, .share = 1.0 / count, .face = -1, .direction = k };
        b->place = (uint32_t)k / 2 ^ (k % 2 ? beside : 0);
        b->ends_disc = k == count - 1;
        punctual_toward(light, nearly_square_to(k), count, b->toward);
    }
}

static void list_light(const direct_light_setup *setup, const punctual *light, light_samples *out) {
    if (light->kind != PUNCTUAL_DIRECTIONAL) {
        list_placed(light, out);
    } else if (punctual_directions(light, setup->sun_directions) > 1) {
        list_disc(setup, light, out);
    } else {
        light_sample *b = &out->all[out->count++];
        *b = (light_sample){ .light = light, .share = 1.0, .face = -1, .direction = -1 };
        punctual_toward(light, 0, 1, b->toward);
    }
}

enum { DISCS, POINTS_OF_THE_SKY, PLACED, KINDS };

static int kind_of(const direct_light_setup *setup, const punctual *light) {
    if (light->kind != PUNCTUAL_DIRECTIONAL) return PLACED;
    return punctual_directions(light, setup->sun_directions) > 1 ? DISCS : POINTS_OF_THE_SKY;
}

/* Where time may run out those with a place are spread over all of them, too, after the others. */
static void list_lights(const direct_light_setup *setup, light_samples *out) {
    const size_t stride = setup->deadline_s > 0.0 ? spread_stride(setup->light_count) : 1;
    for (int kind = 0; kind < KINDS; kind++) {
        if (kind == PLACED) out->parallel = out->count;
        for (size_t i = 0; i < setup->light_count && !(kind == PLACED && setup->only_parallel); i++) {
            const punctual *one = &setup->lights[i * stride % setup->light_count];
            if (kind_of(setup, one) == kind) list_light(setup, one, out);
        }
    }
    out->lights = out->count;
}

bool light_samples_list(const direct_light_setup *setup, light_samples *out) {
    size_t most = setup->sky ? setup->sky->patch_count : 0;
    int widest = setup->sun_directions > SHADOW_VIEW_FACES ? setup->sun_directions : SHADOW_VIEW_FACES;
    *out = (light_samples){ .all = block_zeroed(jobs_memory(setup->jobs),
                                                most + setup->light_count * (size_t)widest + 1, sizeof *out->all) };
    if (!out->all) return false;
    list_lights(setup, out);
    size_t stride = setup->deadline_s > 0.0 ? spread_stride(most) : 1;
    for (size_t i = 0; i < most; i++) {
        light_sample *b = &out->all[out->count++];
        *b = (light_sample){
            .part = &setup->sky->patches[i * stride % most], .share = 1.0, .face = -1, .direction = -1
        };
        vec3_copy(b->toward, b->part->toward);
    }
    return true;
}

void light_sample_place(const light_sample *b, const mesh *m, const surface *f, const element *e, int corner,
                        double out[3]) {
    const size_t s = (size_t)e->first_sample + (size_t)corner;
    double square[2], part[3], place[3] = { m->x[s], m->y[s], m->z[s] };
    if (b->direction >= 0) {
        sobol_2d(b->place, splitmix(s), square);
        mesh_sample_part(m, e, corner, square, part);
        for (int k = 0; k < 3; k++) place[k] += PART * (part[k] - place[k]);
    }
    vec3_copy(out, place);
    if (m->patches[e->patch].is_smooth) shading_normals_lift(m, f, place, out);
}

bool light_sample_irradiance(const light_sample *b, const double point[3], double area, const double normal[3],
                             double E[3]) {
    if (!b->light) return sky_patch_irradiance(b->part, normal, E);
    if (!punctual_irradiance(b->light, b->toward, point, sqrt(area), normal, E)) return false;
    for (int c = 0; c < 3; c++) E[c] *= b->share;
    return true;
}
