/* SPDX-License-Identifier: MIT */
#include "reference.h"

#include <stdlib.h>

int reference_read(const char *path, const char *root, console *c, probe_set *out) {
    char message[PROBES_MESSAGE_SIZE];
    if (probe_set_read(path, root, out, message) == HEMI_OK) return EXIT_DONE;
    c->file = path;
    return console_error(c, "%s", message);
}

int reference_match(const char *path, const probe_set *set, const match_mesh *meshes, size_t count, console *c,
                    match_result *out) {
    char message[PROBES_MESSAGE_SIZE];
    if (probes_match(meshes, count, set, out, message) == HEMI_OK) return EXIT_DONE;
    c->file = path;
    return console_error(c, "%s", message);
}

int reference_compare_views(const char *path, const probe_set *probes, const gltf_asset *asset, const baked_colors *b,
                            console *c, reference_error *error) {
    match_mesh *meshes = calloc(b->mesh_count + 1, sizeof *meshes);
    hemi_mesh_desc *descs = calloc(b->mesh_count + 1, sizeof *descs);
    match_result match = { 0 };
    int status = EXIT_BAD_INPUT;
    if (meshes && descs) {
        for (uint32_t i = 0; i < b->mesh_count; i++) {
            baked_colors_mesh(b, asset, i, &descs[i]);
            meshes[i] = (match_mesh){ descs[i].name, &descs[i], b->views[i].radiance };
        }
        status = reference_match(path, probes, meshes, b->mesh_count, c, &match);
        if (status == EXIT_DONE)
            *error = (reference_error){ match_error(&match.total), match.median, match.percentile95 };
    }
    match_result_destroy(&match);
    free(meshes);
    free(descs);
    return status;
}
