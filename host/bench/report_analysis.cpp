// report_analysis.cpp -- what the thesis reasons about, counted: each figure with what it means.
#include <functional>

#include "bench/report_markup.hpp"
#include "bench/report_sections.hpp"

namespace clarity {
namespace {

struct Figure {
    const char *title, *unit, *meaning;
    double whole;  // 100 for percents
    std::function<double(const Analysis&)> of;
};

const std::vector<Figure>& figures() {
    static const std::vector<Figure> all = {
        {"Nodes visited", "a ray, mean",
         "Every node is a fetch from memory and a test of a volume, one after the other: this is what a ray waits for. A "
         "packet visits what any of its rays needs, so one that holds together visits little more than each ray alone, and "
         "one that has spread visits much more.",
         0, [](const Analysis& a) { return a.nodes_per_ray; }},
        {"Primitives tested", "a ray, mean",
         "Tests of triangles, spheres and polygons in the leaves. Tight volumes keep them near one; bounding spheres, which "
         "are mostly air around a triangle, let many more through, and spheres without a tree above them are all asked.",
         0, [](const Analysis& a) { return a.leaf_tests_per_ray; }},
        {"Lanes alive", "percent of all lanes, per node visited",
         "Branch divergence: the lanes of a work-item go the same way, and those whose ray is not in the node are carried "
         "along. 100 % means that all rays of a packet want every node it visits. Mirrored rays of curved things spread, and "
         "the share falls. With one lane it is how many of the nodes tested were entered.",
         100, [](const Analysis& a) { return 100 * a.lanes_alive; }},
        {"Alive in a warp", "percent, of 32 neighbours, one lane only",
         "The same on a graphics card, where each ray is a work-item and 32 neighbours run in step: all wait for the one "
         "that visits the most nodes. This is the mean of their visits over the most.",
         100, [](const Analysis& a) { return 100 * a.warp_alive; }},
        {"Bytes fetched", "a ray, mean",
         "Nodes and primitives as they lie in memory, each counted once a packet. Times the rays a second this is what "
         "caches and memory must deliver.",
         0, [](const Analysis& a) { return a.bytes_per_ray; }},
        {"Fetched together", "percent of the node fetches",
         "What packets are for, and what coalesced reads are on a graphics card: of the nodes that the rays would fetch one "
         "by one, the share that fetching together saves. 0 % with one lane, where nothing is shared but by the cache.",
         100, [](const Analysis& a) { return 100 * a.bytes_shared; }},
    };
    return all;
}

std::string rays_of(const BenchRecord& r) {
    return r.measure == "primary" ? "camera rays" : r.measure == "reflection" ? "mirrored rays" : r.measure + " rays";
}

std::string charts_of(const BenchReport& report, const Figure& figure, const SeriesNames& names) {
    RecordGroups scenes;
    for (const BenchRecord& r : report.records)
        if (r.analysis.present && r.status == RowStatus::ok) scenes.add(r.suite + "\n" + r.scene, r);
    std::string charts;
    for (const auto& scene : scenes.all()) {
        RecordGroups kinds;
        for (const BenchRecord* r : scene) kinds.add(r->measure, *r);
        BarChart chart;
        chart.title = scene.front()->scene;
        chart.unit = figure.unit;
        chart.whole = figure.whole;
        bool any = false;
        for (const auto& kind : kinds.all()) {
            chart.groups.push_back({rays_of(*kind.front()), {}});
            for (const BenchRecord* r : kind) {
                const double value = figure.of(r->analysis);
                any |= value > 0;
                chart.groups.back().bars.push_back(bar_of(names, *r, value));
                chart.groups.back().bars.back().hint = hint_of(*r);
            }
        }
        if (any) charts += bar_chart(chart);
    }
    return charts.empty() ? charts
                          : std::string("<h3>") + figure.title + "</h3>\n" + paragraph(figure.meaning) +
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
                         "The thesis keeps the rays of a generation in arrays of a fixed size, since its cards could not "
                         "allocate. Glass makes two rays of one, and an array that is full must refuse some: a pixel then "
                         "misses light. This is the share that is refused with 1, 2, 4 and 8 places a pixel; after 4 steps "
                         "no pixel can need more than 8.") +
                     "<div class=\"grid three\">\n" + charts + "</div>\n";
}

}  // namespace

std::string analysis_section(const BenchReport& report, const SeriesNames& names) {
    std::string out;
    for (const Figure& figure : figures()) out += charts_of(report, figure, names);
    out += dropped_of(report, names);
    if (out.empty()) return out;
    return "<h2 id=\"analysis\">Why: what the tracer did</h2>\n" +
           paragraph(
               "Counted by a second, slower program on the same rays, so that counting costs no time above. docs/bench.md "
               "defines every figure.") +
           out;
}

}  // namespace clarity
