// ranks.hpp -- measures one picture by one process, by two, and so on, which mpirun starts and which share it.
#pragma once
#include <nlohmann/json.hpp>

#include "bench/run/bench.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// The words of `clarity render` for a scene and a variant, without device and output.
std::vector<std::string> render_words(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                      const Variant& variant, const import::ImportOptions& import);
// Takes settings, structure and rays from what `clarity render --stats` wrote.
void describe(BenchRecord& row, const nlohmann::json& stats);

// Returns a row for each variant and number of request.ranks. N ranks get the first N of options.devices; where those are
// fewer, several ranks use the same. A row is refused if the picture's file has other bytes than that of the first row and all
// devices are of one kind. Throws Cancelled.
std::vector<BenchRecord> measure_ranks(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, const MeasureRules& rules,
                                       Progress& progress);

}  // namespace clarity::bench
