// pack_checks.hpp -- whether a layout packs the trees of other builders soundly.
#pragma once
#include <string>

#include "tools/check/builds/build_run.hpp"

namespace clarity::check {

// A tree over a scene that halves the primitives in their order, with leaves of at most `leaf` refs. Boxes fit exactly.
struct Halves {
    Halves(const BuildScene& scene, rt_u32 leaf);
    rt_topology topology() const;

    std::vector<rt_topology_node> nodes;
    std::vector<rt_u32> refs, roots;
};

// Packs such trees. Returns what is wrong with the result.
Problem pack_fault(const rt_plugin& layout, const BuildCase& input, rt_u32 leaf);

}  // namespace clarity::check
