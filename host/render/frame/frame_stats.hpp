// frame_stats.hpp -- combines the statistics of several samples or several devices.
#pragma once
#include "render/frame/renderer.hpp"

namespace clarity {

// Adds ray counts and launches only.
void add_rays(FrameStats& sum, const FrameStats& more);
// Adds ray counts, launches and times of work that ran one after the other. Times of kernels are added by name.
void add_stats(FrameStats& sum, const FrameStats& more);
// Combines times of devices that ran side by side: the slowest device's time counts, by kernel name.
void merge_times(std::vector<KernelTime>& all, const std::vector<KernelTime>& one);

}  // namespace clarity
