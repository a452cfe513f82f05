/* SPDX-License-Identifier: MIT
 * Who crashed, a library that takes it that memory never ends, or the command? Mesa and LLVM write to NULL without any,
 * or abort; OpenColorIO and tinygltf throw where they promised not to.
 */
#ifndef HEMIBAKE_CLI_CRASH_SITE_H
#define HEMIBAKE_CLI_CRASH_SITE_H

/* Notes where the code of these libraries lies; before a handler of crashes is set. */
void crash_site_prepare(void);

/* For that handler, of its third argument: the library in whose code, or below a call of which, the crash came; NULL:
 * none of them. Takes no memory and no lock. */
const char *crash_site_library(const void *machine);

#endif
