/* SPDX-License-Identifier: MIT
 * What is the colour of a texture at a place, seen through a footprint of a given size? Images as mip chains of linear
 * rgb, each level the mean of the one below. Private, C++.
 */
#ifndef HEMIBAKE_GLTF_TEXTURE_H
#define HEMIBAKE_GLTF_TEXTURE_H

#include "gltf_model.h"

#include <functional>

struct gltf_level {
    uint32_t width, height;
    std::vector<float> rgb; /* [3*(row*width+column)+c] */
};

/* levels[0] is at most gltf_texture_side texels on a side: elements are larger than such texels. */
static const uint32_t gltf_texture_side = 1024;

struct gltf_mip_chain {
    std::vector<gltf_level> levels;
};

/* A texture as a material names it. */
struct gltf_sampler {
    const gltf_mip_chain *mips = nullptr;            /* NULL: white */
    bool unread = false;                             /* there is a texture, but no picture that can be read */
    uint32_t attribute = 0;                          /* where its two coordinates are among a vertex's attributes */
    int wrap[2] = { 0, 0 };                          /* glTF's numbers */
    bool black[2] = { false, false };                /* beyond 0..1, instead: extras.hemibake_border */
    double row[2][3] = { { 1, 0, 0 }, { 0, 1, 0 } }; /* KHR_texture_transform: uv' = row (u, v, 1) */
};

/* Fills a row of a picture, rgb[3*column+c], linear. */
using gltf_row_fn = std::function<void(uint32_t row, std::vector<float> &rgb)>;

/* Reduces a picture to a mip chain; each row is asked for once or twice. */
gltf_mip_chain gltf_make_mip_chain(const gltf_row_fn &rows, uint32_t width, uint32_t height);

/* How many points there are each way over a quad or triangle. */
struct gltf_points {
    int side[2];
};

/* A mip level is as coarse as a cell of a grid of the usual points each way is large. A piece that is smaller than a
 * few texels needs no more points than tell them apart. Where a texture is stretched, what is a texel one way is many
 * the other way, and points would miss what lies between them: there are as many as texels then, and where that is too
 * many the level is coarser. */
void gltf_refine_points(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners,
                        int usual, size_t &level, gltf_points &out);

/* ---- gltf_image.cpp ---- */

/* What mip chains hold: of metallic-roughness textures m r^2, r and m, so that the mean over texels is exact; colours;
 * and under an alpha mask: colours of the texels it leaves, black elsewhere, and which texels it leaves. A kind is one
 * of these plus texel_kinds times the least alpha that it leaves. */
enum {
    texel_metal,
    texel_data,  /* numbers as they are */
    texel_alpha, /* alpha in all three bands */
    texel_color,
    texel_premultiplied_color, /* times alpha */
    texel_covered_color,
    texel_coverage,
    texel_kinds
};

/* NULL: gltf_decode_image. */
const gltf_mip_chain *gltf_find_mip_chain(gltf_asset &asset, int image, int kind);

/* The pixels of an image, from malloc. False: it is missing, broken or in a format that is not read, and a line says
 * so. */
struct image_pixels;
bool gltf_decode_image(gltf_asset &asset, int image, image_pixels *out);

/* Of a texture's first picture where it has another: a line says if it cannot be read. */
bool gltf_image_is_readable(gltf_asset &asset, int image);

/* What is said of a material whose picture cannot be read. */
extern const char gltf_unread_picture[];

/* Sets sampler.row from KHR_texture_transform; the set of coordinates, which that may name too. */
int gltf_texture_coordinates(int coordinates, const tinygltf::ExtensionMap &extensions, gltf_sampler &sampler);

/* Sets sampler.wrap; the image of a texture, -1 if it has none or texture is out of range. */
int gltf_texture_image(gltf_asset &asset, int texture, gltf_sampler &sampler);

/* The image of a texture info with its coordinates among the attributes of a primitive. */
gltf_sampler gltf_read_sampler(gltf_asset &asset, const gltf_geometry &geometry, const tinygltf::TextureInfo &info,
                               int kind);

/* Numbers linear Rec.709 into the space that is solved in. */
void gltf_convert_factor(const gltf_shadings &all, double rgb[3]);

/* The texel at a point of a piece of a primitive, at the level whose texels are as large as cells of the grid of points
 * that stand for the piece; white without a picture. */
const float *gltf_texel_over(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners,
                             const double *point);

/* ---- gltf_transmission.cpp ---- */

/* How a material lets light past: by its alpha (alphaMode BLEND), and of the rest by KHR_materials_transmission and
 * KHR_materials_diffuse_transmission. */
struct gltf_transmission {
    bool blends = false; /* alpha counts; alpha_at: where factor times COLOR_0's alpha is among the attributes, or -1 */
    double alpha = 1;    /* the factor */
    int alpha_at = -1;
    double straight = 0, diffuse = 0, diffuse_color[3] = { 1, 1, 1 };
    gltf_sampler alpha_map, straight_map, diffuse_map, diffuse_color_map;
    double shown_alpha = 1; /* what a blended copy of the material has for straight transmission */
    bool any = false;
};

gltf_transmission gltf_read_transmission(gltf_asset &asset, const gltf_geometry &geometry, uint32_t material);

/* At a point of a primitive. */
struct gltf_passage {
    double cover, alpha_texel; /* alpha in all, and the picture's part of it */
    double straight, diffuse, diffuse_color[3];
};
gltf_passage gltf_passage_at(const gltf_transmission &t, const double *attributes, uint32_t count, uint32_t corners,
                             const double *point);

/* Straight through what covers a primitive at most, for hemi_material_desc. */
double gltf_most_straight(const gltf_transmission &t, const gltf_geometry &geometry);

/* The level whose texels are no wider than `footprint`, an area in uv. */
size_t gltf_level_for(const gltf_sampler &sampler, double footprint);

/* The texel of a level at uv, wrapped. */
const float *gltf_texel(const gltf_sampler &sampler, size_t level, const double uv[2]);

/* uv of a vertex through the transform. */
void gltf_transform_uv(const gltf_sampler &sampler, const double *attributes, double uv[2]);

#endif
