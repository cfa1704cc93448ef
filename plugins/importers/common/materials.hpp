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

// How much of a surface is there, as keys of the host. A description that has them points to them.
struct AlphaKeys {
    enum Mode { opaque, mask, blend };  // numbers of the words of `alpha`
    void set(Mode mode, double opacity, double cutoff = 0.5) {
        values[0].numbers[0] = static_cast<float>(mode);
        values[1].numbers[0] = limited(opacity, 0, 1, 1);
        values[2].numbers[0] = limited(cutoff, 0, 2, 0.5);
    }
    void give(rt_material_desc& out) const {
        if (values[0].numbers[0] == opaque) return;
        out.values = values;
        out.value_count = 3;
    }
    rt_key_value values[3] = {{"alpha", {opaque, 0, 0}, 0}, {"opacity", {1, 0, 0}, 0}, {"cutoff", {0.5f, 0, 0}, 0}};
};

// A surface is glass if the file gives an index of refraction above 1 or a transmission. Otherwise light passes straight
// through the share that its opacity leaves. Call it last.
inline void apply_transparency(double opacity, double transmission, double stated_ior, AlphaKeys& alpha,
                               rt_material_desc& out) {
    const float clear = 1 - limited(opacity, 0, 1, 1), transmitted = limited(transmission, 0, 1, 0);
    const bool is_glass = stated_ior > 1 || transmitted > 0;
    out.refract = is_glass ? std::max(clear, transmitted) : 0;
    out.ior = stated_ior > 1 ? limited(stated_ior, 1, 10, 1) : transmitted > 0 ? 1.5f : 1.0f;
    if (out.refract > 0) out.reflect = std::min(out.reflect, 1 - out.refract);
    if (!is_glass && clear > 0) alpha.set(AlphaKeys::blend, opacity);
}

}  // namespace importers
