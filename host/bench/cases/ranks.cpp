#include "bench/cases/ranks.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "base/error.hpp"
#include "bench/baselines/speedup.hpp"
#include "bench/cases/entry.hpp"
#include "bench/output/row.hpp"
#include "bench/run/failure.hpp"
#include "bench/run/rank_run.hpp"
#include "render/multi/multi_preparer.hpp"

namespace clarity::bench {
namespace {

using Json = nlohmann::json;

// Parts of a run in their order. `start` is all that is left of the whole command: mpirun, starting and ending processes,
// opening devices, writing the file.
const std::vector<std::string> kParts = {"start", "import", "share", "build", "wait", "trace", "collect"};

// So many ranks, with their row.
struct Crew {
    BenchRecord row;
    std::string devices;                               // as --device takes them
    bool alike = true;                                 // all devices are of one kind
    std::map<std::string, std::vector<double>> parts;  // ms, one entry per repetition
    std::string picture;                               // digest of its file
    bool repeats = true;                               // all repetitions gave the same file
    Json stats;                                        // of the last repetition
};

Crew make_crew(unsigned ranks, const std::vector<DeviceInfo>& devices, const BenchRecord& row, const std::string& label) {
    const std::vector<DeviceInfo> own(devices.begin(), devices.begin() + std::min<std::ptrdiff_t>(ranks, devices.size()));
    Crew crew;
    crew.row = row;
    crew.row.ranks = ranks;
    crew.row.variant = (label.empty() ? "" : label + ", ") + std::to_string(ranks) + (ranks == 1 ? " rank" : " ranks");
    describe(crew.row, own[0]);
    crew.row.device = devices_name(own);
    crew.row.device_id = crew.devices = device_list_text(own);
    crew.row.threads = 0;
    for (const DeviceInfo& device : own) {
        crew.row.threads += device.compute_units;
        crew.alike &= device.driver == devices[0].driver && device.cpu == devices[0].cpu;
    }
    return crew;
}

// The picture's time begins when all ranks can trace and ends when the first one has it.
Sample note(Crew& crew, const RankRun& run) {
    const Json& stats = run.stats;
    const double to_trace = stats.at("wait_ms").at("to_trace"), traced = stats.at("wait_ms").at("traced"),
                 trace = stats.at("ranks").at(0).at("frame_wall_ms"), collect = stats.at("collect_ms");
    const std::map<std::string, double> parts = {{"import", stats.at("import_ms")},
                                                 {"share", stats.at("share_ms")},
                                                 {"build", stats.at("prepare_ms")},
                                                 {"wait", to_trace + traced},
                                                 {"trace", trace},
                                                 {"collect", collect}};
    double rest = run.whole_ms, slowest = 0;
    for (const auto& [name, ms] : parts) {
        crew.parts[name].push_back(ms);
        rest -= ms;
    }
    crew.parts["start"].push_back(rest);
    for (const Json& rank : stats.at("ranks")) slowest = std::max(slowest, rank.at("frame_ms").get<double>());
    if (crew.picture.empty()) crew.picture = run.picture;
    crew.repeats &= crew.picture == run.picture;
    crew.stats = stats;
    return {slowest, trace + traced + collect};
}

void finish(Crew& crew, const Crew& first, const Measured& measured) {
    BenchRecord& row = crew.row;
    if (!crew.stats.is_null()) describe(row, crew.stats);
    set_result(row, measured);
    set_rates(row);
    if (row.status != RowStatus::ok) return;
    for (const std::string& part : kParts) row.parts_ms.emplace_back(part, median(crew.parts[part]));
    if (!crew.alike || !first.alike || (crew.repeats && crew.picture == first.picture)) return;
    row.status = RowStatus::refused;
    row.why = crew.repeats ? "its picture has other bytes than that of the first row: one of the two is wrong"
                           : "its pictures differ from run to run: ranks do not share them rightly";
}

unsigned device_count(const BenchRecord& row, size_t devices) {
    return unsigned(std::min<size_t>(row.ranks, devices));
}

}  // namespace

std::vector<std::string> render_words(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                      const Variant& variant, const import::ImportOptions& import) {
    std::vector<std::string> words = scene.files;
    const auto add = [&](const char* option, const std::string& value) {
        if (value.empty()) return;
        words.emplace_back(option);
        words.push_back(value);
    };
    for (const PluginRecord& record : plugins.records())  // ranks find the others themselves
        if (record.plugin && !is_own_library(record.path)) add("--plugin", record.path);
    for (const std::string& folder : import.search_paths) add("--search-path", folder);
    for (const std::string& importer : import.importers) add("--importer", importer);
    for (const auto* settings : {&request.settings, &variant.settings})
        for (const auto& [key, value] : *settings) add("--set", key + "=" + value);
    add("--accel", variant.accel);
    add("--camera", scene.camera);
    add("--light", scene.light);
    return words;
}

void describe(BenchRecord& row, const nlohmann::json& stats) {
    row.accel = stats.at("accel");
    row.tracer = stats.at("tracer");
    row.depth = stats.at("depth");
    std::sscanf(stats.at("size").get<std::string>().c_str(), "%dx%d", &row.width, &row.height);
    std::sscanf(stats.at("packet").get<std::string>().c_str(), "%dx%d", &row.packet_w, &row.packet_h);
    row.lanes = stats.at("lanes");
    row.triangles = stats.at("triangles");
    row.build_ms = stats.at("build_ms");
    row.pack_ms = stats.at("pack_ms");
    row.compile_ms = stats.at("compile_ms");
    row.accel_bytes = stats.at("accel_bytes");
    row.nodes = stats.at("nodes");
    row.bytes_per_triangle = row.triangles > 0 ? double(row.accel_bytes) / double(row.triangles) : 0;
    row.rays_primary = stats.at("rays").at("primary");
    row.rays_shadow = stats.at("rays").at("shadow");
    row.rays_secondary = stats.at("rays").at("secondary");
    row.rays_dropped = stats.at("dropped_rays");
}

std::vector<BenchRecord> measure_ranks(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, const MeasureRules& rules,
                                       Progress& progress) {
    std::vector<BenchRecord> rows;
    for (const Variant& variant : c.variants) {
        BenchRecord row = make_row(c);
        row.scene = scene.name;
        row.accel = variant.accel;
        std::vector<Crew> crews;
        for (const unsigned ranks : request.ranks) crews.push_back(make_crew(ranks, options.devices, row, variant.label));
        try {
            const RankRunner runner(request.mpirun, render_words(scene, plugins, request, variant, options.import));
            std::vector<Contender> contenders;
            for (Crew& crew : crews)
                contenders.push_back({crew.row.variant, [&crew, &runner, &progress] {
                                          return note(crew, runner.run(crew.row.ranks, crew.devices, progress));
                                      }});
            const std::vector<Measured> measured = measure_interleaved(contenders, rules, progress);
            for (size_t i = 0; i < crews.size(); ++i) finish(crews[i], crews[0], measured[i]);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& error) {
            row.status = RowStatus::failed;
            row.why = failure_text(error);
            rows.push_back(row);
            continue;
        }
        std::vector<BenchRecord> own;
        for (Crew& crew : crews) own.push_back(std::move(crew.row));
        compare_with_first(own);
        for (BenchRecord& one : own)
            if (one.speedup.ratio > 0)
                one.efficiency = one.speedup.ratio * device_count(own[0], options.devices.size()) /
                                 device_count(one, options.devices.size());
        rows.insert(rows.end(), own.begin(), own.end());
    }
    return rows;
}

}  // namespace clarity::bench
