/* SPDX-License-Identifier: MIT
 * How does a bake go on where another was ended? --checkpoint FILE keeps what takes long as it is found, in a file that
 * --resume FILE takes: all is done again then but for that, to the same bytes. Kept is what an input, options and a
 * version alone decide, so a checkpoint of others is refused.
 *
 *     magic, 8 bytes | size of the text, 8 | text | checksum, 8       text: lines that end with a zero: version and
 * build key, 16 | size, 8 | checksum of these, 8 | bytes | checksum, 8        of the program, digest of the input,
 * options
 *     ... as often as there are results
 *
 * Results are added one by one, each by one call, so that nothing has to be done when the bake is ended, by whatever: a
 * last one that is not whole is dropped. Checksums are XXH3.
 */
#ifndef HEMIBAKE_CLI_CHECKPOINT_H
#define HEMIBAKE_CLI_CHECKPOINT_H

#include "console.h"
#include "input_files.h"

typedef struct checkpoint checkpoint;

/* Opens the file of --checkpoint or --resume, which nobody else may have open so; *out is NULL where neither is asked
 * for. lists: of what stages depend on. An exit status, with its line printed. */
int checkpoint_open(const options *o, const input_lists *lists, console *c, checkpoint **out);

/* For hemi_bake_desc; NULL of NULL. */
const hemi_checkpoint *checkpoint_desc(const checkpoint *c);

/* Says what could not be kept; removes the file of a bake whose outputs are there. NULL is fine. */
void checkpoint_close(checkpoint *c, console *to, bool is_done);

#endif
