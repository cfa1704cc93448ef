#include "tools/bench/cases/ranks.hpp"

#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "base/digest.hpp"
#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/read_file.hpp"
#include "base/files/temporary_folder.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "stand/multi_preparer.hpp"
#include "tools/bench/cases/entry.hpp"
#include "tools/bench/output/row.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/failure.hpp"
#include "tools/bench/run/program.hpp"

namespace clarity::bench {
namespace {

// One picture by processes that mpirun starts: `mpirun -n 4 clarity render ... --mpi`.
struct RankRun {
    double whole_ms = 0;   // from the start of mpirun until it has ended
    nlohmann::json stats;  // what `clarity render --stats` wrote
    std::string picture;   // digest of the picture's file
};

// Used from one thread.
class RankRunner {
 public:
    // mpirun: a program and its options, separated by blanks. render: the words after `clarity render`, without those for
    // device, output and statistics. The ranks run this program's own file. Throws Error(failed) without room for a folder.
    RankRunner(const std::string& mpirun, std::vector<std::string> render);
    // Waits for the picture. device: as `--device` takes it; the ranks share those devices out. Throws Error(failed) with the
    // last words of mpirun if it cannot be started or fails, and Cancelled, after all ranks have ended.
    RankRun run(unsigned ranks, const std::string& device, const Progress& progress) const;

 private:
    const TemporaryFolder folder_;
    std::vector<std::string> mpirun_, render_;
};

std::string cause(int status) {
    if (WIFSIGNALED(status)) return std::string("ended by signal ") + strsignal(WTERMSIG(status));
    return "exit code " + std::to_string(WEXITSTATUS(status));
}

// Lines of the program itself, or else the first ones of mpirun, which frames its messages.
std::string words_of(const std::string& messages) {
    constexpr size_t kMostLines = 6;
    std::string ours, theirs;
    size_t lines = 0;
    std::istringstream in(messages);
    for (std::string line; std::getline(in, line);) {
        if (line.find_first_not_of("- \t\r") == std::string::npos) continue;
        if (line.compare(0, 7, "error: ") == 0 && ours.find(line) == std::string::npos) ours += "\n" + line;
        if (++lines <= kMostLines) theirs += "\n" + line;
    }
    return printable(ours.empty() ? theirs : ours);
}

// Runs a command that ends in the words of `clarity render`, and waits. It gets options for statistics, picture and messages in
// `folder`. what: names it in errors. install: what to do if its program cannot be started. Throws Error(failed) with the
// program's last words, and Cancelled, after all that it has started has ended.
RankRun run_render(std::vector<std::string> words, const std::string& folder, const std::string& what, const char* install,
                   const Progress& progress) {
    const std::string stats = folder + "/stats.json", picture = folder + "/picture.pfm", messages = folder + "/messages";
    unlink(stats.c_str());
    unlink(picture.c_str());
    for (const std::string& word : {std::string("-q"), std::string("-o"), picture, std::string("--stats"), stats})
        words.push_back(word);
    const Ended ended = run_program(words, messages, install, progress);
    if (!WIFEXITED(ended.status) || WEXITSTATUS(ended.status) != 0)
        throw Error(Exit::failed,
                    what + ": " + cause(ended.status) + words_of(read_file(messages, kMaxTextFileBytes, Exit::failed)));
    RankRun run;
    run.whole_ms = ended.ms;
    try {
        run.stats = nlohmann::json::parse(read_file(stats, kMaxTextFileBytes, Exit::failed));
    } catch (const nlohmann::json::exception&) {
        throw Error(Exit::failed, stats + ": is no JSON: do all ranks run the same version of the program?");
    }
    run.picture = digest_of_file(picture);
    if (run.picture.empty()) throw Error(Exit::failed, picture + ": cannot be read");
    return run;
}

RankRunner::RankRunner(const std::string& mpirun, std::vector<std::string> render)
    : folder_("clarity-ranks"), render_(std::move(render)) {
    std::istringstream words(mpirun);
    for (std::string word; words >> word;) mpirun_.push_back(word);
    if (mpirun_.empty()) throw Error(Exit::usage, "--mpirun: name a program, as in --mpirun \"mpirun --oversubscribe\"");
}

RankRun RankRunner::run(unsigned ranks, const std::string& device, const Progress& progress) const {
    std::vector<std::string> words = mpirun_;
    for (const std::string& word : {std::string("-n"), std::to_string(ranks), program_file().string(), std::string("render")})
        words.push_back(word);
    words.insert(words.end(), render_.begin(), render_.end());
    for (const std::string& word : {std::string("--mpi"), std::string("--device"), device}) words.push_back(word);
    return run_render(words, folder_.path(), mpirun_[0] + " -n " + std::to_string(ranks),
                      "install Open MPI (Debian: openmpi-bin), or name what starts ranks with --mpirun", progress);
}

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

// The words of `clarity render` that all crews share.
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

// What the ranks told about settings, structure and rays.
void describe(BenchRecord& row, const Json& stats) {
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

std::vector<BenchRecord> measure_start(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, Progress& progress) {
    std::vector<BenchRecord> rows;
    std::unique_ptr<TemporaryFolder> kept;
    const TemporaryFolder output("clarity-start");
    for (const DeviceInfo& device : options.devices)
        for (const Variant& variant : c.variants) {
            if (!kept || variant.cold) kept = std::make_unique<TemporaryFolder>("clarity-cold");
            BenchRecord row = make_row(c);
            row.scene = scene.name;
            row.variant = variant.label;
            describe(row, device);
            std::vector<std::string> words = {"env"};
            for (const char* name : {"XDG_CACHE_HOME", "POCL_CACHE_DIR", "CUDA_CACHE_PATH"})
                words.push_back(std::string(name) + "=" + kept->path() + "/" + name);
            for (const std::string& word :
                 {program_file().string(), std::string("render"), std::string("--device"), device.id()})
                words.push_back(word);
            const std::vector<std::string> render = render_words(scene, plugins, request, variant, options.import);
            words.insert(words.end(), render.begin(), render.end());
            try {
                const RankRun run = run_render(words, output.path(), variant.label, "install coreutils", progress);
                describe(row, run.stats);
                row.time_ms = summarize({run.stats.at("compile_ms").get<double>()});
                row.wall_ms = summarize({run.whole_ms});
            } catch (const Cancelled&) {
                throw;
            } catch (const std::exception& error) {
                row.status = RowStatus::failed;
                row.why = failure_text(error);
            }
            rows.push_back(std::move(row));
        }
    return rows;
}

}  // namespace clarity::bench
