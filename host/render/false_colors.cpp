#include "render/false_colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clarity {
namespace {

using Rgb = std::array<float, 3>;

// lowbias32 (Wellons 2018): neighbouring numbers get unlike colours.
uint32_t hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

Rgb color_of_number(float number) {
    if (number < 0) return {0, 0, 0};
    const uint32_t h = hash(static_cast<uint32_t>(number) + 1);
    return {0.25f + 0.75f * float(h & 255) / 255, 0.25f + 0.75f * float(h >> 8 & 255) / 255,
            0.25f + 0.75f * float(h >> 16 & 255) / 255};
}

// Dark blue, violet, orange, yellow: even steps of brightness, readable without colour vision.
Rgb heat(float x) {
    static constexpr Rgb stops[] = {
        {0.05f, 0.03f, 0.25f}, {0.45f, 0.05f, 0.55f}, {0.85f, 0.25f, 0.35f}, {0.98f, 0.6f, 0.15f}, {0.98f, 0.98f, 0.6f}};
    const float at = std::clamp(x, 0.0f, 1.0f) * 4;
    const int i = std::min(3, static_cast<int>(at));
    Rgb out;
    for (int k = 0; k < 3; ++k) out[k] = stops[i][k] + (at - float(i)) * (stops[i + 1][k] - stops[i][k]);
    return out;
}

}  // namespace

ByteImage false_colors(const FloatImage& values, const std::string& aov) {
    ByteImage image;
    image.width = values.width;
    image.height = values.height;
    const size_t pixels = size_t(values.width) * values.height;
    image.pixels.resize(pixels * 4);
    float least = INFINITY, most = 0;
    for (const float value : values.pixels)
        if (std::isfinite(value)) {
            least = std::min(least, value);
            most = std::max(most, value);
        }
    const float span = most > least ? most - least : 1;
    for (size_t i = 0; i < pixels; ++i) {
        const float* v = &values.pixels[i * values.channels];
        Rgb c{};
        if (aov == "t")
            c.fill(std::isfinite(*v) ? 1 - 0.9f * (*v - least) / span : 0);
        else if (aov == "prim" || aov == "instance")
            c = color_of_number(*v);
        else if (aov == "normal")
            c = v[0] == 0 && v[1] == 0 && v[2] == 0 ? Rgb{} : Rgb{0.5f + 0.5f * v[0], 0.5f + 0.5f * v[1], 0.5f + 0.5f * v[2]};
        else if (aov == "uv")
            c = {v[0] - std::floor(v[0]), v[1] - std::floor(v[1]), 0};
        else
            c = heat(*v / std::max(most, 1.0f));
        for (int k = 0; k < 3; ++k) image.pixels[4 * i + k] = static_cast<uint8_t>(std::clamp(c[k], 0.0f, 1.0f) * 255 + 0.5f);
        image.pixels[4 * i + 3] = 255;
    }
    return image;
}

}  // namespace clarity
