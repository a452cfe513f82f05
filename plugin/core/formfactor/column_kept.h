/* SPDX-License-Identifier: MIT
 * Which columns need not be computed again? Those that are kept (base/kept_results.h), each by what its shooter is.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_COLUMN_KEPT_H
#define HEMIBAKE_CORE_FORMFACTOR_COLUMN_KEPT_H

#include "base/kept_results.h"
#include "formfactor/column.h"

/* NULL: it is to be computed. */
column *column_kept_take(const kept_pass *p, const column_setup *setup, const subpatch *shooter);
void column_kept_give(const kept_pass *p, const subpatch *shooter, const column *c);

#endif
