/* SPDX-License-Identifier: MIT */
#include "mesh/mesh.h"

#include "mesh/shading_normals.h"
#include "scene/contact_lines.h"

/* Elements on either side of one that say more of its noise than it does itself. */
enum { BESIDE = 8 };

static const double *vertex(const mesh *m, uint32_t index) {
    return m->vertices + 3 * (size_t)index;
}

size_t mesh_most_samples(const mesh *m) {
    size_t most = 0;
    for (size_t p = 0; p < m->patch_count; p++)
        if (m->patches[p].sample_count > most) most = m->patches[p].sample_count;
    return most;
}

polygon mesh_polygon(const mesh *m, const uint32_t corner[4]) {
    polygon out = { .count = corner[3] == NO_INDEX ? 3 : 4 };
    for (int i = 0; i < out.count; i++) vec3_copy(out.corner[i], vertex(m, corner[i]));
    return out;
}

bool mesh_emits(const mesh *m) {
    for (size_t p = 0; p < m->patch_count; p++)
        if (material_emits(&m->patches[p].material)) return true;
    return false;
}

double mesh_mean_around(const mesh *m, const double *amount, size_t e) {
    size_t first = e > BESIDE ? e - BESIDE : 0,
           end = e + BESIDE + 1 < m->element_count ? e + BESIDE + 1 : m->element_count;
    double sum = 0.0, area = 0.0;
    for (size_t i = first; i < end; i++) sum += amount[i], area += m->elements[i].area;
    return area > 0.0 ? sum / area : 0.0;
}

size_t mesh_shooter_count(const mesh *m) {
    size_t patches, clusters = mesh_count_clusters(m, &patches);
    return m->patch_count - patches + clusters;
}

/* What was dissolved is left as a cluster of one. */
size_t mesh_count_clusters(const mesh *m, size_t *patches) {
    size_t count = 0;
    *patches = 0;
    for (size_t i = 0; m->clustering && i < m->clustering->count; i++) {
        uint32_t members = m->clustering->clusters[i].member_count;
        count += members > 1;
        *patches += members > 1 ? members : 0;
    }
    return count;
}

void mesh_dissolve(const mesh *m, uint32_t lead) {
    cluster *c = &m->clustering->clusters[m->clustering->of_patch[lead]];
    for (uint32_t i = 0; i < c->member_count; i++) m->clustering->of_patch[c->members[i]] = NO_INDEX;
    c->member_count = 1;
}

void element_sample_place(int corner_count, int k, double place[2]) {
    bool three = corner_count == 3;
    double low = three ? 1.0 / 6.0 : 0.25, high = three ? 2.0 / 3.0 : 0.75;
    place[0] = k == 1 || (k == 2 && !three) ? high : low;
    place[1] = k >= 2 ? high : low;
}

void element_sample_weights(int corner_count, int k, double weights[4]) {
    double place[2];
    element_sample_place(corner_count, k, place);
    double u = place[0], v = place[1];
    if (corner_count == 3) {
        weights[0] = 1 - u - v, weights[1] = u, weights[2] = v, weights[3] = 0.0;
        return;
    }
    weights[0] = (1 - u) * (1 - v), weights[1] = u * (1 - v), weights[2] = u * v, weights[3] = (1 - u) * v;
}

/* The weights of a triangle's corners, from the one at k on: the part is two triangles of one area, from that corner to
 * the middle of either edge and the centre. */
static void part_of_triangle(const double square[2], double weights[3]) {
    const bool is_second = square[0] >= 0.5;
    const double root = sqrt(2.0 * square[0] - is_second), to_middle = root * (1.0 - square[1]),
                 to_center = root * square[1];
    weights[0] = 1.0 - root + 0.5 * to_middle + to_center / 3.0;
    weights[1 + is_second] = 0.5 * to_middle + to_center / 3.0;
    weights[2 - is_second] = to_center / 3.0;
}

void mesh_sample_part(const mesh *m, const element *e, int k, const double square[2], double out[3]) {
    const double u = 0.5 * square[0], v = 0.5 * square[1];
    double weights[4] = { (1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v };
    int count = element_corner_count(e);
    if (count == 3) part_of_triangle(square, weights);
    for (int c = 0; c < 3; c++) out[c] = 0.0;
    for (int i = 0; i < count; i++)
        vec3_add_scaled(out, out, weights[i], m->vertices + 3 * (size_t)e->corner[(k + i) % count]);
}

static double polygon_diameter(const polygon *p) {
    double diameter = 0.0;
    for (int i = 0; i < p->count; i++)
        for (int j = 0; j < i; j++) diameter = fmax(diameter, vec3_distance(p->corner[i], p->corner[j]));
    return diameter;
}

static void place_samples(mesh *m, const element *e) {
    int count = element_corner_count(e);
    uint32_t first = e->first_sample;
    for (int k = 0; k < count; k++) {
        double weights[4], point[3] = { 0, 0, 0 };
        element_sample_weights(count, k, weights);
        for (int i = 0; i < count; i++) vec3_add_scaled(point, point, weights[i], vertex(m, e->corner[i]));
        m->x[first + k] = point[0], m->y[first + k] = point[1], m->z[first + k] = point[2];
        m->sample_area[first + k] = e->area / count;
    }
}

/* Patches and elements that are measured by one job. */
enum { PATCHES_A_JOB = 256, ELEMENTS_A_JOB = 1024 };

static bool place_all(mesh *m, arena *memory) {
    m->sample_count = 0;
    for (size_t e = 0; e < m->element_count; e++) m->sample_count += (size_t)element_corner_count(&m->elements[e]);
    if (m->sample_count > UINT32_MAX) return false;
    m->x = arena_alloc(memory, m->sample_count, sizeof *m->x);
    m->y = arena_alloc(memory, m->sample_count, sizeof *m->y);
    m->z = arena_alloc(memory, m->sample_count, sizeof *m->z);
    m->sample_area = arena_alloc(memory, m->sample_count, sizeof *m->sample_area);
    if (!m->x || !m->y || !m->z || !m->sample_area) return false;
    uint32_t next = 0;
    for (size_t p = 0; p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        owner->first_sample = next;
        for (uint32_t i = 0; i < owner->element_count; i++) {
            element *e = &m->elements[owner->first_element + i];
            e->patch = (uint32_t)p;
            e->first_sample = next;
            next += (uint32_t)element_corner_count(e);
        }
        owner->sample_count = next - owner->first_sample;
    }
    return true;
}

static void patches_job(void *user, size_t job, unsigned worker) {
    mesh *m = user;
    (void)worker;
    for (size_t p = job * PATCHES_A_JOB; p < (job + 1) * PATCHES_A_JOB && p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        const polygon whole = mesh_polygon(m, owner->corner);
        owner->area = polygon_centroid(&whole, owner->center);
        owner->diameter = polygon_diameter(&whole);
        owner->coverage = 1.0;
    }
}

static void elements_job(void *user, size_t job, unsigned worker) {
    mesh *m = user;
    (void)worker;
    for (size_t i = job * ELEMENTS_A_JOB; i < (job + 1) * ELEMENTS_A_JOB && i < m->element_count; i++) {
        const polygon part = mesh_polygon(m, m->elements[i].corner);
        double centroid[3];
        m->elements[i].area = polygon_centroid(&part, centroid);
        place_samples(m, &m->elements[i]);
    }
}

static bool measure(mesh *m, jobs *j, arena *memory) {
    if (!place_all(m, memory)) return false;
    jobs_run(j, (m->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB, patches_job, NULL, m);
    jobs_run(j, (m->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB, elements_job, NULL, m);
    return true;
}

bool mesh_measure(mesh *m, arena *memory) {
    return measure(m, NULL, memory);
}

static void cover_element(mesh *m, element *e, const alpha_mask *holes) {
    const double *corner[4] = { NULL };
    int count = element_corner_count(e);
    for (int i = 0; i < count; i++) corner[i] = vertex(m, e->corner[i]);
    double coverage = alpha_mask_coverage(holes, corner, count);
    e->area *= coverage;
    for (int k = 0; k < count; k++) m->sample_area[e->first_sample + (uint32_t)k] *= coverage;
}

typedef struct taking_off {
    mesh *mesh;
    const scene *scene;
} taking_off;

static void holes_job(void *user, size_t job, unsigned worker) {
    const taking_off *a = user;
    mesh *m = a->mesh;
    (void)worker;
    for (size_t p = job * PATCHES_A_JOB; p < (job + 1) * PATCHES_A_JOB && p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        const alpha_mask *holes = a->scene->surfaces[owner->surface].holes;
        double whole = 0.0, left = 0.0;
        for (uint32_t i = 0; holes && i < owner->element_count; i++) {
            element *e = &m->elements[owner->first_element + i];
            whole += e->area;
            cover_element(m, e, holes);
            left += e->area;
        }
        if (!(left > 0.0 && left < whole)) continue;
        owner->coverage = left / whole;
        owner->area *= owner->coverage;
    }
}

bool mesh_measure_in_scene(mesh *m, const scene *s, jobs *j, arena *memory) {
    if (!measure(m, j, memory)) return false;
    taking_off a = { m, s };
    if (s->tree) jobs_run(j, (m->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB, holes_job, NULL, &a);
    return shading_normals_sample(m, s, j, memory);
}

/* Others see the surface that a patch lies in or under, not the patch. */
static void clear_hidden_reflectance(patch *p) {
    for (int c = 0; c < 3 && p->contact != CONTACT_OPEN; c++) p->material.rho[c] = 0.0;
}

void mesh_set_materials(mesh *m, const scene *s) {
    for (size_t p = 0; p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        const material *own = &s->materials[s->surfaces[owner->surface].material];
        owner->material = *own;
        clear_hidden_reflectance(owner);
        for (uint32_t i = 0; i < owner->element_count; i++) m->elements[owner->first_element + i].material = own;
    }
}

void mesh_average_materials(mesh *m) {
    for (size_t p = 0; p < m->patch_count; p++) {
        patch *owner = &m->patches[p];
        material mean = { .rho = { 0 } };
        for (uint32_t i = 0; i < owner->element_count; i++) {
            const element *e = &m->elements[owner->first_element + i];
            vec3_add_scaled(mean.rho, mean.rho, e->area / owner->area, e->material->rho);
            vec3_add_scaled(mean.M, mean.M, e->area / owner->area, e->material->M);
            vec3_add_scaled(mean.transmittance, mean.transmittance, e->area / owner->area, e->material->transmittance);
            vec3_add_scaled(mean.diffuse_transmittance, mean.diffuse_transmittance, e->area / owner->area,
                            e->material->diffuse_transmittance);
        }
        if (owner->element_count > 0 && owner->area > 0.0) owner->material = mean;
        clear_hidden_reflectance(owner);
    }
}
