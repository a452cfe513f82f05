/* SPDX-License-Identifier: MIT
 * Until when is work that only makes an answer better worth its time?
 */
#ifndef HEMIBAKE_CORE_BASE_DEADLINE_H
#define HEMIBAKE_CORE_BASE_DEADLINE_H

#include <stdbool.h>

/* All zero: for as long as it takes. */
typedef struct deadline {
    double (*clock)(void); /* seconds; any thread may ask */
    double until_s;        /* by clock; 0: no end */
} deadline;

static inline bool deadline_is_over(const deadline *d) {
    return d->until_s > 0.0 && d->clock() > d->until_s;
}

#endif
