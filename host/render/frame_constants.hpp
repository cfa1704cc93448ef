// frame_constants.hpp -- rt_frame from a view and settings.
#pragma once
#include "render/renderer.hpp"

namespace clarity {

rt_frame make_frame(const View& view, const Settings& settings, const AccelData& accel, unsigned sample);

}  // namespace clarity
