/* SPDX-License-Identifier: MIT
 * How do kept rows go into a file, and what of a file is one? A file is a stranger's: whatever is read is looked at
 * before it is an index or a weight.
 */
#ifndef HEMIBAKE_CORE_SOLVER_KEPT_ROWS_FILE_H
#define HEMIBAKE_CORE_SOLVER_KEPT_ROWS_FILE_H

#include "base/chunk_file.h"
#include "solver/kept_rows.h"

/* Rays of all samples, with what they hit. */
void kept_rows_write(const kept_rows *k, chunk_writer *w);

/* The same of a mesh of parts; as kept_rows_cast, which it takes the place of. NULL: r->fault says why. */
kept_rows *kept_rows_read(chunk_reader *r, final_gather *with, const mesh *parts, const uint32_t *roots);

#endif
