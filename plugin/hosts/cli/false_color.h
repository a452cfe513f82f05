/* SPDX-License-Identifier: MIT
 * Which colour shows an error? Black is right, and lighter is worse throughout, so that errors are told apart without
 * colour too.
 */
#ifndef HEMIBAKE_CLI_FALSE_COLOR_H
#define HEMIBAKE_CLI_FALSE_COLOR_H

/* Linear rgb of a share of the full error, which is held to [0,1]. */
void false_color(double share, float rgb[3]);

#endif
