// materials.hpp -- the host's materials from the values that files have. For importers.
#pragma once
#include <algorithm>
#include <cmath>

#include "rt_plugin.h"

namespace importers {

inline float limited(double x, double low, double high, double if_not_finite) {
    return static_cast<float>(std::isfinite(x) ? std::clamp(x, low, high) : if_not_finite);
}

// color: three numbers or more. Values that are not finite become 0.
template <class Color>
void store_color(const Color& color, double factor, double most, float (&out)[3]) {
    for (unsigned k = 0; k < 3; ++k) out[k] = limited(color[k] * factor, 0, most, 0);
}

// A smooth metal mirrors, a rough one stays diffuse in its own colour, which out.color already has.
inline void apply_metallic(double metallic_factor, double roughness_factor, rt_material_desc& out) {
    const float metallic = limited(metallic_factor, 0, 1, 0), roughness = limited(roughness_factor, 0, 1, 1);
    const float smooth = 1 - roughness;
    out.reflect = metallic * smooth;
    // Blinn's exponent for a GGX roughness (alpha = roughness^2): 2 / alpha^2 - 2.
    const float alpha2 = std::max(1e-3f, roughness * roughness * roughness * roughness);
    out.shininess = std::clamp(2 / alpha2 - 2, 1.0f, 1000.0f);
    for (int k = 0; k < 3; ++k) out.specular[k] = smooth * (0.04f + metallic * (out.color[k] - 0.04f));
}

// Rays are bent only if the file gives an index of refraction above 1 or a transmission. Call it last.
inline void apply_transparency(double opacity, double transmission, double stated_ior, rt_material_desc& out) {
    const float transmitted = limited(transmission, 0, 1, 0);
    out.refract = std::max(1 - limited(opacity, 0, 1, 1), transmitted);
    out.ior = stated_ior > 1 ? limited(stated_ior, 1, 10, 1) : transmitted > 0 ? 1.5f : 1.0f;
    if (out.refract > 0) out.reflect = std::min(out.reflect, 1 - out.refract);
}

}  // namespace importers
