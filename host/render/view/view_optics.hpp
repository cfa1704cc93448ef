// view_optics.hpp -- which kinds of lights and surfaces a view has.
#pragma once
#include "render/settings/settings.hpp"
#include "render/view/view.hpp"

namespace clarity {

// Those of the scene's own view.
Optics optics_of(const Scene& scene);
// Those of a view, as far as kernels of these settings' tracer tell them apart.
Optics optics_of(const Scene& scene, const View& view, const Settings& settings);
// Whether kernels that were prepared for the scene with these settings know those of the view.
bool knows(const Settings& prepared, const Scene& scene, const View& view);
// Settings for a scene that will be traced with that view.
Settings with_optics(Settings settings, const Scene& scene, const View& view);

}  // namespace clarity
