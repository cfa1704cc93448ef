// capabilities.hpp -- what a plugin says that it can do: the bits of rt_accel::capabilities with their names, and extensions.
#pragma once
#include <string>
#include <vector>

#include "rt_device.h"
#include "rt_plugin.h"
#include "rt_refit.h"

namespace clarity {

// One bit of rt_accel::capabilities. A new capability is a new row in capabilities.cpp.
struct Capability {
    rt_u32 bit;
    const char* name;    // in `clarity plugins`
    const char* define;  // macro in the kernels of structures that have the capability
};
const std::vector<Capability>& capabilities();

// Returns the names of a structure's capabilities in the order of their bits. Bits that this host does not know are left out.
std::vector<std::string> capability_names(const rt_accel& accel);

// Finds the extensions of a plugin that this host knows.

// The extension `refit` of a structure; refit is nullptr if it has none of a version that this host knows. The tables of
// plugins are the registry's copies.
rt_refit refit_of(const rt_plugin& plugin);
// The extension `device_build`; topology, pack and refit are nullptr if it has none of a version that this host knows.
rt_device_build device_build_of(const rt_plugin& plugin);

}  // namespace clarity
