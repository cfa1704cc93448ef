// report_analysis.cpp -- the counters which the thesis argues with, each with an explanation.
#include "bench/output/record_fields.hpp"
#include "bench/report/report_markup.hpp"
#include "bench/report/report_sections.hpp"

namespace clarity::bench {
namespace {

std::string rays_of(const BenchRecord& r) {
    return r.measure == "primary" ? "camera rays" : r.measure == "reflection" ? "mirrored rays" : r.measure + " rays";
}

std::string charts_of(const BenchReport& report, const Field<Analysis>& field, const SeriesNames& names) {
    RecordGroups scenes;
    for (const BenchRecord& r : report.records)
        if (r.analysis.present && r.status == RowStatus::ok) scenes.add(r.suite + "\n" + r.scene, r);
    std::string charts;
    for (const auto& scene : scenes.all()) {
        RecordGroups kinds;
        for (const BenchRecord* r : scene) kinds.add(r->measure, *r);
        BarChart chart;
        chart.title = scene.front()->scene;
        chart.unit = field.look.unit;
        chart.whole = field.look.scale == 100 ? 100 : 0;  // axes of percents reach to 100
        bool any = false;
        for (const auto& kind : kinds.all()) {
            chart.groups.push_back({rays_of(*kind.front()), {}});
            for (const BenchRecord* r : kind) {
                const double value = field.look.scale * field.number(r->analysis);
                any |= value > 0;
                chart.groups.back().bars.push_back(bar_of(names, *r, value));
                chart.groups.back().bars.back().hint = hint_of(*r);
            }
        }
        if (any) charts += bar_chart(chart);
    }
    return charts.empty() ? charts
                          : std::string("<h3>") + field.look.title + "</h3>\n" + paragraph(field.look.meaning) +
                                "<div class=\"grid three\">\n" + charts + "</div>\n";
}

std::string dropped_of(const BenchReport& report, const SeriesNames& names) {
    RecordGroups scenes;
    for (const BenchRecord& r : report.records)
        if (r.measure == "dropped" && r.status == RowStatus::ok) scenes.add(r.suite + "\n" + r.scene + "\n" + r.device, r);
    std::string charts;
    for (const auto& scene : scenes.all()) {
        BarChart chart;
        chart.title = scene.front()->scene + (names.several_devices() ? ", " + names.device(*scene.front()) : "");
        chart.unit = "percent of the secondary rays, 4 steps";
        chart.groups.emplace_back();
        for (const BenchRecord* r : scene) {
            const double all = double(r->rays_secondary + r->rays_dropped);
            Bar bar = bar_of(names, *r, all > 0 ? 100 * double(r->rays_dropped) / all : 0,
                             std::to_string(r->ray_slots) + (r->ray_slots == 1 ? " slot" : " slots"));
            bar.color = 0;
            bar.hint = figure(double(r->rays_dropped)) + " of " + figure(all) + " rays";
            chart.groups.back().bars.push_back(bar);
        }
        charts += bar_chart(chart);
    }
    return charts.empty()
               ? charts
               : "<h3>Dropped rays</h3>\n" +
                     paragraph(
                         "The thesis keeps the rays of a generation in arrays of a fixed size, because its graphics cards "
                         "could not allocate memory. Glass turns one ray into two. If the array is full, rays are dropped, and "
                         "the pixel misses light. The figure is the share of dropped rays with 1, 2, 4 and 8 slots a pixel; in "
                         "4 steps no pixel can need more than 8.") +
                     "<div class=\"grid three\">\n" + charts + "</div>\n";
}

}  // namespace

std::string analysis_section(const BenchReport& report, const SeriesNames& names) {
    std::string out;
    for (const Field<Analysis>& field : analysis_fields())
        if (field.look.meaning) out += charts_of(report, field, names);
    out += dropped_of(report, names);
    if (out.empty()) return out;
    return "<h2 id=\"analysis\">Why: what the tracer did</h2>\n" +
           paragraph(
               "A second, slower program counts on the same rays, so that counting does not affect the times above. "
               "docs/bench.md defines every figure.") +
           out;
}

}  // namespace clarity::bench
