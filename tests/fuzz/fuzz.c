/* SPDX-License-Identifier: MIT
 * libFuzzer's two functions. The target is named by $HEMIBAKE_FUZZ, so that one program serves all.
 */
#include "targets.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const fuzz_target *target;

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc, (void)argv;
    target = fuzz_target_named(getenv("HEMIBAKE_FUZZ"));
    if (target) return 0;
    fputs("fuzz: $HEMIBAKE_FUZZ names no target\n", stderr);
    exit(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    target->run(bytes, size);
    return 0;
}
