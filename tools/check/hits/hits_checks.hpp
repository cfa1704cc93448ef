// hits_checks.hpp -- whether a structure's kernels hit what they should, on a device.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "rt_plugin.h"
#include "tools/check/steps.hpp"

namespace clarity::check {

struct HitsOptions {
    bool quick = false;
    std::vector<int> lanes = {1, 4, 8, 16};
    bool large = false;            // also scenes of more than 2^20 primitives
    bool lanes_are_named = false;  // by the user; otherwise those that the device cannot have are left out
    size_t rays = 0;               // of a set; 0: as `quick` says
    std::string report_folder;     // where wrong rays are written; "": nowhere
    uint64_t seed = 0;             // of random numbers: see seed.hpp
};

// Leaves out numbers of lanes that the device cannot have, if the user has not named them.
void fit_lanes(HitsOptions& options, const DeviceInfo& info);

// The checks of one structure's kernels. layout: what traces the tree if the plugin builds a topology, otherwise nullptr. open:
// opens the device on first use.
std::vector<Check> hits_checks(const rt_plugin& plugin, const rt_plugin* layout,
                               const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options);

// One check for a device that looks at each access of kernels (oclgrind): it traces few rays of each kind, and judges nothing.
std::vector<Check> access_checks(const rt_plugin& plugin, const rt_plugin* layout,
                                 const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options);

}  // namespace clarity::check
