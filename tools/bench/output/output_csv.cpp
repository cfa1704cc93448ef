// output_csv.cpp -- records as CSV (RFC 4180), with the keys of JSON; nested keys are joined with dots.
#include <algorithm>

#include "tools/bench/output/record_fields.hpp"

namespace clarity::bench {
namespace {

std::string kernels_text(const Json& kernels) {
    std::string text;
    if (kernels.is_object())
        for (const auto& [name, ms] : kernels.items()) text += (text.empty() ? "" : "; ") + name + " " + ms.dump();
    return text;
}

std::string parts_text(const Json& parts) {
    std::string text;
    if (parts.is_array())
        for (const Json& part : parts)
            text += (text.empty() ? "" : "; ") + part.at("part").get<std::string>() + " " + part.at("ms").dump();
    return text;
}

// Errors by samples: "1 0.25; 4 0.125".
std::string points_text(const Json& points) {
    std::string text;
    for (const Json& point : points)
        text += (text.empty() ? "" : "; ") + point.at("samples").dump() + " " + point.at("rmse").dump();
    return text;
}

// Values by their JSON pointers, "/run/clock_mhz/before".
Json flat(const BenchReport& report, const BenchRecord& record) {
    Json json = record_json(report, record);
    json["kernels_ms"] = kernels_text(json["kernels_ms"]);
    for (const char* key : {"parts_ms", "within_ms"}) json[key] = parts_text(json[key]);
    if (json["light"].is_object()) json["light"]["points"] = points_text(json["light"]["points"]);
    return json.flatten();
}

// The columns: all paths of a record which has every member, so that they do not depend on the records to be written.
std::vector<std::string> columns() {
    BenchReport report;
    BenchRecord full;
    full.measure = "frame";
    full.time_ms = full.wall_ms = {1, 1, 1, 1, 1, 1, 1, 1};
    full.analysis.present = true;
    full.speedup = {"embree", 1, 1, 1};
    full.light.sampler = "sobol";
    report.records.push_back(full);
    std::vector<std::string> paths;
    const Json json = flat(report, full);
    for (auto at = json.begin(); at != json.end(); ++at) paths.push_back(at.key());
    return paths;
}

std::string field(const Json& value) {
    if (value.is_null() || value.is_object()) return {};
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace

std::string bench_csv(const BenchReport& report) {
    const std::vector<std::string> paths = columns();
    std::string text;
    for (const std::string& path : paths) {
        std::string name = path.substr(1);
        std::replace(name.begin(), name.end(), '/', '.');
        text += (text.empty() ? "" : ",") + name;
    }
    text += "\r\n";
    for (const BenchRecord& record : report.records) {
        const Json json = flat(report, record);
        for (size_t i = 0; i < paths.size(); ++i) {
            if (i > 0) text += ",";
            if (const auto at = json.find(paths[i]); at != json.end()) text += field(*at);
        }
        text += "\r\n";
    }
    return text;
}

}  // namespace clarity::bench
