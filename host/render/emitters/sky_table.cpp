#include "render/emitters/sky_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/half.hpp"
#include "base/parallel_for.hpp"
#include "render/emitters/pick_table.hpp"

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

}  // namespace

SkyTable make_sky_table(const Sky& sky) {
    SkyTable table;
    for (const float texel : sky.texels)
        while (texel > kLargestHalf * table.scale) table.scale *= 2;
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

}  // namespace clarity
