// report_thesis.cpp -- the thesis's charts: frames per second by steps and device, "then" and "now".
#include <algorithm>
#include <map>

#include "bench/baselines/speedup.hpp"
#include "bench/report/report_markup.hpp"
#include "bench/report/report_sections.hpp"

namespace clarity::bench {
namespace {

// A scene of the thesis, and the figure to compare with. For the six tests that is the end of the chart's axis in fps, which no
// device of 2008 reached.
struct ThesisTest {
    const char *scene, *title;
    double fps;
    const char* meaning;
};
constexpr ThesisTest kTests[] = {
    {"1_two_triangles", "Test 1: 2 triangles", 40, "the thesis's chart ends at 40 fps"},
    {"2_two_spheres", "Test 2: 2 spheres", 100, "the thesis's chart ends at 100 fps"},
    {"3_triangle_two_spheres", "Test 3: 1 triangle and 2 spheres", 35, "the thesis's chart ends at 35 fps"},
    {"4_35_triangles", "Test 4: 35 triangles", 14, "the thesis's chart ends at 14 fps"},
    {"5_36_spheres", "Test 5: 36 spheres", 7, "the thesis's chart ends at 7 fps"},
    {"6_2406_triangles", "Test 6: 2406 triangles", 0.3, "the thesis's chart ends at 0.3 fps"},
    {"spheres21", "The demo that it cites: 21 spheres on a plane", 70, "70 fps, GeForce 8800 GTS, about 800x600"},
    {"aim_100k", "Its aim: a hundred thousand polygons", 60, "60 fps at 1024x768, not reached in 2008"},
};
constexpr size_t kNumbered = 6;

const ThesisTest* test_of(const std::string& scene) {
    for (const ThesisTest& test : kTests)
        if (scene == test.scene) return &test;
    return nullptr;
}

bool is_frame(const BenchRecord& r) {
    return (r.suite == "thesis" || r.suite == "quick") && r.measure == "frame";
}

std::string chart_of(const std::vector<const BenchRecord*>& scene, const SeriesNames& names) {
    const ThesisTest* test = test_of(scene.front()->scene);
    BarChart chart;
    chart.title = test ? test->title : scene.front()->scene;
    chart.unit = "frames per second";
    if (test) {
        chart.reference = test->fps;
        chart.reference_text = test->meaning;
    }
    std::map<int, BarGroup> by_steps;
    for (const BenchRecord* r : scene) {
        BarGroup& group = by_steps[r->depth];
        group.title = std::to_string(r->depth) + (r->depth == 1 ? " step" : " steps");
        group.bars.push_back(bar_of(names, *r, r->fps));
    }
    for (const auto& [steps, group] : by_steps) chart.groups.push_back(group);
    return bar_chart(chart);
}

// One line per scene, device and design.
std::string table_of(const RecordGroups& rows, const SeriesNames& names) {
    std::map<std::string, const BenchRecord*> then;
    for (const auto& row : rows.all())
        for (const BenchRecord* r : row)
            if (r->variant == "then" && has_figures(*r))
                then[r->scene + "\n" + r->device + "\n" + std::to_string(r->depth)] = r;
    MarkupTable table({"test", "design", "1 step", "2 steps", "3 steps", "4 steps", "kernels p50, ms", "all in p50, ms", "p95",
                       "p99", "spread", "Mrays/s", "x thesis's axis", "x then"},
                      2);
    for (const auto& row : rows.all()) {
        std::vector<std::string> fps(5);
        const BenchRecord* last = nullptr;
        for (const BenchRecord* r : row) {
            if (!has_figures(*r) || r->depth < 1 || r->depth > 4) continue;
            fps[r->depth] = figure(r->fps);
            if (!last || r->depth > last->depth) last = r;
        }
        if (!last) continue;
        const ThesisTest* test = test_of(last->scene);
        const auto naive = then.find(last->scene + "\n" + last->device + "\n" + std::to_string(last->depth));
        Speedup by_then;
        if (naive != then.end() && last->variant != "then") by_then = speedup(*last, *naive->second);
        table.add({test ? test->title : last->scene, names.label(*last), fps[1], fps[2], fps[3], fps[4],
                   figure(last->time_ms.median), figure(last->wall_ms.median), figure_or_nothing(last->wall_ms.p95),
                   figure_or_nothing(last->wall_ms.p99),
                   percent_figure(std::max(last->time_ms.spread(), last->wall_ms.spread())), figure(last->mrays_per_s),
                   test ? figure(last->fps / test->fps) : "", ratio_figure(by_then)});
    }
    return table.markup();
}

std::string kernels_of(const RecordGroups& scenes, const SeriesNames& names) {
    MarkupTable table({"scene", "design", "kernel", "ms", "share"}, 3);
    for (const auto& scene : scenes.all())
        for (const BenchRecord* r : scene) {
            if (!has_figures(*r) || r->scene != "aim_100k") continue;
            double sum = 0;
            for (const auto& [name, ms] : r->kernels_ms) sum += ms;
            for (const auto& [name, ms] : r->kernels_ms)
                table.add({r->scene, names.label(*r), name, figure(ms), sum > 0 ? percent_figure(ms / sum) : ""});
        }
    const std::string markup = table.markup();
    return markup.empty() ? markup : "<h3>Where a frame of the aim spends its time</h3>\n" + markup;
}

// Tiles: the range of speed-ups over the axes' ends of the six tests at 4 steps, and the frame rates of the other two scenes.
std::string tiles_of(const RecordGroups& rows, const SeriesNames& names) {
    struct Range {
        double least = 0, most = 0;
        std::string test;
        size_t tests = 0;
    };
    std::map<std::string, Range> ranges;
    std::string tiles;
    for (const auto& row : rows.all()) {
        const BenchRecord& r = *row.back();
        const ThesisTest* test = test_of(r.scene);
        if (!test || !has_figures(r) || r.variant == "then" || r.depth != 4) continue;
        const double factor = r.fps / test->fps;
        if (static_cast<size_t>(test - kTests) >= kNumbered) {
            tiles += "<div><b>" + escape_markup(figure(r.fps)) + " fps</b><span>" +
                     escape_markup(names.device(r) + ": " + test->title + " (" + test->meaning + ")") + "</span></div>\n";
            continue;
        }
        Range& w = ranges[names.device(r)];
        w.most = std::max(w.most, factor);
        if (w.tests++ == 0 || factor < w.least) {
            w.least = factor;
            w.test = test->title;
        }
    }
    std::string out;
    for (const auto& [device, w] : ranges)
        out += "<div><b>" + escape_markup(figure(w.least) + " to " + figure(w.most)) + " x</b><span>" +
               escape_markup(device + ": the ends of the thesis's axes, at 4 steps, " + std::to_string(w.tests) +
                             " tests; least in " + w.test) +
               "</span></div>\n";
    out += tiles;
    return out.empty() ? out : "<div class=\"tiles\">" + out + "</div>\n";
}

}  // namespace

std::string thesis_section(const BenchReport& report, const SeriesNames& names) {
    RecordGroups scenes, rows;
    for (const BenchRecord& r : report.records)
        if (is_frame(r)) {
            scenes.add(r.suite + "\n" + r.scene, r);
            rows.add(r.suite + "\n" + r.scene + "\n" + r.device + "\n" + r.variant, r);
        }
    if (scenes.all().empty()) return {};
    std::string out = "<h2 id=\"thesis\">The thesis's tests, then and now</h2>\n";
    out += tiles_of(rows, names);
    out += paragraph(
        "Frames per second by generations of rays (the thesis's steps), as the thesis draws them. The dashed line is the end "
        "of the axis of its chart, which is above all that its two graphics cards and two processors reached in 2008. "
        "\"then\" is its design on this machine: trees of bounding spheres split by count, one per mesh without a top level, "
        "one ray at a time in packets of 4x4. \"now\" is this program with its default settings. Both time a frame from the "
        "call until its pixels are in host memory.");
    out += "<div class=\"grid\">\n";
    for (const auto& scene : scenes.all()) out += chart_of(scene, names);
    return out + "</div>\n" + table_of(rows, names) + kernels_of(scenes, names);
}

}  // namespace clarity::bench
