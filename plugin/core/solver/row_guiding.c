/* SPDX-License-Identifier: MIT
 * See row_guiding.h.
 */
#include "solver/row_guiding.h"

#include "base/morton.h"
#include "geometry/vec3.h"
#include "solver/row_rays.h"

#include <math.h>
#include <string.h>

/* Elements of a group. Measured on a room with a window of a thousandth of the hemisphere: 4,000 samples of 16 rays
 * find it some dozens of times. */
enum { GROUP = 256, GROUPS_SHARING = ROW_GROUPS_SHARING };

/* What is brighter than the mean by this factor is worth a target. */
static const double BRIGHT = 1.5;

/* A ball reaches further than the third nearest of the others, so that balls cover what they were drawn from: what
 * they miss is left to rays by the cosine, which weigh much. */
enum { NEAREST = 3 };
static const double WIDER = 1.5;

/* An opening is as far as what is seen beside it at less than this angle (sine); beyond, it is the open sky. */
static const double BESIDE_OPENING = 0.26;

/* So many of the surfaces that a group sees are compared for that. */
enum { SEEN_MAX = 2048 };

typedef struct guiding_build {
    const row_rays *rays;
    const double *luminance;
    const row_guiding *from;
    row_guiding *out;
    atomic_bool failed; /* out of memory */
} guiding_build;

/* What all rays of the groups that share hit, element after element: each is looked up once. */
typedef struct lit_rays {
    double *luminance;
    size_t first[GROUPS_SHARING + 1]; /* of the rays of each group */
} lit_rays;

/* ---- groups ---- */

static void center_of(const mesh *m, size_t element_index, double out[3]) {
    const element *e = &m->elements[element_index];
    int corners = element_corner_count(e);
    out[0] = out[1] = out[2] = 0.0;
    for (int k = 0; k < corners; k++) vec3_add_scaled(out, out, 1.0 / corners, m->vertices + 3 * (size_t)e->corner[k]);
}

/* Which of the six sides of a box an element faces; the last are those that reflect nothing, whose light nobody asks
 * for. Neighbours that face elsewhere see other things: the outside of a wall sees all of the sky. */
static uint64_t facing_of(const row_rays *r, const element *e) {
    const double *n = r->scene->surfaces[r->mesh->patches[e->patch].surface].normal;
    if (!material_reflects(e->material)) return 6;
    int k = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) > fabs(n[k])) k = 2;
    return (uint64_t)(2 * k + (n[k] < 0.0));
}

/* Elements side by side along a curve that fills space: each run of them is a group. */
static bool order_elements(const row_rays *r, uint32_t *order, uint32_t *of_element) {
    const mesh *m = r->mesh;
    size_t count = m->element_count;
    morton_place *places = block_new(m->memory, (count + 1) * sizeof *places);
    for (size_t e = 0; places && e < count; e++) {
        double center[3];
        center_of(m, e, center);
        places[e] = (morton_place){ morton_code(center, r->scene->center, r->scene->radius), (uint32_t)e };
        places[e].code |= facing_of(r, &m->elements[e]) << MORTON_BITS;
    }
    if (places) morton_sort(places, count);
    for (size_t i = 0; places && i < count; i++) {
        order[i] = places[i].index;
        of_element[places[i].index] = (uint32_t)(i / GROUP);
    }
    block_free(places);
    return places;
}

/* ---- who has the rows of a group ---- */

bool row_guiding_share(const row_rays *of, ranks *r, row_sharing *out) {
    size_t count = of->mesh->element_count + 1;
    if (!r) return row_sharing_open(NULL, of->mesh, NULL, 1, out);
    uint32_t *order = block_new(of->mesh->memory, count * sizeof *order),
             *of_element = block_new(of->mesh->memory, count * sizeof *of_element);
    bool ok = order && of_element && order_elements(of, order, of_element) &&
              row_sharing_open(r, of->mesh, of_element, GROUPS_SHARING, out);
    block_free_all(order, of_element);
    return ok;
}

static bool is_own(const guiding_build *a, size_t group) {
    return row_sharing_is_own(a->rays->sharing, a->out->order[GROUP * group]);
}

static rank_part part_of_group(const void *user, size_t group) {
    const guiding_build *a = user;
    const size_t size = sizeof *a->out->groups;
    return (rank_part){ a->rays->sharing->owner[a->out->order[GROUP * group]], group * size, size };
}

/* Groups, and what elements vary by. False: out of memory, or others are lost. */
static bool give(const guiding_build *a) {
    const row_sharing *s = a->rays->sharing;
    if (!s || !s->owner) return true;
    return ranks_exchange(s->ranks, s->mesh->memory, a->out->group_count, part_of_group, a, a->out->groups) &&
           row_sharing_give_elements(s, a->out->seen, sizeof *a->out->seen);
}

/* ---- what rays hit ---- */

/* A sample, whose lobes are needed only where the sky is uneven: where else a ray's direction is asked for, they are
 * found then. */
static row_sampler sampler_of(const guiding_build *a, uint32_t e, int corner, row_lobes *lobes) {
    if (row_sky_is_even(a->rays)) return (row_sampler){ .element = e, .corner = corner };
    return row_sampler_guided(a->rays, a->from, e, corner, lobes);
}

static double luminance_of(const guiding_build *a, const row_sampler *at, size_t i) {
    const row_rays *r = a->rays;
    uint32_t hit = r->hit[row_begin(r, at->element, at->corner) + i];
    double L[3];
    if (hit <= ROW_HIT_ELEMENT) return a->luminance[hit];
    if (hit == ROW_HIT_PANES)
        return row_panes_luminance(&r->panes, r->mesh->elements[at->element].first_sample + (size_t)at->corner,
                                   (uint32_t)i, a->luminance);
    if (hit == ROW_HIT_BACK || !r->lights->has_sky) return 0.0;
    row_sky(r, at, i, L);
    return PI * (L[0] + L[1] + L[2]);
}

static double weight_of(const guiding_build *a, const row_sampler *at, size_t i) {
    return (double)a->rays->weight[row_begin(a->rays, at->element, at->corner) + i];
}

/* Looks up what a sample's rays hit; its mean and variance, added. */
static void add_statistics(const guiding_build *a, const row_sampler *at, double *luminance, double *mean,
                           double *variance) {
    double sum = 0.0, squares = 0.0, count = (double)row_count(a->rays, at->element);
    for (size_t j = 0; j < row_count(a->rays, at->element); j++) {
        double L = luminance[j] = luminance_of(a, at, j), w = weight_of(a, at, j);
        sum += w * L, squares += w * L * L;
    }
    *mean += sum;
    *variance += fmax(squares - sum * sum, 0.0) * count / (count - 1.0);
}

/* Returns how many rays the group has. */
static size_t measure_group(const guiding_build *a, size_t index, double *luminance) {
    row_group *g = &a->out->groups[index];
    double samples = 0.0;
    size_t next = 0;
    for (size_t i = GROUP * index; i < GROUP * (index + 1) && i < a->out->element_count; i++) {
        uint32_t e = a->out->order[i];
        int corners = element_corner_count(&a->rays->mesh->elements[e]);
        double mean = 0.0, variance = 0.0;
        for (int k = 0; k < corners; k++, next += row_count(a->rays, e)) {
            row_lobes lobes;
            const row_sampler at = sampler_of(a, e, k, &lobes);
            add_statistics(a, &at, luminance + next, &mean, &variance);
        }
        a->out->seen[e] = (row_seen){ (float)(mean / corners), (float)(variance / corners) };
        g->mean += mean, g->variance += variance;
        samples += corners;
    }
    g->mean /= samples, g->variance /= samples;
    return next;
}

/* ---- targets, by systematic resampling ---- */

/* Rays of the elements order[first .. end) whose light is above a level, each by what it is above it. */
typedef struct resampling {
    const guiding_build *a;
    const double *luminance; /* of all rays of these elements */
    size_t first, end;
    double level, total, step, next; /* step 0: only the total is found */
    row_target *targets;
    uint32_t count, most;
    double (*seen)[3]; /* centres of what the rays hit */
    size_t seen_count;
} resampling;

/* Where a ray that hit the sky passed what else is seen most nearly; false: that is not near. */
static bool opening_of(const resampling *p, const double from[3], const double direction[3], double *distance) {
    double best = BESIDE_OPENING * BESIDE_OPENING;
    *distance = 0.0;
    for (size_t i = 0; i < p->seen_count; i++) {
        double to[3];
        vec3_sub(to, p->seen[i], from);
        double square = vec3_dot(to, to), along = vec3_dot(to, direction);
        double sine = 1.0 - along * along / square;
        if (along <= 0.0 || sine >= best) continue;
        best = sine, *distance = sqrt(square);
    }
    return *distance > 0.0;
}

static row_target target_of(const resampling *p, const row_sampler *at, size_t i) {
    const row_rays *r = p->a->rays;
    double direction[3], distance = 0.0;
    uint32_t hit;
    row_target out = { .radius = 0.0 };
    row_lobes lobes;
    const row_sampler placed = row_sampler_guided(r, p->a->from, at->element, at->corner, &lobes), *whole = &placed;
    row_direction(r, whole, i, direction);
    bool is_sky = r->hit[row_begin(r, at->element, at->corner) + i] == ROW_HIT_SKY;
    bool is_near = is_sky ? opening_of(p, whole->from, direction, &distance)
                          : rays_measure(r->rays, whole->from, direction, &hit, &distance) == RAY_FRONT;
    vec3_copy(out.at, direction);
    /* Past something near either may be what counts, so half of them are openings. */
    if (is_sky && r->lights->glow && (!is_near || p->count % 2) && sky_glow_pdf(r->lights->glow, direction) > 0.0)
        return out;
    out.radius = 1.0;
    if (is_near)
        vec3_add_scaled(out.at, whole->from, distance, direction);
    else
        out.radius = -1.0;
    return out;
}

static void resample_row(resampling *p, const row_sampler *at, const double *luminance) {
    /* What reflects nothing has no use for targets, and would tell others of a sky that only it sees. */
    bool asks = material_reflects(p->a->rays->mesh->elements[at->element].material);
    size_t count = asks ? row_count(p->a->rays, at->element) : 0;
    for (size_t i = 0; i < count; i++) {
        double above = luminance[i] - p->level;
        if (above <= 0.0) continue;
        p->total += above * weight_of(p->a, at, i);
        if (p->step <= 0.0 || p->total < p->next || p->count == p->most) continue;
        p->targets[p->count++] = target_of(p, at, i);
        p->next += p->step * floor(1.0 + (p->total - p->next) / p->step);
    }
}

static void resample_rows(resampling *p) {
    const double *luminance = p->luminance;
    p->total = 0.0;
    for (size_t i = p->first; i < p->end; i++) {
        uint32_t e = p->a->out->order[i];
        for (int k = 0; k < element_corner_count(&p->a->rays->mesh->elements[e]); k++) {
            resample_row(p, &(row_sampler){ .element = e, .corner = k }, luminance);
            luminance += row_count(p->a->rays, e);
        }
    }
}

static void collect_seen(resampling *p) {
    const row_rays *r = p->a->rays;
    size_t all = 0, step;
    for (size_t i = p->first; i < p->end; i++) all += row_count(r, p->a->out->order[i]);
    step = 1 + all / SEEN_MAX;
    for (size_t i = p->first, k = 0; i < p->end; i++) {
        size_t e = p->a->out->order[i];
        for (size_t j = 0; j < row_count(r, e); j++, k++)
            if (k % step == 0 && r->hit[r->begin[e] + j] <= ROW_HIT_ELEMENT && p->seen_count < SEEN_MAX)
                center_of(r->mesh, r->hit[r->begin[e] + j], p->seen[p->seen_count++]);
    }
}

static uint32_t resample(const guiding_build *a, const double *luminance, size_t first_group, size_t group_count,
                         double mean, row_target *targets, uint32_t most) {
    resampling p = { .a = a,
                     .luminance = luminance,
                     .first = GROUP * first_group,
                     .level = BRIGHT * mean,
                     .targets = targets,
                     .most = most };
    p.end = GROUP * (first_group + group_count);
    if (p.end > a->out->element_count) p.end = a->out->element_count;
    resample_rows(&p);
    if (!(p.total > 0.0)) return 0;
    p.step = p.total / most, p.next = 0.5 * p.step;
    p.seen = block_new(a->rays->mesh->memory, SEEN_MAX * sizeof *p.seen);
    if (p.seen) collect_seen(&p);
    resample_rows(&p);
    block_free(p.seen);
    return p.count;
}

static bool is_alike(const row_target *a, const row_target *b) {
    return (a->radius < 0.0) == (b->radius < 0.0) && (a->radius > 0.0) == (b->radius > 0.0);
}

static void set_radius(row_group *g, uint32_t i) {
    double nearest[NEAREST];
    for (int k = 0; k < NEAREST; k++) nearest[k] = INFINITY;
    for (uint32_t j = 0; j < g->target_count; j++) {
        if (j == i || !is_alike(&g->targets[i], &g->targets[j])) continue;
        double distance = vec3_distance(g->targets[i].at, g->targets[j].at);
        for (int k = 0; k < NEAREST; k++)
            if (distance < nearest[k]) {
                double moved = nearest[k];
                nearest[k] = distance, distance = moved;
            }
    }
    double radius = fmax(WIDER * nearest[NEAREST - 1], 1e-30);
    g->targets[i].radius = g->targets[i].radius < 0.0 ? -radius : radius;
}

void row_group_set_radii(row_group *g) {
    for (uint32_t k = 0; k < g->target_count; k++)
        if (g->targets[k].radius != 0.0) set_radius(g, k);
}

/* The groups that share with the group first, and what all rays of theirs hit. NULL luminance: out of memory. */
static size_t look_up(const guiding_build *a, size_t first, lit_rays *out) {
    size_t groups = a->out->group_count - first < GROUPS_SHARING ? a->out->group_count - first : GROUPS_SHARING;
    size_t count = 0;
    for (size_t i = GROUP * first; i < GROUP * (first + groups) && i < a->out->element_count; i++) {
        uint32_t e = a->out->order[i];
        count += row_count(a->rays, e) * (size_t)element_corner_count(&a->rays->mesh->elements[e]);
    }
    out->luminance = block_new(a->rays->mesh->memory, (count + 1) * sizeof *out->luminance);
    out->first[0] = 0;
    for (size_t i = 0; out->luminance && i < groups; i++)
        out->first[i + 1] = out->first[i] + measure_group(a, first + i, out->luminance + out->first[i]);
    return groups;
}

/* Groups that share. */
static void groups_job(void *user, size_t index, unsigned worker) {
    guiding_build *a = user;
    size_t first = GROUPS_SHARING * index;
    row_group *groups = a->out->groups + first;
    row_target shared[ROW_LOBES_SHARED];
    lit_rays lit;
    double mean = 0.0;
    (void)worker;
    if (!is_own(a, first)) return;
    size_t count = look_up(a, first, &lit);
    if (!lit.luminance) {
        atomic_store(&a->failed, true);
        return;
    }
    for (size_t i = 0; i < count; i++) mean += groups[i].mean;
    uint32_t shared_count = resample(a, lit.luminance, first, count, mean / (double)count, shared, ROW_LOBES_SHARED);
    for (size_t i = 0; i < count; i++) {
        row_group *g = &groups[i];
        g->own_count = resample(a, lit.luminance + lit.first[i], first + i, 1, g->mean, g->targets, ROW_LOBES_OWN);
        memcpy(g->targets + g->own_count, shared, shared_count * sizeof *g->targets);
        g->target_count = g->own_count + shared_count;
        row_group_set_radii(g);
    }
    block_free(lit.luminance);
}

/* Elements are where they were. */
static bool take_order(const row_rays *r, const row_guiding *from, row_guiding *out) {
    if (!from) return order_elements(r, out->order, out->of_element);
    memcpy(out->order, from->order, out->element_count * sizeof *out->order);
    memcpy(out->of_element, from->of_element, out->element_count * sizeof *out->of_element);
    return true;
}

bool row_guiding_create(const row_rays *r, const row_guiding *from, jobs *j, const double *luminance,
                        row_guiding *out) {
    size_t count = r->mesh->element_count, groups = (count + GROUP - 1) / GROUP;
    allocator *memory = r->mesh->memory;
    *out = (row_guiding){ .glow = r->lights->glow,
                          .of_element = block_new(memory, (count + 1) * sizeof *out->of_element),
                          .order = block_new(memory, (count + 1) * sizeof *out->order),
                          .element_count = count,
                          .group_count = groups,
                          .groups = block_zeroed(memory, groups + 1, sizeof *out->groups),
                          .seen = block_new(memory, (count + 1) * sizeof *out->seen) };
    guiding_build a = { .rays = r, .luminance = luminance, .from = from, .out = out };
    bool ok = out->of_element && out->order && out->groups && out->seen && take_order(r, from, out);
    if (ok) {
        jobs_run(j, (groups + GROUPS_SHARING - 1) / GROUPS_SHARING, groups_job, NULL, &a);
        ok = !atomic_load(&a.failed) && give(&a) && row_guiding_borrow(out, memory);
    }
    if (!ok) row_guiding_free(out);
    return ok;
}

void row_guiding_free(row_guiding *a) {
    block_free_all(a->of_element, a->order, a->groups, a->seen);
    memset(a, 0, sizeof *a);
}
