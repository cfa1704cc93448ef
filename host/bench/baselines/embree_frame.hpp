// embree_frame.hpp -- Whitted's frame by Embree: what a renderer written for it would do.
#pragma once
#include <embree3/rtcore.h>

#include "bench/baselines/baseline.hpp"

namespace clarity::bench {

// coherent: the flag for rays of all generations, else for camera rays and their shadow rays only. film: r, g, b and the number
// of samples of each pixel, as ours has them. Returns the wall time in ms. counts: rays traced.
double embree_frame(RTCScene scene, const BaselineMesh& mesh, const WhittedScene& whitted, bool coherent, unsigned threads,
                    BaselineArray<float>& film, BaselineRayCounts& counts);

}  // namespace clarity::bench
