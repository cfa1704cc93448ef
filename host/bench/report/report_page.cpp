#include "bench/report/report_page.hpp"

#include "bench/report/report_markup.hpp"
#include "bench/report/report_sections.hpp"
#include "bench/report/report_style.hpp"

namespace clarity::bench {

std::string report_page(const BenchReport& report) {
    const SeriesNames names(report);
    const struct {
        const char *id, *link;
        std::string markup;
    } sections[] = {{"thesis", "Then and now", thesis_section(report, names)},
                    {"packets", "Packets", packets_section(report, names)},
                    {"structures", "Structures and peers", structures_section(report, names)},
                    {"scale", "How cost grows", scale_section(report, names)},
                    {"analysis", "Why", analysis_section(report, names)},
                    {"left-out", "Left out", left_out_section(report, names)},
                    {"machine", "Machine and method", machine_section(report, names)}};
    std::string links, body;
    for (const auto& section : sections) {
        if (section.markup.empty()) continue;
        links += std::string("<a href=\"#") + section.id + "\">" + section.link + "</a> ";
        body += section.markup;
    }
    const std::vector<const BenchRun*> runs = measured_runs(report);
    std::string where;
    for (const BenchRun* run : runs)
        where += escape_markup(run->date + ", " + run->host_cpu + ", " + std::to_string(run->host_threads) +
                               " threads, Clarity " + run->version) +
                 "<br/>";
    const std::string title = "Clarity bench" + (runs.empty() ? std::string() : ", " + runs.front()->date);
    std::string out =
        "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<meta name=\"color-scheme\" "
        "content=\"light dark\"/>\n";
    out += "<title>" + escape_markup(title) + "</title>\n<style>" + kReportStyle +
           "</style>\n</head>\n<body>\n<h1>Clarity bench</h1>\n";
    out += "<p class=\"faint\">" + where + "<code>" + escape_markup(report.run.command) + "</code></p>\n<nav>" + links +
           "</nav>\n";
    if (report.records.empty()) out += paragraph("Nothing was measured.");
    return out + body + "</body>\n</html>\n";
}

}  // namespace clarity::bench
