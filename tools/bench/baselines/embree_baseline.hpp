// embree_baseline.hpp -- Embree as a baseline.
#pragma once
#include "tools/bench/baselines/baseline.hpp"
#include "tools/bench/baselines/embree.hpp"

namespace clarity::bench {

std::unique_ptr<BaselineScene> build_embree(const BaselineMesh& mesh, const std::string& quality, unsigned threads);

// Renders the Whitted frame with Embree, as a renderer written for Embree would do it.

// Renders one frame and returns the wall time in ms. coherent: sets Embree's coherent flag for rays of all generations; else
// only for camera rays and their shadow rays. film: r, g, b and the number of samples of each pixel, as in our film. counts:
// rays traced.
double embree_frame(RTCScene scene, const BaselineMesh& mesh, const WhittedScene& whitted, bool coherent, unsigned threads,
                    BaselineArray<float>& film, BaselineRayCounts& counts);

}  // namespace clarity::bench
