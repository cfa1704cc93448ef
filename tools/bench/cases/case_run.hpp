// case_run.hpp -- runs one case of a suite.
#pragma once
#include "tools/bench/run/fixture.hpp"
#include "tools/bench/run/measure.hpp"

namespace clarity::bench {

struct CaseRun {
    Fixture& fixture;
    const PluginRegistry& plugins;
    const BenchRequest& request;
    const BenchCase& definition;
    const MeasureRules& rules;
    Progress& progress;
};

// All of these return rows, throw Cancelled, and a row which cannot be measured says why.

// One row for each of our variants on each device and for each mode of each baseline, measured interleaved; or what one of the
// functions below returns, if the case is of their kind.
std::vector<BenchRecord> run_case(const CaseRun& run);

// One picture with all its samples: a row for each variant and number of devices, 1, 2, 4, ... and all. Wall times are from the
// call to tone-mapped pixels in host memory. A row is refused if its picture differs from that of one device: devices of one
// kind must agree exactly.
std::vector<BenchRecord> measure_pictures(const CaseRun& run);

// Moves all vertices of a model, and measures what the case names: "refit", "rebuild", or a kind of rays, which are traced
// after either. One row for each variant; of refits and rebuilds also one for each quality of the baseline.
std::vector<BenchRecord> measure_motion(const CaseRun& run);

// Plays 200 frames of the case's animation with each strategy: always refit, a build every 50, 20, 10, 5 or 2 frames, always
// build, and the policy of the window; a row for each. Each frame is done by all of them in turn, so that a disturbance of the
// machine affects all alike.
std::vector<BenchRecord> measure_strategies(const CaseRun& run);

}  // namespace clarity::bench
