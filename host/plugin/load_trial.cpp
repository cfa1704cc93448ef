#include "plugin/load_trial.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/log.hpp"
#include "plugin/known_libraries.hpp"
#include "plugin/registry.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

namespace clarity {
namespace {

// How the worker died.
struct Died {
    std::string how;
};

class LoadSupervisor : public worker::Supervisor {
 public:
    LoadSupervisor(worker::WorkerProcess& process, Progress& progress)
        : Supervisor(process, {worker::kLoadGreeting, "a load worker", worker::worker_program(), Exit::failed}, progress) {}

 private:
    double idle_limit_s() const override { return 10; }
    bool counts_processor_time() const override { return true; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override { return uint64_t(4) << 30; }
    std::string speaker() const override { return "a library that was opened"; }
    void ended(const worker::Ending& ending) const override {
        using End = worker::Ending::Kind;
        switch (ending.kind) {
            case End::crashed:
                throw Died{"crashed the process that opened it (" + ending.how + ")"};
            case End::exited:
                throw Died{"ended the process that opened it (" + ending.how + ")"};
            case End::no_progress:
                throw Died{"did not let the process that opened it go on for " + ending.how};
            case End::memory:
                throw Died{"took more than " + ending.how + " of memory when it was opened"};
            default:
                throw Died{"was being opened when that process was killed"};
        }
    }
};

}  // namespace

std::string try_to_load(const std::string& path) {
    if (std::getenv(worker::kWorkerVariable) || is_known_library(path)) return {};
    try {
        worker::WorkerProcess process(worker::worker_program(), "load-worker",
                                      {"--library", path, "--parent", std::to_string(getpid())}, Exit::failed);
        Progress progress;
        LoadSupervisor(process, progress).follow();
    } catch (const Died& died) {
        return died.how + "; the file may be damaged: build it or copy it again";
    } catch (const std::exception& e) {
        log(LogLevel::debug, path + ": is opened without a trial: " + e.what());
    }
    return {};
}

// load-worker --library FILE --parent PID
int load_worker_main(int argc, char** argv) {
    constexpr const char* instead = "to look at a plugin, run `clarity plugins --plugin FILE`";
    const std::string library = argc == 6 && std::string(argv[2]) == "--library" ? argv[3] : "";
    const long parent = argc == 6 ? std::strtol(argv[5], nullptr, 10) : 0;
    if (!worker::begin_worker(worker::kLoadGreeting, parent, instead)) return static_cast<int>(Exit::usage);
    load_plugin(library);  // the parent finds out itself why a library is refused
    // Its destructors would run at the end of the program.
    const std::string full = std::filesystem::absolute(library).string();
    if (void* const handle = dlopen(full.c_str(), RTLD_NOW | RTLD_NOLOAD)) {
        dlclose(handle);
        dlclose(handle);  // what load_plugin() holds
    }
    std::fflush(nullptr);
    worker::send_message(worker::kChannelFd, {worker::MessageKind::done, 0, 0, {}});
    _exit(0);
}

}  // namespace clarity
