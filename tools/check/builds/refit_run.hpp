// refit_run.hpp -- refits a finished build on guarded memory, with primitives from a moved scene, and watches what the plugin
// asks for.
#pragma once
#include <string>
#include <vector>

#include "tools/check/builds/build_run.hpp"

namespace clarity::check {

struct RefitRun {
    Problem why;  // how it failed or broke its contract; nothing: as far as the ABI goes it is sound
    bool cancelled = false;
    unsigned reports = 0;       // calls of host->progress
    BuilderResult result;       // with copies of the slots
    std::vector<double> costs;  // that it reported of each group; -1: none
};

// The groups of the positions in leaf order. A position that a group does not have: RT_NONE.
std::vector<rt_u32> group_of_positions(const BuildScene& scene, const BuilderResult& built);

// A copy of what a builder wrote.
BuilderResult copy_of(const BuilderResult& from, const rt_plugin& plugin);

// Refits a copy of `built`. moved: the same scene in another pose. changed: for each group. cancel_after: see BuildCase::run().
RefitRun run_refit(const rt_plugin& plugin, const ParameterValues& params, const BuilderResult& built, const BuildScene& moved,
                   const std::vector<uint8_t>& changed, Schedule schedule, unsigned cancel_after = 0);

// The packed primitive of a ref.
const rt_packed_prim& packed_of(const BuildScene& scene, rt_u32 ref);

}  // namespace clarity::check
