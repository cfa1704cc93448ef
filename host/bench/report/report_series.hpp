// report_series.hpp -- records put in order for drawing: who they are of, short names of devices, colours.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "bench/report/report_chart.hpp"

#include "bench/output/record.hpp"

namespace clarity::bench {

// Records put together by a key, in the order in which keys first came.
class RecordGroups {
 public:
    void add(const std::string& key, const BenchRecord& record);
    const std::vector<std::vector<const BenchRecord*>>& all() const { return groups_; }

 private:
    std::map<std::string, size_t> index_;
    std::vector<std::vector<const BenchRecord*>> groups_;
};

// Names and colours of all series of a report, the same in every chart.
class SeriesNames {
 public:
    explicit SeriesNames(const BenchReport& report);
    // "now", "embree packet16 high"; with several devices "now, H200".
    std::string label(const BenchRecord& record) const;
    int color(const BenchRecord& record) const;
    // "H200", "CPU"; told apart by numbers where they would be the same.
    std::string device(const BenchRecord& record) const;
    bool several_devices() const { return devices_.size() > 1; }

 private:
    std::map<std::string, std::string> devices_;  // by the device's own name
    std::map<std::string, int> colors_;           // by label
};

// Those that measured something: one that only joins others has no date.
std::vector<const BenchRun*> measured_runs(const BenchReport& report);
// The variant, or the peer.
std::string who_is(const BenchRecord& record);
// Whether there are figures to be shown.
bool has_figures(const BenchRecord& record);
// "1.23", or "about the same" where the difference is within the measured spread; "" where nothing was compared.
std::string ratio_figure(const Speedup& speedup);
// "" for 0, which says that there is no such figure.
std::string figure_or_nothing(double value);
// Spread, rays, settings: shown when pointed at.
std::string hint_of(const BenchRecord& record);
// A bar of a record: its value, or in words why there is none.
Bar bar_of(const SeriesNames& names, const BenchRecord& record, double value, const std::string& label = {});

}  // namespace clarity::bench
