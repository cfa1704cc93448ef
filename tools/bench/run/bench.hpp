// bench.hpp -- measures the cases of a suite.
#pragma once
#include <functional>

#include "device/device.hpp"
#include "tools/bench/output/record.hpp"
#include "tools/bench/run/measure.hpp"
#include "tools/bench/suites/suite.hpp"
#include "view/settings/settings.hpp"

namespace clarity::bench {

struct BenchOptions {
    std::vector<DeviceInfo> devices;
    MeasureRules rules;  // budget_s is set for each case, from the suite's time limit
    import::ImportOptions import;
    // Called after each row with the report so far; the new row is its last record. An exception which it throws ends the run.
    std::function<void(const BenchReport&)> on_row;
};

// Measures case by case. A row which fails says so in its status, and the other rows are still measured. If `progress` is
// cancelled or the run cannot continue, the report holds the rows which are complete, and `interrupted` or `failure` is set.
// Throws Error(usage) for invalid settings, and the error of a scene named by the user if no row has figures.
BenchReport run_bench(const PluginRegistry& plugins, const BenchRequest& request, const Suite& suite,
                      const BenchOptions& options, Progress& progress);

// Settings of a variant: defaults, overridden by the request's, then by the variant's own, then by its structure. Throws
// Error(usage).
Settings variant_settings(const PluginRegistry& plugins, const BenchRequest& request, const Variant& variant);

// True if the run was not ended by a failure, and no row is refused or failed.
bool all_ok(const BenchReport& report);

}  // namespace clarity::bench
