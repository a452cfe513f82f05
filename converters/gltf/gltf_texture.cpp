/* SPDX-License-Identifier: MIT */
#include "gltf_texture.h"

#include <algorithm>
#include <cmath>

/* ---- mip_chains -------------------------------------------------------------------------------------------------- */

/* Half as long a row, means by area, also of odd lengths: texel i covers [i n/m, (i+1) n/m). */
static void halve_line(const float *from, size_t n, float *to, size_t m) {
    double width = double(n) / double(m);
    for (size_t i = 0; i < m; i++) {
        double low = double(i) * width, high = double(i + 1) * width, sum[3] = { 0, 0, 0 };
        for (size_t k = size_t(low); k < n && double(k) < high; k++) {
            double part = std::min(high, double(k + 1)) - std::max(low, double(k));
            for (size_t c = 0; c < 3; c++) sum[c] += part * double(from[3 * k + c]);
        }
        for (size_t c = 0; c < 3; c++) to[3 * i + c] = float(sum[c] / width);
    }
}

/* A row of the level above rows of a picture: rows [i n/m, (i+1) n/m), each halved first. */
static void halve_rows(const gltf_row_fn &rows, uint32_t width, uint32_t height, uint32_t i, gltf_level &out) {
    const double tall = double(height) / double(out.height);
    const double low = double(i) * tall, high = double(i + 1) * tall;
    std::vector<float> wide(3 * size_t(width)), narrow(3 * size_t(out.width));
    std::vector<double> sum(narrow.size(), 0.0);
    for (uint32_t k = uint32_t(low); k < height && double(k) < high; k++) {
        double part = std::min(high, double(k + 1)) - std::max(low, double(k));
        rows(k, wide);
        halve_line(wide.data(), width, narrow.data(), out.width);
        for (size_t j = 0; j < sum.size(); j++) sum[j] += part * double(narrow[j]);
    }
    for (size_t j = 0; j < sum.size(); j++) out.rgb[3 * size_t(i) * out.width + j] = float(sum[j] / tall);
}

static gltf_level halved(const gltf_row_fn &rows, uint32_t from_width, uint32_t from_height) {
    uint32_t width = std::max(from_width / 2, 1u), height = std::max(from_height / 2, 1u);
    gltf_level out = { width, height, std::vector<float>(3 * size_t(width) * height) };
    for (uint32_t i = 0; i < height; i++) halve_rows(rows, from_width, from_height, i, out);
    return out;
}

static gltf_level halved(const gltf_level &from) {
    auto rows = [&](uint32_t row, std::vector<float> &rgb) {
        std::copy_n(&from.rgb[3 * size_t(row) * from.width], rgb.size(), rgb.begin());
    };
    return halved(rows, from.width, from.height);
}

static gltf_level whole(const gltf_row_fn &rows, uint32_t width, uint32_t height) {
    gltf_level out = { width, height, std::vector<float>(3 * size_t(width) * height) };
    std::vector<float> row(3 * size_t(width));
    for (uint32_t i = 0; i < height; i++) {
        rows(i, row);
        std::copy(row.begin(), row.end(), out.rgb.begin() + ptrdiff_t(3 * size_t(i) * width));
    }
    return out;
}

gltf_mip_chain gltf_make_mip_chain(const gltf_row_fn &rows, uint32_t width, uint32_t height) {
    gltf_mip_chain mips;
    bool fits = width <= gltf_texture_side && height <= gltf_texture_side;
    gltf_level level = fits ? whole(rows, width, height) : halved(rows, width, height);
    while (level.width > gltf_texture_side || level.height > gltf_texture_side) level = halved(level);
    mips.levels.push_back(std::move(level));
    while (mips.levels.back().width > 1 || mips.levels.back().height > 1)
        mips.levels.push_back(halved(mips.levels.back()));
    return mips;
}

/* ---- lookups ----------------------------------------------------------------------------------------------------- */

size_t gltf_level_for(const gltf_sampler &sampler, double footprint) {
    const std::vector<gltf_level> &levels = sampler.mips->levels;
    size_t level = 0;
    while (level + 1 < levels.size() &&
           1.0 / (double(levels[level + 1].width) * double(levels[level + 1].height)) <= footprint)
        level++;
    return level;
}

static size_t wrapped(double at, uint32_t count, int wrap) {
    double turn = std::floor(at), inside = at - turn;
    if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE)
        inside = std::clamp(at, 0.0, 1.0);
    else if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT && std::fmod(turn, 2.0) != 0.0)
        inside = 1.0 - inside;
    if (!(inside >= 0.0)) inside = 0.0; /* not a number */
    return std::min(size_t(inside * count), size_t(count) - 1);
}

const float *gltf_texel(const gltf_sampler &sampler, size_t level, const double uv[2]) {
    static const float black[3] = { 0, 0, 0 };
    const gltf_level &from = sampler.mips->levels[level];
    for (int k = 0; k < 2; k++)
        if (sampler.black[k] && !(uv[k] >= 0 && uv[k] <= 1)) return black;
    size_t column = wrapped(uv[0], from.width, sampler.wrap[0]), row = wrapped(uv[1], from.height, sampler.wrap[1]);
    return &from.rgb[3 * (row * from.width + column)];
}

void gltf_transform_uv(const gltf_sampler &sampler, const double *attributes, double uv[2]) {
    const double *at = attributes + sampler.attribute;
    for (int k = 0; k < 2; k++) uv[k] = sampler.row[k][0] * at[0] + sampler.row[k][1] * at[1] + sampler.row[k][2];
}

/* ---- grids ------------------------------------------------------------------------------------------------------- */

/* Points each way, at most; and how many times as many texels there are one way as the other where there are more. */
static const int grid_side_most = 64;
static const double stretched = 1.05;

/* So many points each way say where within a small piece one texel ends and the next begins. */
static const double points_a_texel = 2;

/* The length in texels of the sides of a quad or triangle along s and along t: from its first corner to the second, and
 * to the last. */
static void texels_along(const gltf_sampler &sampler, size_t level, const double *attributes, uint32_t count,
                         uint32_t corners, double out[2]) {
    const gltf_level &from = sampler.mips->levels[level];
    double at[4][2];
    for (uint32_t i = 0; i < corners; i++) gltf_transform_uv(sampler, attributes + size_t(count) * i, at[i]);
    out[0] = out[1] = 0;
    for (uint32_t i = 0; i < corners; i++) {
        if (corners == 3 && i == 1) continue; /* across both */
        const double *a = at[i], *b = at[(i + 1) % corners];
        double &longest = out[corners == 3 ? i / 2 : i % 2];
        longest = std::max({ longest, std::fabs(b[0] - a[0]) * from.width, std::fabs(b[1] - a[1]) * from.height });
    }
}

void gltf_refine_points(const gltf_sampler &sampler, const double *attributes, uint32_t count, uint32_t corners,
                        int usual, size_t &level, gltf_points &out) {
    double texels[2];
    if (!sampler.mips) return;
    texels_along(sampler, level, attributes, count, corners, texels);
    for (int k = 0; k < 2; k++)
        out.side[k] = std::max(out.side[k], int(std::ceil(std::min(points_a_texel * texels[k], double(usual)))));
    if (!(std::max(texels[0], texels[1]) > stretched * std::min(texels[0], texels[1]))) return;
    while (std::max(texels[0], texels[1]) > grid_side_most && level + 1 < sampler.mips->levels.size())
        texels_along(sampler, ++level, attributes, count, corners, texels);
    for (int k = 0; k < 2; k++)
        out.side[k] = std::max(out.side[k], int(std::ceil(std::min(texels[k], double(grid_side_most)))));
}
