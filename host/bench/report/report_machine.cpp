// report_machine.cpp -- what was left out, the machine, the method of measuring, and all figures.
#include <algorithm>
#include <set>

#include "bench/output/record_fields.hpp"
#include "bench/report/report_markup.hpp"
#include "bench/report/report_sections.hpp"

namespace clarity::bench {
namespace {

const char* status_word(RowStatus status) {
    switch (status) {
        case RowStatus::ok:
            return "ok";
        case RowStatus::refused:
            return "refused";
        case RowStatus::failed:
            return "failed";
        case RowStatus::skipped:
            return "skipped";
    }
    return "";
}

std::string runs_of(const BenchReport& report) {
    MarkupTable table({"run", "date", "version", "command", "processor", "threads", "governor", "clock MHz", "load", "seconds"},
                      5);
    const auto add = [&](const BenchRun& run, const std::string& name) {
        const std::string clock =
            run.clock_mhz_before > 0 ? figure(run.clock_mhz_before) + " to " + figure(run.clock_mhz_after) : "not readable";
        table.add({name, run.date, run.version, run.command, run.host_cpu, std::to_string(run.host_threads),
                   run.governor.empty() ? "not readable" : run.governor, clock,
                   figure(run.load_before) + " to " + figure(run.load_after), figure(run.seconds)});
    };
    const std::vector<const BenchRun*> runs = measured_runs(report);
    for (size_t i = 0; i < runs.size(); ++i) add(*runs[i], std::to_string(i + 1));
    return table.markup();
}

std::string devices_of(const BenchReport& report, const SeriesNames& names) {
    MarkupTable table({"in the charts", "device", "id", "driver", "compute units"}, 4);
    std::set<std::string> seen;
    for (const BenchRecord& r : report.records)
        if (r.baseline.empty() && seen.insert(r.device + "\n" + r.driver).second)
            table.add({names.device(r), r.device, r.device_id, r.driver, std::to_string(r.threads)});
    return table.markup();
}

std::string rows_of(const BenchReport& report, const SeriesNames& names) {
    constexpr const char* kKeys[] = {"fps", "mrays_per_s", "rays"};
    std::vector<std::string> head = {"suite", "case", "series", "structure", "state", "takes"};
    for (const char* clock : {"kernels ", "all in "})
        for (const Field<Summary>& field : summary_fields())
            if (field.look.title) head.push_back(std::string(clock) + field.look.title + ", " + field.look.unit);
    for (const char* key : kKeys) head.push_back(record_field(key).look.title);
    MarkupTable table(head, 5);
    for (const BenchRecord& r : report.records) {
        const bool shown = has_figures(r);
        std::vector<std::string> cells = {r.suite,
                                          r.case_name,
                                          names.label(r),
                                          r.accel + (r.accel_params.empty() ? "" : "," + r.accel_params),
                                          status_word(r.status),
                                          shown ? std::to_string(std::max(r.time_ms.n, r.wall_ms.n)) : ""};
        for (const Summary* times : {&r.time_ms, &r.wall_ms})
            for (const Field<Summary>& field : summary_fields())
                if (field.look.title) cells.push_back(figure_or_nothing(shown ? field.number(*times) : 0));
        for (const char* key : kKeys) cells.push_back(figure_or_nothing(record_field(key).number(r)));
        table.add(cells);
    }
    return table.markup();
}

}  // namespace

std::string left_out_section(const BenchReport& report, const SeriesNames& names) {
    MarkupTable table({"", "suite", "case", "series", "why"}, 5);
    for (const BenchRecord& r : report.records)
        if (r.status != RowStatus::ok) table.add({status_word(r.status), r.suite, r.case_name, names.label(r), r.why});
    for (const std::string& note : report.notes) table.add({"left out", "", "", "", note});
    std::string out = table.markup();
    if (report.interrupted)
        out = "<p class=\"warn\">The run was interrupted. The page shows the rows which were complete by then.</p>\n" + out;
    if (!report.failure.empty())
        out = "<p class=\"warn\">" +
              escape_markup("The run ended early; the page shows the rows which were complete by then. The reason: " +
                            report.failure) +
              "</p>\n" + out;
    return out.empty() ? out : "<h2 id=\"left-out\">Left out</h2>\n" + out;
}

std::string machine_section(const BenchReport& report, const SeriesNames& names) {
    std::string out = "<h2 id=\"machine\">Machine and method</h2>\n" + runs_of(report) + devices_of(report, names);
    double max_spread = 0;
    const std::vector<const BenchRun*> runs = measured_runs(report);
    for (const BenchRun* run : runs) max_spread = std::max(max_spread, run->max_spread);
    out += paragraph(
        "A figure is the p50 (the median) of many repetitions after a warm-up. Figures of one chart and one run were measured "
        "interleaved, A B A B, so that a disturbance of the machine affects all alike. The spread is the interquartile range "
        "divided by the median. If it stays above " +
        percent_figure(max_spread) +
        " after further attempts, the row is refused instead of shown. Kernels are timed by the device's clock, \"all in\" "
        "by the host's. bench.json and bench.csv beside this page hold every figure.");
    if (runs.size() > 1)
        out += paragraph("This page joins " + std::to_string(runs.size()) +
                         " runs. Rows of different runs were not measured interleaved.");
    const std::string rows = rows_of(report, names);
    if (!rows.empty())
        out += "<details><summary>All " + std::to_string(report.records.size()) + " rows</summary>\n" + rows + "</details>\n";
    return out;
}

}  // namespace clarity::bench
