/* SPDX-License-Identifier: MIT
 * What does over-shooting save? Shots until 1 %, 0.1 % and 0.01 % of the light are unshot, in the plain order and with
 * over-shooting, on the paper's room as it is, and with walls that reflect more.
 */
#include "accuracy/paper_room.h"

#include <stdio.h>

enum { TARGETS = 3 };

static const double targets[TARGETS] = { 1e-2, 1e-3, 1e-4 };

static bool count_shots(paper_room *p, jobs *j, bool plain, uint32_t shots[TARGETS], double *mean) {
    for (int i = 0; i < TARGETS; i++) {
        char message[200];
        progressive_result r;
        progressive_setup setup = paper_setup(p, SOLVER_HYBRID, j, paper_seconds);
        setup.columns.resolution = setup.columns.resolution_light = 64;
        double weights[3 * 64 * 64];
        hemicube_weights(64, weights);
        setup.columns.weights = setup.columns.weights_light = weights;
        setup.unshot_target = targets[i];
        setup.plain_order = plain;
        setup.open_rows = true;
        const char *failure = progressive_solve(&setup, &r, message, sizeof message);
        if (failure) fprintf(stderr, "%s\n", failure);
        shots[i] = failure ? 0 : r.shots;
        *mean = 0.0;
        for (size_t s = 0; !failure && s < p->room.mesh.sample_count; s++)
            *mean += p->room.mesh.sample_area[s] * r.irradiance[3 * s + 1];
        progressive_result_free(&r);
        if (failure) return false;
    }
    return true;
}

static bool compare(double brighter) {
    static paper_room p;
    uint32_t plain[TARGETS], over[TARGETS];
    double mean_plain, mean_over;
    memset(&p, 0, sizeof p);
    paper_room_create(&p);
    for (size_t i = 0; i < p.room.material_count; i++)
        for (int c = 0; c < 3; c++) p.room.materials[i].rho[c] = 1 - (1 - p.room.materials[i].rho[c]) / brighter;
    mesh_set_materials(&p.room.mesh, &p.room.scene);
    jobs *j = jobs_create(0);
    bool ok = count_shots(&p, j, true, plain, &mean_plain) && count_shots(&p, j, false, over, &mean_over);
    printf("white walls reflect %.2f\n%10s %10s %10s %8s\n", 1 - 0.3 / brighter, "unshot", "plain", "over", "ratio");
    for (int i = 0; ok && i < TARGETS; i++)
        printf("%9g%% %10u %10u %8.2f\n", 100 * targets[i], plain[i], over[i], (double)plain[i] / over[i]);
    printf("mean irradiance differs by %.1e\n\n", fabs(mean_over / mean_plain - 1));
    jobs_destroy(j);
    paper_room_free(&p);
    return ok;
}

int main(void) {
    return compare(1) && compare(3) ? 0 : 1;
}
