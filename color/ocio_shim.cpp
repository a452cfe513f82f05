/* SPDX-License-Identifier: MIT
 * Which OpenColorIO processors bring colours into the space that is solved in, and out of it to a display?
 *
 *     an asset's colour  ->  [sRGB decoded]  its space to the working space
 *     working space      ->  [looks]  display and view  [sRGB decoded]
 *     working space      ->  linear Rec.709, by name or by the matrices from ACES2065-1
 *
 * Each is one processor: where the display is sRGB, OpenColorIO cancels its encoding against the decoding, and vertex
 * colours need no power function at all. */
#include "ocio_shim.h"

#include "ocio_config.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <strings.h>
#include <vector>

struct color_transform {
    OCIO::ConstConfigRcPtr config;
    std::string names[COLOR_PART_COUNT];
    OCIO::ConstCPUProcessorRcPtr processors[OCIO_TARGET_COUNT];
};

struct color_input {
    std::string space;
    OCIO::ConstCPUProcessorRcPtr processor;
};

namespace {

/* Names under which published configurations carry linear Rec.709 (ACES 2.x and OpenColorIO's own, ACES 1.2, Blender);
 * aliases count. A configuration without any is entered through aces_interchange. */
const char *const linear_rec709_names[] = {
    "lin_rec709",     "lin_rec709_srgb",         "lin_rec709_scene",          "lin_srgb", "Linear Rec.709 (sRGB)",
    "Linear Rec.709", "Utility - Linear - sRGB", "Utility - Linear - Rec.709"
};

/* OpenColorIO prints warnings about configurations; a library does not. */
struct quiet {
    quiet() : level(OCIO::GetLoggingLevel()) { OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE); }
    ~quiet() { OCIO::SetLoggingLevel(level); }
    quiet(const quiet &) = delete;
    quiet &operator=(const quiet &) = delete;
    OCIO::LoggingLevel level;
};

/* Takes no memory: there may be none. */
void write_message(char *message, const char *what, const char *text) {
    std::snprintf(message, COLOR_MESSAGE_SIZE, "%s%s", what, text);
    for (char *c = message; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t') *c = ' ';
}

/* Studio configurations have hundreds of names; the first few show what they look like. */
std::string listed(const std::vector<std::string> &names) {
    const size_t most = 16;
    std::string text;
    for (size_t i = 0; i < names.size() && i < most; i++) text += (i ? ", " : "") + names[i];
    if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
    return text.empty() ? "none" : text;
}

/* ---- names ----------------------------------------------------------------------------------------------------- */

/* name(i) of each. */
template <typename name_t> std::vector<std::string> list(int count, const name_t &name) {
    std::vector<std::string> names;
    for (int i = 0; i < count; i++) names.push_back(name(i));
    return names;
}

std::vector<std::string> views_of(const OCIO::ConstConfigRcPtr &config, const std::string &display) {
    std::vector<std::string> names;
    for (OCIO::ViewType type : { OCIO::VIEW_DISPLAY_DEFINED, OCIO::VIEW_SHARED })
        for (int i = 0; i < config->getNumViews(type, display.c_str()); i++)
            names.push_back(config->getView(type, display.c_str(), i));
    return names;
}

/* The spelling of the configuration, or a failure that lists what there is. */
std::string choose(const char *kind, const std::string &wanted, const std::vector<std::string> &names) {
    for (const std::string &name : names)
        if (strcasecmp(name.c_str(), wanted.c_str()) == 0) return name;
    throw ocio_failure(HEMI_ERROR_ARGUMENT,
                       std::string("no ") + kind + " is called \"" + wanted + "\"; there are: " + listed(names));
}

/* A list of looks: names between commas, colons or bars, each with + or - before it. */
void check_looks(const OCIO::ConstConfigRcPtr &config, const std::string &looks) {
    const std::vector<std::string> names =
        list(config->getNumLooks(), [&](int i) { return config->getLookNameByIndex(i); });
    for (size_t begin = 0; begin < looks.size();) {
        size_t end = looks.find_first_of(",:|", begin);
        if (end == std::string::npos) end = looks.size();
        std::string name = looks.substr(begin, end - begin);
        name.erase(0, name.find_first_not_of(" +-"));
        name.erase(name.find_last_not_of(' ') + 1);
        if (!name.empty()) choose("look", name, names);
        begin = end + 1;
    }
}

/* Names, aliases and roles, whatever their case. */
std::string choose_space(const OCIO::ConstConfigRcPtr &config, const std::string &wanted) {
    if (OCIO::ConstColorSpaceRcPtr space = config->getColorSpace(wanted.c_str())) return space->getName();
    const auto scene = OCIO::SEARCH_REFERENCE_SPACE_SCENE;
    const auto active = OCIO::COLORSPACE_ACTIVE;
    return choose("colour space", wanted, list(config->getNumColorSpaces(scene, active), [&](int i) {
                      return config->getColorSpaceNameByIndex(scene, active, i);
                  }));
}

std::string working_space_of(const OCIO::ConstConfigRcPtr &config, const char *wanted) {
    if (!wanted && !config->hasRole(OCIO::ROLE_SCENE_LINEAR))
        throw ocio_failure(HEMI_ERROR_DATA,
                           "the OpenColorIO configuration has no role scene_linear: name the space to solve "
                           "in with --working-space");
    std::string name = choose_space(config, wanted ? wanted : OCIO::ROLE_SCENE_LINEAR);
    if (config->getColorSpace(name.c_str())->isData())
        throw ocio_failure(HEMI_ERROR_ARGUMENT,
                           "the space \"" + name + "\" is for data and has no primaries to solve in");
    return name;
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

void add_conversion(OCIO::GroupTransformRcPtr &group, const std::string &from, const std::string &to) {
    OCIO::ColorSpaceTransformRcPtr conversion = OCIO::ColorSpaceTransform::Create();
    conversion->setSrc(from.c_str());
    conversion->setDst(to.c_str());
    group->appendTransform(conversion);
}

/* Linear Rec.709 to a space; false if the configuration does not say how. */
bool add_from_rec709(OCIO::GroupTransformRcPtr &group, const OCIO::ConstConfigRcPtr &config, const std::string &to) {
    for (const char *name : linear_rec709_names)
        if (OCIO::ConstColorSpaceRcPtr space = config->getColorSpace(name)) {
            add_conversion(group, space->getName(), to);
            return true;
        }
    if (!config->hasRole("aces_interchange")) return false;
    add_builtin(group, "UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", OCIO::TRANSFORM_DIR_INVERSE);
    add_builtin(group, "ACEScg_to_ACES2065-1", OCIO::TRANSFORM_DIR_FORWARD);
    add_conversion(group, "aces_interchange", to);
    return true;
}

OCIO::ConstCPUProcessorRcPtr compile(const OCIO::ConstConfigRcPtr &config, const OCIO::GroupTransformRcPtr &group) {
    return config->getProcessor(group)->getOptimizedCPUProcessor(OCIO::BIT_DEPTH_F32, OCIO::BIT_DEPTH_F32,
                                                                 OCIO::OPTIMIZATION_VERY_GOOD);
}

hemi_result apply(const OCIO::ConstCPUProcessorRcPtr &processor, float *rgb, size_t count) {
    if (!processor) return HEMI_ERROR_UNSUPPORTED;
    try {
        OCIO::PackedImageDesc image(rgb, static_cast<long>(count), 1, 3);
        processor->apply(image);
        return HEMI_OK;
    } catch (...) {
        return HEMI_ERROR_BACKEND;
    }
}

/* Makes *out; turns what `fill` throws into a code and one line. */
template <typename made_t, typename fill_t> hemi_result make(made_t **out, char *message, const fill_t &fill) {
    *out = nullptr;
    message[0] = '\0';
    try {
        quiet silence;
        auto made = std::make_unique<made_t>();
        fill(*made);
        *out = made.release();
        return HEMI_OK;
    } catch (const ocio_failure &error) {
        write_message(message, "", error.what());
        return error.result;
    } catch (const OCIO::ExceptionMissingFile &error) {
        write_message(message, "a file of the OpenColorIO configuration is missing: ", error.what());
        return HEMI_ERROR_FILE;
    } catch (const std::exception &error) {
        bool is_memory = std::strstr(error.what(), "bad_alloc") != nullptr;
        write_message(message, is_memory ? "out of memory: " : "OpenColorIO: ", error.what());
        if (is_memory) return HEMI_ERROR_MEMORY; /* the parser of configurations hands on the words alone */
    } catch (...) {
        write_message(message, "", "OpenColorIO failed without a word");
    }
    return HEMI_ERROR_DATA;
}

/* ---- out: working space to display ------------------------------------------------------------------------------ */

OCIO::ConstCPUProcessorRcPtr make_view(const color_transform &transform, bool own_looks, ocio_target target) {
    const std::string &source = transform.names[COLOR_PART_WORKING_SPACE];
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    if (!own_looks) add_looks(group, source, transform.names[COLOR_PART_LOOK]);
    OCIO::DisplayViewTransformRcPtr display = OCIO::DisplayViewTransform::Create();
    display->setSrc(source.c_str());
    display->setDisplay(transform.names[COLOR_PART_DISPLAY].c_str());
    display->setView(transform.names[COLOR_PART_VIEW].c_str());
    display->setLooksBypass(!own_looks);
    group->appendTransform(display);
    if (target == OCIO_TARGET_LINEAR) add_srgb_decoding(group);
    return compile(transform.config, group);
}

/* A space is linear if twice the light is twice the value; a curve shows between a dim and a bright colour. */
void check_linear(const color_transform &transform) {
    float dim[3] = { 0.02f, 0.01f, 0.03f }, bright[3] = { 1.28f, 0.64f, 1.92f };
    for (float *rgb : { dim, bright })
        if (apply(transform.processors[OCIO_TARGET_REC709], rgb, 1) != HEMI_OK) return;
    for (int c = 0; c < 3; c++)
        if (!(std::fabs(64.0f * dim[c] - bright[c]) <= 1e-4f * std::fabs(bright[c])))
            throw ocio_failure(HEMI_ERROR_ARGUMENT, "the space \"" + transform.names[COLOR_PART_WORKING_SPACE] +
                                                        "\" is not linear; light adds up in a scene-linear one only");
}

void make_processors(const color_transform_desc &desc, color_transform &transform) {
    for (ocio_target target : { OCIO_TARGET_DISPLAY, OCIO_TARGET_LINEAR })
        transform.processors[target] = make_view(transform, desc.look == nullptr, target);
    OCIO::GroupTransformRcPtr to_rec709 = OCIO::GroupTransform::Create();
    if (!add_from_rec709(to_rec709, transform.config, transform.names[COLOR_PART_WORKING_SPACE])) return;
    to_rec709->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
    transform.processors[OCIO_TARGET_REC709] = compile(transform.config, to_rec709);
    check_linear(transform);
}

void choose_names(const color_transform_desc &desc, color_transform &transform) {
    const OCIO::ConstConfigRcPtr &config = transform.config;
    std::string display = desc.display ? desc.display : config->getDefaultDisplay();
    display =
        choose("display", display, list(config->getNumDisplaysAll(), [&](int i) { return config->getDisplayAll(i); }));
    std::string name = desc.view ? desc.view : config->getDefaultView(display.c_str());
    name = choose(("view of the display " + display).c_str(), name, views_of(config, display));
    std::string looks = desc.look ? desc.look : config->getDisplayViewLooks(display.c_str(), name.c_str());
    check_looks(config, looks);
    transform.names[COLOR_PART_CONFIG] = desc.config ? desc.config : "hemibake";
    transform.names[COLOR_PART_DISPLAY] = display;
    transform.names[COLOR_PART_VIEW] = name;
    transform.names[COLOR_PART_LOOK] = looks;
    transform.names[COLOR_PART_WORKING_SPACE] = working_space_of(config, desc.working_space);
}

/* ---- in: an asset's colours to working space -------------------------------------------------------------------- */

/* By glTF's own rule factors are linear Rec.709, and colour textures the same behind the curve of sRGB. */
void make_input(const color_transform &transform, const color_input_desc &desc, color_input &input) {
    const std::string &working_space = transform.names[COLOR_PART_WORKING_SPACE];
    const char *space = desc.space;
    if (space && std::strcmp(space, COLOR_INPUT_FILE_RULES) == 0)
        space = transform.config->getColorSpaceFromFilepath(desc.file ? desc.file : "");
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    if (space) {
        input.space = choose_space(transform.config, space);
        add_conversion(group, input.space, working_space);
    } else {
        input.space = desc.origin == COLOR_ORIGIN_TEXTURE ? "sRGB" : "linear Rec.709";
        if (desc.origin == COLOR_ORIGIN_TEXTURE) add_srgb_decoding(group);
        if (!add_from_rec709(group, transform.config, working_space))
            throw ocio_failure(
                HEMI_ERROR_DATA,
                "the OpenColorIO configuration has neither linear Rec.709 nor the role aces_interchange: say "
                "with --input-space which of its spaces the asset is in");
    }
    input.processor = compile(transform.config, group);
}

} // namespace

/* ---- public ----------------------------------------------------------------------------------------------------- */

hemi_result color_transform_create(const color_transform_desc *desc, color_transform **out,
                                   char message[COLOR_MESSAGE_SIZE]) {
    const color_transform_desc chosen = desc ? *desc : color_transform_desc{};
    return make(out, message, [&](color_transform &transform) {
        transform.config = ocio_config_load(chosen);
        choose_names(chosen, transform);
        make_processors(chosen, transform);
    });
}

void color_transform_destroy(color_transform *transform) {
    delete transform;
}

const char *color_transform_name(const color_transform *transform, color_part part) {
    return transform->names[part].c_str();
}

hemi_result ocio_apply(const color_transform *transform, ocio_target target, float *rgb, size_t count) {
    return apply(transform->processors[target], rgb, count);
}

hemi_result color_input_create(const color_transform *transform, const color_input_desc *desc, color_input **out,
                               char message[COLOR_MESSAGE_SIZE]) {
    return make(out, message, [&](color_input &input) { make_input(*transform, *desc, input); });
}

void color_input_destroy(color_input *input) {
    delete input;
}

const char *color_input_space(const color_input *input) {
    return input->space.c_str();
}

bool color_input_is_identity(const color_input *input) {
    return input->processor->isNoOp();
}

hemi_result ocio_input_apply(const color_input *input, float *rgb, size_t count) {
    return apply(input->processor, rgb, count);
}

/* ---- what a configuration reads --------------------------------------------------------------------------------- */

void color_config_files(const char *config, void (*see)(void *user, const char *path), void *user) {
    if (!config) return;
    try {
        quiet silence;
        for (const std::string &path : ocio_config_files(config)) see(user, path.c_str());
    } catch (...) {
        /* Who makes a transform of it says why it is none. */
    }
}
