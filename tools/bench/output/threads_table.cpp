// threads_table.cpp -- how rows gain by threads: each measured with several numbers of them.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

double rate(const BenchRecord& r) {
    return r.mtris_per_s > 0 ? r.mtris_per_s : r.mrays_per_s;
}

using Gains = std::map<unsigned, const BenchRecord*>;  // by threads

// Over the fewest threads that it was measured with.
double gain(const Gains& line, unsigned threads) {
    const auto at = line.find(threads);
    return at == line.end() ? 0 : rate(*at->second) / rate(*line.begin()->second);
}

double against(const Gains& line, unsigned threads) {
    const auto at = line.find(threads);
    return at == line.end() ? 0 : at->second->speedup.ratio;
}

// Of lines that have one.
double geometric_mean(const std::vector<const Gains*>& lines, unsigned threads, double (*of)(const Gains&, unsigned)) {
    double sum = 0;
    int count = 0;
    for (const Gains* line : lines)
        if (const double value = of(*line, threads); value > 0) sum += std::log(value), ++count;
    return count ? std::exp(sum / count) : 0;
}

}  // namespace

std::string threads_table(const BenchReport& report) {
    std::vector<std::string> order;
    std::map<std::string, Gains> lines;
    std::set<unsigned> counts;
    for (const BenchRecord& r : report.records) {
        if (r.status != RowStatus::ok || !r.baseline.empty() || r.threads == 0 || rate(r) <= 0) continue;
        const std::string key = r.suite + "\n" + r.case_name + "\n" + r.variant + "\n" + r.device;
        if (lines[key].empty()) order.push_back(key);
        lines[key][r.threads] = &r;
        counts.insert(r.threads);
    }
    if (counts.size() < 2) return {};
    std::vector<std::string> head = {"case", "structure", "M/s with " + std::to_string(*counts.begin())};
    for (const unsigned count : counts)
        if (count != *counts.begin()) head.push_back("x by " + std::to_string(count));
    for (const unsigned count : counts) head.push_back("peer, " + std::to_string(count));
    TextTable table(head, 2);
    const auto add = [&](const std::string& name, const std::string& structure, double first,
                         const std::vector<const Gains*>& of) {
        std::vector<std::string> cells = {name, structure, short_number(first)};
        for (const unsigned count : counts)
            if (count != *counts.begin()) cells.push_back(short_number(geometric_mean(of, count, gain)));
        for (const unsigned count : counts) cells.push_back(short_number(geometric_mean(of, count, against)));
        table.add(cells);
    };
    std::vector<std::string> means;  // "primary\nbvh8", in the order of their first rows
    std::map<std::string, std::vector<const Gains*>> of_mean;
    for (const std::string& key : order) {
        const Gains& line = lines[key];
        const BenchRecord& r = *line.begin()->second;
        if (line.size() < 2) continue;
        add(r.case_name, r.variant, line.begin()->first == *counts.begin() ? rate(r) : 0, {&line});
        const std::string mean = r.measure + "\n" + r.variant;
        if (of_mean[mean].empty()) means.push_back(mean);
        of_mean[mean].push_back(&line);
    }
    for (const std::string& mean : means)
        add("GEOMETRIC MEAN, " + mean.substr(0, mean.find('\n')), mean.substr(mean.find('\n') + 1), 0, of_mean[mean]);
    return "threads: million rays (builds: triangles) a second with the fewest, p50; how many times as fast with more; and "
           "times the fastest peer with as many\n" +
           table.text(30) + "\n";
}

}  // namespace clarity::bench
