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
    bool empty() const { return values_.empty(); }
    void give(rt_material_desc& out) const {
        out.values = values_.data();
        out.value_count = static_cast<rt_u32>(values_.size());
    }

 private:
    std::vector<rt_key_value> values_;
};
// Removes the maps of a use.
template <class Map>
void drop_map(std::vector<Map>& maps, rt_u32 use) {
    maps.erase(std::remove_if(maps.begin(), maps.end(), [&](const Map& map) { return map.use == use; }), maps.end());
}
// Whether a colour has a hue: its channels differ by more than the steps of a picture.
template <class Color>
bool has_hue(const Color& c) {
    return std::max({c[0], c[1], c[2]}) - std::min({c[0], c[1], c[2]}) > 1.0 / 256;
}
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

// GGX is as wide as a highlight of Blinn's with this exponent: alpha = roughness^2 = sqrt(2 / (n + 2)) (Walter et al. 2007,
// section 5.3).
inline double roughness_of(double exponent) {
    return std::sqrt(std::sqrt(2 / (std::max(exponent, 0.0) + 2)));
}

// A highlight of Phong's or Blinn's as the reflection of a surface of glTF, which `path` shows too. Call it last. Its strength
// is no reflectance: files say 0.5 of plastic, which reflects 0.04 straight on. So a strength of 1 is a reflectance of 0.08, as
// it is of `specular` in Burley 2012, "Physically-based shading at Disney", section 5; Blender's importers read files so.
// Below 0.5 the reflection at grazing angles fades, too. Mirrors and glass have none besides: they show the lamp. Returns
// whether it did; only then has the material the map of its specular color.
inline bool add_highlight(const rt_material_desc& out, MaterialKeys& keys) {
    const double strength = std::max({out.specular[0], out.specular[1], out.specular[2]});
    if (!(strength > 0) || out.reflect > 0 || out.refract > 0) return false;
    constexpr double kIor = 1.5, kOfIor = 0.04, kMost = 0.08;
    const double weight = std::min(1.0, strength * kMost / kOfIor);
    std::array<double, 3> highlight{}, color{};
    for (size_t k = 0; k < 3; ++k) {
        highlight[k] = out.specular[k];
        color[k] = highlight[k] * kMost / kOfIor / weight;
    }
    keys.set("model", gltf_model);
    keys.set("ior", kIor);
    keys.set("roughness", roughness_of(out.shininess));
    keys.set("specular_weight", weight);
    keys.set("specular_color", color);
    // Whitted's tracers show it as the file has it.
    keys.set("reflect", 0);
    keys.set("refract", 0);
    keys.set("specular", highlight);
    keys.set("shininess", out.shininess);
    return true;
}

}  // namespace importers
