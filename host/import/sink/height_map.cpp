#include "import/sink/height_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace clarity::import {
namespace {

constexpr double kHeight = 1.0 / 50;  // of white above black, in widths of the picture
constexpr int kGrey = 8;              // by which channels of a grey texel may differ, as JPEG has them

int channel(uint32_t texel, int k) {
    return static_cast<int>(texel >> (8 * k) & 255u);
}
bool is_grey(uint32_t texel) {
    return std::abs(channel(texel, 0) - channel(texel, 1)) <= kGrey && std::abs(channel(texel, 1) - channel(texel, 2)) <= kGrey;
}
uint32_t byte_of(double component) {
    return static_cast<uint32_t>(std::lround((component + 1) / 2 * 255));
}

}  // namespace

void make_normals(uint32_t* texels, const rt_texture& picture) {
    const size_t width = picture.width, height = picture.height, count = width * height;
    const auto grey = static_cast<size_t>(std::count_if(texels, texels + count, is_grey));
    if (grey < count - count / 8) return;
    std::vector<uint8_t> heights(count);
    for (size_t i = 0; i < count; ++i) heights[i] = static_cast<uint8_t>(channel(texels[i], 0));
    const double step = kHeight * static_cast<double>(width) / 255 / 2;  // of a byte over two texels
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            // Pictures repeat. Rows go downwards, and the normal's y upwards.
            const auto at = [&](size_t column, size_t row) { return double(heights[row % height * width + column % width]); };
            const double dx = step * (at(x + 1, y) - at(x + width - 1, y)), dy = step * (at(x, y + height - 1) - at(x, y + 1));
            const double scale = 1 / std::sqrt(dx * dx + dy * dy + 1);
            texels[y * width + x] = 0xff000000u | byte_of(-dx * scale) | byte_of(-dy * scale) << 8 | byte_of(scale) << 16;
        }
}

}  // namespace clarity::import
