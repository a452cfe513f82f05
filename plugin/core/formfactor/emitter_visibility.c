/* SPDX-License-Identifier: MIT */
#include "formfactor/emitter_visibility.h"

#include "base/target_clones.h"
#include "base/tolerance.h"
#include "visibility/occlusion.h"
#include "visibility/visible_part.h"

/* Past so many blockers what is left of an emitter is a mosaic, and rays to RAYS x RAYS of its points cost less. */
enum { BLOCKERS_MAX = 24, RAYS = 16 };

/* How often an emitter is quartered when its visible fragments outgrow their room. Each time the blockers that a
 * quarter shares with the whole about halve. */
enum { QUARTERINGS_MAX = 5 };

/* A ball around a few points. */
static double ball_around(size_t count, const double (*points)[3], double center[3]) {
    double radius = 0.0;
    for (int k = 0; k < 3; k++) center[k] = 0.0;
    for (size_t i = 0; i < count; i++) vec3_add_scaled(center, center, 1.0 / (double)count, points[i]);
    for (size_t i = 0; i < count; i++) radius = fmax(radius, vec3_distance(center, points[i]));
    return radius;
}

static double ball_around_surface(const scene *s, const surface *f, double center[3]) {
    double corners[4][3];
    size_t count = (size_t)surface_corner_count(f);
    for (size_t i = 0; i < count; i++) vec3_copy(corners[i], scene_vertex(s, f->corner[i]));
    return ball_around(count, (const double(*)[3])corners, center);
}

/* Can a surface stand between a point and an emitter? Its plane must have them on two sides, and its ball must reach
 * into the cone from the point to the emitter's ball. */
static bool may_hide(const scene *s, const surface *f, const polygon *emitter, const double emitter_center[3],
                     double emitter_radius, const double point[3]) {
    double height = surface_height(f, point), center[3];
    bool between = false;
    for (int k = 0; k < emitter->count; k++) between = between || surface_height(f, emitter->corner[k]) * height < 0.0;
    if (!between) return false;
    double radius = ball_around_surface(s, f, center);
    return vec3_distance_to_segment(center, point, emitter_center) <= emitter_radius + radius;
}

size_t emitter_visibility_candidates(const scene *s, const polygon *emitter, const double center[3], double radius,
                                     uint32_t *out) {
    double emitter_center[3], emitter_radius = ball_around((size_t)emitter->count, emitter->corner, emitter_center);
    size_t count = 0;
    for (uint32_t i = 0; i < s->surface_count; i++) {
        double at[3];
        if (surface_sheet(s, i) != i || s->surfaces[i].pane) continue;
        double reach = ball_around_surface(s, &s->surfaces[i], at) + fmax(radius, emitter_radius);
        if (vec3_distance_to_segment(at, center, emitter_center) <= reach) out[count++] = i;
    }
    return count;
}

size_t emitter_visibility_list(const emitter_visibility *sight, const polygon *emitter, const double point[3]) {
    const scene *s = sight->scene;
    size_t count = 0, all = sight->candidates ? sight->candidate_count : s->surface_count;
    double center[3], radius = ball_around((size_t)emitter->count, emitter->corner, center);
    for (size_t i = 0; i < all; i++) {
        uint32_t index = sight->candidates ? sight->candidates[i] : (uint32_t)i;
        if (surface_sheet(s, index) == index && !s->surfaces[index].pane &&
            may_hide(s, &s->surfaces[index], emitter, center, radius, point))
            sight->blockers[count++] = index;
    }
    return count;
}

/* ---- past few blockers: exactly ---- */

/* An emitter above the plane of a point, and what stands between. */
typedef struct exact_view {
    polygon emitter;
    const double *point, *normal;
    double margin;
    blocker_list blockers;
} exact_view;

/* surfaces: which ones, or NULL for all. False when out of memory. */
static bool list_blockers(exact_view *g, const scene *s, const uint32_t *surfaces, size_t count,
                          const double emitter_normal[3]) {
    polygon at = { .count = 1 };
    vec3_copy(at.corner[0], g->point);
    const facing_pair pair = { .a = &at,
                               .b = &g->emitter,
                               .normal_a = g->normal,
                               .normal_b = emitter_normal,
                               .plane_a = vec3_dot(g->normal, g->point),
                               .plane_b = vec3_dot(emitter_normal, g->emitter.corner[0]),
                               .margin = g->margin };
    for (size_t k = 0; k < (surfaces ? count : s->surface_count); k++) {
        uint32_t i = surfaces ? surfaces[k] : (uint32_t)k;
        const surface *f = &s->surfaces[i];
        polygon shape = { .count = surface_corner_count(f) };
        if (surface_sheet(s, i) != i || f->pane) continue;
        for (int c = 0; c < shape.count; c++) vec3_copy(shape.corner[c], scene_vertex(s, f->corner[c]));
        if (!blocker_list_add(&g->blockers, &pair, &shape, f->normal, f->plane)) return false;
    }
    return true;
}

/* Fragments that are lost in the smallest quarters count as seen. */
static double factor_of_polygon(const exact_view *g, const polygon *p, int quarterings) {
    bool lost = false;
    polygon quarter[4];
    double factor = visible_factor(&g->blockers, p, g->point, g->normal, g->margin, &lost);
    if (!lost || quarterings == 0) return factor;
    polygon_quarter(p, quarter);
    factor = 0.0;
    for (int q = 0; q < 4; q++) factor += factor_of_polygon(g, &quarter[q], quarterings - 1);
    return factor;
}

/* What is clipped may have more corners than can be quartered: then it is taken as a fan of triangles. */
static double factor_past_blockers(const exact_view *g) {
    const polygon *p = &g->emitter;
    double sum = 0.0;
    if (g->blockers.count == 0) return polygon_factor(p, g->point, g->normal);
    if (p->count <= 4) return factor_of_polygon(g, p, QUARTERINGS_MAX);
    for (int i = 1; i + 1 < p->count; i++) {
        polygon triangle = { .count = 3 };
        vec3_copy(triangle.corner[0], p->corner[0]);
        vec3_copy(triangle.corner[1], p->corner[i]);
        vec3_copy(triangle.corner[2], p->corner[i + 1]);
        sum += factor_of_polygon(g, &triangle, QUARTERINGS_MAX);
    }
    return sum;
}

bool emitter_visibility_exact(const scene *s, const uint32_t *surfaces, size_t count, const polygon *emitter,
                              const double point[3], const double normal[3], double *factor) {
    exact_view g = {
        .point = point, .normal = normal, .margin = TOLERANCE_PLANE * s->radius, .blockers.memory = s->memory
    };
    double emitter_normal[3], unoccluded;
    polygon_vector_area(emitter, emitter_normal);
    *factor = 0.0;
    if (vec3_normalize(emitter_normal) == 0.0) return true;
    polygon_clip(&g.emitter, emitter, normal, vec3_dot(normal, point));
    /* Is the point in front of the emitter? */
    if (g.emitter.count < 3 || !(vec3_dot(emitter_normal, point) >= vec3_dot(emitter_normal, emitter->corner[0])))
        return true;
    bool ok = list_blockers(&g, s, surfaces, count, emitter_normal);
    unoccluded = polygon_factor(&g.emitter, point, normal);
    if (ok && unoccluded > 0.0) *factor = factor_past_blockers(&g);
    blocker_list_free(&g.blockers);
    return ok;
}

/* ---- past many: by rays ---- */

/* A point of a triangle or quad at u, v in [0, 1). */
static void point_on(const polygon *p, double u, double v, double out[3]) {
    const double *d = p->corner[p->count == 4 ? 3 : 0];
    for (int k = 0; k < 3; k++)
        out[k] =
            (1 - v) * ((1 - u) * p->corner[0][k] + u * p->corner[1][k]) + v * ((1 - u) * d[k] + u * p->corner[2][k]);
}

/* From a point to a grid of an emitter's points, axis by axis, so that many rays are asked about at a time. */
typedef struct ray_bundle {
    double along[3][RAYS * RAYS];
    double weight[RAYS * RAYS]; /* as of point sources; 0: not lit from there */
    bool hidden[RAYS * RAYS];
} ray_bundle;

/* Area elements of a triangle's grid grow with v. */
static void aim(ray_bundle *rays, const polygon *emitter, const double point[3], const double normal[3]) {
    double emitter_normal[3];
    polygon_vector_area(emitter, emitter_normal);
    for (int i = 0; i < RAYS * RAYS; i++) {
        double to[3], d[3], v = (i / RAYS + 0.5) / RAYS;
        point_on(emitter, (i % RAYS + 0.5) / RAYS, v, to);
        vec3_sub(d, to, point);
        double r2 = vec3_dot(d, d), cosines = -vec3_dot(d, normal) * vec3_dot(d, emitter_normal);
        bool lit = cosines > 0.0 && r2 > 0.0;
        for (int k = 0; k < 3; k++) rays->along[k][i] = d[k];
        rays->weight[i] = lit ? cosines / (r2 * r2) * (emitter->count == 3 ? v : 1.0) : 0.0;
        rays->hidden[i] = !lit;
    }
}

/* A surface as rays from one point meet it. A ray d crosses its plane at t = -height / (normal . d), and is outside
 * edge k there by start[k] + t (across[k] . d), lengths times that of the edge: as occlusion_inside says, but with all
 * that does not depend on the ray found once. A triangle has its last edge twice. */
typedef struct blocking_view {
    const double *normal;
    double height, start[4], across[4][3];
} blocking_view;

static blocking_view blocking_view_of(const scene *s, const surface *f, const double from[3]) {
    blocking_view v = { .normal = f->normal, .height = surface_height(f, from) };
    int corners = surface_corner_count(f);
    for (int k = 0; k < 4; k++) {
        int i = k < corners ? k : corners - 1;
        const double *a = scene_vertex(s, f->corner[i]);
        double edge[3], offset[3];
        vec3_sub(edge, scene_vertex(s, f->corner[(i + 1) % corners]), a);
        vec3_sub(offset, from, a);
        vec3_cross(v.across[k], edge, f->normal);
        v.start[k] = vec3_dot(v.across[k], offset) - TOLERANCE_EDGE * s->radius * vec3_length(edge);
    }
    return v;
}

/* crossing[i]: where ray i crosses the surface, as a fraction of it; 0 where it does not. */
TARGET_CLONES("avx512f", "avx2", "default")
static void cross_all(const ray_bundle *rays, const blocking_view *v, double crossing[RAYS * RAYS]) {
    for (int i = 0; i < RAYS * RAYS; i++) {
        double x = rays->along[0][i], y = rays->along[1][i], z = rays->along[2][i];
        double t = -v->height / (v->normal[0] * x + v->normal[1] * y + v->normal[2] * z), furthest = 0.0;
        for (int k = 0; k < 4; k++) {
            const double *m = v->across[k];
            double outside = v->start[k] + t * (m[0] * x + m[1] * y + m[2] * z);
            furthest = furthest > outside ? furthest : outside;
        }
        bool is_between = (t > TOLERANCE_SEGMENT_END) & (t < 1 - TOLERANCE_SEGMENT_END);
        crossing[i] = is_between & (furthest <= 0.0) ? t : 0.0;
    }
}

/* Hides the rays that a surface blocks. */
static void block(ray_bundle *rays, const scene *s, const surface *f, const double from[3]) {
    const blocking_view v = blocking_view_of(s, f, from);
    double crossing[RAYS * RAYS];
    cross_all(rays, &v, crossing);
    for (int i = 0; i < RAYS * RAYS; i++) {
        const double d[3] = { rays->along[0][i], rays->along[1][i], rays->along[2][i] };
        double at[3];
        if (rays->hidden[i] || !(crossing[i] > 0.0)) continue;
        vec3_copy(at, from);
        vec3_add_scaled(at, at, crossing[i], d);
        rays->hidden[i] = !f->holes || !alpha_mask_is_hole(f->holes, at);
    }
}

/* How much of an emitter is seen past many blockers, by rays to a grid of its points. */
static double sampled_share(const emitter_visibility *sight, size_t blockers, const polygon *emitter,
                            const double point[3], const double normal[3]) {
    ray_bundle rays;
    double seen = 0.0, all = 0.0;
    aim(&rays, emitter, point, normal);
    for (size_t i = 0; i < blockers; i++)
        block(&rays, sight->scene, &sight->scene->surfaces[sight->blockers[i]], point);
    for (int i = 0; i < RAYS * RAYS; i++) {
        all += rays.weight[i];
        if (!rays.hidden[i]) seen += rays.weight[i];
    }
    return all > 0.0 ? seen / all : 0.0;
}

bool emitter_visibility_has_holes(const emitter_visibility *sight, size_t blockers) {
    for (size_t i = 0; i < blockers; i++)
        if (sight->scene->surfaces[sight->blockers[i]].holes) return true;
    return false;
}

static bool hides_all(const scene *s, const surface *f, const polygon *emitter, const double point[3]) {
    double t;
    for (int k = 0; k < emitter->count; k++)
        if (!occlusion_crossing(f, point, emitter->corner[k], &t) || t <= TOLERANCE_SEGMENT_END ||
            t >= 1 - TOLERANCE_SEGMENT_END || !occlusion_inside(s, f, point, emitter->corner[k], t))
            return false;
    return true;
}

bool emitter_visibility_is_behind_one(const emitter_visibility *sight, size_t blockers, const polygon *emitter,
                                      const double point[3]) {
    for (size_t i = 0; i < blockers; i++)
        if (hides_all(sight->scene, &sight->scene->surfaces[sight->blockers[i]], emitter, point)) return true;
    return false;
}

bool emitter_visibility_is_exact(const emitter_visibility *sight, size_t blockers) {
    return blockers <= BLOCKERS_MAX && !emitter_visibility_has_holes(sight, blockers);
}

bool emitter_visibility_factor(const emitter_visibility *sight, const polygon *emitter, const double point[3],
                               const double normal[3], double *factor) {
    size_t blockers = emitter_visibility_list(sight, emitter, point);
    if (!emitter_visibility_is_exact(sight, blockers)) {
        *factor = polygon_factor(emitter, point, normal) * sampled_share(sight, blockers, emitter, point, normal);
        return true;
    }
    return emitter_visibility_exact(sight->scene, sight->blockers, blockers, emitter, point, normal, factor);
}
