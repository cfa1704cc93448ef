// measured.hpp -- what a request of the bench gives on the first device, in three rounds however much they spread.
#pragma once
#include "support/workbench.hpp"
#include "tools/bench/run/bench.hpp"

namespace clarity::test {

inline bench::BenchReport measured(const bench::BenchRequest& request) {
    bench::BenchOptions options;
    options.devices = {Workbench::get().device().info()};
    options.rules.max_spread = 100;
    options.rules.min_rounds = options.rules.max_rounds = 3;
    const PluginRegistry& plugins = Workbench::get().plugins();
    Progress progress;
    return run_bench(plugins, request, make_suite(request, bench::SceneCatalog("", ""), plugins), options, progress);
}

}  // namespace clarity::test
