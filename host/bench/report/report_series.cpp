#include "bench/report/report_series.hpp"

#include <algorithm>
#include <array>

#include "bench/baselines/speedup.hpp"
#include "bench/report/report_markup.hpp"

namespace clarity::bench {
namespace {

constexpr int kGrey = kChartColors - 1;  // for baselines

std::string short_device(const BenchRecord& record) {
    const std::string& name = record.device;
    if (!record.baseline.empty() || name.rfind("pthread", 0) == 0 || name.rfind("cpu", 0) == 0 ||
        name.find("CPU") != std::string::npos || name.find("Xeon") != std::string::npos ||
        name.find("EPYC") != std::string::npos || name.find("Ryzen") != std::string::npos)
        return "CPU";
    std::string text = name;
    for (const char* maker : {"NVIDIA ", "AMD ", "Intel(R) ", "GeForce "})
        if (text.rfind(maker, 0) == 0) text.erase(0, std::string(maker).size());
    text = text.substr(0, text.find(' ', 4));
    return text.empty() ? "device" : text.substr(0, 20);
}

}  // namespace

SeriesNames::SeriesNames(const BenchReport& report) {
    for (const BenchRecord& r : report.records) {
        // Baselines and builds run on the host's processor, which the report calls CPU; they add no device.
        if (!r.baseline.empty() || r.device.empty() || r.measure == "build") continue;
        if (devices_.count(r.device)) continue;
        const std::string base = short_device(r);
        std::string name = base;
        const auto taken = [&] {
            return std::any_of(devices_.begin(), devices_.end(), [&](const auto& d) { return d.second == name; });
        };
        for (int n = 2; taken(); ++n) name = base + " " + std::to_string(n);
        devices_[r.device] = name;
    }
    int next = 0;
    for (const BenchRecord& r : report.records) {
        // Rows of packets and array sizes have charts of their own, in which positions tell them apart instead of colours.
        if (!r.baseline.empty() || r.measure == "dropped" || r.measure == "build" || r.suite == "packets") continue;
        const std::string key = label(r);
        if (colors_.count(key)) continue;
        colors_[key] = next++ % kGrey;
        colors_.emplace(r.name(), colors_[key]);  // for its builds, on any device
    }
    for (const BenchRecord& r : report.records)
        if (r.baseline.empty() && r.measure == "build" && colors_.emplace(label(r), next % kGrey).second) ++next;
}

std::string SeriesNames::device(const BenchRecord& record) const {
    const auto found = devices_.find(record.device);
    return found != devices_.end() ? found->second : short_device(record);
}

std::string SeriesNames::label(const BenchRecord& record) const {
    if (!several_devices() || !record.baseline.empty() || record.measure == "build") return record.name();
    return record.name() + ", " + device(record);
}

int SeriesNames::color(const BenchRecord& record) const {
    const auto found = colors_.find(label(record));
    return record.baseline.empty() && found != colors_.end() ? found->second : kGrey;
}

std::vector<const BenchRun*> measured_runs(const BenchReport& report) {
    std::vector<const BenchRun*> runs;
    if (!report.run.date.empty()) runs.push_back(&report.run);
    for (const BenchRun& run : report.joined) runs.push_back(&run);
    return runs;
}

bool has_figures(const BenchRecord& record) {
    return record.status == RowStatus::ok && (record.time_ms.n > 0 || record.wall_ms.n > 0);
}

std::string ratio_figure(const Speedup& speedup) {
    if (about_same(speedup.ratio, speedup.spread)) return "about the same";
    return speedup.ratio > 0 ? figure(speedup.ratio) : std::string();
}

std::string figure_or_nothing(double value) {
    return value > 0 ? figure(value) : std::string();
}

std::string hint_of(const BenchRecord& r) {
    if (r.status != RowStatus::ok) return r.why;
    std::string text = r.name() + ": kernels p50 " + figure(r.time_ms.median) + " ms, all in p50 " + figure(r.wall_ms.median) +
                       " ms, spread " + percent_figure(std::max(r.time_ms.spread(), r.wall_ms.spread())) + " of " +
                       std::to_string(std::max(r.time_ms.n, r.wall_ms.n)) + " repetitions";
    if (r.rays() > 0) text += ", " + figure(double(r.rays())) + " rays";
    if (r.lanes > 0)
        text +=
            ", packet " + std::to_string(r.packet_w) + "x" + std::to_string(r.packet_h) + ", lanes " + std::to_string(r.lanes);
    return text;
}

Bar bar_of(const SeriesNames& names, const BenchRecord& record, double value, const std::string& label) {
    Bar bar;
    bar.label = label.empty() ? names.label(record) : label;
    bar.color = names.color(record);
    bar.hint = hint_of(record);
    if (record.status == RowStatus::ok) {
        bar.value = value;
        return bar;
    }
    bar.text = record.status == RowStatus::refused ? "refused" : record.status == RowStatus::failed ? "failed" : "skipped";
    return bar;
}

}  // namespace clarity::bench
