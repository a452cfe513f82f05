/* SPDX-License-Identifier: MIT
 * What does Ctrl-C leave of a bake? The best answer so far, if it is of use: a good old output is worth more than a bad
 * new one.
 */
#ifndef HEMIBAKE_CLI_INTERRUPT_H
#define HEMIBAKE_CLI_INTERRUPT_H

#include "console.h"

/* While it bakes: whoever decides how long the end may take hears what there would be to write. */
void interrupt_follow(const hemi_progress *p);

/* Says so; the exit status. */
int interrupt_without_answer(console *c);

/* When hemi_bake is done: was it interrupted, and is what there is written? EXIT_DONE if so. Later interrupts come too
 * late to change anything, and are none. */
int interrupt_judge(console *c, hemi_statistics *found, bool *is_interrupted);

#endif
