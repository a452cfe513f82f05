/* SPDX-License-Identifier: MIT */
#include "adapt/error_indicator.h"

enum { BANDS = 3 };

/* Of a parabola along an edge h, the best piecewise linear curve is off by 0.0745 h times what the slope departs at the
 * ends from that in the middle (rms); two directions, and steps, are worse. */
static const double SLOPE_SHARE = 0.1;

/* Where elements disagree on the radiance at a vertex they share, as at the edge of a shadow, what is shown ramps from
 * one to the other: over an element of a step's row that leaves step^2 / 12 on the mean, and what its places depart
 * from the averages by is step^2 / 8. */
static const double JUMP_SHARE = 0.8;

/* The bilinear part of a quad's radiance that its two triangles do not show: rms, of the coefficient of uv. */
static const double TWIST_SHARE = 0.05;

/* Where an element shares no vertex with another, as the wall of a house that is one element, nobody says whether its
 * slope goes on or is the edge of a shadow between samples. It counts as an edge where the brightest sample has so many
 * times what the darkest has: two samples on either side of a step in the middle, and a plane through them, leave this
 * share of it (rms). */
static const double EDGE_CONTRAST = 3.0, EDGE_SHARE = 0.29;

/* Samples of at least this share of their area's weight are in the light. */
static const double TRUSTED = 0.5;

/* An element that something stands on in part is off by about this much of its radiance. */
static const double BURIED_FAULT = 0.15;

typedef struct slope {
    double of[BANDS][3]; /* radiance per metre along x, y, z */
} slope;

/* What the elements around a node say about it, weighted by area. */
typedef struct node_mean {
    slope slope;
    double value[BANDS], area;
} node_mean;

typedef struct local_values {
    double value[4][BANDS], mean[BANDS]; /* the mean of what is trusted ... */
    double middle[BANDS], center[3];     /* ... and of all, which is the plane's value at the centre */
    int trusted;
} local_values;

/* What is inside something is taken to be as bright as the rest of the element. */
static local_values local_values_of(const error_indicator_input *in, const element *e) {
    local_values l = { .trusted = 0 };
    int corners = element_corner_count(e);
    bool good[4];
    for (int k = 0; k < corners; k++) {
        size_t s = (size_t)e->first_sample + (size_t)k;
        good[k] = in->weight[s] >= TRUSTED * in->mesh->sample_area[s];
        if (!good[k]) continue;
        l.trusted++;
        for (int c = 0; c < BANDS; c++) l.mean[c] += in->radiance[3 * s + (size_t)c];
    }
    for (int c = 0; c < BANDS && l.trusted; c++) l.mean[c] /= l.trusted;
    for (int k = 0; k < corners; k++)
        for (int c = 0; c < BANDS; c++)
            l.value[k][c] = good[k] ? in->radiance[3 * ((size_t)e->first_sample + (size_t)k) + (size_t)c] : l.mean[c];
    for (int k = 0; k < corners; k++) {
        vec3_add_scaled(l.middle, l.middle, 1.0 / corners, l.value[k]);
        vec3_add_scaled(l.center, l.center, 1.0 / corners, in->mesh->vertices + 3 * (size_t)e->corner[k]);
    }
    return l;
}

/* Along the element's two axes, per unit of reference coordinates. */
static void reference_slope(int corners, const local_values *l, int c, double *du, double *dv) {
    const double one = l->value[1][c] - l->value[0][c];
    if (corners == 3) {
        *du = 2 * one, *dv = 2 * (l->value[2][c] - l->value[0][c]);
        return;
    }
    *du = one + l->value[2][c] - l->value[3][c];
    *dv = l->value[3][c] - l->value[0][c] + l->value[2][c] - l->value[1][c];
}

static void set_slope(const mesh *m, const element *e, const local_values *l, slope *out) {
    int corners = element_corner_count(e);
    const double *origin = m->vertices + 3 * (size_t)e->corner[0];
    double u[3], v[3];
    vec3_sub(u, m->vertices + 3 * (size_t)e->corner[1], origin);
    vec3_sub(v, m->vertices + 3 * (size_t)e->corner[corners - 1], origin);
    double uu = vec3_dot(u, u), uv = vec3_dot(u, v), vv = vec3_dot(v, v), determinant = uu * vv - uv * uv;
    for (int c = 0; c < BANDS; c++) {
        double du, dv;
        reference_slope(corners, l, c, &du, &dv);
        for (int k = 0; k < 3; k++)
            out->of[c][k] =
                determinant > 0.0 ? ((vv * du - uv * dv) * u[k] + (uu * dv - uv * du) * v[k]) / determinant : 0.0;
    }
}

/* What the element's plane of radiance is at a vertex of it. */
static void value_at(const error_indicator_input *in, const element *e, const local_values *l, const slope *own,
                     int place, double value[BANDS]) {
    double offset[3];
    vec3_sub(offset, in->mesh->vertices + 3 * (size_t)element_vertex(e, place), l->center);
    for (int c = 0; c < BANDS; c++) value[c] = l->middle[c] + vec3_dot(own->of[c], offset);
}

static void average_around_nodes(const error_indicator_input *in, const slope *own, node_mean *nodes) {
    for (size_t i = 0; i < in->mesh->element_count; i++) {
        const element *e = &in->mesh->elements[i];
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(e, ring);
        const local_values l = local_values_of(in, e);
        if (l.trusted == 0) continue;
        for (int p = 0; p < places; p++) {
            node_mean *n = &nodes[in->node[ELEMENT_PLACES * i + ring[p]]];
            double value[BANDS];
            value_at(in, e, &l, &own[i], ring[p], value);
            n->area += e->area;
            vec3_add_scaled(n->value, n->value, e->area, value);
            for (int c = 0; c < BANDS; c++) vec3_add_scaled(n->slope.of[c], n->slope.of[c], e->area, own[i].of[c]);
        }
    }
    for (size_t v = 0; v < in->node_count; v++)
        for (int c = 0; c < BANDS && nodes[v].area > 0.0; c++) {
            nodes[v].value[c] /= nodes[v].area;
            for (int k = 0; k < 3; k++) nodes[v].slope.of[c][k] /= nodes[v].area;
        }
}

static double bilinear_term(int corners, const local_values *l) {
    double square = 0.0;
    for (int c = 0; c < BANDS && corners == 4; c++) {
        double twist = 4 * (l->value[0][c] - l->value[1][c] + l->value[2][c] - l->value[3][c]);
        square += TWIST_SHARE * TWIST_SHARE * twist * twist;
    }
    return square;
}

/* Mean squares over the places of the element: of what its slope departs from the averages by, along the surface, and
 * of what its radiance does. */
static void departures(const error_indicator_input *in, size_t index, const local_values *l, const slope *own,
                       const node_mean *nodes, double *slopes, double *values) {
    const element *e = &in->mesh->elements[index];
    int corners = element_corner_count(e);
    uint8_t ring[ELEMENT_PLACES];
    int places = element_ring(e, ring);
    const double *origin = in->mesh->vertices + 3 * (size_t)e->corner[0];
    double u[3], v[3], normal[3];
    vec3_sub(u, in->mesh->vertices + 3 * (size_t)e->corner[1], origin);
    vec3_sub(v, in->mesh->vertices + 3 * (size_t)e->corner[corners - 1], origin);
    vec3_cross(normal, u, v);
    vec3_normalize(normal);
    *slopes = *values = 0.0;
    for (int p = 0; p < places; p++) {
        const node_mean *n = &nodes[in->node[ELEMENT_PLACES * index + ring[p]]];
        double value[BANDS];
        value_at(in, e, l, own, ring[p], value);
        for (int c = 0; c < BANDS; c++) {
            double d[3], jump = n->value[c] - value[c];
            vec3_sub(d, n->slope.of[c], own->of[c]);
            double along = vec3_dot(d, normal);
            *slopes += (vec3_dot(d, d) - along * along) / places;
            *values += jump * jump / places;
        }
    }
}

static bool is_alone(const error_indicator_input *in, size_t index, const node_mean *nodes) {
    const element *e = &in->mesh->elements[index];
    for (int k = 0; k < element_corner_count(e); k++)
        if (nodes[in->node[ELEMENT_PLACES * index + (size_t)k]].area > e->area) return false;
    return true;
}

/* The square of the step that may run between the samples of an element. */
static double step_between(int corners, const local_values *l) {
    double low[BANDS], high[BANDS], square = 0.0, dark = 0.0, bright = 0.0;
    for (int c = 0; c < BANDS; c++) {
        low[c] = high[c] = l->value[0][c];
        for (int k = 1; k < corners; k++)
            low[c] = fmin(low[c], l->value[k][c]), high[c] = fmax(high[c], l->value[k][c]);
        square += (high[c] - low[c]) * (high[c] - low[c]);
        dark += fabs(low[c]), bright += fabs(high[c]);
    }
    return bright > EDGE_CONTRAST * dark ? square : 0.0;
}

/* The square of what samples are the means of and say nothing about: edges of shadows between places that one sample
 * stands for. Slopes from sample to sample go on within each, and are shown. */
static double hidden_within(const error_indicator_input *in, const element *e, const local_values *l) {
    const int corners = element_corner_count(e);
    double variance = 0.0, slopes = 0.0;
    for (int k = 0; k < corners; k++) variance += (double)in->uneven[(size_t)e->first_sample + (size_t)k] / corners;
    for (int c = 0; c < BANDS; c++) {
        double du, dv;
        reference_slope(corners, l, c, &du, &dv);
        slopes += (du * du + dv * dv) / (4 * 12.0);
    }
    return fmax(variance * vec3_dot(e->material->rho, e->material->rho) / (PI * PI) - slopes, 0.0);
}

static double fault_of(const error_indicator_input *in, size_t index, const slope *own, const node_mean *nodes,
                       double *level) {
    const element *e = &in->mesh->elements[index];
    int corners = element_corner_count(e);
    const local_values l = local_values_of(in, e);
    double mean = vec3_dot(l.mean, l.mean);
    *level = 0.0;
    if (material_emits(e->material) || l.trusted == 0) return 0.0;
    *level = mean * e->area * l.trusted / corners;
    double edges = corners == 3 ? 2 * e->area : e->area;
    double slopes, values;
    departures(in, index, &l, own, nodes, &slopes, &values);
    double square =
        SLOPE_SHARE * SLOPE_SHARE * edges * slopes + JUMP_SHARE * JUMP_SHARE * values + bilinear_term(corners, &l);
    if (in->uneven) square += hidden_within(in, e, &l);
    if (is_alone(in, index, nodes)) square += EDGE_SHARE * EDGE_SHARE * step_between(corners, &l);
    if (l.trusted < corners) square += BURIED_FAULT * BURIED_FAULT * mean;
    return square * e->area;
}

bool error_indicator_measure(const error_indicator_input *in, double *fault, double *level) {
    slope *own = block_new(in->mesh->memory, (in->mesh->element_count + 1) * sizeof *own);
    node_mean *nodes = block_new(in->mesh->memory, (in->node_count + 1) * sizeof *nodes);
    bool ok = own && nodes;
    for (size_t v = 0; ok && v < in->node_count; v++) nodes[v] = (node_mean){ .area = 0.0 };
    for (size_t i = 0; ok && i < in->mesh->element_count; i++) {
        const local_values l = local_values_of(in, &in->mesh->elements[i]);
        set_slope(in->mesh, &in->mesh->elements[i], &l, &own[i]);
    }
    if (ok) average_around_nodes(in, own, nodes);
    for (size_t i = 0; ok && i < in->mesh->element_count; i++) fault[i] = fault_of(in, i, &own[i], nodes, &level[i]);
    block_free_all(own, nodes);
    return ok;
}
