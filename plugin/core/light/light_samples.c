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

/* Places of a sun without a disc: half as many as a disc has directions, and no fewer than at draft, unless it is late
 * before it has been looked for. Of each of a few lights that have a place as many, and of more in all as many as of
 * two. */
enum { PLACES_LEAST = 8, PLACES_LATE = 2, PLACES_IN_ALL = 16 };

/* From k-th places of what samples stand for; two each are beside each other. */
static void set_place(light_sample *b, int k, int count) {
    b->share = 1.0 / count;
    b->direction = count > 1 ? k : -1;
    b->place = (uint32_t)k / 2 ^ (k % 2 ? sobol_neighbour((uint32_t)count) : 0);
    b->is_repeated = k > 0;
    b->ends_light = k == count - 1;
}

static int places_of_placed(const direct_light_setup *setup) {
    size_t count = 0;
    int places = light_samples_are_late(setup) ? 1 : PLACES_LEAST;
    for (size_t i = 0; i < setup->light_count; i++) count += setup->lights[i].kind != PUNCTUAL_DIRECTIONAL;
    while (places > 1 && (size_t)places * count > PLACES_IN_ALL) places /= 2;
    return places;
}

static void list_placed(const punctual *light, int places, light_samples *out) {
    for (int face = 0; face < SHADOW_VIEW_FACES; face++)
        for (int k = 0; k < places; k++) {
            light_sample *b = &out->all[out->count++];
            *b = (light_sample){ .light = light, .face = face };
            set_place(b, k, places);
            b->ends_light = b->ends_light && face + 1 == SHADOW_VIEW_FACES;
        }
}

/* Of points of the disc that follow each other every second is 85 degrees further around, and as far from its middle:
 * where half of the disc is hidden it is both of the two in a quarter of all cases, as if they knew nothing of each
 * other. The next would be 138 degrees further. */
static int nearly_square_to(int k) {
    return (k & ~3) | (k & 1) << 1 | (k >> 1 & 1);
}

static int count_of_sun(const direct_light_setup *setup, const punctual *light) {
    const int count = setup->sun_directions;
    if (light->angular_diameter > 0.0 || count <= PLACES_LATE) return count;
    if (light_samples_are_late(setup)) return PLACES_LATE;
    return count <= PLACES_LEAST ? count : count / 2 > PLACES_LEAST ? count / 2 : PLACES_LEAST;
}

static void list_sun(const direct_light_setup *setup, const punctual *light, light_samples *out) {
    const int count = count_of_sun(setup, light);
    for (int k = 0; k < count; k++) {
        light_sample *b = &out->all[out->count++];
        *b = (light_sample){ .light = light, .face = -1 };
        set_place(b, k, count);
        b->is_repeated = b->is_repeated && light->angular_diameter == 0.0;
        punctual_toward(light, nearly_square_to(k), count, b->toward);
    }
}

/* Where time may run out those with a place are spread over all of them, too, after the others. */
static void list_lights(const direct_light_setup *setup, int places, light_samples *out) {
    const size_t stride = setup->deadline_s > 0.0 ? spread_stride(setup->light_count) : 1;
    for (int placed = 0; placed < 2; placed++) {
        if (placed) out->parallel = out->count;
        for (size_t i = 0; i < setup->light_count && !(placed && setup->only_parallel); i++) {
            const punctual *one = &setup->lights[i * stride % setup->light_count];
            if ((one->kind != PUNCTUAL_DIRECTIONAL) != placed) continue;
            if (placed)
                list_placed(one, places, out);
            else
                list_sun(setup, one, out);
        }
    }
    out->lights = out->count;
}

bool light_samples_list(const direct_light_setup *setup, light_samples *out) {
    size_t most = setup->sky ? setup->sky->patch_count : 0;
    const int places = places_of_placed(setup), each_placed = SHADOW_VIEW_FACES * places;
    const int widest = each_placed > setup->sun_directions ? each_placed : setup->sun_directions;
    *out = (light_samples){ .each_placed = (size_t)each_placed,
                            .all = block_zeroed(jobs_memory(setup->jobs),
                                                most + setup->light_count * (size_t)widest + 1, sizeof *out->all) };
    if (!out->all) return false;
    list_lights(setup, places, out);
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

/* Of p, the share of a light that is seen from a place, 0 or 1 but at the edge of a shadow, pairs of directions from
 * places beside each other know the mean square, and all of them the mean. */
void light_sample_see(const light_sample *b, bool was_lit, bool lit, const double E[3], seen_light *so_far,
                      float *uneven) {
    if (lit) so_far->E += (E[0] + E[1] + E[2]) / 3.0, so_far->p += b->share;
    if (b->direction % 2 && lit && was_lit) so_far->p_squared += 2 * b->share;
    if (!b->ends_light) return;
    const double full = so_far->p > 0.0 ? so_far->E / so_far->p : 0.0; /* by all of it */
    *uneven += (float)(full * full * (so_far->p_squared - so_far->p * so_far->p));
    *so_far = (seen_light){ 0 };
}

size_t light_samples_end_of_view(const light_samples *l, size_t first, size_t end) {
    size_t next = first + 1;
    while (next < end && l->all[next].is_repeated) next++;
    return next;
}

double light_samples_flux(const light_samples *l, size_t first, size_t end) {
    double sum = 0.0;
    for (size_t k = first; k < end; k++)
        for (int c = 0; c < 3; c++) sum += l->all[k].light ? l->all[k].light->intensity[c] : l->all[k].part->flux[c];
    return sum;
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
