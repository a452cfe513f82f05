/* SPDX-License-Identifier: MIT
 * What ends the command from outside, and what does it leave? Ctrl-C asks a bake for the best answer so far; a second
 * one, and SIGTERM, SIGHUP, SIGQUIT and SIGXCPU at once, end the process with 128 and their number: nothing is written
 * then.
 */
#ifndef HEMIBAKE_CLI_SIGNALS_H
#define HEMIBAKE_CLI_SIGNALS_H

#include <stdbool.h>

/* Not 0 after the first Ctrl-C of a bake. A handler has nowhere else to leave a word. */
extern volatile int signals_interrupted;

/* Begins to catch; a broken pipe and a file that is too long become errors of whoever writes. name stands in the line
 * that is printed at the end. */
void signals_catch(const char *name);

/* What crashes in a library that cannot do without memory (crash_site.h) ends in a line and with exit status 1; where
 * address space is limited, so does what crashes anywhere, as any want of memory does. Else a crash is a crash. */
void signals_fence_libraries(void);

/* A line that says why the command ends is being printed; where a crash has been said already this does not return. */
void signals_error_begins(void);

/* The line that says why the command ends is out: a crash on the way down, for want of the same memory, adds none. */
void signals_error_is_said(void);

/* From now on the first Ctrl-C sets signals_interrupted. What does not end by itself soon after it ends all the same,
 * and nothing is written: at once for whoever waits. */
void signals_allow_interrupt(void);

/* Is there an answer that is worth waiting for? Then the end may take most of a second, however long the bake took. */
void signals_set_worth(bool is_worth_it);

/* From now on the outputs appear, and no signal comes between two of them, nor says afterwards that there are none. */
void signals_hold(void);
void signals_release(void);

/* The file of this name is removed when a signal ends the process, until it is unguarded. */
void signals_guard(const char *path);
void signals_unguard(const char *path);

#endif
