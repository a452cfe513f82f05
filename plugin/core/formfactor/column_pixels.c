/* SPDX-License-Identifier: MIT
 * What does every element get from a shooter, by the original progressive refinement? The pixels of one hemi-cube on
 * the shooter's centre are counted [Baum89, eq. 7] and the sum is turned round by reciprocity [Baum89, eq. 8]:
 *
 *     F_ei = F_ie A_i / A_e,   F_ie = sum of the weights of the pixels that show e
 *
 * Nothing is done about what the paper finds wrong with it: shooters near their receivers, shooters seen in part,
 * elements smaller than a pixel.
 */
#include "formfactor/column_worker.h"

#include "base/tolerance.h"

static void count_pixels(column_worker *w, const double *weights) {
    const column_setup *setup = w->setup;
    const mesh *m = setup->mesh;
    size_t pixel_count = 3 * (size_t)w->cube.resolution * (size_t)w->cube.resolution;
    hemicube_closure *closure = &w->statistics.closure;
    for (size_t q = 0; q < pixel_count; q++) {
        uint32_t id = w->cube.ids[q];
        if (id == 0) {
            closure->sky += weights[q];
            continue;
        }
        uint32_t e = mesh_items_facing(setup->elements, setup->scene, id, w->cube.eye);
        if (e == NO_INDEX) {
            closure->back += weights[q];
            continue;
        }
        closure->front += weights[q];
        w->element[e] += weights[q];
        column_mark_reached(w, m->elements[e].patch);
    }
}

void column_shoot_pixels(column_worker *w, const subpatch *shooter) {
    const column_setup *setup = w->setup;
    const mesh *m = setup->mesh;
    const surface *f = &setup->scene->surfaces[m->patches[shooter->patch].surface];
    bool light = material_emits(&m->patches[shooter->patch].material);
    double eye[3];
    w->cube.resolution = light ? setup->resolution_light : setup->resolution;
    vec3_add_scaled(eye, shooter->center, TOLERANCE_EYE_LIFT * setup->scene->radius, f->normal);
    hemicube_place(&w->cube, eye, f->normal, 0.0);
    if (!hemicube_draw(&w->cube, w->items, setup->scene->center)) w->failed = true;
    w->statistics.hemicubes++;
    count_pixels(w, light ? setup->weights_light : setup->weights);
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->element_count; k++) {
            uint32_t index = receiver->first_element + k;
            const element *e = &m->elements[index];
            double factor = w->element[index] * shooter->area / e->area;
            for (int c = 0; c < element_corner_count(e); c++) w->sum[e->first_sample + c] = factor;
            w->statistics.evaluations += factor > 0.0;
            w->element[index] = 0.0;
        }
    }
}
