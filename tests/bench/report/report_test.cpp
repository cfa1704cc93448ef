// report_test.cpp -- the page of the bench: it is well-formed for any records, loads nothing from the network, and shows every
// figure.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "bench/output/output.hpp"
#include "bench/report/report.hpp"
#include "bench/report/report_chart.hpp"
#include "bench/report/report_markup.hpp"
#include "bench/report/report_page.hpp"
#include "bench/report/sample.hpp"
#include "bench/report/xml_check.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

size_t count_of(const std::string& text, const std::string& what) {
    size_t n = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
    return n;
}

TEST(ReportPage, IsWellFormedAndSelfContained) {
    const std::string page = report_page(sample_report());
    EXPECT_EQ(xml_error(page), "");
    for (const char* foreign : {"src=", "@import", "url(", "<script", "<link", "http://", "https://"}) {
        const size_t allowed = std::string(foreign) == "http://" ? count_of(page, "http://www.w3.org/") : 0;
        EXPECT_EQ(count_of(page, foreign), allowed) << foreign << ": the page must be self-contained";
    }
    EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
    EXPECT_NE(page.find("@media print"), std::string::npos);
}

TEST(ReportPage, ShowsEveryThesisChartWithItsAxisEnd) {
    const std::string page = report_page(sample_report());
    for (const char* end :
         {"ends at 40 fps", "ends at 100 fps", "ends at 35 fps", "ends at 14 fps", "ends at 7 fps", "ends at 0.3 fps"})
        EXPECT_GE(count_of(page, end), 1u) << end;
    for (const char* id : {"thesis", "packets", "structures", "scale", "analysis", "left-out", "machine"}) {
        EXPECT_EQ(count_of(page, std::string("<h2 id=\"") + id + "\""), 1u) << id;
        EXPECT_EQ(count_of(page, std::string("href=\"#") + id + "\""), 1u) << id;
    }
}

// The speed-ups over the axes' ends, computed by hand: test n takes 6 * 1.6^(n - 1) ms a step, all in 2 % and .3 ms more.
TEST(ReportPage, StatesTheGains) {
    const auto gain = [](int test, double end) { return 1000 / (6 * std::pow(1.6, test - 1) * 4 * 1.02 + .3) / end; };
    const std::string page = report_page(sample_report());
    EXPECT_NE(page.find("<b>" + figure(gain(2, 100)) + " to " + figure(gain(6, .3)) + " x</b><span>CPU: the ends"),
              std::string::npos);
}

TEST(ReportPage, RefusedRowsHaveNoFigures) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) {
        r.status = RowStatus::refused;
        r.why = "the middle half spreads";
    }
    const std::string page = report_page(report);
    EXPECT_EQ(xml_error(page), "");
    EXPECT_EQ(count_of(page, "<i class=\"bar"), 0u);
    EXPECT_GT(count_of(page, ">refused<"), 10u);
}

TEST(ReportPage, SuitesMayBeEmpty) {
    BenchReport nothing;
    EXPECT_EQ(xml_error(report_page(nothing)), "");
    EXPECT_NE(report_page(nothing).find("Nothing was measured"), std::string::npos);
    nothing.interrupted = true;
    nothing.records.resize(3);  // of no suite, without figures
    EXPECT_EQ(xml_error(report_page(nothing)), "");
    EXPECT_NE(report_page(nothing).find("interrupted"), std::string::npos);
}

// A run which measures nothing and only joins earlier runs.
TEST(ReportPage, JoinsRuns) {
    BenchReport report = sample_report();
    report.joined = {report.run, report.run};
    report.joined[1].host_cpu = "another processor";
    report.run = BenchRun();
    report.run.command = "clarity bench --join a --join b";
    for (BenchRecord& r : report.records) r.run = r.device[0] == 'N' ? 2 : 1;
    const std::string page = report_page(report);
    EXPECT_EQ(xml_error(page), "");
    EXPECT_EQ(count_of(page, "another processor"), 2u) << "at the head and in the table of runs";
    EXPECT_EQ(count_of(page, ", 0 threads"), 0u);
    EXPECT_NE(page.find("This page joins 2 runs"), std::string::npos);
    EXPECT_NE(page.find("stays above 10.0 %"), std::string::npos);
}

TEST(ReportPage, NamesWithMarkupAreEscaped) {
    const std::string hostile[] = {
        "</title><script>alert(1)</script>",
        "a\"b'c&d<e>",
        std::string("nul\0in it", 9),
        "\x1b[31mred\xff\xc0\xaf\xed\xa0\x80",
        "]]>-->",
        "a name of a scene that is far longer than any label would like to be, \xe6\xb5\xb7\xe9\xba\xbc"};
    for (const std::string& name : hostile) {
        BenchReport report = sample_report();
        for (BenchRecord& r : report.records) {
            for (std::string* text :
                 {&r.scene, &r.variant, &r.device, &r.driver, &r.case_name, &r.accel, &r.accel_params, &r.why})
                *text += name;
            if (!r.baseline.empty()) r.baseline += name;
        }
        for (std::string* text : {&report.run.command, &report.run.host_cpu, &report.run.date, &report.run.governor})
            *text = name;
        report.notes.push_back(name);
        const std::string page = report_page(report);
        EXPECT_EQ(xml_error(page), "") << escape_markup(name);
        EXPECT_EQ(count_of(page, "<script"), 0u);
    }
}

TEST(ReportPage, NanAndInfinityAreNotShownAsNumbers) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) {
        r.fps = NAN;
        r.mrays_per_s = INFINITY;
        r.analysis.nodes_per_ray = -1;
        r.time_ms.median = 0;
    }
    const std::string page = report_page(report);
    EXPECT_EQ(xml_error(page), "");
    EXPECT_EQ(count_of(page, ":nan%") + count_of(page, ":-nan%") + count_of(page, ":inf%"), 0u);
}

TEST(ReportFolder, HoldsPageAndRecords) {
    const Scratch scratch;
    const std::string folder = scratch.path("a/deep folder");
    write_report(folder, sample_report());
    std::ifstream json(folder + "/bench.json");
    std::stringstream text;
    text << json.rdbuf();
    EXPECT_EQ(read_bench_json(text.str()).records.size(), sample_report().records.size());
    EXPECT_GT(std::filesystem::file_size(folder + "/bench.csv"), 1000u);
    EXPECT_GT(std::filesystem::file_size(folder + "/index.html"), 10000u);
    if (const char* keep = std::getenv("CLARITY_KEEP_REPORT")) write_report(keep, sample_report());
}

TEST(ReportFolder, SaysWhereItCannotWrite) {
    const Scratch scratch;
    const std::string file = scratch.path("file");
    std::ofstream(file) << "here";
    try {
        write_report(file, sample_report());
        FAIL() << "write_report() must fail if a file has the folder's name";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Exit::failed);
        EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
    }
}

TEST(ReportNumbers, ThreeDigitsAndThousands) {
    EXPECT_EQ(figure(0), "0");
    EXPECT_EQ(figure(.01234), "0.0123");
    EXPECT_EQ(figure(1234), "1234");
    EXPECT_EQ(figure(12345), "12\u202f345");
    EXPECT_EQ(figure(1234567), "1\u202f234\u202f567");
    EXPECT_EQ(figure(NAN), "");
}

// The axis is logarithmic if the values are far apart, else linear. On a logarithmic axis, the bar of a hundredth is longer
// than a hundredth.
TEST(ReportCharts, AxisFollowsTheRange) {
    BarChart chart{"t", "u", {{"", {{"a", 1, 0, "", ""}, {"b", 100, 1, "", ""}}}}, 0, "", 0};
    EXPECT_NE(bar_chart(chart).find("logarithmic"), std::string::npos);
    EXPECT_NE(bar_chart(chart).find("width:100.00%"), std::string::npos);
    chart.groups[0].bars[0].value = 50;
    EXPECT_EQ(bar_chart(chart).find("logarithmic"), std::string::npos);
    EXPECT_NE(bar_chart(chart).find("width:50.00%"), std::string::npos);
    chart.whole = 400;
    EXPECT_NE(bar_chart(chart).find("width:25.00%"), std::string::npos) << "relative to `whole`, which is larger than any bar";
    chart.groups[0].bars.clear();
    EXPECT_EQ(bar_chart(chart), "");
}

TEST(ReportCharts, LabelsOfCurvesDoNotOverlap) {
    CurveChart chart{"t", "x", "y", {}};
    for (int i = 0; i < 12; ++i) chart.curves.push_back({"curve " + std::to_string(i), i, {{10, 1}, {1000, 5 + .001 * i}}});
    const std::string svg = curve_chart(chart);
    EXPECT_EQ(xml_error(svg), "");
    std::vector<double> heights;
    for (size_t at = svg.find("text-anchor=\"start\""); at != std::string::npos;
         at = svg.find("text-anchor=\"start\"", at + 1)) {
        const size_t y = svg.rfind(" y=\"", at);
        heights.push_back(std::atof(svg.c_str() + y + 4));
    }
    ASSERT_EQ(heights.size(), 12u);
    for (size_t i = 1; i < heights.size(); ++i) EXPECT_GE(heights[i] - heights[i - 1], 14.9);
    EXPECT_EQ(curve_chart({"t", "x", "y", {{"one point", 0, {{1, 1}}}}}), "");
}

TEST(ReportPage, SaysAboutTheSameWithinTheSpread) {
    BenchReport report = sample_report();
    const auto same = count_of(report_page(report), "about the same");
    for (BenchRecord& r : report.records)
        if (r.suite == "accel" || r.suite == "quick") r.mrays_per_s = r.baseline.empty() ? 100 : 103;  // spreads are 5 %
    EXPECT_GE(count_of(report_page(report), "about the same"), same + 3);
    for (BenchRecord& r : report.records)
        if (r.suite == "accel" || r.suite == "quick") r.mrays_per_s = r.baseline.empty() ? 150 : 100;
    EXPECT_EQ(count_of(report_page(report), "about the same"), 0u);
}

TEST(ReportPage, NamesPercentiles) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) r.wall_ms.p95 = r.time_ms.p99 = 77.7;
    const std::string page = report_page(report);
    for (const char* name : {"p50", "p95", "p99", "77.7"}) EXPECT_GT(count_of(page, name), 0u) << name;
}

TEST(ReportPage, SaysWhyARunEndedEarly) {
    BenchReport report = sample_report();
    report.failure = "not enough memory <on the host>";
    const std::string page = report_page(report);
    EXPECT_NE(page.find("not enough memory &lt;on the host&gt;"), std::string::npos);
    EXPECT_EQ(xml_error(page), "");
}

}  // namespace
