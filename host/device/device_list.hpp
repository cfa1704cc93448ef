// device_list.hpp -- functions that listing and choosing devices share.
#pragma once
#include "device/device.hpp"

namespace clarity {

inline constexpr const char* kInstallDriver =
    "install an OpenCL driver: on Debian `apt-get install pocl-opencl-icd` runs on every CPU, a GPU needs its vendor's "
    "(`clinfo -l` shows what is found)";

// Whether `text` contains `part`, ignoring case.
bool says(const std::string& text, const std::string& part);

}  // namespace clarity
