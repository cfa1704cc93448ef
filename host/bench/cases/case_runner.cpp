#include "bench/cases/case_runner.hpp"

#include <thread>

#include "bench/baselines/speedup.hpp"
#include "bench/cases/baseline_entries.hpp"
#include "bench/cases/light.hpp"
#include "bench/cases/own_entries.hpp"
#include "bench/cases/pictures.hpp"
#include "bench/motion/motion.hpp"
#include "bench/motion/strategies.hpp"
#include "bench/run/bench.hpp"
#include "render/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

// Beyond so many primitives `linear` is skipped, because one picture would take minutes.
constexpr uint64_t kTryEverything = 4000;

class CaseRunner {
 public:
    CaseRunner(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request, const BenchCase& c,
               const MeasureRules& rules, Progress& progress)
        : fixture_(fixture),
          plugins_(plugins),
          request_(request),
          case_(c),
          rules_(rules),
          progress_(progress),
          state_(fixture, c, progress) {}

    std::vector<BenchRecord> run() {
        for (const Variant& variant : case_.variants)
            for (size_t device = 0; device < fixture_.device_count(); ++device) {
                if (variant.cpu_only && !fixture_.device(device).cpu) continue;
                if (case_.measure == "moving" && fixture_.device(device).cpu) continue;  // a CPU copies nothing
                if (case_.measure == "build" && device > 0) break;                       // builders run on the host
                add_ours(variant, device);
            }
        add_baselines(state_);
        std::vector<BenchRecord> rows = measured_rows(state_.entries, case_.timing == Timing::timed, rules_, progress_);
        compare_with_baselines(rows);
        if (case_.measure == "moving") compare_with_one_by_one(rows);
        return rows;
    }

 private:
    void add_ours(const Variant& variant, size_t device) {
        Entry& entry = state_.add_entry();
        Settings settings = variant_settings(plugins_, request_, variant);
        if (variant.accel.empty()) choose_accel(plugins_, default_accel(plugins_, fixture_.device(device).id()), settings);
        const rt_plugin& plugin = *plugins_.accel(settings.accel);
        BenchRecord& row = entry.row;
        row.variant = variant.label;
        row.accel = settings.accel;
        row.accel_params = parameters_text(plugin, settings.accel_params);
        if (case_.measure == "build") {
            describe_host(row, std::thread::hardware_concurrency());
            add_build(entry, [=, &plugin] {
                return build_accel(*fixture_.scene(), plugin, settings.accel_params, progress_, fixture_.target_of(plugin));
            });
            return;
        }
        describe(row, fixture_.device(device));
        describe(row, settings);
        if (plugin.accel->ray_cost == RT_RAY_COST_LINEAR && row.primitives > kTryEverything) {
            row.status = RowStatus::skipped;
            row.why = "it tests every primitive, and a picture of " + std::to_string(row.primitives) +
                      " primitives would take minutes";
            return;
        }
        run_or_mark_failed(entry, [&](BenchRecord&) {
            const Fixture::Held held = fixture_.prepare(device, settings, progress_);
            describe(row, *held.prepared);
            if (case_.measure == "frame")
                add_frame(state_, entry, settings, held);
            else if (case_.measure == "whitted")
                add_whitted(state_, entry, settings, held);
            else if (case_.measure == "moving")
                add_moving(state_, entry, settings, held, variant.overlapped);
            else if (case_.measure == "light")
                add_light(state_, entry, settings, held, request_.reference);
            else if (case_.measure == "dropped")
                entry.finish = [=](BenchRecord& r) { count_rays(state_, r, settings, held, fixture_.view()); };
            else
                add_rays(state_, entry, held);
        });
    }

    Fixture& fixture_;
    const PluginRegistry& plugins_;
    const BenchRequest& request_;
    const BenchCase& case_;
    const MeasureRules& rules_;
    Progress& progress_;
    CaseState state_;
};

}  // namespace

std::vector<BenchRecord> run_case(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                  const BenchCase& c, const MeasureRules& rules, Progress& progress) {
    if (c.measure == "play") return measure_strategies(fixture, plugins, request, c, progress);
    if (!c.motion.empty()) return measure_motion(fixture, plugins, request, c, rules, progress);
    if (c.measure == "picture") return measure_pictures(fixture, plugins, request, c, rules, progress);
    return CaseRunner(fixture, plugins, request, c, rules, progress).run();
}

}  // namespace clarity::bench
