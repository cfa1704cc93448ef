// views.hpp -- passes lights and cameras to the host. For importers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

namespace importers {

// The cone of a spot light: whole angles in radians. Beyond `angle` it has no light, within `inner` it has its full intensity.
struct Cone {
    double angle = 1, inner = 0;
};

// What a file means by the intensity of a light.
enum class Unit {
    relative,  // a white surface that faces it is as bright as its colour says, whatever the distance
    physical   // an intensity (W/sr, candela), which fades by the square of the distance; of a sun an irradiance (W/m^2, lux);
               // of a light with a size a radiance
};

// The lights of a file. Relative ones are scaled until the brightest of them is 1; physical ones stay as they are.
class Lights {
 public:
    // intensity: what the colour is multiplied by. cone: of a spot. range: where physical light ends; 0: nowhere.
    void add(rt_light_desc light, const std::string& name, const double (&color)[3], double intensity, Unit unit,
             const Cone& cone = {}, double range = 0) {
        for (int k = 0; k < 3; ++k) {
            const double c = color[k] * intensity;
            light.color[k] = std::isfinite(c) ? static_cast<float>(std::clamp(c, 0.0, 1e12)) : 0;
            if (unit == Unit::relative) brightest_ = std::max(brightest_, light.color[k]);
        }
        Passed& added = lights_.emplace_back();
        added.name = name, added.unit = unit;
        const bool is_spot = light.kind == RT_LIGHT_SPOT;
        if (is_spot) added.values = {rt::value("angle", degrees(cone.angle)), rt::value("inner", degrees(cone.inner))};
        if (unit == Unit::physical && (is_spot || light.kind == RT_LIGHT_POINT))
            added.values.insert(added.values.end(), {rt::value("falloff", 1), rt::value("range", static_cast<float>(range))});
        if (light.kind == RT_LIGHT_SUN) added.values.push_back(rt::value("angle", 0));
        added.desc = light;
    }
    // By what the colour of the light that was added as the i-th is multiplied.
    float scale(size_t i) const { return lights_[i].unit == Unit::relative ? 1 / brightest_ : 1; }
    // Returns the ids in the order in which the lights were added.
    std::vector<rt_u32> pass(const rt_host* host, const rt_scene_sink& sink) {
        if (brightest_ > 1) rt::log(host, RT_LOG_INFO, "light intensities are scaled by " + std::to_string(1 / brightest_));
        std::vector<rt_u32> ids;
        bool is_physical = false;
        for (size_t i = 0; i < lights_.size(); ++i) {
            rt_light_desc& desc = lights_[i].desc;
            for (float& c : desc.color) c *= scale(i);
            desc.name = lights_[i].name.c_str();
            desc.values = lights_[i].values.data();
            desc.value_count = static_cast<rt_u32>(lights_[i].values.size());
            ids.push_back(rt::id(sink.light(sink.ctx, &desc)));
            is_physical |= lights_[i].unit == Unit::physical;
        }
        if (is_physical)
            rt::log(host, RT_LOG_INFO,
                    "lights have physical units, as the file says: --exposure (a row of the panel) makes the picture brighter "
                    "or darker");
        return ids;
    }

 private:
    struct Passed {
        rt_light_desc desc{};
        std::string name;
        Unit unit = Unit::relative;
        std::vector<rt_key_value> values;
    };
    static float degrees(double radians) {
        const double value = radians * 57.29577951308232;
        return std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 180.0)) : 0;
    }

    std::vector<Passed> lights_;
    float brightest_ = 1;
};

// The angle of view of a camera, in radians, or 45 degrees with a warning if it has none. label: the camera's name in quotes.
inline float angle_of_view(double angle, const std::string& label, const rt_scene_sink& sink) {
    if (angle > 0.001 && angle <= 3.1) return static_cast<float>(angle);
    rt::warn(sink, "the camera " + label + " has no angle of view (orthographic?): 45 degrees are used");
    return 0.7853982f;
}

}  // namespace importers
