// frame_constants.hpp -- rt_frame from a view and settings.
#pragma once
#include "render/kernel_source.hpp"
#include "render/renderer.hpp"

namespace clarity {

rt_frame make_frame(const View& view, const Settings& settings, const Layout& layout, const AccelData& accel, unsigned sample);

}  // namespace clarity
