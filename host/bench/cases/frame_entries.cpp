#include "bench/cases/frame_entries.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "bench/baselines/speedup.hpp"
#include "bench/cases/moving.hpp"

namespace clarity::bench {
namespace {

// Times of a frame's parts in ms by name, one entry per repetition; the record gets the medians.
using PartTimes = std::map<std::string, std::vector<double>>;

void set_medians(BenchRecord& row, const PartTimes& parts) {
    for (const auto& [name, ms] : parts) row.kernels_ms.emplace_back(name, median(ms));
}

// Renders one frame, from the call to tone-mapped pixels in host memory. Returns its wall time in ms. Appends the kernels'
// times to `parts`; its "waiting" is the wall time in which the device ran none of them.
double show_frame(CaseState& state, const Settings& settings, const Fixture::Held& held, const View& view, FrameStats& stats,
                  PartTimes& parts) {
    const auto begin = std::chrono::steady_clock::now();
    stats = held.frames->trace(*held.prepared, settings, view, 0, false, state.progress);
    held.frames->read_display(settings, &stats);
    const double ms = ms_since(begin);
    double busy = 0;
    for (const KernelTime& kernel : stats.kernels) {
        parts[kernel.name].push_back(kernel.ms);
        busy += kernel.ms;
    }
    parts["waiting"].push_back(std::max(ms - busy, 0.0));
    return ms;
}

}  // namespace

void add_frame(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held) {
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        FrameStats stats;
        const double ms = show_frame(state, settings, held, state.fixture.view(), stats, *parts);
        return Sample{stats.device_ms, ms};
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        count_rays(state, row, settings, held, state.fixture.view());
    };
}

void add_whitted(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held) {
    const View view = whitted_view(*state.fixture.scene(), state.fixture.view());
    state.whitted = whitted_scene(view, settings);
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        FrameStats stats;
        show_frame(state, settings, held, view, stats, *parts);
        return Sample{stats.device_ms, stats.wall_ms};
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        count_rays(state, row, settings, held, view);
        state.agreement.check_picture(row, held.frames->read_values());
    };
}

void add_moving(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, bool overlapped) {
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        std::vector<KernelTime> times;
        const Sample sample =
            show_moving(*held.frames, *held.prepared, settings, state.fixture.view(), overlapped, state.progress, &times);
        for (const KernelTime& time : times) (*parts)[time.name].push_back(time.ms);
        return sample;
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        uint64_t digest = 0;
        show_moving(*held.frames, *held.prepared, settings, state.fixture.view(), overlapped, state.progress, nullptr, &digest);
        state.agreement.check_sequence(row, digest, overlapped);
    };
}

void count_rays(CaseState& state, BenchRecord& row, const Settings& settings, const Fixture::Held& held, const View& view) {
    set_ray_counts(row, held.frames->trace(*held.prepared, settings, view, 0, true, state.progress));
}

void compare_with_one_by_one(std::vector<BenchRecord>& rows) {
    for (size_t i = 0; i < rows.size(); ++i)
        for (size_t k = 0; k < i; ++k) {
            if (rows[i].status != RowStatus::ok || rows[k].fps <= 0 ||
                structure_and_device(rows[k]) != structure_and_device(rows[i]))
                continue;
            rows[i].speedup = speedup(rows[i], rows[k]);
        }
}

}  // namespace clarity::bench
