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

/* When something begins that deadline_is_near may ask about; 0 where nobody looks at a clock. */
static inline double deadline_begin(const deadline *d) {
    return d->until_s > 0.0 ? d->clock() : 0.0;
}

/* Since begin_s so much is done: is there, at that pace, no time for what must still come? */
static inline bool deadline_is_near(const deadline *d, double begin_s, double done, double still) {
    if (!(d->until_s > 0.0)) return false;
    double now = d->clock();
    return now > d->until_s || (done > 0.0 && now + still / done * (now - begin_s) > d->until_s);
}

#endif
