#include "bench/cases/baseline_entries.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/processor_time.hpp"
#include "bench/cases/own_entries.hpp"
#include "bench/run/failure.hpp"

namespace clarity::bench {
namespace {

Entry& add_baseline_entry(CaseState& state, const std::string& name) {
    Entry& entry = state.add_entry();
    entry.row.baseline = entry.row.variant = name;
    describe_host(entry.row, state.fixture.baseline_threads());
    return entry;
}

void add_baseline_build(CaseState& state, const BaselineKind& kind) {
    Entry& entry = add_baseline_entry(state, kind.name + " " + kind.quality);
    const auto bytes = std::make_shared<uint64_t>(0);
    const BaselineMesh& mesh = state.fixture.baseline_mesh();
    const unsigned threads = state.fixture.baseline_threads();
    entry.once = [=, &mesh] {
        const auto begin = std::chrono::steady_clock::now();
        const double used_ms = processor_ms();
        const auto scene = kind.build(mesh, kind.quality, threads);
        *bytes = scene->bytes();
        return Sample{scene->build_ms(), ms_since(begin), processor_ms() - used_ms};
    };
    entry.finish = [=](BenchRecord& row) {
        row.build_ms = row.time_ms.median;
        row.accel_bytes = *bytes;
        row.bytes_per_triangle = double(*bytes) / double(row.triangles);
    };
}

// Calls `use` with the structure of a baseline. If there is none, adds a failed row with the reason.
template <class Use>
void with_baseline(CaseState& state, const BaselineKind& kind, const Use& use) {
    try {
        if (state.definition.measure == "whitted" ? !state.whitted : !state.rays)
            throw Error(Exit::failed, "no structure of ours could trace the rays");
        use(state.fixture.baseline(kind));
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        BenchRecord& row = add_baseline_entry(state, kind.name + " " + kind.quality).row;
        row.status = RowStatus::failed;
        row.why = failure_text(e);
    }
}

void describe_baseline(BenchRecord& row, const BaselineScene& scene) {
    row.build_ms = scene.build_ms();
    row.accel_bytes = scene.bytes();
}

void add_baseline_frame(CaseState& state, const BaselineKind& kind, BaselineScene& scene, const std::string& mode) {
    Entry& entry = add_baseline_entry(state, kind.name + " " + mode + " " + kind.quality);
    const auto film = std::make_shared<BaselineArray<float>>();
    const auto counts = std::make_shared<BaselineRayCounts>();
    entry.row.depth = int(state.whitted->generations);
    entry.row.width = int(state.whitted->frame.width);
    entry.row.height = int(state.whitted->frame.height);
    entry.once = [=, &scene, whitted = *state.whitted] {
        Sample sample;
        sample.time_ms = sample.wall_ms = scene.frame_ms(mode, whitted, *film, *counts);
        return sample;
    };
    entry.finish = [=, &scene, &state](BenchRecord& row) {
        describe_baseline(row, scene);
        row.rays_primary = counts->primary;
        row.rays_shadow = counts->shadow;
        row.rays_secondary = counts->secondary;
        FloatImage picture{unsigned(row.width), unsigned(row.height), 3, {}};
        for (size_t i = 0; i < film->size(); ++i)
            if (i % 4 < 3) picture.pixels.push_back((*film)[i]);
        state.agreement.check_picture(row, std::move(picture));
    };
}

void add_baseline_rays(CaseState& state, const BaselineKind& kind, BaselineScene& scene, const std::string& mode) {
    Entry& entry = add_baseline_entry(state, kind.name + " " + mode + " " + kind.quality);
    const RaySet* const set = state.rays;
    const auto hits = std::make_shared<BaselineArray<BaselineHit>>(set->rays.size());
    entry.once = [=, &scene] {
        Sample sample;
        const double used_ms = processor_ms();
        sample.time_ms = scene.trace_ms(mode, *hits);
        sample.processor_ms = processor_ms() - used_ms;
        return sample;
    };
    entry.finish = [=, &scene, &state](BenchRecord& row) {
        describe_baseline(row, scene);
        std::vector<float> distances;
        for (const BaselineHit& hit : *hits) distances.push_back(hit.t);
        state.agreement.check_hits(row, *set, distances);
    };
    set_ray_counts(entry.row, *set);
}

void add_baseline(CaseState& state, const BaselineKind& kind) {
    if (state.definition.measure == "build") {
        add_baseline_build(state, kind);
        return;
    }
    with_baseline(state, kind, [&](BaselineScene& scene) {
        if (state.definition.measure == "whitted") {
            for (const std::string& mode : scene.frame_modes()) add_baseline_frame(state, kind, scene, mode);
        } else {
            scene.take_rays(*state.rays);
            for (const std::string& mode : scene.modes()) add_baseline_rays(state, kind, scene, mode);
        }
    });
}

}  // namespace

void add_baselines(CaseState& state) {
    const std::vector<std::string>& wanted = state.definition.baseline_qualities;
    if (wanted.empty() || state.fixture.baseline_threads() == 0 || baselines_cannot(*state.fixture.scene())) return;
    for (const BaselineKind& kind : baseline_kinds(nullptr))
        if (std::find(wanted.begin(), wanted.end(), kind.quality) != wanted.end()) add_baseline(state, kind);
}

}  // namespace clarity::bench
