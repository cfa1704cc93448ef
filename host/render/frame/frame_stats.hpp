// frame_stats.hpp -- figures of several samples, or of several devices, as one.
#pragma once
#include "render/frame/renderer.hpp"

namespace clarity {

void add_rays(FrameStats& sum, const FrameStats& more);
// Adds up what was traced one after the other; times of kernels by their names.
void add_stats(FrameStats& sum, const FrameStats& more);
// Of devices side by side: the slowest's time.
void merge_times(std::vector<KernelTime>& all, const std::vector<KernelTime>& one);

}  // namespace clarity
