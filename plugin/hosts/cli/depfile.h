/* SPDX-License-Identifier: MIT
 * Which files must a build system watch, so that a bake is made again when one of them changes?
 *
 *     OUT: IN buffer.bin texture.png config.ocio
 *
 * in the syntax that Make reads and that Ninja and CMake take as a depfile.
 */
#ifndef HEMIBAKE_CLI_DEPFILE_H
#define HEMIBAKE_CLI_DEPFILE_H

#include "input_files.h"

/* The text of the depfile of a bake, malloc'ed; NULL: out of memory. lists: of what stages depend on. Files that are
 * not there are not named, since no build system could be content then. */
char *depfile_make(const options *o, const input_lists *lists);

#endif
