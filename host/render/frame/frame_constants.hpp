// frame_constants.hpp -- rt_frame from a view and settings.
#pragma once
#include "render/frame/renderer.hpp"
#include "render/kernels/kernel_source.hpp"

namespace clarity {

rt_frame make_frame(const View& view, const Settings& settings, const Layout& layout, const AccelData& accel, unsigned sample);

}  // namespace clarity
