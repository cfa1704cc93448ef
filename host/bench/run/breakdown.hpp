// breakdown.hpp -- where the time of a frame goes: programs that do less of it, or some of it twice, measured in turns.
// docs/bench.md says what is measured, what follows from it and how far to believe it.
#pragma once
#include <memory>

#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"
#include "render/kernels/frame_parts.hpp"

namespace clarity::bench {

// Frames that are measured. Those with `shadows` or `depth` are settings, the others programs.
enum class Probe {
    film,
    rays,
    closest,
    closest_double_leaf,
    one_generation,
    no_shadows,
    whole,
    whole_closest_double_leaf,
    whole_any_double_leaf
};
constexpr size_t kProbes = 9;

// ms of each probe, by the device's clock -> ms of the parts, which add up to the whole frame, and of leaf tests within two of
// them.
struct Breakdown {
    Parts parts, within;
};
Breakdown break_down(const double (&ms)[kProbes]);

// Fills in the record: parts, what is in them, the whole frame's time. Throws what Preparer and Frames throw.
void measure_breakdown(BenchRecord& row, Fixture& fixture, size_t device, const Settings& settings, const View& view,
                       const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
