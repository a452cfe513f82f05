/* SPDX-License-Identifier: MIT */
#include "interrupt.h"

#include "signals.h"

#include <math.h>
#include <string.h>

/* The largest estimated relative error, what is unshot included, that the output of an interrupted bake may have. */
static const double USABLE_ERROR = 0.25;

/* Comparisons that no NaN passes; an estimate below 0 is none. */
static bool is_usable(double estimate, double unshot) {
    return estimate >= 0.0 && estimate <= USABLE_ERROR && unshot <= USABLE_ERROR;
}

/* By rows, which shoot nothing, there is nothing to show until all rays are cast. From then on what they say of the
 * elements that there are is judged and fitted in less than a second of two processors for 100,000 elements. */
void interrupt_follow(const hemi_progress *p) {
    bool is_soon_there = p->shots > 0 || strcmp(p->stage, "refine") == 0 || strcmp(p->stage, "reconstruct") == 0;
    signals_set_worth(is_soon_there && is_usable(p->error_estimate, p->unshot_fraction));
}

int interrupt_without_answer(console *c) {
    console_error(c, "interrupted; nothing is written");
    return EXIT_INTERRUPTED;
}

int interrupt_judge(console *c, hemi_statistics *found, bool *is_interrupted) {
    const hemi_error_statistics *e = &found->error;
    *is_interrupted = signals_interrupted != 0;
    if (!*is_interrupted) {
        /* What is being written is soon there, and who asks for an end now waits for that and no longer. */
        signals_set_worth(false);
        return EXIT_DONE;
    }
    found->solver.converged = false;
    if (is_usable(e->estimate, e->unshot)) return EXIT_DONE;
    console_error(
        c,
        "interrupted; nothing is written: the error is still about %.0f %%, and above %.0f %% an old output is better",
        100 * fmax(e->estimate, e->unshot), 100 * USABLE_ERROR);
    return EXIT_INTERRUPTED;
}
