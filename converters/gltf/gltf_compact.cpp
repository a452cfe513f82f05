/* SPDX-License-Identifier: MIT
 * What does the output still refer to, and under which number? Geometry that was replaced must not stay in the file:
 * accessors and buffer views that nothing names go, the rest is renumbered and copied into one buffer.
 */
#include "gltf_model.h"

#include <cstring>
#include <new>

/* Called for each number that names an element of some list. */
using number_visitor = std::function<void(cJSON *)>;

/* ---- who names an element of a list ----------------------------------------------------------------------------- */

static const char *const list_names[gltf_list_count] = { "accessors", "bufferViews", "meshes", "nodes",
                                                         "materials", "textures",    "images", "samplers" };

/* Where the numbers stand that name elements of a list: members from the root on, those of each element of an array;
 * a star is any member. Who names meshes, nodes and materials is known to those who move them. */
static const struct {
    gltf_list_kind list;
    const char *path;
} references[] = {
    { gltf_accessors, "meshes/primitives/indices" },
    { gltf_accessors, "meshes/primitives/attributes/*" },
    { gltf_accessors, "meshes/primitives/targets/*" },
    { gltf_accessors, "animations/samplers/input" },
    { gltf_accessors, "animations/samplers/output" },
    { gltf_accessors, "skins/inverseBindMatrices" },
    { gltf_accessors, "nodes/extensions/EXT_mesh_gpu_instancing/attributes/*" },
    { gltf_views, "accessors/bufferView" },
    { gltf_views, "accessors/sparse/indices/bufferView" },
    { gltf_views, "accessors/sparse/values/bufferView" },
    { gltf_views, "images/bufferView" },
    { gltf_views, "meshes/primitives/extensions/KHR_draco_mesh_compression/bufferView" },
    { gltf_views, "extensions/EXT_lights_ies/lights/bufferView" },
    { gltf_images, "textures/source" },
    { gltf_images, "textures/extensions/*/source" }, /* webp, basisu, ... */
    { gltf_samplers, "textures/sampler" },
};

static void visit_path(cJSON *item, const char *path, const number_visitor &visit) {
    const bool array = cJSON_IsArray(item);
    const size_t length = std::strcspn(path, "/");
    const char *rest = array ? path : path + length + (path[length] == '/');
    if (!*path && gltf_is_number(item)) visit(item);
    for (cJSON *child : gltf_elements(item))
        if (array || *path == '*' || std::string(path, length) == child->string) visit_path(child, rest, visit);
}

static void visit_texture_infos(const cJSON *parent, const number_visitor &visit) {
    for (cJSON *item : gltf_elements(parent)) {
        if (item->string && std::strcmp(item->string, "extras") == 0) continue;
        if (gltf_is_texture_info(item)) visit(gltf_member(item, "index"));
        if (item->child) visit_texture_infos(item, visit);
    }
}

static void visit_references(const gltf_draft &draft, gltf_list_kind list, const number_visitor &visit) {
    if (list == gltf_textures) visit_texture_infos(gltf_member(draft.document.get(), "materials"), visit);
    for (const auto &reference : references)
        if (reference.list == list) visit_path(draft.document.get(), reference.path, visit);
}

/* ---- a draft ---------------------------------------------------------------------------------------------------- */

static std::vector<char> named_elements(const gltf_draft &draft, gltf_list_kind list) {
    std::vector<char> named(draft.lists[list].size(), 0);
    visit_references(draft, list, [&named](const cJSON *number) {
        if (number->valueint >= 0 && size_t(number->valueint) < named.size()) named[size_t(number->valueint)] = 1;
    });
    return named;
}

/* Extensions whose indices the visitors above know, beside KHR_materials_*. */
static bool is_understood(const std::string &name) {
    static const char *const known[] = { "KHR_draco_mesh_compression",
                                         "KHR_mesh_quantization",
                                         "KHR_texture_transform",
                                         "KHR_lights_punctual",
                                         "KHR_texture_basisu",
                                         "KHR_xmp_json_ld",
                                         "EXT_mesh_gpu_instancing",
                                         "EXT_texture_webp",
                                         "EXT_texture_avif",
                                         "EXT_meshopt_compression",
                                         "MSFT_texture_dds",
                                         "FB_ngon_encoding",
                                         "KHR_node_visibility",
                                         "KHR_node_selectability",
                                         "KHR_node_hoverability",
                                         "MSFT_lod",
                                         "EXT_lights_ies" };
    for (const char *extension : known)
        if (name == extension) return true;
    return name.compare(0, 14, "KHR_materials_") == 0;
}

gltf_draft::gltf_draft(const gltf_asset &source) : asset(source), document(gltf_copy(source.document.get())) {
    for (int list = 0; list < gltf_list_count; list++) {
        lists[list] = gltf_elements(gltf_member(document.get(), list_names[list]));
        was_named[list] = named_elements(*this, gltf_list_kind(list));
    }
    for (const std::string &name : asset.model.extensionsUsed) keeps_numbers = keeps_numbers || !is_understood(name);
}

/* ---- adding and removing ---------------------------------------------------------------------------------------- */

int gltf_add_element(gltf_draft &draft, gltf_list_kind list, gltf_json element) {
    draft.lists[list].push_back(element.get());
    gltf_append(gltf_list(draft.document.get(), list_names[list]), std::move(element));
    return int(draft.lists[list].size()) - 1;
}

int gltf_add_view(gltf_draft &draft, std::vector<unsigned char> bytes, int target) {
    gltf_json view(cJSON_CreateObject());
    gltf_set_number(view.get(), "buffer", 0);
    gltf_set_number(view.get(), "byteLength", double(bytes.size()));
    gltf_set_number(view.get(), "byteOffset", 0); /* until it is placed */
    if (target) gltf_set_number(view.get(), "target", target);
    draft.fresh.push_back(std::move(bytes));
    return gltf_add_element(draft, gltf_views, std::move(view));
}

void gltf_replace_element(gltf_draft &draft, gltf_list_kind list, size_t i, gltf_json element) {
    cJSON *holder = gltf_member(draft.document.get(), list_names[list]), *&old = draft.lists[list][i];
    if (!cJSON_ReplaceItemViaPointer(holder, old, element.get())) throw std::bad_alloc();
    old = element.release();
}

void gltf_remove_element(gltf_draft &draft, gltf_list_kind list, size_t i) {
    cJSON *holder = gltf_member(draft.document.get(), list_names[list]);
    cJSON_Delete(cJSON_DetachItemViaPointer(holder, draft.lists[list][i]));
    draft.lists[list][i] = nullptr;
}

std::vector<int> gltf_close_list(gltf_draft &draft, gltf_list_kind list) {
    std::vector<int> moved;
    std::vector<cJSON *> kept;
    for (cJSON *element : draft.lists[list]) {
        moved.push_back(element ? int(kept.size()) : -1);
        if (element) kept.push_back(element);
    }
    draft.lists[list] = std::move(kept);
    return moved;
}

/* Drops from a list what the bake left without a user, and renumbers the rest: the new numbers. What nobody named
 * before either is none of our business and stays. */
static std::vector<int> compact(gltf_draft &draft, gltf_list_kind list) {
    std::vector<char> named = named_elements(draft, list);
    const std::vector<char> &was_named = draft.was_named[list];
    for (size_t i = 0; i < was_named.size() && !draft.keeps_numbers; i++)
        if (!named[i] && was_named[i]) gltf_remove_element(draft, list, i);
    std::vector<int> moved = gltf_close_list(draft, list);
    visit_references(draft, list, [&moved](cJSON *number) {
        size_t index = size_t(number->valueint);
        if (number->valueint >= 0 && index < moved.size()) gltf_change_number(number, moved[index]);
    });
    return moved;
}

/* ---- images and the buffer -------------------------------------------------------------------------------------- */

static void pack_images(gltf_draft &draft, const std::vector<int> &moved) {
    for (size_t i = 0; i < moved.size(); i++) {
        const std::vector<unsigned char> &bytes = draft.asset.images[i];
        cJSON *image = moved[i] >= 0 ? draft.lists[gltf_images][size_t(moved[i])] : nullptr;
        if (!image || bytes.empty() || gltf_member(image, "bufferView")) continue;
        gltf_set_text(image, "mimeType", gltf_media_type(bytes.data(), bytes.size(), "").c_str());
        gltf_set_number(image, "bufferView", gltf_add_view(draft, bytes, 0));
        gltf_drop(image, "uri");
    }
}

/* Profiles of EXT_lights_ies whose files were beside the asset. */
static void pack_profiles(gltf_draft &draft) {
    size_t i = 0;
    for (cJSON *light : gltf_elements(gltf_member(gltf_extension(draft.document.get(), "EXT_lights_ies"), "lights"))) {
        const cJSON *uri = gltf_member(light, "uri");
        const std::vector<unsigned char> &bytes = draft.asset.profile_files[i++];
        if (bytes.empty() || !cJSON_IsString(uri) || gltf_is_base64(uri->valuestring)) continue;
        gltf_drop(light, "uri");
        gltf_set_text(light, "mimeType", "application/x-ies-lm-63");
        gltf_set_number(light, "bufferView", gltf_add_view(draft, bytes, 0));
    }
}

static void place_view(cJSON *view, size_t offset, size_t length) {
    gltf_set_number(view, "buffer", 0);
    if (offset)
        gltf_set_number(view, "byteOffset", double(offset));
    else
        gltf_drop(view, "byteOffset");
    gltf_set_number(view, "byteLength", double(length));
    gltf_drop_extension(view, "EXT_meshopt_compression");
}

/* Views begin at multiples of four, which suits every component type. */
static size_t place_views(gltf_draft &draft, const std::vector<int> &moved) {
    const std::vector<tinygltf::BufferView> &originals = draft.asset.model.bufferViews;
    size_t size = 0;
    for (size_t i = 0; i < moved.size(); i++) {
        if (moved[i] < 0) continue;
        bool fresh = i >= originals.size();
        draft.bytes.push_back(fresh
                                  ? draft.fresh[i - originals.size()].data()
                                  : draft.asset.buffers[size_t(originals[i].buffer)].data() + originals[i].byteOffset);
        size_t length = fresh ? draft.fresh[i - originals.size()].size() : originals[i].byteLength;
        size = (size + 3) & ~size_t(3);
        place_view(draft.lists[gltf_views][size_t(moved[i])], size, length);
        size += length;
    }
    return size;
}

void gltf_copy_views(const gltf_draft &draft, unsigned char *to) {
    size_t end = 0;
    for (size_t i = 0; i < draft.bytes.size(); i++) {
        const cJSON *view = draft.lists[gltf_views][i], *offset = gltf_member(view, "byteOffset");
        size_t begin = offset ? size_t(offset->valuedouble) : 0;
        size_t length = size_t(gltf_member(view, "byteLength")->valuedouble);
        std::memset(to + end, 0, begin - end);
        std::memcpy(to + begin, draft.bytes[i], length);
        end = begin + length;
    }
}

size_t gltf_compact(gltf_draft &draft) {
    compact(draft, gltf_textures);
    std::vector<int> images = compact(draft, gltf_images);
    compact(draft, gltf_samplers);
    pack_images(draft, images);
    pack_profiles(draft);
    compact(draft, gltf_accessors);
    size_t size = place_views(draft, compact(draft, gltf_views));
    for (int list = 0; list < gltf_list_count; list++)
        if (draft.lists[list].empty()) gltf_drop(draft.document.get(), list_names[list]);
    return size;
}
