/* SPDX-License-Identifier: MIT
 * How wrong is the result? An estimate of the relative error of [Baum89, eq. 12] from what the bake itself can see:
 * light not yet shot, form factors that do not add up, and radiosity that is not linear over an element.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ESTIMATE_H
#define HEMIBAKE_CORE_SOLVER_ESTIMATE_H

typedef struct error_parts {
    double unshot, factors, discretisation;
} error_parts;

/* Light that is unshot will be reflected a share of the mean reflectance at each of its bounces:
 * missing = unshot rho / (1 - rho). Relative to what is reflected in the end. All in W. */
double estimate_unshot_error(double unshot, double reflected, double mean_rho);

/* The parts are independent: root of the sum of squares. */
double estimate_total(const error_parts *parts);

#endif
