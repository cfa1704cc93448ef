// topology_build.hpp -- runs the builder of a topology, a plain binary tree that another plugin packs, and checks the tree.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/progress.hpp"
#include "render/accel/build_scene.hpp"
#include "rt_plugin.h"

namespace clarity {

// A checked topology, in memory of the host.
struct TopologyData {
    AlignedBytes nodes, refs;
    uint64_t node_count = 0, ref_count = 0;
    std::vector<rt_u32> roots;
    double build_ms = 0, check_ms = 0;
    rt_topology view() const;
};

// Runs the plugin's topology(). Appends the plugin's statistics to `stats`. Throws Error(failed) "accel median: why" if the
// plugin fails or the tree is unsound, and Cancelled.
TopologyData build_topology(const BuildScene& scene, const rt_plugin& plugin, const rt_build_input& input, Progress& progress,
                            std::vector<std::pair<std::string, double>>& stats);

}  // namespace clarity
