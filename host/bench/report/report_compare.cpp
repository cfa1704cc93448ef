// report_compare.cpp -- compares packets, structures and baselines, and shows how cost grows with size.
#include <algorithm>
#include <map>

#include "bench/baselines/speedup.hpp"
#include "bench/output/record_fields.hpp"
#include "bench/report/report_markup.hpp"
#include "bench/report/report_sections.hpp"

namespace clarity::bench {
namespace {

struct Measure {
    const char *key, *title, *unit;
};
constexpr Measure kRays[] = {{"primary", "Camera rays", "million rays a second"},
                             {"shadow", "Shadow rays", "million rays a second"},
                             {"reflection", "Mirrored rays", "million rays a second"},
                             {"diffuse", "Diffusely scattered rays", "million rays a second"}};
constexpr Measure kFrame = {"frame", "Whole frames", "frames per second"};
constexpr Measure kBuild = {"build", "Building", "million triangles a second"};

double value_of(const BenchRecord& r) {
    return r.measure == "frame" ? r.fps : r.measure == "build" ? r.mtris_per_s : r.mrays_per_s;
}

bool is_comparison(const BenchRecord& r) {
    return r.suite == "accel" || (r.suite == "quick" && r.measure != "frame");
}

std::string chart_of(const std::vector<const BenchRecord*>& scene, const Measure& measure, const SeriesNames& names) {
    BarChart chart;
    chart.title = measure.title;
    chart.unit = measure.unit;
    chart.groups.emplace_back();
    for (const BenchRecord* r : scene)
        if (r->measure == measure.key) chart.groups.back().bars.push_back(bar_of(names, *r, value_of(*r)));
    return bar_chart(chart);
}

std::string builds_of(const std::vector<const BenchRecord*>& scene) {
    constexpr const char* kKeys[] = {"mtris_per_s", "bytes_per_triangle", "nodes", "sah_cost"};
    std::vector<std::string> head = {"structure", "build p50, ms"};
    for (const char* key : kKeys) head.push_back(record_field(key).look.title);
    MarkupTable table(head, 1);
    for (const BenchRecord* r : scene) {
        if (r->measure != "build" || !has_figures(*r)) continue;
        std::vector<std::string> cells = {r->name(), figure(r->time_ms.median)};
        for (const char* key : kKeys) cells.push_back(figure_or_nothing(record_field(key).number(*r)));
        table.add(cells);
    }
    return table.markup();
}

// Our best structure against the best baseline on the same rays.
std::string against_baselines(const RecordGroups& scenes, const SeriesNames& names) {
    MarkupTable table({"scene", "rays", "best of ours", "best peer", "ours, Mrays/s", "theirs", "ours by theirs"}, 4);
    for (const auto& scene : scenes.all())
        for (const Measure& measure : kRays) {
            const BenchRecord *ours = nullptr, *theirs = nullptr;
            for (const BenchRecord* r : scene) {
                if (r->measure != measure.key || !has_figures(*r)) continue;
                const BenchRecord*& best = r->baseline.empty() ? ours : theirs;
                if (!best || value_of(*best) < value_of(*r)) best = r;
            }
            if (!ours || !theirs) continue;
            table.add({ours->scene, measure.title, names.label(*ours), theirs->name(), figure(value_of(*ours)),
                       figure(value_of(*theirs)), ratio_figure(speedup(*ours, *theirs))});
        }
    return table.markup();
}

}  // namespace

std::string packets_section(const BenchReport& report, const SeriesNames& names) {
    RecordGroups scenes;
    for (const BenchRecord& r : report.records)
        if (r.suite == "packets") scenes.add(r.scene + "\n" + r.device, r);
    if (scenes.all().empty()) return {};
    std::string out =
        "<h2 id=\"packets\">Packets</h2>\n" +
        paragraph(
            "Packet: the pixels which one work-item computes. Lanes: the rays which it traces side by side. The thesis found "
            "4x4 best on its graphics cards, where every ray of a packet was traced on its own. Here a packet of 4x4 on 16 "
            "lanes is traversed like one ray: a node is fetched once for all. A structure that takes streams traces all such "
            "groups of a larger packet together, up to as many groups as lanes.") +
        "<div class=\"grid\">\n";
    for (const auto& scene : scenes.all()) {
        BarChart chart;
        chart.title = scene.front()->scene + (names.several_devices() ? ", " + names.device(*scene.front()) : "");
        chart.unit = "frames per second, 4 steps";
        std::map<int, BarGroup> by_lanes;
        for (const BenchRecord* r : scene) {
            BarGroup& group = by_lanes[r->lanes];
            group.title = std::to_string(r->lanes) + (r->lanes == 1 ? " lane" : " lanes");
            Bar bar = bar_of(names, *r, r->fps, "packet " + std::to_string(r->packet_w) + "x" + std::to_string(r->packet_h));
            bar.color = static_cast<int>(by_lanes.size()) - 1;
            group.bars.push_back(bar);
        }
        int color = 0;
        for (auto& [lanes, group] : by_lanes) {
            for (Bar& bar : group.bars) bar.color = color;
            ++color;
            chart.groups.push_back(group);
        }
        out += bar_chart(chart);
    }
    return out + "</div>\n";
}

std::string structures_section(const BenchReport& report, const SeriesNames& names) {
    RecordGroups scenes;
    for (const BenchRecord& r : report.records)
        if (is_comparison(r)) scenes.add(r.suite + "\n" + r.scene, r);
    if (scenes.all().empty()) return {};
    std::string out =
        "<h2 id=\"structures\">Structures and peers</h2>\n" +
        paragraph(
            "All structures trace the same rays, which are made once on the host: camera rays, and from each hit a ray to "
            "the light, a mirrored ray and a diffusely scattered ray. Peers (grey) trace the same rays with the "
            "same number of threads, and are measured interleaved with ours. Only active rays count: a pixel whose "
            "camera ray hit nothing has no secondary rays.");
    out += against_baselines(scenes, names);
    bool first = true;
    for (const auto& scene : scenes.all()) {
        const BenchRecord& r = *scene.front();
        out += std::string("<details") + (first ? " open=\"open\"" : "") + "><summary>" +
               escape_markup(r.scene + ", " + (r.triangles < 1000 ? std::to_string(r.triangles) : figure(double(r.triangles))) +
                             " triangles") +
               "</summary>\n<div class=\"grid\">\n";
        first = false;
        for (const Measure& measure : kRays) out += chart_of(scene, measure, names);
        out += chart_of(scene, kFrame, names) + chart_of(scene, kBuild, names) + "</div>\n" + builds_of(scene) + "</details>\n";
    }
    return out;
}

std::string scale_section(const BenchReport& report, const SeriesNames& names) {
    std::string charts;
    const auto add = [&](const Measure& measure) {
        std::map<std::string, Curve> curves;
        for (const BenchRecord& r : report.records) {
            if (r.suite != "scale" || r.measure != measure.key || !has_figures(r) || r.triangles == 0 || !(value_of(r) > 0))
                continue;
            Curve& curve = curves[names.label(r)];
            curve.label = names.label(r);
            curve.color = names.color(r);
            curve.points.emplace_back(double(r.triangles), value_of(r));
        }
        CurveChart chart{measure.title, "triangles", measure.unit, {}};
        for (auto& [label, curve] : curves) {
            std::sort(curve.points.begin(), curve.points.end());
            chart.curves.push_back(curve);
        }
        charts += curve_chart(chart);
    };
    for (const Measure& measure : kRays) add(measure);
    add(kFrame);
    add(kBuild);
    if (charts.empty()) return {};
    return "<h2 id=\"scale\">How cost grows</h2>\n" +
           paragraph(
               "One model at several sizes: its triangles are split and displaced, so that the surface has detail at every "
               "size. With a hierarchy, ten times as many triangles cost a ray only a few more nodes, until they no longer fit "
               "a cache. Testing every triangle would make a ray ten times as expensive.") +
           "<div class=\"grid\">\n" + charts + "</div>\n";
}

}  // namespace clarity::bench
