/* SPDX-License-Identifier: MIT
 * Was a struct of the host built with this library's header, or with an older or newer one? Its first field says how
 * large it is.
 *
 *     desc of an older host   shorter: what it lacks is 0, which is the default of every field
 *     desc of a newer host    longer: refused, since the library would pass over wishes that it does not know
 *     view of an older host   shorter: it gets the fields that it has
 *     view of a newer host    longer: what the library does not know is 0
 */
#ifndef HEMIBAKE_API_DESC_SIZE_H
#define HEMIBAKE_API_DESC_SIZE_H

#include <hemibake/hemibake.h>

/* Copies desc, of the size in its first field, over *known, which has known_size bytes. least: what every version has.
 * False, with one line to the context's log (which may be NULL), if desc is NULL or no version has its size. */
bool desc_take(const hemi_context *context, const char *name, const void *desc, size_t least, void *known,
               size_t known_size);

/* Writes *known, which has known_size bytes, over the view *out, of the size in its first field, which stays. False if
 * no version has that size. least: what every version has. */
bool view_give(void *out, size_t least, const void *known, size_t known_size);

/* The size of a struct up to and with one of its fields. */
#define DESC_THROUGH(type, field) (offsetof(type, field) + sizeof(((type *)0)->field))

#endif
