/* SPDX-License-Identifier: MIT */
#include "solver/estimate.h"

double estimate_unshot_error(double unshot, double reflected, double mean_rho) {
    double missing = unshot * mean_rho / (1.0 - mean_rho);
    return missing > 0.0 ? missing / (reflected + missing) : 0.0;
}
