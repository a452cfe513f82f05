/* SPDX-License-Identifier: MIT
 * See ocio_config.h. OpenColorIO opens tables by their names when a processor is made; where only some folders may be
 * read, all that the configuration could name is looked at before, found by OpenColorIO's own search. Tables in XML
 * (CLF, CTF) may name further files: such ones are refused then.
 */
#include "ocio_config.h"

#include <cctype>
#include <fstream>
#include <sstream>
#include <vector>

namespace {

const char embedded_config[] =
#include "hemibake_ocio.inc"
    ;

/* ---- loading --------------------------------------------------------------------------------------------------- */

bool is_builtin(const char *path) {
    return std::string(path).rfind("ocio://", 0) == 0;
}

void check_readable(const std::string &path) {
    if (is_builtin(path.c_str())) {
        if (OCIO::GetVersionHex() >= 0x02020000) return;
        throw ocio_failure(HEMI_ERROR_UNSUPPORTED, "the OpenColorIO configuration " + path +
                                                       " needs OpenColorIO 2.2; this is " + OCIO::GetVersion() +
                                                       ": give the path of an .ocio file");
    }
    std::ifstream file(path, std::ios::binary);
    if (!file || file.peek() == std::ifstream::traits_type::eof())
        throw ocio_failure(HEMI_ERROR_FILE,
                           "the OpenColorIO configuration " + path + " cannot be read, or it is empty");
}

/* "2.99" of a file's line "ocio_profile_version: 2.99"; what OpenColorIO says of it names the file first. */
std::string version_asked_for(const std::string &path) {
    std::ifstream file(path);
    const std::string key = "ocio_profile_version:";
    for (std::string line; std::getline(file, line);) {
        if (line.compare(0, key.size(), key) != 0) continue;
        size_t begin = line.find_first_not_of(' ', key.size()), end = line.find_first_not_of("0123456789.", begin);
        return begin == std::string::npos ? "" : line.substr(begin, end - begin);
    }
    return "";
}

OCIO::ConstConfigRcPtr load(const char *path) {
    check_readable(path);
    try {
        OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromFile(path);
        config->validate();
        return config;
    } catch (const OCIO::Exception &error) {
        std::string text = error.what();
        if (text.find("not able to load that config version") != std::string::npos)
            throw ocio_failure(HEMI_ERROR_UNSUPPORTED, "the configuration is of version " + version_asked_for(path) +
                                                           " and needs a newer OpenColorIO; this is " +
                                                           OCIO::GetVersion());
        if (text.find("invalid built-in transform style") != std::string::npos)
            throw ocio_failure(HEMI_ERROR_UNSUPPORTED, "it needs a newer OpenColorIO; this is " +
                                                           std::string(OCIO::GetVersion()) + ": " + text);
        throw ocio_failure(HEMI_ERROR_DATA,
                           std::string("the OpenColorIO configuration ") + path + " is broken: " + text);
    }
}

/* ---- files that it names --------------------------------------------------------------------------------------- */

using transforms = std::vector<OCIO::ConstTransformRcPtr>;

/* All that the configuration has; groups are not opened yet. */
transforms transforms_of(const OCIO::ConstConfigRcPtr &config) {
    const auto space = OCIO::SEARCH_REFERENCE_SPACE_ALL;
    transforms out;
    for (int i = 0; i < config->getNumColorSpaces(space, OCIO::COLORSPACE_ALL); i++)
        if (auto one = config->getColorSpace(config->getColorSpaceNameByIndex(space, OCIO::COLORSPACE_ALL, i)))
            for (auto to : { OCIO::COLORSPACE_DIR_TO_REFERENCE, OCIO::COLORSPACE_DIR_FROM_REFERENCE })
                out.push_back(one->getTransform(to));
    for (int i = 0; i < config->getNumNamedTransforms(OCIO::NAMEDTRANSFORM_ALL); i++)
        if (auto one = config->getNamedTransform(config->getNamedTransformNameByIndex(OCIO::NAMEDTRANSFORM_ALL, i)))
            for (auto way : { OCIO::TRANSFORM_DIR_FORWARD, OCIO::TRANSFORM_DIR_INVERSE })
                out.push_back(one->getTransform(way));
    for (int i = 0; i < config->getNumViewTransforms(); i++)
        if (auto one = config->getViewTransform(config->getViewTransformNameByIndex(i)))
            for (auto to : { OCIO::VIEWTRANSFORM_DIR_TO_REFERENCE, OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE })
                out.push_back(one->getTransform(to));
    for (int i = 0; i < config->getNumLooks(); i++)
        if (auto one = config->getLook(config->getLookNameByIndex(i)))
            out.insert(out.end(), { one->getTransform(), one->getInverseTransform() });
    return out;
}

/* Does XML ask for another file, by an element or by what an entity may hide? Zeros are left out, as UTF-16 has them.
 */
bool names_files(const char *path) {
    static const std::string marks[] = { "<reference", "<!entity" };
    std::ifstream file(path, std::ios::binary);
    std::string last;
    for (char c; file.get(c);) {
        if (!c) continue;
        if (c == '<') last.clear();
        if (c == '<' || (!last.empty() && last.size() < marks[0].size()))
            last += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        for (const std::string &mark : marks)
            if (last == mark) return true;
    }
    return false;
}

/* Where each file lies that transforms name, once; what is not there is left out: who needs it will say so. */
std::set<std::string> files_of(const OCIO::ConstConfigRcPtr &config) {
    std::set<std::string> out;
    for (transforms left = transforms_of(config); !left.empty();) {
        const OCIO::ConstTransformRcPtr one = left.back();
        left.pop_back();
        if (auto file = OCIO::DynamicPtrCast<const OCIO::FileTransform>(one)) {
            try {
                out.insert(config->getCurrentContext()->resolveFileLocation(file->getSrc()));
            } catch (const OCIO::Exception &) {
            }
        }
        if (auto group = OCIO::DynamicPtrCast<const OCIO::GroupTransform>(one))
            for (int i = 0; i < group->getNumTransforms(); i++) left.push_back(group->getTransform(i));
    }
    return out;
}

void check_file(const color_transform_desc &desc, const std::string &path) {
    char reason[COLOR_MESSAGE_SIZE] = "";
    if (!desc.may_read(desc.may_read_user, path.c_str(), reason))
        throw ocio_failure(HEMI_ERROR_FILE, "the table " + path + " that it names: " + reason);
    if (names_files(path.c_str()))
        throw ocio_failure(HEMI_ERROR_FILE, "the table " + path + " that it names asks for further files itself");
}

} // namespace

OCIO::ConstConfigRcPtr ocio_config_load(const color_transform_desc &desc) {
    std::istringstream inside(embedded_config);
    if (!desc.config) return OCIO::Config::CreateFromStream(inside);
    OCIO::ConstConfigRcPtr config = load(desc.config);
    if (desc.may_read && !is_builtin(desc.config))
        for (const std::string &path : files_of(config)) check_file(desc, path);
    return config;
}

std::set<std::string> ocio_config_files(const char *path) {
    return is_builtin(path) ? std::set<std::string>() : files_of(load(path));
}
