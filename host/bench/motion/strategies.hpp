// strategies.hpp -- runs a case of the suite `policy`: an animation, with refits and builds by one rule after another.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// Plays 200 frames of the case's animation with each strategy: always refit, a build every 50, 20, 10, 5 or 2 frames, always
// build, and the policy of the window. Each frame is done by all of them in turn, so that a disturbance of the machine affects
// all alike. Returns one row for each. Throws Cancelled.
std::vector<BenchRecord> measure_strategies(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                            const BenchCase& c, Progress& progress);

}  // namespace clarity::bench
