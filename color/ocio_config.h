/* SPDX-License-Identifier: MIT
 * Which OpenColorIO configuration is it, and may the files be read that it names? Private to this folder; throws
 * ocio_failure and what OpenColorIO throws.
 */
#ifndef HEMIBAKE_COLOR_OCIO_CONFIG_H
#define HEMIBAKE_COLOR_OCIO_CONFIG_H

#include "color_transform.h"

#include <OpenColorIO/OpenColorIO.h>

#include <set>
#include <stdexcept>
#include <string>

namespace OCIO = OCIO_NAMESPACE;

struct ocio_failure : std::runtime_error {
    ocio_failure(hemi_result r, const std::string &text) : std::runtime_error(text), result(r) {}
    hemi_result result;
};

/* The one that desc names, or the one inside; every file that its transforms name is asked of desc.may_read. */
OCIO::ConstConfigRcPtr ocio_config_load(const color_transform_desc &desc);

/* Where each file lies that transforms of the configuration name, once; what is not there is left out. */
std::set<std::string> ocio_config_files(const char *path);

#endif
