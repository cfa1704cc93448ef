// bench.hpp -- measures what a suite lists.
#pragma once
#include "bench/measure.hpp"
#include "bench/record.hpp"
#include "bench/suite.hpp"
#include "device/device.hpp"

namespace clarity {

struct BenchOptions {
    std::vector<DeviceInfo> devices;
    MeasureRules rules;  // budget_s is set case by case, from the suite's time limit
    ImportOptions import;
};

// Case by case. What goes wrong with one row is that row's status, and the others go on. Once `progress` is cancelled the
// report holds what is complete. Throws Error(usage) for settings that make no sense.
BenchReport run_bench(const PluginRegistry& plugins, const BenchRequest& request, const Suite& suite,
                      const BenchOptions& options, Progress& progress);

// Settings of a variant: the request's, then its own, then its structure. Throws Error(usage).
Settings variant_settings(const PluginRegistry& plugins, const BenchRequest& request, const Variant& variant);

// Whether all went well: no row refused or failed.
bool all_ok(const BenchReport& report);

}  // namespace clarity
