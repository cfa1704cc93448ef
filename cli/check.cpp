// clarity check: says whether plugins are right, one line a check.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/run_tool.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "device/device.hpp"
#include "import/import.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/causes.hpp"
#include "tools/check/check.hpp"
#include "view/edit/edit.hpp"

namespace clarity {
namespace {

using check::CheckResult;
using check::Outcome;

// Runs a program that prints for the user. Throws Error(failed) if it fails.
void run_or_throw(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    if (!run_tool(words, text)) throw Error(Exit::failed, "`" + text + "` failed; its messages are above");
}

// Builds the plugins of a folder of source, in a folder `build` of it, as its author would.
std::vector<PluginRecord> build_folder(const std::string& folder) {
    namespace fs = std::filesystem;
    if (!fs::exists(fs::path(folder) / "CMakeLists.txt"))
        throw Error(
            Exit::usage,
            folder + ": is a folder without CMakeLists.txt; name a library, or a folder that `clarity new-plugin` made");
    const fs::path build = fs::path(folder) / "build", prefix = program_file().parent_path().parent_path();
    run_or_throw(
        {"cmake", "-S", folder, "-B", build.string(), "-DCMAKE_PREFIX_PATH=" + prefix.string(), "-DCMAKE_BUILD_TYPE=Release"});
    run_or_throw({"cmake", "--build", build.string()});
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
        const bool needed = record.plugin->importer
                                ? !other.plugin->accel && id != record.plugin->id
                                : record.plugin->accel && record.plugin->accel->layout && other.plugin->accel &&
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
const char* status_text(Outcome::Kind kind) {
    return kind == Outcome::Kind::passed ? "passed" : kind == Outcome::Kind::failed ? "failed" : "skipped";
}

// A word as a shell reads it.
std::string quoted(const std::string& word) {
    const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=+%@#";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos && word[0] != '#') return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string seconds_text(double seconds) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f s", seconds);
    return text;
}

std::string counted(size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// The checks of one library: prints what passes at once and what fails at the end, grouped by its cause.
class Report {
 public:
    // word: what names the library on the command line.
    Report(const PluginRecord& record, const std::string& word, const CheckCommand& command)
        : record_(record), word_(word), command_(command) {}

    void take(const CheckResult& result) {
        results_.push_back(result);
        if (command_.json) return;
        if (result.outcome.kind == Outcome::Kind::failed)
            log(LogLevel::info, result.plugin + " " + result.name + " fails; the last lines say how");
        else
            print(line_of(result) + "  (" + seconds_text(result.seconds) + ")");
    }
    // Prints what failed, and the verdict. cut: why not all checks ran.
    void finish(const std::string& cut) {
        causes_ = check::causes_of(results_);
        cut_ = cut;
        if (command_.json) return;
        for (const check::Cause& cause : causes_)
            for (const size_t i : cause.results) {
                const CheckResult& result = results_[i];
                if (i != cause.results.front()) {
                    print("        " + result.name + " fails, too: " + shortened(printable_line(result.outcome.found)));
                    continue;
                }
                print(line_of(result) + "  (" + seconds_text(result.seconds) + "); repeat: " + repeat_text(result) +
                      (result.outcome.repeat.empty() ? "" : "; " + result.outcome.repeat));
            }
        print("verdict  " + std::string(record_.plugin->id) + ": " + verdict());
    }
    // At least one check passed, none failed, and the run was not cut short. Skipped checks do not count.
    bool is_right() const { return count(Outcome::Kind::passed) > 0 && causes_.empty() && cut_.empty(); }

    std::string verdict() const {
        const size_t failed = count(Outcome::Kind::failed), skipped = count(Outcome::Kind::skipped);
        std::string text;
        if (failed > 0) {
            text = "wrong: " + std::to_string(failed) + " of " + counted(results_.size(), "check") + " failed, likely of " +
                   counted(causes_.size(), "fault") + ":";
            for (const check::Cause& cause : causes_)
                text += (&cause == causes_.data() ? " " : ", ") + results_[cause.results.front()].name +
                        (cause.stage.empty() ? "" : " (" + cause.stage + ")");
        } else if (count(Outcome::Kind::passed) == 0) {
            text = "undecided: nothing was checked";
        } else {
            text = std::string(cut_.empty() ? "nothing wrong was found by " : "undecided: nothing wrong was found so far by ") +
                   counted(count(Outcome::Kind::passed), "check");
        }
        if (!cut_.empty()) text += "; cut by " + cut_;
        if (skipped > 0) {
            text += "; skipped:";
            bool first = true;
            for (const CheckResult& result : results_)
                if (result.outcome.kind == Outcome::Kind::skipped) {
                    text += (first ? " " : ", ") + result.name;
                    first = false;
                }
        }
        if (failed == 0 && command_.options.quick) text += "; the long form, without --quick, tries more";
        if (command_.options.seed != 0) text += "; seed " + std::to_string(command_.options.seed);
        return text;
    }

    void add_json(nlohmann::ordered_json& list) const {
        const std::string said = verdict();
        for (size_t i = 0; i < results_.size(); ++i) {
            const CheckResult& result = results_[i];
            const CheckResult* cause = nullptr;
            for (const check::Cause& one : causes_)
                if (std::count(one.results.begin(), one.results.end(), i)) cause = &results_[one.results.front()];
            nlohmann::ordered_json json = {{"plugin", result.plugin},
                                           {"library", record_.path},
                                           {"check", result.name},
                                           {"status", status_text(result.outcome.kind)},
                                           {"tried", result.tried},
                                           {"found", result.outcome.found},
                                           {"repeat", repeat_text(result)},
                                           {"report", result.outcome.repeat},
                                           {"seconds", result.seconds},
                                           {"seed", command_.options.seed},
                                           {"verdict", said}};
            if (cause) {
                json["cause"] = cause->name;
                json["stage"] = check::stage_of(result);
            }
            list.push_back(std::move(json));
        }
    }
    std::string junit() const;

 private:
    static void print(const std::string& line) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
    }
    static std::string shortened(const std::string& text) {
        constexpr size_t kMost = 160;
        return text.size() <= kMost ? text : text.substr(0, kMost) + " ...";
    }
    static std::string line_of(const CheckResult& result) {
        return std::string(kind_text(result.outcome.kind)) + "  " + result.plugin + " " + result.name + ": " + result.tried +
               ": " + printable_line(result.outcome.found);
    }
    size_t count(Outcome::Kind kind) const {
        return static_cast<size_t>(std::count_if(results_.begin(), results_.end(),
                                                 [&](const CheckResult& result) { return result.outcome.kind == kind; }));
    }
    // A line for a shell that does this check again.
    std::string repeat_text(const CheckResult& result) const {
        const check::CheckOptions& options = command_.options;
        std::string text = "clarity check " + quoted(word_) + " --only " + result.name;
        const auto add = [&](const char* option, const std::string& value) {
            if (!value.empty()) text += std::string(" ") + option + " " + quoted(value);
        };
        if (options.quick) text += " --quick";
        if (options.seed != 0) add("--seed", std::to_string(options.seed));
        for (const int lanes : options.lanes) add("--lanes", std::to_string(lanes));
        add("--device", options.device);
        for (const std::string& sample : options.samples) add("--samples", sample);
        add("--truth", options.truth_folder);
        for (const std::string& file : command_.scene_files) add("--scene", file);
        add("--rays", options.rays_file);
        return text;
    }

    const PluginRecord& record_;
    const std::string word_;
    const CheckCommand& command_;
    std::vector<CheckResult> results_;
    std::vector<check::Cause> causes_;
    std::string cut_;
};

// An element <testsuite> of JUnit's format, as servers of continuous integration read it.
std::string Report::junit() const {
    double seconds = 0;
    for (const CheckResult& result : results_) seconds += result.seconds;
    std::string text = "  <testsuite name=\"" + markup_line(record_.plugin->id) + "\" tests=\"" +
                       std::to_string(results_.size()) + "\" failures=\"" + std::to_string(count(Outcome::Kind::failed)) +
                       "\" skipped=\"" + std::to_string(count(Outcome::Kind::skipped)) + "\" time=\"" +
                       std::to_string(seconds) + "\">\n";
    for (const CheckResult& result : results_) {
        text += "    <testcase classname=\"" + markup_line(record_.plugin->id) + "\" name=\"" + markup_line(result.name) +
                "\" time=\"" + std::to_string(result.seconds) + "\">";
        const std::string found = markup_line(result.tried + ": " + result.outcome.found);
        if (result.outcome.kind == Outcome::Kind::failed)
            text += "<failure message=\"" + found + "\">" + markup_line("repeat: " + repeat_text(result)) + "</failure>";
        else if (result.outcome.kind == Outcome::Kind::skipped)
            text += "<skipped message=\"" + found + "\"/>";
        else
            text += "<system-out>" + found + "</system-out>";
        text += "</testcase>\n";
    }
    return text + "    <system-out>" + markup_line(verdict()) + "</system-out>\n  </testsuite>\n";
}

// What --list says of one library.
void list_checks(const PluginRegistry& plugins, const PluginRecord& record, const CheckCommand& command, Progress& progress,
                 nlohmann::ordered_json& list) {
    check::check_plugin_library(
        record, needed_beside(plugins, record), command.options, progress, [&](const CheckResult& result) {
            if (command.json)
                list.push_back({{"plugin", result.plugin}, {"check", result.name}, {"tried", result.tried}});
            else
                std::printf("%s %s: %s\n", result.plugin.c_str(), result.name.c_str(), result.tried.c_str());
        });
}

// The scene of --scene, for checks of hits.
std::shared_ptr<const Scene> own_scene(const PluginRegistry& plugins, const std::vector<std::string>& files,
                                       Progress& progress) {
    check_scene_files(files);
    auto scene = std::make_shared<const Scene>(with_scene_edits(import::import_scene(plugins, files, {}, progress)));
    if (!scene->shapes.empty())
        throw Error(Exit::usage, "--scene " + files.front() +
                                     ": has shapes, and only their plugins know where rays meet them; leave them out, or check "
                                     "the shape by `clarity check " +
                                     scene->shape_kinds.front().id + "`");
    return scene;
}

// Refuses a device that compiles some kernels wrongly: its faults would look like faults of plugins.
void expect_sound_compiler(const check::CheckOptions& options) {
    const auto traces_nothing = [](const std::string& name) {
        return name.rfind("builds", 0) == 0 || name.rfind("keys", 0) == 0;
    };
    if (!options.only.empty() && std::all_of(options.only.begin(), options.only.end(), traces_nothing)) return;
    const DeviceInfo device = choose_device(options.device);
    if (device.llvmpipe)
        throw Error(
            Exit::no_device,
            device.name + " (" + device.platform +
                ") is no device to check plugins on: it makes wrong code of some kernels, such as those of bvh4, and what "
                "fails there may be its own fault; name another one with --device, as `clarity devices` lists them, or "
                "check the builder alone with --only builds");
}

}  // namespace

int run_check(const PluginRegistry& plugins, const CheckCommand& asked) {
    CheckCommand command = asked;
    std::vector<std::pair<PluginRecord, std::string>> libraries;  // with the words that name them
    for (const std::string& word : command.what) {
        const bool is_folder = std::filesystem::is_directory(word);
        for (PluginRecord& record : libraries_of(plugins, word)) {
            if (!command.scene_files.empty() && !record.plugin->accel)
                throw Error(Exit::usage, "--scene: " + std::string(record.plugin->id) +
                                             " is no structure; give the files of an importer by --samples");
            const std::string name = is_folder ? record.path : word;
            libraries.emplace_back(std::move(record), name);
        }
    }
    const bool runs_kernels = std::any_of(libraries.begin(), libraries.end(),
                                          [](const auto& library) { return library.first.plugin->importer == nullptr; });
    if (runs_kernels && !command.options.list) expect_sound_compiler(command.options);
    if (!command.options.report_folder.empty()) std::filesystem::create_directories(command.options.report_folder);
    if (!command.junit_file.empty()) check_writable(command.junit_file);
    Progress progress;
    const CancelOnSignal cancel(progress);
    if (!command.scene_files.empty()) {
        read_rays(command.options.rays_file);  // its faults are the user's, not the plugin's
        command.options.scene = own_scene(plugins, command.scene_files, progress);
        if (command.options.only.empty()) command.options.only = {"hits.own"};
    }
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    std::string junit;
    bool all = true;
    for (const auto& [record, word] : libraries) {
        if (command.options.list) {
            list_checks(plugins, record, command, progress, list);
            continue;
        }
        Report report(record, word, command);
        check::CheckEnd end;
        try {
            end = check::check_plugin_library(record, needed_beside(plugins, record), command.options, progress,
                                              [&](const CheckResult& result) { report.take(result); });
        } catch (const Cancelled&) {
            report.finish("Ctrl-C");
            throw;
        }
        report.finish(end.cut);
        report.add_json(list);
        junit += report.junit();
        all &= report.is_right();
        if (!report.is_right() && command.options.stop_at_first) break;
    }
    if (command.json) std::printf("%s\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    if (!command.junit_file.empty())
        write_text_file(command.junit_file,
                        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + junit + "</testsuites>\n");
    return static_cast<int>(all ? Exit::done : Exit::failed);
}

}  // namespace clarity
