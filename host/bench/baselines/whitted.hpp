// whitted.hpp -- the frame that ours and peers both render: every surface a half mirror of one grey, one light, shadows.
#pragma once
#include "render/frame/renderer.hpp"

namespace clarity::bench {

// What a peer needs of it. The camera's vectors are those of rt_frame, so that all rays are the same.
struct WhittedScene {
    rt_frame frame{};
    rt_light light{};
    float color = 0, reflect = 0, min_weight = 0;
    unsigned generations = 5;
};

// The scene's view with its first light alone and all its materials turned into half mirrors. Throws Error(failed) if there is
// no light.
View whitted_view(const Scene& scene, View view);
WhittedScene whitted_scene(const View& view, const Settings& settings);

// Of how many pixels two pictures differ by more than `tolerance` in any channel; 0..1. Sizes that differ: 1.
double differing_pixels(const FloatImage& a, const FloatImage& b, float tolerance);

}  // namespace clarity::bench
