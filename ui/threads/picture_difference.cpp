#include "ui/threads/picture_difference.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace clarity::ui {

PictureDifference compare_pictures(const ByteImage& a, const ByteImage& b) {
    PictureDifference out;
    if (a.width != b.width || a.height != b.height) {
        out.mean = out.largest = 255;
        out.share = 1;
        return out;
    }
    std::vector<uint8_t> pixels(a.pixels.size());
    constexpr int kBrighter = 8;
    uint64_t sum = 0, differing = 0;
    int largest = 0;
    for (size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
        int most = 0;
        for (size_t k = 0; k < 3; ++k) {
            const int d = std::abs(int(a.pixels[i + k]) - int(b.pixels[i + k]));
            sum += static_cast<uint64_t>(d);
            most = std::max(most, d);
            pixels[i + k] = static_cast<uint8_t>(std::min(255, d * kBrighter));
        }
        pixels[i + 3] = 255;
        differing += most > 1;
        largest = std::max(largest, most);
    }
    const double count = static_cast<double>(pixels.size()) / 4;
    if (count > 0) {
        out.mean = static_cast<double>(sum) / (3 * count);
        out.share = static_cast<double>(differing) / count;
    }
    out.largest = largest;
    out.image = {a.width, a.height, std::move(pixels)};
    return out;
}

}  // namespace clarity::ui
