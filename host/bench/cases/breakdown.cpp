#include "bench/cases/breakdown.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "bench/output/row.hpp"

namespace clarity::bench {
namespace {

constexpr const char* kNames[kProbes] = {"film",
                                         "rays",
                                         "closest",
                                         "closest, leaf tests twice",
                                         "one generation",
                                         "no shadows",
                                         "whole",
                                         "nearest leaf tests twice",
                                         "any-hit leaf tests twice"};
constexpr FramePart kPrograms[kProbes] = {FramePart::film,
                                          FramePart::rays,
                                          FramePart::closest,
                                          FramePart::closest_double_leaf,
                                          FramePart::whole,
                                          FramePart::whole,
                                          FramePart::whole,
                                          FramePart::whole_closest_double_leaf,
                                          FramePart::whole_any_double_leaf};

double median_of(const std::vector<KernelTime>& kernels, const char* name) {
    std::vector<double> ms;
    for (const KernelTime& kernel : kernels)
        if (kernel.name == name) ms.push_back(kernel.ms);
    return median(ms);
}

}  // namespace

Breakdown break_down(const double (&ms)[kProbes]) {
    const auto of = [&](Probe probe) { return ms[static_cast<size_t>(probe)]; };
    const double leaves = of(Probe::closest_double_leaf) - of(Probe::closest),
                 all_leaves = of(Probe::whole_closest_double_leaf) - of(Probe::whole);
    Breakdown b;
    b.parts = {{"camera rays", of(Probe::rays) - of(Probe::film)},
               {"traversal", of(Probe::closest) - of(Probe::rays) - leaves},
               {"leaf tests", leaves},
               {"shading", of(Probe::one_generation) - of(Probe::closest)},
               {"shadow rays", of(Probe::whole) - of(Probe::no_shadows)},
               {"reflections", of(Probe::no_shadows) - of(Probe::one_generation)},
               {"film", of(Probe::film)}};
    b.within = {{"leaf tests of shadow rays", of(Probe::whole_any_double_leaf) - of(Probe::whole)},
                {"leaf tests of reflections", all_leaves - leaves}};
    return b;
}

void measure_breakdown(BenchRecord& row, Fixture& fixture, size_t device, const Settings& settings, const View& view,
                       const MeasureRules& rules, Progress& progress) {
    const Fixture::Held held = fixture.prepare(device, settings, progress);
    describe(row, *held.prepared);
    FrameParts programs(fixture.opened(device));
    // Each probe has a film of its own, like the rows of other cases, so that it does not disturb another probe's pace.
    std::vector<Contender> contenders;
    std::vector<KernelTime> shown;
    for (size_t i = 0; i < kProbes; ++i) {
        const Probe probe = static_cast<Probe>(i);
        Settings reduced = held.prepared->settings;
        reduced.width = settings.width;
        reduced.height = settings.height;
        reduced.depth = settings.depth;
        reduced.shadows = settings.shadows;
        if (probe <= Probe::one_generation) reduced.depth = 1;
        if (probe <= Probe::no_shadows) reduced.shadows = false;
        const auto prepared = programs.prepare(*held.prepared, kPrograms[i]);
        const auto frames = std::make_shared<FrameRenderer>(fixture.opened(device));
        frames->trace(*prepared, reduced, view, 0, false, progress);  // warm-up: compilation must not count as measuring time
        contenders.push_back({kNames[i], [=, &view, &progress, &shown] {
                                  const auto begin = std::chrono::steady_clock::now();
                                  FrameStats stats = frames->trace(*prepared, reduced, view, 0, false, progress);
                                  Sample sample{stats.device_ms, 0};
                                  if (probe != Probe::whole) return sample;
                                  frames->read_display(reduced, &stats);
                                  sample.wall_ms = ms_since(begin);
                                  shown.insert(shown.end(), stats.kernels.begin(), stats.kernels.end());
                                  return sample;
                              }});
    }
    const std::vector<Measured> measured = measure_interleaved(contenders, rules, progress);
    double ms[kProbes], error = 0;
    for (size_t i = 0; i < kProbes; ++i) {
        if (measured[i].status != RowStatus::ok) {
            row.status = measured[i].status;
            row.why = std::string(kNames[i]) + ": " + measured[i].why;
            return;
        }
        ms[i] = measured[i].time_ms.median;
        error = std::max(error, 0.5 * (measured[i].time_ms.q3 - measured[i].time_ms.q1));
    }
    const Measured& whole = measured[static_cast<size_t>(Probe::whole)];
    row.time_ms = whole.time_ms;
    row.wall_ms = whole.wall_ms;
    const Breakdown b = break_down(ms);
    row.parts_ms = b.parts;
    row.within_ms = b.within;
    row.parts_error_ms = error;
    for (const char* name : {"tone map", "read-back"}) row.parts_ms.emplace_back(name, median_of(shown, name));
}

}  // namespace clarity::bench
