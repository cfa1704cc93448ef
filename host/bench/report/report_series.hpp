// report_series.hpp -- prepares records for charts: names of series and devices, colours.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "bench/output/record_groups.hpp"
#include "bench/report/report_chart.hpp"

namespace clarity::bench {

// Names and colours of all series of a report; they are the same in every chart.
class SeriesNames {
 public:
    explicit SeriesNames(const BenchReport& report);
    // "now", "embree packet16 high"; "now, H200" if there are several devices.
    std::string label(const BenchRecord& record) const;
    int color(const BenchRecord& record) const;
    // Short name: "H200", "CPU"; numbered if two devices would have the same name.
    std::string device(const BenchRecord& record) const;
    bool several_devices() const { return devices_.size() > 1; }

 private:
    std::map<std::string, std::string> devices_;  // key: the device's full name
    std::map<std::string, int> colors_;           // key: label
};

// The runs which measured something. A run which only joins earlier runs has no date.
std::vector<const BenchRun*> measured_runs(const BenchReport& report);
// True if the record has figures to show.
bool has_figures(const BenchRecord& record);
// "1.23"; "about the same" if the difference is within the measured spread; "" if nothing was compared.
std::string ratio_figure(const Speedup& speedup);
// "" for 0, which means that there is no figure.
std::string figure_or_nothing(double value);
// Spread, rays and settings, shown when the pointer is over the bar.
std::string hint_of(const BenchRecord& record);
// A bar of a record: its value, or a word which says why it has none.
Bar bar_of(const SeriesNames& names, const BenchRecord& record, double value, const std::string& label = {});

}  // namespace clarity::bench
