#include "tools/bench/baselines/whitted.hpp"

#include <cmath>

#include "base/error.hpp"
#include "scene/light_kinds.hpp"
#include "stand/multi_frame_renderer.hpp"

namespace clarity::bench {

View whitted_view(const Scene& scene, View view) {
    if (view.lights.empty())
        throw Error(Exit::failed, "the scene has no light, and the frame of the peers needs one: add a light to the scene");
    view.lights.resize(1);
    // Peers know two kinds of lights.
    const rt_light& first = view.lights[0];
    view.lights[0] = whitted_light(light_kind_of(first).has_place ? RT_LIGHT_POINT : RT_LIGHT_DIRECTIONAL,
                                   {first.position[0], first.position[1], first.position[2]},
                                   {first.color[0], first.color[1], first.color[2]});
    rt_material mirror{};
    for (float& c : mirror.color) c = 0.8f;
    mirror.reflect = 0.5f;
    mirror.shininess = mirror.ior = 1;
    mirror.texture = RT_NONE;
    view.materials.assign(scene.materials.size(), mirror);
    return view;
}

WhittedScene whitted_scene(const View& view, const Settings& settings) {
    WhittedScene whitted;
    whitted.frame = frame_constants(view, settings);
    whitted.light = view.lights.at(0);
    whitted.color = view.materials.at(0).color[0];
    whitted.reflect = view.materials.at(0).reflect;
    whitted.min_weight = static_cast<float>(number_of(settings, "min_weight"));
    whitted.generations = static_cast<unsigned>(settings.depth);
    return whitted;
}

double differing_pixels(const FloatImage& a, const FloatImage& b, float tolerance) {
    if (a.width != b.width || a.height != b.height || a.channels != b.channels || a.pixels.empty()) return 1;
    size_t differ = 0;
    for (size_t i = 0; i < a.pixels.size(); i += a.channels) {
        bool same = true;
        for (unsigned c = 0; c < a.channels; ++c) same &= std::fabs(a.pixels[i + c] - b.pixels[i + c]) <= tolerance;
        differ += !same;
    }
    return double(differ) * a.channels / double(a.pixels.size());
}

}  // namespace clarity::bench
