/* SPDX-License-Identifier: MIT
 * Has an output been made of the same input, by the same options and version? Then it need not be made again.
 */
#ifndef HEMIBAKE_CLI_INPUT_DIGEST_H
#define HEMIBAKE_CLI_INPUT_DIGEST_H

#include "input_files.h"

/* SHA-256, as hexadecimal digits, of all that decides what a bake writes: version, options, the bytes of the input and
 * of the files that it and the options name; not where they lie. "": nobody knows, as of a stage of USD, whose layers
 * are found by reading it, or of what is no plain file. */
void input_digest(const options *o, char digest[65]);

/* Of the bytes of the input and of the files that it, the options and the lists (NULL: none) name. */
void input_digest_of_files(const options *o, const input_lists *lists, char digest[65]);

/* Does the output of these options say that it was made so (asset.extras.hemibake.input_sha256, which
 * only a bake into a folder leaves)? */
bool input_digest_is_in_output(const options *o);

#endif
