// ranks_table.cpp -- pictures that ranks of MPI share, compared with those of the first number of ranks.
#include <algorithm>

#include "bench/baselines/speedup.hpp"
#include "bench/output/output.hpp"
#include "bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

double whole_ms(const BenchRecord& r) {
    double sum = 0;
    for (const auto& [name, ms] : r.parts_ms) sum += ms;
    return sum;
}

}  // namespace

std::string ranks_table(const BenchReport& report) {
    TextTable table({"scene", "", "device", "picture ms", "spread %", "x the first", "efficiency %", "whole s", "start",
                     "import", "share", "build", "wait", "trace", "collect"},
                    3);
    for (const BenchRecord& r : report.records) {
        if (r.measure != "ranks" || r.status != RowStatus::ok) continue;
        std::vector<std::string> cells = {r.scene,
                                          r.variant,
                                          r.device_id,
                                          short_number(r.wall_ms.median),
                                          percent(std::max(r.time_ms.spread(), r.wall_ms.spread())),
                                          ratio_text(r.speedup.ratio, r.speedup.spread, "same"),
                                          r.efficiency > 0 ? percent(r.efficiency) : "",
                                          short_number(whole_ms(r) / 1000)};
        for (const auto& [name, ms] : r.parts_ms) cells.push_back(short_number(ms));
        table.add(cells);
    }
    return table.empty()
               ? std::string()
               : "mpi: a picture that ranks share, from the moment that all can trace until the first rank has it, p50; "
                 "then the whole command, and where its time goes in the first rank, ms\nsame: about the same, the "
                 "difference is within the measured spread\n" +
                     table.text(26) + "\n";
}

}  // namespace clarity::bench
