/* SPDX-License-Identifier: MIT
 * Which configurations do the tests of colour write themselves?
 */
#ifndef HEMIBAKE_TESTS_COLOR_CONFIG_H
#define HEMIBAKE_TESTS_COLOR_CONFIG_H

#include "check.h"
#include "color_transform.h"

#include <stdlib.h>

/* Writes text to a temporary file and creates a transform from it. */
static inline hemi_result create_from(const char *text, color_transform_desc desc, color_transform **out,
                                      char *message) {
    char path[] = "/tmp/hemibake-ocio-XXXXXX";
    int descriptor = mkstemp(path);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
    desc.config = path;
    hemi_result result = color_transform_create(&desc, out, message);
    CHECK(strpbrk(message, "\r\n") == NULL);
    remove(path);
    return result;
}

/* A configuration whose scene_linear is ACEScg, as studios have; it knows Rec.709 by aces_interchange only. */
static const char aces_config[] =
    "ocio_profile_version: 2\n"
    "roles: {scene_linear: ACEScg, aces_interchange: ACES2065-1, default: ACEScg}\n"
    "file_rules:\n"
    "  - !<Rule> {name: Default, colorspace: default}\n"
    "displays:\n"
    "  sRGB:\n"
    "    - !<View> {name: Plain, colorspace: sRGB}\n"
    "    - !<View> {name: Halved, colorspace: sRGB, looks: half}\n"
    "looks:\n"
    "  - !<Look> {name: half, process_space: ACEScg, transform: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, "
    "0, "
    "0, 0, 0.5, 0, 0, 0, 0, 1]}}\n"
    "  - !<Look> {name: double, process_space: ACEScg, transform: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, "
    "0, 0, 2, 0, 0, 0, 0, 1]}}\n"
    "colorspaces:\n"
    "  - !<ColorSpace> {name: ACES2065-1}\n"
    "  - !<ColorSpace> {name: ACEScg, to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}}\n"
    "  - !<ColorSpace>\n"
    "    name: sRGB\n"
    "    from_scene_reference: !<GroupTransform>\n"
    "      children:\n"
    "        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}\n"
    "        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}\n"
    "        - !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}\n";

#endif
