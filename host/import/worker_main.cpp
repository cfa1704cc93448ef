// worker_main.cpp -- main function of the worker process: loads the importers, enters the sandbox, imports, and leaves the
// scene in shared memory.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/log.hpp"
#include "import/import.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/wire.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity::import {
namespace {

using worker::MessageKind;

// Names each file to the parent before it is imported, and waits until the worker's limits allow for it.
class ImportProgress : public worker::ChannelProgress, public ImportObserver {
 public:
    void running(const std::string& file, const std::string& importer) override {
        worker::send_message(worker::kChannelFd, {MessageKind::running, 0, 0, file + '\n' + importer});
        worker::Message answer;
        do {
            pollfd ready = {worker::kChannelFd, POLLIN, 0};
            poll(&ready, 1, -1);
            if (worker::receive_message(worker::kChannelFd, answer) == worker::Received::closed) _exit(1);
            if (answer.kind == MessageKind::cancel) throw Cancelled();
        } while (answer.kind != MessageKind::proceed);
    }
};

struct Arguments {
    worker::WorkerLimits limits;
    std::vector<std::string> plugins, search_paths, importers, files;
    long parent = 0;
};

// import-worker [--memory BYTES] [--most-memory BYTES] [--cpu SECONDS] [--parent PID] [--plugin FILE]... [--search FOLDER]...
// [--importer ID,key=value]... -- FILE...
bool parse(int argc, char** argv, Arguments& arguments) {
    int i = 1;
    if (i < argc && std::strcmp(argv[i], "import-worker") == 0) ++i;
    for (; i + 1 < argc && std::strcmp(argv[i], "--") != 0; i += 2) {
        const std::string key = argv[i], value = argv[i + 1];
        if (key == "--memory") {
            arguments.limits.memory_bytes = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--most-memory") {
            arguments.limits.most_memory_bytes = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--cpu") {
            arguments.limits.cpu_s = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--parent") {
            arguments.parent = std::strtol(value.c_str(), nullptr, 10);
        } else if (key == "--plugin") {
            arguments.plugins.push_back(value);
        } else if (key == "--importer") {
            arguments.importers.push_back(value);
        } else if (key == "--search") {
            arguments.search_paths.push_back(value);
        } else {
            return false;
        }
    }
    if (i >= argc || std::strcmp(argv[i], "--") != 0) return false;
    for (++i; i < argc; ++i) arguments.files.push_back(argv[i]);
    return !arguments.files.empty();
}

void import_files(const Arguments& arguments, ImportProgress& progress) {
    const FileAccess access(arguments.files, arguments.search_paths);
    const PluginRegistry plugins = PluginRegistry::of(arguments.plugins);
    const ImporterParameters parameters = parse_importer_choices(plugins, arguments.importers);
    // A file that the user named may be a link to another folder. Only the target itself may be read, not the files beside it.
    std::vector<std::string> named;
    for (const std::string& file : arguments.files) named.push_back(std::filesystem::canonical(first_frame(file)).string());
    for (const std::string& note : enter_sandbox(worker::WorkerKind::parser, access.folders(), named, arguments.limits)) {
        log(LogLevel::debug, "import worker: " + note);
    }
    SceneBuilder builder(plugins, parameters, access, progress, &progress);
    for (const std::string& file : arguments.files) builder.add_root(file);
    Scene scene = builder.take();
    worker::allow_writing_result();
    MemoryFile result = MemoryFile::of(worker::kResultFd);
    try {
        write_scene(result, std::move(scene));
    } catch (const Error& e) {
        throw Error(Exit::import_failed, arguments.files.front() + ": " + e.what());
    }
}

int run(const Arguments& arguments) {
    ImportProgress progress;
    std::string why;
    try {
        import_files(arguments, progress);
    } catch (const std::bad_alloc&) {
        why = arguments.files.front() + ": out of memory";
    } catch (const std::exception& e) {
        why = e.what();
    }
    std::fflush(nullptr);  // what importers printed comes before the end
    if (why.empty()) {
        worker::send_message(worker::kChannelFd, {MessageKind::done, 0, 0, {}});
    } else {
        worker::send_message(worker::kChannelFd, {MessageKind::failed, 0, 0, why});
    }
    return why.empty() ? 0 : static_cast<int>(Exit::import_failed);
}

}  // namespace

int import_worker_main(int argc, char** argv) {
    Arguments arguments;
    constexpr const char* instead = "to import a file, run `clarity info FILE`";
    if (!parse(argc, argv, arguments)) {
        std::fprintf(stderr, "workers are started by clarity itself; %s\n", instead);
        return static_cast<int>(Exit::usage);
    }
    if (!worker::begin_worker(worker::kImportGreeting, arguments.parent, instead)) return static_cast<int>(Exit::usage);
    const int status = run(arguments);
    // Exit without destructors: the kernel frees memory faster, and the clean-up of a library could still crash.
    _exit(status);
}

}  // namespace clarity::import
