// whitted.hpp -- the frame which we and the baselines both render: every surface is a half mirror of one grey, with one light
// and shadows.
#pragma once
#include "base/pictures/image_io.hpp"
#include "scene/scene.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity::bench {

// The data which a baseline needs to render it. The camera's vectors are those of rt_frame, so that all rays are the same.
struct WhittedScene {
    rt_frame frame{};
    rt_light light{};
    float color = 0, reflect = 0, min_weight = 0;
    unsigned generations = 5;
};

// The view with the scene's first light only and all materials replaced by half mirrors. Throws Error(failed) if the scene has
// no light.
View whitted_view(const Scene& scene, View view);
WhittedScene whitted_scene(const View& view, const Settings& settings);

// Share (0..1) of the pixels which differ by more than `tolerance` in any channel; 1 if the sizes differ.
double differing_pixels(const FloatImage& a, const FloatImage& b, float tolerance);

}  // namespace clarity::bench
