// breakdown.hpp -- how the time of a frame divides among its parts. Reduced programs, and programs which do one part twice, are
// measured interleaved; differences of their times are the parts. docs/bench.md defines the parts, and says how accurate they
// are.
#pragma once
#include <memory>

#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"
#include "render/frame/frame_parts.hpp"

namespace clarity::bench {

// Frames which are measured. one_generation and no_shadows are the whole program with other settings, the rest are programs of
// their own.
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

// Parts of a frame in ms.
struct Breakdown {
    Parts parts, within;  // parts: add up to the whole frame; within: leaf tests contained in two of the parts
};
// Computes the parts from the time of each probe, in ms by the device's clock.
Breakdown break_down(const double (&ms)[kProbes]);

// Fills in the record: parts, leaf tests within them, times of the whole frame. Throws what Preparer and FrameRenderer throw.
void measure_breakdown(BenchRecord& row, Fixture& fixture, size_t device, const Settings& settings, const View& view,
                       const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
