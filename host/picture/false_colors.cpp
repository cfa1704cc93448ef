#include "picture/false_colors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/angle.hpp"
#include "base/lowbias32.hpp"
#include "base/pictures/srgb.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

using Rgb = std::array<uint8_t, 3>;
using Table = std::array<std::array<uint8_t, 4>, 257>;  // the last entry: nothing was hit
using Rgb3 = std::array<double, 3>;

uint8_t byte_of(double x) {
    return static_cast<uint8_t>(std::clamp(x, 0.0, 1.0) * 255 + 0.5);
}

// From lightness, chroma and hue to linear RGB: Ottosson 2020, A perceptual color space for image processing (Oklab).
Rgb3 linear_from_oklch(double lightness, double chroma, double hue) {
    const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
    const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3),
                 m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3),
                 s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

// Dark blue, violet, red, orange, pale yellow. Lightness rises in even steps, so that equal differences in value look equal,
// with or without colour vision (Kovesi 2015, Good Colour Maps: How to Design Them). The hue only helps to name the colours.
// The chroma is nearly the largest that sRGB has for this lightness and hue.
Table make_heat() {
    Table map;
    for (int i = 0; i < 256; ++i) {
        const double x = i / 255.0, lightness = 0.18 + 0.78 * x, hue = (275 + 190 * std::pow(x, 0.9)) * kRadPerDegree;
        double least = 0, most = 0.4;
        for (int step = 0; step < 30; ++step) {
            const double chroma = 0.5 * (least + most);
            const Rgb3 c = linear_from_oklch(lightness, chroma, hue);
            const bool inside = *std::min_element(c.begin(), c.end()) >= 0 && *std::max_element(c.begin(), c.end()) <= 1;
            (inside ? least : most) = chroma;
        }
        const Rgb3 c = linear_from_oklch(lightness, 0.92 * std::min(least, 0.2), hue);
        for (int k = 0; k < 3; ++k) map[i][k] = byte_of(srgb_from_linear(c[k]));
    }
    return map;
}

// Near surfaces are bright. A hit is never completely black.
Table make_gray() {
    Table map;
    for (int i = 0; i < 256; ++i) map[i].fill(byte_of(1 - 0.9 * i / 255.0));
    return map;
}

const Table& entries(FalseColorScale::Map map) {
    static const auto opaque = [](Table m) {
        m[256] = {};
        for (auto& entry : m) entry[3] = 255;
        return m;
    };
    static const Table heat = opaque(make_heat()), gray = opaque(make_gray());
    return map == FalseColorScale::Map::gray ? gray : heat;
}

// Adjacent numbers get different colours.
Rgb color_of_number(float number) {
    if (!(number >= 0)) return {0, 0, 0};
    const uint32_t h = lowbias32(static_cast<uint32_t>(number) + 1);
    Rgb color;
    for (int k = 0; k < 3; ++k) color[k] = static_cast<uint8_t>(64 + (h >> (8 * k) & 255) * 191 / 255);
    return color;
}

size_t pixel_count(const FloatImage& values) {
    return size_t(values.width) * values.height;
}

template <class Color>
void paint(const FloatImage& values, uint8_t* rgba, Color&& color) {
    const size_t pixels = pixel_count(values);
    for (size_t i = 0; i < pixels; ++i) {
        const Rgb c = color(&values.pixels[i * values.channels]);
        const uint8_t quad[4] = {c[0], c[1], c[2], 255};
        std::memcpy(rgba + 4 * i, quad, 4);
    }
}

}  // namespace

std::array<uint8_t, 3> color_at(const FalseColorScale& scale, float position) {
    // A NaN fails the comparison and gets the colour of 0.
    const auto& entry = entries(scale.map)[position > 0 ? static_cast<size_t>(std::min(position, 1.0f) * 255 + 0.5f) : 0];
    return {entry[0], entry[1], entry[2]};
}

FalseColorScale scale_of(const FloatImage& values, const std::string& name, float most) {
    const Aov& aov = find_aov(name);
    FalseColorScale scale = aov.scale;
    const bool share = aov.range == Aov::Range::share;
    if (scale.map == FalseColorScale::Map::none || (share && !(most > 0))) return scale;
    float low = INFINITY, high = -INFINITY;
    for (const float value : values.pixels) {  // no branch, so that it vectorises; NaN and infinity do not count
        low = value < low ? value : low;
        const float finite = value < INFINITY ? value : -INFINITY;
        high = finite > high ? finite : high;
    }
    if (aov.range == Aov::Range::measured && low <= high) scale.min = low;
    if (most > 0) high = most;
    scale.max = std::max(high, aov.range == Aov::Range::measured ? scale.min : scale.min + 1);
    return scale;
}

ByteImage false_colors(const FloatImage& values, const std::string& name, const FalseColorScale& scale) {
    const Aov::Paint how = find_aov(name).paint;
    std::vector<uint8_t> pixels(4 * pixel_count(values));
    uint8_t* const rgba = pixels.data();
    if (how == Aov::Paint::hash) {
        paint(values, rgba, [](const float* v) { return color_of_number(*v); });
    } else if (how == Aov::Paint::direction) {
        paint(values, rgba, [](const float* v) {
            if (v[0] == 0 && v[1] == 0 && v[2] == 0) return Rgb{};
            return Rgb{byte_of(0.5 + 0.5 * v[0]), byte_of(0.5 + 0.5 * v[1]), byte_of(0.5 + 0.5 * v[2])};
        });
    } else if (how == Aov::Paint::texture) {
        paint(values, rgba,
              [](const float* v) { return Rgb{byte_of(v[0] - std::floor(v[0])), byte_of(v[1] - std::floor(v[1])), 0}; });
    } else {
        const Table& map = entries(scale.map);
        const float factor = scale.max > scale.min ? 255 / (scale.max - scale.min) : 0, min = scale.min;
        const float* v = values.pixels.data();
        for (size_t i = 0, pixels = pixel_count(values); i < pixels; ++i, ++v) {
            const float at = std::min((*v - min) * factor + 0.5f, 255.0f);
            const int entry = *v < INFINITY ? at > 0 ? static_cast<int>(at) : 0 : 256;
            std::memcpy(rgba + 4 * i, map[entry].data(), 4);
        }
    }
    return {values.width, values.height, std::move(pixels)};
}

}  // namespace clarity
