/* SPDX-License-Identifier: MIT
 * Does a material never give back more light than it gets, and is what is no material refused?
 */
#include "check.h"

#include "scene/material.h"

static const double NONE[3] = { 0, 0, 0 };

static void what_is_no_number_is_no_material(void) {
    static const double bad[] = { -1e-9, NAN, INFINITY };
    material m;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const double one[3] = { 0.5, bad[i], 0.5 };
        CHECK(!material_set(&m, one, NONE) && !material_set(&m, NONE, one));
        CHECK(material_set(&m, NONE, NONE) && !material_set_transmission(&m, one, NONE, 1.0, true) &&
              !material_set_transmission(&m, NONE, one, 1.0, true));
    }
    CHECK(!material_set(&m, NONE, (double[]){ 0, 0, 2e30 }));
}

static void exitance_is_pi_times_radiance(void) {
    material m;
    CHECK(material_set(&m, NONE, (double[]){ 1, 2, 0 }));
    CHECK_NEAR(m.M[1], 2 * 3.14159265358979323846, 1e-15);
}

static void shares_never_add_up_to_more_than_all(void) {
    material m;
    const double rho[3] = { 0.6, 0.2, 0.0 }, straight[3] = { 0.5, 0.5, 1.0 }, diffuse[3] = { 0.6, 0.1, 0.0 };
    CHECK(material_set(&m, rho, NONE) && material_set_transmission(&m, straight, diffuse, 0.999, true));
    CHECK(material_clamp(&m, NULL, 0.999));
    for (int c = 0; c < 3; c++) CHECK(m.rho[c] + m.transmittance[c] <= 1.0 && m.diffuse_transmittance[c] <= m.rho[c]);
    CHECK_NEAR(m.diffuse_transmittance[0], 0.6 * 0.999 / 1.2, 1e-15); /* both are reduced alike */
    CHECK_NEAR(m.rho[1], 0.3, 1e-15);
    CHECK_NEAR(m.transmittance[1], 0.5, 0);
    CHECK_NEAR(m.transmittance[2], 1.0, 0);
}

static void what_the_method_does_not_know_is_left_out(void) {
    material m;
    CHECK(material_set(&m, (double[]){ 0.5, 0.5, 0.5 }, NONE));
    CHECK(material_set_transmission(&m, NONE, (double[]){ 0.5, 0.5, 0.5 }, 0.999, false));
    CHECK_NEAR(m.rho[0], 0.5, 0);
    CHECK_NEAR(m.diffuse_transmittance[0], 0, 0);
}

/* So that both, multiplied by the texture again, keep their ratio. */
static void what_is_demodulated_is_reduced_as_much(void) {
    material m, demodulated;
    const double one[3] = { 1, 1, 1 }, half[3] = { 0.5, 0.5, 0.5 };
    CHECK(material_set(&m, one, NONE) && material_set(&demodulated, half, NONE));
    CHECK(material_clamp(&m, &demodulated, 0.8));
    CHECK_NEAR(m.rho[0], 0.8, 0);
    CHECK_NEAR(demodulated.rho[0], 0.4, 1e-15);
    CHECK(!material_clamp(&m, &demodulated, 0.8));
}

static void what_is_wholly_clear_tints_nothing(void) {
    const double none[3] = { 0 }, all[3] = { 1, 1, 1 }, red[3] = { 1, 0, 0 }, half[3] = { 0.5, 0.5, 0.5 };
    CHECK(!material_tints(none, all, none, false));
    CHECK(material_tints(none, all, none, true)); /* somewhere it may be less */
    CHECK(material_tints(none, red, none, false) && material_tints(none, half, none, false));
    CHECK(material_tints(half, all, none, false) && material_tints(none, all, half, false));
    CHECK(!material_tints(half, none, none, true)); /* nothing passes */
}

int main(void) {
    RUN(what_is_no_number_is_no_material);
    RUN(exitance_is_pi_times_radiance);
    RUN(shares_never_add_up_to_more_than_all);
    RUN(what_the_method_does_not_know_is_left_out);
    RUN(what_is_demodulated_is_reduced_as_much);
    RUN(what_is_wholly_clear_tints_nothing);
    return check_end();
}
