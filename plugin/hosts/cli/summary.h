/* SPDX-License-Identifier: MIT
 * What does a person read when a bake is done? Some lines on stdout of what the report says.
 */
#ifndef HEMIBAKE_CLI_SUMMARY_H
#define HEMIBAKE_CLI_SUMMARY_H

#include "report.h"

/* more: the files beside the output; NULL is none. */
void summary_print(const report_facts *facts, const char *const *more, size_t more_count);

#endif
