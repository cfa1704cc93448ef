// frame_constants.hpp -- the constants of a frame (rt_frame) from a view and settings.
#pragma once
#include "kernels/layout.hpp"
#include "structures/accel_build.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {

// Returns the constants of sample `sample`, 0 being the first. With a sample above 0 the kernel adds to the film.
rt_frame make_frame(const View& view, const Settings& settings, const Layout& layout, const AccelData& accel, unsigned sample);

}  // namespace clarity
