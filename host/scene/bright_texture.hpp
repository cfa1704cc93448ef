// bright_texture.hpp -- textures of light, which may be above 1. Their texels have a shared exponent
// (base/pictures/shared_exponent.hpp), are linear for every use, and have no alpha.
#pragma once
#include <algorithm>

#include "scene/scene.hpp"

namespace clarity {

// A flag of rt_texture, beside RT_TEXTURE_LINEAR; cl/shading/textures.h has the same number.
inline constexpr rt_u32 kBrightTexture = 4;

inline bool is_bright(const rt_texture& texture) {
    return (texture.flags & kBrightTexture) != 0;
}
inline bool has_bright_textures(const Scene& scene) {
    return std::any_of(scene.textures.begin(), scene.textures.end(), is_bright);
}

}  // namespace clarity
