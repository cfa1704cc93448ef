// output_json.cpp -- writes records as JSON and reads them, by the table of record_fields.hpp.
#include "base/error.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/output/record_fields.hpp"
#include "tools/bench/output/speedup.hpp"

namespace clarity::bench {
namespace {

BenchRecord read_record(const Json& json) {
    if (!json.is_object() || !json.contains("status"))
        throw Error(Exit::failed, "it has no `status`; expected a record, as `clarity bench --json` writes it");
    BenchRecord r;
    read_fields(json, record_fields(), r);
    r.analysis.present = json.contains("analysis") && json["analysis"].is_object();
    return r;
}

BenchRun read_run(const Json& json) {
    BenchRun run;
    if (const auto at = json.find("run"); at != json.end()) read_fields(*at, run_fields(), run);
    return run;
}

bool same_run(const BenchRun& a, const BenchRun& b) {
    return write_fields(run_fields(), a) == write_fields(run_fields(), b);
}

// Adds the means over all scenes of the suite to the speed-up of one row.
void add_means(Json& speedup, const SpeedupMean& mean) {
    speedup["geometric_mean"] = number_json(mean.mean);
    speedup["least"] = number_json(mean.least);
    speedup["least_scene"] = mean.least_scene;
    speedup["rows"] = mean.rows;
}

}  // namespace

Json record_json(const BenchReport& report, const BenchRecord& r) {
    Json json = write_fields(record_fields(), r, r.status == RowStatus::ok);
    if (json["versus"].is_object())
        if (const std::vector<SpeedupMean> means = speedup_means(report); const SpeedupMean* mean = mean_of(means, r))
            add_means(json["versus"], *mean);
    json["run"] = write_fields(run_fields(), report.run_of(r));
    return json;
}

std::string bench_json(const BenchReport& report) {
    Json list = Json::array();
    for (const BenchRecord& record : report.records) list.push_back(record_json(report, record));
    return list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bench_json_row(const BenchReport& report, const BenchRecord& record) {
    // The text is "[\n {...}\n]"; removes the brackets and their newlines.
    const std::string list = Json::array({record_json(report, record)}).dump(1, ' ', false, Json::error_handler_t::replace);
    return list.substr(2, list.size() - 4);
}

BenchReport read_bench_json(const std::string& text) {
    BenchReport report;
    size_t at = 0;
    try {
        Json list = Json::parse(text, nullptr, false);
        if (list.is_discarded())
            list = Json::parse(text + "\n]", nullptr, false);  // the list lacks its end: the run was killed
        if (list.is_discarded()) list = Json::parse(text);     // throws, with the position of the error
        if (!list.is_array()) throw Error(Exit::failed, "expected a list of records, as `clarity bench --json` writes it");
        for (; at < list.size(); ++at) {
            BenchRecord record = read_record(list[at]);
            const BenchRun run = read_run(list[at]);
            if (at == 0) report.run = run;
            while (!same_run(report.run_of(record), run))
                if (record.run++ == report.joined.size()) report.joined.push_back(run);
            report.records.push_back(std::move(record));
        }
    } catch (const Json::exception& e) {
        throw Error(Exit::failed, "record " + std::to_string(at) + ": " + e.what());
    } catch (const Error& e) {
        throw Error(Exit::failed, "record " + std::to_string(at) + ": " + e.what());
    }
    return report;
}

}  // namespace clarity::bench
