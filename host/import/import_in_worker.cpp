#include "import/import_in_worker.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/packed_file.hpp"
#include "base/log.hpp"
#include "base/physical_memory.hpp"
#include "base/printable.hpp"
#include "import/wire.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

namespace clarity::import {
namespace {

// Limits of a worker. They grow with the sizes of all files that it reads, included files too.
class Limits {
 public:
    explicit Limits(const ImportOptions& options) : options_(options) {}
    void add_file(const std::string& path) { file_bytes_ += std::min(stated_content_bytes(path), uint64_t(1) << 50); }
    // Seconds without progress. Small files are read in milliseconds; a damaged file that puts a parser into an endless loop
    // must be stopped within ten seconds.
    double idle_s() const { return std::min(7 + 2 * static_cast<double>(file_bytes_) / (1 << 20), options_.time_limit_s); }
    uint64_t cpu_s() const { return static_cast<uint64_t>(std::ceil(std::clamp(options_.time_limit_s, 1.0, 1e9))); }
    uint64_t memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return std::min(std::max(uint64_t(1) << 30, 64 * file_bytes_), most_memory_bytes());
    }
    uint64_t most_memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return physical_memory_bytes() / 4 * 3;
    }

 private:
    const ImportOptions& options_;
    uint64_t file_bytes_ = 0;
};

// Supervises one import.
class ImportSupervisor : public worker::Supervisor {
 public:
    ImportSupervisor(worker::WorkerProcess& process, Limits limits, std::string first_file, const std::string& program,
                     Progress& progress)
        : Supervisor(process, {worker::kImportGreeting, "an import worker", program, Exit::import_failed}, progress),
          limits_(limits),
          file_(std::move(first_file)) {}

 private:
    using End = worker::Ending::Kind;
    void handle(const worker::Message& message) override {
        if (message.kind != worker::MessageKind::running) return;
        const size_t end = message.text.find('\n');
        file_ = message.text.substr(0, end);
        importer_ = end == std::string::npos ? "" : message.text.substr(end + 1);
        made_progress();
        const uint64_t before = limits_.memory_bytes();
        limits_.add_file(file_);
        worker_.raise_memory_limit(limits_.memory_bytes() - before);
        worker::send_message(worker_.channel(), {worker::MessageKind::proceed, 0, 0, {}});
    }
    void printed(const std::string& line) override {
        log(LogLevel::info,
            (importer_.empty() ? "an importer" : "importer " + importer_) + " printed: " + printable_line(line));
    }
    double idle_limit_s() const override { return limits_.idle_s(); }
    uint64_t processor_limit_s() const override { return limits_.cpu_s(); }
    uint64_t memory_limit_bytes() const override { return limits_.memory_bytes(); }
    std::string speaker() const override { return importer_.empty() ? "the importer" : "the importer " + importer_; }

    void ended(const worker::Ending& ending) const override {
        const std::string advice = "; the file is damaged or uses something that the library cannot handle";
        switch (ending.kind) {
            case End::no_progress:
                fail(speaker() + " made no progress for " + ending.how +
                     " and was stopped; the file is damaged, or too complex for the library that reads it");
            case End::memory:
                fail(speaker() + " needs more than " + ending.how +
                     " of memory; the file is damaged, or larger than this machine can import");
            case End::exited:
                fail(speaker() + " ended the worker process (" + ending.how + ") without a result" + advice);
            case End::processor_time:
                fail(speaker() + " used more than " + ending.how + " of processor time and was stopped" + advice);
            case End::killed:
                fail(speaker() +
                     "'s worker process was killed from outside, as the system does when memory runs out; close other "
                     "programs or take a smaller file");
            case End::crashed:
                break;
        }
        fail(speaker() + " crashed (" + ending.how + ") while reading" + advice);
    }
    [[noreturn]] void fail(const std::string& why) const { throw Error(Exit::import_failed, file_ + ": " + why); }

    Limits limits_;
    std::string file_, importer_;
};

}  // namespace

Scene import_in_worker(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                       Progress& progress) {
    if (std::getenv(worker::kWorkerVariable)) {
        throw Error(Exit::import_failed, files.front() +
                                             ": this process is an import worker itself and starts no other; set "
                                             "CLARITY_WORKER to the program `clarity`");
    }
    const Limits limits(options);
    const std::string program = options.worker.empty() ? worker::worker_program() : options.worker;
    std::vector<std::string> arguments;
    const std::pair<const char*, uint64_t> numbers[] = {{"--memory", limits.memory_bytes()},
                                                        {"--most-memory", limits.most_memory_bytes()},
                                                        {"--cpu", limits.cpu_s()},
                                                        {"--parent", static_cast<uint64_t>(getpid())}};
    for (const auto& [key, value] : numbers) arguments.insert(arguments.end(), {key, std::to_string(value)});
    for (const PluginRecord& record : plugins.records()) {
        if (!record.plugin || record.shadowed || record.plugin->accel) continue;
        arguments.insert(arguments.end(), {"--plugin", record.loaded});
    }
    for (const std::string& folder : options.search_paths) arguments.insert(arguments.end(), {"--search", folder});
    for (const std::string& importer : options.importers) arguments.insert(arguments.end(), {"--importer", importer});
    arguments.push_back("--");
    arguments.insert(arguments.end(), files.begin(), files.end());

    worker::WorkerProcess process(program, "import-worker", arguments, Exit::import_failed);
    ImportSupervisor(process, limits, files.front(), program, progress).follow();
    try {
        return read_scene(process.result());
    } catch (const Error& e) {
        throw Error(Exit::import_failed, files.front() + ": the import worker's result cannot be used: " + e.what());
    }
}

}  // namespace clarity::import
