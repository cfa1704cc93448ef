#include "tools/bench/output/record_fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

constexpr const char* kStatus[] = {"ok", "refused", "failed", "skipped"};

// A summary as JSON. If the row is not ok, only its spread and count are written: figures are withheld.
Json summary_json(const BenchRecord& r, const Summary& s) {
    if (s.n == 0) return nullptr;
    if (r.status != RowStatus::ok) return {{"spread", number_json(s.spread())}, {"n", s.n}};
    return write_fields(summary_fields(), s);
}

Summary read_summary(const Json& json) {
    Summary s;
    read_fields(json, summary_fields(), s);
    if (json.contains("spread") && !json.contains("median") && !json.contains("p50")) {
        s.median = s.q1 = 1;  // figures were withheld: make a summary of that spread
        s.q3 = 1 + json.at("spread").get<double>();
    }
    return s;
}

// A summary of times; null if it is 0, because rays are not timed by the host's clock.
Field<BenchRecord> times(const char* key, Summary BenchRecord::* member) {
    return {key, [=](const BenchRecord& r) { return (r.*member).median > 0 ? summary_json(r, r.*member) : Json(); },
            [=](const Json& json, BenchRecord& r) { r.*member = read_summary(json); }};
}

// A count, which does not depend on time: a row that is refused because its times are unsteady has it, too.
Field<BenchRecord> count_of(Field<BenchRecord> field) {
    field.figure = false;
    field.write = [write = field.write](const BenchRecord& r) {
        return r.status == RowStatus::ok || r.status == RowStatus::refused ? write(r) : Json();
    };
    return field;
}

// A size as "4x2"; null for 0x0.
Field<BenchRecord> size(const char* key, int BenchRecord::* w, int BenchRecord::* h) {
    return {key,
            [=](const BenchRecord& r) { return r.*w > 0 ? Json(std::to_string(r.*w) + "x" + std::to_string(r.*h)) : Json(); },
            [=](const Json& json, BenchRecord& r) {
                const std::string text = json.get<std::string>();
                if (std::sscanf(text.c_str(), "%dx%d", &(r.*w), &(r.*h)) != 2)
                    throw Error(Exit::failed, std::string(key) + ": `" + text + "` is not a size such as 4x4");
            }};
}

Field<BenchRecord> parts(const char* key, Parts BenchRecord::* member) {
    return figure_of<BenchRecord>({key,
                                   [=](const BenchRecord& r) {
                                       if ((r.*member).empty()) return Json();
                                       Json json = Json::array();  // an array keeps the order, an object would not
                                       for (const auto& [name, ms] : r.*member)
                                           json.push_back({{"part", name}, {"ms", number_json(ms)}});
                                       return json;
                                   },
                                   [=](const Json& json, BenchRecord& r) {
                                       for (const Json& one : json)
                                           (r.*member).emplace_back(one.at("part").get<std::string>(),
                                                                    one.at("ms").is_null() ? 0 : one.at("ms").get<double>());
                                   }});
}

// A struct within the record. present: tells whether there is anything to write.
template <class Part>
Field<BenchRecord> nested(const char* key, Part BenchRecord::* member, const Fields<Part>& (*fields)(),
                          bool (*present)(const Part&)) {
    return figure_of<BenchRecord>(
        {key, [=](const BenchRecord& r) { return present(r.*member) ? write_fields(fields(), r.*member) : Json(); },
         [=](const Json& json, BenchRecord& r) { read_fields(json, fields(), r.*member); }});
}

const Fields<Speedup>& versus_fields() {
    static const Fields<Speedup> fields = {plain("peer", &Speedup::baseline), plain("ratio", &Speedup::ratio),
                                           plain("spread", &Speedup::spread),
                                           unless_empty("bytes_ratio", &Speedup::bytes_ratio)};
    return fields;
}

const Fields<Played>& played_fields() {
    static const Fields<Played> fields = {plain("total_ms", &Played::total_ms),
                                          plain("update_ms", &Played::update_ms),
                                          plain("trace_ms", &Played::trace_ms),
                                          plain("builds", &Played::builds),
                                          plain("worst_cost_ratio", &Played::worst_cost_ratio),
                                          plain("to_best", &Played::to_best)};
    return fields;
}

const Fields<LightRun>& light_fields() {
    using Point = LightRun::Point;
    static const Fields<Point> of_point = {plain("samples", &Point::samples), plain("ms", &Point::ms),
                                           plain("rmse", &Point::rmse), plain("trimmed_rmse", &Point::trimmed_rmse),
                                           plain("relmse", &Point::relmse)};
    const auto if_told = [](const char* key, int LightRun::* member) {
        Field<LightRun> field = plain(key, member);
        field.write = [=](const LightRun& l) { return l.*member >= 0 ? Json(l.*member) : Json(); };
        return field;
    };
    static const Fields<LightRun> fields = {plain("sampler", &LightRun::sampler),
                                            plain("strategy", &LightRun::strategy),
                                            plain("reference", &LightRun::reference),
                                            unless_empty("msamples_per_s", &LightRun::msamples_per_s),
                                            plain("slope", &LightRun::slope),
                                            {"points",
                                             [](const LightRun& l) {
                                                 Json json = Json::array();
                                                 for (const Point& point : l.points)
                                                     json.push_back(write_fields(of_point, point));
                                                 return json;
                                             },
                                             [](const Json& json, LightRun& l) {
                                                 for (const Json& one : json)
                                                     read_fields(one, of_point, l.points.emplace_back());
                                             }},
                                            unless_empty("state_bytes", &LightRun::state_bytes),
                                            if_told("registers", &LightRun::registers),
                                            if_told("spilled_bytes", &LightRun::spilled_bytes)};
    return fields;
}

const Fields<BenchRecord>& rays_fields() {
    static const Fields<BenchRecord> fields = {plain("primary", &BenchRecord::rays_primary),
                                               plain("shadow", &BenchRecord::rays_shadow),
                                               plain("secondary", &BenchRecord::rays_secondary)};
    return fields;
}

Json status_json(const BenchRecord& r) {
    return kStatus[static_cast<int>(r.status)];
}

void read_status(const Json& json, BenchRecord& r) {
    const std::string word = json.get<std::string>();
    const auto found = std::find(std::begin(kStatus), std::end(kStatus), word);
    if (found == std::end(kStatus)) throw Error(Exit::failed, "status: `" + word + "` is none of ok, refused, failed, skipped");
    r.status = static_cast<RowStatus>(found - std::begin(kStatus));
}

Json kernels_json(const BenchRecord& r) {
    if (r.kernels_ms.empty()) return nullptr;
    Json json = Json::object();
    for (const auto& [name, ms] : r.kernels_ms) json[name] = number_json(ms);
    return json;
}

void read_kernels(const Json& json, BenchRecord& r) {
    for (const auto& [name, ms] : json.items()) r.kernels_ms.emplace_back(name, ms.is_null() ? 0 : ms.get<double>());
}

}  // namespace

Json number_json(double value) {
    if (!std::isfinite(value)) return nullptr;
    if (value == std::floor(value) && std::fabs(value) < 1e15) return static_cast<int64_t>(value);
    const double scale = std::pow(10.0, 5 - std::floor(std::log10(std::fabs(value))));
    return std::isfinite(scale) && scale > 0 ? std::round(value * scale) / scale : value;
}

const Fields<Summary>& summary_fields() {
    static const Fields<Summary> fields = {plain("p50", &Summary::median, {"p50", "p50", "ms"}),
                                           unless_empty("p95", &Summary::p95, {"p95", "p95", "ms"}),
                                           unless_empty("p99", &Summary::p99, {"p99", "p99", "ms"}),
                                           plain("median", &Summary::median),  // the name of p50 in earlier versions
                                           plain("q1", &Summary::q1, {"q1", "q1", "ms"}),
                                           plain("q3", &Summary::q3, {"q3", "q3", "ms"}),
                                           plain("min", &Summary::min),
                                           plain("max", &Summary::max),
                                           {"spread", [](const Summary& s) { return number_json(s.spread()); }, {}},
                                           plain("n", &Summary::n)};
    return fields;
}

const Fields<Analysis>& analysis_fields() {
    const auto percent = [](const char* column, const char* title, const char* unit, const char* meaning, bool zero = true) {
        return Look{column, title, unit, meaning, 100, 1, zero};
    };
    static const Fields<Analysis> fields = {
        plain("nodes_per_ray", &Analysis::nodes_per_ray,
              {"nodes/ray", "Nodes visited", "a ray, mean",
               "Every node costs a fetch from memory and a test of its volume, one after the other. A packet visits the nodes "
               "which any of its rays needs: a coherent packet visits few more than each ray alone, an incoherent one many "
               "more."}),
        plain("own_nodes_per_ray", &Analysis::own_nodes_per_ray, {"own"}),
        plain("boxes_per_ray", &Analysis::boxes_per_ray,
              {"boxes", "Boxes tested", "a ray, mean",
               "Tests of bounding boxes, or of other volumes. A node of a wide tree costs one fetch and a box for each child. "
               "Structures that part space test a plane a node instead, and no box but their own."}),
        unless_empty("reported", &Analysis::reported),
        plain("leaf_tests_per_ray", &Analysis::leaf_tests_per_ray,
              {"leaf tests", "Primitives tested", "a ray, mean",
               "Tests of triangles, spheres and polygons in the leaves. Tight volumes keep them near one. Bounding spheres are "
               "mostly empty around a triangle, so that more rays reach the leaves. Spheres without a tree above them are all "
               "tested."}),
        plain("lanes_alive", &Analysis::lanes_alive,
              percent(
                  "lanes alive %", "Lanes alive", "percent of all lanes, per node visited",
                  "Branch divergence: all lanes of a work-item visit the same nodes, and a lane whose ray misses the node does "
                  "no work. 100 % means that every ray of a packet needs every node which the packet visits. Mirror rays of "
                  "curved surfaces diverge, and the share falls. With one lane it is the share of tested nodes which were "
                  "entered.")),
        plain(
            "warp_alive", &Analysis::warp_alive,
            percent("warp %", "Alive in a warp", "percent, of 32 neighbours, one lane only",
                    "The same on a GPU, where each ray is a work-item and 32 neighbours run in lockstep: all wait for the ray "
                    "which visits most nodes. The figure is the mean number of visits divided by the largest.",
                    false)),
        plain("bytes_per_ray", &Analysis::bytes_per_ray,
              {"bytes/ray", "Bytes fetched", "a ray, mean",
               "Nodes and primitives as they are stored in memory, each counted once per packet. Multiplied by the rays a "
               "second, "
               "this is the bandwidth which caches and memory must deliver."}),
        plain(
            "bytes_shared", &Analysis::bytes_shared,
            percent(
                "shared %", "Fetched together", "percent of the node fetches",
                "The gain of packets, as of coalesced reads on a GPU: the share of node fetches which a packet saves, compared "
                "with rays which fetch one by one. 0 % with one lane, where only the cache shares fetches.")),
        plain("node_bytes", &Analysis::node_bytes)};
    return fields;
}

const Fields<BenchRecord>& record_fields() {
    using R = BenchRecord;
    static const Fields<R> fields = {
        plain("suite", &R::suite),
        plain("case", &R::case_name),
        plain("scene", &R::scene),
        plain("measure", &R::measure),
        plain("variant", &R::variant),
        unless_empty("peer", &R::baseline),
        plain("device", &R::device),
        plain("device_id", &R::device_id),
        unless_empty("driver", &R::driver),
        unless_empty("device_clock_mhz", &R::device_clock_mhz),
        plain("threads", &R::threads),
        unless_empty("accel", &R::accel),
        unless_empty("accel_params", &R::accel_params),
        unless_empty("tracer", &R::tracer),
        unless_empty("depth", &R::depth),
        size("packet", &R::packet_w, &R::packet_h),
        unless_empty("lanes", &R::lanes),
        unless_empty("ray_slots", &R::ray_slots),
        size("size", &R::width, &R::height),
        plain("triangles", &R::triangles),
        plain("primitives", &R::primitives),
        {"status", status_json, read_status},
        unless_empty("why", &R::why),
        unless_empty("clock", &R::clock),
        times("time_ms", &R::time_ms),
        times("wall_ms", &R::wall_ms),
        {"frame_ms", [](const R& r) { return r.measure == "frame" ? summary_json(r, r.time_ms) : Json(); }, {}},
        figure_of(unless_empty("processors", &R::processors, {"procs", "processors"})),
        figure_of(unless_empty("fps", &R::fps, {"fps", "fps"})),
        count_of({"rays",
                  [](const R& r) { return write_fields(rays_fields(), r); },
                  [](const Json& json, R& r) { read_fields(json, rays_fields(), r); },
                  {"rays", "rays"},
                  [](const R& r) { return double(r.rays()); }}),
        count_of(plain("dropped_rays", &R::rays_dropped)),
        count_of(plain("hits", &R::hits)),
        figure_of(unless_empty("mrays_per_s", &R::mrays_per_s, {"Mrays/s", "Mrays/s"})),
        figure_of(unless_empty("build_ms", &R::build_ms)),
        figure_of(unless_empty("pack_ms", &R::pack_ms)),
        figure_of(unless_empty("compile_ms", &R::compile_ms)),
        figure_of(unless_empty("mtris_per_s", &R::mtris_per_s, {"Mtri/s", "Mtri/s"})),
        count_of({"page_faults",
                  [](const R& r) { return r.page_faults < 0 ? Json() : number_json(r.page_faults); },
                  [](const Json& json, R& r) { r.page_faults = json.get<double>(); },
                  {"faults", "page faults", nullptr, nullptr, 1, 0, true},
                  [](const R& r) { return r.page_faults < 0 ? NAN : r.page_faults; }}),
        count_of(unless_empty("bytes_per_triangle", &R::bytes_per_triangle, {"B/tri", "bytes/triangle"})),
        count_of(unless_empty("accel_bytes", &R::accel_bytes)),
        count_of(unless_empty("nodes", &R::nodes, {"nodes", "nodes"})),
        count_of(unless_empty("sah_cost", &R::sah_cost, {"SAH", "SAH cost"})),
        nested<Speedup>("versus", &R::speedup, versus_fields, [](const Speedup& v) { return !v.baseline.empty(); }),
        nested<Played>("animation", &R::animation, played_fields, [](const Played& p) { return p.total_ms > 0; }),
        nested<LightRun>("light", &R::light, light_fields, [](const LightRun& l) { return !l.sampler.empty(); }),
        count_of(nested<Analysis>("analysis", &R::analysis, analysis_fields, [](const Analysis& a) { return a.present; })),
        count_of(unless_empty("ranks", &R::ranks)),
        figure_of(unless_empty("efficiency", &R::efficiency)),
        parts("parts_ms", &R::parts_ms),
        parts("within_ms", &R::within_ms),
        figure_of<R>({"parts_error_ms", [](const R& r) { return r.parts_ms.empty() ? Json() : number_json(r.parts_error_ms); },
                      [](const Json& json, R& r) { r.parts_error_ms = json.get<double>(); }}),
        figure_of<R>({"kernels_ms", kernels_json, read_kernels})};
    return fields;
}

const Fields<BenchRun>& run_fields() {
    using R = BenchRun;
    const auto before_after = [](const char* key, double R::* before, double R::* after) {
        const Fields<R> both = {plain("before", before), plain("after", after)};
        return Field<R>{key, [=](const R& run) { return write_fields(both, run); },
                        [=](const Json& json, R& run) { read_fields(json, both, run); }};
    };
    static const Fields<R> fields = {plain("version", &R::version),
                                     plain("date", &R::date),
                                     plain("command", &R::command),
                                     plain("host_cpu", &R::host_cpu),
                                     plain("host_threads", &R::host_threads),
                                     unless_empty("governor", &R::governor),
                                     before_after("clock_mhz", &R::clock_mhz_before, &R::clock_mhz_after),
                                     before_after("load", &R::load_before, &R::load_after),
                                     plain("max_spread", &R::max_spread),
                                     plain("seconds", &R::seconds)};
    return fields;
}

const Field<BenchRecord>& record_field(const std::string& key) {
    const Field<BenchRecord>* const field = find_field(record_fields(), key);
    if (!field) throw Error(Exit::failed, "a benchmark record has no field '" + key + "'");
    return *field;
}

std::string shown_text(double stored, const Look& look) {
    const double value = stored * look.scale;
    if ((value == 0 && !look.zero) || !std::isfinite(value)) return {};
    if (look.digits < 0) return short_number(value);
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", look.digits, value);
    return text;
}

}  // namespace clarity::bench
