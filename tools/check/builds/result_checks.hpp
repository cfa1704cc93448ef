// result_checks.hpp -- whether what a builder wrote is sound. Each function returns what is wrong.
#pragma once
#include <string>
#include <vector>

#include "tools/check/builds/build_run.hpp"

namespace clarity::check {

// A leaf that was not in the input: it cannot be packed.
Problem unknown_ref(const BuildScene& scene, const BuilderResult& result);
// Every primitive of the input is among the leaves, and nothing else is.
Problem missing_refs(const BuildScene& scene, const BuilderResult& result);

// The volumes that `levels` shows are numbers, and hold the triangles below them. Returns nothing where the plugin shows none.
Problem loose_bounds(const rt_plugin& plugin, const BuildScene& scene, BuilderResult& result);

// For each group: the surface of all volumes that `levels` shows, in units of that of the first level. 0: there is none.
std::vector<double> relative_surfaces(const rt_plugin& plugin, const BuilderResult& result);

// What a refit to one pose reported of each group, negative where nothing, and relative_surfaces().
struct PosedCosts {
    const char* pose;
    std::vector<double> costs, surfaces;
};
// The costs that refits report rise with the surfaces of the tree's volumes: the host decides by them when to build again.
Problem cost_fault(const BuildScene& scene, const std::vector<PosedCosts>& poses);

// Slots are not far larger than what the builder filled, nor than the input.
Problem wasted_memory(const rt_accel& accel, const BuildCase& input, const BuilderResult& result);

}  // namespace clarity::check
