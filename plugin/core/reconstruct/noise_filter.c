/* SPDX-License-Identifier: MIT
 * See noise_filter.h.
 */
#include "reconstruct/noise_filter.h"

#include "geometry/vec3.h"

#include <math.h>
#include <string.h>

/* So many steps over shared vertices, and so many elements at most; a plane is fitted to so many at least. */
enum { RINGS = 2, AROUND_MAX = 40, AROUND_MIN = 4, ELEMENTS_A_JOB = 64 };

/* Elements are alike where they, with those beside them, differ by less than so many times their noise, which counts as
 * no more than this share of their light: what differs by more is hardly the same light, however noisy it is. */
static const double ALIKE = 1.5, NOISE_MAX = 0.1;

/* The few samples of one element, whose bands are noisy alike, agree by chance by about so many times their noise, and
 * not by more than the latter. */
static const double BY_CHANCE = 1.0, NEVER_BY_CHANCE = 6.0;

/* Elements beside each other look the same way to this cosine. */
static const double SAME_WAY = 0.9;

/* See plane_at. */
static const double STEEPEST = 0.5;

/* A sample that sees less than this share is inside something. */
static const double SEES = 0.5;

/* A list of neighbours is found in by hashes, several times as many as there are: by the golden ratio [Knuth98]. */
enum { PLACES = 128, HASH_SHIFT = 32 - 7 };
static const uint32_t HASH = UINT32_C(2654435769);

enum { BANDS = 6 }; /* irradiance, and half of what the halves differ in */

/* Irradiance and its slopes, in the element's own axes. */
typedef struct plane {
    float at[3][3];
} plane;

typedef struct filter {
    const noise_filter_input *in;
    uint32_t *first, *elements; /* elements[first[n] .. first[n+1]): those at node n */
    double *mean;               /* mean[BANDS*e+b] over its samples */
    double *center, *normal;    /* center[3*e+k]; of what it is part of */
    double *around;             /* around[3*e+c]: the mean of the means of e and those beside it */
    double *variance;           /* variance[e]: of that, all bands */
    double *agreed, *noise;     /* S and N of each element's own samples, against its plane */
    bool *is_inside;            /* of each element: of none or few of its samples is known what they see */
    float *spread;              /* spread[e]: what the plane of e keeps of a sample's noise, squared */
    plane *planes;
} filter;

/* ---- neighbours ---- */

static bool list_at_nodes(filter *f) {
    const mesh *m = f->in->mesh;
    size_t corners = 0;
    for (size_t e = 0; e < m->element_count; e++) {
        int count = element_corner_count(&m->elements[e]);
        for (int k = 0; k < count; k++) f->first[m->nodes[m->elements[e].corner[k]] + 1]++;
        corners += (size_t)count;
    }
    for (size_t n = 0; n < m->node_count; n++) f->first[n + 1] += f->first[n];
    uint32_t *next = block_new(m->memory, (m->node_count + 1) * sizeof *next);
    f->elements = block_new(m->memory, (corners + 1) * sizeof *f->elements);
    bool ok = next && f->elements;
    if (ok) memcpy(next, f->first, m->node_count * sizeof *next);
    for (uint32_t e = 0; ok && e < m->element_count; e++)
        for (int k = 0; k < element_corner_count(&m->elements[e]); k++)
            f->elements[next[m->nodes[m->elements[e].corner[k]]]++] = e;
    block_free(next);
    return ok;
}

static const double *normal_of(const filter *f, uint32_t e) {
    const mesh *m = f->in->mesh;
    return f->in->scene->surfaces[m->patches[m->elements[e].patch].surface].normal;
}

/* Elements are listed once, though each is met at all of its corners, by all that are there. */
typedef struct listed {
    uint32_t *around; /* [AROUND_MAX] */
    int count;
    uint8_t place[PLACES]; /* 1 + where in the list, by what the element hashes to, or the next that is free */
} listed;

static void list(listed *l, uint32_t e, uint32_t place) {
    l->around[l->count++] = e;
    l->place[place] = (uint8_t)l->count;
}

/* Where an element is in the places, or would be. */
static uint32_t place_of(const listed *l, uint32_t e) {
    uint32_t place = e * HASH >> HASH_SHIFT;
    while (l->place[place] && l->around[l->place[place] - 1] != e) place = (place + 1) % PLACES;
    return place;
}

static void list_if_alike(const filter *f, uint32_t e, uint32_t other, listed *l) {
    uint32_t place = place_of(l, other);
    if (l->place[place] || f->is_inside[other]) return;
    if (vec3_dot(f->normal + 3 * (size_t)e, f->normal + 3 * (size_t)other) >= SAME_WAY) list(l, other, place);
}

/* Lists an element and those so many rings around it; how many. */
static int list_around(const filter *f, uint32_t e, int rings, uint32_t around[AROUND_MAX]) {
    const mesh *m = f->in->mesh;
    int begin = 0;
    listed l = { .around = around };
    list(&l, e, place_of(&l, e));
    for (int ring = 0; ring < rings; ring++) {
        int end = l.count;
        for (; begin < end; begin++) {
            const element *one = &m->elements[around[begin]];
            for (int k = 0; k < element_corner_count(one); k++) {
                uint32_t n = m->nodes[one->corner[k]];
                for (uint32_t i = f->first[n]; i < f->first[n + 1] && l.count < AROUND_MAX; i++)
                    list_if_alike(f, e, f->elements[i], &l);
            }
        }
    }
    return l.count;
}

/* ---- means and noise ---- */

/* Of the light with noise at a sample: A + B over 2, and A - B over 2. */
static void values_at(const filter *f, size_t s, double out[BANDS]) {
    for (size_t c = 0; c < 3; c++) {
        out[c] = f->in->irradiance[3 * s + c] - (f->in->exact ? f->in->exact[3 * s + c] : 0.0);
        out[3 + c] = f->in->half_difference[3 * s + c];
    }
}

static void mean_job(void *user, size_t job, unsigned worker) {
    filter *f = user;
    const mesh *m = f->in->mesh;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < (job + 1) * ELEMENTS_A_JOB && e < m->element_count; e++) {
        const element *one = &m->elements[e];
        int corners = element_corner_count(one), seeing = 0;
        for (int k = 0; k < corners; k++) {
            size_t s = one->first_sample + (size_t)k;
            const double place[3] = { m->x[s], m->y[s], m->z[s] };
            double values[BANDS];
            values_at(f, s, values);
            for (size_t b = 0; b < BANDS; b++) f->mean[BANDS * e + b] += values[b] / corners;
            vec3_add_scaled(f->center + 3 * e, f->center + 3 * e, 1.0 / corners, place);
            seeing += f->in->row_sum[s] > SEES;
        }
        f->is_inside[e] = seeing < corners;
        memcpy(f->normal + 3 * e, normal_of(f, (uint32_t)e), 3 * sizeof *f->normal);
    }
}

static void variance_job(void *user, size_t job, unsigned worker) {
    filter *f = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < (job + 1) * ELEMENTS_A_JOB && e < f->in->mesh->element_count; e++) {
        uint32_t around[AROUND_MAX];
        int count = list_around(f, (uint32_t)e, 1, around);
        for (int i = 0; i < count; i++)
            for (size_t c = 0; c < 3; c++) {
                double half = f->mean[BANDS * around[i] + 3 + c];
                f->around[3 * e + c] += f->mean[BANDS * around[i] + c] / count;
                f->variance[e] += half * half / count / count;
            }
    }
}

/* ---- planes ---- */

/* Solves the symmetric system of three unknowns for each band; false: it has no single solution. */
static bool solve(double a[3][3], double b[3][3]) {
    for (int i = 0; i < 3; i++) {
        if (!(a[i][i] > 1e-9 * a[0][0])) return false;
        for (int r = i + 1; r < 3; r++) {
            double share = a[r][i] / a[i][i];
            for (int c = i; c < 3; c++) a[r][c] -= share * a[i][c];
            for (int k = 0; k < 3; k++) b[k][r] -= share * b[k][i];
        }
    }
    for (int k = 0; k < 3; k++)
        for (int i = 2; i >= 0; i--) {
            for (int c = i + 1; c < 3; c++) b[k][i] -= a[i][c] * b[k][c];
            b[k][i] /= a[i][i];
        }
    return true;
}

typedef struct frame {
    const double *origin;
    double u[3], v[3], scale;
} frame;

static frame frame_of(const filter *f, uint32_t e) {
    frame out = { .origin = f->center + 3 * (size_t)e, .scale = sqrt(fmax(f->in->mesh->elements[e].area, 1e-300)) };
    vec3_tangents(normal_of(f, e), out.u, out.v);
    return out;
}

static void place_in(const frame *at, const double point[3], double out[3]) {
    double to[3];
    vec3_sub(to, point, at->origin);
    out[0] = 1.0, out[1] = vec3_dot(to, at->u) / at->scale, out[2] = vec3_dot(to, at->v) / at->scale;
}

/* What a sample holds, and where it lies in the frame of its element. */
static void sample_in(const filter *f, const frame *at, size_t s, double values[BANDS], double place[3]) {
    const mesh *m = f->in->mesh;
    const double point[3] = { m->x[s], m->y[s], m->z[s] };
    values_at(f, s, values);
    place_in(at, point, place);
}

/* How much an element says about another. */
static double weight_of(const filter *f, uint32_t e, uint32_t other, double distance, double reach) {
    double off = 0.0, level = 0.0, noise = f->variance[e] + f->variance[other], share = distance / reach;
    for (size_t c = 0; c < 3; c++) {
        double d = f->around[3 * (size_t)other + c] - f->around[3 * (size_t)e + c];
        off += d * d;
        level += f->around[3 * (size_t)e + c] * f->around[3 * (size_t)e + c];
    }
    noise = fmin(noise, NOISE_MAX * NOISE_MAX * level);
    if (other == e) return 1.0;
    return noise > 0.0 ? (1.0 - share * share) * exp(-off / (ALIKE * ALIKE * noise)) : 0.0;
}

static void fit_plane(filter *f, uint32_t e) {
    uint32_t around[AROUND_MAX];
    double place[AROUND_MAX][3], reach = 0.0, a[3][3] = { { 0 } }, b[3][3] = { { 0 } };
    double squares = 0.0;
    const frame at = frame_of(f, e);
    int count = list_around(f, e, RINGS, around);
    for (int i = 0; i < count; i++) {
        place_in(&at, f->center + 3 * (size_t)around[i], place[i]);
        reach = fmax(reach, 1.1 * sqrt(place[i][1] * place[i][1] + place[i][2] * place[i][2]));
    }
    for (int i = 0; i < count; i++) {
        double w =
            weight_of(f, e, around[i], sqrt(place[i][1] * place[i][1] + place[i][2] * place[i][2]), fmax(reach, 1e-30));
        squares += w * w;
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) a[r][c] += w * place[i][r] * place[i][c];
            for (size_t k = 0; k < 3; k++) b[k][r] += w * place[i][r] * f->mean[BANDS * (size_t)around[i] + k];
        }
    }
    f->spread[e] = (float)(squares / (a[0][0] * a[0][0]) / element_corner_count(&f->in->mesh->elements[e]));
    double level = a[0][0], sum[3] = { b[0][0], b[1][0], b[2][0] };
    bool fits = count >= AROUND_MIN && solve(a, b);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) f->planes[e].at[k][i] = (float)(fits ? b[k][i] : i == 0 ? sum[k] / level : 0.0);
}

/* A quarter of an element from its middle light is no less than a share of what is there: where none is alike, elements
 * across the edge of a shadow give a plane its slopes, and it would fall to nothing within its own. */
static double plane_at(const plane *p, int band, const double place[3]) {
    double middle = (double)p->at[band][0];
    return fmax(middle + (double)p->at[band][1] * place[1] + (double)p->at[band][2] * place[2], STEEPEST * middle);
}

static void plane_job(void *user, size_t job, unsigned worker) {
    filter *f = user;
    const mesh *m = f->in->mesh;
    (void)worker;
    for (uint32_t e = (uint32_t)(job * ELEMENTS_A_JOB); e < (job + 1) * ELEMENTS_A_JOB && e < m->element_count; e++) {
        const element *one = &m->elements[e];
        if (f->is_inside[e]) continue;
        fit_plane(f, e);
        const frame at = frame_of(f, e);
        int corners = element_corner_count(one);
        for (int k = 0; k < corners; k++) {
            double values[BANDS], place[3];
            sample_in(f, &at, one->first_sample + (size_t)k, values, place);
            for (int c = 0; c < 3; c++) {
                double r = values[c] - plane_at(&f->planes[e], c, place), d = values[3 + c];
                f->agreed[e] += (r * r - d * d) / corners;
                f->noise[e] += d * d / corners;
            }
        }
    }
}

/* ---- filtering ---- */

/* S around an element, the first of those that are listed. An edge of light goes on from one element to the next: what
 * stands out in one or two alone is chance, so these are left out of the mean, and the element's own counts as far as
 * another's does, or as far as chance never goes. */
static double agreed_around(const filter *f, const uint32_t *around, int count, double noise) {
    double sum = 0.0, most = -INFINITY, next = -INFINITY;
    for (int i = 0; i < count; i++) {
        double one = f->agreed[around[i]];
        sum += one;
        next = one > most ? most : fmax(next, one);
        most = fmax(most, one);
    }
    double mean = count > 3 ? (sum - most - next) / (count - 2) : sum / count;
    double own = f->agreed[around[0]];
    return fmax(mean, fmax(fmin(own, next) - BY_CHANCE * noise, own - NEVER_BY_CHANCE * noise));
}

static void filter_job(void *user, size_t job, unsigned worker) {
    filter *f = user;
    const mesh *m = f->in->mesh;
    (void)worker;
    for (uint32_t e = (uint32_t)(job * ELEMENTS_A_JOB); e < (job + 1) * ELEMENTS_A_JOB && e < m->element_count; e++) {
        const element *one = &m->elements[e];
        uint32_t around[AROUND_MAX];
        double noise = 0.0;
        if (f->is_inside[e]) continue;
        int count = list_around(f, e, 1, around);
        for (int i = 0; i < count; i++) noise += f->noise[around[i]] / count;
        if (!(noise > 0.0)) continue;
        double agreed = agreed_around(f, around, count, noise);
        double share = fmax(agreed, 0.0) / (fmax(agreed, 0.0) + noise);
        double left = sqrt(share + (1.0 - share) * (1.0 - share) * (double)f->spread[e]);
        const frame at = frame_of(f, e);
        for (int k = 0; k < element_corner_count(one); k++) {
            double values[BANDS], place[3];
            size_t s = one->first_sample + (size_t)k;
            sample_in(f, &at, s, values, place);
            for (size_t c = 0; c < 3; c++) {
                double p = plane_at(&f->planes[e], (int)c, place);
                f->in->irradiance[3 * s + c] += fmax(p + share * (values[c] - p), 0.0) - values[c];
                f->in->half_difference[3 * s + c] *= left;
            }
        }
    }
}

static bool allocate(filter *f) {
    const mesh *m = f->in->mesh;
    size_t count = m->element_count + 1;
    f->first = block_zeroed(m->memory, m->node_count + 2, sizeof *f->first);
    f->mean = block_zeroed(m->memory, BANDS * count, sizeof *f->mean);
    f->center = block_zeroed(m->memory, 3 * count, sizeof *f->center);
    f->normal = block_new(m->memory, 3 * count * sizeof *f->normal);
    f->around = block_zeroed(m->memory, 3 * count, sizeof *f->around);
    f->variance = block_zeroed(m->memory, count, sizeof *f->variance);
    f->agreed = block_zeroed(m->memory, count, sizeof *f->agreed);
    f->noise = block_zeroed(m->memory, count, sizeof *f->noise);
    f->is_inside = block_zeroed(m->memory, count, sizeof *f->is_inside);
    f->spread = block_zeroed(m->memory, count, sizeof *f->spread);
    f->planes = block_new(m->memory, count * sizeof *f->planes);
    return f->first && f->mean && f->center && f->normal && f->around && f->variance && f->agreed && f->noise &&
           f->is_inside && f->spread && f->planes;
}

bool noise_filter(const noise_filter_input *in) {
    static void (*const passes[])(void *user, size_t job, unsigned worker) = { mean_job, variance_job, plane_job,
                                                                               filter_job };
    filter f = { .in = in };
    bool ok = allocate(&f) && list_at_nodes(&f);
    for (int i = 0; ok && i < 4; i++)
        jobs_run(in->jobs, (in->mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB, passes[i], NULL, &f);
    block_free_all(f.first, f.elements, f.mean, f.center, f.normal, f.around, f.variance, f.agreed, f.noise,
                   f.is_inside, f.spread, f.planes);
    return ok;
}
