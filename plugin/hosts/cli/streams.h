/* SPDX-License-Identifier: MIT
 * Are stdin, stdout and stderr there, and did what was printed arrive?
 */
#ifndef HEMIBAKE_CLI_STREAMS_H
#define HEMIBAKE_CLI_STREAMS_H

/* Whoever starts a program with a stream closed gives its number to the first file that is opened: an error line would
 * end up in an output. Such streams are opened here, and lead nowhere: what is printed to stdout then is an error. A line
 * on stderr leaves in one piece, since others may write to the same log; what is no line has to be flushed. */
void streams_open(void);

/* The exit status: the one given, or EXIT_OUTPUT with a line if what was printed to stdout did not get there. */
int streams_close(int status);

#endif
