#include "import/sink/opacity_map.hpp"

#include <cmath>

#include "rt_plugin.h"

namespace clarity::import {

void make_opacities(uint32_t* texels, const rt_texture& picture, uint32_t space) {
    for (size_t i = 0; i < size_t(picture.width) * picture.height; ++i) {
        const auto at = [&](unsigned k) { return texels[i] >> (8 * k) & 255u; };
        const double brightness = 0.2127 * at(0) + 0.7152 * at(1) + 0.0721 * at(2);
        const uint32_t opacity = space == RT_SPACE_ALPHA ? at(3) : static_cast<uint32_t>(std::lround(255 - brightness));
        texels[i] = opacity * 0x01010101u;
    }
}

}  // namespace clarity::import
