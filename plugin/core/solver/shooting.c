/* SPDX-License-Identifier: MIT */
#include "solver/shooting.h"

#include "scene/contact_lines.h"
#include "solver/energy.h"
#include "solver/gather.h"
#include "solver/subdivision.h"

#include <string.h>

/* Shooters whose powers differ by less than this share take their turns by number, not by rounding: corners of a room
 * that are alike must not be told apart by its scale. */
static const double SAME_POWER = 1e-6;

/* What a dim place has unshot is little of all there is, but may be most of what it has. Once little of all is unshot,
 * who has had a column shoots until less than this share of its own is left, unless that is less than so much of all.
 */
static const double OF_ITS_OWN = 0.05, OF_ALL = 1e-8;

/* Of a lamp whose light mostly misses the scene, as one of 10 cm does 40 m above a yard, little is unshot from the
 * start, and all that the yard's walls give each other is less. What is left is then judged by what has been reflected:
 * it counts as no more than so many times that. In rooms, where a quarter of the light and more is reflected, nothing
 * changes. */
static const double MOST_OF_REFLECTED = 4.0;

/* W; of what the target is a fraction. */
static double light_to_shoot(const shooting *s) {
    double emitted = s->out->books.emitted;
    return s->setup->unshot_is_of_emitted ? emitted : fmin(emitted, MOST_OF_REFLECTED * s->reflected);
}

void shooting_emit(shooting *s) {
    double rho = 0.0, area = 0.0;
    s->out->books = (energy_books){ 0 };
    s->out->light_count = 0;
    s->reflected = 0.0;
    for (size_t p = 0; p < s->mesh->patch_count; p++) {
        const patch *one = &s->mesh->patches[p];
        const material *m = &one->material;
        double power[3];
        shooters_direct(s->shooters, (uint32_t)p, s->setup->arrived, power);
        for (int k = 0; k < 3; k++) {
            power[k] *= one->area;
            s->out->books.emitted += m->M[k] * one->area;
            s->reflected += m->rho[k] * power[k];
        }
        if (one->contact != CONTACT_COPY) energy_book_direct(&s->out->books, power, m);
        s->out->light_count += material_emits(m);
        rho += one->area * (m->rho[0] + m->rho[1] + m->rho[2]) / 3.0;
        area += one->area;
    }
    s->mean_rho = rho / area;
    s->out->books.unshot = s->unshot_magnitude = s->out->books.emitted - s->out->books.absorbed;
}

bool shooting_report(shooting *s) {
    double t = s->setup->clock() - s->setup->start_s;
    if (s->setup->time_limit_s > 0.0 && t > s->setup->time_limit_s) s->out_of_time = true;
    if (s->setup->stop && *s->setup->stop) s->out_of_time = true;
    if (!s->setup->progress) return true;
    /* Unshot power falls about geometrically, so progress is counted in its logarithm. */
    double left = s->unshot_magnitude / s->out->books.emitted;
    double of_all = s->setup->unshot_target * light_to_shoot(s) / s->out->books.emitted;
    double fraction = of_all > 0.0 && left > 0.0 ? fmin(log(left) / log(of_all), 1.0) : left > 0.0 ? 0.0 : 1.0;
    s->fraction = fmax(s->fraction, fraction);
    if (!s->setup->progress(s->setup->progress_user, s->fraction, s->out->shots, fmin(left, 1.0)))
        s->out->cancelled = true;
    return !s->out->cancelled;
}

static bool add_curve_point(shooting *s) {
    progressive_result *r = s->out;
    if ((r->curve_count & (r->curve_count - 1)) == 0) {
        progressive_point *grown = block_resize(jobs_memory(s->setup->jobs), r->curve,
                                                (r->curve_count ? 2 * r->curve_count : 1) * sizeof *grown);
        if (!grown) return false;
        r->curve = grown;
    }
    r->unshot_fraction = s->unshot_magnitude / r->books.emitted;
    r->unshot_error = energy_unshot_error(s->unshot_magnitude, s->reflected, s->mean_rho);
    r->factor_error = s->factor_error_weight > 0.0 ? sqrt(s->factor_error_sum / s->factor_error_weight) : 0.0;
    progressive_point point = { .t_s = s->setup->clock() - s->setup->start_s,
                                .unshot_fraction = r->unshot_fraction,
                                .unshot_error = r->unshot_error,
                                .shots = r->shots,
                                .analytic = s->store->statistics.analytic,
                                .evaluations = s->store->statistics.evaluations };
    r->curve[r->curve_count++] = point;
    if (s->observed) {
        memcpy(s->observed, r->irradiance, 3 * s->mesh->sample_count * sizeof *s->observed);
        if (!gather_all(s->shooters, s->setup->jobs, s->observed)) return false;
        s->setup->observe(s->setup->observe_user, &point, s->observed);
    }
    return true;
}

/* ---- the three steps of a shot ---- */

/* The shooter with the most unshot power; sums all on the way. */
static uint32_t find_shooter(shooting *s) {
    uint32_t best = 0;
    double most = 0.0, sum = 0.0;
    for (size_t i = 0; i < s->shooters->count; i++) {
        double power = shooter_unshot_power(&s->shooters->all[i]);
        sum += power;
        if (power > most * (1.0 + SAME_POWER)) most = power, best = (uint32_t)i;
    }
    s->unshot_magnitude = sum;
    return best;
}

/* Cuts a shooter before its first shot if it is too large for its light. 1: it was cut; 0: not; -1: out of memory. */
static int subdivide(shooting *s, uint32_t index) {
    shooter *one = &s->shooters->all[index];
    if (!s->subdivides || one->shots > 0 || !subdivision_is_possible(s->shooters, index)) return 0;
    const patch *p = &s->mesh->patches[one->subpatch.patch];
    const material *m = shooter_material(s->shooters, index);
    gather_patch(s->shooters, one->subpatch.patch, s->out->irradiance, s->radiosity);
    for (size_t k = 0; k < 3 * (size_t)p->sample_count; k++)
        s->radiosity[k] = m->M[k % 3] + m->rho[k % 3] * s->radiosity[k];
    bool too_large = subdivision_by_gradient(s->shooters, index, s->radiosity) ||
                     (one->column && subdivision_by_factor(one->column));
    if (!too_large) return 0;
    if (one->column) column_store_count(s->store, index), column_store_drop(s->store, index);
    return subdivision_quarter(s->shooters, index, s->radiosity) ? 1 : -1;
}

/* What the shooter will get back of the light that the others have unshot now: rho sum_j F_ij unshot_j, W/m2. */
static void overshoot(const shooting *s, uint32_t index, double over[3]) {
    const shooter *from = &s->shooters->all[index];
    const double *rho = shooter_material(s->shooters, index)->rho;
    for (int k = 0; k < 3; k++) over[k] = 0.0;
    for (size_t i = 0; i < from->column->run_count; i++) {
        uint32_t to = from->column->runs[i].patch;
        double unshot[3], F = shooter_average(from, i) * s->mesh->patches[to].area / from->subpatch.area;
        shooters_patch_unshot(s->shooters, to, unshot);
        for (int k = 0; k < 3; k++) over[k] += rho[k] * F * from->column->runs[i].tint[k] * unshot[k];
    }
    /* Who owes light pays first. */
    for (int k = 0; k < 3; k++)
        if (from->unshot[k] <= 0.0) over[k] = 0.0;
}

void shooting_distribute(shooting *s, uint32_t index, const double B[3]) {
    shooter *from = &s->shooters->all[index];
    const column *c = from->column;
    column_store_count(s->store, index);
    double power[3], absorbed[3] = { 0, 0, 0 }, received = 0.0, area = from->subpatch.area;
    for (int k = 0; k < 3; k++) {
        power[k] = B[k] * area;
        from->unshot[k] -= B[k];
        from->shot[k] += B[k];
        from->shot_in_all[k] += B[k];
        s->out->books.unshot -= power[k];
    }
    for (size_t i = 0; i < c->run_count; i++) {
        uint32_t to = c->runs[i].patch;
        const material *m = shooter_material(s->shooters, to);
        bool is_copy = s->mesh->patches[to].contact == CONTACT_COPY; /* it gets what another has got already */
        double gain[3], share = is_copy ? 0.0 : s->mesh->patches[to].area * shooter_average(from, i) / area;
        shooters_receive(s->shooters, from, i, B, gain);
        for (int k = 0; k < 3; k++) {
            s->out->books.unshot += gain[k];
            s->reflected += gain[k];
            double passed = share * c->runs[i].tint[k];
            received += passed * (1.0 - m->transmittance[k]) / 3.0;
            absorbed[k] += passed * (1.0 - m->rho[k] - m->transmittance[k]);
        }
    }
    energy_book_shot(&s->out->books, c, power, absorbed, received);
    if (c->closure.front > 0.0 && !c->tints) {
        double off = c->total / c->closure.front - 1.0, weight = fabs(power[0]) + fabs(power[1]) + fabs(power[2]);
        s->factor_error_sum += weight * off * off;
        s->factor_error_weight += weight;
    }
    from->shots++;
    s->out->shots++;
}

void shooting_make_room(shooting *s, uint32_t index) {
    if (!column_store_is_full(s->store)) return;
    gather_deliver(s->shooters, index, s->out->irradiance);
    column_store_drop(s->store, index);
}

/* ---- the loop ---- */

static bool is_done(shooting *s) {
    progressive_result *r = s->out;
    r->converged = s->unshot_magnitude <= s->setup->unshot_target * light_to_shoot(s);
    if (!r->converged && s->setup->error_target > 0.0)
        r->converged =
            energy_unshot_error(s->unshot_magnitude, s->reflected, s->mean_rho) < 0.25 * s->setup->error_target;
    return r->converged || r->cancelled || s->out_of_time;
}

/* The column of a shooter that is about to shoot; cuts it first where it must be. *cut: look for another shooter. */
static const char *prepare(shooting *s, uint32_t index, bool *cut) {
    int before = subdivide(s, index);
    size_t count = mesh_shooter_count(s->mesh);
    const char *failure = before == 0 ? column_store_fetch(s->store, index) : NULL;
    if (failure || s->out->cancelled) return failure;
    bool dissolved = mesh_shooter_count(s->mesh) > count;
    int after = before == 0 && s->shooters->all[index].column ? subdivide(s, index) : 0;
    *cut = before != 0 || after != 0 || dissolved;
    return before < 0 || after < 0 ? "out of memory" : NULL;
}

/* A shot of a shooter that has its column. */
static void shoot(shooting *s, uint32_t index) {
    double B[3], over[3] = { 0, 0, 0 };
    if (s->over_shoots) overshoot(s, index, over);
    for (int k = 0; k < 3; k++) B[k] = s->shooters->all[index].unshot[k] + over[k];
    shooting_distribute(s, index, B);
    shooting_make_room(s, index);
}

/* Of those that have had a column, kept or not, the one with the most unshot power of whom that is much. False: there
 * is none. */
static bool find_dim(const shooting *s, uint32_t *best) {
    double most = OF_ALL * s->out->books.emitted;
    bool any = false;
    for (size_t i = 0; i < s->shooters->count; i++) {
        const shooter *one = &s->shooters->all[i];
        const double *B = one->shot_in_all;
        double power = shooter_unshot_power(one), own = (fabs(B[0]) + fabs(B[1]) + fabs(B[2])) * one->subpatch.area;
        if (!one->is_counted || power <= OF_ITS_OWN * own || power <= most * (1.0 + SAME_POWER)) continue;
        most = power, *best = (uint32_t)i, any = true;
    }
    return any;
}

const char *shooting_shoot_dim(shooting *s) {
    uint32_t index;
    while (!s->out_of_time && !s->out->cancelled && find_dim(s, &index)) {
        const char *failure = column_store_fetch(s->store, index);
        if (failure) return failure;
        if (!s->shooters->all[index].column) break; /* ended on the way */
        shoot(s, index);
        if (s->out->shots % 64 == 0) shooting_report(s);
    }
    find_shooter(s); /* which sums what is unshot */
    return add_curve_point(s) ? NULL : "out of memory";
}

const char *shooting_run(shooting *s) {
    uint32_t next_point = s->out->shots;
    for (;;) {
        uint32_t index = find_shooter(s);
        if (s->out->shots >= next_point) {
            next_point = s->out->shots + s->out->shots / 4 + 1;
            if (!add_curve_point(s)) return "out of memory";
        }
        if (is_done(s)) break;
        bool cut = false;
        const char *failure = prepare(s, index, &cut);
        if (failure || s->out->cancelled) return failure;
        if (cut) continue;
        if (!s->shooters->all[index].column) {
            shooting_report(s);
            if (s->out_of_time) break;
            return "a form-factor column is missing";
        }
        shoot(s, index);
        if (s->out->shots % 64 == 0 && !shooting_report(s)) return NULL;
    }
    return add_curve_point(s) ? NULL : "out of memory";
}
