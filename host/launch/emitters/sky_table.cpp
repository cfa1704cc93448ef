#include "launch/emitters/sky_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/half.hpp"
#include "base/parallel_for.hpp"
#include "base/pictures/light_range.hpp"
#include "base/pictures/srgb.hpp"
#include "scene/bright_texture.hpp"

namespace clarity {
namespace {

// Appends the running sums of what deal() gives to each weight.
void append_sums(const std::vector<double>& weights, rt_u32* sums) {
    rt_u32 sum = 0;
    const std::vector<rt_u32> shares = deal(weights, RT_PICKS);
    for (size_t i = 0; i < shares.size(); ++i) {
        sums[i] = sum;
        sum += shares[i];
    }
    sums[shares.size()] = sum;
}

constexpr double kMostSide = 8;  // texels of a side of the rectangle

// Where a coordinate beyond a picture of `size` texels shows it.
int64_t wrapped(int64_t at, int64_t size, rt_u32 mode) {
    if (mode == RT_WRAP_CLAMP) return std::clamp<int64_t>(at, 0, size - 1);
    const int64_t period = mode == RT_WRAP_MIRROR ? 2 * size : size, within = ((at % period) + period) % period;
    return within < size ? within : period - 1 - within;
}

double brightness(uint32_t texel, const rt_texture& texture) {
    double sum = 0;
    if (is_bright(texture)) {
        for (const float light : bright_light(texture, texel)) sum += light;
        return sum / 3;
    }
    for (int k = 0; k < 3; ++k) {
        const auto byte = static_cast<uint8_t>(texel >> (8 * k));
        sum += texture.flags & RT_TEXTURE_LINEAR ? byte / 255.0 : linear_from_srgb(byte / 255.0);
    }
    return sum / 3;
}

}  // namespace

SkyTable make_sky_table(const Sky& sky) {
    SkyTable table;
    LightRange light;
    for (const float texel : sky.texels) light.add(texel);
    table.scale = std::ldexp(1.0f, power_that_fits(light, {kLeastNormalHalf, kLargestHalf}));
    const size_t w = sky.values.width, h = sky.values.height;
    if (sky.values.kind != RT_SKY_PICTURE || w == 0 || h == 0) return table;
    const float* const texels = sky.texels.data();
    const auto mean = [&](size_t x, size_t y) {
        const float* const rgb = texels + 3 * (y * w + x);
        return (double(rgb[0]) + rgb[1] + rgb[2]) / 3;
    };
    table.picks.resize(h + 1 + h * (w + 1));
    table.halves.resize(3 * w * h);
    std::vector<double> rows(h);
    parallel_for(static_cast<uint32_t>(h), [&](uint32_t y) {
        // The mean of a bilinear function over a cell around a texel: weights 1, 6, 1 of 8 along each axis.
        const size_t ys[3] = {y > 0 ? y - 1 : 0, y, std::min<size_t>(y + 1, h - 1)};
        std::vector<double> along(w), cells(w);
        for (size_t x = 0; x < w; ++x) along[x] = (mean(x, ys[0]) + 6 * mean(x, ys[1]) + mean(x, ys[2])) / 8;
        double sum = 0;
        for (size_t x = 0; x < w; ++x) {
            cells[x] = (along[(x + w - 1) % w] + 6 * along[x] + along[(x + 1) % w]) / 8;
            sum += cells[x];
        }
        append_sums(cells, table.picks.data() + h + 1 + y * (w + 1));
        const double solid_angle =
            2 * kPi / double(w) * 2 * std::sin(kPi * (y + 0.5) / double(h)) * std::sin(kPi / (2 * double(h)));
        rows[y] = sum * solid_angle;
        for (size_t i = 3 * w * y; i < 3 * w * (y + 1); ++i) table.halves[i] = to_half(texels[i] / table.scale);
    });
    for (const double row : rows) table.flux += row;
    append_sums(rows, table.picks.data());
    return table;
}

double mean_of_map(const Scene& scene, rt_u32 number, rt_u32 triangle) {
    const rt_map& map = scene.maps[number];
    const rt_texture& texture = scene.textures[map.texture];
    const SharedArray<float>& uvs = map.set == 0 ? scene.uvs : scene.uvs2;
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int corner = 0; corner < 3; ++corner) {
        const size_t vertex = scene.triangles[3 * size_t(triangle) + corner];
        const double u = uvs.empty() ? 0 : uvs[2 * vertex], v = uvs.empty() ? 0 : uvs[2 * vertex + 1];
        const double at[2] = {map.matrix[0] * u + map.matrix[1] * v + map.matrix[2],
                              1 - (map.matrix[3] * u + map.matrix[4] * v + map.matrix[5])};
        for (int k = 0; k < 2; ++k) lo[k] = std::min(lo[k], at[k]), hi[k] = std::max(hi[k], at[k]);
    }
    // The rectangle in texels of the picture that is small enough.
    rt_texture picture = texture;
    for (rt_u32 level = 0; level < texture.levels; ++level) {
        if ((hi[0] - lo[0]) * picture.width <= kMostSide && (hi[1] - lo[1]) * picture.height <= kMostSide) break;
        picture = smaller_picture(picture);
    }
    const uint32_t* const texels = scene.texels.data() + picture.first;
    const int64_t width = picture.width, height = picture.height, size[2] = {width, height};
    int64_t first[2], count[2];
    for (int k = 0; k < 2; ++k) {
        // Half a texel more, because colours are interpolated. Where the picture repeats, once is enough.
        first[k] = static_cast<int64_t>(std::floor(std::clamp(lo[k], -1e6, 1e6) * double(size[k]) - 0.5));
        const auto end = static_cast<int64_t>(std::floor(std::clamp(hi[k], -1e6, 1e6) * double(size[k]) + 0.5));
        count[k] = std::min(end - first[k] + 1, 2 * size[k]);
    }
    double sum = 0;
    for (int64_t y = 0; y < count[1]; ++y)
        for (int64_t x = 0; x < count[0]; ++x)
            sum += brightness(texels[wrapped(first[1] + y, height, texture.wrap / RT_WRAP_ALONG_V) * width +
                                     wrapped(first[0] + x, width, texture.wrap % RT_WRAP_ALONG_V)],
                              texture);
    return sum / (double(count[0]) * double(count[1]));
}

std::vector<rt_u32> deal(const std::vector<double>& weights, rt_u32 total) {
    std::vector<rt_u32> shares(weights.size(), 0);
    double sum = 0;
    rt_u32 takers = 0;
    for (const double weight : weights)
        if (weight > 0) sum += weight, ++takers;
    if (takers == 0) return shares;
    // One for each; the rest by rounding the running sum, so that the total is exact.
    const double rest = double(total) - takers;
    double so_far = 0;
    rt_u32 dealt = 0, seen = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        so_far += weights[i];
        const auto until = ++seen == takers
                               ? static_cast<rt_u32>(rest)
                               : std::min(static_cast<rt_u32>(std::llround(so_far / sum * rest)), static_cast<rt_u32>(rest));
        shares[i] = 1 + until - dealt;
        dealt = until;
    }
    return shares;
}

unsigned fill_pick_table(const std::vector<double>& weights, std::vector<rt_emitter>& emitters) {
    const std::vector<rt_u32> shares = deal(weights, RT_PICKS);
    unsigned bits = 0;
    while ((size_t(1) << bits) < weights.size()) ++bits;
    const rt_u32 cells = rt_u32(1) << bits, room = rt_u32(1) << (RT_PICK_BITS - bits);
    emitters.resize(cells);
    std::vector<rt_u32> left(cells, 0), small, large;
    for (rt_u32 i = 0; i < cells; ++i) {
        if (i < shares.size()) left[i] = shares[i];
        emitters[i].alias = i;
        emitters[i].threshold = room;
        emitters[i].pick = static_cast<rt_f32>(double(left[i]) / RT_PICKS);
        (left[i] < room ? small : large).push_back(i);
    }
    // A cell whose own emitter does not fill it gives the rest to an emitter that has too much (Vose 1991, "A Linear Algorithm
    // for Generating Random Numbers with a Given Distribution").
    while (!small.empty() && !large.empty()) {
        const rt_u32 poor = small.back(), rich = large.back();
        small.pop_back();
        emitters[poor].threshold = left[poor];
        emitters[poor].alias = rich;
        left[rich] -= room - left[poor];
        if (left[rich] >= room) continue;
        large.pop_back();
        small.push_back(rich);
    }
    return bits;
}

}  // namespace clarity
