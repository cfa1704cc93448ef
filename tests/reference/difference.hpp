// difference.hpp -- measures how much two pictures differ.
#pragma once
#include <algorithm>
#include <cstdlib>

#include "base/pictures/image_io.hpp"

namespace clarity::reference {

constexpr int kTolerance = 2;  // in steps of 1/255, in the channel that differs most

// Difference of two pictures of the same size. beyond: number of pixels that differ by more than kTolerance.
struct Difference {
    size_t pixels = 0, beyond = 0;
    int worst = 0;
    ByteImage picture;  // eight times the difference, to look at
    double share() const { return double(beyond) / double(pixels); }
};

inline Difference compare(const ByteImage& a, const ByteImage& b) {
    Difference d;
    d.pixels = size_t(a.width) * a.height;
    std::vector<uint8_t> picture(a.pixels.begin(), a.pixels.end());
    for (size_t i = 0; i < d.pixels; ++i) {
        int most = 0;
        for (size_t c = 4 * i; c < 4 * i + 3; ++c) {
            const int off = std::abs(int(a.pixels[c]) - int(b.pixels[c]));
            most = std::max(most, off);
            picture[c] = static_cast<uint8_t>(std::min(255, 8 * off));
        }
        d.beyond += most > kTolerance;
        d.worst = std::max(d.worst, most);
    }
    d.picture = {a.width, a.height, std::move(picture)};
    return d;
}

}  // namespace clarity::reference
