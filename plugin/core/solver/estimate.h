/* SPDX-License-Identifier: MIT
 * How wrong is the result for having stopped? The relative error of [Baum89, eq. 12] by light not yet shot. What else
 * is wrong shows only in the result: reconstruct/residual.h.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ESTIMATE_H
#define HEMIBAKE_CORE_SOLVER_ESTIMATE_H

/* Light that is unshot will be reflected a share of the mean reflectance at each of its bounces:
 * missing = unshot rho / (1 - rho). Relative to what is reflected in the end. All in W. */
double estimate_unshot_error(double unshot, double reflected, double mean_rho);

#endif
