// output_json.cpp -- records as JSON and back. One table of keys serves both ways, and CSV.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "bench/record_keys.hpp"
#include "bench/versus.hpp"

namespace clarity {
namespace {

constexpr const char* kStatus[] = {"ok", "refused", "failed", "skipped"};

// Six digits are more than any measurement has; whole numbers stay whole.
Json number(double value) {
    if (!std::isfinite(value)) return nullptr;
    if (value == std::floor(value) && std::fabs(value) < 1e15) return static_cast<int64_t>(value);
    const double scale = std::pow(10.0, 5 - std::floor(std::log10(std::fabs(value))));
    return std::isfinite(scale) && scale > 0 ? std::round(value * scale) / scale : value;
}

Json summary_json(const Summary& s) {
    if (s.n == 0) return nullptr;
    return {{"p50", number(s.median)},
            {"p95", s.p95 > 0 ? number(s.p95) : Json()},
            {"p99", s.p99 > 0 ? number(s.p99) : Json()},
            {"median", number(s.median)},  // the name of p50 in earlier versions
            {"q1", number(s.q1)},
            {"q3", number(s.q3)},
            {"min", number(s.min)},
            {"max", number(s.max)},
            {"spread", number(s.spread())},
            {"n", s.n}};
}

// What is withheld: all but how unsteady it was.
Json withheld_json(const Summary& s) {
    if (s.n == 0) return nullptr;
    return {{"spread", number(s.spread())}, {"n", s.n}};
}

Json analysis_json(const Analysis& a) {
    if (!a.present) return nullptr;
    return {{"nodes_per_ray", number(a.nodes_per_ray)},
            {"own_nodes_per_ray", number(a.own_nodes_per_ray)},
            {"leaf_tests_per_ray", number(a.leaf_tests_per_ray)},
            {"lanes_alive", number(a.lanes_alive)},
            {"warp_alive", number(a.warp_alive)},
            {"bytes_per_ray", number(a.bytes_per_ray)},
            {"bytes_shared", number(a.bytes_shared)},
            {"node_bytes", a.node_bytes}};
}

Json run_json(const BenchRun& run) {
    return {{"version", run.version},
            {"date", run.date},
            {"command", run.command},
            {"host_cpu", run.host_cpu},
            {"host_threads", run.host_threads},
            {"governor", run.governor.empty() ? Json() : Json(run.governor)},
            {"clock_mhz", {{"before", number(run.clock_mhz_before)}, {"after", number(run.clock_mhz_after)}}},
            {"load", {{"before", number(run.load_before)}, {"after", number(run.load_after)}}},
            {"max_spread", number(run.max_spread)},
            {"seconds", number(run.seconds)}};
}

std::string size_text(int w, int h) {
    return w > 0 ? std::to_string(w) + "x" + std::to_string(h) : std::string();
}

Json text_or_null(const std::string& text) {
    return text.empty() ? Json() : Json(text);
}

// What of `json` is there and of the right kind; null and missing: as it was.
void get(const Json& json, const char* key, double& to) {
    if (const auto at = json.find(key); at != json.end() && !at->is_null()) to = at->get<double>();
}
void get(const Json& json, const char* key, std::string& to) {
    if (const auto at = json.find(key); at != json.end() && !at->is_null()) to = at->get<std::string>();
}
template <class Whole>
void get_whole(const Json& json, const char* key, Whole& to) {
    if (const auto at = json.find(key); at != json.end() && !at->is_null()) to = at->get<Whole>();
}
Json part(const Json& json, const char* key) {
    const auto at = json.find(key);
    return at != json.end() && at->is_object() ? *at : Json::object();
}

void get_size(const Json& json, const char* key, int& w, int& h) {
    std::string text;
    get(json, key, text);
    if (!text.empty() && std::sscanf(text.c_str(), "%dx%d", &w, &h) != 2)
        throw Error(Exit::failed, std::string(key) + ": `" + text + "` is no size such as 4x4");
}

Summary read_summary(const Json& json) {
    Summary s;
    get(json, "median", s.median);  // records of earlier versions
    get(json, "p50", s.median);
    get(json, "p95", s.p95);
    get(json, "p99", s.p99);
    get(json, "q1", s.q1);
    get(json, "q3", s.q3);
    get(json, "min", s.min);
    get(json, "max", s.max);
    get_whole(json, "n", s.n);
    // Of what was withheld only the spread is known: it is kept.
    if (json.contains("spread") && !json.contains("median") && !json.contains("p50")) {
        s.median = s.q1 = s.q3 = 1;
        get(json, "spread", s.q3);
        s.q3 += 1;
    }
    return s;
}

Analysis read_analysis(const Json& json) {
    Analysis a;
    a.present = !json.empty();
    get(json, "nodes_per_ray", a.nodes_per_ray);
    get(json, "own_nodes_per_ray", a.own_nodes_per_ray);
    get(json, "leaf_tests_per_ray", a.leaf_tests_per_ray);
    get(json, "lanes_alive", a.lanes_alive);
    get(json, "warp_alive", a.warp_alive);
    get(json, "bytes_per_ray", a.bytes_per_ray);
    get(json, "bytes_shared", a.bytes_shared);
    get_whole(json, "node_bytes", a.node_bytes);
    return a;
}

Json parts_json(const Parts& parts) {
    if (parts.empty()) return nullptr;
    Json json = Json::array();  // an order that an object would not keep
    for (const auto& [name, ms] : parts) json.push_back({{"part", name}, {"ms", number(ms)}});
    return json;
}

Parts read_parts(const Json& json, const char* key) {
    Parts parts;
    const auto at = json.find(key);
    if (at != json.end() && at->is_array())
        for (const Json& one : *at) {
            parts.emplace_back();
            get(one, "part", parts.back().first);
            get(one, "ms", parts.back().second);
        }
    return parts;
}

Json versus_json(const BenchRecord& r, const std::vector<VersusMean>& means) {
    const VersusMean* mean = mean_of(means, r);
    if (!mean) return nullptr;
    return {{"peer", r.versus.peer},
            {"ratio", number(r.versus.ratio)},
            {"spread", number(r.versus.spread)},
            {"bytes_ratio", r.versus.bytes_ratio > 0 ? number(r.versus.bytes_ratio) : Json()},
            {"geometric_mean", number(mean->mean)},
            {"least", number(mean->least)},
            {"least_scene", mean->least_scene},
            {"rows", mean->rows}};
}

BenchRun read_run(const Json& json) {
    BenchRun run;
    get(json, "version", run.version);
    get(json, "date", run.date);
    get(json, "command", run.command);
    get(json, "host_cpu", run.host_cpu);
    get_whole(json, "host_threads", run.host_threads);
    get(json, "governor", run.governor);
    get(part(json, "clock_mhz"), "before", run.clock_mhz_before);
    get(part(json, "clock_mhz"), "after", run.clock_mhz_after);
    get(part(json, "load"), "before", run.load_before);
    get(part(json, "load"), "after", run.load_after);
    get(json, "max_spread", run.max_spread);
    get(json, "seconds", run.seconds);
    return run;
}

BenchRecord read_record(const Json& json) {
    BenchRecord r;
    get(json, "suite", r.suite);
    get(json, "case", r.case_name);
    get(json, "scene", r.scene);
    get(json, "measure", r.measure);
    get(json, "variant", r.variant);
    get(json, "peer", r.peer);
    get(json, "device", r.device);
    get(json, "device_id", r.device_id);
    get(json, "driver", r.driver);
    get_whole(json, "device_clock_mhz", r.device_clock_mhz);
    get_whole(json, "threads", r.threads);
    get(json, "accel", r.accel);
    get(json, "accel_params", r.accel_params);
    get(json, "tracer", r.tracer);
    get_whole(json, "depth", r.depth);
    get_size(json, "packet", r.packet_w, r.packet_h);
    get_whole(json, "lanes", r.lanes);
    get_whole(json, "ray_slots", r.ray_slots);
    get_size(json, "size", r.width, r.height);
    get_whole(json, "triangles", r.triangles);
    get_whole(json, "primitives", r.primitives);
    std::string status;
    get(json, "status", status);
    const auto found = std::find(std::begin(kStatus), std::end(kStatus), status);
    if (found == std::end(kStatus))
        throw Error(Exit::failed, "status: `" + status + "` is none of ok, refused, failed, skipped");
    r.status = static_cast<RowStatus>(found - std::begin(kStatus));
    get(json, "why", r.why);
    r.time_ms = read_summary(part(json, "time_ms"));
    r.wall_ms = read_summary(part(json, "wall_ms"));
    get(json, "fps", r.fps);
    const Json rays = part(json, "rays");
    get_whole(rays, "primary", r.rays_primary);
    get_whole(rays, "shadow", r.rays_shadow);
    get_whole(rays, "secondary", r.rays_secondary);
    get_whole(json, "dropped_rays", r.rays_dropped);
    get_whole(json, "hits", r.hits);
    get(json, "mrays_per_s", r.mrays_per_s);
    get(json, "build_ms", r.build_ms);
    get(json, "pack_ms", r.pack_ms);
    get(json, "compile_ms", r.compile_ms);
    get(json, "mtris_per_s", r.mtris_per_s);
    get(json, "bytes_per_triangle", r.bytes_per_triangle);
    get_whole(json, "accel_bytes", r.accel_bytes);
    get_whole(json, "nodes", r.nodes);
    get(json, "sah_cost", r.sah_cost);
    get(part(json, "versus"), "peer", r.versus.peer);
    get(part(json, "versus"), "ratio", r.versus.ratio);
    get(part(json, "versus"), "spread", r.versus.spread);
    get(part(json, "versus"), "bytes_ratio", r.versus.bytes_ratio);
    r.parts_ms = read_parts(json, "parts_ms");
    r.within_ms = read_parts(json, "within_ms");
    get(json, "parts_error_ms", r.parts_error_ms);
    r.analysis = read_analysis(part(json, "analysis"));
    const Json kernels = part(json, "kernels_ms");
    for (const auto& [name, ms] : kernels.items()) r.kernels_ms.emplace_back(name, ms.get<double>());
    return r;
}

bool same_run(const BenchRun& a, const BenchRun& b) {
    return run_json(a) == run_json(b);
}

}  // namespace

Json record_json(const BenchReport& report, const BenchRecord& r) {
    const bool shown = r.status == RowStatus::ok;
    const auto figure = [&](double value) { return shown && value > 0 ? number(value) : Json(); };
    const auto times = [&](const Summary& s) { return shown ? summary_json(s) : withheld_json(s); };
    Json json;
    json["suite"] = r.suite;
    json["case"] = r.case_name;
    json["scene"] = r.scene;
    json["measure"] = r.measure;
    json["variant"] = r.variant;
    json["peer"] = text_or_null(r.peer);
    json["device"] = r.device;
    json["device_id"] = r.device_id;
    json["driver"] = text_or_null(r.driver);
    json["device_clock_mhz"] = r.device_clock_mhz > 0 ? Json(r.device_clock_mhz) : Json();
    json["threads"] = r.threads;
    json["accel"] = text_or_null(r.accel);
    json["accel_params"] = text_or_null(r.accel_params);
    json["tracer"] = text_or_null(r.tracer);
    json["depth"] = r.depth > 0 ? Json(r.depth) : Json();
    json["packet"] = text_or_null(size_text(r.packet_w, r.packet_h));
    json["lanes"] = r.lanes > 0 ? Json(r.lanes) : Json();
    json["ray_slots"] = r.ray_slots > 0 ? Json(r.ray_slots) : Json();
    json["size"] = text_or_null(size_text(r.width, r.height));
    json["triangles"] = r.triangles;
    json["primitives"] = r.primitives;
    json["status"] = kStatus[static_cast<int>(r.status)];
    json["why"] = text_or_null(r.why);
    json["time_ms"] = times(r.time_ms);
    json["wall_ms"] = r.wall_ms.median > 0 ? times(r.wall_ms) : Json();
    json["frame_ms"] = r.measure == "frame" ? json["time_ms"] : Json();
    json["fps"] = figure(r.fps);
    json["rays"] =
        shown ? Json{{"primary", r.rays_primary}, {"shadow", r.rays_shadow}, {"secondary", r.rays_secondary}} : Json();
    json["dropped_rays"] = shown ? Json(r.rays_dropped) : Json();
    json["hits"] = shown ? Json(r.hits) : Json();
    json["mrays_per_s"] = figure(r.mrays_per_s);
    json["build_ms"] = figure(r.build_ms);
    json["pack_ms"] = figure(r.pack_ms);
    json["compile_ms"] = figure(r.compile_ms);
    json["mtris_per_s"] = figure(r.mtris_per_s);
    json["bytes_per_triangle"] = figure(r.bytes_per_triangle);
    json["accel_bytes"] = figure(double(r.accel_bytes));
    json["nodes"] = figure(double(r.nodes));
    json["sah_cost"] = figure(r.sah_cost);
    json["versus"] = shown ? versus_json(r, versus_means(report)) : Json();
    json["analysis"] = shown ? analysis_json(r.analysis) : Json();
    json["parts_ms"] = shown ? parts_json(r.parts_ms) : Json();
    json["within_ms"] = shown ? parts_json(r.within_ms) : Json();
    json["parts_error_ms"] = shown && !r.parts_ms.empty() ? number(r.parts_error_ms) : Json();
    json["kernels_ms"] = nullptr;
    if (shown && !r.kernels_ms.empty()) json["kernels_ms"] = Json::object();
    if (shown)
        for (const auto& [name, ms] : r.kernels_ms) json["kernels_ms"][name] = number(ms);
    json["run"] = run_json(report.run_of(r));
    return json;
}

std::string bench_json(const BenchReport& report) {
    Json list = Json::array();
    for (const BenchRecord& record : report.records) list.push_back(record_json(report, record));
    return list.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bench_json_row(const BenchReport& report, const BenchRecord& record) {
    // The list "[\n {...}\n]" without its brackets.
    const std::string list = Json::array({record_json(report, record)}).dump(1, ' ', false, Json::error_handler_t::replace);
    return list.substr(2, list.size() - 4);
}

BenchReport read_bench_json(const std::string& text) {
    BenchReport report;
    size_t at = 0;
    try {
        Json list = Json::parse(text, nullptr, false);
        if (list.is_discarded()) list = Json::parse(text + "\n]", nullptr, false);  // of a run that was killed
        if (list.is_discarded()) list = Json::parse(text);                          // says where the text is wrong
        if (!list.is_array()) throw Error(Exit::failed, "expected a list of records, as `clarity bench --json` writes it");
        for (; at < list.size(); ++at) {
            BenchRecord record = read_record(list[at]);
            const BenchRun run = read_run(part(list[at], "run"));
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

}  // namespace clarity
