// srgb.hpp -- the curve of sRGB (IEC 61966-2-1), both ways, of 0..1, and the luminance of its primaries.
#pragma once
#include <cmath>

namespace clarity {

inline double linear_from_srgb(double x) {
    return x <= .04045 ? x / 12.92 : std::pow((x + .055) / 1.055, 2.4);
}
inline double srgb_from_linear(double x) {
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}
// Of linear colours: Rec. 709.
inline double luminance_of(const float* rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

}  // namespace clarity
