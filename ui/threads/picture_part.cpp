#include "ui/threads/picture_part.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::ui {
namespace {

constexpr uint8_t kUnknown = 24;  // grey where nothing is known
constexpr unsigned kAround = 90;  // of 256: how bright the rest is
constexpr size_t kBytes = 4;      // of a pixel

size_t place_of(const Settings& settings, unsigned row) {
    return (size_t(settings.crop.y) + row) * size_t(settings.whole_width()) + size_t(settings.crop.x);
}

bool is_part(const Settings& settings) {
    return settings.crop.whole_width > 0;
}

}  // namespace

std::string crop_text(const PicturePart& part, int width, int height) {
    const auto span = [](float first, float size, int all) {
        const int begin = std::clamp(static_cast<int>(std::lround(first * static_cast<float>(all))), 0, all - 1);
        const int end = std::clamp(static_cast<int>(std::lround((first + size) * static_cast<float>(all))), begin + 1, all);
        return std::pair(begin, end - begin);
    };
    const auto [x, w] = span(part.x, part.width, width);
    const auto [y, h] = span(part.y, part.height, height);
    return std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(w) + "," + std::to_string(h);
}

Settings of_whole(Settings settings) {
    settings.width = settings.whole_width();
    settings.height = settings.whole_height();
    settings.crop = {};
    return settings;
}

ByteImage in_whole(const ByteImage& part, const Settings& settings, const ByteImage& around) {
    const auto width = static_cast<unsigned>(settings.whole_width()), height = static_cast<unsigned>(settings.whole_height());
    if (part.width != unsigned(settings.width) || part.height != unsigned(settings.height))
        return in_whole(cropped(part, settings), settings, around);
    std::vector<uint8_t> pixels(kBytes * width * height, kUnknown);
    const bool known = around.width == width && around.height == height;
    for (size_t i = 0; i < pixels.size(); ++i)
        if (i % kBytes == kBytes - 1)
            pixels[i] = 255;
        else if (known)
            pixels[i] = static_cast<uint8_t>(around.pixels[i] * kAround / 256);
    for (unsigned row = 0; row < part.height; ++row)
        std::copy_n(part.pixels.data() + kBytes * row * part.width, kBytes * part.width,
                    pixels.begin() + std::ptrdiff_t(kBytes * place_of(settings, row)));
    return {width, height, std::move(pixels)};
}

FloatImage in_whole(const FloatImage& part, const Settings& settings, float outside) {
    if (!is_part(settings) || part.pixels.empty()) return part;
    const auto width = static_cast<unsigned>(settings.whole_width()), height = static_cast<unsigned>(settings.whole_height());
    FloatImage whole{width, height, part.channels, {}};
    whole.pixels.assign(size_t(width) * height * part.channels, outside);
    for (unsigned row = 0; row < part.height; ++row)
        std::copy_n(part.pixels.begin() + std::ptrdiff_t(size_t(row) * part.width * part.channels), part.width * part.channels,
                    whole.pixels.begin() + std::ptrdiff_t(place_of(settings, row) * part.channels));
    return whole;
}

ByteImage cropped(const ByteImage& whole, const Settings& settings) {
    if (!is_part(settings)) return whole;
    const auto width = static_cast<unsigned>(settings.width), height = static_cast<unsigned>(settings.height);
    std::vector<uint8_t> pixels(kBytes * width * height);
    for (unsigned row = 0; row < height; ++row)
        std::copy_n(whole.pixels.data() + kBytes * place_of(settings, row), kBytes * width,
                    pixels.begin() + std::ptrdiff_t(kBytes * row * width));
    return {width, height, std::move(pixels)};
}

}  // namespace clarity::ui
