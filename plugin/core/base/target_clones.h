/* SPDX-License-Identifier: MIT
 * Functions that are compiled once for each of several instruction sets, of which the loader picks one. What picks is
 * called before a sanitizer has set itself up, which calls of the sanitizer's own in it do not outlive; so there is but
 * the portable version then. It gives the same bits.
 */
#ifndef HEMIBAKE_CORE_BASE_TARGET_CLONES_H
#define HEMIBAKE_CORE_BASE_TARGET_CLONES_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define TARGET_CLONES(...) __attribute__((target_clones(__VA_ARGS__)))
#else
#define TARGET_CLONES(...)
#endif

#endif
