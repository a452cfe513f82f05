/* SPDX-License-Identifier: MIT */
#include "solver/energy.h"

void energy_book_shot(energy_books *books, const column *c, const double power[3], const double absorbed_fraction[3],
                      double received) {
    double lost = 1.0 - received, beyond = c->closure.back + c->closure.sky;
    /* With nothing but fronts in sight, what the samples missed counts as absorbed. */
    double to_sky = beyond > 0.0 ? lost * c->closure.sky / beyond : 0.0;
    for (int band = 0; band < 3; band++) {
        books->absorbed += power[band] * (absorbed_fraction[band] + lost - to_sky);
        books->escaped += power[band] * to_sky;
    }
}

void energy_book_direct(energy_books *books, const double power[3], const material *m) {
    for (int band = 0; band < 3; band++) {
        books->emitted += power[band] * (1.0 - m->transmittance[band]);
        books->absorbed += power[band] * (1.0 - m->rho[band] - m->transmittance[band]);
    }
}

double energy_residual(const energy_books *books) {
    double rest = books->emitted - books->absorbed - books->escaped - books->unshot;
    return books->emitted > 0.0 ? fabs(rest) / books->emitted : 0.0;
}

double energy_unshot_error(double unshot, double reflected, double mean_rho) {
    double missing = unshot * mean_rho / (1.0 - mean_rho);
    return missing > 0.0 ? missing / (reflected + missing) : 0.0;
}
