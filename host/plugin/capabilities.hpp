// capabilities.hpp -- names of the bits of rt_accel::capabilities, for messages, JSON and kernels.
#pragma once
#include <string>
#include <vector>

#include "rt_plugin.h"

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

}  // namespace clarity
