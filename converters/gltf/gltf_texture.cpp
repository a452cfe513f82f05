/* SPDX-License-Identifier: MIT
 * See gltf_texture.h.
 */
#include "gltf_texture.h"

#include <algorithm>
#include <cmath>

/* ---- pyramids ---------------------------------------------------------------------------------------------------- */

/* Half as long a row or column, means by area, also of odd lengths: texel i covers [i n/m, (i+1) n/m). step: between
 * neighbours, in texels. */
static void halve_line(const float *from, size_t n, size_t step_from, float *to, size_t m, size_t step_to) {
    double width = double(n) / double(m);
    for (size_t i = 0; i < m; i++) {
        double low = double(i) * width, high = double(i + 1) * width, sum[3] = { 0, 0, 0 };
        for (size_t k = size_t(low); k < n && double(k) < high; k++) {
            double part = std::min(high, double(k + 1)) - std::max(low, double(k));
            for (size_t c = 0; c < 3; c++) sum[c] += part * double(from[3 * k * step_from + c]);
        }
        for (size_t c = 0; c < 3; c++) to[3 * i * step_to + c] = float(sum[c] / width);
    }
}

static gltf_level halved(const gltf_level &from) {
    uint32_t width = std::max(from.width / 2, 1u), height = std::max(from.height / 2, 1u);
    gltf_level narrow = { width, from.height, std::vector<float>(3 * size_t(width) * from.height) };
    gltf_level out = { width, height, std::vector<float>(3 * size_t(width) * height) };
    for (size_t row = 0; row < from.height; row++)
        halve_line(&from.rgb[3 * row * from.width], from.width, 1, &narrow.rgb[3 * row * width], width, 1);
    for (size_t column = 0; column < width; column++)
        halve_line(&narrow.rgb[3 * column], from.height, width, &out.rgb[3 * column], height, width);
    return out;
}

gltf_pyramid gltf_make_pyramid(std::vector<float> &&rgb, uint32_t width, uint32_t height) {
    gltf_pyramid pyramid;
    gltf_level level = { width, height, std::move(rgb) };
    while (level.width > gltf_texture_side || level.height > gltf_texture_side) level = halved(level);
    pyramid.levels.push_back(std::move(level));
    while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1)
        pyramid.levels.push_back(halved(pyramid.levels.back()));
    return pyramid;
}

/* ---- looking ----------------------------------------------------------------------------------------------------- */

size_t gltf_level_for(const gltf_sampler &sampler, double window) {
    const std::vector<gltf_level> &levels = sampler.pyramid->levels;
    size_t level = 0;
    while (level + 1 < levels.size() &&
           1.0 / (double(levels[level + 1].width) * double(levels[level + 1].height)) <= window)
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
    const gltf_level &from = sampler.pyramid->levels[level];
    size_t column = wrapped(uv[0], from.width, sampler.wrap[0]), row = wrapped(uv[1], from.height, sampler.wrap[1]);
    return &from.rgb[3 * (row * from.width + column)];
}

void gltf_texture_place(const gltf_sampler &sampler, const double *attributes, double uv[2]) {
    const double *at = attributes + sampler.attribute;
    for (int k = 0; k < 2; k++) uv[k] = sampler.row[k][0] * at[0] + sampler.row[k][1] * at[1] + sampler.row[k][2];
}
