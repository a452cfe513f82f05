/* SPDX-License-Identifier: MIT
 * How is a report read by people? One HTML file that needs nothing else: report_page.html with the JSON in it, the
 * asset before and after, and the sizes of triangles.
 */
#ifndef HEMIBAKE_CLI_REPORT_PAGE_H
#define HEMIBAKE_CLI_REPORT_PAGE_H

#include "report.h"

/* Does the name ask for a page? */
bool report_page_is_asked(const char *path);

/* json: of report_make. Text from malloc; NULL: out of memory. */
char *report_page_make(const report_facts *facts, hemi_context *context, console *c, const char *json);

#endif
