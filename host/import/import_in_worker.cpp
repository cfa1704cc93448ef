#include "import/import_in_worker.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/packed_file.hpp"
#include "base/files/parcel.hpp"
#include "base/log.hpp"
#include "base/machine.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "import/import.hpp"
#include "import/sink/scene_builder.hpp"
#include "import/wire.hpp"
#include "scene/surface_models.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity::import {
namespace {

// What the worker takes. It returns a SentScene (wire.hpp).
struct ImportJob {
    worker::WorkerLimits limits;
    std::vector<std::string> plugins, surfaces, search_paths, importers, files;
    std::vector<PictureFile> pictures;
    CLARITY_MEMBERS(limits, plugins, surfaces, search_paths, importers, files, pictures);
};

using worker::MessageKind;

// Names each file to the parent before it is imported, and what pictures take, and waits until the worker's limits allow for
// it.
class ImportProgress : public worker::ChannelProgress, public ImportObserver {
 public:
    void running(const std::string& file, const std::string& importer) override { ask(file + '\n' + importer); }
    void decoding(uint64_t bytes) override {
        constexpr uint64_t kWorthAsking = 1 << 20;
        waiting_ += bytes;
        if (waiting_ < kWorthAsking) return;
        ask('\n' + std::to_string(waiting_));
        waiting_ = 0;
    }

 private:
    // Returns once the parent's limits allow for it.
    static void ask(const std::string& step) {
        worker::say_step(step);
        worker::Message answer;
        do {
            pollfd ready = {worker::kChannelFd, POLLIN, 0};
            poll(&ready, 1, -1);
            if (worker::receive_message(worker::kChannelFd, answer) == worker::Received::closed) _exit(1);
            if (answer.kind == MessageKind::cancel) throw Cancelled();
        } while (answer.kind != MessageKind::proceed);
    }
    uint64_t waiting_ = 0;  // bytes of pictures that were not asked for yet
};

void import_files(const ImportJob& job, ImportProgress& progress) {
    const FileAccess access(job.files, job.search_paths, job.pictures);
    number_surface_models(job.surfaces);
    const PluginRegistry plugins = PluginRegistry::of(job.plugins);
    const ImporterParameters parameters = parse_importer_choices(plugins, job.importers);
    // A file that the user named may be a link to another folder. Only the target itself may be read, not the files beside it.
    std::vector<std::string> named;
    for (const std::string& file : job.files) named.push_back(std::filesystem::canonical(first_frame(file)).string());
    worker::enter_sandbox(worker::WorkerKind::parser, access.folders(), named, job.limits);
    SceneBuilder builder(plugins, parameters, access, progress, &progress);
    for (const std::string& file : job.files) builder.add_root(file);
    for (const PictureFile& picture : job.pictures) builder.add_picture(picture.path, picture.space);
    SentScene result{builder.take()};
    try {
        worker::answer(result);
    } catch (const Error& e) {
        throw Error(Exit::import_failed, job.files.front() + ": " + e.what());
    }
}

// The work of kImportJob. Its steps are a file, a line break and the importer that reads it, or a line break and the bytes that
// pictures take. It waits with each for MessageKind::proceed.
void import_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<ImportJob>(arguments);
    ImportProgress progress;
    try {
        import_files(job, progress);
    } catch (const std::bad_alloc&) {
        throw Error(Exit::import_failed, job.files.front() + ": out of memory");
    }
}

// Limits of a worker. They grow with the sizes of all files that it reads, included files too, and of decoded pictures.
class Limits {
 public:
    explicit Limits(const ImportOptions& options) : options_(options) {}
    void add_file(const std::string& path) { file_bytes_ += std::min(stated_content_bytes(path), uint64_t(1) << 50); }
    // Of what is small in files: pictures.
    void add_memory(uint64_t bytes) { more_bytes_ += std::min(bytes, uint64_t(1) << 50); }
    // Seconds without progress. Small files are read in milliseconds; a damaged file that puts a parser into an endless loop
    // must be stopped within ten seconds. A picture of 4096 x 4096 takes 0.3 s on an idle machine, and 8 s on a busy one.
    double idle_s() const {
        constexpr double kOfFiles = 2, kOfPictures = 0.02;  // seconds a MiB
        const double mebibytes = static_cast<double>(1 << 20);
        return std::min(7 + kOfFiles * static_cast<double>(file_bytes_) / mebibytes +
                            kOfPictures * static_cast<double>(more_bytes_) / mebibytes,
                        options_.time_limit_s);
    }
    uint64_t cpu_s() const { return static_cast<uint64_t>(std::ceil(std::clamp(options_.time_limit_s, 1.0, 1e9))); }
    uint64_t memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return std::min(std::max(uint64_t(1) << 30, 64 * file_bytes_) + more_bytes_, most_memory_bytes());
    }
    uint64_t most_memory_bytes() const {
        if (options_.memory_limit_bytes > 0) return options_.memory_limit_bytes;
        return physical_memory_bytes() / 4 * 3;
    }

 private:
    const ImportOptions& options_;
    uint64_t file_bytes_ = 0, more_bytes_ = 0;
};

class Import : public worker::Job {
 public:
    Import(Limits limits, const std::string& first_file) : Job(kImportJob, "the importer", {}), import_limits_(limits) {
        what_ = subject = first_file;
        take_limits();
    }

 private:
    void take_limits() { limits_ = {import_limits_.idle_s(), import_limits_.cpu_s(), import_limits_.memory_bytes()}; }
    void on_step(const std::string& text) override {
        const size_t end = text.find('\n');
        const uint64_t before = limits_.memory_bytes;
        if (end == 0) {
            uint64_t bytes = 0;
            if (read_number(text.substr(1), bytes)) import_limits_.add_memory(bytes);
            return proceed(before);
        }
        what_ = text.substr(0, end);
        importer_ = end == std::string::npos ? "" : text.substr(end + 1);
        who_ = "the importer" + (importer_.empty() ? "" : " " + importer_);
        import_limits_.add_file(what_);
        proceed(before);
    }
    // before: the limit of memory that the worker has.
    void proceed(uint64_t before) {
        take_limits();
        process().raise_memory_limit(limits_.memory_bytes - before);
        worker::send_message(process().channel(), {worker::MessageKind::proceed, 0, 0, {}});
    }
    void on_output(const std::string& line) override {
        log(LogLevel::info,
            (importer_.empty() ? "an importer" : "importer " + importer_) + " printed: " + printable_line(line));
    }

    Limits import_limits_;
    std::string importer_;
};

}  // namespace

const worker::JobKind kImportJob = {
    "import",
    "to import a file, run `clarity info FILE`",
    Exit::import_failed,
    false,
    LogLevel::info,
    {"{what}: {who} crashed ({how}) while reading; the file is damaged or uses something that the library cannot handle",
     "{what}: {who} ended the worker process ({how}) without a result; the file is damaged or uses something that the library "
     "cannot handle",
     "{what}: {who} made no progress for {how} and was stopped; the file is damaged, or too complex for the library that reads "
     "it",
     "{what}: {who} used more than {how} of processor time and was stopped; the file is damaged or uses something that the "
     "library cannot handle",
     "{what}: {who} needs more than {how} of memory; the file is damaged, or larger than this machine can import",
     "{what}: {who}'s worker process was killed from outside, as the system does when memory runs out; close other programs or "
     "take a smaller file"},
    import_job};

Scene import_in_worker(const PluginRegistry& plugins, const std::vector<std::string>& files, const ImportOptions& options,
                       Progress& progress) {
    if (worker::in_worker()) {
        throw Error(Exit::import_failed, files.front() +
                                             ": this process is an import worker itself and starts no other; set "
                                             "CLARITY_WORKER to the program `clarity`");
    }
    const Limits limits(options);
    ImportJob job{{limits.memory_bytes(), limits.most_memory_bytes(), limits.cpu_s()},
                  {},
                  surface_model_ids(),
                  options.search_paths,
                  options.importers,
                  files,
                  options.pictures};
    for (const PluginRecord& record : plugins.records())
        if (record.plugin && !record.shadowed && !record.plugin->accel) job.plugins.push_back(record.loaded);
    Import import(limits, files.front());
    if (!options.worker.empty()) import.program = options.worker;
    SentScene result;
    import.run(job, result, progress);
    return std::move(result.scene);
}

}  // namespace clarity::import
