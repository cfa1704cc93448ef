// embree_frame.hpp -- renders the Whitted frame with Embree, as a renderer written for Embree would do it.
#pragma once
#include <embree3/rtcore.h>

#include "bench/baselines/baseline.hpp"

namespace clarity::bench {

// Renders one frame and returns the wall time in ms. coherent: sets Embree's coherent flag for rays of all generations; else
// only for camera rays and their shadow rays. film: r, g, b and the number of samples of each pixel, as in our film. counts:
// rays traced.
double embree_frame(RTCScene scene, const BaselineMesh& mesh, const WhittedScene& whitted, bool coherent, unsigned threads,
                    BaselineArray<float>& film, BaselineRayCounts& counts);

}  // namespace clarity::bench
