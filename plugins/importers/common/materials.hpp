// materials.hpp -- the host's materials from the values that files have. For importers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

// Further values by the keys of the host's table. A description that has them points to them.
class MaterialKeys {
 public:
    void set(const char* key, double number) { set(key, std::array<double, 3>{number, number, number}); }
    void set(const char* key, const std::array<double, 3>& numbers) {
        rt_key_value value = {key, {}, 0};
        for (size_t k = 0; k < 3; ++k) value.numbers[k] = static_cast<float>(numbers[k]);
        values_.push_back(value);
    }
    void add(const rt_key_value* values, size_t count) { values_.insert(values_.end(), values, values + count); }
    void give(rt_material_desc& out) const {
        out.values = values_.data();
        out.value_count = static_cast<rt_u32>(values_.size());
    }

 private:
    std::vector<rt_key_value> values_;
};
inline bool has_map(const std::vector<rt_map_desc>& maps, rt_u32 use) {
    return std::any_of(maps.begin(), maps.end(), [&](const rt_map_desc& map) { return map.use == use; });
}
// The description points to the maps, which must outlive it.
inline void give_maps(const std::vector<rt_map_desc>& maps, rt_material_desc& out) {
    out.maps = maps.data();
    out.map_count = static_cast<rt_u32>(maps.size());
    out.map_bytes = sizeof(rt_map_desc);
}

// Numbers of the words of the key `model`.
enum Model { whitted_model, lambert_model, conductor_model, dielectric_model, gltf_model, unlit_model };

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
    void give(MaterialKeys& keys) const {
        if (values[0].numbers[0] != opaque) keys.add(values, 3);
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
