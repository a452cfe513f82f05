/* SPDX-License-Identifier: MIT
 * Where does every watt go, and how wrong is the result for having stopped? What is emitted is absorbed, escapes, or
 * waits to be shot. Sums over the rgb bands. Light that comes from outside counts as emitted where it arrives.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ENERGY_H
#define HEMIBAKE_CORE_SOLVER_ENERGY_H

#include "formfactor/column.h"

typedef struct energy_books {
    double emitted, absorbed, escaped, unshot; /* W */
} energy_books;

/* Books one shot. power: of each band, W. absorbed_fraction[c]: share of the power of band c that the receiving fronts
 * absorb; received: share that reaches fronts at all. The rest goes to backs and sky as the hemi-cube saw them. */
void energy_book_shot(energy_books *books, const column *c, const double power[3], const double absorbed_fraction[3],
                      double received);

/* Books light that arrives from outside. power: of each band, W, on a patch of a material; what goes through it is
 * booked where it arrives next. */
void energy_book_direct(energy_books *books, const double power[3], const material *m);

/* |emitted - absorbed - escaped - unshot| / emitted */
double energy_residual(const energy_books *books);

/* The relative error of having stopped [Baum89, eq. 12]; what else is wrong shows only in the result
 * (reconstruct/residual.h). Light that is unshot will be reflected a share of the mean reflectance at each of its
 * bounces: missing = unshot rho / (1 - rho). Relative to what is reflected in the end. All in W. */
double energy_unshot_error(double unshot, double reflected, double mean_rho);

#endif
