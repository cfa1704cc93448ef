// clarity check: says whether plugins are right, one line a check.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/printable.hpp"
#include "check/check.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"

namespace clarity {
namespace {

using check::CheckResult;
using check::Outcome;

// Runs a program that prints for the user. Throws Error(failed) if it fails.
void run_tool(const std::vector<std::string>& words) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    pid_t pid = -1;
    int status = 0;
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    if (const int error = posix_spawnp(&pid, argv[0], nullptr, nullptr, argv.data(), environ))
        throw Error(Exit::failed, "`" + text + "` cannot be run: " + std::strerror(error));
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw Error(Exit::failed, "`" + text + "` failed; its messages are above");
}

// Builds the plugins of a folder of source, in a folder `build` of it, as its author would.
std::vector<PluginRecord> build_folder(const std::string& folder) {
    namespace fs = std::filesystem;
    if (!fs::exists(fs::path(folder) / "CMakeLists.txt"))
        throw Error(
            Exit::usage,
            folder + ": is a folder without CMakeLists.txt; name a library, or a folder that `clarity new-plugin` made");
    const fs::path build = fs::path(folder) / "build", prefix = program_file().parent_path().parent_path();
    run_tool(
        {"cmake", "-S", folder, "-B", build.string(), "-DCMAKE_PREFIX_PATH=" + prefix.string(), "-DCMAKE_BUILD_TYPE=Release"});
    run_tool({"cmake", "--build", build.string()});
    std::vector<PluginRecord> records;
    for (const auto& entry : fs::recursive_directory_iterator(build)) {
        if (entry.path().extension() != ".so") continue;
        PluginRecord record = load_plugin(entry.path().string());
        if (!record.plugin) throw Error(Exit::failed, entry.path().string() + ": the library was refused: " + record.why);
        record.path = fs::absolute(entry.path()).string();
        records.push_back(std::move(record));
    }
    if (records.empty())
        throw Error(Exit::failed, folder + ": it builds no plugin; its CMakeLists.txt needs clarity_add_plugin(...)");
    return records;
}

// The libraries that a word names: a file, those of a folder of source, or all plugins of that id.
std::vector<PluginRecord> libraries_of(const PluginRegistry& plugins, const std::string& word) {
    std::error_code error;
    if (std::filesystem::is_directory(word, error)) return build_folder(word);
    if (word.find('/') != std::string::npos || std::filesystem::path(word).extension() == ".so") {
        PluginRecord record = load_plugin(word);
        if (!record.plugin) throw Error(Exit::failed, word + ": the library was refused: " + record.why);
        record.path = std::filesystem::absolute(word).string();
        return {record};
    }
    std::vector<PluginRecord> found;
    std::string ids;
    for (const PluginRecord& record : plugins.records()) {
        if (!record.plugin || record.shadowed) continue;
        ids += (ids.empty() ? "" : ", ") + std::string(record.plugin->id);
        if (word == record.plugin->id) found.push_back(record);
    }
    if (found.empty())
        throw Error(Exit::usage, word + ": no plugin of this id; there are " + ids + "; or name a library, ./" + word + ".so");
    return found;
}

// The libraries that the checks of a plugin need: what packs and traces its topology, other importers and shapes, or, of a
// shape, importers and a structure.
std::vector<std::string> needed_beside(const PluginRegistry& plugins, const PluginRecord& record) {
    std::vector<std::string> beside;
    if (record.plugin->primitive) {
        // The structure of least effort: its kernels are compiled for scenes with the shape.
        const rt_plugin* structure = nullptr;
        std::string path;
        for (const PluginRecord& other : plugins.records()) {
            if (!other.plugin || other.shadowed) continue;
            if (other.plugin->importer) beside.push_back(other.path);
            if (!other.plugin->accel || !other.plugin->accel->build) continue;
            if (structure && other.plugin->accel->ray_cost <= structure->accel->ray_cost) continue;
            structure = other.plugin;
            path = other.path;
        }
        if (structure) beside.push_back(path);
        return beside;
    }
    for (const PluginRecord& other : plugins.records()) {
        if (!other.plugin || other.shadowed || other.path == record.path) continue;
        const std::string id = other.plugin->id;
        const bool needed = record.plugin->importer ? !other.plugin->accel && id != record.plugin->id
                                                    : record.plugin->accel->layout && other.plugin->accel &&
                                                          id == record.plugin->accel->layout && other.plugin->accel->pack;
        if (needed) beside.push_back(other.path);
    }
    if (beside.empty() && record.plugin->accel && record.plugin->accel->layout)
        throw Error(Exit::failed, record.path + ": its layout '" + record.plugin->accel->layout +
                                      "' was not found, or packs no trees; `clarity plugins` lists the structures that do");
    return beside;
}

const char* kind_text(Outcome::Kind kind) {
    return kind == Outcome::Kind::passed ? "ok" : kind == Outcome::Kind::failed ? "FAILED" : "skipped";
}

std::string repeat_text(const CheckResult& result, const CheckCommand& command) {
    std::string text = "clarity check " + result.plugin + " --only " + result.name;
    for (const std::string& word : command.what)
        if (word.find('/') != std::string::npos) text = "clarity check " + word + " --only " + result.name;
    if (command.options.quick) text += " --quick";
    return text;
}

void print(const CheckResult& result, const CheckCommand& command) {
    std::string line = std::string(kind_text(result.outcome.kind)) + "  " + result.plugin + " " + result.name + ": " +
                       result.tried + ": " + printable_line(result.outcome.found);
    char time[32];
    std::snprintf(time, sizeof time, "  (%.1f s)", result.seconds);
    line += time;
    if (result.outcome.kind == Outcome::Kind::failed) {
        line += "; repeat: " + repeat_text(result, command);
        if (!result.outcome.repeat.empty()) line += "; " + result.outcome.repeat;
    }
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

}  // namespace

int run_check(const PluginRegistry& plugins, const CheckCommand& command) {
    std::vector<PluginRecord> libraries;
    for (const std::string& word : command.what)
        for (PluginRecord& record : libraries_of(plugins, word)) libraries.push_back(std::move(record));
    if (!command.options.report_folder.empty()) std::filesystem::create_directories(command.options.report_folder);
    Progress progress;
    const CancelOnSignal cancel(progress);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    bool all = true;
    for (const PluginRecord& record : libraries)
        all &= check::check_plugin_library(
            record, needed_beside(plugins, record), command.options, progress, [&](const CheckResult& result) {
                if (!command.json) return print(result, command);
                list.push_back({{"plugin", result.plugin},
                                {"library", record.path},
                                {"check", result.name},
                                {"status", result.outcome.kind == Outcome::Kind::passed   ? "passed"
                                           : result.outcome.kind == Outcome::Kind::failed ? "failed"
                                                                                          : "skipped"},
                                {"tried", result.tried},
                                {"found", result.outcome.found},
                                {"repeat", repeat_text(result, command)},
                                {"report", result.outcome.repeat},
                                {"seconds", result.seconds}});
            });
    if (command.json) std::printf("%s\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    return static_cast<int>(all ? Exit::done : Exit::failed);
}

}  // namespace clarity
