/* SPDX-License-Identifier: MIT */
#include "traced_lights.h"

#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double mean(const double rgb[3]) {
    return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

/* ---- powers ------------------------------------------------------------------------------------------------------ */

static double emitter_power(const traced_scene *s, uint32_t triangle) {
    double emission[3];
    traced_scene_mean_emission(s, triangle, emission);
    return PI * mean(emission) * s->triangles[triangle].area * (traced_scene_double_sided(s, triangle) ? 2 : 1);
}

/* What falls into the ball around the scene. */
static double punctual_power(const traced_scene *s, const hemi_light_desc *light) {
    if (light->kind == HEMI_LIGHT_DIRECTIONAL) return PI * s->radius * s->radius * mean(light->intensity);
    double outer = light->outer_cone > 0 ? light->outer_cone : PI / 4;
    double solid_angle = light->kind == HEMI_LIGHT_POINT ? 4 * PI : 2 * PI * (1 - cos(outer));
    return solid_angle * mean(light->intensity);
}

/* Solid angle of a texel of a row. */
static double texel_angle(const hemi_sky_desc *sky, uint32_t row) {
    double top = PI * (0.5 - (double)row / sky->height), bottom = PI * (0.5 - (row + 1.0) / sky->height);
    return (sin(top) - sin(bottom)) * 2 * PI / sky->width;
}

static double texel_radiance(const hemi_sky_desc *sky, size_t texel) {
    double rgb[3];
    for (size_t c = 0; c < 3; c++) rgb[c] = sky->radiance[c] * (double)sky->image[3 * texel + c];
    return mean(rgb);
}

/* Makes shares of sums; the last one is 1 whatever rounding says. */
static double to_shares(double *sums, size_t count) {
    double total = count ? sums[count - 1] : 0;
    for (size_t i = 0; i < count; i++) sums[i] = total > 0 ? sums[i] / total : (i + 1.0) / (double)count;
    return total;
}

/* Its power, int L dw over the sphere times the disc of the scene; below 0: out of memory. */
static double create_sky(traced_lights *l) {
    const hemi_sky_desc *sky = &l->scene->sky;
    if (!sky->image) return 0;
    l->rows = malloc(sky->height * sizeof *l->rows);
    l->columns = malloc((size_t)sky->height * sky->width * sizeof *l->columns);
    if (!l->rows || !l->columns) return -1;
    double flux = 0;
    for (uint32_t r = 0; r < sky->height; r++) {
        double *row = l->columns + (size_t)r * sky->width, sum = 0;
        for (uint32_t c = 0; c < sky->width; c++)
            row[c] = sum += texel_radiance(sky, (size_t)r * sky->width + c) * texel_angle(sky, r);
        l->rows[r] = flux += to_shares(row, sky->width);
    }
    to_shares(l->rows, sky->height);
    return flux * PI * l->scene->radius * l->scene->radius;
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static void list_emitters(traced_lights *l) {
    const traced_scene *s = l->scene;
    double sum = 0;
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        double power = emitter_power(s, t);
        l->index[t] = UINT32_MAX;
        if (!(power > 0)) continue;
        l->index[t] = (uint32_t)l->emitter_count;
        l->cumulative[l->emitter_count] = sum += power;
        l->emitters[l->emitter_count++] = t;
    }
}

bool traced_lights_create(const traced_scene *s, traced_lights *l) {
    size_t most = s->triangle_count + s->light_count + 1;
    *l = (traced_lights){ .scene = s };
    l->emitters = malloc(most * sizeof *l->emitters);
    l->cumulative = malloc(most * sizeof *l->cumulative);
    l->index = malloc(most * sizeof *l->index);
    double sky = l->emitters && l->cumulative && l->index ? create_sky(l) : -1;
    if (sky < 0) {
        traced_lights_destroy(l);
        return false;
    }
    list_emitters(l);
    l->count = l->emitter_count;
    double sum = l->count ? l->cumulative[l->count - 1] : 0;
    for (uint32_t i = 0; i < s->light_count; i++) l->cumulative[l->count++] = sum += punctual_power(s, &s->lights[i]);
    if (l->rows) l->cumulative[l->count++] = sum + sky;
    if (!(to_shares(l->cumulative, l->count) > 0)) l->count = 0;
    return true;
}

void traced_lights_destroy(traced_lights *l) {
    free(l->emitters);
    free(l->cumulative);
    free(l->index);
    free(l->rows);
    free(l->columns);
    memset(l, 0, sizeof *l);
}

/* ---- picking ----------------------------------------------------------------------------------------------------- */

/* The first whose share reaches u; u becomes where in it u lies. */
static size_t pick(const double *shares, size_t count, double *u) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (shares[middle] > *u)
            high = middle;
        else
            low = middle + 1;
    }
    double before = low ? shares[low - 1] : 0, share = shares[low] - before;
    *u = share > 0 ? fmin(fmax((*u - before) / share, 0), 1) : 0;
    return low;
}

static double share_of(const double *shares, size_t i) {
    return shares[i] - (i ? shares[i - 1] : 0);
}

/* ---- sampling ---------------------------------------------------------------------------------------------------- */

/* Evenly by area: a point of the unit square, folded along its diagonal [Heitz, A low-distortion map, 2019]. */
static void place_in_triangle(const double u[2], double weights[3]) {
    double a = u[0], b = u[1];
    if (b > a) {
        a /= 2;
        b -= a;
    } else {
        b /= 2;
        a -= b;
    }
    weights[0] = 1 - a - b;
    weights[1] = a;
    weights[2] = b;
}

static bool sample_emitter(const traced_lights *l, size_t light, const traced_point *at, const double u[2],
                           traced_light_sample *out) {
    uint32_t triangle = l->emitters[light];
    const traced_triangle *t = &l->scene->triangles[triangle];
    double weights[3], rho[3], place[3] = { 0, 0, 0 };
    place_in_triangle(u, weights);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) place[k] += weights[i] * t->corner[i][k];
        out->toward[k] = place[k] - at->eye[k];
    }
    out->distance = vec3_normalize(out->toward);
    double cosine = -vec3_dot(out->toward, t->normal);
    if (traced_scene_double_sided(l->scene, triangle)) cosine = fabs(cosine);
    if (!(cosine > 0)) return false;
    traced_scene_shade(l->scene, triangle, weights, rho, out->radiance);
    out->density = share_of(l->cumulative, light) * out->distance * out->distance / (cosine * t->area);
    return true;
}

/* How much of a spot's light goes that way: glTF's smooth edge. [KHR_lights_punctual] */
static double spot_share(const hemi_light_desc *light, const double toward[3]) {
    double axis[3];
    vec3_copy(axis, light->direction);
    vec3_normalize(axis);
    double outer = cos(light->outer_cone > 0 ? light->outer_cone : PI / 4), inner = cos(light->inner_cone);
    /* The least width is that of the extension's own code; where the two are one the edge is sharp. */
    double width = inner > outer ? fmax(inner - outer, 0.001) : 1e-9;
    double share = (-vec3_dot(axis, toward) - outer) / width;
    share = fmin(fmax(share, 0), 1);
    return share * share;
}

/* Two unit vectors at a right angle to a third. */
static void frame(const double n[3], double x[3], double y[3]) {
    const double helper[3] = { fabs(n[0]) > 0.5 ? 0 : 1, fabs(n[0]) > 0.5 ? 1 : 0, 0 };
    vec3_cross(x, helper, n);
    vec3_normalize(x);
    vec3_cross(y, n, x);
}

static void sample_sun(const hemi_light_desc *light, const double u[2], traced_light_sample *out) {
    double toward[3] = { -light->direction[0], -light->direction[1], -light->direction[2] }, x[3], y[3];
    vec3_normalize(toward);
    frame(toward, x, y);
    double sine = sin(light->angular_diameter / 2) * sqrt(u[0]), angle = 2 * PI * u[1];
    double cosine = sqrt(fmax(0, 1 - sine * sine));
    for (int k = 0; k < 3; k++) out->toward[k] = cosine * toward[k] + sine * (cos(angle) * x[k] + sin(angle) * y[k]);
    vec3_copy(out->radiance, light->intensity);
    out->distance = INFINITY;
}

static bool sample_punctual(const hemi_light_desc *light, const traced_point *at, const double u[2],
                            traced_light_sample *out) {
    out->sizeless = true;
    if (light->kind == HEMI_LIGHT_DIRECTIONAL) {
        sample_sun(light, u, out);
        return true;
    }
    vec3_sub(out->toward, light->position, at->eye);
    double r = out->distance = vec3_normalize(out->toward), share = 1 / (r * r);
    if (light->kind == HEMI_LIGHT_SPOT) share *= spot_share(light, out->toward);
    if (light->range > 0) share *= fmax(0, 1 - pow(r / light->range, 4));
    for (int c = 0; c < 3; c++) out->radiance[c] = share * light->intensity[c];
    return share > 0;
}

static void sample_sky(const traced_lights *l, const double u[2], traced_light_sample *out) {
    const hemi_sky_desc *sky = &l->scene->sky;
    double in_row = u[0], in_column = u[1];
    uint32_t r = (uint32_t)pick(l->rows, sky->height, &in_row);
    uint32_t c = (uint32_t)pick(l->columns + (size_t)r * sky->width, sky->width, &in_column);
    double top = sin(PI * (0.5 - (double)r / sky->height)), bottom = sin(PI * (0.5 - (r + 1.0) / sky->height));
    double height = bottom + in_row * (top - bottom), angle = 2 * PI * ((c + in_column) / sky->width - 0.5);
    double level = sqrt(fmax(0, 1 - height * height));
    out->toward[0] = level * cos(angle);
    out->toward[1] = height;
    out->toward[2] = level * sin(angle);
    out->distance = INFINITY;
    traced_scene_sky(l->scene, out->toward, out->radiance);
    out->density = traced_lights_density_of_sky(l, out->toward);
}

bool traced_lights_sample(const traced_lights *l, const traced_point *at, const double u[2], traced_light_sample *out) {
    double v[2] = { u[0], u[1] };
    if (l->count == 0) return false;
    *out = (traced_light_sample){ 0 };
    size_t light = pick(l->cumulative, l->count, &v[0]), punctual = light - l->emitter_count;
    if (light < l->emitter_count) return sample_emitter(l, light, at, v, out);
    if (punctual < l->scene->light_count) {
        out->density = share_of(l->cumulative, light);
        return sample_punctual(&l->scene->lights[punctual], at, v, out);
    }
    sample_sky(l, v, out);
    return out->density > 0;
}

/* ---- densities --------------------------------------------------------------------------------------------------- */

double traced_lights_density_at(const traced_lights *l, const traced_point *from, const traced_point *met) {
    uint32_t light = l->index[met->triangle];
    double toward[3];
    if (light == UINT32_MAX || l->count == 0) return 0;
    vec3_sub(toward, met->position, from->eye);
    double r = vec3_normalize(toward), cosine = -vec3_dot(toward, met->normal);
    return share_of(l->cumulative, light) * r * r / (fmax(cosine, 1e-12) * l->scene->triangles[met->triangle].area);
}

double traced_lights_density_of_sky(const traced_lights *l, const double d[3]) {
    const hemi_sky_desc *sky = &l->scene->sky;
    if (!l->rows || l->count == 0) return 0;
    double u = 0.5 + atan2(d[2], d[0]) / (2 * PI), v = 0.5 - asin(fmax(-1, fmin(1, d[1]))) / PI;
    uint32_t c = (uint32_t)fmin(u * sky->width, sky->width - 1), r = (uint32_t)fmin(v * sky->height, sky->height - 1);
    return share_of(l->cumulative, l->count - 1) * share_of(l->rows, r) *
           share_of(l->columns + (size_t)r * sky->width, c) / texel_angle(sky, r);
}
