#include "render/trial/trial.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>

#include "base/error.hpp"
#include "base/files/cache_folder.hpp"
#include "base/files/library_files.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "base/printable.hpp"
#include "compile/compile.hpp"
#include "device/kernel_files.hpp"
#include "plugin/registry.hpp"
#include "render/kernels/scene_features.hpp"
#include "render/trial/trial_arguments.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

bool is_wanted(const DeviceInfo& info) {
    if (std::getenv(worker::kWorkerVariable)) return false;
    const char* word = std::getenv("CLARITY_TRIAL");
    if (word && std::strcmp(word, "off") == 0) return false;
    return (word && std::strcmp(word, "on") == 0) || (info.cpu && compiles_in_worker());
}

// The file that a plugin was loaded from; empty: it is part of this program.
std::string library_of(const rt_plugin& plugin) {
    const std::string file = loaded_file_of(plugin.id);
    std::error_code error;
    return file.empty() || fs::equivalent(file, program_file(), error) ? std::string() : file;
}

// What has to be tried: "cl/tracers/iterative.cl, changed from line 12 on". Empty: these kernels are the program's own.
struct Suspects {
    std::string text;
    SourceLocation first;  // of what was edited; without a message
};

Suspects suspects_of(const Trial& trial) {
    Suspects found;
    const auto add = [&](const std::string& text) { found.text += (found.text.empty() ? "" : ", ") + text; };
    for (const EditedKernel& edited : edited_kernels()) {
        if (trial.source.text.find("\"" + edited.shown_name + "\"") == std::string::npos) continue;
        if (found.text.empty()) found.first = {edited.path, edited.line, 0, {}};
        add(edited.path + (edited.line ? ", changed from line " + std::to_string(edited.line) + " on" : ""));
    }
    const std::string library = library_of(*trial.prepared.accel->layout);
    if (!library.empty() && !is_own_library(original_of(library))) add("the kernels of " + original_of(library));
    return found;
}

// Programs that have passed, by their text and device, in this process and in earlier ones.
class Passed {
 public:
    explicit Passed(const Trial& trial) {
        const std::string text = trial.source.options + '\n' + trial.info.name + '\n' + trial.info.driver + '\n' +
                                 trial.prepared.settings.accel + '\n' + trial.source.text;
        char name[40];
        std::snprintf(name, sizeof name, "%016llx-%zx", static_cast<unsigned long long>(hash_bytes(text.data(), text.size())),
                      text.size());
        name_ = name;
    }
    bool known() const {
        const std::lock_guard<std::mutex> lock(mutex());
        std::error_code error;
        return names().count(name_) || (!cache_folder().empty() && fs::exists(folder() / name_, error));
    }
    void keep() const {
        const std::lock_guard<std::mutex> lock(mutex());
        names().insert(name_);
        // The note for later processes is a convenience: without it they try these kernels again.
        if (cache_folder().empty()) return;
        std::error_code error;
        fs::create_directories(folder(), error);
        std::ofstream(folder() / name_) << '\n';
    }

 private:
    static fs::path folder() { return cache_folder() / "tried_kernels"; }
    static std::mutex& mutex() {
        static auto& all = *new std::mutex;
        return all;
    }
    static std::set<std::string>& names() {
        static auto& all = *new std::set<std::string>;
        return all;
    }
    std::string name_;
};

class TrialSupervisor : public worker::Supervisor {
 public:
    TrialSupervisor(worker::WorkerProcess& process, Progress& progress)
        : Supervisor(process, {worker::kTrialGreeting, "a trial worker", worker::worker_program(), Exit::kernel_build_failed},
                     progress) {}
    // Why there was no trial, through no fault of the kernels; empty: there was one.
    const std::string& not_tried() const { return not_tried_; }

 private:
    void handle(const worker::Message& message) override {
        if (message.kind == worker::MessageKind::running) {
            step_ = message.text;
            limit_s_ = message.fraction > 0 && message.fraction < 1e9f ? double(message.fraction) : 60;
            made_progress();
        } else if (message.kind == worker::MessageKind::report) {
            not_tried_ = message.text;
        }
    }
    double idle_limit_s() const override { return limit_s_; }
    bool counts_processor_time() const override { return true; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override {
        return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3;
    }
    std::string speaker() const override { return "the trial of kernels"; }
    void ended(const worker::Ending& ending) const override {
        using End = worker::Ending::Kind;
        const auto fail = [&](const std::string& what) { throw Error(Exit::kernel_build_failed, what + " while " + step_); };
        switch (ending.kind) {
            case End::crashed:
                fail("crashed (" + ending.how + ")");
                break;
            case End::no_progress:
                fail("did not come to an end within " + ending.how + " of processor time");
                break;
            case End::memory:
                fail("took more than " + ending.how + " of memory");
                break;
            case End::exited:
                fail("ended the process (" + ending.how + ")");
                break;
            default:
                fail("were killed from outside, maybe for want of memory,");
        }
    }
    std::string step_ = "starting", not_tried_;
    double limit_s_ = 60;
};

TrialArguments arguments_of(const Trial& trial) {
    const AccelData& accel = *trial.prepared.accel;
    TrialArguments arguments;
    for (const rt_plugin* plugin : {accel.plugin, accel.layout}) {
        const std::string library = library_of(*plugin);
        if (arguments.libraries.empty() || arguments.libraries.back().first != library)
            arguments.libraries.emplace_back(library, original_of(library));
    }
    arguments.device = trial.info.id();
    arguments.device_name = trial.info.name;
    arguments.features = features_of(*trial.prepared.scene, accel.scene);
    arguments.settings = trial.prepared.settings;
    arguments.settings.accel = accel.plugin->id;
    arguments.settings.accel_params = accel.params;
    return arguments;
}

}  // namespace

void try_kernels(const Trial& trial, Progress& progress) {
    if (!is_wanted(trial.info)) return;
    const Suspects suspects = suspects_of(trial);
    const Passed passed(trial);
    if (suspects.text.empty() || library_of(*trial.prepared.accel->layout).empty() || passed.known()) return;
    if (progress.cancelled()) throw Cancelled();
    progress.stage("trying kernels in a worker");
    worker::WorkerProcess process(worker::worker_program(), "trial-worker", words_of(arguments_of(trial)),
                                  Exit::kernel_build_failed);
    TrialSupervisor supervisor(process, progress);
    try {
        supervisor.follow();
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        const std::string why = std::string("kernels were tried in a worker first, and ") + e.what();
        SourceLocation place = suspects.first;
        place.message = why;
        throw Error(Exit::kernel_build_failed,
                    why + " (" + trial.source.what + "; " + suspects.text + "); `clarity check " +
                        trial.prepared.accel->layout->id +
                        "` looks closer, with oclgrind if that is installed; CLARITY_TRIAL=off runs kernels untried",
                    {}, place);
    }
    if (supervisor.not_tried().empty())
        passed.keep();
    else
        log(LogLevel::debug, "kernels were not tried: " + printable_line(supervisor.not_tried()));
}

}  // namespace clarity
