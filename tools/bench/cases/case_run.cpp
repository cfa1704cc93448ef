#include "tools/bench/cases/case_run.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "tools/bench/cases/case_state.hpp"
#include "tools/bench/cases/light.hpp"
#include "tools/bench/cases/own_entries.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/bench/run/failure.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

// Entries of the baselines: other ray tracers on the same scene.
Entry& add_baseline_entry(CaseState& state, const BaselineKind& kind, const std::string& mode = {}) {
    Entry& entry = state.add_entry();
    entry.row.baseline = entry.row.variant = kind.name + (mode.empty() ? "" : " " + mode) + " " + kind.quality;
    entry.row.baseline_quality = kind.quality;
    describe_host(entry.row, state.fixture.baseline_threads());
    entry.row.driver = baseline_version();
    return entry;
}

void add_baseline_build(CaseState& state, const BaselineKind& kind) {
    Entry& entry = add_baseline_entry(state, kind);
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
        BenchRecord& row = add_baseline_entry(state, kind).row;
        row.status = RowStatus::failed;
        row.why = failure_text(e);
    }
}

void describe_baseline(BenchRecord& row, const BaselineScene& scene) {
    row.build_ms = scene.build_ms();
    row.accel_bytes = scene.bytes();
}

void add_baseline_frame(CaseState& state, const BaselineKind& kind, BaselineScene& scene, const std::string& mode) {
    Entry& entry = add_baseline_entry(state, kind, mode);
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
    Entry& entry = add_baseline_entry(state, kind, mode);
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

// Appends an entry for each kind of baseline that the case wants, and for each of its modes. Call it after our entries are
// added: baselines trace the rays and render the frame which these have prepared. If a baseline cannot be measured, its row
// says why. The entries use `state`, which must outlive them. Throws Cancelled.
void add_baselines(CaseState& state) {
    const std::vector<std::string>& wanted = state.definition.baseline_qualities;
    if (wanted.empty() || !state.fixture.has_baselines()) return;
    for (const BaselineKind& kind : baseline_kinds(nullptr))
        if (std::find(wanted.begin(), wanted.end(), kind.quality) != wanted.end()) add_baseline(state, kind);
}

// Beyond so many primitives `linear` is skipped, because one picture would take minutes.
constexpr uint64_t kTryEverything = 4000;

class CaseRunner : CaseRun {
 public:
    explicit CaseRunner(const CaseRun& run) : CaseRun(run), state_(fixture, definition, progress) {}

    std::vector<BenchRecord> run() {
        for (const Variant& variant : definition.variants)
            for (size_t device = 0; device < fixture.device_count(); ++device) {
                if (variant.cpu_only && !fixture.device(device).cpu) continue;
                if (definition.measure == "moving" && fixture.device(device).cpu) continue;  // a CPU copies nothing
                if (definition.measure == "build" && device > 0) break;                      // builders run on the host
                add_ours(variant, device);
            }
        add_baselines(state_);
        std::vector<BenchRecord> rows = measured_rows(state_.entries, definition.timing == Timing::timed, rules, progress);
        compare_with_baselines(rows);
        if (definition.measure == "moving") compare_with_one_by_one(rows);
        return rows;
    }

 private:
    void add_ours(const Variant& variant, size_t device) {
        Entry& entry = state_.add_entry();
        Settings settings = variant_settings(plugins, request, variant);
        if (variant.accel.empty()) choose_accel(plugins, default_accel(plugins, fixture.device(device).id()), settings);
        const rt_plugin& plugin = *plugins.accel(settings.accel);
        BenchRecord& row = entry.row;
        row.variant = variant.label;
        row.accel = settings.accel;
        row.accel_params = parameters_text(plugin, settings.accel_params);
        if (definition.measure == "build") {
            describe_host(row, loop_threads());
            add_build(entry, [=, &plugin] {
                return build_accel(*fixture.scene(), plugin, settings.accel_params, progress, fixture.target_of(plugin));
            });
            return;
        }
        describe(row, fixture.device(device));
        describe(row, settings);
        if (plugin.accel->ray_cost == RT_RAY_COST_LINEAR && row.primitives > kTryEverything) {
            row.status = RowStatus::skipped;
            row.why = "it tests every primitive, and a picture of " + std::to_string(row.primitives) +
                      " primitives would take minutes";
            return;
        }
        run_or_mark_failed(entry, [&](BenchRecord&) {
            const Fixture::Held held = fixture.prepare(device, settings, progress);
            describe(row, *held.prepared->first());
            if (definition.measure == "frame")
                add_frame(state_, entry, settings, held);
            else if (definition.measure == "whitted")
                add_whitted(state_, entry, settings, held);
            else if (definition.measure == "moving")
                add_moving(state_, entry, settings, held, variant.overlapped);
            else if (definition.measure == "light")
                add_light(state_, entry, settings, held, request.reference);
            else if (definition.measure == "dropped")
                entry.finish = [=](BenchRecord& r) { count_rays(state_, r, settings, held, fixture.view()); };
            else
                add_rays(state_, entry, held);
        });
    }

    CaseState state_;
};

}  // namespace

std::vector<BenchRecord> run_case(const CaseRun& run) {
    const BenchCase& c = run.definition;
    if (c.measure == "play") return measure_strategies(run);
    if (!c.motion.empty()) return measure_motion(run);
    if (c.measure == "picture") return measure_pictures(run);
    return CaseRunner(run).run();
}

}  // namespace clarity::bench
