/* SPDX-License-Identifier: MIT
 * What is said of an asset, one line a kind? A hundred sheer materials are one line with a count.
 */
#include "gltf_model.h"

#include <map>

/* Between whom a note is about and what it says; no text from a file holds it (gltf_printable). */
static const char separator = '\x1f';

void gltf_note(gltf_asset &asset, const std::string &subject, const std::string &text) {
    asset.skipped.push_back(subject + separator + text);
}

/* A kind of note: what it says of which sort of thing. */
struct kind_of_note {
    std::string first, text;
    size_t count;
};

void gltf_gather_notes(gltf_asset &asset) {
    std::vector<kind_of_note> kinds;
    std::map<std::string, size_t> known;
    for (const std::string &note : asset.skipped) {
        size_t end = note.find(separator);
        bool counted = end != std::string::npos;
        std::string subject = counted ? note.substr(0, end) : note, text = counted ? note.substr(end + 1) : "";
        std::string key = counted ? subject.substr(0, subject.find(' ')) + separator + text : note;
        auto [at, fresh] = known.insert({ key, kinds.size() });
        if (fresh) kinds.push_back({ subject, text, 0 });
        kinds[at->second].count++;
    }
    asset.lines.clear();
    for (const kind_of_note &kind : kinds) {
        std::string more = kind.count > 1 && !kind.text.empty() ? gltf_text(" and %zu more", kind.count - 1) : "";
        asset.lines.push_back(kind.first + more + (kind.text.empty() ? "" : ": " + kind.text));
    }
}

size_t gltf_asset_skipped_count(const gltf_asset *asset) {
    return asset->lines.size();
}

const char *gltf_asset_skipped(const gltf_asset *asset, size_t index) {
    return index < asset->lines.size() ? asset->lines[index].c_str() : nullptr;
}
