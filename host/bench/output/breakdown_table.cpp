// breakdown_table.cpp -- the parts of a frame's time in percent, one line per scene.
#include <algorithm>
#include <cstdio>

#include "bench/output/output.hpp"
#include "bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

std::string share_text(double part, double whole) {
    char text[16];
    std::snprintf(text, sizeof text, "%.1f", whole > 0 ? 100 * part / whole : 0);
    return text;
}

double sum_of(const Parts& parts) {
    double sum = 0;
    for (const auto& [name, ms] : parts) sum += ms;
    return sum;
}

}  // namespace

std::string breakdown_table(const BenchReport& report) {
    const BenchRecord* some = nullptr;
    for (const BenchRecord& r : report.records)
        if (!some && r.status == RowStatus::ok && r.measure == "breakdown" && !r.parts_ms.empty()) some = &r;
    if (!some) return {};
    std::vector<std::string> head = {"scene", "structure", "frame ms"};
    for (const auto& [name, ms] : some->parts_ms) head.push_back(name);
    head.push_back("+-");
    std::vector<std::string> within_head = {"scene", "structure"};
    for (const auto& [name, ms] : some->within_ms) within_head.push_back(name);
    TextTable table(head, 2), within(within_head, 2);
    for (const BenchRecord& r : report.records) {
        if (r.status != RowStatus::ok || r.measure != "breakdown" || r.parts_ms.size() != some->parts_ms.size()) continue;
        const double all = sum_of(r.parts_ms);
        std::vector<std::string> cells = {r.scene, r.variant, short_number(all)}, in = {r.scene, r.variant};
        for (const auto& [name, ms] : r.parts_ms) cells.push_back(share_text(ms, all));
        cells.push_back(share_text(r.parts_error_ms, all));
        table.add(cells);
        for (const auto& [name, ms] : r.within_ms) in.push_back(share_text(ms, all));
        within.add(in);
    }
    return "where a frame's time goes, percent; +-: half the interquartile range of the least steady time\n" + table.text(20) +
           "\nand of these, percent of the frame\n" + within.text(20) + "\n";
}

}  // namespace clarity::bench
