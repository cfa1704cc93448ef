#include "import/import_job.hpp"

#include <poll.h>
#include <unistd.h>

#include <filesystem>
#include <new>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "import/import.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/wire.hpp"
#include "worker/child.hpp"

namespace clarity::import {
namespace {

using worker::MessageKind;

// Names each file to the parent before it is imported, and waits until the worker's limits allow for it.
class ImportProgress : public worker::ChannelProgress, public ImportObserver {
 public:
    void running(const std::string& file, const std::string& importer) override {
        worker::say_step(file + '\n' + importer);
        worker::Message answer;
        do {
            pollfd ready = {worker::kChannelFd, POLLIN, 0};
            poll(&ready, 1, -1);
            if (worker::receive_message(worker::kChannelFd, answer) == worker::Received::closed) _exit(1);
            if (answer.kind == MessageKind::cancel) throw Cancelled();
        } while (answer.kind != MessageKind::proceed);
    }
};

void import_files(const ImportJob& job, ImportProgress& progress) {
    const FileAccess access(job.files, job.search_paths);
    const PluginRegistry plugins = PluginRegistry::of(job.plugins);
    const ImporterParameters parameters = parse_importer_choices(plugins, job.importers);
    // A file that the user named may be a link to another folder. Only the target itself may be read, not the files beside it.
    std::vector<std::string> named;
    for (const std::string& file : job.files) named.push_back(std::filesystem::canonical(first_frame(file)).string());
    worker::enter_sandbox(worker::WorkerKind::parser, access.folders(), named, job.limits);
    SceneBuilder builder(plugins, parameters, access, progress, &progress);
    for (const std::string& file : job.files) builder.add_root(file);
    SentScene result{builder.take()};
    try {
        worker::answer(result);
    } catch (const Error& e) {
        throw Error(Exit::import_failed, job.files.front() + ": " + e.what());
    }
}

}  // namespace

void import_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<ImportJob>(arguments);
    ImportProgress progress;
    try {
        import_files(job, progress);
    } catch (const std::bad_alloc&) {
        throw Error(Exit::import_failed, job.files.front() + ": out of memory");
    }
}

}  // namespace clarity::import
