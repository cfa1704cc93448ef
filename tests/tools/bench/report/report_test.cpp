// report_test.cpp -- the page of the bench: it loads nothing from the network, and shows every figure. What it shows is read
// from the document that Chromium has made of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/report/report.hpp"
#include "tools/bench/report/sample.hpp"

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

namespace {

size_t count_of(const std::string& text, const std::string& what) {
    size_t n = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
    return n;
}

bool has_chromium() {
    return std::system("command -v chromium >/dev/null 2>&1") == 0;
}

// What Chromium prints for the page; `options` say what that is.
std::string by_chromium(const BenchReport& report, const Scratch& scratch, const std::string& options) {
    const std::string file = scratch.path("index.html");
    std::ofstream(file) << report_page(report);
    const std::string command =
        "timeout 300 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir='" +
        scratch.path("profile") + "' --virtual-time-budget=5000 " + options + " 'file://" + file + "' 2>/dev/null";
    std::string out;
    if (FILE* pipe = popen(command.c_str(), "r")) {
        char piece[65536];
        for (size_t n; (n = fread(piece, 1, sizeof piece, pipe)) > 0;) out.append(piece, n);
        pclose(pipe);
    }
    return out;
}

// The elements that the script has made, as HTML.
std::string shown(const BenchReport& report) {
    const Scratch scratch;
    const std::string page = by_chromium(report, scratch, "--dump-dom");
    const size_t body = page.rfind("</script>");
    return body == std::string::npos ? std::string() : page.substr(body);
}

class ReportShown : public testing::Test {
 protected:
    void SetUp() override {
        if (!has_chromium()) GTEST_SKIP() << "chromium is not installed: what the page shows is not tested";
    }
};

TEST(ReportPage, IsSelfContained) {
    std::string page = report_page(sample_report());
    const size_t library = page.find("* Chart.js"), end = page.find("</script>", library);
    ASSERT_NE(library, std::string::npos);
    page.erase(library, end - library);
    for (const char* foreign : {"src=", "@import", "url(", "<link", "http://", "https://", "{{"})
        EXPECT_EQ(count_of(page, foreign), 0u) << foreign << ": the page must be self-contained";
    EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
    EXPECT_NE(page.find("@media print"), std::string::npos);
    EXPECT_NE(page.find("<noscript>"), std::string::npos);
}

TEST_F(ReportShown, EveryThesisChartWithItsAxisEnd) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) r.wall_ms.p95 = r.time_ms.p99 = 77.7;
    const std::string page = shown(report);
    for (const char* end :
         {"ends at 40 fps", "ends at 100 fps", "ends at 35 fps", "ends at 14 fps", "ends at 7 fps", "ends at 0.3 fps"})
        EXPECT_GE(count_of(page, end), 1u) << end;
    for (const char* id : {"thesis", "packets", "structures", "scale", "light", "analysis", "left-out", "machine"}) {
        EXPECT_EQ(count_of(page, std::string("<h2 id=\"") + id + "\""), 1u) << id;
        EXPECT_EQ(count_of(page, std::string("href=\"#") + id + "\""), 1u) << id;
    }
    EXPECT_EQ(count_of(page, ">Embree 4.3.3<"), 1u) << "which version of the peers was measured";
    EXPECT_EQ(count_of(page, "<canvas"), 5u + 2)
        << "a chart of curves for each kind of rays, and for builds; two of errors of light";
    for (const char* name : {"p50", "p95", "p99", "undefined", "NaN"})
        EXPECT_EQ(count_of(page, name) > 0, name[0] == 'p') << name;
    // Test 6 at 4 steps, computed by hand: 6 * 1.6^5 ms a step, all in 2 % and 0.3 ms more. The bar shows three digits.
    char fps[16];
    std::snprintf(fps, sizeof fps, ">%.3g<", 1000 / (6 * std::pow(1.6, 5) * 4 * 1.02 + .3));
    EXPECT_GE(count_of(page, fps), 1u) << fps;
    // Curves are drawn, and name their points for readers that do not see.
    EXPECT_GE(count_of(page, "aria-label=\"Camera rays, million rays a second over triangles: bvh2, CPU "), 1u);
    EXPECT_GT(count_of(page, "style=\"width:100.00%;background:var(--c"), 10u) << "the longest bar of each chart fills it";
    EXPECT_GT(count_of(page, ", logarithmic<"), 0u) << "of tests with `then` far below `now`";
}

// The speed-ups over the axes' ends, computed by hand: test n takes 6 * 1.6^(n - 1) ms a step, all in 2 % and .3 ms more.
TEST_F(ReportShown, TheGains) {
    const auto gain = [](int test, double end) { return 1000 / (6 * std::pow(1.6, test - 1) * 4 * 1.02 + .3) / end; };
    char range[96];
    std::snprintf(range, sizeof range, "<b>%.3f to %.1f x</b><span>CPU: the ends", gain(2, 100), gain(6, .3));
    EXPECT_NE(shown(sample_report()).find(range), std::string::npos) << range;
}

TEST_F(ReportShown, RefusedRowsWithoutFigures) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) {
        r.status = RowStatus::refused;
        r.why = "the middle half spreads";
    }
    const std::string page = shown(report);
    EXPECT_EQ(count_of(page, "<i class=\"bar"), 0u);
    EXPECT_EQ(count_of(page, "<canvas"), 0u);
    EXPECT_GT(count_of(page, ">refused<"), 10u);
}

TEST_F(ReportShown, SuitesThatAreEmpty) {
    BenchReport nothing;
    nothing.failure = "not enough memory <on the host>";
    nothing.interrupted = true;
    const std::string page = shown(nothing);
    for (const char* text : {"Nothing was measured", "interrupted", "not enough memory &lt;on the host&gt;"})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    nothing.records.resize(3);  // of no suite, without figures
    EXPECT_NE(shown(nothing).find("All 3 rows"), std::string::npos);
}

// A run which measures nothing and only joins earlier runs.
TEST_F(ReportShown, JoinedRuns) {
    BenchReport report = sample_report();
    report.joined = {report.run, report.run};
    report.joined[1].host_cpu = "another processor";
    for (BenchRun& run : report.joined) run.max_spread = .1;
    report.run = BenchRun();
    report.run.command = "clarity bench --join a --join b";
    for (BenchRecord& r : report.records) r.run = r.device[0] == 'N' ? 2 : 1;
    const std::string page = shown(report);
    EXPECT_EQ(count_of(page, "another processor"), 2u) << "at the head and in the table of runs";
    EXPECT_EQ(count_of(page, ", 0 threads"), 0u);
    EXPECT_NE(page.find("This page joins 2 runs"), std::string::npos);
    EXPECT_NE(page.find("stays above 10.0&nbsp;%"), std::string::npos);
}

TEST_F(ReportShown, NamesWithMarkupAsText) {
    const std::string hostile[] = {
        "</title></script><script>document.title = 'taken'</script><!--",
        "a\"b'c&d<e>",
        std::string("nul\0in it", 9),
        "\x1b[31mred\xff\xc0\xaf\xed\xa0\x80",
        "]]>-->",
        "a name of a scene that is far longer than any label would like to be, \xe6\xb5\xb7\xe9\xba\xbc"};
    std::string name;
    for (const std::string& one : hostile) name += one;
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) {
        for (std::string* text : {&r.scene, &r.variant, &r.device, &r.driver, &r.case_name, &r.accel, &r.accel_params, &r.why})
            *text += name;
        if (!r.baseline.empty()) r.baseline += name;
    }
    for (std::string* text : {&report.run.command, &report.run.host_cpu, &report.run.date, &report.run.governor}) *text = name;
    report.notes.push_back(name);
    const std::string page = shown(report);
    EXPECT_EQ(count_of(page, "<script"), 0u);
    EXPECT_GT(count_of(page, "a\"b'c&amp;d&lt;e&gt;"), 0u);
    EXPECT_EQ(page.find('\x1b'), std::string::npos);
    EXPECT_EQ(count_of(page, "<h2 id=\"machine\">"), 1u) << "the page is whole";
}

TEST_F(ReportShown, ErrorsOfLightOverSecondsAndSamples) {
    const std::string page = shown(sample_report());
    EXPECT_EQ(count_of(page, "RMSE over seconds: "), 1u);
    EXPECT_EQ(count_of(page, "RMSE over samples a pixel: independent, CPU 0.300 at 1.00"), 1u) << "the whole curve as text";
    EXPECT_GE(count_of(page, "-0.717"), 1u);
    EXPECT_GE(count_of(page, "not told"), 4u) << "registers and spills of two rows";
    EXPECT_EQ(count_of(page, "path, cold"), 2u) << "in its table and in that of all rows";
}

TEST_F(ReportShown, NanAndInfinityAreNoNumbers) {
    BenchReport report = sample_report();
    for (BenchRecord& r : report.records) {
        r.fps = NAN;
        r.mrays_per_s = INFINITY;
        r.analysis.nodes_per_ray = -1;
        r.time_ms.median = 0;
    }
    const std::string page = shown(report);
    EXPECT_EQ(count_of(page, "<h2 id=\"machine\">"), 1u) << "the page is whole";
    EXPECT_EQ(count_of(page, "NaN") + count_of(page, "Infinity") + count_of(page, "undefined"), 0u);
}

TEST_F(ReportShown, AboutTheSameWithinTheSpread) {
    BenchReport report = sample_report();
    const auto set = [&](double ours, double theirs) {
        for (BenchRecord& r : report.records)
            if (r.suite == "accel" || r.suite == "quick") r.mrays_per_s = r.baseline.empty() ? ours : theirs;
        return count_of(shown(report), "about the same");
    };
    const size_t same = set(100, 103);  // spreads are 5 %
    EXPECT_GE(same, 3u);
    EXPECT_EQ(set(150, 100), 0u);
}

// The library is inside and draws: a picture of a page with curves is no picture of an empty page.
TEST_F(ReportShown, CurvesAreDrawn) {
    const Scratch scratch;
    BenchReport report = sample_report();
    report.records.erase(
        std::remove_if(report.records.begin(), report.records.end(), [](const BenchRecord& r) { return r.suite != "scale"; }),
        report.records.end());
    const std::string picture = scratch.path("page.png");
    by_chromium(report, scratch, "--window-size=1200,2400 --screenshot='" + picture + "'");
    ASSERT_TRUE(std::filesystem::exists(picture));
    EXPECT_GT(std::filesystem::file_size(picture), 100000u);
    if (const char* keep = std::getenv("CLARITY_KEEP_REPORT"))
        std::filesystem::copy_file(picture, std::string(keep) + "/curves.png",
                                   std::filesystem::copy_options::overwrite_existing);
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
    expect_error([&] { write_report(file, sample_report()); }, {file}, Exit::failed);
}

}  // namespace
