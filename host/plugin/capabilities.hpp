// capabilities.hpp -- names of what a structure can do: rt_accel::capabilities as text, for people, JSON and kernels.
#pragma once
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

// One bit of rt_accel::capabilities. A new capability is a new row in capabilities.cpp.
struct Capability {
    rt_u32 bit;
    const char* name;    // in `clarity plugins`
    const char* define;  // in the kernels of structures that have it
};
const std::vector<Capability>& capabilities();

// Names of those that a structure has, in the order of their bits. Bits that this host does not know have none.
std::vector<std::string> capability_names(const rt_accel& accel);

}  // namespace clarity
