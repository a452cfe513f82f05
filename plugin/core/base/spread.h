/* SPDX-License-Identifier: MIT
 * In which order are places looked at where time may run out on the way? So that any run of them is spread over all.
 */
#ifndef HEMIBAKE_CORE_BASE_SPREAD_H
#define HEMIBAKE_CORE_BASE_SPREAD_H

#include <stddef.h>

/* Steps of this size visit all of count places, any run of them evenly: about the golden section, and coprime. At least
 * 1. */
size_t spread_stride(size_t count);

#endif
