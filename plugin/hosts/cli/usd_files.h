/* SPDX-License-Identifier: MIT
 * How does the command read and write USD? By its Python package hemibake.usd in a process of its own: a stage becomes a
 * scene GLB in a folder that is gone in the end, and a baked GLB there becomes USD.
 */
#ifndef HEMIBAKE_CLI_USD_FILES_H
#define HEMIBAKE_CLI_USD_FILES_H

#include "console.h"

#include <stddef.h>

typedef struct usd_files {
    char *folder; /* NULL: nothing of USD has been asked for yet */
    char *scene, *sky, *dependencies, *baked, *written, *layer;
    bool has_sky, is_read; /* is_read: the input is a stage */
    char **losses;         /* lines of what the bake does not show of the stage */
    size_t loss_count;
} usd_files;

/* By its extension, or by its first bytes: #usda, PXR-USDC, or a zip, which no glTF is. */
bool usd_is_input(const char *path);

/* By its extension: .usda, .usdc, .usdz or .usd. */
bool usd_is_output(const char *path);

/* Makes scene, sky and dependencies of the stage of the command line. An exit status, with its line printed. */
int usd_read(usd_files *files, const options *o, console *c);

/* Makes of the bytes of a baked GLB, which go to files->baked, the file `written` with the extension of output, and if
 * asked for the file `layer`, which names payload. */
int usd_write(usd_files *files, const options *o, const char *output, const void *glb, size_t size, console *c);

/* A whole file from malloc; NULL: it cannot be read. */
void *usd_read_file(const char *path, size_t *size);

/* LAYER.baked.usdc beside LAYER.usda, from malloc. */
char *usd_payload_name(const char *layer);

/* Removes the folder with what is in it. */
void usd_files_close(usd_files *files);

#endif
