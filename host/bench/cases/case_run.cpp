#include "bench/cases/case_run.hpp"

#include "base/parallel_for.hpp"
#include "bench/baselines/speedup.hpp"
#include "bench/cases/baseline_entries.hpp"
#include "bench/cases/light.hpp"
#include "bench/cases/own_entries.hpp"
#include "bench/run/bench.hpp"
#include "render/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

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
            describe(row, *held.prepared);
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
