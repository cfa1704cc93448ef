#include "tools/bench/report/report.hpp"

#include <filesystem>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/output/record_fields.hpp"

namespace clarity::bench {
namespace {

// Made by cmake: page.html, page.js, and chart.min.js of Debian's libjs-chart.js.
struct PageFile {
    const char *name, *text;
};
constexpr PageFile kFiles[] = {
#include "report.inc"
};

std::string text_of(const std::string& name) {
    for (const PageFile& file : kFiles)
        if (std::filesystem::path(file.name).filename() == name) return file.text;
    throw Error(Exit::failed, "this build holds no " + name + " for the report");
}

// How the page names the statistics of a struct: [{key, title, unit, meaning, scale}] of those that have a title.
template <class Owner>
Json looks_of(const Fields<Owner>& fields) {
    Json looks = Json::array();
    const auto text = [](const char* words) { return words ? Json(words) : Json(); };
    for (const Field<Owner>& field : fields)
        if (field.look.title)
            looks.push_back({{"key", field.key},
                             {"title", field.look.title},
                             {"unit", text(field.look.unit)},
                             {"meaning", text(field.look.meaning)},
                             {"scale", field.look.scale}});
    return looks;
}

// The page's data: {records, runs, command, notes, interrupted, failure, looks}. A record is as in bench.json, without its run.
// A run that only joins earlier runs has no date, and is left out.
Json page_data(const BenchReport& report) {
    Json data = {{"records", Json::array()}, {"runs", Json::array()}};
    for (const BenchRecord& r : report.records)
        data["records"].push_back(write_fields(record_fields(), r, r.status == RowStatus::ok));
    if (!report.run.date.empty()) data["runs"].push_back(write_fields(run_fields(), report.run));
    for (const BenchRun& run : report.joined) data["runs"].push_back(write_fields(run_fields(), run));
    data["command"] = report.run.command;
    data["notes"] = report.notes;
    data["interrupted"] = report.interrupted;
    data["failure"] = report.failure;
    Json titles = Json::object();
    for (const Field<BenchRecord>& field : record_fields())
        if (field.look.title) titles[field.key] = field.look.title;
    data["looks"] = {{"analysis", looks_of(analysis_fields())}, {"times", looks_of(summary_fields())}, {"record", titles}};
    return data;
}

void replace_slot(std::string& page, const std::string& slot, const std::string& text) {
    const std::string mark = "{{" + slot + "}}";
    page.replace(page.find(mark), mark.size(), text);
}

}  // namespace

std::string report_page(const BenchReport& report) {
    // In the data, `<` is written as an escape, so that no name can end the script element.
    std::string data;
    for (const char c : page_data(report).dump(-1, ' ', false, Json::error_handler_t::replace))
        c == '<' ? data += "\\u003c" : data += c;
    std::string page = text_of("page.html");
    replace_slot(page, "chart.js", text_of("chart.min.js"));
    replace_slot(page, "page.js", text_of("page.js"));
    replace_slot(page, "data", data);
    return page;
}

void write_report(const std::string& folder, const BenchReport& report) {
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder))
        throw Error(Exit::failed, folder + ": cannot make this folder for the report (" +
                                      (error ? error.message() : "a file of that name is in the way") +
                                      "); name another with --report");
    const fs::path base(folder);
    write_text_file((base / "bench.json").string(), bench_json(report));
    write_text_file((base / "bench.csv").string(), bench_csv(report));
    write_text_file((base / "index.html").string(), report_page(report));
}

}  // namespace clarity::bench
