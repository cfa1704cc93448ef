// light_range.hpp -- light of a picture whose texels are numbers of few bits. They hold it divided by a power of two, one for
// the whole picture, so that dark pictures keep their digits and bright ones are not cut off.
#pragma once
#include <algorithm>

namespace clarity {

// A picture's least number above 0, and its greatest.
struct LightRange {
    void add(float light) {
        if (!(light > 0)) return;
        least = most > 0 ? std::min(least, light) : light;
        most = std::max(most, light);
    }

    float least = 0, most = 0;
};

// By which power of two light is divided, so that `held` has all of it, with all digits. 0 where it does so anyway. Where no
// power does, the brightest light is held, and what is darkest loses digits.
inline int power_that_fits(const LightRange& light, const LightRange& held) {
    constexpr int kLeast = -112;  // so that the factor, and what it is multiplied by, are normal floats
    int power = 0;
    double factor = 1;
    while (light.most > held.most * factor) factor *= 2, ++power;
    while (power > kLeast && light.most > 0 && light.least < held.least * factor && light.most <= held.most * factor / 2)
        factor /= 2, --power;
    return power;
}

}  // namespace clarity
