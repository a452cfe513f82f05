/* SPDX-License-Identifier: MIT
 * Which OpenColorIO processors make a display and view?
 *
 *     [Rec.709 to ACES2065-1]  [looks]  display and view  [sRGB decoded]
 *
 * Both targets are one processor each: where the display is sRGB, OpenColorIO cancels its encoding against the
 * decoding, and the linear target needs no power function at all. */
#include "ocio_shim.h"

#include <OpenColorIO/OpenColorIO.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <strings.h>
#include <vector>

namespace OCIO = OCIO_NAMESPACE;

namespace {

const char embedded_config[] =
#include "hemibake_ocio.inc"
    ;

const char embedded_name[] = "hemibake";

/* Names under which published configurations carry linear Rec.709 (ACES 2.x and OpenColorIO's own, ACES 1.2, Blender);
 * aliases count. A configuration without any is entered through aces_interchange. */
const char *const linear_rec709_names[] = {
    "lin_rec709",     "lin_rec709_srgb",         "lin_rec709_scene",          "lin_srgb", "Linear Rec.709 (sRGB)",
    "Linear Rec.709", "Utility - Linear - sRGB", "Utility - Linear - Rec.709"
};

struct failure : std::runtime_error {
    failure(hemi_result r, const std::string &text) : std::runtime_error(text), result(r) {}
    hemi_result result;
};

/* OpenColorIO prints warnings about configurations; a library does not. */
struct quiet {
    quiet() : level(OCIO::GetLoggingLevel()) { OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE); }
    ~quiet() { OCIO::SetLoggingLevel(level); }
    quiet(const quiet &) = delete;
    quiet &operator=(const quiet &) = delete;
    OCIO::LoggingLevel level;
};

void write_message(char *message, const char *text) {
    std::snprintf(message, COLOR_MESSAGE_SIZE, "%s", text);
    for (char *c = message; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t') *c = ' ';
}

std::string listed(const std::vector<std::string> &names) {
    std::string text;
    for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
}

/* ---- configuration --------------------------------------------------------------------------------------------- */

void check_readable(const std::string &path) {
    if (path.rfind("ocio://", 0) == 0) {
        if (OCIO::GetVersionHex() >= 0x02020000) return;
        throw failure(HEMI_ERROR_UNSUPPORTED, "the OpenColorIO configuration " + path +
                                                  " needs OpenColorIO 2.2; this is " + OCIO::GetVersion() +
                                                  ": give the path of an .ocio file");
    }
    std::ifstream file(path, std::ios::binary);
    if (!file || file.peek() == std::ifstream::traits_type::eof())
        throw failure(HEMI_ERROR_FILE, "the OpenColorIO configuration " + path + " cannot be read, or it is empty");
}

OCIO::ConstConfigRcPtr load_file(const std::string &path) {
    check_readable(path);
    try {
        OCIO::ConstConfigRcPtr config = OCIO::Config::CreateFromFile(path.c_str());
        config->validate();
        return config;
    } catch (const OCIO::Exception &error) {
        std::string text = error.what();
        bool newer = text.find("not able to load that config version") != std::string::npos;
        throw failure(
            newer ? HEMI_ERROR_UNSUPPORTED : HEMI_ERROR_DATA,
            (newer ? "a newer OpenColorIO is needed: " : "the OpenColorIO configuration " + path + " is broken: ") +
                text);
    }
}

OCIO::ConstConfigRcPtr load(const char *path) {
    if (path) return load_file(path);
    std::istringstream text(embedded_config);
    return OCIO::Config::CreateFromStream(text);
}

/* ---- names ----------------------------------------------------------------------------------------------------- */

std::vector<std::string> displays_of(const OCIO::ConstConfigRcPtr &config) {
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumDisplaysAll(); i++) names.push_back(config->getDisplayAll(i));
    return names;
}

std::vector<std::string> views_of(const OCIO::ConstConfigRcPtr &config, const std::string &display) {
    std::vector<std::string> names;
    for (OCIO::ViewType type : { OCIO::VIEW_DISPLAY_DEFINED, OCIO::VIEW_SHARED })
        for (int i = 0; i < config->getNumViews(type, display.c_str()); i++)
            names.push_back(config->getView(type, display.c_str(), i));
    return names;
}

std::vector<std::string> looks_of(const OCIO::ConstConfigRcPtr &config) {
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumLooks(); i++) names.push_back(config->getLookNameByIndex(i));
    return names;
}

/* The spelling of the configuration, or a failure that lists what there is. */
std::string choose(const char *kind, const std::string &wanted, const std::vector<std::string> &names) {
    for (const std::string &name : names)
        if (strcasecmp(name.c_str(), wanted.c_str()) == 0) return name;
    throw failure(HEMI_ERROR_ARGUMENT,
                  std::string("no ") + kind + " is called \"" + wanted + "\"; there are: " + listed(names));
}

/* A list of looks: names between commas, colons or bars, each with + or - before it. */
void check_looks(const OCIO::ConstConfigRcPtr &config, const std::string &looks) {
    for (size_t begin = 0; begin < looks.size();) {
        size_t end = looks.find_first_of(",:|", begin);
        if (end == std::string::npos) end = looks.size();
        std::string name = looks.substr(begin, end - begin);
        name.erase(0, name.find_first_not_of(" +-"));
        name.erase(name.find_last_not_of(' ') + 1);
        if (!name.empty()) choose("look", name, looks_of(config));
        begin = end + 1;
    }
}

std::string source_of(const OCIO::ConstConfigRcPtr &config) {
    for (const char *name : linear_rec709_names)
        if (OCIO::ConstColorSpaceRcPtr space = config->getColorSpace(name)) return space->getName();
    for (const char *role : { "aces_interchange", "scene_linear" })
        if (config->hasRole(role)) return role;
    throw failure(HEMI_ERROR_DATA, "the OpenColorIO configuration has neither linear Rec.709 nor the roles "
                                   "aces_interchange or scene_linear: there is no way in for radiance");
}

/* ---- processors ------------------------------------------------------------------------------------------------ */

void add_builtin(OCIO::GroupTransformRcPtr &group, const char *style, OCIO::TransformDirection direction) {
    OCIO::BuiltinTransformRcPtr builtin = OCIO::BuiltinTransform::Create();
    builtin->setStyle(style);
    builtin->setDirection(direction);
    group->appendTransform(builtin);
}

void add_looks(OCIO::GroupTransformRcPtr &group, const std::string &source, const std::string &looks) {
    if (looks.empty()) return;
    OCIO::LookTransformRcPtr look = OCIO::LookTransform::Create();
    look->setSrc(source.c_str());
    look->setDst(source.c_str());
    look->setLooks(looks.c_str());
    group->appendTransform(look);
}

void add_srgb_decoding(OCIO::GroupTransformRcPtr &group) {
    const double gamma[4] = { 2.4, 2.4, 2.4, 1.0 }, offset[4] = { 0.055, 0.055, 0.055, 0.0 };
    OCIO::ExponentWithLinearTransformRcPtr decode = OCIO::ExponentWithLinearTransform::Create();
    decode->setGamma(gamma);
    decode->setOffset(offset);
    decode->setNegativeStyle(OCIO::NEGATIVE_LINEAR); /* as in the built-in sRGB display, so that the two cancel */
    group->appendTransform(decode);
}

} // namespace

struct ocio_view {
    std::string names[OCIO_VIEW_PART_COUNT];
    OCIO::ConstCPUProcessorRcPtr processors[OCIO_TARGET_COUNT];
};

namespace {

OCIO::ConstCPUProcessorRcPtr make_processor(const OCIO::ConstConfigRcPtr &config, const ocio_view &view, bool own_looks,
                                            ocio_target target) {
    const std::string &source = view.names[OCIO_VIEW_SOURCE];
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    if (source == "aces_interchange") {
        add_builtin(group, "UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", OCIO::TRANSFORM_DIR_INVERSE);
        add_builtin(group, "ACEScg_to_ACES2065-1", OCIO::TRANSFORM_DIR_FORWARD);
    }
    if (!own_looks) add_looks(group, source, view.names[OCIO_VIEW_LOOK]);
    OCIO::DisplayViewTransformRcPtr display = OCIO::DisplayViewTransform::Create();
    display->setSrc(source.c_str());
    display->setDisplay(view.names[OCIO_VIEW_DISPLAY].c_str());
    display->setView(view.names[OCIO_VIEW_VIEW].c_str());
    display->setLooksBypass(!own_looks);
    group->appendTransform(display);
    if (target == OCIO_TARGET_LINEAR) add_srgb_decoding(group);
    return config->getProcessor(group)->getOptimizedCPUProcessor(OCIO::BIT_DEPTH_F32, OCIO::BIT_DEPTH_F32,
                                                                 OCIO::OPTIMIZATION_VERY_GOOD);
}

void choose_names(const OCIO::ConstConfigRcPtr &config, const color_transform_desc &desc, ocio_view &view) {
    view.names[OCIO_VIEW_CONFIG] = desc.config ? desc.config : embedded_name;
    std::string display = desc.display ? desc.display : config->getDefaultDisplay();
    display = choose("display", display, displays_of(config));
    std::string name = desc.view ? desc.view : config->getDefaultView(display.c_str());
    name = choose(("view of the display " + display).c_str(), name, views_of(config, display));
    std::string looks = desc.look ? desc.look : config->getDisplayViewLooks(display.c_str(), name.c_str());
    check_looks(config, looks);
    view.names[OCIO_VIEW_DISPLAY] = display;
    view.names[OCIO_VIEW_VIEW] = name;
    view.names[OCIO_VIEW_LOOK] = looks;
    view.names[OCIO_VIEW_SOURCE] = source_of(config);
}

} // namespace

hemi_result ocio_view_create(const color_transform_desc *desc, ocio_view **out, char message[COLOR_MESSAGE_SIZE]) {
    ocio_view *view = nullptr;
    *out = nullptr;
    try {
        quiet silence;
        view = new ocio_view;
        OCIO::ConstConfigRcPtr config = load(desc->config);
        choose_names(config, *desc, *view);
        for (ocio_target target : { OCIO_TARGET_DISPLAY, OCIO_TARGET_LINEAR })
            view->processors[target] = make_processor(config, *view, desc->look == nullptr, target);
        *out = view;
        return HEMI_OK;
    } catch (const failure &error) {
        write_message(message, error.what());
        delete view;
        return error.result;
    } catch (const std::bad_alloc &) {
        write_message(message, "out of memory for a colour transform");
        delete view;
        return HEMI_ERROR_MEMORY;
    } catch (const std::exception &error) {
        write_message(message, (std::string("OpenColorIO: ") + error.what()).c_str());
    } catch (...) {
        write_message(message, "OpenColorIO failed without a word");
    }
    delete view;
    return HEMI_ERROR_DATA;
}

void ocio_view_destroy(ocio_view *view) {
    delete view;
}

const char *ocio_view_name(const ocio_view *view, ocio_view_part part) {
    return view->names[part].c_str();
}

hemi_result ocio_view_apply(const ocio_view *view, ocio_target target, float *rgb, size_t count) {
    try {
        OCIO::PackedImageDesc image(rgb, static_cast<long>(count), 1, 3);
        view->processors[target]->apply(image);
        return HEMI_OK;
    } catch (...) {
        return HEMI_ERROR_BACKEND;
    }
}
