#include "tools/bench/run/bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/parallel_for.hpp"
#include "tools/bench/cases/case_run.hpp"
#include "tools/bench/cases/entry.hpp"
#include "tools/bench/cases/ranks.hpp"
#include "tools/bench/output/machine.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/failure.hpp"
#include "tools/bench/run/fixture.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

std::string row_text(const BenchRecord& row) {
    char text[160] = "";
    if (row.status != RowStatus::ok) return "  " + row.name() + ": " + row.why;
    if (row.measure == "dropped")
        std::snprintf(text, sizeof text, "%llu of %llu rays dropped", static_cast<unsigned long long>(row.rays_dropped),
                      static_cast<unsigned long long>(row.rays_dropped + row.rays_secondary));
    else if (row.measure == "start")
        std::snprintf(text, sizeof text, "%.2f s, %.2f s of them compiling", row.wall_ms.median / 1000,
                      row.time_ms.median / 1000);
    else if (!row.light.points.empty())
        std::snprintf(text, sizeof text, "%.3f Msamples/s, RMSE %.4g at %u samples", row.light.msamples_per_s,
                      row.light.points.back().rmse, row.light.points.back().samples);
    else if (row.time_ms.n == 0)
        std::snprintf(text, sizeof text, "counted");
    else if (is_build(row))
        std::snprintf(text, sizeof text, "%.2f ms, %.2f Mtris/s", row.time_ms.median, row.mtris_per_s);
    else if (row.measure == "moving")
        std::snprintf(text, sizeof text, "%.3f ms, %.1f fps", row.wall_ms.median, row.fps);
    else if (row.rays() == 0)
        std::snprintf(text, sizeof text, "%.3f ms, %.1f fps", row.time_ms.median, row.fps);
    else if (row.measure == "frame" || row.measure == "picture" || row.measure == "ranks")
        std::snprintf(text, sizeof text, "%.3f ms, %.1f fps, %.1f Mrays/s", row.time_ms.median, row.fps, row.mrays_per_s);
    else
        std::snprintf(text, sizeof text, "%.3f ms, %.1f Mrays/s", row.time_ms.median, row.mrays_per_s);
    char spread[48] = "";
    if (row.time_ms.n > 0)
        std::snprintf(spread, sizeof spread, "  (n %u, spread %.1f %%)", row.time_ms.n, 100 * row.time_ms.spread());
    return "  " + row.name() + ": " + text + spread;
}

// Whether other processes read the scene of a case.
bool reads_itself(const BenchCase& c) {
    return c.measure == "ranks" || c.measure == "start";
}

// Measures the cases in their order. Each case gets an equal share of the time which is left.
class Session {
 public:
    Session(const PluginRegistry& plugins, const BenchRequest& request, const Suite& suite, const BenchOptions& options,
            Progress& progress)
        : plugins_(plugins),
          request_(request),
          suite_(suite),
          options_(options),
          progress_(progress),
          fixture_(plugins, options.devices, options.import) {}

    void run(BenchReport& report) {
        size_t loaded = suite_.scenes.size();
        for (size_t i = 0; i < suite_.cases.size(); ++i) {
            const BenchCase& c = suite_.cases[i];
            const double left = suite_.time_limit_s - seconds_since(begin_);
            if (left <= 0) {
                note_unfinished(report, i);
                return;
            }
            char stage[32];
            std::snprintf(stage, sizeof stage, "%zu/%zu ", i + 1, suite_.cases.size());
            progress_.stage(stage + c.suite + " " + c.name);
            if (c.scene != loaded && !reads_itself(c)) {
                if (!load(c, report)) {
                    while (i + 1 < suite_.cases.size() && suite_.cases[i + 1].scene == c.scene) ++i;
                    continue;
                }
                loaded = c.scene;
            }
            MeasureRules rules = options_.rules;
            rules.budget_s = left / double(suite_.cases.size() - i);
            std::vector<BenchRecord> rows = measure(c, rules);
            log(LogLevel::info, stage + c.suite + " " + c.name);
            for (BenchRecord& row : rows) {
                log(LogLevel::info, row_text(row));
                add(report, std::move(row));
            }
        }
    }

    // Throws the error of the first unreadable scene named by the user, if no row has figures.
    void throw_if_nothing(const BenchReport& report) const {
        const auto failed = [](const BenchRecord& row) { return row.status == RowStatus::failed; };
        if (first_error_ && std::all_of(report.records.begin(), report.records.end(), failed)) throw *first_error_;
    }

 private:
    void add(BenchReport& report, BenchRecord row) const {
        report.records.push_back(std::move(row));
        if (options_.on_row) options_.on_row(report);
    }

    // Measures one case. If its rows cannot even be made (not enough memory, for example), returns one failed row with the
    // reason.
    std::vector<BenchRecord> measure(const BenchCase& c, const MeasureRules& rules) {
        try {
            if (c.measure == "start")
                return measure_start(suite_.scenes[c.scene].source, plugins_, request_, c, options_, progress_);
            if (c.measure == "ranks")
                return measure_ranks(suite_.scenes[c.scene].source, plugins_, request_, c, options_, rules, progress_);
            return run_case({fixture_, plugins_, request_, c, rules, progress_});
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& e) {
            return {failed_row(c, failure_text(e))};
        }
    }

    BenchRecord failed_row(const BenchCase& c, const std::string& why) const {
        BenchRecord row = make_row(c);
        row.scene = suite_.scenes[c.scene].source.name;
        row.status = RowStatus::failed;
        row.why = why;
        return row;
    }

    // Loads the scene of a case. Returns false if that fails: a scene named by the user then gets a failed row, a scene of a
    // suite gets a note.
    bool load(const BenchCase& c, BenchReport& report) {
        const SuiteScene& source = suite_.scenes[c.scene];
        const Settings settings = variant_settings(plugins_, request_, {});
        try {
            fixture_.load(source, settings.width, settings.height, progress_);
            return true;
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& e) {
            const std::string why = failure_text(e);
            if (request_.files.empty()) {
                report.notes.push_back(source.source.name + " is left out: " + why);
                log(LogLevel::warning, report.notes.back());
                return false;
            }
            add(report, failed_row(c, why));
            log(LogLevel::error, why);
            const auto* error = dynamic_cast<const Error*>(&e);
            if (!first_error_) first_error_ = error ? *error : Error(Exit::failed, why);
            return false;
        }
    }

    void note_unfinished(BenchReport& report, size_t first) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "the time limit of %.0f s was used up: %zu of %zu cases are left out, from %s on; raise --time-limit",
                      suite_.time_limit_s, suite_.cases.size() - first, suite_.cases.size(), suite_.cases[first].name.c_str());
        report.notes.push_back(text);
        log(LogLevel::warning, text);
    }

    const PluginRegistry& plugins_;
    const BenchRequest& request_;
    const Suite& suite_;
    const BenchOptions& options_;
    Progress& progress_;
    Fixture fixture_;
    const Clock::time_point begin_ = Clock::now();
    std::optional<Error> first_error_;  // of a scene named by the user
};

}  // namespace

Settings variant_settings(const PluginRegistry& plugins, const BenchRequest& request, const Variant& variant) {
    Settings settings;
    for (const auto& [key, value] : request.settings) set_setting(settings, key, value);
    for (const auto& [key, value] : variant.settings) set_setting(settings, key, value);
    if (!variant.accel.empty()) choose_accel(plugins, variant.accel, settings);
    return settings;
}

BenchReport run_bench(const PluginRegistry& plugins, const BenchRequest& request, const Suite& suite,
                      const BenchOptions& options, Progress& progress) {
    for (const BenchCase& c : suite.cases)
        for (const Variant& variant : c.variants) variant_settings(plugins, request, variant);  // throws for bad settings now
    BenchReport report;
    report.notes = suite.notes;
    const bool wants_baselines =
        std::any_of(suite.cases.begin(), suite.cases.end(), [](const BenchCase& c) { return !c.baseline_qualities.empty(); });
    std::string no_baselines;
    if (wants_baselines && baseline_kinds(&no_baselines).empty()) report.notes.push_back(no_baselines);
    const auto is_cpu = [](const DeviceInfo& device) { return device.cpu; };
    if (wants_baselines && no_baselines.empty() && std::none_of(options.devices.begin(), options.devices.end(), is_cpu))
        report.notes.push_back(
            "peers are left out: they trace on the host's processor, and no device of this run is a CPU; --device all takes "
            "every device");
    for (const std::string& note : report.notes) log(LogLevel::warning, note);
    BenchRun& run = report.run;
    run.version = CLARITY_VERSION;
    run.date = utc_date();
    run.host_cpu = host_cpu_name();
    run.host_threads = loop_threads();
    run.governor = clock_governor();
    run.clock_mhz_before = host_clock_mhz();
    run.load_before = load_average();
    run.max_spread = options.rules.max_spread;
    const auto begin = Clock::now();
    Session session(plugins, request, suite, options, progress);
    try {
        session.run(report);
    } catch (const Cancelled&) {
        report.interrupted = true;
    } catch (const std::exception& e) {
        report.failure = failure_text(e);
    }
    session.throw_if_nothing(report);
    run.seconds = seconds_since(begin);
    run.clock_mhz_after = host_clock_mhz();
    run.load_after = load_average();
    return report;
}

bool all_ok(const BenchReport& report) {
    return report.failure.empty() && std::none_of(report.records.begin(), report.records.end(), [](const BenchRecord& row) {
               return row.status == RowStatus::refused || row.status == RowStatus::failed;
           });
}

}  // namespace clarity::bench
