// speedup_table.cpp -- our speed divided by the fastest baseline's: scenes down, measures across, and means at the end.
#include <algorithm>

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

constexpr const char* kMeasures[] = {"primary", "shadow", "reflection", "diffuse", "whitted", "build"};

constexpr const char* kSame = "same";

// One line of the table: a structure on a device in one scene.
struct Line {
    const BenchRecord* first;
    Speedup speedup[std::size(kMeasures)];
    double bytes = 0;
};

bool together(const BenchRecord& a, const BenchRecord& b) {
    // Builds run on the host, so that they belong to the lines of every device.
    const bool device = a.device_id == b.device_id || a.measure == "build" || b.measure == "build";
    return a.run == b.run && a.suite == b.suite && a.scene == b.scene && a.variant == b.variant && device;
}

void add_mean(TextTable& table, const std::vector<SpeedupMean>& means, const BenchRecord& of, const char* what,
              double SpeedupMean::* value, double SpeedupMean::* spread) {
    std::vector<std::string> cells = {what, of.variant};
    for (const char* measure : kMeasures) {
        std::string found;
        for (const SpeedupMean& m : means)
            if (m.run == of.run && m.suite == of.suite && m.variant == of.variant && m.measure == measure &&
                (m.device_id == of.device_id || m.measure == "build"))
                found = ratio_text(m.*value, m.*spread, kSame);
        cells.push_back(found);
    }
    cells.emplace_back();  // memory has no mean
    table.add(cells);
}

}  // namespace

std::string speedup_table(const BenchReport& report) {
    std::vector<Line> lines;
    for (const BenchRecord& r : report.records) {
        const auto* at =
            std::find_if(std::begin(kMeasures), std::end(kMeasures), [&](const char* m) { return r.measure == m; });
        if (r.speedup.baseline.empty() || r.status != RowStatus::ok || r.suite != "cpu" || at == std::end(kMeasures)) continue;
        auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return together(*l.first, r); });
        if (line == lines.end()) line = lines.insert(lines.end(), Line{&r, {}, 0});
        if (line->first->measure == "build") line->first = &r;  // because a row of a build has no device
        line->speedup[at - std::begin(kMeasures)] = r.speedup;
        if (r.measure == "build") line->bytes = r.speedup.bytes_ratio;
    }
    if (lines.empty()) return {};
    TextTable table({"scene", "structure", "primary", "shadow", "reflect", "diffuse", "whitted", "build", "bytes"}, 2);
    std::vector<const BenchRecord*> structures;
    for (const Line& line : lines) {
        std::vector<std::string> cells = {line.first->scene, line.first->variant};
        for (const Speedup& v : line.speedup) cells.push_back(ratio_text(v.ratio, v.spread, kSame));
        cells.push_back(ratio_text(line.bytes, 0, "1.00"));
        table.add(cells);
        const auto same = [&](const BenchRecord* r) {
            return r->run == line.first->run && r->variant == line.first->variant && r->device_id == line.first->device_id;
        };
        if (std::none_of(structures.begin(), structures.end(), same)) structures.push_back(line.first);
    }
    const std::vector<SpeedupMean> means = speedup_means(report);
    for (const BenchRecord* structure : structures) {
        add_mean(table, means, *structure, "GEOMETRIC MEAN", &SpeedupMean::mean, &SpeedupMean::mean_spread);
        add_mean(table, means, *structure, "LEAST", &SpeedupMean::least, &SpeedupMean::least_spread);
    }
    return "cpu: how many times as fast as the fastest peer in the same case (build: as the medium one, "
           "builder=morton: low, spatial: high), p50; bytes: as many times\n"
           "same: about the same, the difference is within the measured spread\n" +
           table.text(26) + "\n";
}

}  // namespace clarity::bench
