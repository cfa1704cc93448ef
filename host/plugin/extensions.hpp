// extensions.hpp -- finds the extensions of a plugin that this host knows.
#pragma once
#include "rt_device.h"
#include "rt_refit.h"

namespace clarity {

// The extension `refit` of a structure; refit is nullptr if it has none of a version that this host knows. The tables of
// plugins are the registry's copies.
rt_refit refit_of(const rt_plugin& plugin);
// The extension `device_build`; topology, pack and refit are nullptr if it has none of a version that this host knows.
rt_device_build device_build_of(const rt_plugin& plugin);

}  // namespace clarity
