/* SPDX-License-Identifier: MIT
 * What is there to bake in an asset: how much of which material, and what gives light?
 */
#ifndef HEMIBAKE_CLI_INSPECTION_H
#define HEMIBAKE_CLI_INSPECTION_H

#include "asset_colors.h"
#include "console.h"
#include "gltf_asset.h"

typedef struct inspected_material {
    const char *name;
    double area_m2;        /* of what is baked, both sides of what is double-sided */
    double reflectance[3]; /* the mean over that area, textures and vertex colours included */
    double power_w[3];     /* that it emits */
    double share;          /* of the colour factors that is left: below 1 of metals */
} inspected_material;

typedef struct inspection {
    inspected_material *materials; /* the asset's, in their order */
    uint32_t material_count;
    uint32_t mesh_count; /* that are baked ... */
    uint32_t left_count; /* ... and that are not, since they are unlit */
    double triangles, area_m2, power_w;
    uint32_t light_count; /* without size */
    bool has_sky;         /* of the asset, or asked for */
} inspection;

/* After the textures have been read. EXIT_DONE or an exit status with its line printed. */
int inspection_make(const gltf_asset *asset, const asset_colors *colors, const options *o, console *c, inspection *out);
void inspection_free(inspection *i);

/* Is it lit and yet gives nothing back, so that it stays black? */
bool inspected_material_is_black(const inspected_material *m);

double inspected_material_power(const inspected_material *m); /* of all bands, as energy.emitted of the report, W */

#endif
