// light_table.cpp -- pictures by paths of light: their errors by samples and by seconds.

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

std::string told(int number) {
    return number < 0 ? "not told" : std::to_string(number);
}

const std::vector<std::string> kHead = {"scene",      "",         "samples", "seconds", "RMSE",      "trimmed",  "relMSE",
                                        "Msamples/s", "spread %", "slope",   "B/path",  "registers", "spilled B"};

}  // namespace

std::string light_table(const BenchReport& report) {
    TextTable table(kHead, 2);
    for (const BenchRecord& r : report.records) {
        if (r.measure != "light" || r.status != RowStatus::ok) continue;
        for (const LightRun::Point& point : r.light.points) {
            const bool last = &point == &r.light.points.back();
            std::vector<std::string> cells = {r.scene,
                                              r.variant,
                                              std::to_string(point.samples),
                                              short_number(point.ms / 1000),
                                              short_number(point.rmse),
                                              short_number(point.trimmed_rmse),
                                              short_number(point.relmse)};
            if (last)
                for (const std::string& cell :
                     {short_number(r.light.msamples_per_s), percent(r.wall_ms.spread()), short_number(r.light.slope),
                      std::to_string(r.light.state_bytes), told(r.light.registers), told(r.light.spilled_bytes)})
                    cells.push_back(cell);
            cells.resize(kHead.size());
            table.add(cells);
        }
    }
    return table.empty() ? std::string()
                         : "light: errors against the reference; slope: of log RMSE over log samples, -0.5 of independent "
                           "samples;\nB/path: state of a path in a lane; not told: the driver says nothing of registers\n" +
                               table.text() + "\n";
}

}  // namespace clarity::bench
