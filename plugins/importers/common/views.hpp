// views.hpp -- passes lights and cameras to the host. For importers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

namespace importers {

// The cone of a spot light: whole angles in radians. Beyond `angle` it has no light, within `inner` it has its full intensity.
struct Cone {
    double angle = 1, inner = 0;
};

// The lights of a file. Physical intensities (watts, candela, lux) assume falloff with distance. Lights here have none, so all
// of them are scaled until the brightest is 1.
class Lights {
 public:
    // intensity: what the colour is multiplied by. cone: of a spot.
    void add(rt_light_desc light, const std::string& name, const double (&color)[3], double intensity, const Cone& cone = {}) {
        for (int k = 0; k < 3; ++k) {
            const double c = color[k] * intensity;
            light.color[k] = std::isfinite(c) ? static_cast<float>(std::clamp(c, 0.0, 1e30)) : 0;
            brightest_ = std::max(brightest_, light.color[k]);
        }
        names_.push_back(name);
        light.name = names_.back().c_str();
        if (light.kind == RT_LIGHT_SPOT) {
            cones_.push_back({rt::value("angle", degrees(cone.angle)), rt::value("inner", degrees(cone.inner))});
            light.values = cones_.back().data();
            light.value_count = static_cast<rt_u32>(cones_.back().size());
        }
        lights_.push_back(light);
    }
    float scale() const { return 1 / brightest_; }
    // Returns the ids in the order in which the lights were added.
    std::vector<rt_u32> pass(const rt_host* host, const rt_scene_sink& sink) {
        if (brightest_ > 1) rt::log(host, RT_LOG_INFO, "light intensities are scaled by " + std::to_string(scale()));
        std::vector<rt_u32> ids;
        for (rt_light_desc& light : lights_) {
            for (float& c : light.color) c *= scale();
            ids.push_back(rt::id(sink.light(sink.ctx, &light)));
        }
        return ids;
    }

 private:
    std::vector<rt_light_desc> lights_;
    static float degrees(double radians) {
        const double value = radians * 57.29577951308232;
        return std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 180.0)) : 0;
    }

    std::deque<std::string> names_;  // which does not move them
    std::deque<std::array<rt_key_value, 2>> cones_;
    float brightest_ = 1;
};

// The angle of view of a camera, in radians, or 45 degrees with a warning if it has none. label: the camera's name in quotes.
inline float angle_of_view(double angle, const std::string& label, const rt_scene_sink& sink) {
    if (angle > 0.001 && angle <= 3.1) return static_cast<float>(angle);
    rt::warn(sink, "the camera " + label + " has no angle of view (orthographic?): 45 degrees are used");
    return 0.7853982f;
}

}  // namespace importers
