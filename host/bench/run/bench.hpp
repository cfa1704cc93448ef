// bench.hpp -- measures what a suite lists.
#pragma once
#include <functional>

#include "bench/output/record.hpp"
#include "bench/run/measure.hpp"
#include "bench/suites/suite.hpp"
#include "device/device.hpp"

namespace clarity::bench {

struct BenchOptions {
    std::vector<DeviceInfo> devices;
    MeasureRules rules;  // budget_s is set case by case, from the suite's time limit
    import::ImportOptions import;
    // Called after each row with the report so far; the row is its last record. What it throws ends the run.
    std::function<void(const BenchReport&)> on_row;
};

// Measures case by case. What goes wrong with one row is that row's status, and the others go on. If `progress` is cancelled or
// the run cannot go on, the report holds the rows that are complete, and `interrupted` or `failure` says so. Throws
// Error(usage) for settings that make no sense, and the error of a scene that a person named if no row has figures.
BenchReport run_bench(const PluginRegistry& plugins, const BenchRequest& request, const Suite& suite,
                      const BenchOptions& options, Progress& progress);

// Settings of a variant: the request's, then its own, then its structure. Throws Error(usage).
Settings variant_settings(const PluginRegistry& plugins, const BenchRequest& request, const Variant& variant);

// Whether all went well: the run came to its end, and no row is refused or failed.
bool all_ok(const BenchReport& report);

}  // namespace clarity::bench
